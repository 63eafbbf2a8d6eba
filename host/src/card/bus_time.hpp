// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/card/board.hpp"

namespace cde {

/// What accesses and transfers take on PCI, computed a transaction at a time: the modelled time of
/// the functional bus. It knows the host's profile, width and burst size, the clocks of the card's
/// PCI side (docs/reference/pci.md) and how the driver of a card behind PCI goes about a transfer;
/// not what is transferred. Private to the driver.
class BusTime {
 public:
  static constexpr std::uint64_t kPciPs = 15'000;  ///< of a PCI clock, 66.67 MHz

  explicit BusTime(const OpenOptions& options);

  /// PCI clocks: all of them, those with a transaction on the bus, those in which data move.
  struct Clocks {
    std::uint64_t all = 0, busy = 0, data = 0;
    Clocks& operator+=(const Clocks& other);
    [[nodiscard]] std::uint64_t ps() const { return all * kPciPs; }
  };

  /// Accesses of the CPU to `count` registers of the card in a row, at least one. Writes are
  /// posted, in a burst; each read is retried until its data have come from the core's clock
  /// domain.
  [[nodiscard]] Clocks write(std::uint64_t count = 1) const;
  [[nodiscard]] Clocks read(std::uint64_t count = 1) const;
  /// A read of a register of the bridge.
  [[nodiscard]] Clocks poll() const { return read_after(1, 1); }

  /// A transfer by the card's DMA engine, with all that the driver does around it.
  struct Transfer {
    Clocks clocks = {};
    std::uint64_t lead = 0;  ///< of all clocks, those before the card's local bus is used
    unsigned accesses = 0;   ///< to registers
  };
  /// At least 8 bytes, a multiple of 8, at most kMappedBytes.
  [[nodiscard]] Transfer transfer(std::uint32_t bytes, bool to_host) const;

  /// From the card's interrupt line to the CPU.
  [[nodiscard]] static Clocks interrupt() { return {.all = 7}; }

 private:
  struct Bursts {
    std::uint64_t pages, number, words;  ///< words of 64 bits
    std::uint64_t first, last;           ///< words of these bursts
  };
  [[nodiscard]] Bursts bursts(std::uint32_t bytes) const;
  [[nodiscard]] Clocks read_after(std::uint64_t retries, std::uint64_t count) const;
  /// From the first data phase, or for a write of host memory from the first request to the card's
  /// local bus, until the last word has arrived; `stolen` by polls from a busy bus.
  [[nodiscard]] double data_clocks(const Bursts& b, bool to_host, double stolen) const;
  /// From the tail to the interrupt, without the data.
  [[nodiscard]] double fixed_clocks(const Bursts& b, bool to_host) const;
  /// What a poll of the driver takes from a transfer, so many clocks after the data phases began.
  [[nodiscard]] double stolen(const Bursts& b, bool to_host, double since) const;

  HostProfile host_;
  std::uint64_t phases_;  ///< data phases of a word: 1, or 2 on a bus of 32 bits
  std::uint64_t burst_;   ///< bytes
  double core_;           ///< PCI clocks of a core clock
};

}  // namespace cde
