// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "card/board_impl.hpp"

namespace cde {

/// Of so many ring entries: two share their middle beat.
constexpr std::uint64_t beats_of(std::uint64_t entries) {
  return (card::kRecordWords * entries + 1) / 2;
}

constexpr bool bit(std::uint64_t status, unsigned number) {
  return (status >> number & 1) != 0;
}

/// A record as the ring has it. Private to the driver.
[[nodiscard]] Record decode(const std::uint32_t* word, const FloatWords& numbers);

/// What all passes share: their clocks, how a card that works is waited for, how one is stopped,
/// and what is said of one that fails. Private to the driver.
class CardPass {
 public:
  CardPass(Board::Impl& card, const Query& query);
  CardPass(const CardPass&) = delete;
  CardPass& operator=(const CardPass&) = delete;

 protected:
  ~CardPass() = default;
  /// What the card has done so far, for messages.
  [[nodiscard]] virtual std::string state() = 0;

  /// Lets the card work for so many clocks or until its interrupt; its status then, else 0. Throws
  /// if it refused the command or an access, and what Query::progress throws meanwhile.
  [[nodiscard]] std::uint64_t work(std::uint64_t clocks);
  /// Query::drain_records, an even number of them: the beat that two records share is there when
  /// both are.
  [[nodiscard]] std::uint64_t off_full_ring() const {
    return std::max<std::uint64_t>(2, query_.drain_records + query_.drain_records % 2ull);
  }
  /// So many entries of the ring, which are there, into words_.
  void fetch(std::uint64_t entries);
  /// Errors of the bus or of DDR behind a pass that is done; clears its state, and returns what it
  /// was.
  std::uint64_t check_end(Counters& counters);
  void check_watchdog();
  /// Calls Query::progress, and again with this share while the card works.
  void tell_progress(double share);

  [[noreturn]] void timeout(const std::string& what);
  [[noreturn]] void device_error(const std::string& what, std::uint64_t status,
                                 std::uint64_t address = 0);
  /// Leaves the card idle and its ring empty. A card that does not come to an end is reset, and the
  /// next pass writes again what that takes; one that is lost stays so.
  void abort() noexcept;
  /// Times of the pass so far.
  [[nodiscard]] ModelledTime times() const;

  Board::Impl& card_;
  const Query& query_;
  std::uint64_t started_;  ///< clock
  std::vector<std::uint32_t> words_;

 private:
  [[nodiscard]] DeviceFault fault_at(std::uint64_t address);
  [[noreturn]] void uncorrectable(std::uint64_t words, std::uint64_t status);
  [[nodiscard]] bool stopped();

  std::uint64_t registers_before_, waited_ps_ = 0, download_ps_ = 0;
  std::chrono::steady_clock::time_point wall_start_;
  std::function<void()> pause_;  // tells the last share again
};

}  // namespace cde
