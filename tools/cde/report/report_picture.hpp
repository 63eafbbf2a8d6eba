// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/image/camera.hpp"
#include "cde/image/image.hpp"
#include "report/report_scene.hpp"

/// The still picture of a report: the first view of the 3-D scene, for readers without scripts.
namespace cde::cli {

using Colour = std::array<float, 3>;  ///< linear light, 0 to 1

/// Draws triangles, lines and dots with a depth buffer that is twice as fine as the picture.
class Picture {
 public:
  Picture(const Camera& camera, Resolution size);

  void triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                const Colour& colour);
  void surface(const Surface& surface, const Transform& pose, const Colour& colour);
  void line(const Eigen::Vector3f& from, const Eigen::Vector3f& to, const Colour& colour,
            float opacity);
  void dot(const Eigen::Vector3f& at, const Colour& colour, float radius);  ///< radius in pixels

  [[nodiscard]] Image image() const;

 private:
  struct Seen {
    Eigen::Vector2f at;
    float depth;
  };
  [[nodiscard]] Eigen::Vector3f in_view(const Eigen::Vector3f& point) const;
  [[nodiscard]] Seen project(const Eigen::Vector3f& view) const;
  void pixel(int x, int y, float depth, const Colour& colour, float opacity, bool solid);

  Resolution size_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f eye_;
  float scale_, near_;
  std::vector<Colour> colours_;
  std::vector<float> depths_;
};

/// Unit shapes, which a Placement transforms: ball of radius 1, cube from -1 to 1, cylinder,
/// square.
[[nodiscard]] Surface unit_surface(Drawn drawn);

}  // namespace cde::cli
