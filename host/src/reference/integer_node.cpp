// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/integer_node.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace cde::reference {
namespace {

using bvh::Child;
using bvh::Node;
using Whole = std::int64_t;

// ---- Floats as whole numbers ----

/// significand 2^exponent, exactly. The exponent of a subnormal number is the least one.
struct Parts {
  Whole significand;
  int exponent;
};
constexpr int kFloatFraction = 23, kFloatBias = 127;
Parts parts(float x) {
  const auto word = std::bit_cast<std::uint32_t>(x);
  const int field = static_cast<int>(word >> kFloatFraction & 0xff);
  const Whole size = (word & 0x7fffff) | (field != 0 ? 0x800000 : 0);
  return {std::signbit(x) ? -size : size, std::max(field, 1) - kFloatBias - kFloatFraction};
}
/// The exponent of the first significant bit of a normal number; 128 for infinity.
int exponent_of(float x) {
  return parts(x).exponent + kFloatFraction;
}

/// A number of steps between two whole numbers.
struct Steps {
  Whole floor;
  bool exact;
  [[nodiscard]] Whole ceil() const { return floor + (exact ? 0 : 1); }
};
/// size 2^exponent in steps of 2^step, limited to -2^bits to 2^bits - 1.
Steps steps(Whole size, int exponent, int step, int bits) {
  const Whole most = (Whole{1} << bits) - 1, least = -most - 1;
  const int up = exponent - step;
  if (up >= 0) {
    if (size == 0) return {0, true};
    if (up > bits || size > most >> up || size < least >> up)
      return {size > 0 ? most : least, true};
    return {size * (Whole{1} << up), true};
  }
  const int down = std::min(-up, 62);  // sizes are below 2^62
  const Whole floor = size >> down;
  if (floor > most || floor < least) return {floor > 0 ? most : least, true};
  return {floor, floor * (Whole{1} << down) == size};
}
/// The difference of two numbers, exactly. The first may be infinite.
Steps difference(float a, float b, int step, int bits) {
  if (std::isinf(a)) return {a > 0 ? (Whole{1} << bits) - 1 : -(Whole{1} << bits), true};
  Parts x = parts(a), y = parts(-b);
  if (x.exponent < y.exponent) std::swap(x, y);
  // Beyond 36 places the smaller number is less than a step, or the difference exceeds the limits.
  // Only its sign counts.
  constexpr int kPlaces = 36;
  const int apart = x.exponent - y.exponent;
  if (apart > kPlaces) y.significand = (y.significand > 0) - (y.significand < 0);
  const int places = std::min(apart, kPlaces);
  return steps(x.significand * (Whole{1} << places) + y.significand, x.exponent - places, step,
               bits);
}

// ---- The node for one ray ----

/// Planes of byte 0 on one axis, and the T of a byte step, in steps of the axis.
struct AxisPlanes {
  Whole near, far;            ///< without meaning if unbounded
  Whole near_unit, far_unit;  ///< rounded down and up
  bool no_near, no_far;       ///< unbounded
  bool negative;
};

struct NodePlanes {
  TimeScale scale;
  std::array<AxisPlanes, 3> axes;
};

NodePlanes planes_of(const IntegerRay& ray, const Node& node, const IntegerFormat& format) {
  constexpr int kByte = 8;
  // A margin has a scale of its own only if four of it exceed the node.
  constexpr int kMargin = 2;
  const int unit_bits = format.unit_bits, bound_bits = unit_bits + 9;
  const Eigen::Vector3f origin = node.origin();
  Vector<float> corner;
  std::array<int, 3> range{};  // the larger of 256 units and of 4 margins: its exponent
  int lo = 0;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<unsigned>(k);
    const float from_origin = origin[k] - ray.o[k];
    corner[k] = from_origin * ray.inverse[k];
    range[axis] = std::max(exponent_of(ray.inverse[k]) + node.exponent(k) + kByte,
                           exponent_of(ray.margin[k]) + kMargin);
    if (range[axis] < range[static_cast<unsigned>(lo)]) lo = k;
  }
  NodePlanes front;
  const int step = range[static_cast<unsigned>(lo)] - kByte - format.step_bits;
  front.scale = {corner[lo], step};
  const auto margin_of = [&](int k, int axis_step) {
    const Parts margin = parts(ray.margin[k]);
    return steps(margin.significand, margin.exponent, axis_step, bound_bits).floor + 1;
  };
  const auto unit_of = [&](int k, int axis_step) {
    const Parts inverse = parts(ray.inverse[k]);
    return steps(inverse.significand, inverse.exponent + node.exponent(k), axis_step,
                 unit_bits + 1);
  };
  // As far as axis lo tells, T is from T_ref - before to T_ref + after.
  const Steps unit_lo = unit_of(lo, step);
  const Whole before = margin_of(lo, step) - 255 * std::min<Whole>(unit_lo.floor, 0),
              after = margin_of(lo, step) + 255 * std::max<Whole>(unit_lo.ceil(), 0);
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<unsigned>(k);
    AxisPlanes& axis = front.axes[at];
    const int axis_step = std::max(step, range[at] - kByte - (unit_bits - 1));
    const bool slow = axis_step > step;
    const Whole margin = margin_of(k, axis_step);
    const Steps plane = difference(corner[k], corner[lo], axis_step, bound_bits + 1);
    const Whole most = Whole{1} << bound_bits;
    axis.near = std::min(plane.floor - margin - (slow ? before : 0), most);
    axis.far = std::max(plane.ceil() + margin + (slow ? after : 0), -most);
    axis.no_near = std::isinf(ray.margin[k]) || axis.near < -most;
    axis.no_far = std::isinf(ray.margin[k]) || axis.far > most;
    const Steps unit = unit_of(k, axis_step);
    axis.near_unit = unit.floor;
    axis.far_unit = unit.ceil();
    axis.negative = std::signbit(ray.inverse[k]);
  }
  return front;
}

constexpr Whole kKeyZero = Whole{1} << (IntegerVisit::kKeyBits - 1);

/// A whole number of quarter units as a key.
unsigned key_of(Whole quarters) {
  return static_cast<unsigned>(std::clamp(quarters, -kKeyZero, kKeyZero - 1) + kKeyZero);
}

}  // namespace

IntegerRay integer_ray(const Vector<float>& o, const Vector<float>& d,
                       const RootBounds<float>& root, Shape leaf, int sixteenths) {
  const auto share = static_cast<float>(sixteenths);
  const float reach_of_root = reach<float>({o, o}, root);
  float margin = reach_of_root * (share * 0x1p-20f) + root.margin * (share * 0x1p-4f);
  if (leaf == Shape::kSphere) {
    const float most = max_num(max_num(magnitude(d[0]), magnitude(d[1])), magnitude(d[2]));
    if (!(most * 0x1p-42f <= reach_of_root && reach_of_root <= most * 0x1p37f))
      margin = std::numeric_limits<float>::infinity();
  }
  IntegerRay ray{o, {}, {}};
  for (int k = 0; k < 3; ++k) {
    ray.inverse[k] = 1 / std::copysign(max_num(magnitude(d[k]), 0x1p-80f), d[k]);
    ray.margin[k] = margin * magnitude(ray.inverse[k]);
  }
  return ray;
}

IntegerVisit integer_visit(const IntegerRay& ray, const Node& node, float floor, float limit,
                           bool farthest, const IntegerFormat& format) {
  const NodePlanes front = planes_of(ray, node, format);
  const int bits = format.unit_bits + 10;
  const Whole most = (Whole{1} << bits) - 1, least = -most - 1;
  const TimeScale& scale = front.scale;
  const Whole lowest =
      std::min(difference(floor, scale.reference, scale.exponent, bits).ceil(), most);
  const Whole highest = difference(limit, scale.reference, scale.exponent, bits).floor;
  IntegerVisit visit{.scale = scale};
  for (unsigned i = 0; i < Node::kChildren; ++i) {
    Whole near = least, far = most;
    for (int k = 0; k < 3; ++k) {
      const AxisPlanes& axis = front.axes[static_cast<unsigned>(k)];
      const Whole lower = node.lower(i, k), upper = node.upper(i, k);
      if (!axis.no_near)
        near = std::max(near, axis.near + (axis.negative ? upper : lower) * axis.near_unit);
      if (!axis.no_far)
        far = std::min(far, axis.far + (axis.negative ? lower : upper) * axis.far_unit);
    }
    if (node.child(i) != Child::kNone && near <= far && far >= lowest && near <= highest)
      visit.entered |= 1u << i;
    visit.keys[i] =
        static_cast<std::uint16_t>(key_of((farthest ? -far : near) >> (format.step_bits - 2)));
  }
  return visit;
}

unsigned key_limit(const TimeScale& scale, float t, bool farthest, const IntegerFormat& format) {
  const Steps quarters =
      difference(t, scale.reference, scale.exponent + format.step_bits - 2, IntegerVisit::kKeyBits);
  return key_of(farthest ? -quarters.ceil() : quarters.floor);
}

}  // namespace cde::reference
