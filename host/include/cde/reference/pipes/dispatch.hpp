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
#include "cde/reference/pipes/gap_bound.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "cde/support/error.hpp"

/// From a pair's number to its reference.
namespace cde::reference {

/// The shapes that a pair tests, first and second.
template <class A, class B>
struct Kinds {};

/// Calls use(Kinds<A, B>, test), where test(A, B) is the pair's mirror reference in the scalar S.
template <class S, class Use>
void with_pair(Pair pair, Algorithm algorithm, bool box, PlaneSide plane, const PairBudget& work,
               Use use) {
  using R = BasicRay<S>;
  using T = BasicTriangle<S>;
  using Ball = BasicSphere<S>;
  using Box = BasicObb<S>;
  using Can = BasicCylinder<S>;
  const cylinder::Budget budget{static_cast<int>(work.samples), static_cast<int>(work.circle),
                                static_cast<int>(work.free)};
// FUNCTION is a template's name, which parentheses would spoil.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define CDE_SEARCH(A, FUNCTION) \
  use(Kinds<A, Can>(), [budget](const A& x, const Can& y) { return FUNCTION<S>(x, y, budget); })
#define CDE_TEST(A, B, FUNCTION) \
  use(Kinds<A, B>(), [](const A& x, const B& y) { return FUNCTION<S>(x, y); })
#define CDE_BOUND(A, B, FUNCTION)                                                       \
  box ? use(Kinds<A, B>(),                                                              \
            [](const A& x, const B& y) { return bounded<S>(FUNCTION<S>(x, y), x, y); }) \
      : CDE_TEST(A, B, FUNCTION)
#define CDE_PLANE(A, FUNCTION)   \
  use(Kinds<A, BasicPlane<S>>(), \
      [plane](const A& x, const BasicPlane<S>& y) { return FUNCTION<S>(x, y, plane); })
  // NOLINTEND(bugprone-macro-parentheses)
  switch (pair) {
    case Pair::kRayTriangle:
      return with_ray_triangle<S>(algorithm, box, [&use](auto test) { use(Kinds<R, T>(), test); });
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
#undef CDE_PLANE
#undef CDE_BOUND
#undef CDE_TEST
#undef CDE_SEARCH
  throw Error(ErrorCode::kUsage, fmt::format("no reference for {}", name(pair)));
}

}  // namespace cde::reference
