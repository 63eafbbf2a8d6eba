// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/convex/candidate_axes.hpp"
#include "cde/reference/pipes/convex/frame.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde::reference {
namespace convex {

/// Two boxes in A's frame: A's centre is 0, its axes are e_i.
template <typename S>
struct BoxPair {
  Vector<S> a, b;                  ///< half extents
  Vector<S> t;                     ///< centre of B
  std::array<Vector<S>, 3> r;      ///< axes of B, right-handed
  std::array<Vector<S>, 3> f;      ///< half edges of B, b_j r_j
  std::array<Vector<S>, 3> signs;  ///< turned axes of B, for their signs
  S tie;                           ///< tie width of signed distances
};

/// 58 add 73 mul.
template <typename S>
[[nodiscard]] BoxPair<S> box_pair(const BasicObb<S>& a, const BasicObb<S>& b) {
  BoxPair<S> pair;
  pair.a = a.half, pair.b = b.half;
  pair.t = to_local<S>(a.rotation, sub<S>(b.c, a.c));
  for (int j = 0; j < 3; ++j) pair.r[j] = to_local<S>(a.rotation, b.rotation.col(j));
  // A box may be given by a reflection. The signs below need a rotation, which gives the same box.
  const S handedness = dot<S>(cross<S>(pair.r[0], pair.r[1]), pair.r[2]);
  for (int k = 0; k < 3; ++k) pair.r[2][k] = move_sign(handedness, pair.r[2][k]);
  for (int j = 0; j < 3; ++j) {
    pair.f[j] = scale<S>(pair.r[j], pair.b[j]);
    pair.signs[j] = turned<S>(pair.r[j]);
  }
  const S extents =
      ((a.half.x() + a.half.y()) + a.half.z()) + ((b.half.x() + b.half.y()) + b.half.z());
  pair.tie = tie_width(norm1<S>(pair.t) + extents);
  return pair;
}

/// B's centre moved to its corner that is nearest in a direction; with index `skip` to the midpoint
/// of the edge along that axis. `sign[j]` has the sign of direction.r_j. 9 or 6 add.
template <typename S>
[[nodiscard]] Vector<S> corner_of_b(const BoxPair<S>& pair, const Vector<S>& sign, int skip = -1) {
  Vector<S> q = pair.t;
  for (int j = 0; j < 3; ++j) {
    if (j == skip) continue;
    const Vector<S>& f = pair.f[j];
    q = sub<S>(q, Vector<S>(move_sign(sign[j], f.x()), move_sign(sign[j], f.y()),
                            move_sign(sign[j], f.z())));
  }
  return q;
}

/// Face i of A, on this side, with the nearest corner of B. 18 add 3 mul, 4 min/max.
template <typename S>
[[nodiscard]] CandidateAxis<S> face_of_a(const BoxPair<S>& pair, int i, S side) {
  const Vector<S> across(pair.f[0][i], pair.f[1][i], pair.f[2][i]);
  const S separation = (magnitude(pair.t[i]) - pair.a[i]) - norm1<S>(across);
  const Vector<S> sign(move_sign(side, pair.signs[0][i]), move_sign(side, pair.signs[1][i]),
                       move_sign(side, pair.signs[2][i]));
  return face_axis<S>(i, pair.a, side, corner_of_b<S>(pair, sign), separation);
}

/// Edge i of A and edge j of B.
template <typename S>
[[nodiscard]] CandidateAxis<S> edges(const BoxPair<S>& pair, int i, int j, S inverse_ff) {
  const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, o = (j + 2) % 3;
  const EdgeNormal<S> n = edge_normal<S>(i, pair.f[j]);
  const S h = project<S>(i, n, pair.t);
  const int first = i == 0 ? 1 : 0, second = i == 2 ? 1 : 2;  // the axes k and l in order
  const S n_first = i == 1 ? n.l : n.k, n_second = i == 1 ? n.k : n.l;
  const S side = side_of(h, pair.tie,
                         select(kBeyond<S> < magnitude(n_first), move_sign(pair.t[first], n_first),
                                move_sign(pair.t[second], n_second)));
  const S on_a = magnitude(n.k) * pair.a[k] + magnitude(n.l) * pair.a[l];
  const Vector<S> on_b(project<S>(i, n, pair.f[0]), project<S>(i, n, pair.f[1]),
                       project<S>(i, n, pair.f[2]));
  const S separation = (magnitude(h) - on_a) - norm1<S>(on_b);
  // n = e_i x r_j, so n.e_k = -r_jl, n.e_l = r_jk, n.r_m = r_oi and n.r_o = -r_mi.
  Vector<S> sign_a, sign_b;
  sign_a[i] = S{0};
  sign_a[k] = move_sign(side, -pair.signs[j][l]);
  sign_a[l] = move_sign(side, pair.signs[j][k]);
  sign_b[j] = S{0};
  sign_b[m] = move_sign(side, pair.signs[o][i]);
  sign_b[o] = move_sign(side, -pair.signs[m][i]);
  return edge_axis<S>(i, pair.a, sign_a, corner_of_b<S>(pair, sign_b, j), pair.f[j], S{-1},
                      inverse_ff, n, side, separation);
}

/// The pair in B's frame, roles exchanged. 6 add 18 mul.
template <typename S>
[[nodiscard]] BoxPair<S> seen_from_b(const BoxPair<S>& pair) {
  BoxPair<S> back;
  back.a = pair.b, back.b = pair.a, back.tie = pair.tie;
  for (int j = 0; j < 3; ++j) {
    back.t[j] = -dot<S>(pair.r[j], pair.t);
    back.r[j] = Vector<S>(pair.r[0][j], pair.r[1][j], pair.r[2][j]);
    back.f[j] = scale<S>(back.r[j], back.b[j]);
    back.signs[j] = Vector<S>(pair.signs[0][j], pair.signs[1][j], pair.signs[2][j]);
  }
  return back;
}

/// An axis of the exchanged pair in A's frame; its witness on A is a corner of A. 24 add 12 mul, 4
/// min/max.
template <typename S>
[[nodiscard]] CandidateAxis<S> face_of_b(const BoxPair<S>& pair, const BoxPair<S>& back, int j) {
  // The side on which A is; the normal points the other way.
  const S side = side_of(back.t[j], pair.tie, -along<S>(pair.t, pair.r[j]));
  CandidateAxis<S> axis = face_of_a<S>(back, j, side);
  const Vector<S> v = axis.x.v;
  for (int i = 0; i < 3; ++i) {
    const Vector<S> row(pair.r[0][i], pair.r[1][i], pair.r[2][i]);
    axis.x.v[i] = -dot<S>(row, v);
    axis.x.p[i] = -move_sign(side, move_sign(pair.signs[j][i], pair.a[i]));
    axis.n[i] = -move_sign(side, pair.r[j][i]);
  }
  return axis;
}

/// All fifteen candidate axes: faces of A, faces of B, edges (0,0), (0,1), ... (2,2).
template <typename S>
[[nodiscard]] std::array<CandidateAxis<S>, 15> box_axes(const BoxPair<S>& pair) {
  std::array<CandidateAxis<S>, 15> axes;
  const BoxPair<S> back = seen_from_b<S>(pair);
  for (int i = 0; i < 3; ++i) {
    axes[i] = face_of_a<S>(pair, i, pair.t[i]);
    axes[3 + i] = face_of_b<S>(pair, back, i);
  }
  for (int j = 0; j < 3; ++j) {
    const S ff = pair.b[j] * pair.b[j];
    const S inverse_ff = reciprocal_or_zero<S>(usable(ff), ff);
    for (int i = 0; i < 3; ++i) axes[6 + 3 * i + j] = edges<S>(pair, i, j, inverse_ff);
  }
  return axes;
}

/// The corner of B minus the corner of A that is farthest against v. 18 add 9 mul.
template <typename S>
[[nodiscard]] Difference<S> box_support(const BoxPair<S>& pair, const Vector<S>& v) {
  const Vector<S> on_b(dot<S>(v, pair.f[0]), dot<S>(v, pair.f[1]), dot<S>(v, pair.f[2]));
  const Vector<S> p = corner<S>(v, pair.a);
  return {sub<S>(corner_of_b<S>(pair, on_b), p), p};
}

/// OBB against OBB, in A's frame. The difference of two boxes has 15 pairs of facets, whose normals
/// are the 15 axes of the separating-axis test. The depth is the least overlap on them. The
/// distance is the least distance to the 15 facets that face the origin. 638 add 568 mul 15 div 10
/// sqrt.
template <typename S>
[[nodiscard]] Outcome<S> obb_obb(const BasicObb<S>& a, const BasicObb<S>& b) {
  const BoxPair<S> pair = box_pair(a, b);
  const SignedDistance<S> result =
      answer<S>(box_axes<S>(pair), pair.a, pair.tie,
                [&](const Vector<S>& v) { return box_support<S>(pair, v); });
  return outcome<S>(result.s, add<S>(a.c, to_world<S>(a.rotation, midpoint(result.x))),
                    to_world<S>(a.rotation, result.n));
}

}  // namespace convex

/// OBB A against OBB B; see convex::obb_obb.
template <typename S>
[[nodiscard]] Outcome<S> obb_obb(const BasicObb<S>& a, const BasicObb<S>& b) {
  return at_size_one<S>(a, b, [](const auto& x, const auto& y) { return convex::obb_obb(x, y); });
}

}  // namespace cde::reference
