#include "cde/primitives.hpp"

#include <fmt/format.h>

#include <cmath>

#include "cde/error.hpp"

namespace cde {
namespace {

std::optional<std::string> not_finite(const char* field, const Eigen::Vector3f& v) {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(v[i])) return fmt::format("{}.{} is {}", field, "xyz"[i], v[i]);
  }
  return std::nullopt;
}

template <typename Primitive>
void check_any(const Primitive& primitive, std::string_view what) {
  if (const auto why = defect(primitive)) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: {}", what, *why));
  }
}

}  // namespace

std::optional<std::string> defect(const Ray& ray) {
  if (auto why = not_finite("origin", ray.o)) return why;
  if (auto why = not_finite("direction", ray.d)) return why;
  if (ray.d.x() == 0.0f && ray.d.y() == 0.0f && ray.d.z() == 0.0f) return "direction is zero";
  if (std::isnan(ray.tmin)) return "tmin is nan";
  if (std::isnan(ray.tmax)) return "tmax is nan";
  return std::nullopt;
}

std::optional<std::string> defect(const Triangle& triangle) {
  if (auto why = not_finite("v0", triangle.v0)) return why;
  if (auto why = not_finite("v1", triangle.v1)) return why;
  return not_finite("v2", triangle.v2);
}

void check(const Ray& ray, std::string_view what) {
  check_any(ray, what);
}
void check(const Triangle& triangle, std::string_view what) {
  check_any(triangle, what);
}

}  // namespace cde
