// SPDX-License-Identifier: Apache-2.0
#include "operators.hpp"

#include <stdexcept>

#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/obb_plane.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_plane.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"

namespace cde::testing {
namespace {

template <class P>
P any() {
  std::array<Counted, P::kWords> words;
  words.fill(Counted(0.5));
  return from_words<P>(words);
}

/// References are straight-line code: any operands give the same operators.
template <template <class> class A, template <class> class B, class Pipe>
Tally count(Pipe pipe) {
  const auto a = any<A<Counted>>();
  const auto b = any<B<Counted>>();
  Counted::tally = {};
  (void)pipe(a, b);
  return Counted::tally;
}

Tally of_ray_triangle(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::kMoller:
      return count<BasicRay, BasicTriangle>([](const auto& ray, const auto& triangle) {
        return reference::ray_triangle_moller<Counted, false, true>(ray, triangle);
      });
    case Algorithm::kBadouel:
      return count<BasicRay, BasicTriangle>(reference::ray_triangle_badouel<Counted, false, true>);
    case Algorithm::kPluecker:
      return count<BasicRay, BasicTriangle>(reference::ray_triangle_pluecker<Counted, false, true>);
    case Algorithm::kWatertight:
      return count<BasicRay, BasicTriangle>(
          reference::ray_triangle_watertight<Counted, false, true>);
  }
  throw std::logic_error("not an algorithm of ray-triangle");
}

}  // namespace

Tally operators(Pair pair, Algorithm algorithm) {
  namespace convex = reference::convex;
  switch (pair) {
    case Pair::kRayTriangle:
      return of_ray_triangle(algorithm);
    case Pair::kRaySphere:
      return count<BasicRay, BasicSphere>(reference::ray_sphere<Counted, true>);
    case Pair::kRayCylinder:
      return count<BasicRay, BasicCylinder>(reference::ray_cylinder<Counted, true>);
    case Pair::kSphereSphere:
      return count<BasicSphere, BasicSphere>(convex::sphere_sphere<Counted>);
    case Pair::kTriangleSphere:
      return count<BasicTriangle, BasicSphere>(convex::triangle_sphere<Counted>);
    case Pair::kSphereObb:
      return count<BasicSphere, BasicObb>(convex::sphere_obb<Counted>);
    case Pair::kObbPlane:
      return count<BasicObb, BasicPlane>([](const auto& a, const auto& b) {
        return convex::obb_plane(a, b, PlaneSide::kSurface);
      });
    case Pair::kSpherePlane:
      return count<BasicSphere, BasicPlane>([](const auto& a, const auto& b) {
        return convex::sphere_plane(a, b, PlaneSide::kSurface);
      });
    case Pair::kObbObb:
      return count<BasicObb, BasicObb>(convex::obb_obb<Counted>);
    case Pair::kTriangleObb:
      return count<BasicTriangle, BasicObb>(convex::triangle_obb<Counted>);
    case Pair::kTriangleAabb:
      return count<BasicTriangle, BasicAabb>(convex::triangle_aabb<Counted>);
    case Pair::kTriangleTriangle:
      return count<BasicTriangle, BasicTriangle>(convex::triangle_triangle<Counted>);
    default:
      throw std::logic_error("a pair with iterations has no closed form");
  }
}

}  // namespace cde::testing
