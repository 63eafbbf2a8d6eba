// SPDX-License-Identifier: Apache-2.0
// The reference itself: the vector code equals the template, and the template matches cases worked
// out by hand.
#include "cde/reference/reference.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "cases.hpp"

namespace cde::testing {
namespace {

const Triangle kPlain{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};

/// Expected records of the pass, from the template alone.
std::vector<Record> slow(const RayScene& scene, Mode mode, const Stencil& stencil,
                         Algorithm algorithm) {
  std::vector<Record> out;
  for (std::size_t first = 0; first < scene.rays.size(); first += 256) {
    const std::size_t end = std::min(first + 256, scene.rays.size());
    std::vector<Record> best(end - first);
    for (std::size_t j = 0; j < scene.triangles.size(); ++j) {
      for (std::size_t i = first; i < end; ++i) {
        if (stencil[i - first]) continue;
        const Record r =
            reference::record_of(scene.rays[i], scene.triangles[j], static_cast<std::uint32_t>(i),
                                 static_cast<std::uint32_t>(j), false, algorithm);
        if (mode == Mode::kAll || (mode == Mode::kHits && r.f)) out.push_back(r);
        Record& b = best[i - first];
        const bool keep =
            !b.f || (mode == Mode::kNearest ? r.t < b.t : mode == Mode::kFarthest && r.t > b.t);
        if (r.f && keep) b = r;
      }
    }
    if (mode == Mode::kAll || mode == Mode::kHits) continue;
    for (std::size_t i = first; i < end; ++i) {
      if (stencil[i - first]) continue;
      Record b = best[i - first];
      if (defect(scene.rays[i])) b = reference::record_of(scene.rays[i], kPlain, 0, 0);
      b.primary = static_cast<std::uint32_t>(i);
      out.push_back(b);
    }
  }
  return out;
}

void expect_same(const std::vector<Record>& a, const std::vector<Record>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same_bits(a[i], b[i])) << "record " << i;
}

TEST(Reference, VectorCode_EqualsTheTemplate) {
  Random random;
  Stencil some;
  for (std::size_t i = 0; i < 256; ++i) some[i] = random.below(4) == 0;
  for (const RayScene& scene : {beam(random, 300, 200), cloud(random, 700, 300), directed(),
                                beam(random, 1, 50, 0x1p-60f)}) {
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
      for (const Stencil& stencil : {Stencil(), some}) {
        for (const Algorithm algorithm : {Algorithm::kMoller, Algorithm::kWatertight}) {
          SCOPED_TRACE(fmt::format("{} {}", name_of(mode), name(algorithm)));
          ASSERT_TRUE(reference::has_fast_brute_force(algorithm, {}));
          expect_same(
              reference::cast(scene.rays, scene.triangles, mode, stencil, {}, false, {}, algorithm),
              slow(scene, mode, stencil, algorithm));
        }
      }
    }
  }
}

/// The pairs of one primary, in each mode: the record kept last is its result.
TEST(Reference, LastKeptPair_IsTheRecord) {
  Random random;
  const RayScene scene = beam(random, 20, 60);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    SCOPED_TRACE(name_of(mode));
    const std::vector<Record> all = reference::cast(scene.rays, scene.triangles, mode, {});
    for (std::uint32_t i = 0; i < scene.rays.size(); ++i) {
      const auto tested =
          reference::brute_force({.mode = mode}, Shapes(scene.rays), i, Shapes(scene.triangles));
      std::vector<Record> own, kept;
      for (const Record& r : all)
        if (r.primary == i) own.push_back(r);
      expect_same(tested.records, own);
      ASSERT_EQ(tested.pairs.size(), scene.triangles.size());
      for (const reference::BruteForcePair& p : tested.pairs) {
        EXPECT_EQ(p.candidate, p.record.f || mode == Mode::kAll);
        if (p.kept) kept.assign(1, p.record);
      }
      const bool streams = mode == Mode::kAll || mode == Mode::kHits;
      EXPECT_EQ(kept.empty(), streams || !own[0].f);
      if (!kept.empty()) expect_same(kept, own);
    }
  }
  // Pairs that do not count have no effect.
  const auto odd =
      reference::brute_force({.counts = [](std::uint32_t, std::uint32_t s) { return s % 2 == 1; }},
                             Shapes(scene.rays), 0, Shapes(scene.triangles));
  ASSERT_EQ(odd.pairs.size(), 30u);
  for (std::size_t i = 0; i < odd.pairs.size(); ++i) EXPECT_EQ(odd.pairs[i].secondary, 2 * i + 1);
  EXPECT_THROW((void)reference::brute_force({}, Shapes(scene.rays), 20, Shapes(scene.triangles)),
               Error);
}

struct Known {
  const char* name;
  Ray ray;
  Triangle triangle;
  bool f;
  float t;
  Eigen::Vector3f cp;

  friend void PrintTo(const Known& k, std::ostream* out) { *out << k.name; }
};

constexpr float kInf = std::numeric_limits<float>::infinity();

class ReferenceKnown : public ::testing::TestWithParam<Known> {};

TEST_P(ReferenceKnown, Case_HasItsOutcome) {
  const Known& known = GetParam();
  const Record r = reference::record_of(known.ray, known.triangle, 7, 3);
  EXPECT_EQ(r.f, known.f);
  EXPECT_FALSE(r.bad);
  EXPECT_EQ(r.t, known.t);
  EXPECT_EQ(r.cp, known.cp);
  EXPECT_EQ(r.index, known.f ? 3u : ~0u);
  EXPECT_EQ(r.primary, 7u);
}

const Eigen::Vector3f kOrigin(0, 0, 0);
INSTANTIATE_TEST_SUITE_P(
    Cases, ReferenceKnown,
    ::testing::Values(
        Known{"FrontFace", {{0.25f, 0.25f, 0}, {0, 0, 1}}, kPlain, true, 1, {0.25f, 0.25f, 1}},
        Known{"BackFace", {{0.25f, 0.25f, 3}, {0, 0, -4}}, kPlain, true, 0.5f, {0.25f, 0.25f, 1}},
        Known{"Corner", {{0, 0, 0}, {0, 0, 1}}, kPlain, true, 1, {0, 0, 1}},
        Known{"Hypotenuse", {{0.5f, 0.5f, 0}, {0, 0, 1}}, kPlain, true, 1, {0.5f, 0.5f, 1}},
        Known{"BesideTheEdge", {{-0.001f, 0.5f, 0}, {0, 0, 1}}, kPlain, false, kInf, kOrigin},
        Known{"Behind", {{0.25f, 0.25f, 2}, {0, 0, 1}}, kPlain, false, kInf, kOrigin},
        Known{"BehindButAllowed",
              {{0.25f, 0.25f, 2}, {0, 0, 1}, -2},
              kPlain,
              true,
              -1,
              {0.25f, 0.25f, 1}},
        Known{"EndsOnThePlane",
              {{0.25f, 0.25f, 0}, {0, 0, 1}, 0, 1},
              kPlain,
              true,
              1,
              {0.25f, 0.25f, 1}},
        Known{"EndsBefore",
              {{0.25f, 0.25f, 0}, {0, 0, 1}, 0, 0x1.fffffep-1f},
              kPlain,
              false,
              kInf,
              kOrigin},
        Known{
            "EmptyInterval", {{0.25f, 0.25f, 0}, {0, 0, 1}, 2, 0.5f}, kPlain, false, kInf, kOrigin},
        Known{"InThePlane", {{-1, 0.25f, 1}, {1, 0, 0}}, kPlain, false, kInf, kOrigin},
        Known{"NoArea",
              {{0, 0, 0}, {0, 0, 1}},
              {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
              false,
              kInf,
              kOrigin}),
    [](const auto& info) { return info.param.name; });

TEST(Reference, TiesAndZeros_KeepTheLowestIndex) {
  RayScene scene;
  scene.rays.push_back({.o = {0.25f, 0.25f, 1}, .d = {0, 0, 1}, .tmin = -1});
  // is +0 for one orientation and -0 for the other.
  scene.triangles = {kPlain, {kPlain.v0, kPlain.v2, kPlain.v1}, kPlain};
  for (int turn = 0; turn < 2; ++turn) {
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny}) {
      const auto records = reference::cast(scene.rays, scene.triangles, mode);
      ASSERT_EQ(records.size(), 1u);
      EXPECT_EQ(records[0].index, 0u) << name_of(mode);
    }
    std::swap(scene.triangles[0], scene.triangles[1]);
  }
}

TEST(Reference, ExactCases_DoubleEqualsFloat) {
  using V = Eigen::Vector3d;
  const auto r = reference::ray_triangle_moller<double>(V(0.25, 0.25, 0), V(0, 0, 2), 0.0, 10.0,
                                                        V(0, 0, 1), V(1, 0, 1), V(0, 1, 1));
  EXPECT_TRUE(r.f);
  EXPECT_EQ(r.t, 0.5);
  EXPECT_EQ(r.cp, V(0.25, 0.25, 1));
  const auto bad = reference::ray_triangle_moller<double>(V(0, 0, 0), V(0, 0, 0), 0.0, 1.0,
                                                          V(0, 0, 1), V(1, 0, 1), V(0, 1, 1));
  EXPECT_TRUE(bad.bad);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(bad.t), 0x7ff8000000000000u);
}

TEST(Checker, Difference_HasPairsForExplain) {
  const RayScene scene{{{{0.25f, 0.25f, 0}, {0, 0, 1}}}, {kPlain}};
  auto records = reference::cast(scene.rays, scene.triangles);
  reference::Checker right(scene.rays, scene.triangles, Mode::kNearest, {}, 256, "");
  right.compare(records);
  EXPECT_EQ(explain_lines(right), "");
  records[0].t = 2;
  reference::Checker wrong(scene.rays, scene.triangles, Mode::kNearest, {}, 256, "");
  wrong.compare(records);
  EXPECT_EQ(explain_lines(wrong),
            "\n  explain: cde explain ray-triangle --format fp32 --arith rtl --algorithm moller "
            "--no-box '0x3e800000 0x3e800000 0x00000000 0x00000000 0x00000000 0x3f800000 "
            "0x00000000 0x7f800000 | 0x00000000 0x00000000 0x3f800000 0x3f800000 0x00000000 "
            "0x3f800000 0x00000000 0x3f800000 0x3f800000'");
}

TEST(Checker, Difference_NamesItAndHowToRepeatIt) {
  Random random;
  const RayScene scene = beam(random, 10, 20);
  auto records = reference::cast(scene.rays, scene.triangles);
  const auto check = [&] {
    reference::Checker checker(scene.rays, scene.triangles, Mode::kNearest, {}, 256,
                               "cde cast x.stl");
    checker.check(records);
    checker.finish();
    return checker.compared();
  };
  EXPECT_EQ(check(), 10u);
  const auto expect_mismatch = [&](const std::string& text) {
    try {
      check();
      FAIL() << "no difference reported: " << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kMismatch);
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  const Record good = records[4];
  records[4].cp.y() = std::nextafter(good.cp.y(), 100.0f);
  expect_mismatch("ray 4: the card's record differs");
  expect_mismatch("repeat with: cde cast x.stl --ray=");
  records[4] = good;
  records.pop_back();
  expect_mismatch("card      no record");
  records.push_back(good);
  expect_mismatch("reference ray 9 ");
  records = reference::cast(scene.rays, scene.triangles);
  records.push_back(good);
  expect_mismatch("reference no record");
}

/// `cde cast` reports this: every record is compared, also after a difference.
TEST(Checker, Matches_AreCounted) {
  Random random;
  const RayScene scene = beam(random, 10, 20);
  const auto all = reference::cast(scene.rays, scene.triangles);
  const auto expect_counts = [&](const std::vector<Record>& records, std::uint64_t compared,
                                 std::uint64_t matching, const std::string& difference) {
    reference::Checker checker(scene.rays, scene.triangles, Mode::kNearest, {}, 256, "cde cast");
    for (std::size_t i = 0; i < records.size(); i += 3)
      checker.compare(std::span(records).subspan(i, std::min<std::size_t>(3, records.size() - i)));
    checker.compare_end();
    EXPECT_EQ(checker.compared(), compared);
    EXPECT_EQ(checker.matching(), matching);
    EXPECT_EQ(checker.difference().substr(0, difference.size()), difference);
    EXPECT_EQ(checker.difference().empty(), compared == matching);
  };
  expect_counts(all, 10, 10, "");
  auto records = all;
  records[4].t = std::nextafter(records[4].t, 0.0f);
  expect_counts(records, 10, 9, "ray 4: ");
  records[7].index ^= 1;
  expect_counts(records, 10, 8, "ray 4: ");
  records = all;
  records.pop_back();
  expect_counts(records, 10, 9, "ray 9: ");
  records.insert(records.end(), {all[9], all[9], all[9]});
  expect_counts(records, 12, 10, "ray 9: ");
}

}  // namespace
}  // namespace cde::testing
