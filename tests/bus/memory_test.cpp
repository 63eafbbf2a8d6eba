// SPDX-License-Identifier: Apache-2.0
// DDR with the timing of banks, rows and refresh: the records of ideal memory in nearly the same
// time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../board/cases.hpp"
#include "cde/mesh/terrain.hpp"

namespace cde::testing {
namespace {

struct MemorySetting {
  Bus bus;
  bool ecc;

  friend void PrintTo(const MemorySetting& s, std::ostream* out) {
    *out << (s.bus == Bus::kCycle ? "PCI" : "functional bus") << (s.ecc ? ", check bits" : "");
  }
};

class MemoryTimes : public ::testing::TestWithParam<MemorySetting> {
 protected:
  struct Ran {
    std::vector<Record> records;
    std::uint64_t ps;
    MemoryCounters memory;
  };
  /// Sixteen rays on sixteen lanes: one slot per cycle, the fastest rate of a card.
  static Ran run(Memory memory, std::uint32_t period_ps, std::span<const Triangle> triangles,
                 std::span<const Ray> rays) {
    BoardConfig config = host_config();
    config.bus = GetParam().bus;
    config.ecc = GetParam().ecc;
    OpenOptions options;
    options.memory = memory;
    options.clock_period_ps = period_ps;
    Board board = Board::open(config, options);
    board.upload(triangles);
    const std::uint64_t start = board.time_ps();
    board.load(rays);
    std::vector<Record> records = board.run({});
    return {std::move(records), board.time_ps() - start, board.memory_counters()};
  }
};

TEST_P(MemoryTimes, CycleMemory_IsNearlyAsFastAsIdeal) {
  const Mesh mesh = make_terrain({});
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
  Random random;
  std::vector<Ray> rays;
  const Eigen::AlignedBox3f box = bounds(mesh);
  for (int i = 0; i < 16; ++i) {
    const Eigen::Vector3f at(random.in(0, 1), random.in(0, 1), 1.1f);
    rays.push_back({.o = box.min() + box.sizes().cwiseProduct(at), .d = {0, 0, -1}});
  }
  // At 200 MHz the card needs the whole bandwidth of the modules. Uploads over PCI signals are
  // slow.
  std::vector<std::uint32_t> periods = {10'000};
  if (GetParam().bus == Bus::kFunctional) periods.push_back(5'000);
  for (const std::uint32_t period_ps : periods)
    for (const std::size_t count : {triangles.size(), std::size_t{40}}) {
      const auto some = std::span<const Triangle>(triangles).first(count);
      const Ran ideal = run(Memory::kIdeal, period_ps, some, rays);
      const Ran cycle = run(Memory::kCycle, period_ps, some, rays);
      SCOPED_TRACE(fmt::format("{} triangles, {} MHz", count, 1'000'000 / period_ps));
      ASSERT_EQ(ideal.records.size(), cycle.records.size());
      for (std::size_t i = 0; i < ideal.records.size(); ++i)
        ASSERT_TRUE(same_bits(ideal.records[i], cycle.records[i])) << i;
      std::printf(
          "%6zu triangles, core %u MHz: ideal %.3f us, cycle %.3f us; %llu bursts, %llu row "
          "misses, %llu refreshes\n",
          count, 1'000'000 / period_ps, static_cast<double>(ideal.ps) * 1e-6,
          static_cast<double>(cycle.ps) * 1e-6,
          static_cast<unsigned long long>(cycle.memory.bursts),
          static_cast<unsigned long long>(cycle.memory.row_misses),
          static_cast<unsigned long long>(cycle.memory.refreshes));
      EXPECT_NEAR(static_cast<double>(ideal.ps), static_cast<double>(cycle.ps),
                  0.05 * static_cast<double>(cycle.ps));
      EXPECT_EQ(ideal.memory.bursts, 0u);
      // Two triangles of 36 bytes per burst of 72 bytes. A refresh reopens rows of 36,864 bytes.
      EXPECT_EQ(cycle.memory.bursts, (count + 1) / 2);
      EXPECT_GE(cycle.memory.row_misses, count * 36 / 36'864 + 1);
      EXPECT_LE(cycle.memory.row_misses, count * 36 / 36'864 + 1 + cycle.memory.refreshes * 2);
      if (count > 1000) {
        // One refresh per 7.8125 us of the time in which DDR is read.
        const double passes = static_cast<double>(count * period_ps) / 7'812'500;
        EXPECT_NEAR(static_cast<double>(cycle.memory.refreshes), passes, 0.05 * passes + 1);
      }
    }
}
INSTANTIATE_TEST_SUITE_P(
    Cards, MemoryTimes,
    ::testing::Values(MemorySetting{Bus::kFunctional, false}, MemorySetting{Bus::kFunctional, true},
                      MemorySetting{Bus::kCycle, false}, MemorySetting{Bus::kCycle, true}),
    [](const auto& info) {
      return std::string(info.param.bus == Bus::kCycle ? "Cycle" : "Functional") +
             (info.param.ecc ? "Ecc" : "");
    });

}  // namespace
}  // namespace cde::testing
