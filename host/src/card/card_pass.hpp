// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "card/board_impl.hpp"

namespace cde {

/// Beats of this many ring entries. Two entries share their middle beat.
constexpr std::uint64_t beats_of(std::uint64_t entries) {
  return (card::kRecordWords * entries + 1) / 2;
}

constexpr bool bit(std::uint64_t status, unsigned number) {
  return (status >> number & 1) != 0;
}

/// Decodes a record of the ring. Private to the driver.
[[nodiscard]] Record decode(const std::uint32_t* word, const FloatWords& numbers);

/// Common code of all passes: their cycles, waiting for a working card, stopping it, and messages
/// about a failed pass. Private to the driver.
class CardPass {
 public:
  CardPass(Board::Impl& card, const Query& query);
  CardPass(const CardPass&) = delete;
  CardPass& operator=(const CardPass&) = delete;

 protected:
  ~CardPass() = default;
  /// The card's progress, for messages.
  [[nodiscard]] virtual std::string state() = 0;

  /// Lets the card work for this many cycles or until its interrupt. Returns its status if it
  /// interrupted, else 0. Throws if the card refused the command or an access, and passes on what
  /// Query::progress throws.
  [[nodiscard]] std::uint64_t work(std::uint64_t cycles);
  /// Query::drain_records, rounded up to even: two records share a beat, which needs both.
  [[nodiscard]] std::uint64_t off_full_ring() const {
    return std::max<std::uint64_t>(2, query_.drain_records + query_.drain_records % 2ull);
  }
  /// Reads this many ring entries into words_. The ring must hold them.
  void fetch(std::uint64_t entries);
  /// Reports errors of the bus or of DDR after a pass, clears the card's status and returns it.
  std::uint64_t check_end(Counters& counters);
  void check_watchdog();
  /// Calls Query::progress now, and again with this share while the card works.
  void tell_progress(double share);

  [[noreturn]] void timeout(const std::string& what);
  [[noreturn]] void device_error(const std::string& what, std::uint64_t status,
                                 std::uint64_t address = 0);
  /// Leaves the card idle with an empty ring. Resets a card that does not end, so the next pass
  /// writes everything again. A lost card stays lost.
  void abort() noexcept;
  /// Times of the pass so far.
  [[nodiscard]] ModelledTime times() const;

  Board::Impl& card_;
  const Query& query_;
  std::uint64_t started_;  ///< first clock of the pass
  std::vector<std::uint32_t> words_;

 private:
  [[nodiscard]] DeviceFault fault_at(std::uint64_t address);
  [[noreturn]] void uncorrectable(std::uint64_t words, std::uint64_t status);
  [[nodiscard]] bool stopped();

  std::uint64_t registers_before_, waited_ps_ = 0, download_ps_ = 0;
  std::chrono::steady_clock::time_point wall_start_;
  std::function<void()> pause_;  // reports the last share again
};

}  // namespace cde
