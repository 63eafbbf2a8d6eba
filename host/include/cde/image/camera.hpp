// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde {

/// Size of a picture in pixels. Rays and pixels come row by row, the top row first, left to right.
struct Resolution {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
};

/// The rays of a picture, each computed when it is asked for.
class PixelRays {
 public:
  [[nodiscard]] std::size_t size() const { return size_.pixels(); }
  /// Of a pixel; rows from the top, left to right.
  [[nodiscard]] Ray operator[](std::size_t pixel) const;
  [[nodiscard]] std::vector<Ray> all() const;

 private:
  friend struct Camera;
  friend PixelRays grid_pixels(const Eigen::AlignedBox3f& box, Resolution resolution);
  PixelRays() = default;
  Resolution size_;
  bool parallel_ = false;  // straight down, from a rectangle
  Eigen::Vector3f eye_ = Eigen::Vector3f::Zero();
  Eigen::Vector3d right_, up_, forward_;  // of the view
  double half_y_ = 0, pixel_ = 0;
  Eigen::Vector3d low_, extent_;  // of the box
  double z_ = 0;
};

/// Pinhole camera, world frame.
struct Camera {
  Eigen::Vector3f eye;
  Eigen::Vector3f target;  ///< in the middle of the picture; must differ from eye
  Eigen::Vector3f up =
      Eigen::Vector3f::UnitZ();  ///< upwards in the picture; if along the view, another is chosen
  float fov_degrees = 40.0f;     ///< vertical field of view, 0 < fov < 180

  /// One ray through each pixel centre, of unit direction (within rounding), so that T is the
  /// distance from the eye. Error kUsage if the camera or the resolution makes no sense.
  [[nodiscard]] std::vector<Ray> rays(Resolution resolution) const;
  /// The same, none of them made yet.
  [[nodiscard]] PixelRays pixels(Resolution resolution) const;
};

/// Looks at the points from the south-west and above, as close as shows all of them. Error kUsage
/// if there is none, or one is not finite.
[[nodiscard]] Camera camera_for(std::span<const Eigen::Vector3f> points, Resolution resolution);
/// The same, of a box's corners.
[[nodiscard]] Camera camera_for(const Eigen::AlignedBox3f& box, Resolution resolution);

/// "ex,ey,ez, tx,ty,tz[,fov]": eye, target, vertical field of view in degrees. Error kUsage, with
/// the column.
[[nodiscard]] Camera parse_camera(std::string_view text, std::string_view name = "--camera");

/// Orthographic view straight down (-z): the box is cut into width x height cells, one ray through
/// each centre, the top row at the largest y. Rays start at the height of the box plus its largest
/// extent and have unit direction.
[[nodiscard]] std::vector<Ray> grid_rays(const Eigen::AlignedBox3f& box, Resolution resolution);
/// The same, none of them made yet.
[[nodiscard]] PixelRays grid_pixels(const Eigen::AlignedBox3f& box, Resolution resolution);

/// "WxH", each 1 to 32768. Error kUsage.
[[nodiscard]] Resolution parse_resolution(std::string_view text, std::string_view name = "--size");

}  // namespace cde
