// SPDX-License-Identifier: Apache-2.0
#include "cgal.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <CGAL/squared_distance_3.h>

#include <stdexcept>

namespace cde::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

Kernel::Point_3 point(const Vec& v) {
  return {v.x(), v.y(), v.z()};
}

Kernel::Triangle_3 with_area(const Triangle& t) {
  const Kernel::Triangle_3 made(point(t.v0), point(t.v1), point(t.v2));
  if (made.is_degenerate()) throw std::invalid_argument("triangle without area");
  return made;
}

}  // namespace

double cgal_squared_distance(const Vec& p, const Triangle& triangle) {
  return CGAL::to_double(CGAL::exact(CGAL::squared_distance(point(p), with_area(triangle))));
}

bool cgal_intersect(const Triangle& triangle, const Aabb& box) {
  return CGAL::do_intersect(with_area(triangle),
                            Kernel::Iso_cuboid_3(point(box.min), point(box.max)));
}

bool cgal_intersect(const Ray& ray, const Triangle& triangle) {
  const Kernel::Vector_3 d(ray.d.x(), ray.d.y(), ray.d.z());
  return CGAL::do_intersect(Kernel::Ray_3(point(ray.o), d), with_area(triangle));
}

}  // namespace cde::oracle
