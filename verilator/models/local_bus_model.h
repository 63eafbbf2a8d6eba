// SPDX-License-Identifier: Apache-2.0
// Harness of a top module with the local bus at its ports: clock, chips, bus master, waves. Exports
// the C interface of abi.h. The including file has the class Chips, the memories at the other
// ports.
#pragma once
#include <cstring>
#include <memory>
#include <new>

#include "Vmodel.h"
#include "cde/abi/abi.h"
#include "cde/contract/records.hpp"
#include "cde/contract/registers.hpp"
#include "coverage.h"
#include "random_start.h"
#include "verilated.h"
#include "wave_file.h"

namespace {

/// One card: the Verilated top, its clock, and the chips around it.
class Card {
 public:
  explicit Card(const cde_board_options& o)
      : options_(o),
        context_(new VerilatedContext),
        random_(*context_),
        model_(new Vmodel(context_.get(), CDE_KIND)),
        chips_(options_.memory, options_.ddr_latency, options_.clock_period_ps) {
    random_.before_reset(*model_, [this] {
      for (const int level : {0, 1}) {
        model_->clk_i = level;
        model_->eval();
      }
    });
    reset();
    random_.after_reset();
  }
  ~Card() {
    trace_close();
    // A thread remembers the context that it used last, which may belong to a destroyed card.
    Verilated::threadContextp(context_.get());
    model_->final();
    cde_write_coverage(context_.get(), CDE_KIND);
  }

  void reset() {
    model_->rst_i = 1;
    chips_.reset();
    for (int i = 0; i < 4; ++i) tick();
    model_->rst_i = 0;
    tick();
  }

  uint64_t write(uint32_t space, uint32_t offset, const uint8_t* data, uint64_t beats,
                 uint64_t max_cycles) {
    uint64_t done = 0;
    if (space >> cde::card::kSpaceBits != 0) return 0;
    model_->bus_valid_i = 1;
    model_->bus_write_i = 1;
    model_->bus_space_i = space;
    for (uint64_t limit = cycles_ + max_cycles; done < beats && cycles_ < limit;) {
      model_->bus_addr_i = offset + static_cast<uint32_t>(8 * done);
      std::memcpy(&model_->bus_wdata_i, data + 8 * done, 8);
      done += tick();
    }
    model_->bus_valid_i = 0;
    return done;
  }

  uint64_t read(uint32_t space, uint32_t offset, uint8_t* data, uint64_t beats,
                uint64_t max_cycles) {
    uint64_t asked = 0, got = 0;
    if (space >> cde::card::kSpaceBits != 0) return 0;
    model_->bus_write_i = 0;
    model_->bus_space_i = space;
    for (uint64_t limit = cycles_ + max_cycles; got < beats && cycles_ < limit;) {
      model_->bus_valid_i = asked < beats;
      model_->bus_addr_i =
          space == cde::card::kSpaceSram ? 0 : offset + static_cast<uint32_t>(8 * asked);
      asked += tick() && model_->bus_valid_i;
      if (model_->bus_rvalid_o) std::memcpy(data + 8 * got++, &model_->bus_rdata_o, 8);
    }
    model_->bus_valid_i = 0;
    return got;
  }

  uint64_t run(uint64_t max_cycles) {
    const uint64_t start = cycles_;
    while (!model_->irq_o && cycles_ - start < max_cycles) tick();
    return cycles_ - start;
  }
  void advance(uint64_t cycles) {
    for (const uint64_t end = cycles_ + cycles; cycles_ < end;) tick();
  }
  bool interrupt() const { return model_->irq_o; }
  const cde_memory_counters& memory() const { return chips_.counters(); }
  uint64_t cycles() const { return cycles_; }

  int trace_open(const cde_trace& what) {
    return waves_.open(*context_, *model_, what, cycles_ * options_.clock_period_ps);
  }
  int trace_close() { return waves_.close(); }

  int ddr_flip(uint64_t byte, uint8_t mask) { return flip(&chips_.ddr(), byte, mask); }
  int check_flip(uint64_t word, uint8_t mask) { return flip(chips_.check(), word, mask); }
  void ddr_hang(uint32_t cycles) { chips_.hang(cycles); }

 private:
  static int flip(SparseMemory* memory, uint64_t byte, uint8_t mask) {
    uint8_t* const p = memory != nullptr ? memory->at(byte, 1) : nullptr;
    if (p == nullptr) return -1;
    *p ^= mask;
    return 0;
  }

  /// Runs one cycle with the caller's inputs. Returns whether the card took the offered bus beat.
  bool tick() {
    chips_.before(*model_);
    model_->clk_i = 0;
    eval();
    const bool taken = model_->bus_valid_i && model_->bus_ready_o;
    chips_.at(*model_);
    model_->clk_i = 1;
    eval();
    chips_.after(*model_);
    ++cycles_;
    return taken;
  }

  void eval() {
    model_->eval();
    const uint64_t now =
        cycles_ * options_.clock_period_ps + (model_->clk_i ? options_.clock_period_ps / 2 : 0);
    if (Chips::asks(*model_, waves_.awaited_word())) waves_.begin(now);
    waves_.dump(now);
  }

  cde_board_options options_;
  std::unique_ptr<VerilatedContext> context_;
  RandomStart random_;
  std::unique_ptr<Vmodel> model_;
  WaveFile waves_;
  Chips chips_;
  uint64_t cycles_ = 0;
};

Card* card(void* p) {
  return static_cast<Card*>(p);
}

const cde_board_api kApi = {
    {CDE_BOARD_ABI, sizeof(cde_board_api)},
    Chips::kWordBits,
    CDE_CONFIG_HASH,
#include "params.inc"
    ,
    [](const cde_board_options* o) -> void* {
      try {
        return new Card(*o);
      } catch (const std::bad_alloc&) {
        return nullptr;
      }
    },
    [](void* p) { delete card(p); },
    [](void* p) { card(p)->reset(); },
    [](void* p, uint32_t space, uint32_t offset, const void* data, uint64_t beats,
       uint64_t max_cycles) {
      return card(p)->write(space, offset, static_cast<const uint8_t*>(data), beats, max_cycles);
    },
    [](void* p, uint32_t space, uint32_t offset, void* data, uint64_t beats, uint64_t max_cycles) {
      return card(p)->read(space, offset, static_cast<uint8_t*>(data), beats, max_cycles);
    },
    [](void* p, uint64_t max_cycles) { return card(p)->run(max_cycles); },
    [](void* p, uint64_t cycles) { card(p)->advance(cycles); },
    [](void* p) { return static_cast<int>(card(p)->interrupt()); },
    [](void* p) { return card(p)->cycles(); },
    [](void* p, cde_memory_counters* c) { *c = card(p)->memory(); },
    [](void* p, const cde_trace* what) { return card(p)->trace_open(*what); },
    [](void* p) { return card(p)->trace_close(); },
    [](void* p, uint64_t byte, uint8_t mask) { return card(p)->ddr_flip(byte, mask); },
    [](void* p, uint64_t word, uint8_t mask) { return card(p)->check_flip(word, mask); },
    [](void* p, uint32_t cycles) { card(p)->ddr_hang(cycles); },
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const cde_board_api* cde_board_entry() {
  return &kApi;
}
