// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/obb_plane.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_plane.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"
#include "cde/reference/pipes/cylinder/pairs.hpp"
#include "cde/reference/pipes/distance_bound.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "cde/support/error.hpp"

/// @file
/// Selects the reference of a pair by its number.
namespace cde::reference {

/// The first and second shape of a pair.
template <class A, class B>
struct Kinds {};

/// Settings that a pair's result depends on, beside its shapes.
struct PipeSettings {
  bool box = false;
  PlaneSide plane = PlaneSide::kSurface;
  cylinder::Iterations iterations;
};

/// The mirror reference of shapes A and B. It is a function pointer, so that its users are compiled
/// once per pair of shapes.
template <class S, class A, class B>
struct PipeMirror {
  Outcome<S> (*answer)(const A&, const B&, const PipeSettings&);
  PipeSettings settings;
  Outcome<S> operator()(const A& a, const B& b) const { return answer(a, b, settings); }
};

/// A pipe's result, with the box rule if `box` is set.
template <class S, class A, class B>
[[nodiscard]] Outcome<S> bounded_if(bool box, const Outcome<S>& pipe, const A& a, const B& b) {
  return box ? bounded<S>(pipe, a, b) : pipe;
}

/// Calls `use(Kinds<A, B>, test)`, where test(A, B) is the pair's mirror reference in the scalar S.
template <class S, class Use>
void with_pair(Pair pair, Algorithm algorithm, bool box, PlaneSide plane,
               const PairIterations& work, Use use) {
  using R = BasicRay<S>;
  using T = BasicTriangle<S>;
  using Ball = BasicSphere<S>;
  using Box = BasicObb<S>;
  using Can = BasicCylinder<S>;
  const PipeSettings settings{
      box,
      plane,
      {static_cast<int>(work.samples), static_cast<int>(work.circle), static_cast<int>(work.free)}};
// FUNCTION is a template's name, which parentheses would spoil.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define CDE_ANSWER(A, B, ANSWER)                                                             \
  use(Kinds<A, B>(),                                                                         \
      PipeMirror<S, A, B>{[](const A& x, const B& y, [[maybe_unused]] const PipeSettings& s) \
                              -> Outcome<S> { return ANSWER; },                              \
                          settings})
#define CDE_TEST(A, B, FUNCTION) CDE_ANSWER(A, B, FUNCTION<S>(x, y))
#define CDE_SEARCH(A, FUNCTION) CDE_ANSWER(A, Can, FUNCTION<S>(x, y, s.iterations))
#define CDE_PLANE(A, FUNCTION) CDE_ANSWER(A, BasicPlane<S>, FUNCTION<S>(x, y, s.plane))
#define CDE_BOUND(A, B, FUNCTION) CDE_ANSWER(A, B, bounded_if<S>(s.box, FUNCTION<S>(x, y), x, y))
  // NOLINTEND(bugprone-macro-parentheses)
  switch (pair) {
    case Pair::kRayTriangle:
      return use(Kinds<R, T>(), ray_triangle_test<S>(algorithm, box));
    case Pair::kObbObb:
      return CDE_BOUND(Box, Box, obb_obb);
    case Pair::kTriangleAabb:
      return CDE_BOUND(T, BasicAabb<S>, triangle_aabb);
    case Pair::kTriangleObb:
      return CDE_BOUND(T, Box, triangle_obb);
    case Pair::kSphereSphere:
      return CDE_TEST(Ball, Ball, sphere_sphere);
    case Pair::kTriangleSphere:
      return CDE_BOUND(T, Ball, triangle_sphere);
    case Pair::kTriangleTriangle:
      return CDE_BOUND(T, T, triangle_triangle);
    case Pair::kRayCylinder:
      return CDE_TEST(R, Can, ray_cylinder);
    case Pair::kObbPlane:
      return CDE_PLANE(Box, obb_plane);
    case Pair::kSpherePlane:
      return CDE_PLANE(Ball, sphere_plane);
    case Pair::kRaySphere:
      return CDE_TEST(R, Ball, ray_sphere);
    case Pair::kSphereObb:
      return CDE_BOUND(Ball, Box, sphere_obb);
    case Pair::kTriangleCylinder:
      return CDE_SEARCH(T, triangle_cylinder);
    case Pair::kCylinderCylinder:
      return CDE_SEARCH(Can, cylinder_cylinder);
    case Pair::kObbCylinder:
      return CDE_SEARCH(Box, obb_cylinder);
  }
#undef CDE_BOUND
#undef CDE_PLANE
#undef CDE_SEARCH
#undef CDE_TEST
#undef CDE_ANSWER
  throw Error(ErrorCode::kUsage, fmt::format("no reference for {}", name(pair)));
}

}  // namespace cde::reference
