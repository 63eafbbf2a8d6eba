// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "cde/geometry/rounded.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/reference/pipes/convex/frame.hpp"

/// @file
/// Results of the card's transformer (rtl/transform/transformer.sv). Points become R p + t,
/// directions R d without a sum (-0 stays). Intervals, radii and extents are unchanged. The input
/// contract (check.hpp) is checked on the result: it can overflow, and the corners of a distant box
/// can coincide.
namespace cde::reference {

/// R p + t: 9 mul 9 add.
template <typename S>
[[nodiscard]] Vector<S> transformed_point(const BasicTransform<S>& m, const Vector<S>& p) {
  return add<S>(convex::to_world<S>(m.rotation, p), m.translation);
}

/// Transforms field by field: points, directions, unit vectors, and the columns of a rotation.
template <typename P>
[[nodiscard]] P transformed(const BasicTransform<typename P::Scalar>& m, P x) {
  using S = typename P::Scalar;
  visit_fields(x, [&m](const char*, WordKind kind, auto& field) {
    if constexpr (std::is_same_v<decltype(field), Matrix3<S>&>) {
      for (int k = 0; k < 3; ++k) field.col(k) = convex::to_world<S>(m.rotation, field.col(k));
    } else if constexpr (std::is_same_v<decltype(field), Vector<S>&>) {
      if (kind == WordKind::kCoordinate) field = transformed_point<S>(m, field);
      if (kind == WordKind::kDirection || kind == WordKind::kPure)
        field = convex::to_world<S>(m.rotation, field);
    }
  });
  return x;
}

/// n' = R n, d' = d + n'.t: 12 mul 9 add.
template <typename S>
[[nodiscard]] BasicPlane<S> transformed(const BasicTransform<S>& m, const BasicPlane<S>& x) {
  const Vector<S> n = convex::to_world<S>(m.rotation, x.n);
  return {n, x.d + dot<S>(n, m.translation)};
}

/// Translation only: the card refuses an object of AABBs whose rotation is not the identity.
template <typename S>
[[nodiscard]] BasicAabb<S> transformed(const BasicTransform<S>& m, const BasicAabb<S>& x) {
  return {add<S>(x.min, m.translation), add<S>(x.max, m.translation)};
}

/// Transforms in a number format no wider than fp32: words are rounded to it and moved in its
/// arithmetic.
template <class P>
[[nodiscard]] P transformed_in(FpFormat format, const Transform& m, const P& x) {
  if (format == FpFormat{}) return transformed(m, x);
  P moved = x;
  with_scalar(format, [&]<class S>() {
    moved = primitive_cast<float>(transformed(primitive_cast<S>(m), primitive_cast<S>(x)));
  });
  return moved;
}

/// Primitives as a pass tests them, and the slot of each.
template <typename P>
struct PassSecondaries {
  std::vector<P> shapes;
  std::vector<std::uint32_t> slots;
};

/// Secondaries in the order of a brute-force pass: the range of each object in turn, transformed;
/// without objects all of them unmoved. Ranges must lie within `shapes`, a span, vector or
/// TriangleView.
template <typename Shapes>
[[nodiscard]] auto pass_secondaries(const Shapes& shapes, std::span<const Object> objects,
                                    FpFormat format = {}) {
  PassSecondaries<std::remove_cvref_t<decltype(shapes[0])>> all;
  for (const Object& object : objects) {
    for (std::uint32_t i = object.first; i < object.first + object.count; ++i) {
      all.shapes.push_back(transformed_in(format, object.transform, shapes[i]));
      all.slots.push_back(i);
    }
  }
  for (std::uint32_t i = 0; objects.empty() && i < shapes.size(); ++i) {
    all.shapes.push_back(rounded(shapes[i], format));
    all.slots.push_back(i);
  }
  return all;
}

/// Primaries in the register file after posing. Those in no object are unmoved; if several objects
/// have a primary, the last one counts.
template <typename P>
[[nodiscard]] std::vector<P> posed(std::span<const P> shapes, std::span<const Object> objects,
                                   FpFormat format = {}) {
  std::vector<P> all;
  for (const P& shape : shapes) all.push_back(rounded(shape, format));
  for (const Object& object : objects)
    for (std::uint32_t i = object.first; i < object.first + object.count; ++i)
      all[i] = transformed_in(format, object.transform, shapes[i]);
  return all;
}

}  // namespace cde::reference
