// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cde/accuracy/error_counts.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// @file
/// Records of a scene in several number formats, compared with binary64.
namespace cde::accuracy {

/// Results of a query in a frame. The truth is the same pipe's mirror reference in fp64, on the
/// shapes before rounding to the format.
struct SceneAccuracy {
  FpFormat format = {};
  std::uint32_t frame = 0;
  std::string query = {};
  std::uint64_t records = 0;  ///< one per primary; in modes all and hits one per pair
  std::uint64_t hits = 0;     ///< in the format
  std::uint64_t refused = 0;  ///< shapes that break the format's input contract: not counted below
  std::uint64_t false_hits = 0, false_misses = 0;
  std::uint64_t other = 0;  ///< both have the same F, but for different secondaries
  std::uint64_t ties = 0;   ///< like `other`, but the true T of both agree within 16 u: not wrong
  /// |T - T'| / |T'| where both have a result; for solids of the signed distance.
  ErrorCounts t = {};
  std::uint64_t rows = 0;  ///< cycles in which rows enter the pipe, on the planned card

  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + other; }
};

/// What to measure.
struct SceneAccuracyOptions {
  std::vector<FpFormat> formats = {};
  std::uint32_t first = 0, last = 0;  ///< frames
  bool quiet = false;
};

/// Results frame by frame, then by format, then by query. The host poses shapes. Error kUsage for a
/// query with an object on both sides.
[[nodiscard]] std::vector<SceneAccuracy> scene_accuracy(const Scene& scene, const Plan& plan,
                                                        const SceneAccuracyOptions& options);

/// `clock_hz` is assumed, the same for all formats.
[[nodiscard]] nlohmann::ordered_json scene_accuracy_json(const std::vector<SceneAccuracy>& rows,
                                                         double clock_hz);

}  // namespace cde::accuracy
