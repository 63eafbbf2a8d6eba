// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cde {

/// How the connection between host and card is simulated. Records are the same.
enum class Bus {
  kFunctional,  ///< transfers are beats on the card's local bus; their PCI time is computed
  kCycle,       ///< PCI signals cycle by cycle, and the card's DMA engine (docs/reference/pci.md)
};

/// Faults between host and card and in the card's memory, for tests (Board::inject). They affect
/// `count` transactions of the card, unless another unit is named below. kUntilReset: all of them
/// until Board::reset(). Bus::kFunctional supports only kNoAnswer and kHang (on_functional_bus).
enum class BusFault : std::uint32_t {
  kRetry = 0,            ///< retried
  kSlow = 1,             ///< `value` wait states before every data phase
  kDisconnect = 2,       ///< disconnected with data at data phase `value`, from 1
  kDisconnectEmpty = 3,  ///< disconnected without data after `value` data phases, at least 1
  kParity = 4,           ///< wrong parity in data phase `value`, from 1
  kTargetAbort = 5,      ///< aborted after `value` data phases
  kMasterAbort = 6,      ///< not answered
  kLostInterrupt = 7,    ///< `count` interrupts are lost
  kGrant = 8,            ///< the grant is removed `value` cycles after FRAME#
  kNoAnswer = 9,         ///< the card does not answer `count` transactions of the host
  kNoGrant = 10,  ///< the card gets no grant for `count` PCI cycles in which it requests the bus
  kHang = 11,     ///< DDR gives no data for `count` core cycles, so a pass hangs
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

/// Traffic between host and card since it was opened.
struct BusCounters {
  std::uint64_t register_accesses = 0;
  std::uint64_t transfers = 0;      ///< DMA descriptors served
  std::uint64_t bytes_to_card = 0;  ///< by DMA, retries not counted
  std::uint64_t bytes_to_host = 0;
  /// Descriptors, or their remainders, given to the card again.
  std::uint64_t transfer_retries = 0;
  std::uint64_t access_retries = 0;   ///< accesses repeated after a parity error or no answer
  std::uint64_t pass_retries = 0;     ///< passes repeated because records were lost in transfer
  std::uint64_t lost_interrupts = 0;  ///< detected by polling
  std::uint64_t pci_cycles = 0;       ///< modelled PCI cycles. Among them:
  std::uint64_t pci_busy = 0;         ///< cycles with a transaction on the bus
  std::uint64_t pci_data = 0;         ///< cycles in which data moved.
  /// Faults of Board::inject that happened, by BusFault (kNoGrant, kHang: in cycles).
  /// Bus::kFunctional counts only kNoAnswer.
  std::array<std::uint64_t, kBusFaults> faults = {};
};

}  // namespace cde
