// SPDX-License-Identifier: Apache-2.0
// Drives a card behind PCI, as a kernel driver would.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "card/abi_table.hpp"
#include "card/card_link.hpp"
#include "card/pci_port.hpp"
#include "cde/contract/pci.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

static_assert(kBusFaults == CDE_PCI_FAULTS && kUntilReset == CDE_PCI_UNTIL_RESET);

constexpr std::uint32_t kBar = 0xF0000000;  // the card's registers in the host's address space
constexpr std::uint32_t kCommand = 0x146;   // memory, bus master, parity, SERR
constexpr std::uint32_t kPageBytes = 1u << pci::kPageBits;
// Entries of the card's page table: descriptors, completion records, data.
constexpr std::uint32_t kRingPage = 0, kCompletionPage = 1, kDataPage = 2;
constexpr std::uint32_t kDataBytes = kMappedBytes, kDataPages = kDataBytes / kPageBytes;
constexpr unsigned kDescriptors = 16;
constexpr std::uint64_t kLastAskCycles = 65536;  // longest interval between polls
// Retries in a row until a transfer fails: 2 ms at 8 cycles per retry. That is a fifth of the time
// after which the engine counts as hung.
constexpr std::uint32_t kRetryLimit = 1u << 14;

bool bit(std::uint64_t word, unsigned number) {
  return (word >> number & 1) != 0;
}

const char* text_of(std::uint32_t code) {
  static constexpr const char* kTexts[] = {"ok",
                                           "bad length",
                                           "bad alignment",
                                           "page not mapped",
                                           "read-only page",
                                           "master abort",
                                           "target abort",
                                           "parity error",
                                           "too many retries",
                                           "bad ring settings",
                                           "stopped",
                                           "bus mastering is off"};
  return code < std::size(kTexts) ? kTexts[code] : "unknown code";
}

class PciLink final : public CardLink {
 public:
  PciLink(SimulationModel model, const OpenOptions& options)
      : port_(std::move(model), options, std::uint64_t{2} * (kDataPage + kDataPages) * kPageBytes),
        period_ps_(options.clock_period_ps),
        retries_(options.bus_retries),
        burst_(options.bus_burst) {
    set_up();
  }

  void write(card::Space space, std::uint32_t offset, const void* data,
             std::uint64_t beats) override {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    if (is_register(space, offset, beats)) return port_.store(offset, data, 8 * beats);
    for (std::uint64_t done = 0; done < 8 * beats;) {
      const auto n =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(kDataBytes, 8 * beats - done));
      stage(bytes + done, n);
      move(space, offset + static_cast<std::uint32_t>(done), n, false);
      done += n;
      counters_.bytes_to_card += n;
    }
  }

  void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) override {
    auto* bytes = static_cast<std::uint8_t*>(data);
    if (is_register(space, offset, beats)) return port_.fetch(offset, data, 8 * beats);
    for (std::uint64_t done = 0; done < 8 * beats;) {
      const auto n =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(kDataBytes, 8 * beats - done));
      move(space, offset + static_cast<std::uint32_t>(done), n, true);
      unstage(bytes + done, n);
      done += n;
      counters_.bytes_to_host += n;
    }
  }

  /// Polls for a lost interrupt, at intervals that double up to kLastAskCycles. So the delay is at
  /// most the time that the card worked.
  std::uint64_t run(std::uint64_t max_cycles, const std::function<void()>& pause) override {
    port_.alive();
    const std::uint64_t start = time_ps(), end = start + max_cycles * period_ps_;
    settle();
    for (std::uint64_t slice = kFirstAskCycles * period_ps_; !pending_ && time_ps() < end;
         slice = longer(slice)) {
      pass(std::min(slice, end - time_ps()), pause);
      if (interrupted()) break;
      if (bit(port_.load(pci::kRegIrqStatus), pci::kIrqCard) && !interrupted()) {
        pending_ = true;
        ++counters_.lost_interrupts;
      }
    }
    return (time_ps() - start) / period_ps_;
  }
  bool interrupt() override {
    const bool seen = pending_ || interrupted();
    pending_ = false;
    return seen;
  }
  [[nodiscard]] std::uint64_t cycles() const override { return port_.cycles(); }
  [[nodiscard]] std::uint64_t time_ps() const override { return port_.time_ps(); }
  [[nodiscard]] BusCounters counters() const override {
    BusCounters c = counters_;
    c.register_accesses = port_.accesses();
    c.access_retries = port_.access_retries();
    cde_pci_counters pci{};
    api().counters(port_.host(), &pci);
    c.pci_cycles = pci.cycles;
    c.pci_busy = pci.busy;
    c.pci_data = pci.data;
    std::copy(std::begin(pci.faults), std::end(pci.faults), c.faults.begin());
    return c;
  }
  [[nodiscard]] MemoryCounters memory_counters() const override {
    cde_memory_counters c{};
    api().memory_counters(port_.host(), &c);
    return {.bursts = c.bursts, .row_misses = c.row_misses, .refreshes = c.refreshes};
  }
  void reset() override {
    port_.reset();
    pending_ = false;
    try {
      set_up();
    } catch (const Error& error) {
      port_.lose(error);
    }
  }
  void alive() const override { port_.alive(); }
  [[nodiscard]] bool lost() const override { return port_.lost(); }
  [[nodiscard]] DeviceFault fault() override {
    return {.pci_status = port_.pci_status(), .cycle = cycles()};
  }
  [[nodiscard]] std::string violation() const override {
    const char* const rule = api().violation(port_.host());
    return rule != nullptr ? rule : "";
  }
  void inject(BusFault fault, std::uint32_t count, std::uint32_t value) override {
    if (api().fault(port_.host(), static_cast<std::uint32_t>(fault), count, value) != 0)
      throw Error(ErrorCode::kUsage, fmt::format("no fault {}", static_cast<unsigned>(fault)));
  }

  void trace_open(const std::filesystem::path& file, const TraceOptions& which,
                  std::optional<std::uint64_t> ddr_word) override {
    require_waves(api().parameters);
    open_waves(file, which, ddr_word, period_ps_,
               [this](const cde_trace* wanted) { return api().trace_open(port_.host(), wanted); });
  }
  void trace_close() override { require_whole_waves(api().trace_close(port_.host())); }
  bool flip_ddr(std::uint64_t byte, std::uint8_t mask) override {
    return flip(card::kSpaceDdr, byte, mask);
  }
  bool flip_check(std::uint64_t word, std::uint8_t mask) override {
    return flip(CDE_PCI_SPACE_CHECK, word, mask);
  }
  [[nodiscard]] std::uint64_t config_hash() const override { return api().config_hash; }

 private:
  [[nodiscard]] const cde_pci_api& api() const { return port_.api(); }
  /// Waits for the interrupt, for at most `ps`.
  void pass(std::uint64_t ps, const std::function<void()>& pause = {}) {
    const std::uint64_t cycles = (ps + period_ps_ - 1) / period_ps_, end = time_ps() + ps;
    const auto step = [&](std::uint64_t some) {
      const std::uint64_t wanted = std::min(some * period_ps_, end - time_ps());
      const std::uint64_t spent = api().run(port_.host(), wanted, 1);
      return spent < wanted || interrupted() ? 0 : some;
    };
    (void)pace_.run(cycles, step, pause);
  }
  [[nodiscard]] bool interrupted() const { return api().interrupt(port_.host()) != 0; }
  [[nodiscard]] std::uint64_t longer(std::uint64_t slice) const {
    return std::min(2 * slice, kLastAskCycles * period_ps_);
  }
  /// Checks a pending interrupt again after posted writes, since one of them may clear it.
  void settle() {
    if (!port_.posted() || !(pending_ || interrupted())) return;
    (void)port_.load(
        card::kRegStatus);  // a read from the card itself pushes the posted writes through
    pending_ = bit(port_.load(pci::kRegIrqStatus), pci::kIrqCard) && !interrupted();
  }
  bool flip(std::uint32_t space, std::uint64_t byte, std::uint8_t mask) {
    std::uint64_t bytes = 0;
    auto* const memory =
        static_cast<std::uint8_t*>(api().local_memory(port_.host(), space, &bytes));
    if (memory == nullptr || byte >= bytes) return false;
    memory[byte] ^= mask;
    return true;
  }

  // ---- Set-up ----

  void set_up() {
    const std::uint32_t id = port_.config_read(0x00);
    if (id != (std::uint32_t{pci::kDeviceId} << 16 | pci::kVendorId))
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("PCI device {:08x} is not a card of cde", id));
    port_.config_write(0x10, kBar);
    port_.config_write(0x0C, 0x4008);  // latency timer, cache line size
    port_.config_write(0x04, kCommand);
    // The card clears 4,096 entries, one per cycle. The polls take longer than that.
    for (std::uint32_t asked = 0; bit(port_.load(pci::kRegStatus), pci::kStatusClearing); ++asked)
      if (asked == pci::kPages) port_.fail("the page table is not cleared after reset", {});
    std::vector<std::uint64_t> entries;
    for (std::uint32_t page = 0; page < kDataPage + kDataPages; ++page) {
      const bool writable = page != kRingPage;
      entries.push_back(std::uint64_t{api().frame(port_.host(), page)} << pci::kPageFrame |
                        1u << pci::kPageValid |
                        static_cast<std::uint64_t>(writable) << pci::kPageWritable);
    }
    port_.store(pci::kPageTable, entries.data(), 8 * entries.size());
    port_.set(pci::kRegBurst, burst_);
    port_.set(pci::kRegRetryLimit, kRetryLimit);
    port_.set(pci::kRegRingBase, kRingPage * kPageBytes);
    port_.set(pci::kRegRingSize, kDescriptors);
    port_.set(pci::kRegCompletionBase, kCompletionPage * kPageBytes);
    start_ring();
  }
  void start_ring() {
    std::memset(page(kCompletionPage), 0, kDescriptors * pci::kCompletionBytes);
    port_.set(pci::kRegControl, 1u << pci::kControlClear);
    port_.set(pci::kRegRingTail, 0);
    port_.set(pci::kRegIrqStatus, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    port_.set(pci::kRegIrqMask, 1u << pci::kIrqCard);
    port_.set(pci::kRegControl, 1u << pci::kControlRun);
    next_ = 0;
    lap_ = true;
  }

  // ---- Host memory ----

  std::uint8_t* page(std::uint32_t entry) {
    return static_cast<std::uint8_t*>(api().memory(port_.host(), api().frame(port_.host(), entry)));
  }
  void stage(const std::uint8_t* from, std::uint32_t bytes) {
    for (std::uint32_t at = 0; at < bytes; at += kPageBytes)
      std::memcpy(page(kDataPage + at / kPageBytes), from + at, std::min(kPageBytes, bytes - at));
  }
  void unstage(std::uint8_t* to, std::uint32_t bytes) {
    for (std::uint32_t at = 0; at < bytes; at += kPageBytes)
      std::memcpy(to + at, page(kDataPage + at / kPageBytes), std::min(kPageBytes, bytes - at));
  }

  // ---- Transfers ----

  struct Ending {
    std::uint32_t code, bytes, address;
    std::uint16_t pci_status;
  };

  /// Moves bytes between the data pages and a space of the card. Faults may split it into several
  /// descriptors.
  void move(card::Space space, std::uint32_t offset, std::uint32_t bytes, bool to_host) {
    unsigned failures = 0;
    for (std::uint32_t done = 0; done < bytes;) {
      const Ending e = serve(kDataPage * kPageBytes + done, space,
                             space == card::kSpaceSram ? 0 : offset + done, bytes - done, to_host);
      if (e.code == pci::kCodeOk) return;
      failures = e.bytes != 0 ? 1 : failures + 1;
      done += e.bytes;
      const bool passing = e.code == pci::kCodeMasterAbort || e.code == pci::kCodeTargetAbort ||
                           e.code == pci::kCodeParity || e.code == pci::kCodeRetryLimit;
      // A failed transfer loses the records that had left the ring.
      const bool stream = space == card::kSpaceSram;
      start_ring();
      if (!passing || stream || failures > retries_) {
        port_.fail(fmt::format("DMA of {} bytes {} space {} offset {:#x}: {} after {} bytes", bytes,
                               to_host ? "from" : "to", static_cast<int>(space), offset,
                               text_of(e.code), done),
                   {.code = e.code,
                    .pci_status = e.pci_status,
                    .address = e.address,
                    .repeatable = passing && stream});
      }
      ++counters_.transfer_retries;
    }
  }

  Ending serve(std::uint32_t mapped, card::Space space, std::uint32_t offset, std::uint32_t bytes,
               bool to_host) {
    port_.alive();
    const std::uint64_t words[4] = {std::uint64_t{bytes} << 32 | mapped,
                                    std::uint64_t{offset} |
                                        std::uint64_t{space} << pci::kDescriptorSpace |
                                        std::uint64_t{to_host} << pci::kDescriptorToHost |
                                        std::uint64_t{1} << pci::kDescriptorIrq,
                                    0, 0};
    const unsigned number = next_;
    std::memcpy(page(kRingPage) + number * pci::kDescriptorBytes, words, sizeof words);
    next_ = (next_ + 1) % kDescriptors;
    port_.set(pci::kRegIrqMask, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    port_.set(pci::kRegRingTail, next_);
    const Ending e = ending(number, mapped, bytes);
    if (next_ == 0) lap_ = !lap_;
    port_.set(pci::kRegIrqStatus, 1u << pci::kIrqCompletion | 1u << pci::kIrqHalted);
    port_.set(pci::kRegIrqMask, 1u << pci::kIrqCard);
    ++counters_.transfers;
    return e;
  }

  Ending ending(unsigned number, std::uint32_t mapped, std::uint32_t bytes) {
    try {
      return wait(number, mapped, bytes);
    } catch (const Error& error) {
      port_.lose(error);  // the engine may still move data at any later time
    }
  }

  /// The completion record, or the registers' state if there can be none. An engine that does not
  /// end needs a reset.
  Ending wait(unsigned number, std::uint32_t mapped, std::uint32_t bytes) {
    // No host is slower than 8 bytes per 10 microseconds.
    const std::uint64_t limit = 10'000'000'000 + std::uint64_t{bytes} * 1'250'000;
    const std::uint64_t deadline = time_ps() + limit;
    const Watchdog dog = port_.watchdog();
    for (std::uint64_t slice = kFirstAskCycles * period_ps_;; slice = longer(slice)) {
      pass(slice);
      const bool seen = interrupted();
      if (const auto ending = completion(number)) {
        counters_.lost_interrupts += seen ? 0 : 1;
        return *ending;
      }
      const std::uint64_t status = port_.load(pci::kRegStatus);
      if (bit(status, pci::kStatusHalted)) {
        counters_.lost_interrupts += seen || interrupted() ? 0 : 1;
        return {static_cast<std::uint32_t>(status >> pci::kStatusCode & 0xff), 0,
                static_cast<std::uint32_t>(port_.load(pci::kRegFaultAddr)), 0};
      }
      const bool late = time_ps() > deadline;
      if (!late && !dog.barked()) continue;
      const std::string within =
          late ? fmt::format("{} us of modelled time", limit / 1'000'000) : "the watchdog's time";
      port_.lose(ErrorCode::kTimeout,
                 fmt::format("DMA descriptor {} of {} bytes did not end within {}, status {:#x}",
                             number, bytes, within, status),
                 {.address = mapped});
    }
  }

  [[nodiscard]] std::optional<Ending> completion(unsigned number) {
    std::uint64_t record[2];
    std::memcpy(record, page(kCompletionPage) + number * pci::kCompletionBytes, sizeof record);
    // A parity error may have lost either word.
    if (bit(record[1], pci::kCompletionLap) != lap_ ||
        bit(record[0], 32 + pci::kCompletionLapFirst) != lap_)
      return std::nullopt;
    return Ending{static_cast<std::uint32_t>(record[1] >> pci::kCompletionCode & 0xff),
                  static_cast<std::uint32_t>(record[0] >> 32) & ~7u,
                  static_cast<std::uint32_t>(record[0]),
                  static_cast<std::uint16_t>(record[1] >> pci::kCompletionPci)};
  }

  PciPort port_;
  std::uint32_t period_ps_;
  unsigned retries_;
  std::uint32_t burst_;
  unsigned next_ = 0;  // descriptor
  bool lap_ = true, pending_ = false;
  Pace pace_;
  BusCounters counters_;
};

}  // namespace

std::unique_ptr<CardLink> pci_link(SimulationModel model, const OpenOptions& options) {
  return std::make_unique<PciLink>(std::move(model), options);
}

}  // namespace cde
