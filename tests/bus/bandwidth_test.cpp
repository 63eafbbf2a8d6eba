// SPDX-License-Identifier: Apache-2.0
// Bandwidth of the bus: the peak, the published figures that the profile of 2001 is fitted to, and
// a table.
#include <cstdio>
#include <cstdlib>

#include "bus_card.hpp"
#include "cde/card/host_profile.hpp"

namespace cde::testing {
namespace {

constexpr double kPeak = 8 / 15e-9;  // bytes per second
constexpr std::uint32_t kData = BusCard::kFirstFree * 4096;

/// Seconds from the write of the tail register to the interrupt.
double seconds(BusCard& card, std::uint32_t bytes, bool to_host) {
  card.stage(BusCard::descriptor(kData, bytes, card::kSpaceDdr, 0, to_host));
  const std::uint64_t start = card.api().time_ps(card.handle());
  card.publish();
  card.api().run(card.handle(), 1'000'000'000'000, 1);
  const std::uint64_t end = card.api().time_ps(card.handle());
  EXPECT_EQ(card.wait().code, pci::kCodeOk);
  card.write(pci::kRegIrqStatus, 1u << pci::kIrqCompletion);
  return static_cast<double>(end - start) * 1e-12;
}

struct Link : BusCard {
  Link(const std::string& profile, std::uint32_t burst)
      : BusCard({.profile = profile, .core_period_ps = 5'000}) {
    enumerate(0x146, 255);
    map_range(0, kFirstFree + 1023);
    start_ring(16, burst);
  }
  /// Bytes per second of the data alone: descriptor, record and host accesses cancel out.
  double rate(bool to_host) {
    const double less = seconds(*this, 16'384, to_host), more = seconds(*this, 212'992, to_host);
    return (212'992 - 16'384) / (more - less);
  }
};

TEST(PciBandwidth, IdealHost_ReachesNineTenthsOfThePeak) {
  Link link("ideal", 4096);
  EXPECT_GE(link.rate(false), 0.9 * kPeak);
  EXPECT_GE(link.rate(true), 0.9 * kPeak);
  EXPECT_GE(4'194'304 / seconds(link, 4'194'304, false), 0.9 * kPeak)
      << "including descriptor and record";
}

/// Published: 147 MB/s with 256-byte read bursts, 315 MB/s with 512-byte write bursts.
TEST(PciBandwidth, HostOf2001_HasThePublishedRates) {
  EXPECT_NEAR(Link("p64-2001", 256).rate(false), 147e6, 0.05 * 147e6);
  EXPECT_NEAR(Link("p64-2001", 512).rate(true), 315e6, 0.05 * 315e6);
}

TEST(PciBandwidth, LargerTransfers_AreNotSlower) {
  std::printf(
      "MB/s of one transfer from the write of the tail to the interrupt, bursts of 4,096 bytes\n");
  std::printf("%10s", "bytes");
  for (const HostProfile& p : kHostProfiles)
    std::printf("  %*s read   write", static_cast<int>(p.name.size()), std::string(p.name).c_str());
  std::printf("\n");
  std::vector<std::unique_ptr<Link>> links;
  links.reserve(std::size(kHostProfiles));
  for (const HostProfile& p : kHostProfiles)
    links.push_back(std::make_unique<Link>(std::string(p.name), 4096));
  std::vector<double> before(links.size());
  const std::uint32_t most = std::getenv("CDE_FULL") != nullptr ? 4'194'304 : 1'048'576;
  for (std::uint32_t bytes = 64; bytes <= most; bytes *= 4) {
    std::printf("%10u", bytes);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const double read = bytes / seconds(*links[i], bytes, false),
                   write = bytes / seconds(*links[i], bytes, true);
      std::printf("  %*s%5.1f  %5.1f ", static_cast<int>(kHostProfiles[i].name.size()), "",
                  read * 1e-6, write * 1e-6);
      EXPECT_GT(read, before[i]) << "larger bursts must not be slower";
      EXPECT_LT(std::max(read, write), kPeak);
      before[i] = read;
    }
    std::printf("\n");
  }
}

/// The card's own cycles per burst, without the host's cycles. docs/reference/pci.md states them.
TEST(PciBandwidth, Burst_HasTheDocumentedOverhead) {
  for (const HostProfile& p : kHostProfiles)
    for (const bool to_host : {false, true}) {
      Link link(std::string(p.name), 512);
      const double cycles = 512 / link.rate(to_host) / 15e-9 - 64;
      const double own = cycles - (to_host ? p.write_latency : p.read_latency);
      std::printf("%s, %s: %.1f cycles per burst beside its data, %.1f of them the card's\n",
                  std::string(p.name).c_str(), to_host ? "write" : "read", cycles, own);
      // A page lookup takes three cycles, and this burst is an eighth of a page.
      EXPECT_NEAR(own - 3.0 / 8, to_host ? 9 : 8, 0.05);
    }
}

}  // namespace
}  // namespace cde::testing
