// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "cde/oracle/cases.hpp"

namespace cde::oracle {
namespace {

constexpr double k15Degrees = std::numbers::pi / 12;

Frame about(const Vec& axis, int steps_of_15_degrees) {
  // Quarter turns are exact: people write 0, not 6e-17.
  const auto exact = [](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; };
  const Frame turn = Eigen::AngleAxisd(steps_of_15_degrees * k15Degrees, axis).toRotationMatrix();
  return turn.unaryExpr(exact);
}

/// Lying on a side or standing, then turned about z, and sometimes leaning.
Frame posture(Random& random) {
  const Frame side = random.chance(0.5) ? Frame(Frame::Identity()) : random.quarter_turns();
  const Frame turn = turn_of_15_degrees(random);
  return turn * side;
}

/// A body around the origin.
Shape body(Random& random, ShapeKind kind) {
  const Frame frame = posture(random);
  const double x = grid_length(random), y = grid_length(random), z = grid_length(random);
  return with_kind(kind, [&]<class S>() -> Shape {
    if constexpr (requires { S::body(random, frame, Vec(x, y, z)); })
      return S::body(random, frame, Vec(x, y, z));
    else
      throw std::invalid_argument("a body of a scene is a solid or a triangle");
  });
}

Vec grid_point(Random& random, int reach) {
  const auto draw = [&] { return kGrid * (random.below(2 * reach + 1) - reach); };
  const double x = draw(), y = draw();
  return {x, y, 0};
}

/// The shape with its lowest point at this height.
Shape at_rest(const Shape& shape, double height) {
  return moved(shape, (height + support(shape, -Vec::UnitZ())) * Vec::UnitZ());
}

Shape put(Random& random, const Shape& shape, const Scene& scene) {
  std::vector<const Shape*> others;
  for (const Body& other : scene)
    if (other.kind != ShapeKind::kPlane) others.push_back(&other.shape);
  const double choice = random.unit();
  const Vec anywhere = grid_point(random, 16);
  const bool sinks = random.chance(0.3);
  const double sunk = kGrid * (1 + random.below(4));
  if (others.empty() || choice < 0.25) return at_rest(moved(shape, anywhere), sinks ? -sunk : 0);

  const Shape& other =
      *others[static_cast<std::size_t>(random.below(static_cast<int>(others.size())))];
  const Vec c = center(other);
  const Vec across(c.x(), c.y(), 0);
  const Vec aside = random.chance(0.4) ? Vec(Vec::Zero()) : grid_point(random, 3);
  if (choice < 0.65) {
    const double top = support(other, Vec::UnitZ());
    return at_rest(moved(shape, across + aside), sinks ? top - sunk : top);
  }
  const Vec n = random.flipped(Vec::Unit(random.below(2)));  // beside it, on the same ground
  const double ground = -support(other, -Vec::UnitZ());
  const Shape level = at_rest(moved(shape, across + aside - n.dot(aside) * n), ground);
  const double distance = support(other, n) + support(level, -n) - (sinks ? sunk : 0);
  return moved(level, distance * n);
}

Plane flat_ground(Random& random) {
  const double kind = random.unit();
  if (kind < 0.6) return {Vec::UnitZ(), 0};
  const Vec wall = random.flipped(Vec::Unit(random.below(2)));
  if (kind < 0.8) return {wall, kGrid * (random.below(17) - 8)};
  const int axis = random.below(2), steps = 1 + random.below(4);
  return {about(Vec::Unit(axis), steps).col(2), 0};
}

double apart(const Shape& a, const Shape& b) {
  if (const auto* plane = std::get_if<Plane>(&b))
    return std::abs(plane->n.dot(center(a)) - plane->d);
  return (center(a) - center(b)).norm();
}

}  // namespace

double half_width_along(const Shape& shape, const Vec& n) {
  return support(shape, n) - n.dot(center(shape));
}

Frame turn_of_15_degrees(Random& random) {
  const int steps = random.chance(0.5) ? 6 * random.below(4) : random.below(24);
  const Frame turn = about(Vec::UnitZ(), steps);
  if (!random.chance(0.15)) return turn;
  const int axis = random.below(2), lean = 1 + random.below(11);
  return turn * about(Vec::Unit(axis), lean);
}

Scene make_scene(Random& random, const std::vector<ShapeKind>& wanted) {
  using enum ShapeKind;
  static constexpr std::array kKinds = {kObb, kObb, kCylinder, kSphere, kTriangle, kAabb};
  std::vector<ShapeKind> kinds = wanted;
  const int more = 1 + random.below(4);
  for (int k = 0; k < more; ++k)
    kinds.push_back(kKinds[static_cast<std::size_t>(random.below(kKinds.size()))]);
  for (std::size_t k = kinds.size() - 1; k > 0; --k)
    std::swap(kinds[k], kinds[static_cast<std::size_t>(random.below(static_cast<int>(k) + 1))]);
  Scene scene = {{kPlane, flat_ground(random)}};
  for (const ShapeKind kind : kinds) {
    if (kind == kPlane) continue;
    const Shape shape = body(random, kind);
    scene.push_back({kind, put(random, shape, scene)});
  }
  return scene;
}

std::pair<Shape, Shape> neighbours(Random& random, const Scene& scene, ShapeKind a, ShapeKind b) {
  std::vector<std::pair<const Shape*, const Shape*>> pairs;
  for (const Body& x : scene)
    for (const Body& y : scene)
      if (x.kind == a && y.kind == b && &x != &y) pairs.emplace_back(&x.shape, &y.shape);
  if (pairs.empty()) throw std::invalid_argument("the scene has no such pair");
  const auto nearer = [](const auto& p, const auto& q) {
    return apart(*p.first, *p.second) < apart(*q.first, *q.second);
  };
  const auto any = static_cast<std::size_t>(random.below(static_cast<int>(pairs.size())));
  const auto nearest = *std::min_element(pairs.begin(), pairs.end(), nearer);
  const auto& chosen = random.chance(0.75) ? nearest : pairs[any];
  return {*chosen.first, *chosen.second};
}

Shape any_of(Random& random, const Scene& scene, ShapeKind kind) {
  std::vector<const Shape*> all;
  for (const Body& body : scene)
    if (body.kind == kind) all.push_back(&body.shape);
  if (all.empty()) throw std::invalid_argument("the scene has no such body");
  return *all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))];
}

}  // namespace cde::oracle
