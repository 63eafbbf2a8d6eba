// SPDX-License-Identifier: Apache-2.0
#include "card/bus_time.hpp"

#include <algorithm>
#include <cmath>

#include "card/card_link.hpp"

namespace cde {
namespace {

// PCI cycles of rtl/bus and of the host bridge that no profile changes. They are sums of states of
// the bus state machines, read off Bus::kCycle; tests/bus/time_test.cpp checks them.
constexpr std::uint64_t kAccess = 6;     // CPU write: cycles around the data phases
constexpr std::uint64_t kBetween = 4;    // any access: cycles with an idle bus
constexpr std::uint64_t kReadBurst = 8;  // card's reads: cycles between bursts
constexpr std::uint64_t kWriteBurst = 9;
constexpr std::uint64_t kPage = 3;      // page lookup before the transfer
constexpr std::uint64_t kHandOver = 2;  // from one master to the other, with arbitration
constexpr std::uint64_t kDescriptor = 4, kRecord = 2;  // words
constexpr double kUpload = 36;                         // fixed cycles of a transfer to the card,
constexpr double kDownload = 37.5;                     // and of one to the host,
constexpr double kDownloadCore = 4.5;  // which also crosses into the core's clock domain and back
constexpr double kRequests = 16;       // words between the DMA engine's FIFO and the local bus
constexpr double kDrain = 4.3;  // from the last word on the local bus to the end of the transfer
constexpr double kSlice = 64;   // latency timer: a request of the CPU may cut a burst after this
constexpr double kCut = 6;      // to resume a cut burst, without the latency
constexpr double kStep = 5;     // cost of a poll that cuts no burst
constexpr std::uint64_t kLead = 14;  // tail write to data, without descriptor and pages
// Cycles of PCI and of the core until a read of the card's registers has its data.
constexpr double kReadPci = 3.8, kReadCore = 5;

constexpr std::uint64_t kPageBytes = 4096;

}  // namespace

BusTime::BusTime(const OpenOptions& options)
    : host_(options.host),
      phases_(options.narrow_bus ? 2 : 1),
      burst_(options.bus_burst),
      core_(static_cast<double>(options.clock_period_ps) / kPciPs) {}

BusTime::Cycles& BusTime::Cycles::operator+=(const Cycles& other) {
  all += other.all;
  busy += other.busy;
  data += other.data;
  return *this;
}

// ---- The CPU's accesses ----

BusTime::Cycles BusTime::write(std::uint64_t count) const {
  const std::uint64_t all = kAccess + 2 * phases_ * count;  // a data phase every other clock
  return {.all = all, .busy = all - kBetween, .data = phases_ * count};
}

BusTime::Cycles BusTime::read(std::uint64_t count) const {
  const std::uint64_t attempt = 7 + phases_;
  const double wait = kReadPci + kReadCore * core_;
  return read_after(static_cast<std::uint64_t>(std::ceil(wait / static_cast<double>(attempt))),
                    count);
}

BusTime::Cycles BusTime::read_after(std::uint64_t retries, std::uint64_t count) const {
  const std::uint64_t attempt = 7 + phases_, last = kAccess + 2 * phases_;
  // All registers but the last disconnect in the middle of a burst.
  const std::uint64_t all = count * (retries * attempt + last) + (count - 1) * (3 - phases_);
  return {.all = all, .busy = all - count * (retries + 1) * kBetween, .data = phases_ * count};
}

// ---- Transfers ----

BusTime::Bursts BusTime::bursts(std::uint32_t bytes) const {
  const std::uint64_t whole = bytes / kPageBytes, rest = bytes % kPageBytes;
  const std::uint64_t tail = rest != 0 ? rest : kPageBytes;
  return {.pages = whole + (rest != 0 ? 1 : 0),
          .number = whole * ((kPageBytes + burst_ - 1) / burst_) + (rest + burst_ - 1) / burst_,
          .words = bytes / 8,
          .first = std::min<std::uint64_t>(burst_, bytes) / 8,
          .last = ((tail - 1) % burst_ + 1) / 8};
}

double BusTime::data_cycles(const Bursts& b, bool to_host, double stolen) const {
  const auto data = static_cast<double>(b.words * phases_);
  const auto more = static_cast<double>(b.number - 1);
  const auto words = static_cast<double>(b.words);
  if (!to_host) {
    // A slower local bus leaves words waiting in the FIFO.
    return std::max(data + more * (kReadBurst + host_.read_latency) + stolen,
                    (words - kRequests) * core_ + kDrain);
  }
  // A burst starts once the card holds all of it. The card fetches the next words meanwhile.
  const double fetch = std::max(1.0, core_);
  return std::max(static_cast<double>(b.first) * fetch + data +
                      more * (kWriteBurst + host_.write_latency) + stolen,
                  words * fetch + static_cast<double>(b.last * phases_));
}

double BusTime::stolen(const Bursts& b, bool to_host, double since) const {
  const double latency = to_host ? host_.write_latency : host_.read_latency;
  if (since < 0) return to_host ? kStep : latency + kCut + kStep;  // during the descriptor read
  const auto beats = static_cast<double>(b.first * phases_);
  const auto own = static_cast<double>(to_host ? kWriteBurst : kReadBurst);
  // The CPU gets the bus only after the card's time slice. It needs the bus twice. Each time it
  // cuts the current burst, if the burst has words left.
  const double at = std::fmod(since, own + latency + beats);
  const double left = std::min(latency + beats - std::max(at, kSlice), beats);
  unsigned cuts = left > 0 ? 1 : 0;
  if (latency + (left > 0 ? left : beats) > kSlice) ++cuts;
  return cuts == 0 ? kStep : cuts * (latency + kCut);
}

double BusTime::fixed_cycles(const Bursts& b, bool to_host) const {
  const std::uint64_t first = to_host ? host_.write_latency : host_.read_latency;
  const std::uint64_t known = (kDescriptor + kRecord) * phases_ + kPage * (b.pages - 1) +
                              host_.read_latency + host_.write_latency + host_.arbitration + first;
  return static_cast<double>(known) + (to_host ? kDownload + kDownloadCore * core_ : kUpload);
}

BusTime::Transfer BusTime::transfer(std::uint32_t bytes, bool to_host) const {
  const Bursts b = bursts(bytes);
  const std::uint64_t reads = to_host ? 1 : 1 + b.number;  // descriptor, data
  const std::uint64_t writes = to_host ? 1 + b.number : 1;
  Transfer t{.accesses = 4};
  Cycles& c = t.cycles;
  for (unsigned i = 0; i < 4; ++i) c += write();
  c.all += kHandOver + host_.arbitration;
  c.busy += reads * host_.read_latency + writes * host_.write_latency;
  const std::uint64_t moved = (b.words + kDescriptor + kRecord) * phases_;
  c.busy += moved;
  c.data += moved;
  const std::uint64_t lead =
      kLead + host_.arbitration + host_.read_latency + kDescriptor * phases_ + kPage * b.pages;
  t.lead = 2 * write().all + lead;

  // The driver waits for the interrupt, and polls now and then in case it was lost.
  const double begun = static_cast<double>(lead) +
                       (to_host ? static_cast<double>(b.first) * std::max(1.0, core_) : 0);
  const double fixed = fixed_cycles(b, to_host);
  double taken = 0, wait = fixed + data_cycles(b, to_host, taken);
  double asked = static_cast<double>(kFirstAskCycles) * core_, slice = asked;
  while (asked < wait) {
    c.busy += poll().busy;
    c.data += poll().data;
    ++t.accesses;
    taken += stolen(b, to_host, asked - taken - begun);
    wait = fixed + data_cycles(b, to_host, taken);
    slice *= 2;
    asked += slice + static_cast<double>(poll().all);
  }
  c.all += static_cast<std::uint64_t>(std::llround(wait));
  return t;
}

}  // namespace cde
