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

/// Size of a picture in pixels. Rays and pixels are ordered row by row, top row first, left to
/// right.
struct Resolution {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
};

/// The rays of a picture. Each is computed on access.
class PixelRays {
 public:
  [[nodiscard]] std::size_t size() const { return size_.pixels(); }
  /// Ray of a pixel, in the order of Resolution.
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
  Eigen::Vector3f target;                         ///< centre of the picture; must differ from eye
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();  ///< upwards in the picture; if parallel to the
                                                  ///< view, another vector is chosen
  float fov_degrees = 40.0f;                      ///< vertical field of view, 0 < fov < 180

  /// One ray through each pixel centre, of unit direction (within rounding), so that T is the
  /// distance from the eye. Error kUsage if the camera or the resolution is invalid.
  [[nodiscard]] std::vector<Ray> rays(Resolution resolution) const;
  /// The same, computed on access.
  [[nodiscard]] PixelRays pixels(Resolution resolution) const;
};

/// Looks at the points from the south-west and above, as close as possible with all of them in
/// view. Error kUsage if there is no point, or one is not finite.
[[nodiscard]] Camera camera_for(std::span<const Eigen::Vector3f> points, Resolution resolution);
/// The same for the corners of a box.
[[nodiscard]] Camera camera_for(const Eigen::AlignedBox3f& box, Resolution resolution);

/// Parses "ex,ey,ez, tx,ty,tz[,fov]": eye, target, vertical field of view in degrees. Error kUsage,
/// with the column.
[[nodiscard]] Camera parse_camera(std::string_view text, std::string_view name = "--camera");

/// Orthographic view straight down (-z). The box is divided into width x height cells with one ray
/// through each centre. The top row has the largest y. Rays start at the top of the box plus its
/// largest extent and have unit direction.
[[nodiscard]] std::vector<Ray> grid_rays(const Eigen::AlignedBox3f& box, Resolution resolution);
/// The same, computed on access.
[[nodiscard]] PixelRays grid_pixels(const Eigen::AlignedBox3f& box, Resolution resolution);

/// Parses "WxH", each 1 to 32768. Error kUsage.
[[nodiscard]] Resolution parse_resolution(std::string_view text, std::string_view name = "--size");

}  // namespace cde
