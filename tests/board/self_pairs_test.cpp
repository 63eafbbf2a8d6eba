// SPDX-License-Identifier: Apache-2.0
// Pairs of a shape with itself, and pairs that a query would report from both sides. The scene
// runner leaves out the same pairs as a selection by hand from the records of all pairs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "../printed.hpp"
#include "cde/scene/scene_runner.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

/// Uses the model of the object tests if the card moves objects, else the model of the sphere
/// tests.
Plan planned(const Scene& scene) {
  Plan p = plan(scene);
  const bool moves = p.board.transform != Transformer::kNone;
  p.board = BoardConfig{};
  p.board.lanes = 8;
  if (moves) {
    p.board.pairs = {Pair::kRayTriangle, Pair::kSphereSphere, Pair::kRayCylinder, Pair::kObbPlane};
    p.board.transform = Transformer::kBoth;
    p.board.ddr_slots = 4000;
    p.board.sram_records = 1024;
  } else {
    p.board.pairs = {Pair::kSphereSphere};
    p.board.normals = true;
    p.board.ddr_slots = 1000;
    p.board.sram_records = 64;
  }
  p.board.swap = true;
  return p;
}

struct Case {
  const char* name;
  std::string card, objects, primaries, secondaries, mask;
};

std::string balls(const char* name, unsigned count, unsigned seed, const char* motion = "") {
  return fmt::format(
      "[[object]]\nname = \"{}\"\nrandom = {{ shape = \"sphere\", count = {}, seed = {}, "
      "min = [-3, -3, -3], max = [3, 3, 3], size = [0.1, 0.7] }}\n{}",
      name, count, seed, motion);
}
const char* const kMoving =
    "motion = { kind = \"velocity\", linear = [1, -2, 1], angular = [20, 30, 40] }\n";

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"one_object", "", balls("a", 300, 1), R"("a")", R"("a")", ""},
      {"one_packet", "", balls("a", 40, 2), R"("a")", R"("a")", ""},
      {"masked", "", balls("a", 270, 3), R"("a")", R"("a")", "mask = [0, \"5..9\", 255, 269]\n"},
      {"overlapping_lists", "", balls("a", 150, 4) + balls("b", 130, 5) + balls("c", 30, 6),
       R"(["a", "b"])", R"(["b", "c", "a"])", ""},
      {"part", "", balls("a", 100, 7) + balls("b", 20, 8), R"("a")", R"(["b", "a"])", ""},
      {"moved_by_the_card", "[card]\ntransform_site = \"card\"\n",
       balls("a", 60, 9, kMoving) + balls("b", 50, 10), R"(["a", "b"])", R"(["a", "b"])", ""},
      {"alone", "", balls("a", 1, 11) + balls("b", 3, 12), R"(["b"])", R"(["b"])", "mask = [1]\n"},
  };
  return all;
}

struct SceneRun {
  std::vector<Record> records;
  QueryFrame frame;
};

SceneRun run_scene(const Case& c, Mode mode, bool self, Scene& scene) {
  scene = parse_scene(
      fmt::format("frames = 10\n{}{}[[query]]\nname = \"q\"\npair = \"sphere-sphere\"\n"
                  "primaries = {}\nsecondaries = {}\nmode = \"{}\"\n{}{}{}",
                  c.card, c.objects, c.primaries, c.secondaries, name_of(mode), c.mask,
                  self ? "self = true\n" : "", c.card.empty() ? "normals = true\n" : ""),
      "s.toml");
  const Plan plan = planned(scene);
  SceneRunner runner(scene, plan, {});
  SceneRun p;
  p.frame = runner.run_frame(3, [&](std::size_t, std::span<const Record> some) {
    p.records.insert(p.records.end(), some.begin(), some.end());
  })[0];
  EXPECT_EQ(p.frame.mismatches, 0u) << p.frame.first_mismatch;
  EXPECT_EQ(p.frame.compared, p.records.size());
  EXPECT_EQ(p.frame.counters.records, p.records.size());
  EXPECT_GE(p.frame.card_records, p.records.size());
  return p;
}

/// The shape of each number on one side: object and member.
std::vector<std::pair<std::size_t, std::size_t>> things(const Scene& scene,
                                                        const std::vector<std::size_t>& objects) {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (const std::size_t o : objects)
    for (std::size_t i = 0; i < size(scene.objects[o].shapes); ++i) all.emplace_back(o, i);
  return all;
}

class SelfPairs : public ::testing::TestWithParam<std::tuple<std::size_t, Mode>> {};

double signed_t(const Record& r) {
  return r.f ? -static_cast<double>(r.t) : static_cast<double>(r.t);
}

TEST_P(SelfPairs, PairsOfAQueryWithItself_CountOnce) {
  const Case& c = cases()[std::get<0>(GetParam())];
  const Mode mode = std::get<1>(GetParam());
  Scene scene;
  const SceneRun all = run_scene(c, Mode::kAll, true, scene);
  const auto primary = things(scene, scene.queries[0].primaries);
  const auto secondary = things(scene, scene.queries[0].secondaries);
  ASSERT_EQ(all.frame.card_records, all.records.size());
  const SceneRun got = run_scene(c, mode, false, scene);

  std::set<std::uint32_t> active;
  for (const Record& r : all.records) active.insert(r.primary);
  // Primary number of each shape.
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> asks;
  for (const std::uint32_t p : active) asks[primary[p]] = p;
  const std::set tested(secondary.begin(), secondary.end());

  const bool pairwise = mode == Mode::kAll || mode == Mode::kHits;
  std::vector<Record> expected;
  std::map<std::uint32_t, Record> best;
  for (const std::uint32_t p : active) best[p].primary = p;
  for (const Record& r : all.records) {  // packet by packet, secondaries ascending
    const auto a = primary[r.primary], b = secondary[r.index];
    if (a == b) continue;
    if (pairwise) {
      // The same pair from the other side.
      const auto other = asks.find(b);
      if (other != asks.end() && tested.contains(a) && other->second < r.primary) continue;
      if (mode == Mode::kAll || r.f) expected.push_back(r);
      continue;
    }
    Record& kept = best[r.primary];
    const bool none = kept.index == ~0u;
    const bool better = mode == Mode::kAny       ? none && r.f
                        : mode == Mode::kNearest ? none || signed_t(r) < signed_t(kept)
                                                 : none || signed_t(r) > signed_t(kept);
    if (better) kept = r;
  }
  if (!pairwise)
    for (const auto& [p, r] : best) expected.push_back(r);

  ASSERT_EQ(got.records.size(), expected.size());
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(same_bits(got.records[i], expected[i]))
        << i << ": " << differing_fields(got.records[i], expected[i]);
    hits += expected[i].f ? 1 : 0;
  }
  EXPECT_EQ(got.frame.hits, hits);
  EXPECT_LT(hits, all.frame.hits) << "no pair was left out";
  // The farthest record of many is no hit, and three shapes have too few pairs.
  if (mode != Mode::kFarthest && std::string_view(c.name) != "alone") {
    EXPECT_GT(hits, 5u);
  }
  // The plan and the run agree.
  const QueryWork work = plan(scene).queries[0];
  EXPECT_TRUE(work.self_pairs);
  if (c.card.empty()) {
    EXPECT_EQ(got.frame.passes, work.passes);
    if (mode != Mode::kAny) {
      EXPECT_EQ(got.frame.counters.pairs, work.tests);
    }
  }
  if (mode != Mode::kHits) {
    EXPECT_EQ(work.most_records, expected.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, SelfPairs,
                         ::testing::Combine(::testing::Range<std::size_t>(0, 7),
                                            ::testing::Values(Mode::kNearest, Mode::kFarthest,
                                                              Mode::kAny, Mode::kAll, Mode::kHits)),
                         [](const auto& info) {
                           return fmt::format("{}_{}", cases()[std::get<0>(info.param)].name,
                                              name_of(std::get<1>(info.param)));
                         });

/// Half of the tests, and no records of pairs that precede their own packet.
TEST(SelfPairsCost, OneSidedPass_BeginsAfterItsPacket) {
  const Case& c = cases()[0];
  Scene scene;
  const SceneRun once = run_scene(c, Mode::kHits, false, scene);
  EXPECT_EQ(once.frame.passes, 2u);
  EXPECT_EQ(once.frame.counters.pairs, 256u * 299 + 44 * 43);
  const SceneRun twice = run_scene(c, Mode::kHits, true, scene);
  EXPECT_EQ(twice.frame.hits, 2 * once.frame.hits + 300)
      << "pairs from both sides, and each shape with itself";
}

}  // namespace
}  // namespace cde::testing
