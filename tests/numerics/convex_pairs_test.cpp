// The seven convex pairs with a closed form, judged by certificate: the mirror reference is what
// the hardware computes, so its errors are the pipes' errors. Tolerances are those of the contract,
// 16 u S for s and 16 u S + 4 u L for the witness points; nothing here widens them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "cde/fp.hpp"
#include "cde/reference/convex/obb_obb.hpp"
#include "cde/reference/convex/obb_plane.hpp"
#include "cde/reference/convex/sphere_obb.hpp"
#include "cde/reference/convex/sphere_sphere.hpp"
#include "cde/reference/convex/triangle_box.hpp"
#include "cde/reference/convex/triangle_sphere.hpp"
#include "convex_cases.hpp"
#include "counted.hpp"
#include "oracle/oracle.hpp"

namespace cde::testing {
namespace {

using oracle::Pair;
using reference::Outcome;
using reference::PlaneSide;

constexpr std::uint64_t kSeed = 20030;
constexpr int kCases = 24000;
constexpr int kDirected = 4000;

using Words = std::vector<double>;

template <template <class> class P, class S>
P<S> primitive(const Words& words) {
  std::array<S, P<S>::kWords> as_s;
  for (std::size_t i = 0; i < as_s.size(); ++i) as_s[i] = static_cast<S>(words.at(i));
  return from_words<P<S>>(as_s);
}

template <class S>
Outcome<S> run(Pair pair, const Words& a, const Words& b) {
  namespace r = reference;
  switch (pair) {
    case Pair::kSphereSphere:
      return r::sphere_sphere(primitive<BasicSphere, S>(a), primitive<BasicSphere, S>(b));
    case Pair::kTriangleSphere:
      return r::triangle_sphere(primitive<BasicTriangle, S>(a), primitive<BasicSphere, S>(b));
    case Pair::kSphereObb:
      return r::sphere_obb(primitive<BasicSphere, S>(a), primitive<BasicObb, S>(b));
    case Pair::kObbPlane:
      return r::obb_plane(primitive<BasicObb, S>(a), primitive<BasicPlane, S>(b));
    case Pair::kObbObb:
      return r::obb_obb(primitive<BasicObb, S>(a), primitive<BasicObb, S>(b));
    case Pair::kTriangleObb:
      return r::triangle_obb(primitive<BasicTriangle, S>(a), primitive<BasicObb, S>(b));
    case Pair::kTriangleAabb:
      return r::triangle_aabb(primitive<BasicTriangle, S>(a), primitive<BasicAabb, S>(b));
    default:
      throw std::logic_error("not a convex pair with a closed form");
  }
}

template <class S>
oracle::Result judged(const Outcome<S>& o) {
  const auto vec = [](const Vector3<S>& v) {
    return oracle::Vec(static_cast<double>(v.x()), static_cast<double>(v.y()),
                       static_cast<double>(v.z()));
  };
  return {o.f, static_cast<double>(o.t), vec(o.cp), vec(o.n)};
}

/// check(), and once more with a hundredfold budget if the oracle could not tell.
oracle::Verdict verdict(const oracle::Shape& a, const oracle::Shape& b, const oracle::Result& r,
                        oracle::CheckOptions options) {
  oracle::Verdict v = oracle::check(a, b, r, options);
  if (v.failure == oracle::Failure::kOracleTooWide) {
    options.gap.max_evaluations *= 100;
    v = oracle::check(a, b, r, options);
  }
  return v;
}

/// Worst errors of a set of cases, in units of u S; the witness points' as a share of tolP / u.
struct Worst {
  int cases = 0, hits = 0, in_band = 0, excused = 0, failed = 0;
  double c1 = 0, c2 = 0, witness = 0;

  void add(const Worst& w) {
    cases += w.cases, hits += w.hits, in_band += w.in_band, excused += w.excused;
    failed += w.failed;
    c1 = std::max(c1, w.c1), c2 = std::max(c2, w.c2), witness = std::max(witness, w.witness);
  }
};

template <class S>
Worst judge(const Outcome<S>& o, const oracle::Shape& a, const oracle::Shape& b, double u,
            std::string& message) {
  if (o.bad) {
    message = "flagged as bad input";
    return {.cases = 1, .failed = 1};
  }
  const oracle::Verdict v = verdict(a, b, judged(o), {.u = u, .gap = {}});
  if (!v.ok()) message = v.describe();
  const double us = u * v.scale;
  return {1,
          o.f,
          v.in_band,
          v.excused,
          !v.ok(),
          v.error_c1 / us,
          v.error_c2 / us,
          16 * std::max(v.witness_a, v.witness_b) / v.tolerance_p};
}

class Report {
 public:
  explicit Report(const std::string& title) {
    std::printf("%-32s %6s %6s %5s %7s %6s %6s %8s\n", title.c_str(), "cases", "hits", "band",
                "excused", "c1/uS", "c2/uS", "c3/16");
  }

  template <class S>
  void add(const std::string& family, const oracle::Case& c, double u) {
    const Outcome<S> o = run<S>(c.pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()});
    add(family, o, c.shape_a(), c.shape_b(), u, c.describe());
  }

  template <class S>
  void add(const std::string& family, const Outcome<S>& o, const oracle::Shape& a,
           const oracle::Shape& b, double u, const std::string& description) {
    std::string message;
    const Worst w = judge<S>(o, a, b, u, message);
    if (w.failed != 0 && ++shown_ <= 5) ADD_FAILURE() << message << '\n' << description;
    families_[family].add(w);
    all_.add(w);
  }

  const Worst& finish() {
    for (const auto& [name, w] : families_) line("  " + name, w);
    line("  all", all_);
    EXPECT_EQ(all_.failed, 0) << "certificates that fail";
    return all_;
  }

 private:
  static void line(const std::string& name, const Worst& w) {
    std::printf("%-32s %6d %5.1f%% %5d %7d %6.2f %6.2f %8.2f\n", name.c_str(), w.cases,
                100.0 * w.hits / w.cases, w.in_band, w.excused, w.c1, w.c2, w.witness);
  }

  std::map<std::string, Worst> families_;
  Worst all_;
  int shown_ = 0;
};

class ConvexPair : public ::testing::TestWithParam<Pair> {};

TEST_P(ConvexPair, CertificateHoldsNearContactAndInDirectedFamilies) {
  Report report(std::string(oracle::to_string(GetParam())) + ", seed " + std::to_string(kSeed));
  for (int i = 0; i < kCases; ++i) {
    const oracle::Case c = oracle::generate(GetParam(), kSeed, i);
    report.add<float>(c.family, c, 0x1p-24);
  }
  const Worst& all = report.finish();
  EXPECT_GT(all.hits, kCases * 3 / 10);
  EXPECT_LT(all.hits, kCases * 7 / 10);
  EXPECT_GT(all.in_band, 0) << "no case is near enough to touching to try F";
}

// Where normals are hardest: the nearest features change from vertex to edge to face within a hair,
// the distance is small, edges and faces are all but parallel, triangles all but a segment.
TEST_P(ConvexPair, CertificateHoldsWhereFeaturesChange) {
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
  EXPECT_GT(all.hits, all.cases / 10);
  EXPECT_GT(apart, all.cases / 10);
}

INSTANTIATE_TEST_SUITE_P(All, ConvexPair,
                         ::testing::Values(Pair::kSphereSphere, Pair::kTriangleSphere,
                                           Pair::kSphereObb, Pair::kObbPlane, Pair::kObbObb,
                                           Pair::kTriangleObb, Pair::kTriangleAabb),
                         [](const auto& info) {
                           std::string name = oracle::to_string(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

constexpr std::array kConvexPairs = {Pair::kSphereSphere, Pair::kTriangleSphere, Pair::kSphereObb,
                                     Pair::kObbPlane,     Pair::kObbObb,         Pair::kTriangleObb,
                                     Pair::kTriangleAabb};
constexpr int kFormatCases = 4000;

/// Errors scale with u. Sizes are kept where the format has room: squares that neither overflow nor
/// are subnormal, and boxes that rounding does not flatten.
template <class S>
void other_format(const char* name, double smallest, double largest) {
  for (const Pair pair : kConvexPairs) {
    Report report(std::string(name) + " " + oracle::to_string(pair));
    int used = 0;
    for (int i = 0; i < kFormatCases; ++i) {
      oracle::Case c = oracle::generate(pair, kSeed, i);
      const std::string family = c.family;
      const double size = oracle::scene_size(c.shape_a(), c.shape_b());
      const double far = oracle::largest_coordinate(c.shape_a(), c.shape_b());
      if (size < smallest || size > largest || far > largest) continue;
      if (family == "scale mismatch" || family == "needles and plates") continue;
      for (auto* words : {&c.a, &c.b})
        for (float& w : *words) w = static_cast<float>(static_cast<S>(w));
      report.add<S>("", c, reference::kUnitRoundoff<S>);
      ++used;
    }
    report.finish();
    EXPECT_GT(used, kFormatCases / 2);
  }
}

TEST(ConvexPairFormat, Fp16) {
  other_format<Fp16>("fp16", 2.5, 60);
}
TEST(ConvexPairFormat, Bf16) {
  other_format<Bf16>("bf16", 1e-6, 8);
}
TEST(ConvexPairFormat, Fp24) {
  other_format<Fp24>("fp24", 1e-4, 1e4);
}

/// The same shape with a rotation that is orthonormal in binary64, not only in binary32.
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
    for (const auto& v : vectors) words.insert(words.end(), {v.x(), v.y(), v.z()});
    words.insert(words.end(), rest);
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

// The oracle's interval is 1e-8 S wide, and that limits the check: 16 u S with u = 2^-29, which is
// 2^24 times binary64's.
TEST(ConvexPairFormat, Fp64) {
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

}  // namespace
}  // namespace cde::testing
