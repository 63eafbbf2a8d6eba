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

/// The records of a scene in several number formats, against binary64.
namespace cde::accuracy {

/// Of a query in a frame. The truth is the same pipe's mirror reference in fp64, on the shapes
/// before they are rounded to the format.
struct SceneAccuracy {
  FpFormat format = {};
  std::uint32_t frame = 0;
  std::string query = {};
  std::uint64_t records = 0;  ///< one a primary; in modes all and hits one a pair
  std::uint64_t hits = 0;     ///< of the format
  std::uint64_t refused = 0;  ///< the shapes break the format's input contract: not counted below
  std::uint64_t false_hits = 0, false_misses = 0;
  std::uint64_t other = 0;  ///< both have the same F, but not of the same secondary
  std::uint64_t ties = 0;   ///< the same, and the truth's T of both are within 16 u: not wrong
  ErrorCounts t = {};       ///< of T, of solids the signed gap, where both answer: |T - T'| / |T'|
  std::uint64_t rows = 0;   ///< clocks that the pipe is fed, on the planned card

  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + other; }
};

/// What is asked of the scene.
struct SceneAccuracyOptions {
  std::vector<FpFormat> formats = {};
  std::uint32_t first = 0, last = 0;  ///< frames
  bool quiet = false;
};

/// Frame by frame, of each its formats, of each the queries. Shapes are posed by the host. Error
/// kUsage for a query with an object on both sides.
[[nodiscard]] std::vector<SceneAccuracy> scene_accuracy(const Scene& scene, const Plan& plan,
                                                        const SceneAccuracyOptions& options);

/// `clock_hz` is an assumption, the same for all formats.
[[nodiscard]] nlohmann::ordered_json scene_accuracy_json(const std::vector<SceneAccuracy>& rows,
                                                         double clock_hz);

}  // namespace cde::accuracy
