// SPDX-License-Identifier: Apache-2.0
// Harness of the `pair_unit` top module: clock, operands and results row by row, waves. Exports the
// C interface of abi_pair.h.
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "Vmodel.h"
#include "cde/abi/abi_pair.h"
#include "coverage.h"
#include "parameters.h"
#include "verilated.h"
#include "wave_file.h"

/// An operator that the model has reported.
struct Operator {
  std::string path;
  uint32_t operation, latency;
};

struct cde_pair_unit {
  std::unique_ptr<VerilatedContext> context{new VerilatedContext};
  std::unique_ptr<Vmodel> model{new Vmodel(context.get(), "pair_unit")};
  WaveFile waves;
  uint64_t cycles = 0, start = 0;
  cde_pair_progress progress{};
  uint32_t iterations = 0x080808;
  std::vector<Operator> operators;
  std::vector<cde_pair_operator> shown;  // the same operators for C
  void (*seen)(void*, uint32_t, uint64_t, uint64_t, uint64_t, uint64_t) = nullptr;
  void* seen_context = nullptr;

  static inline thread_local cde_pair_unit* evaluated = nullptr;

  cde_pair_unit() {
    reset();
    for (const Operator& o : operators) shown.push_back({o.path.c_str(), o.operation, o.latency});
  }
  ~cde_pair_unit() {
    trace_close();
    Verilated::threadContextp(context.get());
    model->final();
    cde_write_coverage(context.get(), "pair_unit");
  }

  void reset() {
    model->rst_i = 1;
    model->valid_i = 0;
    model->iterations_i = iterations;
    for (int i = 0; i < 4; ++i) tick();
    model->rst_i = 0;
    model->eval();  // the waves already have this time
  }

  void eval() {
    evaluated = this;
    model->eval();
    waves.dump(2 * cycles + model->clk_i);
  }

  void tick() {
    model->clk_i = 1;
    eval();
    ++cycles;
    model->clk_i = 0;
    eval();
  }

  int trace_open(const cde_trace& what) {
    const int opened = waves.open(*context, *model, what, 2 * cycles);
    waves.dump(2 * cycles + model->clk_i);  // makes the first rising edge visible
    return opened;
  }
  int trace_close() { return waves.close(); }
};

namespace {

constexpr unsigned kLanes = parameter("LANES", 8);
constexpr size_t kWord = sizeof(Vmodel::t_o) / kLanes;
constexpr size_t kAWords = sizeof(Vmodel::a_i) / (kWord * kLanes);
constexpr size_t kBWords = sizeof(Vmodel::b_i) / (kWord * kLanes);

/// Writes operand words of up to a row of pairs into a port of [word][lane]. Lanes without a pair
/// keep their words.
void scatter(void* port, const uint8_t* from, size_t words, uint64_t pairs) {
  auto* to = static_cast<uint8_t*>(port);
  for (uint64_t lane = 0; lane < pairs; ++lane)
    for (size_t w = 0; w < words; ++w)
      std::memcpy(to + (w * kLanes + lane) * kWord, from + (lane * words + w) * kWord, kWord);
}

void gather(const Vmodel& m, uint8_t* to, uint64_t pairs) {
  const auto word = [&](const void* port, size_t index, uint64_t lane) {
    return static_cast<const uint8_t*>(port) + (index * kLanes + lane) * kWord;
  };
  for (uint64_t lane = 0; lane < pairs; ++lane, to += CDE_PAIR_RESULT_WORDS * kWord) {
    std::memset(to, 0, 2 * kWord);
    to[CDE_PAIR_F * kWord] = *word(&m.f_o, 0, lane) & 1;
    to[CDE_PAIR_BAD * kWord] = *word(&m.bad_o, 0, lane) & 1;
    std::memcpy(to + CDE_PAIR_T * kWord, word(&m.t_o, 0, lane), kWord);
    for (size_t k = 0; k < 3; ++k) {
      std::memcpy(to + (CDE_PAIR_CP + k) * kWord, word(&m.cp_o, k, lane), kWord);
      std::memcpy(to + (CDE_PAIR_N + k) * kWord, word(&m.n_o, k, lane), kWord);
    }
  }
}

uint64_t test(cde_pair_unit* unit, const void* a, const void* b, void* results, uint64_t n,
              uint32_t (*gap)(void*), void* gap_context) {
  Vmodel& m = *unit->model;
  const auto* pa = static_cast<const uint8_t*>(a);
  const auto* pb = static_cast<const uint8_t*>(b);
  auto* out = static_cast<uint8_t*>(results);
  const uint64_t start = unit->start = unit->cycles, rows = (n + kLanes - 1) / kLanes;
  const auto size = [&](uint64_t row) {
    return row + 1 < rows || n % kLanes == 0 ? kLanes : n % kLanes;
  };
  cde_pair_progress& seen = unit->progress = {};
  uint64_t& in = seen.taken;
  uint64_t& got = seen.answered;
  uint64_t last = start;  // cycle of the last progress
  bool offered = false;   // a row waits at the input port until it is taken
  uint32_t wait = rows != 0 && gap != nullptr ? gap(gap_context) : 0;
  while (got < rows) {
    // Results of the row that entered one latency ago precede the clock that takes the next row.
    if (m.valid_o) {
      seen.disordered = m.tag_o != static_cast<uint32_t>(got) || got == in;
      if (seen.disordered != 0) return CDE_PAIR_STUCK;
      gather(m, out + got * kLanes * CDE_PAIR_RESULT_WORDS * kWord, size(got));
      ++got;
      last = unit->cycles;
      if (got == rows) break;
    }
    if (!offered && in < rows && wait == 0) {
      scatter(&m.a_i, pa + in * kLanes * kAWords * kWord, kAWords, size(in));
      scatter(&m.b_i, pb + in * kLanes * kBWords * kWord, kBWords, size(in));
      m.tag_i = static_cast<uint32_t>(in);
      offered = true;
    }
    m.valid_i = offered;
    if (offered && m.ready_o) {
      offered = false;
      ++in;
      last = unit->cycles;
      wait = in < rows && gap != nullptr ? gap(gap_context) : 0;
    } else if (wait != 0) {
      --wait;
      if (got == in) last = unit->cycles;  // waits only for the gap
    }
    seen.cycle = last - start;
    if (unit->cycles - last > CDE_PAIR_PATIENCE) return CDE_PAIR_STUCK;
    unit->tick();
  }
  m.valid_i = 0;
  unit->tick();
  return unit->cycles - 1 - start;
}

const cde_pair_api kApi = {
    {CDE_PAIR_ABI, sizeof(cde_pair_api)},
    kWord,
    kLanes,
    kAWords,
    kBWords,
    CDE_CONFIG_HASH,
    kParameters,
    []() -> cde_pair_unit* {
      try {
        return new cde_pair_unit;
      } catch (const std::bad_alloc&) {
        return nullptr;
      }
    },
    [](cde_pair_unit* unit) { delete unit; },
    [](const cde_pair_unit* unit) { return uint32_t{unit->model->latency_o}; },
    [](cde_pair_unit* unit, uint32_t iterations) {
      unit->iterations = iterations;
      unit->reset();
    },
    test,
    [](const cde_pair_unit* unit) { return unit->progress; },
    [](cde_pair_unit* unit) { unit->reset(); },
    [](cde_pair_unit* unit, const cde_trace* what) { return unit->trace_open(*what); },
    [](cde_pair_unit* unit) { return unit->trace_close(); },
    [](const cde_pair_unit* unit) { return static_cast<uint32_t>(unit->shown.size()); },
    [](const cde_pair_unit* unit, uint32_t index) { return &unit->shown[index]; },
    [](cde_pair_unit* unit, void (*seen)(void*, uint32_t, uint64_t, uint64_t, uint64_t, uint64_t),
       void* context) {
      unit->seen = seen;
      unit->seen_context = context;
    },
};

}  // namespace

#ifdef CDE_TAP
// Called by rtl/simulated/operator_tap.sv. All operators of a unit have called it after the first
// clock.
extern "C" int cde_tap_open(const char* path, int operation, int latency) {
  cde_pair_unit& unit = *cde_pair_unit::evaluated;
  unit.operators.push_back(
      {path, static_cast<uint32_t>(operation), static_cast<uint32_t>(latency)});
  return static_cast<int>(unit.operators.size()) - 1;
}
extern "C" void cde_tap(int tap, unsigned long long a, unsigned long long b, unsigned long long r) {
  const cde_pair_unit& unit = *cde_pair_unit::evaluated;
  if (unit.seen != nullptr)
    unit.seen(unit.seen_context, static_cast<uint32_t>(tap), unit.cycles - unit.start, a, b, r);
}
#endif

extern "C" __attribute__((visibility("default"))) const cde_pair_api* cde_pair_entry() {
  return &kApi;
}
