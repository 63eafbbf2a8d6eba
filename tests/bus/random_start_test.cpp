// SPDX-License-Identifier: Apache-2.0
// Cards after power-up: every register is random, and inputs are random before the reset
// (verilator/models/random_start.h). Results equal the results of a card that starts with zeros,
// cycle for cycle, on both buses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "../board/board_configs.hpp"
#include "../printed.hpp"
#include "cde/scene/scene.hpp"
#include "cde/scene/scene_runner.hpp"

namespace cde::testing {
namespace {

constexpr const char* kTurning =
    "motion = { kind = \"velocity\", linear = [1, -2, 1], angular = [20, 30, 40] }\n";

std::string object(const char* shape, unsigned count, const char* motion) {
  const bool sized = std::string(shape) != "plane";
  return fmt::format(
      "[[object]]\nname = \"{0}\"\nrandom = {{ shape = \"{0}\", count = {3}, seed = 5, "
      "min = [-2, -2, -2], max = [2, 2, 2]{1} }}\n{2}",
      shape, sized ? ", size = [0.3, 1.5]" : "", motion, count);
}

std::vector<Pair> every_pair() {
  std::vector<Pair> all;
  for (unsigned p = 0; p < kPairs; ++p) all.push_back(static_cast<Pair>(p));
  return all;
}

/// Every shape and every mode: one query per pair, or one per mode if there are few pairs.
std::string scene_of(const BoardConfig& card) {
  const bool few = card.pairs.size() < 5;
  const unsigned count = few ? 40 : 7;
  static constexpr const char* kModes[] = {"nearest", "farthest", "any", "all", "hits"};
  std::string text =
      "frames = 2\n[[object]]\nname = \"ray\"\nrandom_rays = { count = 9, half_angle = 30 }\n"
      "motion = { kind = \"still\", position = [0, 0, 5] }\n";
  for (const char* shape : {"triangle", "sphere", "plane", "cylinder", "obb"})
    text += object(shape, count, kTurning);
  text += object("aabb", count, "");
  unsigned mode = 0;
  for (const Pair pair : card.pairs) {
    const unsigned first = few ? 0 : mode++ % 5;
    for (unsigned m = first; m < (few ? 5 : first + 1); ++m)
      text += fmt::format(
          "[[query]]\nname = \"{0}-{3}\"\npair = \"{0}\"\nprimaries = \"{1}\"\nsecondaries = "
          "\"{2}\"\n"
          "mode = \"{3}\"\nnormals = {4}\n",
          name(pair), name(primary_shape(pair)), name(secondary_shape(pair)), kModes[m],
          is_solid(pair) && card.normals);
  }
  return text;
}

/// A card and its bus.
struct Start {
  const char* name;
  Bus bus;
  bool every = true;  ///< every pair and option, or two pairs
};
void PrintTo(const Start& start, std::ostream* out) {
  *out << start.name;
}

BoardConfig card_of(const Start& start) {
  if (!start.every) return rich_config(start.bus);
  return {.lanes = 1,
          .pairs = every_pair(),
          .swap = true,
          .normals = true,
          .parallel = true,
          .sat_interval = 3,
          .transform = Transformer::kBoth,
          .ddr_slots = 4000,
          .sram_records = 1024,
          .bus = start.bus,
          .ecc = true};
}

/// Cycles of every query and the bus time, after a check of every record.
struct SceneRun {
  std::vector<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>> cycles;
  std::uint64_t hits = 0, compared = 0;
};

SceneRun play(const Start& start, unsigned seed) {
  setenv("CDE_RANDOM_SEED", std::to_string(seed).c_str(), 1);
  const BoardConfig card = card_of(start);
  const Scene scene = parse_scene(scene_of(card), "pairs.toml");
  Plan p = plan(scene);
  p.board = card;
  SceneRunner runner(scene, p, {});
  SceneRun ran;
  for (const std::uint32_t frame : {0u, 1u})
    for (const QueryFrame& f : runner.run_frame(frame, {})) {
      EXPECT_EQ(f.mismatches, 0u) << f.first_mismatch;
      EXPECT_EQ(f.compared, f.counters.records);
      ran.cycles.emplace_back(f.counters.cycles, f.secondary_cycles, f.download_cycles);
      ran.hits += f.hits;
      ran.compared += f.compared;
    }
  return ran;
}

class RandomStart : public ::testing::TestWithParam<Start> {
 protected:
  void SetUp() override { setenv("CDE_RANDOM_START", "1", 1); }
  void TearDown() override {
    unsetenv("CDE_RANDOM_START");
    unsetenv("CDE_RANDOM_SEED");
  }
};

TEST_P(RandomStart, RandomRegisters_ChangeNothing) {
  const unsigned seeds = std::getenv("CDE_FULL") != nullptr ? 20 : 3;
  const SceneRun zeros = play(GetParam(), 0);
  const unsigned least = GetParam().every ? 100 : 10;
  EXPECT_GT(zeros.hits, least);
  EXPECT_GT(zeros.compared, zeros.hits + least);
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(fmt::format("CDE_RANDOM_SEED={}", seed));
    EXPECT_EQ(play(GetParam(), seed).cycles, zeros.cycles);
  }
}
INSTANTIATE_TEST_SUITE_P(Cards, RandomStart,
                         ::testing::Values(Start{"TwoPairsPci", Bus::kCycle, false},
                                           Start{"EveryPairFunctional", Bus::kFunctional},
                                           Start{"EveryPairPci", Bus::kCycle}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cde::testing
