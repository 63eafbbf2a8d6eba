// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

/// @file
/// Pictures of a mesh, as a pipe computes them and in exact arithmetic.
namespace cde::accuracy {

/// Pixels of one pipe compared with exact arithmetic.
struct PixelCounts {
  std::uint64_t false_hits = 0, false_misses = 0;
  std::uint64_t other = 0;  ///< another triangle is nearest, outside the band
  std::uint64_t ties = 0;   ///< another triangle is nearest, within the band: not wrong
  ErrorCounts depth;        ///< |T - exact T| over exact T, if both hit
  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + other; }
};

/// Classification of a pipe's pixel, against the given mesh.
enum class PixelKind : std::uint8_t { kNothing, kRight, kFalseHit, kFalseMiss, kOther };

/// Position of a wrong pixel: the exact hit, or the pipe's hit if there is none.
struct WrongPoint {
  PixelKind kind = PixelKind::kFalseHit;
  Eigen::Vector3f at;
};

struct PictureAccuracy {
  AccuracyPipe pipe;
  std::uint64_t rays = 0, hits = 0, triangles = 0;
  std::uint64_t refused = 0;  ///< triangles that the input contract refuses
  int scaled_by = 0;          ///< all lengths are scaled by this power of two, to fit the format
  PixelCounts of_scene;       ///< against the given mesh and rays
  std::vector<PixelKind> pixels;  ///< pixels of of_scene, one per ray
  std::vector<WrongPoint> wrong;  ///< the wrong pixels of of_scene
  PixelCounts of_words;           ///< against mesh and rays rounded to the format
};

/// Nearest hits of all rays, by each pipe's mirror reference and by exact arithmetic. Pipes must be
/// ray-triangle. A pixel is within the band if a displacement of 16 u of the ray's RayAnswer::scale
/// lets it hit the triangle, and T agrees equally well.
[[nodiscard]] std::vector<PictureAccuracy> picture_accuracy(const Mesh& mesh,
                                                            std::span<const Ray> rays,
                                                            const std::vector<AccuracyPipe>& pipes,
                                                            bool quiet);

[[nodiscard]] nlohmann::ordered_json picture_json(const std::vector<PictureAccuracy>& rows);

}  // namespace cde::accuracy
