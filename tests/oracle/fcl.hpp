// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// Signed distances of FCL 0.7: distance(), which uses GJK and EPA of libccd. The requested
/// accuracy is 1e-9 of the scene. There is no answer if FCL has none: for a plane, on which it
/// crashes, or if its solver gives up.
///
/// FCL runs in a child process, because its EPA sometimes ends the program with an assertion, on
/// about one pair of cylinders in a thousand. Such pairs have no answer. The assertion fails on
/// most overlapping spheres. FCL therefore gets a sphere as its centre with a millionth of the
/// radius, and the rest is subtracted from the distance. There is no answer if the centre is inside
/// the other shape.
///
/// FCL treats rotations and axes as exactly orthonormal: use it for operands in binary64, not for
/// operands of a slot. Throws std::system_error if the child process cannot start.
[[nodiscard]] std::vector<std::optional<double>> fcl_signed_distances(
    const std::vector<std::pair<Shape, Shape>>& pairs);

}  // namespace cde::oracle
