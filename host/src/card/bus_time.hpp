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

  /// PCI clocks: all, with a transaction on the bus, and with a data phase.
  struct Clocks {
    std::uint64_t all = 0, busy = 0, data = 0;
    Clocks& operator+=(const Clocks& other);
    [[nodiscard]] std::uint64_t ps() const { return all * kPciPs; }
  };

  /// Clocks of CPU accesses to `count` consecutive registers of the card; count is at least 1.
  /// Writes are posted, in a burst. A read is retried until its data arrive from the core's clock
  /// domain.
  [[nodiscard]] Clocks write(std::uint64_t count = 1) const;
  [[nodiscard]] Clocks read(std::uint64_t count = 1) const;
  /// A read of a bridge register.
  [[nodiscard]] Clocks poll() const { return read_after(1, 1); }

  /// A transfer by the card's DMA engine, including the driver's accesses around it.
  struct Transfer {
    Clocks clocks = {};
    std::uint64_t lead = 0;  ///< clocks before the card's local bus is used
    unsigned accesses = 0;   ///< accesses to registers
  };
  /// `bytes` is a multiple of 8, from 8 to kMappedBytes.
  [[nodiscard]] Transfer transfer(std::uint32_t bytes, bool to_host) const;

  /// Clocks from the card's interrupt line to the CPU.
  [[nodiscard]] static Clocks interrupt() { return {.all = 7}; }

 private:
  struct Bursts {
    std::uint64_t pages, number, words;  ///< words: 64 bits each
    std::uint64_t first, last;           ///< words of the first and the last burst
  };
  [[nodiscard]] Bursts bursts(std::uint32_t bytes) const;
  [[nodiscard]] Clocks read_after(std::uint64_t retries, std::uint64_t count) const;
  /// Clocks until the last word has arrived. They begin with the first data phase, or for a
  /// transfer to the host with the first request to the card's local bus. Polls took `stolen`
  /// clocks of the bus.
  [[nodiscard]] double data_clocks(const Bursts& b, bool to_host, double stolen) const;
  /// Clocks from the tail write to the interrupt, without the data.
  [[nodiscard]] double fixed_clocks(const Bursts& b, bool to_host) const;
  /// Clocks that a poll takes from a transfer, `since` clocks after its data phases began.
  [[nodiscard]] double stolen(const Bursts& b, bool to_host, double since) const;

  HostProfile host_;
  std::uint64_t phases_;  ///< data phases per word: 1, or 2 on a 32-bit bus
  std::uint64_t burst_;   ///< bytes
  double core_;           ///< PCI clocks per core clock
};

}  // namespace cde
