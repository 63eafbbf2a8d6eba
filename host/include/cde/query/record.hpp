// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cde/contract/registers.hpp"
#include "cde/geometry/primitives.hpp"

namespace cde {

/// Which records a pass keeps. Of rays only hits count; of solids every pair has a signed gap, the
/// distance apart or minus the penetration depth, and T is its size.
enum class Mode : std::uint8_t {
  kNearest = card::kModeNearest,    ///< one a primary: the smallest (T or signed gap, index)
  kFarthest = card::kModeFarthest,  ///< one a primary: the largest, then the smallest index
  kAny = card::kModeAny,            ///< one a primary: the first hit in stream order; ends early
  kAll = card::kModeAll,            ///< one a pair, secondary by secondary, primaries ascending
  kHits = card::kModeHits,          ///< those of kAll that hit
  kOccluded = card::kModeOccluded,  ///< one a primary: F alone, that of kAny; no index, point or T.
                                    ///< Ends at the first hit, whichever that is
};

/// "nearest", "farthest", "any", "all", "hits", "occluded".
[[nodiscard]] const char* name_of(Mode mode);
[[nodiscard]] std::optional<Mode> mode_named(std::string_view name);

/// What the card found for a primary, or for a pair.
struct Record {
  Eigen::Vector3f cp = Eigen::Vector3f::Zero();  ///< hit or contact point; 0 if none, NaN if bad
  bool f = false;                                ///< hit
  bool bad = false;           ///< the primary, or in modes all and hits the secondary, is bad input
  std::uint32_t index = ~0u;  ///< secondary, in upload order; all ones if none was found
  float t = std::numeric_limits<float>::infinity();  ///< ray: P(t) is the hit; solids: distance
                                                     ///< (f = 0) or depth (f = 1); +inf if none,
                                                     ///< NaN if bad
  std::uint32_t primary = 0;  ///< its number in the packet, from Board::cast in the whole cast
  Eigen::Vector3f n = Eigen::Vector3f::Zero();  ///< with Query::normals, of solids: unit, from the
                                                ///< pair's first shape to its second
};

/// Bits that differ in nothing: NaN payloads and signs of zero count.
[[nodiscard]] bool same_bits(const Record& a, const Record& b);
/// Names of the fields in which they differ in some bit, as a list "T, CPx"; empty if none.
[[nodiscard]] std::string differing_fields(const Record& a, const Record& b);

/// Takes records as they come off the card, in order, in pieces of any size.
using RecordSink = std::function<void(std::span<const Record>)>;

}  // namespace cde
