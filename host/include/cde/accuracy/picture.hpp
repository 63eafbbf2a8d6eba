// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "cde/accuracy/tally.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

/// Pictures of a mesh, as a pipe sees it and as it is.
namespace cde::accuracy {

/// Pixels of one pipe against exact arithmetic.
struct PixelCounts {
  std::uint64_t false_hits = 0, false_misses = 0;
  std::uint64_t other = 0;  ///< another triangle is nearest, beyond the band
  std::uint64_t ties = 0;   ///< another one, within the band: not wrong
  ErrorCounts depth;        ///< |T - exact T| over exact T, where both hit
  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + other; }
};

/// What a pixel of a pipe is, against the mesh as it is given.
enum class PixelKind : std::uint8_t { kNothing, kRight, kFalseHit, kFalseMiss, kOther };

/// Where in space a wrong pixel is: at what is there, or where the pipe sees something.
struct WrongPoint {
  PixelKind kind = PixelKind::kFalseHit;
  Eigen::Vector3f at;
};

struct PictureAccuracy {
  AccuracyPipe pipe;
  std::uint64_t rays = 0, hits = 0, triangles = 0;
  std::uint64_t refused = 0;      ///< triangles that the input contract does not allow
  int scaled_by = 0;              ///< all lengths times this power of two, to fit the format
  PixelCounts of_scene;           ///< against the mesh and the rays as they are given
  std::vector<PixelKind> pixels;  ///< of_scene's, a ray each
  std::vector<WrongPoint> wrong;  ///< of them those that are
  PixelCounts of_words;           ///< against both as they are rounded to the format
};

/// Nearest hits of all rays, by each pipe's mirror reference and by exact arithmetic. Pipes are of
/// ray-triangle. A pixel is within the band if the triangle is met within a displacement of 16 u of
/// the ray's RayAnswer::scale and T is as near.
[[nodiscard]] std::vector<PictureAccuracy> picture_accuracy(const Mesh& mesh,
                                                            std::span<const Ray> rays,
                                                            const std::vector<AccuracyPipe>& pipes,
                                                            bool quiet);

[[nodiscard]] nlohmann::ordered_json picture_json(const std::vector<PictureAccuracy>& rows);

}  // namespace cde::accuracy
