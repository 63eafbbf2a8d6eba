// SPDX-License-Identifier: Apache-2.0
#include "cylinder_cases.hpp"

#include <cmath>
#include <numbers>
#include <variant>

#include "cde/oracle/random.hpp"

namespace cde::testing {
namespace {

using oracle::Random;
using oracle::Vec;
using Frame = Eigen::Matrix3d;

Vec tilted(Random& random, const Vec& a, double angle) {
  const Vec across = a.cross(random.direction()).normalized();
  return std::cos(angle) * a + std::sin(angle) * across;
}

/// A face normal of A.
Vec face(const oracle::Shape& a) {
  if (const auto* cylinder = std::get_if<oracle::Cylinder>(&a)) return cylinder->axis;
  if (const auto* box = std::get_if<oracle::Obb>(&a)) return box->rotation.col(0);
  const auto& t = std::get<oracle::Triangle>(a);
  return (t.v1 - t.v0).cross(t.v2 - t.v0).normalized();
}

/// Lengths and coordinates on a grid of 1, or real numbers.
struct Ruler {
  Random& random;
  bool grid;
  double length(int most) { return grid ? 1 + random.below(most) : random.uniform(0.2, most); }
  double place(int most) {
    return grid ? random.below(2 * most + 1) - most : random.uniform(-most, most);
  }
  Vec point(int most) {
    const double x = place(most), y = place(most), z = place(most);
    return {x, y, z};
  }
};

/// A triangle with an edge along an axis; two thirds have another edge along another axis.
oracle::Shape upright_triangle(Ruler& ruler) {
  Random& random = ruler.random;
  const Frame frame = random.quarter_turns();
  const Vec v0 = ruler.point(3);
  const Vec along = ruler.length(8) * frame.col(0);
  Vec other = ruler.length(8) * frame.col(1);
  const int kind = random.below(6);
  if (kind == 0) other += ruler.place(8) * frame.col(0);
  if (kind == 1) other += ruler.place(8) * frame.col(0) + ruler.place(4) * frame.col(2);
  const std::array<Vec, 3> v = {v0, v0 + along, v0 + other};
  const int first = random.below(3);
  return oracle::Triangle{v[first], v[(first + 1) % 3], v[(first + 2) % 3]};
}

oracle::Shape upright_primary(oracle::Pair pair, Ruler& ruler) {
  Random& random = ruler.random;
  if (pair == oracle::Pair::kTriangleCylinder) return upright_triangle(ruler);
  const Vec c = ruler.random.chance(0.5) ? Vec(Vec::Zero()) : ruler.point(2);
  if (pair == oracle::Pair::kCylinderCylinder) {
    const Vec axis = random.quarter_turns().col(0);
    const double half = ruler.length(5), radius = ruler.length(4);
    return oracle::Cylinder{c, axis, half, radius};
  }
  const double x = ruler.length(6), y = ruler.length(6), z = ruler.length(6);
  return oracle::Obb{c, {x, y, z}, random.quarter_turns()};
}

/// A corner of the shape: for a triangle its i-th corner, for a cylinder a point of a rim, also on
/// the grid.
Vec corner(Random& random, const oracle::Shape& shape, int i) {
  if (const auto* t = std::get_if<oracle::Triangle>(&shape)) {
    return i == 0 ? t->v0 : i == 1 ? t->v1 : t->v2;
  }
  if (const auto* box = std::get_if<oracle::Obb>(&shape)) {
    Vec at = box->c;
    for (int i = 0; i < 3; ++i) at += random.sign() * box->half[i] * box->rotation.col(i);
    return at;
  }
  const auto& c = std::get<oracle::Cylinder>(shape);
  const Vec across = c.axis.cross(random.quarter_turns().col(0));
  const Vec out = across.norm() > 0.5 ? across : Vec(c.axis.y(), c.axis.z(), c.axis.x());
  return c.c + random.sign() * c.half_height * c.axis + c.radius * out;
}

oracle::Shape tilted_shape(Random& random, const oracle::Shape& shape, double angle) {
  const Frame by = Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
  const Vec c = oracle::center(shape);
  return oracle::moved(turned(oracle::moved(shape, -c), by), c);
}

}  // namespace

oracle::Shape random_primary(oracle::Pair pair, std::uint64_t seed) {
  Random random(seed, 11, 0);
  const auto extent = [&] { return random.decades(0.2, 2); };
  if (pair == oracle::Pair::kCylinderCylinder) {
    const Vec axis = random.direction();
    const double half = extent(), radius = extent();
    return oracle::Cylinder{Vec::Zero(), axis, half, radius};
  }
  if (pair == oracle::Pair::kObbCylinder) {
    const Frame frame = random.rotation();
    const double x = extent(), y = extent(), z = extent();
    return oracle::Obb{Vec::Zero(), {x, y, z}, frame};
  }
  std::array<Vec, 3> v;
  for (Vec& x : v) {
    const double length = 2 * random.unit();
    x = length * random.direction();
  }
  return oracle::Triangle{v[0], v[1], v[2]};
}

oracle::Case near_cap(oracle::Pair pair, std::uint64_t index) {
  const oracle::Shape a = random_primary(pair, kCylinderSeed + index);
  Random random(kCylinderSeed, 12, index);
  const Vec axis_b = random.direction();
  const double half = random.decades(0.2, 2), radius = random.decades(0.2, 2);
  oracle::Cylinder b{Vec::Zero(), axis_b, half, radius};
  Vec axis = face(a);
  if (random.chance(0.7)) {
    const double angle = random.decades(1e-4, 0.06);
    b.axis = random.flipped(tilted(random, axis, angle));
  } else if (pair != oracle::Pair::kCylinderCylinder) {
    axis = b.axis;
  }
  const double off = random.decades(1e-4, 0.06);
  const Vec n = random.flipped(tilted(random, axis, off));
  const auto support = [](const oracle::Shape& shape, const Vec& along) {
    Vec at;  // the gradient of the support function
    for (int i = 0; i < 3; ++i) {
      const Vec step = 1e-6 * Vec::Unit(i);
      at[i] = (oracle::support(shape, along + step) - oracle::support(shape, along - step)) / 2e-6;
    }
    return at;
  };
  const double share = random.chance(0.5) ? 0.02 : 0.6;
  const double aside = share * random.unit() * b.radius;
  b.c = support(a, n) - support(b, -n) + aside * n.cross(random.direction()).normalized();
  const oracle::SignedDistance distance = oracle::signed_distance(a, b);
  const double wanted = random.either_sign(random.decades(1e-7, 1e-3));
  b.c += distance.n * (wanted - distance.lo);
  return {pair, kCylinderSeed, index, "near a cap axis", oracle::to_words(a), oracle::to_words(b)};
}

oracle::Case upright(oracle::Pair pair, std::uint64_t index) {
  static constexpr std::array<const char*, 9> kFamilies = {
      "grid",          "real",          "grid, tilted",          "real, tilted",
      "grid, rotated", "real, rotated", "real, tilted, rotated", "grid, touching",
      "real, touching"};
  const std::size_t family = index % kFamilies.size();
  const bool grid = family % 2 == 0 ? family < 6 : family == 7;
  const bool tilt = family == 2 || family == 3 || family == 6, rotate = family >= 4 && family <= 6;
  Random random(kCylinderSeed, 13, index);
  Ruler ruler{random, grid};
  oracle::Shape a = upright_primary(pair, ruler);
  const Vec c = ruler.point(random.chance(0.5) ? 3 : 9);
  const double half = ruler.length(5), radius = ruler.length(5);
  oracle::Shape b = oracle::Cylinder{c, Vec::UnitZ() * random.sign(), half, radius};
  if (tilt) {
    const double angle = random.decades(1e-7, 1e-2);
    b = tilted_shape(random, b, angle);
  }
  if (rotate) {
    const Frame by = random.rotation();
    a = turned(a, by);
    b = turned(b, by);
  }
  if (family == 7) {
    // The support planes of both shapes across a grid axis coincide.
    const Vec n = random.sign() * random.quarter_turns().col(0);
    b = oracle::moved(b, (oracle::support(a, n) + oracle::support(b, -n)) * n);
  }
  if (family == 8) {
    const oracle::SignedDistance distance = oracle::signed_distance(a, b);
    const double wanted = random.chance(0.3) ? 0 : random.either_sign(random.decades(1e-7, 1e-3));
    b = oracle::moved(b, (wanted - distance.lo) * distance.n);
  }
  return {pair, kCylinderSeed, index, kFamilies[family], oracle::to_words(a), oracle::to_words(b)};
}

oracle::Case on_a_rim(oracle::Pair pair, std::uint64_t index) {
  static constexpr std::array<const char*, 4> kFamilies = {"grid", "grid, Pythagorean",
                                                           "grid, rotated", "real, rotated"};
  const std::size_t family = index % kFamilies.size();
  Random random(kCylinderSeed, 15, index);
  Ruler ruler{random, family < 3};
  oracle::Shape a = upright_primary(pair, ruler);
  const Frame frame = random.quarter_turns();
  const double half = ruler.length(3), any = ruler.length(4);
  const double radius = family == 1 ? 5 : any;
  const Vec other = (3 * frame.col(1) + 4 * frame.col(2)) / 5;
  const Vec out = family == 1 ? other : Vec(frame.col(1));
  const int first = random.below(3);
  const Vec at = corner(random, a, first) - random.sign() * half * frame.col(0) - radius * out;
  oracle::Shape b = oracle::Cylinder{at, frame.col(0), half, radius};
  if (auto* t = std::get_if<oracle::Triangle>(&a); t != nullptr && random.chance(0.5)) {
    // Its corner lies outside, on B's axis: n touches an edge from this corner to the rim.
    const std::array<Vec*, 3> v = {&t->v0, &t->v1, &t->v2};
    const Vec beyond = at + random.sign() * (half + ruler.length(3)) * frame.col(0);
    *v[(first + 1 + random.below(2)) % 3] = beyond;
  }
  if (family >= 2) {
    const Frame by = random.rotation();
    a = turned(a, by);
    b = turned(b, by);
  }
  return {pair, kCylinderSeed, index, kFamilies[family], oracle::to_words(a), oracle::to_words(b)};
}

}  // namespace cde::testing
