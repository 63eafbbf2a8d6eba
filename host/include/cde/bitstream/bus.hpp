// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cde {

/// How the way between host and card is simulated. Records are the same.
enum class Bus {
  kFunctional,  ///< transfers are beats on the card's local bus; what they would take on PCI is
                ///< computed
  kCycle,       ///< PCI signals clock by clock, and the card's DMA engine (docs/reference/pci.md)
};

/// What can go wrong between host and card and in its memory, for tests (Board::inject). `count`
/// transactions of the card get it, unless another unit is named; kUntilReset: all of them until
/// Board::reset(). Bus::kFunctional has kNoAnswer and kHang only (on_functional_bus).
enum class BusFault : std::uint32_t {
  kRetry = 0,            ///< retried
  kSlow = 1,             ///< `value` wait states before every data phase
  kDisconnect = 2,       ///< disconnected with data at data phase `value`, from 1
  kDisconnectEmpty = 3,  ///< disconnected without data after `value` data phases, at least 1
  kParity = 4,           ///< wrong parity in data phase `value`, from 1
  kTargetAbort = 5,      ///< aborted after `value` data phases
  kMasterAbort = 6,      ///< not answered
  kLostInterrupt = 7,    ///< `count` interrupts are not seen
  kGrant = 8,            ///< the grant is taken away `value` clocks after FRAME#
  kNoAnswer = 9,         ///< the card does not answer `count` transactions of the host
  kNoGrant = 10,  ///< the card is not given the bus for `count` PCI clocks in which it asks for it
  kHang = 11,     ///< DDR gives no data for `count` core clocks, so a pass hangs
};
inline constexpr std::uint32_t kBusFaults = 12;
inline constexpr std::uint32_t kUntilReset = ~std::uint32_t{0};

/// "retry", "slow", "disconnect", "disconnect-empty", "parity", "target-abort", "master-abort",
/// "lost-interrupt", "grant", "no-answer", "no-grant", "hang".
[[nodiscard]] const char* name_of(BusFault fault);
[[nodiscard]] std::optional<BusFault> fault_named(std::string_view name);
[[nodiscard]] constexpr bool on_functional_bus(BusFault fault) {
  return fault == BusFault::kNoAnswer || fault == BusFault::kHang;
}

/// What happened on the way to the card since it was opened.
struct BusCounters {
  std::uint64_t register_accesses = 0;
  std::uint64_t transfers = 0;      ///< DMA descriptors served
  std::uint64_t bytes_to_card = 0;  ///< by DMA, retries not counted
  std::uint64_t bytes_to_host = 0;
  std::uint64_t transfer_retries = 0;  ///< descriptors, or their rest, given to the card again
  std::uint64_t access_retries = 0;    ///< accesses repeated after a parity error or no answer
  std::uint64_t pass_retries = 0;      ///< passes run again because records were lost on their way
  std::uint64_t lost_interrupts = 0;   ///< found by polling
  std::uint64_t pci_clocks = 0;        ///< of modelled time; of them ...
  std::uint64_t pci_busy = 0;          ///< ... with a transaction on the bus,
  std::uint64_t pci_data = 0;          ///< ... in which data moved
  /// Faults of Board::inject that happened, by BusFault (kNoGrant, kHang: clocks);
  /// Bus::kFunctional counts kNoAnswer only.
  std::array<std::uint64_t, kBusFaults> faults = {};
};

}  // namespace cde
