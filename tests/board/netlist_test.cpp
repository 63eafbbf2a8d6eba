// SPDX-License-Identifier: Apache-2.0
// The netlist of the card for one FPGA (tools/synthesis simulate), run by the driver.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "bvh_cards.hpp"
#include "cde/card/board.hpp"

namespace cde::testing {
namespace {

using namespace hard;
using namespace through;

constexpr std::uint32_t kMemoryCycles = 8;
constexpr unsigned kTriangles = 100;

/// The parameters of the netlist: words NAME=VALUE of $CDE_NETLIST_CARD.
std::vector<std::string> netlist_parameters() {
  const char* const given = std::getenv("CDE_NETLIST_CARD");
  std::istringstream words(given != nullptr ? given : "");
  std::vector<std::string> parameters = {"ARITH=rtl"};
  for (std::string word; words >> word;) parameters.push_back(word);
  return parameters;
}

/// The driver's configuration for them. The driver reads the number of primaries from the card.
BoardConfig configuration(std::vector<std::string> parameters) {
  std::erase_if(parameters, [](const std::string& p) { return p.starts_with("PRIMARIES="); });
  const auto config = BoardConfig::of(parameters);
  if (!config) throw Error(ErrorCode::kUsage, "CDE_NETLIST_CARD has a parameter that no card has");
  return *config;
}

struct CountedCast {
  std::vector<Record> records;
  std::uint64_t cycles = 0;
};
CountedCast cast_and_count(Board& board, const std::vector<Ray>& rays, Through through) {
  CountedCast cast;
  cast.cycles = board
                    .cast(rays, {.pair = Pair::kRayTriangle, .through = through},
                          [&](std::span<const Record> some) {
                            cast.records.insert(cast.records.end(), some.begin(), some.end());
                          })
                    .cycles;
  return cast;
}

TEST(Netlist, TreeAndSweep_EqualTheRtl) {
  const char* const file = std::getenv("CDE_NETLIST");
  if (file == nullptr)
    GTEST_SKIP() << "CDE_NETLIST names no netlist model (tests/synthesis/netlist sets it)";
  const std::vector<std::string> parameters = netlist_parameters();
  const BoardConfig config = configuration(parameters);
  Board netlist =
      Board::open(config, {.file = file, .config_hash = 0, .ddr_latency = kMemoryCycles});
  Board rtl = Board::open(config, {.file = model_path("fpga_card", parameters),
                                   .config_hash = model_hash("fpga_card", parameters),
                                   .ddr_latency = kMemoryCycles});
  TriangleScene scene = kScenes[6].make();  // terrain
  scene.resize(kTriangles);
  const Bvh bvh = Bvh::build(scene);
  const char* const count = std::getenv("CDE_NETLIST_RAYS");
  const std::vector<Ray> rays = hard_rays(scene, count != nullptr ? std::stoul(count) : 1000);
  const std::vector<Record> should = expected(scene, bvh, rays, Mode::kNearest);
  for (Board* board : {&netlist, &rtl}) board->upload(scene, bvh);
  for (const Through through : {Through::kBvh, Through::kBruteForce}) {
    SCOPED_TRACE(through == Through::kBvh ? "tree" : "sweep");
    const CountedCast got = cast_and_count(netlist, rays, through),
                      wanted = cast_and_count(rtl, rays, through);
    const unsigned hits = expect_same(got.records, should);
    EXPECT_GT(hits, 0u);
    EXPECT_EQ(expect_same(wanted.records, should), hits);
    EXPECT_EQ(got.cycles, wanted.cycles);
    std::cout << rays.size() << " rays, " << scene.size() << " triangles, " << hits << " hits, "
              << got.cycles << " cycles\n";
  }
}

}  // namespace
}  // namespace cde::testing
