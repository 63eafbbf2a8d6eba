// SPDX-License-Identifier: Apache-2.0
#include "card/card_pass.hpp"

#include <fmt/format.h>

#include "cde/contract/pairs.hpp"
#include "cde/contract/records.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"

namespace cde {

Record decode(const std::uint32_t* word, const FloatWords& numbers) {
  Record r;
  for (int k = 0; k < 3; ++k)
    r.cp[k] = numbers.decode(word[card::kRecordCp + static_cast<unsigned>(k)]);
  r.f = bit(word[card::kRecordFlags], card::kFlagF);
  r.bad = bit(word[card::kRecordFlags], card::kFlagBad);
  r.index = word[card::kRecordIndex];
  r.t = numbers.decode(word[card::kRecordT]);
  r.primary = word[card::kRecordPrimary];
  return r;
}

CardPass::CardPass(Board::Impl& card, const Query& query)
    : card_(card),
      query_(query),
      started_(card.cycles()),
      registers_before_(card.register_ps),
      wall_start_(std::chrono::steady_clock::now()) {
  if (query_.progress) pause_ = [this] { query_.progress(0); };
}

std::uint64_t CardPass::work(std::uint64_t cycles) {
  const std::uint64_t asleep = card_.link->time_ps();
  card_.link->run(cycles, pause_);
  waited_ps_ += card_.link->time_ps() - asleep;
  if (!card_.link->interrupt()) return 0;
  const std::uint64_t status = card_.read_register(card::kRegStatus);
  if (bit(status, card::kStatusCommandError)) device_error("command refused", status);
  if (bit(status, card::kStatusBusError)) card_.check_bus("a pass");
  return status;
}

void CardPass::tell_progress(double share) {
  if (!query_.progress) return;
  query_.progress(share);
  pause_ = [this, share] { query_.progress(share); };
}

void CardPass::check_watchdog() {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_start_;
  if (wall > query_.watchdog) timeout(fmt::format("watchdog of {} s", query_.watchdog.count()));
}

void CardPass::fetch(std::uint64_t entries) {
  const std::uint64_t before = card_.link->time_ps();
  words_.resize(2 * beats_of(entries));
  card_.link->read(card::kSpaceSram, 0, words_.data(), beats_of(entries));
  download_ps_ += card_.link->time_ps() - before;
}

std::uint64_t CardPass::check_end(Counters& c) {
  const std::uint64_t ecc = card_.read_register(card::kRegEcc);
  c.corrected_words = card::kEccCorrected.of(ecc);
  const std::uint64_t status = card_.read_register(card::kRegStatus);
  if (bit(status, card::kStatusBusError)) card_.check_bus("the download of records");
  card_.write_register(card::kRegControl, card::kControlClear);
  if (const std::uint64_t failed = card::kEccFailed.of(ecc); failed != 0)
    uncorrectable(failed, status);
  return status;
}

ModelledTime CardPass::times() const {
  return {.load = card_.load_ps,
          .engine = waited_ps_,
          .write_back = 0,
          .download = download_ps_,
          .registers = card_.register_ps - registers_before_};
}

void CardPass::timeout(const std::string& what) {
  throw Error(ErrorCode::kTimeout,
              fmt::format("the card did not finish before its {}: {}", what, state()), fault_at(0));
}

void CardPass::device_error(const std::string& what, std::uint64_t status, std::uint64_t address) {
  throw Error(
      ErrorCode::kDevice,
      fmt::format("{} (mode {}, status {:#x}): {}", what, name_of(query_.mode), status, state()),
      fault_at(address));
}

DeviceFault CardPass::fault_at(std::uint64_t address) {
  DeviceFault fault = card_.link->fault();
  fault.address = static_cast<std::uint32_t>(address);
  return fault;
}

void CardPass::uncorrectable(std::uint64_t words, std::uint64_t status) {
  const auto byte = card_.find_uncorrectable((query_.swap ? card::kCommandSwap : 0) |
                                             card::kCommandPair(*query_.pair));
  device_error(
      fmt::format("{} of DDR {} uncorrectable errors, {}", counted(words, "word"),
                  words == 1 ? "has" : "have",
                  byte               ? fmt::format("in secondary {} at byte {:#x}",
                                                   *byte / (4 * cde::words(card_.secondary_shape)), *byte)
                  : card_.node_cache ? "and no secondary has any: they are in nodes or slots"
                                     : "but were read without them afterwards"),
      status, byte.value_or(0));
}

void CardPass::abort() noexcept {
  try {
    if (!card_.link->lost() && !stopped()) card_.recover();
  } catch (const Error&) {
    // The device is lost, and every later call reports it.
  }
}

bool CardPass::stopped() {
  constexpr unsigned kAsks = 1000;
  constexpr std::uint64_t kStop = card::kControlAbort | card::kControlClear;
  try {
    card_.write_register(card::kRegControl, kStop);
    for (unsigned i = 0; i < kAsks; ++i) {
      if (bit(card_.read_register(card::kRegStatus), card::kStatusBusy)) continue;
      card_.write_register(card::kRegControl, kStop);
      return true;
    }
  } catch (const Error&) {
    if (card_.link->lost()) throw;
  }
  return false;
}

}  // namespace cde
