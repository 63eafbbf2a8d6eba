// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "cde/reference/filter/proof.hpp"
#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"

/// @file
/// The proposal of a narrow pipe for a pair in a wide format (proof.hpp,
/// `rtl/filter/filter_proposal.sv`).
namespace cde::reference::filter {

/// The pipe of a pair of solids without an iterative pipeline (has_filter). Its operands are
/// unchecked: a narrowed shape may be invalid, for instance with a size of zero. The operators'
/// result is then proposed nevertheless.
struct FreePipe {
  template <class A, class B, typename S = typename A::Scalar>
  Outcome<S> operator()(const A& a, const B& b) const {
    return scaled_answer<S>(a, b, [](const auto& x, const auto& y) {
      if constexpr (kShapeOf<A> == Shape::kObb)
        return convex::obb_obb(x, y);
      else if constexpr (kShapeOf<B> == Shape::kAabb)
        return convex::triangle_aabb(x, y);
      else if constexpr (kShapeOf<A> == Shape::kTriangle && kShapeOf<B> == Shape::kObb)
        return convex::triangle_obb(x, y);
      else if constexpr (kShapeOf<A> == Shape::kTriangle)
        return convex::triangle_sphere(x, y);
      else if constexpr (kShapeOf<B> == Shape::kObb)
        return convex::sphere_obb(x, y);
      else
        return convex::sphere_sphere(x, y);
    });
  }
};

/// The words of a shape relative to `o`, times 2^-k, each rounded to the narrow scalar N.
template <class N, template <class> class P, typename S>
[[nodiscard]] P<N> narrowed(const P<S>& shape, const Vector<S>& o, int k) {
  std::array<N, P<S>::kWords> words;
  std::size_t i = 0;
  visit_words(shape, [&](const char*, int axis, S x) {
    const WordKind kind = scaling::kind<P<S>>(i);
    if (kind == WordKind::kCoordinate) x = x - o[axis % 3];
    if (scaling::is_length(kind)) x = times_power_of_two(x, -k);
    words[i++] = N(x);
  });
  return from_words<P<N>>(words);
}

/// Functions pull() move a point towards the inside of a shape. They clamp p to the shape reduced
/// by `by` on all sides, but to no less than half its size.
template <class N>
N smaller(N size, N by) {
  return max_num(size - by, size * convex::kHalf<N>);
}
/// v, shortened to length `most`.
template <class N>
Vector<N> limited(const Vector<N>& v, N most) {
  const N vv = dot<N>(v, v);
  return vv <= most * most ? v : scale<N>(v, most / square_root(vv));
}
template <class N>
Vector<N> pull(const BasicSphere<N>& x, const Vector<N>& p, N by) {
  return add<N>(x.c, limited<N>(sub<N>(p, x.c), smaller(x.r, by)));
}
template <class N>
Vector<N> pull(const BasicObb<N>& x, const Vector<N>& p, N by) {
  Vector<N> q = convex::to_local<N>(x.rotation, sub<N>(p, x.c));
  for (int i = 0; i < 3; ++i) {
    const N end = smaller(x.half[i], by);
    q[i] = clamp<N>(q[i], -end, end);
  }
  return add<N>(x.c, convex::to_world<N>(x.rotation, q));
}
template <class N>
Vector<N> pull(const BasicAabb<N>& x, Vector<N> p, N by) {
  for (int i = 0; i < 3; ++i) {
    const N in = min_num(by, (x.max[i] - x.min[i]) * N(0.25));
    p[i] = clamp<N>(p[i], x.min[i] + in, x.max[i] - in);
  }
  return p;
}
template <class N>
Vector<N> pull(const BasicCylinder<N>& x, const Vector<N>& p, N by) {
  const Vector<N> q = sub<N>(p, x.c);
  const N along = dot<N>(x.axis, q), end = smaller(x.half_height, by);
  const Vector<N> across = limited<N>(sub<N>(q, scale<N>(x.axis, along)), smaller(x.radius, by));
  return add<N>(x.c, add<N>(across, scale<N>(x.axis, clamp<N>(along, -end, end))));
}

/// Weights of v1 and v2 for a point of a triangle near p: least squares, limited to the triangle.
/// 21 mul, 23 add and sub, 2 div.
template <class N>
std::array<N, 2> weights(const BasicTriangle<N>& t, const Vector<N>& p) {
  const Vector<N> e1 = sub<N>(t.v1, t.v0), e2 = sub<N>(t.v2, t.v0), w = sub<N>(p, t.v0);
  const N d11 = dot<N>(e1, e1), d12 = dot<N>(e1, e2), d22 = dot<N>(e2, e2);
  const N w1 = dot<N>(e1, w), w2 = dot<N>(e2, w), det = d11 * d22 - d12 * d12;
  const N i = clamp<N>((d22 * w1 - d12 * w2) / det, N(0), N(1));
  return {i, clamp<N>((d11 * w2 - d12 * w1) / det, N(0), N(1) - i)};
}
template <class N>
Vector<N> pull(const BasicTriangle<N>& t, const Vector<N>& p, N) {
  const auto [i, j] = weights(t, p);
  return add<N>(t.v0, add<N>(scale<N>(sub<N>(t.v1, t.v0), i), scale<N>(sub<N>(t.v2, t.v0), j)));
}

/// Runs test(A, B) in N on the shapes, moved to A's origin and scaled to about 1. CP may lie on the
/// boundary of both bodies, where nothing is certain. It is therefore pulled inside by a quarter of
/// the depth.
template <class N, template <class> class A, template <class> class B, typename S, class Test>
[[nodiscard]] Proposal<S> propose(const A<S>& a, const B<S>& b, Test test) {
  const Body<A<S>> body(a);
  const Vector<S> o = body.origin;
  constexpr int kLeast = scaling::kBias<S> + kLengths<S>.low;
  const int k =
      std::max(stored_exponent(size_of_pair(body, Body<B<S>>(b))), kLeast) - scaling::kBias<S>;
  const A<N> x = narrowed<N, A, S>(a, o, k);
  const B<N> y = narrowed<N, B, S>(b, o, k);
  const Outcome<N> r = test(x, y);
  Vector<N> p = r.cp;
  const N by = r.t * N(0.25);
  if (r.f) p = pull(x, pull(y, p, by), by);
  const auto wide = [](N v) { return S(static_cast<float>(v)); };
  Proposal<S> claim;
  for (int i = 0; i < 3; ++i) {
    claim.n[i] = wide(r.n[i]);
    claim.point[i] = times_power_of_two(wide(p[i]), k);
  }
  if constexpr (kShapeOf<A<S>> == Shape::kTriangle) {
    const auto [i, j] = weights(x, p);
    claim.weight = {wide(i), wide(j)};
  }
  return claim;
}

}  // namespace cde::reference::filter
