// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/card/board.hpp"

namespace cde {

/// Computes the PCI time of accesses and transfers, one transaction at a time: the modelled time of
/// the functional bus. It uses the host's profile, bus width and burst size, the clocks of the
/// card's PCI side (docs/reference/pci.md) and the steps of the PCI driver. It does not depend on
/// the data. Private to the driver.
class BusTime {
 public:
  static constexpr std::uint64_t kPciPs = 15'000;  ///< period of a PCI clock, 66.67 MHz

  explicit BusTime(const OpenOptions& options);

  /// PCI cycles: all, with a transaction on the bus, and with a data phase.
  struct Cycles {
    std::uint64_t all = 0, busy = 0, data = 0;
    Cycles& operator+=(const Cycles& other);
    [[nodiscard]] std::uint64_t ps() const { return all * kPciPs; }
  };

  /// Cycles of CPU accesses to `count` consecutive registers of the card; count is at least 1.
  /// Writes are posted, in a burst. A read is retried until its data arrive from the core's clock
  /// domain.
  [[nodiscard]] Cycles write(std::uint64_t count = 1) const;
  [[nodiscard]] Cycles read(std::uint64_t count = 1) const;
  /// A read of a bridge register.
  [[nodiscard]] Cycles poll() const { return read_after(1, 1); }

  /// A transfer by the card's DMA engine, including the driver's accesses around it.
  struct Transfer {
    Cycles cycles = {};
    std::uint64_t lead = 0;  ///< cycles before the card's local bus is used
    unsigned accesses = 0;   ///< accesses to registers
  };
  /// `bytes` is a multiple of 8, from 8 to kMappedBytes.
  [[nodiscard]] Transfer transfer(std::uint32_t bytes, bool to_host) const;

  /// Cycles from the card's interrupt line to the CPU.
  [[nodiscard]] static Cycles interrupt() { return {.all = 7}; }

 private:
  struct Bursts {
    std::uint64_t pages, number, words;  ///< words: 64 bits each
    std::uint64_t first, last;           ///< words of the first and the last burst
  };
  [[nodiscard]] Bursts bursts(std::uint32_t bytes) const;
  [[nodiscard]] Cycles read_after(std::uint64_t retries, std::uint64_t count) const;
  /// Cycles until the last word has arrived. They begin with the first data phase, or for a
  /// transfer to the host with the first request to the card's local bus. Polls took `stolen`
  /// cycles of the bus.
  [[nodiscard]] double data_cycles(const Bursts& b, bool to_host, double stolen) const;
  /// Cycles from the tail write to the interrupt, without the data.
  [[nodiscard]] double fixed_cycles(const Bursts& b, bool to_host) const;
  /// Cycles that a poll takes from a transfer, `since` cycles after its data phases began.
  [[nodiscard]] double stolen(const Bursts& b, bool to_host, double since) const;

  HostProfile host_;
  std::uint64_t phases_;  ///< data phases per word: 1, or 2 on a 32-bit bus
  std::uint64_t burst_;   ///< bytes
  double core_;           ///< PCI cycles per core clock
};

}  // namespace cde
