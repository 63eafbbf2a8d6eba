// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "card/abi_table.hpp"
#include "card/bus_time.hpp"
#include "card/card_link.hpp"
#include "card/device_loss.hpp"
#include "cde/abi/abi.h"
#include "cde/contract/pci.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

constexpr std::uint64_t kAccessCycles = 1000;  // more than any single access takes

/// Transfers beats over the local bus as fast as the card takes them, and adds PCI's time to the
/// modelled time. A running pass continues during that time. Idle cycles of the card are not
/// simulated.
class LocalLink final : public CardLink {
 public:
  LocalLink(SimulationModel model, const OpenOptions& options)
      : model_(std::move(model)),
        period_ps_(options.clock_period_ps),
        retries_(options.bus_retries),
        bus_(options) {
    api_ = abi_table<cde_board_entry_fn>(model_, "cde_board_entry", CDE_BOARD_ABI);
    const cde_board_options card_options = {.memory = static_cast<std::uint32_t>(options.memory),
                                            .ddr_latency = options.ddr_latency,
                                            .clock_period_ps = options.clock_period_ps};
    card_ = api_->create(&card_options);
    if (card_ == nullptr) no_memory_for_models();
  }
  LocalLink(const LocalLink&) = delete;
  LocalLink& operator=(const LocalLink&) = delete;
  ~LocalLink() override { api_->destroy(card_); }

  void write(card::Space space, std::uint32_t offset, const void* data,
             std::uint64_t beats) override {
    const auto put = [&](const std::uint8_t* from, std::uint64_t done, std::uint64_t n) {
      clocked([&] {
        transferred(api_->write(card_, space, offset + static_cast<std::uint32_t>(8 * done),
                                from + 8 * done, n, n * 4 + kAccessCycles),
                    n, "written to", space, offset);
      });
    };
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    if (is_register(space, offset, beats)) {
      answered(offset, "register write");
      access(bus_.write(beats));
      put(bytes, 0, beats);
      follow(offset, bytes, beats);
      posted_ = true;
    } else {
      counters_.bytes_to_card += 8 * beats;
      in_pieces(beats, false, [&](std::uint64_t done, std::uint64_t n) { put(bytes, done, n); });
    }
  }
  void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) override {
    auto* bytes = static_cast<std::uint8_t*>(data);
    const auto get = [&](std::uint64_t done, std::uint64_t n) {
      const std::uint64_t at = space == card::kSpaceSram ? 0 : 8 * done;
      clocked([&] {
        transferred(api_->read(card_, space, offset + static_cast<std::uint32_t>(at),
                               bytes + 8 * done, n, n * 4 + kAccessCycles),
                    n, "read from", space, offset);
      });
    };
    if (is_register(space, offset, beats)) {
      answered(offset, "register read");
      access(bus_.read(beats));
      get(0, beats);
      posted_ = false;
      for (std::uint64_t i = 0; i < beats; ++i)
        if (offset + 8 * i == card::kRegStatus) watch(bytes + 8 * i);
    } else {
      counters_.bytes_to_host += 8 * beats;
      in_pieces(beats, true, get);
    }
  }

  /// Waits like the driver of a card behind PCI.
  std::uint64_t run(std::uint64_t max_cycles, const std::function<void()>& pause) override {
    loss_.alive();
    const std::uint64_t start = now_, end = now_ + max_cycles * period_ps_;
    std::uint64_t status = 0;  // pushes a posted write through, which may clear this interrupt
    if (posted_ && interrupt()) read(card::kSpaceReg, card::kRegStatus, &status, 1);
    for (std::uint64_t slice = kFirstAskCycles; now_ < end && !interrupt(); slice *= 2) {
      const std::uint64_t left = (end - now_ + period_ps_ - 1) / period_ps_;
      const auto step = [&](std::uint64_t cycles) {
        const std::uint64_t spent = api_->run(card_, cycles);
        now_ += spent * period_ps_;
        core_ = now_;
        return spent;
      };
      (void)pace_.run(std::min(slice, left), step, pause);
      charge(interrupt() ? BusTime::interrupt() : polled());
    }
    return (now_ - start) / period_ps_;
  }
  bool interrupt() override { return api_->interrupt(card_) != 0; }
  [[nodiscard]] std::uint64_t cycles() const override { return now_ / period_ps_; }
  [[nodiscard]] std::uint64_t time_ps() const override { return now_; }
  [[nodiscard]] BusCounters counters() const override {
    BusCounters c = counters_;
    c.pci_cycles = now_ / BusTime::kPciPs;
    c.faults[static_cast<std::size_t>(BusFault::kNoAnswer)] = unanswered_;
    return c;
  }
  [[nodiscard]] MemoryCounters memory_counters() const override {
    cde_memory_counters c{};
    api_->memory(card_, &c);
    return {.bursts = c.bursts, .row_misses = c.row_misses, .refreshes = c.refreshes};
  }
  void reset() override {
    api_->reset(card_);
    running_ = false;
    if (unanswering_ == kUntilReset) unanswering_ = 0;
    loss_.reset();
    answered(0, "read of configuration space");
  }
  void alive() const override { loss_.alive(); }
  [[nodiscard]] bool lost() const override { return loss_.lost(); }
  [[nodiscard]] DeviceFault fault() override { return {.cycle = cycles()}; }
  [[nodiscard]] std::string violation() const override { return {}; }
  void inject(BusFault fault, std::uint32_t count, std::uint32_t) override {
    if (!on_functional_bus(fault)) {
      throw Error(ErrorCode::kUsage,
                  fmt::format("the functional bus has no fault '{}'; open the board with "
                              "Bus::kCycle",
                              name_of(fault)));
    }
    if (fault == BusFault::kNoAnswer)
      unanswering_ = count;
    else
      api_->ddr_hang(card_, count);
  }

  void trace_open(const std::filesystem::path& file, const TraceOptions& which,
                  std::optional<std::uint64_t> ddr_word) override {
    require_waves(api_->parameters);
    open_waves(file, which, ddr_word, period_ps_,
               [this](const cde_trace* wanted) { return api_->trace_open(card_, wanted); });
  }
  void trace_close() override { require_whole_waves(api_->trace_close(card_)); }
  bool flip_ddr(std::uint64_t byte, std::uint8_t mask) override {
    return api_->ddr_flip(card_, byte, mask) == 0;
  }
  bool flip_check(std::uint64_t word, std::uint8_t mask) override {
    return api_->check_flip(card_, word, mask) == 0;
  }
  [[nodiscard]] std::uint64_t config_hash() const override { return api_->config_hash; }

 private:
  // ---- Time ----

  /// Spends bus time, in which a running pass continues.
  void charge(const BusTime::Cycles& bus) {
    counters_.pci_busy += bus.busy;
    counters_.pci_data += bus.data;
    elapse(bus.ps());
  }
  void elapse(std::uint64_t ps) {
    now_ += ps;
    if (!running_) core_ = now_;
    if (core_ >= now_) return;
    const std::uint64_t cycles = (now_ - core_) / period_ps_;
    api_->advance(card_, cycles);
    core_ += cycles * period_ps_;
  }
  /// Wraps calls that clock the core: a running pass has had this time.
  template <class F>
  void clocked(const F& call) {
    const std::uint64_t before = api_->cycles(card_);
    call();
    if (running_) core_ += (api_->cycles(card_) - before) * period_ps_;
  }
  /// Simulates a card that does not answer an access, or the first access of a transfer. Retries as
  /// on PCI, then loses the card.
  void answered(std::uint32_t offset, const char* what) {
    loss_.alive();
    for (unsigned i = 0; unanswering_ != 0; ++i) {
      if (unanswering_ != kUntilReset) --unanswering_;
      ++unanswered_;
      charge(bus_.poll());
      if (i == retries_) {
        loss_.lose(ErrorCode::kDevice,
                   fmt::format("{} at offset {:#x}: the card does not answer", what, offset),
                   {.code = pci::kCodeMasterAbort,
                    .pci_status = 0xffff,
                    .address = offset,
                    .cycle = cycles()});
      }
      ++counters_.access_retries;
    }
  }
  void access(const BusTime::Cycles& cycles) {
    ++counters_.register_accesses;
    charge(cycles);
  }
  BusTime::Cycles polled() {
    ++counters_.register_accesses;
    return bus_.poll();
  }

  /// Follows control writes: they start a pass, and the status shows its end.
  void follow(std::uint32_t offset, const std::uint8_t* data, std::uint64_t beats) {
    if (offset > card::kRegControl || offset + 8 * beats <= card::kRegControl) return;
    std::uint64_t value = 0;
    std::memcpy(&value, data + (card::kRegControl - offset), sizeof value);
    if ((value & card::kControlGo) != 0 && !running_) {
      running_ = true;
      core_ = now_;
    }
  }
  void watch(const std::uint8_t* data) {
    std::uint64_t status = 0;
    std::memcpy(&status, data, sizeof status);
    running_ = running_ && (status >> card::kStatusBusy & 1) != 0;
  }

  /// Splits a transfer into the pieces that the PCI driver would use.
  template <class F>
  void in_pieces(std::uint64_t beats, bool to_host, const F& move) {
    constexpr std::uint64_t kPiece = kMappedBytes / 8;
    for (std::uint64_t done = 0; done < beats;) {
      const std::uint64_t n = std::min(kPiece, beats - done);
      answered(pci::kRegIrqMask, "register write");
      const BusTime::Transfer t = bus_.transfer(static_cast<std::uint32_t>(8 * n), to_host);
      counters_.register_accesses += t.accesses;
      ++counters_.transfers;
      elapse(t.lead * BusTime::kPciPs);
      move(done, n);
      BusTime::Cycles rest = t.cycles;
      rest.all -= t.lead;
      charge(rest);
      now_ = std::max(now_, core_);
      done += n;
    }
  }

  void transferred(std::uint64_t done, std::uint64_t wanted, const char* what, card::Space space,
                   std::uint32_t offset) {
    if (done == wanted) return;
    loss_.lose(ErrorCode::kDevice,
               fmt::format("local bus hangs: {} of {} beats {} space {} offset {:#x}", done, wanted,
                           what, static_cast<int>(space), offset),
               {.address = offset, .cycle = cycles()});
  }

  SimulationModel model_;
  std::uint32_t period_ps_;
  unsigned retries_;
  BusTime bus_;
  Pace pace_;
  std::uint64_t now_ = 0;   // modelled time
  std::uint64_t core_ = 0;  // end of a pass's simulated time; sometimes slightly ahead
  bool running_ = false;    // a pass is running
  bool posted_ = false;     // a register was written and none read since
  DeviceLoss loss_;
  std::uint32_t unanswering_ = 0;  // host transactions that the card will not answer
  std::uint64_t unanswered_ = 0;   // host transactions without an answer so far
  BusCounters counters_;
  const cde_board_api* api_ = nullptr;
  void* card_ = nullptr;
};

}  // namespace

std::unique_ptr<CardLink> local_link(SimulationModel model, const OpenOptions& options) {
  return std::make_unique<LocalLink>(std::move(model), options);
}

}  // namespace cde
