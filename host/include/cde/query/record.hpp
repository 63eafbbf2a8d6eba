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

/// Which records a pass keeps. For rays only hits count. For solids every pair has a signed
/// distance: the distance apart, or minus the penetration depth. T is its absolute value.
enum class Mode : std::uint8_t {
  /// One per primary: the smallest (T or signed distance, then index).
  kNearest = card::kModeNearest,
  kFarthest = card::kModeFarthest,  ///< one per primary: the largest, then the smallest index
  kAny = card::kModeAny,            ///< one per primary: the first hit in stream order; ends early
  kAll = card::kModeAll,            ///< one per pair, secondary by secondary, primaries ascending
  kHits = card::kModeHits,          ///< the hits of kAll
  kOccluded = card::kModeOccluded,  ///< one per primary: F of kAny, without index, point or T. Ends
                                    ///< at any first hit
};

/// "nearest", "farthest", "any", "all", "hits", "occluded".
[[nodiscard]] const char* name_of(Mode mode);
[[nodiscard]] std::optional<Mode> mode_named(std::string_view name);

/// Result of the card for a primary, or for a pair.
struct Record {
  Eigen::Vector3f cp = Eigen::Vector3f::Zero();  ///< hit or contact point; 0 if none, NaN if bad
  bool f = false;                                ///< hit
  bool bad = false;           ///< the primary is bad input; in modes all and hits, the secondary
  std::uint32_t index = ~0u;  ///< secondary, in upload order; all ones if none was found
  /// ray: P(t) is the hit; solids: distance (f = 0) or depth (f = 1); +inf if none, NaN if bad.
  float t = std::numeric_limits<float>::infinity();
  /// Number of the primary in the packet; from Board::cast in the whole cast.
  std::uint32_t primary = 0;
  Eigen::Vector3f n = Eigen::Vector3f::Zero();  ///< with Query::normals, for solids: unit, from the
                                                ///< pair's first shape to its second
};

/// Whether all bits agree, NaN payloads and signs of zero included.
[[nodiscard]] bool same_bits(const Record& a, const Record& b);
/// Names of the fields that differ in some bit, as a list "T, CPx"; empty if none do.
[[nodiscard]] std::string differing_fields(const Record& a, const Record& b);

/// Receives records in the order of the card, in pieces of any size.
using RecordSink = std::function<void(std::span<const Record>)>;

}  // namespace cde
