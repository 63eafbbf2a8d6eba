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

/// A waiting driver polls in case the interrupt was lost: first after this many core cycles, then
/// at doubling intervals.
inline constexpr std::uint64_t kFirstAskCycles = 1024;
/// Bytes that a driver maps, which is the most per transfer.
inline constexpr std::uint32_t kMappedBytes = 1u << 20;

/// The part of kSpaceReg that single accesses reach on any bus. Transfers reach the rest.
inline constexpr std::uint32_t kRegisterWindow = pci::kRegisters;

/// Divides a simulation into steps of at most about 0.1 s of wall time, at any simulation speed.
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

/// The driver's access to a card: its spaces, over either bus, and its interrupt. Times are core
/// cycles of the card since power-on. Private to the driver.
class CardLink {
 public:
  virtual ~CardLink() = default;

  /// Transfers `beats` words of 64 bits at byte offset, offset + 8, ... (SRAM: the offset stays 0).
  /// The card reports refused accesses in its status register. Error kDevice if the bus cannot
  /// transfer the words.
  virtual void write(card::Space space, std::uint32_t offset, const void* data,
                     std::uint64_t beats) = 0;
  virtual void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) = 0;

  /// Runs the card until its interrupt, for at most this many core cycles. Returns the cycles
  /// spent. Calls `pause`, if given, between cycles several times per second of wall time; it may
  /// throw.
  virtual std::uint64_t run(std::uint64_t max_cycles, const std::function<void()>& pause = {}) = 0;
  [[nodiscard]] virtual bool interrupt() = 0;
  [[nodiscard]] virtual std::uint64_t cycles() const = 0;
  /// Modelled time since power-on, including the bus and the core.
  [[nodiscard]] virtual std::uint64_t time_ps() const = 0;
  [[nodiscard]] virtual BusCounters counters() const = 0;
  [[nodiscard]] virtual MemoryCounters memory_counters() const = 0;
  /// Also ends the state of a lost device. An Error if the device stays lost.
  virtual void reset() = 0;
  /// Throws the reason if the device is lost.
  virtual void alive() const = 0;
  [[nodiscard]] virtual bool lost() const = 0;
  /// What the bus noted of a failure, and the clock.
  [[nodiscard]] virtual DeviceFault fault() = 0;
  /// The first violated bus rule; empty if none.
  [[nodiscard]] virtual std::string violation() const = 0;
  /// Error kUsage if this kind of bus has no such fault.
  virtual void inject(BusFault fault, std::uint32_t count, std::uint32_t value) = 0;

  /// Error kUsage if the simulation model cannot write waves, kFile if the file cannot be written.
  /// `ddr_word` is the place of TraceOptions::secondary.
  virtual void trace_open(const std::filesystem::path& file, const TraceOptions& which,
                          std::optional<std::uint64_t> ddr_word) = 0;
  virtual void trace_close() = 0;
  /// Flips bits of a DDR byte, or of the check bits of a word. False if there are no such bits.
  virtual bool flip_ddr(std::uint64_t byte, std::uint8_t mask) = 0;
  virtual bool flip_check(std::uint64_t word, std::uint8_t mask) = 0;

  /// Hash of the loaded simulation model, independent of its card's registers.
  [[nodiscard]] virtual std::uint64_t config_hash() const = 0;

 protected:
  /// Whether this is a single access rather than a transfer.
  [[nodiscard]] static bool is_register(card::Space space, std::uint32_t offset,
                                        std::uint64_t beats) {
    return space == card::kSpaceReg && offset + 8 * beats <= kRegisterWindow;
  }
};

/// A link that drives the local bus directly. It computes the time that PCI would take
/// (bus_time.hpp), counted from a card that the host has set up. Error kConfiguration if the
/// simulation model has another interface, kDevice if there is no memory for the card.
[[nodiscard]] std::unique_ptr<CardLink> local_link(SimulationModel model,
                                                   const OpenOptions& options);

/// A card behind PCI. Registers use single accesses. Everything else uses the card's DMA engine and
/// pages that this link maps for it. The link repeats transfers that fail for a transient reason,
/// up to OpenOptions::bus_retries times in a row. Persistent failures are an Error kDevice with a
/// DeviceFault. So is a failed read of the record stream, which cannot be repeated without losing
/// records. If the card stops answering, or its bus or DMA engine hangs, every call throws until
/// reset(). Opening has the errors of local_link().
[[nodiscard]] std::unique_ptr<CardLink> pci_link(SimulationModel model, const OpenOptions& options);

}  // namespace cde
