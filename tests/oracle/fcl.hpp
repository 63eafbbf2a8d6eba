// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// The signed distances of FCL 0.7 (distance(), which has GJK and EPA of libccd behind it), asked
/// for 1e-9 of the scene; nothing where FCL has none: a plane (it crashes on one), or a solver that
/// gave up. It runs in a child process, since on about one pair of cylinders in a thousand its EPA
/// stops the program with an assertion; such pairs have no answer either. A sphere is given to FCL
/// as its centre with a millionth of the radius and the rest taken off the distance, because that
/// assertion fails on most overlapping spheres; there is no answer if the centre is inside the
/// other shape.
///
/// FCL takes rotations and axes as exactly orthonormal: it is for operands made in binary64, not
/// for those of a slot. Throws std::system_error if no child can be started.
[[nodiscard]] std::vector<std::optional<double>> fcl_signed_distances(
    const std::vector<std::pair<Shape, Shape>>& pairs);

}  // namespace cde::oracle
