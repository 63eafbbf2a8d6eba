// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "cde/fp/fp.hpp"
#include "cde/geometry/primitives.hpp"

/// @file
/// The operators of the pipes. The mirror references use nothing else. They are +, -, *, / of
/// scalars (rtl/fp/fp_add.sv, fp_mul.sv, fp_div.sv), the comparisons <, <=, == (fp_cmp.sv, false
/// when an operand is NaN), and the functions below. Each operator rounds once. A function marked
/// as a wire costs no operator: it moves, flips or selects bits.
///
/// Code that includes a mirror must be compiled without contraction (-ffp-contract=off): an FMA
/// rounds once where the hardware rounds twice. The scalar S is float, double or `Fp<E, M>`. A test
/// may use its own counting scalar, found by argument-dependent look-up.
namespace cde::reference {

template <typename S>
using Vector = Vector3<S>;

/// Result type of a comparison of S: bool, or a counting scalar's own type. Combine masks with &&
/// || !, which are wires on lane masks. Both sides are always computed.
template <typename S>
using Mask = decltype(std::declval<S>() < std::declval<S>());

/// Unit roundoff u = 2^-(M+1) of a format with M fraction bits: the largest relative error of one
/// operation that neither overflows nor underflows. 2^-24 in fp32.
template <typename S>
inline constexpr double kUnitRoundoff = static_cast<double>(std::numeric_limits<S>::epsilon()) / 2;

/// The card's one NaN: positive, quiet, no payload.
template <typename S>
[[nodiscard]] constexpr S canonical_nan() {
  return std::numeric_limits<S>::quiet_NaN();
}

/// Wire at the output of a pipe: any NaN becomes the canonical one. The operators of the RTL do
/// this themselves when CANON = 1.
template <typename S>
[[nodiscard]] constexpr S canonical(S x) {
  return x == x ? x : canonical_nan<S>();
}

/// Wire: +0 instead of -0, other values unchanged.
template <typename S>
[[nodiscard]] constexpr S no_minus_zero(S x) {
  return x == S(0) ? S(0) : x;
}

/// Result of a pipe for one pair. A miss of a ray is T = +inf, CP = 0. Rays have no normal.
template <typename S>
struct Outcome {
  bool f = false;                            ///< the shapes meet
  bool bad = false;                          ///< an operand is out of contract (check.hpp)
  S t = std::numeric_limits<S>::infinity();  ///< ray parameter, or distance or depth
  Vector<S> cp = Vector<S>::Zero();          ///< contact point, world frame
  Vector<S> n = Vector<S>::Zero();           ///< unit normal from A to B, world frame
};

/// The result for bad input: F = 0, every other field the canonical NaN.
template <typename S>
[[nodiscard]] Outcome<S> bad_outcome() {
  const S nan = canonical_nan<S>();
  return {false, true, nan, Vector<S>::Constant(nan), Vector<S>::Constant(nan)};
}

/// Wire: a where the mask is set, else b. The value not selected may be anything, NaN included.
template <typename S>
[[nodiscard]] constexpr S select(Mask<S> mask, S a, S b) {
  return mask ? a : b;
}
template <typename S>
[[nodiscard]] Vector<S> select(Mask<S> mask, const Vector<S>& a, const Vector<S>& b) {
  return {select(mask, a.x(), b.x()), select(mask, a.y(), b.y()), select(mask, a.z(), b.z())};
}

/// Wire: the sign bit cleared, also of zeros and NaN.
template <typename S>
[[nodiscard]] constexpr S magnitude(S x) {
  using std::abs;
  return abs(x);
}

/// Wire: the sign bit as a mask, also set for -0.
template <typename S>
[[nodiscard]] constexpr Mask<S> is_negative(S x) {
  using std::signbit;
  return signbit(x);
}

/// Wire: y with its sign bit exclusive-ored with the sign bit of x, also for zeros. The operand x
/// is the result of an operator, so a NaN counts as positive, whatever sign the host's arithmetic
/// gives it.
template <typename S>
[[nodiscard]] constexpr S move_sign(S x, S y) {
  using std::signbit;
  return signbit(x) && x == x ? -y : y;
}

/// fp_sqrt.sv
template <typename S>
[[nodiscard]] S square_root(S x) {
  using std::sqrt;
  return sqrt(x);
}

/// minimumNumber of IEEE 754-2019 (fp_minmax.sv): a number beats a NaN, -0 is below +0.
template <typename S>
[[nodiscard]] constexpr S min_num(S a, S b) {
  using std::signbit;
  const bool a_below = a < b || (a == b && signbit(a));
  return canonical(a_below || b != b ? a : b);
}

/// maximumNumber of IEEE 754-2019 (fp_minmax.sv with MAX = 1).
template <typename S>
[[nodiscard]] constexpr S max_num(S a, S b) {
  using std::signbit;
  const bool b_below = b < a || (a == b && signbit(b));
  return canonical(b_below || b != b ? a : b);
}

/// x limited to low .. high: max, then min (fp_minmax.sv twice). A NaN gives low.
template <typename S>
[[nodiscard]] constexpr S clamp(S x, S low, S high) {
  return min_num(max_num(x, low), high);
}

/// a x b, each component the difference of two rounded products (rtl/vector/vec_cross.sv: 6 mul,
/// 3 sub). Exchanging a and b flips the signs and nothing else.
template <typename S>
[[nodiscard]] Vector<S> cross(const Vector<S>& a, const Vector<S>& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// (x u + y v) + z w (rtl/vector/vec_dot.sv: 3 mul, 2 add). Eigen adds in another order.
template <typename S>
[[nodiscard]] S dot(const Vector<S>& a, const Vector<S>& b) {
  return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z();
}

/// a + b, a - b (rtl/vector/vec_add.sv: 3 add or sub) and s a (rtl/vector/vec_scale.sv: 3 mul).
template <typename S>
[[nodiscard]] Vector<S> add(const Vector<S>& a, const Vector<S>& b) {
  return {a.x() + b.x(), a.y() + b.y(), a.z() + b.z()};
}
template <typename S>
[[nodiscard]] Vector<S> sub(const Vector<S>& a, const Vector<S>& b) {
  return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z()};
}
template <typename S>
[[nodiscard]] Vector<S> scale(const Vector<S>& a, S s) {
  return {a.x() * s, a.y() * s, a.z() * s};
}

}  // namespace cde::reference
