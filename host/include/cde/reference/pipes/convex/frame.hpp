// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/geometry/ops.hpp"

/// @file
/// Transforms between the world and a box's frame. The matrix's columns are the box axes.
namespace cde::reference::convex {

/// U x: 6 add 9 mul.
template <typename S>
[[nodiscard]] Vector<S> to_world(const Matrix3<S>& u, const Vector<S>& x) {
  return {dot<S>(Vector<S>(u(0, 0), u(0, 1), u(0, 2)), x),
          dot<S>(Vector<S>(u(1, 0), u(1, 1), u(1, 2)), x),
          dot<S>(Vector<S>(u(2, 0), u(2, 1), u(2, 2)), x)};
}

/// U^T x: 6 add 9 mul.
template <typename S>
[[nodiscard]] Vector<S> to_local(const Matrix3<S>& u, const Vector<S>& x) {
  return {dot<S>(u.col(0), x), dot<S>(u.col(1), x), dot<S>(u.col(2), x)};
}

}  // namespace cde::reference::convex
