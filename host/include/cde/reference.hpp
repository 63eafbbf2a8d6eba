#pragma once
#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "cde/board.hpp"
#include "cde/primitives.hpp"

/// Mirror reference: what the card computes, operation by operation in the same order with the same
/// roundings, so that every bit must match. The library is compiled without contraction; whoever
/// includes the template must do the same (-ffp-contract=off), as an FMA rounds once where the
/// hardware rounds twice.
namespace cde::reference {

/// The card's one NaN: positive, quiet, no payload.
template <typename S>
[[nodiscard]] constexpr S canonical_nan() {
  if constexpr (sizeof(S) == 4) {
    return std::bit_cast<S>(std::uint32_t{0x7fc00000});
  } else {
    return std::bit_cast<S>(std::uint64_t{0x7ff8000000000000});
  }
}

template <typename S>
[[nodiscard]] constexpr S canonical(S x) {
  return x != x ? canonical_nan<S>() : x;
}

template <typename S>
using Vector = Eigen::Matrix<S, 3, 1>;

/// What the pipe answers for one pair.
template <typename S>
struct Outcome {
  bool f = false;
  bool bad = false;
  S t = std::numeric_limits<S>::infinity();
  Vector<S> cp = Vector<S>::Zero();
};

/// y gets the sign bit of x moved onto it by exclusive or; also of zeros and NaN.
template <typename S>
[[nodiscard]] S move_sign(S x, S y) {
  using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits kSign = Bits{1} << (8 * sizeof(S) - 1);
  return std::bit_cast<S>(std::bit_cast<Bits>(y) ^ (std::bit_cast<Bits>(x) & kSign));
}

/// a x b, each component the difference of two rounded products (rtl/vector/vec_cross.sv).
template <typename S>
[[nodiscard]] Vector<S> cross(const Vector<S>& a, const Vector<S>& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// (x u + y v) + z w (rtl/vector/vec_dot.sv). Eigen adds in another order.
template <typename S>
[[nodiscard]] S dot(const Vector<S>& a, const Vector<S>& b) {
  return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z();
}

/// Ray against triangle after Möller and Trumbore 1997, as in rtl/pipes/ray_triangle_moller.sv:
/// two-sided, one division, u, v and u+v compared with det unscaled. NaN fails every comparison.
template <typename S>
[[nodiscard]] Outcome<S> ray_triangle_moller(const Vector<S>& o, const Vector<S>& d, S tmin, S tmax,
                                             const Vector<S>& v0, const Vector<S>& v1,
                                             const Vector<S>& v2) {
  Outcome<S> r;
  r.bad = !o.allFinite() || !d.allFinite() || (d.x() == 0 && d.y() == 0 && d.z() == 0) ||
          std::isnan(tmin) || std::isnan(tmax) || !v0.allFinite() || !v1.allFinite() ||
          !v2.allFinite();
  if (r.bad) {
    r.t = canonical_nan<S>();
    r.cp.setConstant(r.t);
    return r;
  }
  const Vector<S> e1 = v1 - v0, e2 = v2 - v0, tv = o - v0;
  const Vector<S> p = cross<S>(d, e2), q = cross<S>(tv, e1);
  const S det = dot<S>(p, e1), u = dot<S>(p, tv), v = dot<S>(q, d), tn = dot<S>(q, e2);
  const S uv = u + v;
  const S size = std::abs(det);
  const S us = move_sign(det, u), vs = move_sign(det, v), uvs = move_sign(det, uv);
  const bool inside =
      S{0} <= us && us <= size && S{0} <= vs && vs <= size && uvs <= size && S{0} < size;
  const S t = tn / det;
  if (inside && tmin <= t && t <= tmax) {
    r.f = true;
    r.t = t;
    for (int k = 0; k < 3; ++k) r.cp[k] = canonical<S>(o[k] + t * d[k]);
  }
  return r;
}

/// The same for one pair of the card, as the record that mode all writes.
[[nodiscard]] Record record_of(const Ray& ray, const Triangle& triangle, std::uint32_t primary,
                               std::uint32_t index);

/// The records of a cast, computed in software; see Board::cast. Fast enough for large scenes (the
/// misses, nearly all pairs, are sorted out by vector code), the hits go through the template.
class Sweep {
 public:
  /// Up to `packet` rays meet all triangles at a time. Rays and triangles must outlive the sweep.
  Sweep(std::span<const Ray> rays, const TriangleView& triangles, Mode mode,
        const Stencil& stencil = {}, unsigned packet = 256);
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  /// The next records in the card's order; empty at the end. Valid until the next call.
  [[nodiscard]] std::span<const Record> next();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// All of them at once.
[[nodiscard]] std::vector<Record> cast(std::span<const Ray> rays, const TriangleView& triangles,
                                       Mode mode = Mode::kNearest, const Stencil& stencil = {});

/// Compares records of the card with the reference as they arrive.
class Checker {
 public:
  /// `command` is the start of a command that repeats the query, e.g. "cde cast terrain --lanes
  /// 16". Rays and triangles must outlive the checker.
  Checker(std::span<const Ray> rays, const TriangleView& triangles, Mode mode,
          const Stencil& stencil, unsigned packet, std::string command);

  /// Throws kMismatch at the first record that differs in a bit: its inputs in hexfloat, both
  /// outputs, and the command that repeats it.
  void check(std::span<const Record> records);

  /// Throws kMismatch if the reference has more records than were checked.
  void finish();

  [[nodiscard]] std::uint64_t compared() const { return compared_; }

 private:
  [[noreturn]] void mismatch(const Record* card, const Record* expected) const;
  std::span<const Ray> rays_;
  TriangleView triangles_;
  Sweep sweep_;
  std::span<const Record> pending_;
  std::uint64_t compared_ = 0;
  std::string command_;
};

}  // namespace cde::reference
