// SPDX-License-Identifier: Apache-2.0
// The convex pairs with a closed form, checked by certificate. The mirror reference equals the
// hardware, so its errors are the errors of the pipes. Tolerances are the contract's: 16 u S
// for s, and 16 u S + 4 u L for the witness points.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "amount.hpp"
#include "cde/fp/fp.hpp"
#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/oracle/random.hpp"
#include "convex_cases.hpp"
#include "convex_check.hpp"
#include "in_docs.hpp"
#include "operators.hpp"
#include "printed.hpp"

namespace cde::testing {
namespace {

constexpr std::uint64_t kSeed = 20030;
constexpr int kCases = 24000;
constexpr int kDirected = 4000;

class ConvexPair : public ::testing::TestWithParam<Pair> {};

TEST_P(ConvexPair, NearContactAndDirected_CertificateHolds) {
  Report report(std::string(oracle::to_string(GetParam())) + ", seed " + std::to_string(kSeed));
  for (int i = 0; i < kCases; ++i) {
    const oracle::Case c = oracle::generate(GetParam(), kSeed, i);
    report.add<float>(c.family, c, 0x1p-24);
  }
  const Worst& all = report.finish();
  EXPECT_GT(all.hits, kCases * 3 / 10);
  EXPECT_LT(all.hits, kCases * 7 / 10);
  EXPECT_GT(all.in_band, 0) << "no case is close enough to touching to test F";
}

// The hardest normals: the nearest features change between vertex, edge and face within tiny
// distances. The distance is small, edges and faces are nearly parallel, and triangles are nearly
// segments.
TEST_P(ConvexPair, ChangingFeatures_CertificateHolds) {
  Report report(std::string(oracle::to_string(GetParam())) + ", directed");
  int apart = 0;
  for (const DirectedFamily family : kDirectedFamilies) {
    for (int i = 0; i < kDirected; ++i) {
      const oracle::Case c = directed_case(GetParam(), family, kSeed, i);
      report.add<float>(to_string(family), c, 0x1p-24);
    }
  }
  const Worst& all = report.finish();
  apart = all.cases - all.hits;
  // Two triangles that approach by a vertex or an edge pass each other.
  EXPECT_GT(all.hits, all.cases / (GetParam() == Pair::kTriangleTriangle ? 20 : 10));
  EXPECT_GT(apart, all.cases / 10);
}

// Everyday scenes: whole numbers, equal coordinates, one shape upon another.
TEST_P(ConvexPair, EverydayScenes_CertificateHolds) {
  const int count = amount(2000, 20000);
  Report report(std::string(oracle::to_string(GetParam())) + ", everyday");
  for (int i = 0; i < count; ++i) {
    const oracle::Case c = oracle::everyday(GetParam(), kSeed, i);
    report.add<float>(c.family, c, 0x1p-24);
  }
  const Worst& all = report.finish();
  EXPECT_GT(all.hits, count * 3 / 10);
  EXPECT_LT(all.hits, count * 7 / 10);
  EXPECT_GT(all.in_band, count / 100) << "too few shapes rest on each other";
}

/// The larger distance of a witness point from its body, over the tolerance 16 u S + 4 u L.
double witness_miss(const oracle::Case& c) {
  const auto o = judged(run<float>(c.pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()}));
  const oracle::Shape a = c.shape_a(), b = c.shape_b();
  const double tolerance =
      0x1p-24 * (16 * oracle::scene_size(a, b) + 4 * oracle::largest_coordinate(a, b));
  const oracle::Vec half = (o.f ? -o.t : o.t) / 2 * o.n;
  const double miss = std::max(oracle::distance(o.cp - half, a), oracle::distance(o.cp + half, b));
  return miss >= 0 ? miss / tolerance : INFINITY;
}

// If the depth has two directions, or faces are nearly parallel, the certificates of T and n hold
// while CP may lie outside a body. CDE_FULL runs a million cases. There, pairs with candidate axes
// may miss by what docs/reference/pairs_convex.md states under "Limits".
TEST_P(ConvexPair, WitnessPoints_LieInTheBodies) {
  const int count = amount(40000, 1000000);
  const bool sat = GetParam() == Pair::kObbObb || GetParam() == Pair::kTriangleObb ||
                   GetParam() == Pair::kTriangleAabb;
  const int allowed = sat && count > 40000 ? 2 : 0;
  int out = 0;
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    const oracle::Case c = oracle::everyday(GetParam(), kSeed + 1, i);
    const double miss = witness_miss(c);
    worst = std::max(worst, miss);
    out += miss > 1;
    if (miss > 1 && out <= 3) std::printf("%.3g tolerances: %s\n", miss, c.describe().c_str());
  }
  std::printf("%s, everyday, seed %u: %d cases, %d witness points out of tolerance, worst %.3g\n",
              oracle::to_string(GetParam()), static_cast<unsigned>(kSeed + 1), count, out, worst);
  EXPECT_LE(out, allowed);
  EXPECT_LE(worst, allowed > 0 ? 7 : 1);
}

INSTANTIATE_TEST_SUITE_P(All, ConvexPair, ::testing::ValuesIn(kConvexPairs), [](const auto& info) {
  std::string name = oracle::to_string(info.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// The plane as the solid n.x <= d, against the oracle's half-space: bodies near its surface, half
// of them far below it. Above the plane both modes are equal. The normal always points into the
// solid.
template <template <class> class Body, class Pipe>
void judge_half_space(Pair pair, Pipe pipe) {
  Report report(std::string(oracle::to_string(pair)) + " as half-space, seed " +
                std::to_string(kSeed));
  int above = 0, deep = 0;
  for (int i = 0; i < kCases; ++i) {
    const oracle::Case c = oracle::generate(pair, kSeed, i);
    auto solid = std::get<oracle::Plane>(c.shape_b());
    solid.half_space = true;
    const auto a = primitive<Body, float>({c.a.begin(), c.a.end()});
    const auto b = primitive<BasicPlane, float>({c.b.begin(), c.b.end()});
    const auto o = pipe(a, b, PlaneSide::kHalfSpace);
    report.add<float>(c.family, o, c.shape_a(), solid, 0x1p-24, c.describe());
    EXPECT_EQ(o.n, -b.n) << c.describe();
    const auto surface = pipe(a, b, PlaneSide::kSurface);
    if (surface.n == o.n) {
      ++above;
      EXPECT_TRUE(o.f == surface.f && o.t == surface.t && o.cp == surface.cp) << c.describe();
    } else if (!surface.f) {
      ++deep;
      EXPECT_TRUE(o.f) << c.describe();
    }
  }
  const Worst& all = report.finish();
  EXPECT_LT(all.hits, kCases * 9 / 10);
  EXPECT_GT(all.in_band, 0);
  EXPECT_GT(above, kCases / 4);
  EXPECT_GT(deep, kCases / 10);
}

TEST(ConvexPairHalfSpace, PlaneAsSolid_CertificateHolds) {
  judge_half_space<BasicObb>(Pair::kObbPlane, reference::obb_plane<float>);
  judge_half_space<BasicSphere>(Pair::kSpherePlane, reference::sphere_plane<float>);
}

constexpr int kFormatCases = 4000;

/// Errors scale with u. Sizes stay where the format has enough range: squares neither overflow nor
/// become subnormal, and boxes do not become flat by rounding. With a plane nothing is squared, and
/// its body alone sets the size.
template <class S>
void other_format(const char* name, double smallest, double largest, double farthest) {
  for (const Pair pair : kConvexPairs) {
    const double least = secondary_shape(pair) == Shape::kPlane ? smallest / 8 : smallest;
    Report report(std::string(name) + " " + oracle::to_string(pair));
    int used = 0;
    for (int i = 0; i < kFormatCases; ++i) {
      oracle::Case c = oracle::generate(pair, kSeed, i);
      const std::string family = c.family;
      const double size = oracle::scene_size(c.shape_a(), c.shape_b());
      const double far = oracle::largest_coordinate(c.shape_a(), c.shape_b());
      if (size < least || size > largest || far > farthest) continue;
      if (family == "scale mismatch" || family == "needles and plates") continue;
      for (auto* words : {&c.a, &c.b})
        for (double& w : *words) w = static_cast<double>(static_cast<S>(w));
      report.add<S>("", c, reference::kUnitRoundoff<S>);
      ++used;
    }
    report.finish();
    EXPECT_GT(used, kFormatCases / 2);
  }
}

TEST(ConvexPairFormat, Fp16_CertificateHolds) {
  other_format<Fp16>("fp16", 2.5, 60, 60);
}
TEST(ConvexPairFormat, Bf16_CertificateHolds) {
  other_format<Bf16>("bf16", 1e-6, 1e6, 8);
}
TEST(ConvexPairFormat, Fp24_CertificateHolds) {
  other_format<Fp24>("fp24", 1e-4, 1e4, 1e4);
}

/// Results for bodies of given sizes at a distance of 1 to 2 from the world's origin.
struct Sized {
  int judged = 0, out = 0;
  double worst = 0;  ///< error of s, in u S

  [[nodiscard]] std::string text() const {
    return fmt::format("{:.1f} ({} of {})", worst, out, judged);
  }
};

/// Cases near contact or slightly deeper, with the usual proportions. Bodies that round to a size
/// below the format's smallest are left out.
template <class S>
Sized judge_sizes(Pair pair, double size_a, double size_b, int count) {
  const int exponent = std::bit_width(static_cast<unsigned>(std::numeric_limits<S>::max_exponent));
  const oracle::Format format{.exp_bits = exponent, .man_bits = std::numeric_limits<S>::digits - 1};
  Sized result;
  for (int i = 0; i < count; ++i) {
    oracle::Random random(kSeed, 3000 + static_cast<std::uint64_t>(pair), i);
    oracle::Build build_a, build_b;
    build_a.scale = size_a * random.uniform(0.5, 1);
    build_b.scale = size_b * random.uniform(0.5, 1);
    const oracle::Frame frame_a = random.rotation(), frame_b = random.rotation();
    oracle::Shape a = oracle::build_shape(random, oracle::primary(pair), frame_a, build_a);
    oracle::Shape b = oracle::build_shape(random, oracle::secondary(pair), frame_b, build_b);
    const auto* plane = std::get_if<oracle::Plane>(&b);
    const oracle::Vec n = plane != nullptr ? plane->n : random.direction();
    const double distance = random.chance(0.5) ? random.uniform(-0.3, 1)
                                               : random.either_sign(random.decades(1e-4, 1e-1));
    const double to = distance * std::min(size_a, size_b);
    if (plane != nullptr)
      a = oracle::moved(a, (oracle::support(a, -n) + to) * n);
    else
      b = oracle::moved(b, (oracle::support(a, n) + oracle::support(b, -n) + to) * n);
    const double far = random.uniform(1, 2);
    const oracle::Vec at = far * random.direction();
    const oracle::Case c{pair,
                         kSeed,
                         static_cast<std::uint64_t>(i),
                         "sizes",
                         oracle::to_words(oracle::moved(a, at), format),
                         oracle::to_words(oracle::moved(b, at), format)};
    const Outcome<S> o = run<S>(pair, c.a, c.b);
    if (o.bad) continue;
    std::string message;
    const Worst w = judge<S>(o, c.shape_a(), c.shape_b(), reference::kUnitRoundoff<S>, message);
    ++result.judged;
    result.out += w.failed;
    result.worst = std::max({result.worst, w.c1, w.c2});
  }
  return result;
}

template <class S>
void small_triangles(const char* name) {
  for (const Pair pair :
       {Pair::kTriangleSphere, Pair::kTriangleObb, Pair::kTriangleAabb, Pair::kTriangleTriangle}) {
    for (int k = 1; k <= 5; ++k) {
      const Sized r = judge_sizes<S>(pair, std::ldexp(0.5, -k), 0.5, 500);
      EXPECT_EQ(r.judged, 500);
      EXPECT_EQ(r.out, 0) << name << ' ' << oracle::to_string(pair) << " 2^-" << k << ' '
                          << r.text();
    }
  }
}

// The product of two edges of a small triangle can underflow, and so can the square of its normal.
// A triangle of 1/16 of the scene in fp16 must keep its corners.
TEST(ConvexPairFormat, SmallTriangles_CertificateHolds) {
  small_triangles<Fp16>("fp16");
  small_triangles<Bf16>("bf16");
  small_triangles<Fp24>("fp24");
  small_triangles<float>("fp32");
}

/// The same shape with a rotation that is orthonormal in binary64 instead of binary32.
oracle::Shape sharpened(oracle::Shape shape) {
  if (auto* box = std::get_if<oracle::Obb>(&shape))
    box->rotation = Eigen::Quaterniond(box->rotation).normalized().toRotationMatrix();
  if (auto* plane = std::get_if<oracle::Plane>(&shape)) plane->n.normalize();
  return shape;
}

struct WordsOf {
  static Words join(std::initializer_list<oracle::Vec> vectors,
                    std::initializer_list<double> rest) {
    Words words;
    for (const oracle::Vec& v : vectors) words.insert(words.end(), v.begin(), v.end());
    for (const double x : rest) words.push_back(x);
    return words;
  }
  Words operator()(const oracle::Sphere& s) const { return join({s.c}, {s.r}); }
  Words operator()(const oracle::Aabb& s) const { return join({s.min, s.max}, {}); }
  Words operator()(const oracle::Triangle& s) const { return join({s.v0, s.v1, s.v2}, {}); }
  Words operator()(const oracle::Plane& s) const { return join({s.n}, {s.d}); }
  Words operator()(const oracle::Obb& s) const {
    const Eigen::Matrix3d& r = s.rotation;
    return join({s.c, s.half, r.row(0), r.row(1), r.row(2)}, {});
  }
  Words operator()(const oracle::Cylinder&) const { throw std::logic_error("no cylinders"); }
};

// The oracle's interval is 1e-8 S wide, which limits the check: 16 u S with u = 2^-29, which is
// 2^24 times the u of binary64.
TEST(ConvexPairFormat, Fp64_CertificateHolds) {
  for (const Pair pair : kConvexPairs) {
    Report report(std::string("fp64 ") + oracle::to_string(pair));
    for (int i = 0; i < kFormatCases; ++i) {
      const oracle::Case c = oracle::generate(pair, kSeed, i);
      if (c.family == std::string("needles and plates")) continue;
      const oracle::Shape a = sharpened(c.shape_a()), b = sharpened(c.shape_b());
      const auto o = run<double>(pair, std::visit(WordsOf{}, a), std::visit(WordsOf{}, b));
      report.add<double>("", o, a, b, 0x1p-29, c.describe());
    }
    report.finish();
  }
}

// The three pairs of equal shapes: swapping the shapes reverses the normal, and keeps s and F.
TEST(ConvexPairSwapped, SwappedShapes_Agree) {
  for (const Pair pair : {Pair::kSphereSphere, Pair::kObbObb, Pair::kTriangleTriangle}) {
    Report report(std::string(oracle::to_string(pair)) + ", exchanged");
    for (int i = 0; i < kDirected; ++i) {
      oracle::Case c = oracle::generate(pair, kSeed + 1, i);
      const Outcome<float> o = run<float>(pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()});
      std::swap(c.a, c.b);
      const Outcome<float> back =
          run<float>(pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()});
      report.add<float>(c.family, c, 0x1p-24);
      const double s = o.f ? -o.t : o.t, s_back = back.f ? -back.t : back.t;
      const double band = 0x1p-20 * oracle::scene_size(c.shape_a(), c.shape_b());
      EXPECT_LE(std::abs(s - s_back), band) << c.describe();
    }
    report.finish();
  }
}

// The same bodies in other words: vertices in another order, box axes permuted or reflected.
TEST(ConvexPairSwapped, OtherWordsOfTheSameBody_CertificateHolds) {
  for (const Pair pair : {Pair::kTriangleSphere, Pair::kTriangleAabb, Pair::kTriangleObb,
                          Pair::kObbObb, Pair::kSphereObb, Pair::kObbPlane}) {
    Report report(std::string(oracle::to_string(pair)) + ", other words");
    for (int i = 0; i < kDirected; ++i) {
      oracle::Case c = oracle::generate(pair, kSeed + 2, i);
      for (auto* words : {&c.a, &c.b}) {
        if (words->size() == 9)
          std::swap_ranges(words->begin(), words->begin() + 3, words->end() - 3);
        if (words->size() == 15)
          for (int row = 0; row < 3; ++row) (*words)[6 + 3 * row + i % 3] *= -1;  // a reflection
      }
      report.add<float>(c.family, c, 0x1p-24);
    }
    report.finish();
  }
}

// ---- The tables of docs/tables/pairs_convex.md ----

std::string with_commas(int n) {
  return n < 1000 ? fmt::format("{}", n) : fmt::format("{},{:03}", n / 1000, n % 1000);
}

TEST(ConvexPairTables, AccuracyAndCost_EqualTheDocs) {
  std::vector<std::string> lines;
  for (const Pair pair : kConvexPairs) {
    Worst all;
    const auto add = [&](const oracle::Case& c) {
      std::string message;
      all.add(judge<float>(run<float>(pair, c.a, c.b), c.shape_a(), c.shape_b(), 0x1p-24, message));
    };
    for (int i = 0; i < kCases; ++i) add(oracle::generate(pair, kSeed, i));
    for (const DirectedFamily family : kDirectedFamilies)
      for (int i = 0; i < kDirected; ++i) add(directed_case(pair, family, kSeed, i));
    EXPECT_EQ(all.failed, 0);
    const Tally n = operators(pair);
    lines.push_back(
        fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} | {} | {} | {} | {} | {} | {} | {} |",
                    oracle::to_string(pair), all.c1, all.c2, all.witness, with_commas(all.in_band),
                    all.excused, n.add + n.sub, n.mul, n.div, n.sqrt, n.depth));
  }
  expect_in_docs("tables/pairs_convex.md", lines);
}

TEST(ConvexPairTables, EverydayFamilies_EqualTheDocs) {
  std::vector<std::string> lines;
  for (const Pair pair : kConvexPairs) {
    Worst all;
    for (int i = 0; i < kCases; ++i) {
      const oracle::Case c = oracle::everyday(pair, kSeed, i);
      std::string message;
      all.add(judge<float>(run<float>(pair, c.a, c.b), c.shape_a(), c.shape_b(), 0x1p-24, message));
    }
    EXPECT_EQ(all.failed, 0);
    lines.push_back(fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} | {} | {} |",
                                oracle::to_string(pair), all.c1, all.c2, all.witness,
                                with_commas(all.in_band), with_commas(all.excused)));
  }
  expect_in_docs("tables/pairs_convex.md", lines);
}

// The pipe scales by the largest coordinate, so small shapes have few exponents left in fp16.
TEST(ConvexPairTables, SmallScenesInCoarseFormats_EqualTheDocs) {
  std::vector<std::string> lines;
  for (const Pair pair : kConvexPairs) {
    std::string line = fmt::format("| {} |", oracle::to_string(pair));
    for (int k = 1; k <= 5; ++k) {
      const double size = std::ldexp(0.5, -k);
      line += fmt::format(" {} |", judge_sizes<Fp16>(pair, size, size, 500).text());
      const Sized fine = judge_sizes<Bf16>(pair, size, size, 500);
      EXPECT_EQ(fine.out, 0) << "bf16 " << oracle::to_string(pair) << ' ' << fine.text();
      EXPECT_GT(fine.judged, 250);
    }
    lines.push_back(line);
  }
  expect_in_docs("tables/pairs_convex.md", lines);
}

/// The worst error of s over the size of the bodies and the distance between them, when both stand
/// `far` from the world's origin.
double error_at(Pair pair, double far) {
  double worst = 0;
  for (int i = 0; i < kFormatCases; ++i) {
    const oracle::Case at_origin = oracle::generate(pair, kSeed, 2 * i);
    if (oracle::scene_size(at_origin.shape_a(), at_origin.shape_b()) < 1) continue;
    oracle::Random random(kSeed, 2000 + static_cast<std::uint64_t>(pair), i);
    const oracle::Vec by = far * random.direction();
    oracle::Case c = at_origin;
    c.a = oracle::to_words(oracle::moved(at_origin.shape_a(), by));
    c.b = oracle::to_words(oracle::moved(at_origin.shape_b(), by));
    const auto o = judged(run<float>(pair, c.a, c.b));
    const oracle::SignedDistance distance = oracle::signed_distance(c.shape_a(), c.shape_b());
    const double s = o.f ? -o.t : o.t;
    const double size =
        oracle::scene_size(oracle::moved(c.shape_a(), -by), oracle::moved(c.shape_b(), -by));
    worst = std::max(worst, std::max({0.0, distance.lo - s, s - distance.hi}) / size);
  }
  return worst;
}

// Centres are subtracted first, so T is equally good anywhere. The d of a plane is measured from
// the world's origin, so n.c - d cancels.
TEST(ConvexPairTables, DistanceFromTheOrigin_EqualsTheDocs) {
  std::vector<std::string> lines;
  for (const Pair pair : kConvexPairs) {
    std::vector<double> errors;
    for (const double far : {0.0, 10.0, 1e3, 1e5}) errors.push_back(error_at(pair, far));
    if (secondary_shape(pair) == Shape::kPlane)
      EXPECT_GT(errors[3], 1e-4) << "the docs say that planes are the exception";
    else
      EXPECT_LE(*std::max_element(errors.begin(), errors.end()), 16 * 0x1p-24);
    lines.push_back(fmt::format("| {} | {:.1e} | {:.1e} | {:.1e} | {:.1e} |",
                                oracle::to_string(pair), errors[0], errors[1], errors[2],
                                errors[3]));
  }
  expect_in_docs("tables/pairs_convex.md", lines);
}

}  // namespace
}  // namespace cde::testing
