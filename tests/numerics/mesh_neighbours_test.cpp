// SPDX-License-Identifier: Apache-2.0
// Triangle pairs of a mesh against a mesh, or against itself: neighbours with a common edge or
// vertex, flat or folded, coplanar triangles, and small against large ones. They are checked by
// certificate and by known properties.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "cde/oracle/oracle.hpp"
#include "cde/oracle/random.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"

namespace cde::testing {
namespace {

using oracle::Random;
using oracle::Vec;
using reference::Outcome;
using Corners = std::array<Vec, 3>;

constexpr std::uint64_t kSeed = 20031;
constexpr int kCases = 1500;

struct Two {
  Corners a, b;
};

Vec in_cube(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}
Corners anywhere(Random& random) {
  const Vec p = in_cube(random), q = in_cube(random), r = in_cube(random);
  return {p, q, r};
}
Vec normal(const Corners& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}
Vec whole_in_plane(Random& random) {
  const double x = random.below(9) - 4., y = random.below(9) - 4.;
  return {x, y, 1};
}

Two shared_vertex(Random& random) {
  Two two{anywhere(random), anywhere(random)};
  two.b[0] = two.a[0];
  return two;
}
/// Neighbours over an edge: nearly coplanar, nearly folded onto each other, or neither.
Two shared_edge(Random& random) {
  Two two{anywhere(random), {}};
  const Corners& a = two.a;
  const double along = random.uniform(-0.2, 1.2), lift = random.decades(1e-9, 1e-1);
  const Vec foot = a[0] + along * (a[1] - a[0]);
  const int kind = random.below(3);
  const double across = kind == 0 ? -1 : 1;
  two.b = {a[1], a[0], kind == 2 ? in_cube(random) : foot + across * (a[2] - foot)};
  if (kind < 2) two.b[2] += random.either_sign(lift) * normal(a);
  return two;
}
/// Different edges on one line: a T junction.
Two collinear_edges(Random& random) {
  Two two{anywhere(random), {}};
  const Vec e = two.a[1] - two.a[0];
  const double from = random.uniform(-0.5, 1.5), to = random.uniform(-0.5, 1.5);
  two.b = {two.a[0] + from * e, two.a[0] + to * e, in_cube(random)};
  return two;
}
/// Whole coordinates in one plane: overlapping, touching, apart, without area.
Two in_one_plane(Random& random) {
  Two two;
  for (Corners* t : {&two.a, &two.b})
    for (Vec& v : *t) v = whole_in_plane(random);
  return two;
}
/// Coplanar up to a tiny tilt, side by side or not.
Two tilted_plane(Random& random) {
  Two two = in_one_plane(random);
  const double angle = random.decades(1e-9, 1e-2);
  const Eigen::Matrix3d hair = Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
  const Eigen::Matrix3d turn = random.rotation();
  for (Vec& v : two.b) v = hair * v;
  for (Corners* t : {&two.a, &two.b})
    for (Vec& v : *t) v = turn * v;
  return two;
}
Two small_and_large(Random& random) {
  Two two{anywhere(random), anywhere(random)};
  const double size = random.decades(1e-6, 1e-2);
  const double u = random.unit(), v = (1 - u) * random.unit(), h = random.uniform(-2, 2) * size;
  const Vec at = two.a[0] + u * (two.a[1] - two.a[0]) + v * (two.a[2] - two.a[0]);
  for (Vec& p : two.b) p = at + h * normal(two.a) + size * p;
  if (random.chance(0.5)) std::swap(two.a, two.b);
  return two;
}
/// All coordinates are among five values, with many equal corners: points, segments, vertices on
/// edges and faces.
Two few_points(Random& random) {
  Two two;
  for (Corners* t : {&two.a, &two.b})
    for (Vec& v : *t) {
      const double x = random.below(5) - 2., y = random.below(5) - 2., z = random.below(5) - 2.;
      v = {x, y, z};
    }
  if (random.chance(0.5)) two.a[2] = two.a[static_cast<std::size_t>(random.below(2))];
  if (random.chance(0.3)) two.b[1] = two.b[0];
  return two;
}

struct Family {
  const char* name;
  Two (*make)(Random&);
  bool meet;  ///< they have a common point
};
const Family kFamilies[] = {{"shared vertex", shared_vertex, true},
                            {"shared edge", shared_edge, true},
                            {"collinear edges", collinear_edges, false},
                            {"in one plane", in_one_plane, false},
                            {"tilted plane", tilted_plane, false},
                            {"small and large", small_and_large, false},
                            {"few points", few_points, false}};

/// Words of two slots, which binary32 represents exactly.
oracle::Case words_of(const Two& two, const Vec& by) {
  const auto words = [&by](const Corners& t) {
    return oracle::to_words(oracle::Triangle{t[0] + by, t[1] + by, t[2] + by});
  };
  return {oracle::Pair::kTriangleTriangle, kSeed, 0, "", words(two.a), words(two.b)};
}
Triangle primitive(const std::vector<double>& words) {
  std::array<float, 9> as_float{};
  for (std::size_t i = 0; i < as_float.size(); ++i) as_float[i] = static_cast<float>(words.at(i));
  return from_words<Triangle>(as_float);
}
oracle::Decision judged(const oracle::Case& c, const Outcome<float>& o) {
  return oracle::check(c.shape_a(), c.shape_b(),
                       {o.f, o.t, o.cp.cast<double>(), o.n.cast<double>()},
                       {.u = 0x1p-24, .distance = {}});
}

TEST(MeshNeighbours, Families_CertificateHolds) {
  for (const Family& family : kFamilies) {
    int hits = 0, wrong = 0;
    double c1 = 0, c2 = 0, witness = 0;
    for (int i = 0; i < kCases; ++i) {
      Random random(kSeed, static_cast<std::uint64_t>(&family - kFamilies), i);
      const Two two = family.make(random);
      const bool moves = random.chance(0.3);
      const double distance = random.decades(1, 1e4);
      const Vec far = distance * random.direction();
      const oracle::Case c = words_of(two, moves ? far : Vec(Vec::Zero()));
      const Outcome<float> o = reference::triangle_triangle(primitive(c.a), primitive(c.b));
      const oracle::Decision v = judged(c, o);
      const double us = 0x1p-24 * v.scale;
      if (!v.ok() && ++wrong <= 3) ADD_FAILURE() << v.describe() << '\n' << c.describe();
      EXPECT_TRUE(!family.meet || o.f || o.t <= 16 * us) << c.describe();
      hits += o.f;
      c1 = std::max(c1, v.error_c1 / us), c2 = std::max(c2, v.error_c2 / us);
      witness = std::max(witness, 16 * std::max(v.witness_a, v.witness_b) / v.tolerance_p);
    }
    std::printf("%-16s %d cases, %.1f %% hits, c1 %.2f c2 %.2f c3 %.2f\n", family.name, kCases,
                100. * hits / kCases, c1, c2, witness);
    EXPECT_EQ(wrong, 0) << family.name;
    EXPECT_GT(hits, kCases / 50) << family.name;
  }
}

// Whole coordinates give exact answers.
TEST(MeshNeighbours, CoplanarTriangles_AreAnsweredExactly) {
  const Triangle one = primitive({0, 0, 0, 4, 0, 0, 0, 4, 0});
  const auto with = [&](const std::vector<double>& w) {
    return reference::triangle_triangle(one, primitive(w));
  };
  EXPECT_TRUE(reference::triangle_triangle(one, one).f) << "the same triangle";
  EXPECT_EQ(reference::triangle_triangle(one, one).t, 0);
  const auto inside = with({1, 1, 0, 2, 1, 0, 1, 2, 0});
  EXPECT_TRUE(inside.f);
  EXPECT_EQ(inside.t, 0);
  EXPECT_EQ(inside.n.cwiseAbs(), Eigen::Vector3f(0, 0, 1));
  EXPECT_TRUE(with({4, 0, 0, 0, 4, 0, 4, 4, 0}).f) << "a common edge";
  EXPECT_TRUE(with({4, 0, 0, 8, 0, 0, 8, 4, 0}).f) << "a common vertex";
  const auto beside = with({-3, 0, 0, -3, 4, 0, -5, 2, 0});
  EXPECT_FALSE(beside.f) << "no candidate axis separates these";
  EXPECT_EQ(beside.t, 3);
  EXPECT_EQ(beside.n, Eigen::Vector3f(-1, 0, 0));
  EXPECT_EQ(beside.cp.x(), -1.5f);
  const auto above = with({1, 1, 2, 2, 1, 2, 1, 2, 2});
  EXPECT_EQ(above.t, 2);
  EXPECT_EQ(above.n, Eigen::Vector3f(0, 0, 1));
}

// Exactly parallel edges, and a depth with two sides of which only one has the witness.
TEST(MeshNeighbours, ParallelEdgesAndTwoSidedDepth_CertificateHolds) {
  const oracle::Case apart{oracle::Pair::kTriangleTriangle, 0, 0, "", {0, 0, 0, 3, 0, -3, -1, 0, 0},
                           {6, 0, -3, 0, 0, 1, 2, 0, 1}};
  const oracle::Case deep{
      oracle::Pair::kTriangleTriangle, 0, 0, "", {-1, 1, -2, -1, -2, 1, 1, -1, 0},
      {0, 2, 2, 0, -2, -2, 0, -2, 2}};
  for (const oracle::Case& c : {apart, deep}) {
    const auto o = reference::triangle_triangle(primitive(c.a), primitive(c.b));
    const oracle::Decision v = judged(c, o);
    EXPECT_TRUE(v.ok()) << v.describe() << '\n' << c.describe();
  }
}

}  // namespace
}  // namespace cde::testing
