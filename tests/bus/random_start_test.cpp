// SPDX-License-Identifier: Apache-2.0
// Cards as power leaves them: every register random and inputs random before the reset
// (verilator/models/random_start.h). What comes out is what a card that starts as zeros gives,
// clock for clock, on both buses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "../printed.hpp"
#include "cde/scene/player.hpp"
#include "cde/scene/scene.hpp"

namespace cde::testing {
namespace {

constexpr const char* kTurning =
    "motion = { kind = \"velocity\", linear = [1, -2, 1], angular = [20, 30, 40] }\n";

std::string object(const char* shape, const char* motion) {
  const bool sized = std::string(shape) != "plane";
  return fmt::format(
      "[[object]]\nname = \"{0}\"\nrandom = {{ shape = \"{0}\", count = 7, seed = 5, "
      "min = [-2, -2, -2], max = [2, 2, 2]{1} }}\n{2}",
      shape, sized ? ", size = [0.3, 1.5]" : "", motion);
}

std::vector<Pair> pairs() {
  std::vector<Pair> all;
  for (unsigned p = 0; p < kPairs; ++p) all.push_back(static_cast<Pair>(p));
  return all;
}

/// Every shape, every pair, every mode.
std::string every_pair() {
  static constexpr const char* kModes[] = {"nearest", "farthest", "any", "all", "hits"};
  std::string text =
      "frames = 2\n[[object]]\nname = \"ray\"\nrandom_rays = { count = 9, half_angle = 30 }\n"
      "motion = { kind = \"still\", position = [0, 0, 5] }\n";
  for (const char* shape : {"triangle", "sphere", "plane", "cylinder", "obb"})
    text += object(shape, kTurning);
  text += object("aabb", "");
  unsigned mode = 0;
  for (const Pair pair : pairs()) {
    text += fmt::format(
        "[[query]]\nname = \"{0}\"\npair = \"{0}\"\nprimaries = \"{1}\"\nsecondaries = \"{2}\"\n"
        "mode = \"{3}\"\nnormals = {4}\n",
        name(pair), name(primary_shape(pair)), name(secondary_shape(pair)), kModes[mode++ % 5],
        is_solid(pair));
  }
  return text;
}

BoardConfig everything(Bus bus) {
  return {.lanes = 1,
          .pairs = pairs(),
          .swap = true,
          .normals = true,
          .parallel = true,
          .facet_interval = 3,
          .transform = Transformer::kBoth,
          .ddr_slots = 4000,
          .sram_records = 1024,
          .bus = bus,
          .ecc = true};
}

/// Clocks of every query, when every record was right; with what the bus took.
struct Played {
  std::vector<std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>> clocks;
  std::uint64_t hits = 0, compared = 0;
};

Played play(Bus bus, unsigned seed) {
  setenv("CDE_RANDOM_SEED", std::to_string(seed).c_str(), 1);
  const Scene scene = parse_scene(every_pair(), "every_pair.toml");
  Plan p = plan(scene);
  p.board = everything(bus);
  Player player(scene, p, {});
  Played played;
  for (const std::uint32_t frame : {0u, 1u})
    for (const QueryFrame& f : player.play(frame, {})) {
      EXPECT_EQ(f.mismatches, 0u) << f.first_mismatch;
      EXPECT_EQ(f.compared, f.counters.records);
      played.clocks.emplace_back(f.counters.cycles, f.secondary_clocks, f.download_clocks);
      played.hits += f.hits;
      played.compared += f.compared;
    }
  return played;
}

class RandomStart : public ::testing::TestWithParam<Bus> {
 protected:
  void SetUp() override { setenv("CDE_RANDOM_START", "1", 1); }
  void TearDown() override {
    unsetenv("CDE_RANDOM_START");
    unsetenv("CDE_RANDOM_SEED");
  }
};

TEST_P(RandomStart, ChangesNothing) {
  const unsigned seeds = std::getenv("CDE_FULL") != nullptr ? 20 : 3;
  const Played zeros = play(GetParam(), 0);
  EXPECT_GT(zeros.hits, 100u);
  EXPECT_GT(zeros.compared, zeros.hits + 100);
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE(fmt::format("CDE_RANDOM_SEED={}", seed));
    EXPECT_EQ(play(GetParam(), seed).clocks, zeros.clocks);
  }
}
INSTANTIATE_TEST_SUITE_P(Buses, RandomStart, ::testing::Values(Bus::kFunctional, Bus::kCycle),
                         [](const auto& info) {
                           return info.param == Bus::kCycle ? "Pci" : "Functional";
                         });

}  // namespace
}  // namespace cde::testing
