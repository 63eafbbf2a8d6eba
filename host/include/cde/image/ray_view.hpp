// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/image/camera.hpp"

namespace cde {

/// Rays as two arrays of vectors (x, y, z), with any distance in bytes from one vector to the next.
/// All rays have one interval.
struct StridedRays {
  const float *origins = nullptr, *directions = nullptr;
  std::ptrdiff_t origin_step = 3 * sizeof(float), direction_step = 3 * sizeof(float);
  std::size_t count = 0;
  float tmin = 0, tmax = std::numeric_limits<float>::infinity();

  [[nodiscard]] Ray operator[](std::size_t i) const {
    return {vector(origins, origin_step, i), vector(directions, direction_step, i), tmin, tmax};
  }

 private:
  static Eigen::Vector3f vector(const float* first, std::ptrdiff_t step, std::size_t i) {
    const char* at = reinterpret_cast<const char*>(first) + step * static_cast<std::ptrdiff_t>(i);
    Eigen::Vector3f v;
    std::memcpy(v.data(), at, 3 * sizeof(float));
    return v;
  }
};

/// A sequence of rays. Either they are stored elsewhere and must outlive the view, or they are
/// the rays of a picture. A picture's rays are computed on access, so its size needs no memory.
class RayView {
 public:
  RayView() : RayView(std::span<const Ray>()) {}
  RayView(std::span<const Ray> rays)  // NOLINT(google-explicit-constructor)
      : rays_(rays), size_(rays.size()) {}
  RayView(const std::vector<Ray>& rays)  // NOLINT(google-explicit-constructor)
      : RayView(std::span(rays)) {}
  RayView(const PixelRays& rays)  // NOLINT(google-explicit-constructor)
      : rays_(rays), size_(rays.size()) {}
  RayView(const StridedRays& rays)  // NOLINT(google-explicit-constructor)
      : rays_(rays), size_(rays.count) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Ray operator[](std::size_t i) const {
    Ray ray = std::visit([&](const auto& rays) { return rays[first_ + i]; }, rays_);
    if (turn_) {
      ray.o = (*turn_)(ray.o);
      ray.d = (*turn_)(ray.d);
    }
    return ray;
  }
  /// `count` rays from `first` on.
  [[nodiscard]] RayView subview(std::size_t first, std::size_t count) const {
    RayView some = *this;
    some.first_ += first;
    some.size_ = std::min(count, size_ - first);
    return some;
  }
  /// The same with `turn` applied to origins and directions.
  [[nodiscard]] RayView turned(std::function<Eigen::Vector3f(const Eigen::Vector3f&)> turn) const {
    RayView other = *this;
    if (turn_) {
      turn = [first = turn_, second = std::move(turn)](const Eigen::Vector3f& v) {
        return second((*first)(v));
      };
    }
    other.turn_ = std::make_shared<const Turn>(std::move(turn));
    return other;
  }
  [[nodiscard]] std::vector<Ray> copy() const {
    std::vector<Ray> rays;
    rays.reserve(size_);
    for (std::size_t i = 0; i < size_; ++i) rays.push_back((*this)[i]);
    return rays;
  }

 private:
  using Turn = std::function<Eigen::Vector3f(const Eigen::Vector3f&)>;
  std::variant<std::span<const Ray>, PixelRays, StridedRays> rays_;
  std::size_t first_ = 0, size_;
  std::shared_ptr<const Turn> turn_;
};

}  // namespace cde
