// SPDX-License-Identifier: Apache-2.0
#include "cde/image/camera.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

constexpr std::uint32_t kMostPixels = 32768;  // per side

void check(Resolution resolution) {
  if (resolution.width < 1 || resolution.width > kMostPixels || resolution.height < 1 ||
      resolution.height > kMostPixels) {
    throw Error(ErrorCode::kUsage,
                fmt::format("a picture of {} x {} pixels: each side must be 1 to {}",
                            resolution.width, resolution.height, kMostPixels));
  }
}

/// Orthonormal view frame in binary64.
struct Frame {
  Eigen::Vector3d right, up, forward;
};

Frame frame_of(const Camera& camera) {
  if (!camera.eye.allFinite() || !camera.target.allFinite() || !camera.up.allFinite()) {
    throw Error(ErrorCode::kUsage, "camera: eye, target and up must be finite");
  }
  if (camera.eye == camera.target)
    throw Error(ErrorCode::kUsage, "camera: eye and target are the same point");
  Frame f;
  f.forward = (camera.target.cast<double>() - camera.eye.cast<double>()).normalized();
  f.right = f.forward.cross(camera.up.cast<double>());
  if (f.right.norm() <= 1e-6 * camera.up.cast<double>().norm()) {
    // Looking straight up or down, or without an up vector: north (+y) is up in the picture. If
    // that is the view direction, +z is up.
    f.right = f.forward.cross(Eigen::Vector3d::UnitY());
    if (f.right.norm() <= 1e-6) f.right = f.forward.cross(Eigen::Vector3d::UnitZ());
  }
  f.right.normalize();
  f.up = f.right.cross(f.forward);
  return f;
}

double half_height(float fov_degrees) {
  if (!(fov_degrees > 0.0f && fov_degrees < 180.0f)) {
    throw Error(ErrorCode::kUsage,
                fmt::format("camera: field of view of {} degrees, must be above 0 and below 180",
                            fov_degrees));
  }
  return std::tan(fov_degrees * std::numbers::pi / 360.0);
}

}  // namespace

Ray PixelRays::operator[](std::size_t pixel) const {
  const auto row = static_cast<std::uint32_t>(pixel / size_.width);
  const auto column = static_cast<std::uint32_t>(pixel % size_.width);
  if (parallel_) {
    const double y = low_.y() + extent_.y() * (size_.height - row - 0.5) / size_.height;
    const double x = low_.x() + extent_.x() * (column + 0.5) / size_.width;
    return {Eigen::Vector3d(x, y, z_).cast<float>(), {0.0f, 0.0f, -1.0f}};
  }
  const double y = half_y_ - (row + 0.5) * pixel_;
  const double x = (column + 0.5 - 0.5 * size_.width) * pixel_;
  return {eye_, (forward_ + x * right_ + y * up_).normalized().cast<float>()};
}

std::vector<Ray> PixelRays::all() const {
  std::vector<Ray> rays;
  rays.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) rays.push_back((*this)[i]);
  return rays;
}

PixelRays Camera::pixels(Resolution resolution) const {
  check(resolution);
  const Frame f = frame_of(*this);
  PixelRays rays;
  rays.size_ = resolution;
  rays.eye_ = eye;
  rays.right_ = f.right, rays.up_ = f.up, rays.forward_ = f.forward;
  rays.half_y_ = half_height(fov_degrees);
  rays.pixel_ = 2.0 * rays.half_y_ / resolution.height;
  return rays;
}

std::vector<Ray> Camera::rays(Resolution resolution) const {
  return pixels(resolution).all();
}

Camera camera_for(const Eigen::AlignedBox3f& box, Resolution resolution) {
  std::vector<Eigen::Vector3f> corners;
  if (!box.isEmpty())
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)));
  return camera_for(corners, resolution);
}

Camera camera_for(std::span<const Eigen::Vector3f> points, Resolution resolution) {
  check(resolution);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  if (box.isEmpty() || !box.sizes().allFinite())
    throw Error(ErrorCode::kUsage, "camera: there is nothing to look at");
  constexpr double kMargin = 1.03;
  const Eigen::Vector3d centre = 0.5 * (box.min().cast<double>() + box.max().cast<double>());
  // The long side of the box points away from the viewer, slightly turned.
  const bool deep = box.sizes().y() >= box.sizes().x();
  const Eigen::Vector3d towards =
      (deep ? Eigen::Vector3d(-0.42, -1.0, 0.72) : Eigen::Vector3d(-1.0, -0.42, 0.72)).normalized();
  Camera camera;
  camera.target = centre.cast<float>();
  camera.eye = (centre + towards * std::max(box.sizes().cast<double>().norm(), 1e-6)).cast<float>();
  const Frame f = frame_of(camera);
  const double half_y = half_height(camera.fov_degrees) / kMargin;
  const double half_x = half_y * resolution.width / resolution.height;
  // A point (x, y, z) of the view frame is seen from distance d, `shift` off the centre. It is in
  // the picture if |x| <= half_x (d + z), and likewise for y. The centring shift depends on d, so
  // both are iterated. Each step at least halves the remaining error.
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  double distance = 0.0;
  const auto view = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
    const Eigen::Vector3d c = point.cast<double>() - centre;
    return {c.dot(f.right) - shift.x(), c.dot(f.up) - shift.y(), c.dot(f.forward)};
  };
  const auto back_off = [&] {
    distance = 0.0;
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d p = view(point);
      distance =
          std::max({distance, std::abs(p.x()) / half_x - p.z(), std::abs(p.y()) / half_y - p.z()});
    }
  };
  for (int pass = 0; pass < 24; ++pass) {
    back_off();
    Eigen::AlignedBox2d seen;
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d p = view(point);
      seen.extend(Eigen::Vector2d(p.head<2>() / (distance + p.z())));
    }
    if (!seen.min().allFinite() || !seen.max().allFinite()) break;  // a single point
    shift += 0.25 * distance * (seen.min() + seen.max());
  }
  back_off();
  if (!(distance > 0.0)) distance = 1.0;  // a single point
  const Eigen::Vector3d target = centre + shift.x() * f.right + shift.y() * f.up;
  camera.target = target.cast<float>();
  camera.eye = (target - distance * f.forward).cast<float>();
  return camera;
}

Camera parse_camera(std::string_view text, std::string_view name) {
  std::array<float, 7> values{};
  values[6] = Camera{}.fov_degrees;
  std::size_t count = 0;
  std::size_t start = 0;
  for (;;) {
    const std::size_t comma = text.find(',', start);
    const std::string_view field =
        text::trim(text.substr(start, comma == std::string_view::npos ? comma : comma - start));
    if (count == values.size()) break;
    if (text::parse_float(field, values[count]) != text::Number::kOk ||
        !std::isfinite(values[count])) {
      throw Error(ErrorCode::kUsage, fmt::format("{}:{}: {} is not a finite number", name,
                                                 start + 1, in_quotes(field)));
    }
    ++count;
    if (comma == std::string_view::npos) {
      start = std::string_view::npos;
      break;
    }
    start = comma + 1;
  }
  if (count < 6 || start != std::string_view::npos) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{}: expected 6 or 7 numbers: ex,ey,ez, tx,ty,tz[,fov]", name));
  }
  Camera camera{{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
  camera.fov_degrees = values[6];
  (void)frame_of(camera);
  (void)half_height(camera.fov_degrees);
  return camera;
}

PixelRays grid_pixels(const Eigen::AlignedBox3f& box, Resolution resolution) {
  check(resolution);
  if (box.isEmpty() || !box.sizes().allFinite())
    throw Error(ErrorCode::kUsage, "grid: there is nothing to look at");
  PixelRays rays;
  rays.size_ = resolution;
  rays.parallel_ = true;
  rays.low_ = box.min().cast<double>();
  rays.extent_ = box.max().cast<double>() - rays.low_;
  rays.z_ = rays.low_.z() + rays.extent_.z() + rays.extent_.maxCoeff();
  return rays;
}

std::vector<Ray> grid_rays(const Eigen::AlignedBox3f& box, Resolution resolution) {
  return grid_pixels(box, resolution).all();
}

Resolution parse_resolution(std::string_view text, std::string_view name) {
  const std::size_t x = text.find_first_of("xX");
  Resolution resolution;
  if (x == std::string_view::npos || !text::parse_int(text.substr(0, x), resolution.width) ||
      !text::parse_int(text.substr(x + 1), resolution.height)) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{}: {} is not WIDTHxHEIGHT", name, in_quotes(text)));
  }
  check(resolution);
  return resolution;
}

}  // namespace cde
