#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "cde/camera.hpp"
#include "cde/primitives.hpp"

namespace cde {

/// Rays in a row: some that are there, which must outlive this, or those of a picture, each made
/// when it is asked for, so that a picture of any size takes no memory.
class RayView {
 public:
  RayView() : RayView(std::span<const Ray>()) {}
  RayView(std::span<const Ray> rays)  // NOLINT(google-explicit-constructor)
      : rays_(rays), size_(rays.size()) {}
  RayView(const std::vector<Ray>& rays)  // NOLINT(google-explicit-constructor)
      : RayView(std::span(rays)) {}
  RayView(const PixelRays& rays)  // NOLINT(google-explicit-constructor)
      : rays_(rays), size_(rays.size()) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Ray operator[](std::size_t i) const {
    if (const auto* given = std::get_if<std::span<const Ray>>(&rays_)) return (*given)[first_ + i];
    return std::get<PixelRays>(rays_)[first_ + i];
  }
  /// `count` of them from `first` on.
  [[nodiscard]] RayView subview(std::size_t first, std::size_t count) const {
    RayView some = *this;
    some.first_ += first;
    some.size_ = std::min(count, size_ - first);
    return some;
  }
  [[nodiscard]] std::vector<Ray> copy() const {
    std::vector<Ray> rays;
    rays.reserve(size_);
    for (std::size_t i = 0; i < size_; ++i) rays.push_back((*this)[i]);
    return rays;
  }

 private:
  std::variant<std::span<const Ray>, PixelRays> rays_;
  std::size_t first_ = 0, size_;
};

}  // namespace cde
