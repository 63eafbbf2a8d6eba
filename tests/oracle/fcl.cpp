#include "fcl.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>

#include <exception>
#include <memory>

namespace cde::oracle {
namespace {

using Object = fcl::CollisionObjectd;

Object placed(std::shared_ptr<fcl::CollisionGeometryd> geometry, const Eigen::Matrix3d& rotation,
              const Vec& center) {
  return Object(std::move(geometry), rotation, center);
}

struct ToObject {
  std::optional<Object> operator()(const Sphere& s) const {
    return placed(std::make_shared<fcl::Sphered>(s.r), Eigen::Matrix3d::Identity(), s.c);
  }
  std::optional<Object> operator()(const Aabb& s) const {
    return placed(std::make_shared<fcl::Boxd>(s.max - s.min), Eigen::Matrix3d::Identity(),
                  (s.min + s.max) / 2);
  }
  std::optional<Object> operator()(const Obb& s) const {
    return placed(std::make_shared<fcl::Boxd>(2 * s.half), s.rotation, s.c);
  }
  std::optional<Object> operator()(const Cylinder& s) const {
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec::UnitZ(), s.axis);
    return placed(std::make_shared<fcl::Cylinderd>(s.radius, 2 * s.half_height),
                  turn.toRotationMatrix(), s.c);
  }
  /// A convex body with a front and a back.
  std::optional<Object> operator()(const Triangle& s) const {
    const Vec c = (s.v0 + s.v1 + s.v2) / 3;
    auto vertices =
        std::make_shared<const std::vector<Vec>>(std::vector<Vec>{s.v0 - c, s.v1 - c, s.v2 - c});
    auto faces = std::make_shared<const std::vector<int>>(std::vector<int>{3, 0, 1, 2, 3, 0, 2, 1});
    return placed(std::make_shared<fcl::Convexd>(vertices, 2, faces), Eigen::Matrix3d::Identity(),
                  c);
  }
  std::optional<Object> operator()(const Plane&) const { return std::nullopt; }
};

}  // namespace

std::optional<double> fcl_signed_distance(const Shape& a, const Shape& b) {
  const auto object_a = std::visit(ToObject{}, a), object_b = std::visit(ToObject{}, b);
  if (!object_a || !object_b) return std::nullopt;
  fcl::DistanceRequestd request;
  const bool ball = std::holds_alternative<Sphere>(a) || std::holds_alternative<Sphere>(b);
  request.enable_signed_distance = !ball;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = 1e-9 * scene_size(a, b);
  fcl::DistanceResultd result;
  try {
    fcl::distance(&*object_a, &*object_b, request, result);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  if (ball && result.min_distance < 0) return std::nullopt;
  return result.min_distance;
}

}  // namespace cde::oracle
