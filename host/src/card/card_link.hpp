// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "cde/card/board.hpp"
#include "cde/contract/pci.hpp"
#include "cde/support/device_fault.hpp"

namespace cde {

/// A driver that waits for an interrupt asks whether it was lost: after so many core clocks, then
/// at intervals that double.
inline constexpr std::uint64_t kFirstAskClocks = 1024;
/// Bytes that a driver has mapped, and so transfers at a time.
inline constexpr std::uint32_t kMappedBytes = 1u << 20;

/// Of kSpaceReg, what is reached by single accesses whatever the bus; the rest by transfers.
inline constexpr std::uint32_t kRegisterWindow = pci::kRegisters;

/// Divides a simulation into steps of a tenth of a second or less of this machine's time, however
/// slow its model is.
class Pace {
 public:
  /// Calls `step(n)`, which simulates at most n units and returns those spent, until `units` are
  /// spent or it spends fewer than n. Returns the units spent.
  template <class Step>
  std::uint64_t run(std::uint64_t units, const Step& step, const std::function<void()>& pause) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds kShort{25}, kLong{100};
    std::uint64_t spent = 0;
    while (spent < units) {
      const std::uint64_t wanted = std::min(size_, units - spent);
      const auto began = Clock::now();
      const std::uint64_t got = step(wanted);
      const auto took = Clock::now() - began;
      spent += got;
      if (took < kShort && wanted == size_) size_ *= 2;
      if (took > kLong)
        size_ = 1 + static_cast<std::uint64_t>(static_cast<double>(wanted) *
                                               (std::chrono::duration<double>(kShort) / took));
      if (pause) pause();
      if (got < wanted) break;
    }
    return spent;
  }

 private:
  std::uint64_t size_ = 16;
};

/// The way from the driver to a card: accesses to its spaces over whichever bus it is plugged
/// into, and its interrupt. Times are the card's: core clocks since power-on. Private to the
/// driver.
class CardLink {
 public:
  virtual ~CardLink() = default;

  /// `beats` transfers of 64 bits at byte offset, offset + 8, ... (SRAM: the offset stays 0). What
  /// the card refuses shows in its status register. Error kDevice if the bus does not transfer
  /// them.
  virtual void write(card::Space space, std::uint32_t offset, const void* data,
                     std::uint64_t beats) = 0;
  virtual void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) = 0;

  /// Lets the card work until its interrupt, at most so many core clocks; returns those spent.
  /// `pause`, if there is one, is called several times per second of this machine's time, between
  /// clocks, and may throw.
  virtual std::uint64_t run(std::uint64_t max_clocks, const std::function<void()>& pause = {}) = 0;
  [[nodiscard]] virtual bool interrupt() = 0;
  [[nodiscard]] virtual std::uint64_t clocks() const = 0;
  /// Modelled time since power-on, of bus and core.
  [[nodiscard]] virtual std::uint64_t time_ps() const = 0;
  [[nodiscard]] virtual BusCounters counters() const = 0;
  [[nodiscard]] virtual MemoryCounters memory_counters() const = 0;
  /// Ends the state of a lost device, too; an Error if it stays lost.
  virtual void reset() = 0;
  /// Throws what happened if the device is lost.
  virtual void alive() const = 0;
  [[nodiscard]] virtual bool lost() const = 0;
  /// For the report of a failure: what the bus has noted of it, and the clock.
  [[nodiscard]] virtual DeviceFault fault() = 0;
  /// The first rule of the bus that was broken; empty if none.
  [[nodiscard]] virtual std::string violation() const = 0;
  /// Error kUsage if this kind of bus has no such fault.
  virtual void inject(BusFault fault, std::uint32_t count, std::uint32_t value) = 0;

  /// Error kUsage if the bitstream has no waves, kFile if the file cannot be
  /// written. `ddr_word` is where TraceOptions::secondary lies.
  virtual void trace_open(const std::filesystem::path& file, const TraceOptions& which,
                          std::optional<std::uint64_t> ddr_word) = 0;
  virtual void trace_close() = 0;
  /// Bits of a byte of DDR, or of the check bits of a word; false where there are none.
  virtual bool flip_ddr(std::uint64_t byte, std::uint8_t mask) = 0;
  virtual bool flip_check(std::uint64_t word, std::uint8_t mask) = 0;

  /// Of the loaded bitstream, whatever its card says.
  [[nodiscard]] virtual std::uint64_t config_hash() const = 0;

 protected:
  /// What goes as a single access, not as a transfer.
  [[nodiscard]] static bool is_register(card::Space space, std::uint32_t offset,
                                        std::uint64_t beats) {
    return space == card::kSpaceReg && offset + 8 * beats <= kRegisterWindow;
  }
};

/// The local bus itself, driven by the harness; the time that PCI would take is computed
/// (bus_time.hpp) and counts from a card that the host has set up. Errors: kConfiguration if the
/// bitstream speaks another interface, kDevice if there is no memory for the card.
[[nodiscard]] std::unique_ptr<CardLink> local_link(Bitstream bitstream, const OpenOptions& options);

/// A card behind PCI: registers by single accesses, all else by the card's DMA engine through pages
/// that this maps for it. Transfers that fail for a passing reason are repeated up to
/// OpenOptions::bus_retries times in a row; what cannot be repeated without losing records (the
/// record stream) and what goes on failing is an Error kDevice with a DeviceFault. When the card
/// answers no more, or its bus or DMA engine hangs, every call throws until reset(). Errors of
/// opening as local_link().
[[nodiscard]] std::unique_ptr<CardLink> pci_link(Bitstream bitstream, const OpenOptions& options);

}  // namespace cde
