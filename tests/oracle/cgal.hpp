// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// CGAL with exact predicates and exact constructions. Triangles must have area, which is tested
/// exactly; otherwise throws std::invalid_argument.
[[nodiscard]] double cgal_squared_distance(const Vec& p, const Triangle& triangle);
[[nodiscard]] bool cgal_intersect(const Triangle& triangle, const Aabb& box);
/// The whole half-line from o; tmin and tmax are ignored.
[[nodiscard]] bool cgal_intersect(const Ray& ray, const Triangle& triangle);

}  // namespace cde::oracle
