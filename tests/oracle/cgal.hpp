// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// CGAL with exact predicates and exact constructions. Triangles must have area (throws
/// std::invalid_argument), which is decided exactly.
[[nodiscard]] double cgal_squared_distance(const Vec& p, const Triangle& triangle);
[[nodiscard]] bool cgal_intersect(const Triangle& triangle, const Aabb& box);
/// The whole half-line from o; tmin and tmax are not looked at.
[[nodiscard]] bool cgal_intersect(const Ray& ray, const Triangle& triangle);

}  // namespace cde::oracle
