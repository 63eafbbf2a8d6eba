#pragma once
#include <optional>

#include "shapes.hpp"

namespace cde::oracle {

/// The signed distance of FCL 0.7 (distance(), which has GJK and EPA of libccd behind it), asked
/// for 1e-9 of the scene; nothing where FCL has none: a plane, a solver that gave up, or a sphere
/// that overlaps something, on which its EPA stops the program with an assertion. FCL takes
/// rotations and axes as exactly orthonormal: it is for operands made in binary64, not for those of
/// a slot.
[[nodiscard]] std::optional<double> fcl_signed_distance(const Shape& a, const Shape& b);

}  // namespace cde::oracle
