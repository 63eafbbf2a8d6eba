// SPDX-License-Identifier: Apache-2.0
// Modelled time of the functional bus, compared with a card whose PCI signals are simulated cycle
// by cycle. Records are the same, and times agree within 5 %.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../board/cases.hpp"

namespace cde::testing {
namespace {

constexpr double kTolerance = 0.05;
constexpr std::array kModes = {Mode::kNearest, Mode::kAny, Mode::kAll, Mode::kHits};

struct TimeSetting {
  const char* host;
  std::uint32_t burst;
  bool narrow;
  std::uint32_t period_ps;
};
std::string text(const TimeSetting& s) {
  return fmt::format("{}, bursts of {}, {} bits, {} MHz", s.host, s.burst, s.narrow ? 32 : 64,
                     1'000'000 / s.period_ps);
}

/// The same card on both kinds of bus.
class Twins {
 public:
  Twins(const BoardConfig& config, const TimeSetting& s)
      : functional_(open(config, Bus::kFunctional, s)), cycle_(open(config, Bus::kCycle, s)) {}

  /// Modelled picoseconds of `f` on both boards.
  struct Times {
    double functional, cycle;
    [[nodiscard]] double ratio() const { return functional / cycle; }
    Times& operator+=(const Times& other) {
      functional += other.functional;
      cycle += other.cycle;
      return *this;
    }
  };
  template <class F>
  Times time(const F& f) {
    const auto one = [&](Board& board) {
      const std::uint64_t start = board.time_ps();
      f(board);
      return static_cast<double>(board.time_ps() - start);
    };
    return {one(functional_), one(cycle_)};
  }
  Board& functional() { return functional_; }
  Board& cycle() { return cycle_; }

 private:
  static Board open(BoardConfig config, Bus bus, const TimeSetting& s) {
    config.bus = bus;
    OpenOptions o;
    o.host = *host_profile(s.host);
    o.bus_burst = s.burst;
    o.narrow_bus = s.narrow;
    o.clock_period_ps = s.period_ps;
    return Board::open(config, o);
  }
  Board functional_, cycle_;
};

void expect_close(const Twins::Times& t, const std::string& what) {
  EXPECT_NEAR(t.functional, t.cycle, kTolerance * t.cycle) << what;
}

/// Uploads a scene and runs it in every mode; checks that the times agree.
void compare(Twins& twins, const RayScene& scene, const std::string& name) {
  Twins::Times total = twins.time([&](Board& b) { b.upload(scene.triangles, false); });
  expect_close(total, "upload, " + name);
  std::string line = fmt::format("{:<46} upload {:.3f}", name, total.ratio());
  for (const Mode mode : kModes) {
    std::vector<std::vector<Record>> records;
    std::vector<Counters> counters(2);
    const Twins::Times t = twins.time([&](Board& b) {
      b.load(scene.rays);
      records.push_back(b.run({.mode = mode}, &counters[records.size()]));
    });
    expect_close(t, fmt::format("load and run, mode {}, {}", name_of(mode), name));
    EXPECT_DOUBLE_EQ(static_cast<double>(counters[0].time.total()), t.functional)
        << "sum of its parts";
    EXPECT_DOUBLE_EQ(static_cast<double>(counters[1].time.total()), t.cycle) << "sum of its parts";
    EXPECT_EQ(counters[0].pairs, counters[1].pairs);
    ASSERT_EQ(records[0].size(), records[1].size());
    for (std::size_t i = 0; i < records[0].size(); ++i)
      ASSERT_TRUE(same_bits(records[0][i], records[1][i])) << i;
    line += fmt::format("  {} {:.3f}", name_of(mode), t.ratio());
    total += t;
  }
  expect_close(total, "all of it, " + name);
  std::printf("%s  total %.3f of %.3f ms\n", line.c_str(), total.ratio(), total.cycle * 1e-9);
}

class BusTimes : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(BusTimes, FunctionalBus_MatchesSignalTimes) {
  Random random;
  const RayScene scene = cloud(random, 64, 300);
  for (const char* host : {"ideal", "good", "p64-2001"})
    for (const std::uint32_t burst : {256u, 4096u})
      for (const bool narrow : {false, true}) {
        const TimeSetting s = {host, burst, narrow, GetParam()};
        SCOPED_TRACE(text(s));
        Twins twins(host_config(), s);
        for (const std::size_t triangles : {1, 40, 5000}) {
          const RayScene part = cloud(random, 1, triangles);
          const auto t = twins.time([&](Board& b) { b.upload(part.triangles, false); });
          expect_close(t, fmt::format("upload of {}, {}", triangles, text(s)));
        }
        compare(twins, scene, text(s));
      }
}
INSTANTIATE_TEST_SUITE_P(CorePeriods, BusTimes, ::testing::Values(20'000u, 10'000u, 5'000u));

/// Whenever the record ring is full, the pass waits for the host.
TEST(BusTimesFullRing, FullRing_MatchesSignalTimes) {
  Random random;
  const RayScene scene = cloud(random, 60, 100);
  for (const char* host : {"ideal", "good", "p64-2001"}) {
    const TimeSetting s = {host, 256, false, 10'000};
    SCOPED_TRACE(text(s));
    Twins twins(small_config(), s);
    compare(twins, scene, text(s));
  }
}

TEST(BusTimesCounters, Counters_MatchTheSignals) {
  Random random;
  const RayScene scene = cloud(random, 100, 500);
  for (const char* host : {"ideal", "p64-2001"}) {
    Twins twins(host_config(), {host, 256, false, 10'000});
    const auto counted = [&](Board& b) {
      const BusCounters before = b.bus_counters();
      b.upload(scene.triangles, false);
      b.load(scene.rays);
      (void)b.run({.mode = Mode::kAll});
      BusCounters c = b.bus_counters();
      c.transfers -= before.transfers;
      c.bytes_to_card -= before.bytes_to_card;
      c.bytes_to_host -= before.bytes_to_host;
      c.pci_busy -= before.pci_busy;
      c.pci_data -= before.pci_data;
      c.register_accesses -= before.register_accesses;
      return c;
    };
    const BusCounters f = counted(twins.functional()), c = counted(twins.cycle());
    EXPECT_EQ(f.transfers, c.transfers);
    EXPECT_EQ(f.bytes_to_card, c.bytes_to_card);
    EXPECT_EQ(f.bytes_to_host, c.bytes_to_host);
    const auto close = [&](const char* what, std::uint64_t a, std::uint64_t b) {
      std::printf("%s, %s: %llu, signals %llu\n", host, what, static_cast<unsigned long long>(a),
                  static_cast<unsigned long long>(b));
      EXPECT_NEAR(static_cast<double>(a), static_cast<double>(b),
                  kTolerance * static_cast<double>(b));
    };
    close("busy cycles", f.pci_busy, c.pci_busy);
    close("data cycles", f.pci_data, c.pci_data);
    close("register accesses", f.register_accesses, c.register_accesses);
  }
}

}  // namespace
}  // namespace cde::testing
