// SPDX-License-Identifier: Apache-2.0
// The memory chips of the board: DDR and SRAM at the ports of board.sv.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>

#include "Vmodel.h"
#include "cde/contract/records.hpp"
#include "ddr_timing.h"
#include "narrow_timing.h"
#include "parameters.h"
#include "sparse_memory.h"

/// Called around every cycle of the core, in this order: before(), falling edge, at(), rising edge,
/// after().
class Chips {
 public:
  static constexpr unsigned kWordBits =
      8 * sizeof(Vmodel::sram_write_data_o) / cde::card::kRecordWords;
  /// `memory` is CDE_MEMORY_*. The ideal memory and the narrow one have a fixed latency in cycles.
  Chips(uint32_t memory, uint32_t ddr_latency, uint32_t clock_period_ps)
      : memory_(memory),
        latency_(ddr_latency),
        period_ps_(clock_period_ps),
        narrow_(ddr_latency),
        ddr_(kDdrBytes + 64),
        check_(kEcc ? kDdrBytes / 4 + 64 : 1),
        sram_(kSramBytes * (kWordBytes / 4)) {}

  void reset() {
    asked_ = answered_;
    narrow_.reset();
    if (hang_ == kUntilReset) hang_ = 0;
  }
  /// Stops DDR's answers for this many cycles; all ones: until reset. Requests made meanwhile are
  /// answered afterwards.
  void hang(uint32_t cycles) { hang_ = cycles; }
  [[nodiscard]] uint64_t hung() const { return hung_; }  // cycles so far
  SparseMemory& ddr() { return ddr_; }
  /// Check bits of DDR, one byte per word; null without ECC.
  SparseMemory* check() { return kEcc ? &check_ : nullptr; }
  SparseMemory& sram() { return sram_; }
  [[nodiscard]] const cde_memory_counters& counters() const { return timing_.counters(); }

  /// Supplies DDR's answer of this cycle to an earlier request.
  void before(Vmodel& m) {
    ++clock_;
    m.ddr_ready_i = memory_ != CDE_MEMORY_NARROW || narrow_.ready(clock_);
    m.ddr_valid_i = 0;
    if (hang_ != 0) {
      if (hang_ != kUntilReset) --hang_;
      ++hung_;
      return;
    }
    const Read& oldest = reads_[answered_ % kReads];
    if (answered_ == asked_ || oldest.due > clock_) return;
    m.ddr_valid_i = 1;
    ++answered_;
    if (const uint8_t* p = ddr_.at(oldest.word * kWordBytes, sizeof(m.ddr_data_i)))
      std::memcpy(&m.ddr_data_i, p, sizeof(m.ddr_data_i));
    if (kEcc)
      if (const uint8_t* p = check_.at(oldest.word, kDdrWords))
        std::memcpy(&m.ddr_check_i, p, kDdrWords);
  }
  /// Whether the card requests this DDR word now.
  [[nodiscard]] static bool asks(const Vmodel& m, uint64_t word) {
    return m.ddr_read_o && word - m.ddr_read_word_o < kDdrWords;
  }
  void at(const Vmodel& m) {
    if (m.ddr_read_o && m.ddr_ready_i) reads_[asked_++ % kReads] = {due(m), m.ddr_read_word_o};
    if (m.ddr_write_o && m.ddr_ready_i && memory_ == CDE_MEMORY_NARROW) narrow_.write(clock_, 8);
    if (m.ddr_write_o)
      if (uint8_t* p = ddr_.at(m.ddr_write_addr_o, 8)) std::memcpy(p, &m.ddr_write_data_o, 8);
    if (kEcc && m.ddr_write_o) {
      constexpr uint64_t kWords = 8 / kWordBytes;
      if (uint8_t* p = check_.at(m.ddr_write_addr_o / 8 * kWords, kWords))
        std::memcpy(p, &m.ddr_write_check_o, kWords);
    }
    if (m.sram_write_o)
      if (uint8_t* p = sram_.at(m.sram_write_addr_o * kRecord, kRecord))
        std::memcpy(p, &m.sram_write_data_o, kRecord);
    fetched_ = m.sram_read_o ? sram_.at(m.sram_read_addr_o * kRecord, kRecord) : nullptr;
  }
  void after(Vmodel& m) {
    if (fetched_ != nullptr) std::memcpy(&m.sram_read_data_i, fetched_, kRecord);
  }

 private:
  /// A requested beat, and the first cycle in which its data are ready.
  struct Read {
    uint64_t due = 0, word = 0;
  };
  [[nodiscard]] uint64_t due(const Vmodel& m) {
    if (memory_ == CDE_MEMORY_IDEAL) return clock_ + latency_;
    if (memory_ == CDE_MEMORY_NARROW) return narrow_.read(clock_, m.ddr_read_words_o * kWordBytes);
    const uint64_t ready =
        timing_.read(clock_ * period_ps_, m.ddr_read_word_o * kWordBytes, kDdrWords * kWordBytes);
    return (ready + period_ps_ - 1) / period_ps_;
  }

  static constexpr unsigned kDdrWords = cde::card::kDdrWords;
  static constexpr uint64_t kReads = 256;  // more than the card requests ahead
  static constexpr uint64_t kWordBytes = sizeof(Vmodel::ddr_data_i) / kDdrWords;
  static constexpr uint32_t kUntilReset = ~0u;
  static constexpr uint64_t kDdrBytes = 2'000'000'000;
  static constexpr uint64_t kSramBytes = cde::card::kRecordWords * 2097152;
  static constexpr uint64_t kRecord = sizeof(Vmodel::sram_write_data_o);
  static constexpr bool kEcc = parameter("ECC", 0) != 0;  // one byte of check bits per word
  const uint32_t memory_;
  const uint64_t latency_, period_ps_;
  DdrTiming timing_;
  NarrowTiming narrow_;
  SparseMemory ddr_, check_, sram_;
  std::array<Read, kReads> reads_ = {};
  uint32_t hang_ = 0;
  const uint8_t* fetched_ = nullptr;
  uint64_t clock_ = 0, asked_ = 0, answered_ = 0, hung_ = 0;
};
