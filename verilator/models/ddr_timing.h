// SPDX-License-Identifier: Apache-2.0
// Timing of reads from DDR SDRAM: two 1 GB modules of DDR-400 side by side, 144 bits wide, with
// open pages. Times are picoseconds of the card's own time. Requests are served in order, each as
// soon as its bank and the data bus allow. So a bank opens its row while another bank's data are on
// the bus. The parameters are JEDEC's for the DDR-400B speed bin (3-3-3) and 512 Mbit chips
// (JESD79). kController is an assumption.
//
// Writes take no time here. The DDR is not written during a pass, and the host writes at most 8
// bytes per core clock, a ninth of the modules' rate.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "cde/abi/abi_memory.h"

class DdrTiming {
 public:
  /// When the data of this read are at the card's pins. Data arrive in the order of the reads.
  uint64_t read(uint64_t now, uint64_t byte, uint64_t bytes) {
    const uint64_t arrived = now + kController;
    for (uint64_t burst = byte / kBurstBytes; burst * kBurstBytes < byte + bytes; ++burst)
      if (burst != held_[0] && burst != held_[1]) fetch(arrived, burst);
    return std::max(arrived, data_end_);
  }

  [[nodiscard]] const cde_memory_counters& counters() const { return counters_; }

 private:
  static constexpr uint64_t kClock = 5'000;       // 200 MHz, two transfers per clock
  static constexpr uint64_t kBurstBytes = 72;     // 4 transfers of 18 bytes
  static constexpr uint64_t kBurst = 2 * kClock;  // on the data bus
  static constexpr uint64_t kRowBytes = 36'864;   // 2,048 columns of 18 bytes
  static constexpr uint64_t kBanks = 8;     // 2 ranks of 4; consecutive rows use consecutive banks
  static constexpr uint64_t kRcd = 15'000;  // from opening a row to a read
  static constexpr uint64_t kRp = 15'000;   // precharge
  static constexpr uint64_t kCas = 15'000;  // from a read to its data
  static constexpr uint64_t kRas = 40'000;  // least time that a row stays open
  static constexpr uint64_t kRfc = 70'000;  // refresh
  static constexpr uint64_t kRefi = 7'812'500;     // between refreshes
  static constexpr uint64_t kController = 40'000;  // request and data through the controller
  static constexpr uint64_t kNone = ~0ull;

  struct Bank {
    uint64_t row = kNone, opened = 0, ready = 0;
  };

  void fetch(uint64_t arrived, uint64_t burst) {
    refresh(arrived);
    const uint64_t page = burst * kBurstBytes / kRowBytes;
    Bank& bank = banks_[page % kBanks];
    uint64_t command = std::max(arrived, bank.ready);
    if (bank.row != page) {
      ++counters_.row_misses;
      if (bank.row != kNone) command = std::max(command, bank.opened + kRas) + kRp;
      bank.row = page;
      bank.opened = command;
      command += kRcd;
    }
    // The bank's next read may follow once this read's burst has ended.
    command = std::max(command, data_end_ < kCas ? 0 : data_end_ - kCas);
    bank.ready = command + kBurst;
    data_end_ = command + kCas + kBurst;
    held_ = {held_[1], burst};
    ++counters_.bursts;
  }

  /// Due refreshes go first and close all rows. Refreshes during an idle time are over, and only
  /// the last one can still delay a read.
  void refresh(uint64_t now) {
    if (now < next_refresh_) return;
    const uint64_t due = next_refresh_ + (now - next_refresh_) / kRefi * kRefi;
    const uint64_t done = std::max(due, data_end_) + kRp + kRfc;
    for (Bank& bank : banks_) bank = {.ready = done};
    counters_.refreshes += done > now ? 1 : 0;
    next_refresh_ = due + kRefi;
  }

  std::array<Bank, kBanks> banks_ = {};
  std::array<uint64_t, 2> held_ = {kNone, kNone};  // bursts held in the controller
  uint64_t data_end_ = 0, next_refresh_ = kRefi;
  cde_memory_counters counters_ = {};
};
