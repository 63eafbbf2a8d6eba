// SPDX-License-Identifier: Apache-2.0
#include "fcl.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>

#include <unistd.h>

#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>

#include "cde/support/process.hpp"

namespace cde::oracle {
namespace {

using Object = fcl::CollisionObjectd;

constexpr double kCore = 1e-6;  // share of a sphere's radius that FCL gets

double taken_off(const Shape& shape) {
  const auto* sphere = std::get_if<Sphere>(&shape);
  return sphere ? (1 - kCore) * sphere->r : 0;
}

Object placed(std::shared_ptr<fcl::CollisionGeometryd> geometry, const Eigen::Matrix3d& rotation,
              const Vec& center) {
  return Object(std::move(geometry), rotation, center);
}

struct ToObject {
  std::optional<Object> operator()(const Sphere& s) const {
    return placed(std::make_shared<fcl::Sphered>(kCore * s.r), Eigen::Matrix3d::Identity(), s.c);
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
  std::optional<Object> operator()(const auto&) const { return std::nullopt; }
};

std::optional<double> fcl_signed_distance(const Shape& a, const Shape& b) {
  const auto object_a = std::visit(ToObject{}, a), object_b = std::visit(ToObject{}, b);
  if (!object_a || !object_b) return std::nullopt;
  const double off = taken_off(a) + taken_off(b);
  fcl::DistanceRequestd request;
  request.enable_signed_distance = off == 0;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = 1e-9 * scene_size(a, b);
  fcl::DistanceResultd result;
  try {
    fcl::distance(&*object_a, &*object_b, request, result);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  if (off > 0 && result.min_distance <= 0) return std::nullopt;
  return result.min_distance - off;
}

/// Answers the pairs from `first` on in a child process, until the end or its death.
void answer_in_child(const std::vector<std::pair<Shape, Shape>>& pairs, std::size_t first,
                     std::vector<std::optional<double>>& answers) {
  const process::Result ran = process::run_isolated([&](int out) {
    close(STDERR_FILENO);  // the assertion's message
    for (std::size_t i = first; i < pairs.size(); ++i) {
      const auto answer = fcl_signed_distance(pairs[i].first, pairs[i].second);
      const double value = answer.value_or(std::numeric_limits<double>::quiet_NaN());
      if (write(out, &value, sizeof value) != sizeof value) _exit(1);
    }
  });
  for (std::size_t at = 0; at + sizeof(double) <= ran.output.size(); at += sizeof(double)) {
    double value = 0;
    std::memcpy(&value, ran.output.data() + at, sizeof value);
    answers.push_back(std::isnan(value) ? std::nullopt : std::optional(value));
  }
}

}  // namespace

std::vector<std::optional<double>> fcl_signed_distances(
    const std::vector<std::pair<Shape, Shape>>& pairs) {
  std::vector<std::optional<double>> answers;
  while (answers.size() < pairs.size()) {
    answer_in_child(pairs, answers.size(), answers);
    if (answers.size() < pairs.size()) answers.emplace_back();  // the pair that ended it
  }
  return answers;
}

}  // namespace cde::oracle
