// SPDX-License-Identifier: Apache-2.0
#include "convex_operators.hpp"

#include <stdexcept>

#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/obb_plane.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_plane.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"

namespace cde::testing {
namespace {

template <class P>
P any() {
  std::array<Counted, P::kWords> words;
  words.fill(Counted(0.5));
  return from_words<P>(words);
}

/// References are straight-line code: the operators are those of any operands.
template <template <class> class A, template <class> class B, class Pipe>
Tally count(Pipe pipe) {
  const auto a = any<A<Counted>>();
  const auto b = any<B<Counted>>();
  Counted::tally = {};
  (void)pipe(a, b);
  return Counted::tally;
}

}  // namespace

std::vector<Pair> convex_pairs() {
  std::vector<Pair> all;
  for (unsigned p = 0; p < kPairs; ++p)
    if (const auto pair = static_cast<Pair>(p); is_solid(pair) && !has_budget(pair))
      all.push_back(pair);
  return all;
}

Tally convex_operators(Pair pair) {
  namespace convex = reference::convex;
  switch (pair) {
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
    default:
      throw std::logic_error("not a convex pair with a closed form");
  }
}

}  // namespace cde::testing
