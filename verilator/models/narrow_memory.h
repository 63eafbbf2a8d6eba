// SPDX-License-Identifier: Apache-2.0
// The memory at the ports of fpga_card.sv: 16 bits per cycle, in order.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>

#include "Vmodel.h"
#include "cde/abi/abi.h"
#include "sparse_memory.h"

/// Called around every cycle of the core, as in chips.h.
class Chips {
 public:
  static constexpr unsigned kWordBits = 32;

  /// A read is answered after `latency` cycles, at least one, for any kind of memory.
  Chips(uint32_t /*memory*/, uint32_t latency, uint32_t /*clock_period_ps*/)
      : latency_(latency == 0 ? 1 : latency), data_(kBytes) {}

  void reset() {
    asked_ = answered_;
    if (hang_ == kUntilReset) hang_ = 0;
  }
  /// Stops the memory for this many cycles; all ones: until reset.
  void hang(uint32_t cycles) { hang_ = cycles; }
  SparseMemory& ddr() { return data_; }
  SparseMemory* check() { return nullptr; }
  [[nodiscard]] const cde_memory_counters& counters() const { return counters_; }
  [[nodiscard]] static bool asks(const Vmodel& m, uint64_t word) {
    return m.memory_access_o && !m.memory_write_o && m.memory_addr_o / 2 == word;
  }

  void before(Vmodel& m) {
    ++clock_;
    m.memory_valid_i = 0;
    m.memory_ready_i = hang_ == 0 && asked_ - answered_ < kReads;
    if (hang_ != 0) {
      if (hang_ != kUntilReset) --hang_;
      return;
    }
    const Read& oldest = reads_[answered_ % kReads];
    if (answered_ == asked_ || oldest.due > clock_) return;
    m.memory_valid_i = 1;
    ++answered_;
    if (const uint8_t* p = data_.at(oldest.half * 2, 2)) std::memcpy(&m.memory_data_i, p, 2);
  }
  void at(const Vmodel& m) {
    if (!m.memory_access_o || !m.memory_ready_i) return;
    const uint64_t half = m.memory_addr_o;
    if (!m.memory_write_o) {
      reads_[asked_++ % kReads] = {clock_ + latency_, half};
    } else if (uint8_t* p = data_.at(half * 2, 2)) {
      std::memcpy(p, &m.memory_data_o, 2);
    }
  }
  void after(Vmodel&) {}

 private:
  struct Read {
    uint64_t due = 0, half = 0;
  };
  static constexpr uint64_t kReads = 512, kBytes = 2'000'000'000;
  static constexpr uint32_t kUntilReset = ~0u;
  const uint64_t latency_;
  SparseMemory data_;
  std::array<Read, kReads> reads_ = {};
  cde_memory_counters counters_ = {};
  uint32_t hang_ = 0;
  uint64_t clock_ = 0, asked_ = 0, answered_ = 0;
};
