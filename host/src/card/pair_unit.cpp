// SPDX-License-Identifier: Apache-2.0
#include "cde/card/pair_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <utility>

#include "card/abi_table.hpp"
#include "cde/abi/abi_pair.h"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

std::vector<std::string> PairConfig::parameters() const {
  const auto in_range = [](std::string_view what, unsigned value, unsigned low, unsigned high) {
    if (value < low || value > high)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is {}, expected {} to {}", what, value, low, high));
  };
  check(arithmetic);
  (void)name(pair);
  (void)name(algorithm);
  in_range("plane", static_cast<unsigned>(plane), 0, 1);
  in_range("lanes", lanes, 1, tap ? 1 : 256);
  for (const unsigned cycles : cycles_of(latency))
    in_range("latency of an operator", cycles, 1, kMostOperatorLatency);
  if (algorithm != Algorithm::kMoller && pair != Pair::kRayTriangle)
    throw Error(ErrorCode::kUsage, fmt::format("{} has only one algorithm", name(pair)));
  if (box && !has_box_rule(pair))
    throw Error(ErrorCode::kUsage, fmt::format("{} has no box rule", name(pair)));
  if (plane != PlaneSide::kSurface && secondary_shape(pair) != Shape::kPlane)
    throw Error(ErrorCode::kUsage, fmt::format("{} has no half-space", name(pair)));
  check_sat_interval(sat_interval, {&pair, 1});
  std::vector<std::string> p{
      fmt::format("PAIR={}", static_cast<unsigned>(pair)), fmt::format("EXP={}", format.exp_bits),
      fmt::format("MAN={}", format.man_bits), fmt::format("LANES={}", lanes),
      fmt::format("ARITH={}", arithmetic == Arithmetic::kRtl ? "rtl" : "host")};
  if (pair == Pair::kRayTriangle)
    p.push_back(fmt::format("ALGORITHM={}", static_cast<unsigned>(algorithm)));
  if (box) p.emplace_back("BOX=1");
  if (plane == PlaneSide::kHalfSpace) p.emplace_back("HALF_SPACE=1");
  const auto add = [&p](std::string_view key, unsigned value) {
    if (value != 1) p.push_back(fmt::format("{}={}", key, value));
  };
  add("SAT_II", sat_interval);
  add("LAT_ADD", latency.add);
  add("LAT_MUL", latency.mul);
  add("LAT_DIV", latency.div);
  add("LAT_SQRT", latency.sqrt);
  add("LAT_CMP", latency.compare);
  if (trace) p.emplace_back("TRACE=1");
  if (tap) p.emplace_back("TAP=1");
  return p;
}

namespace {
/// Operands and results in the unit's word width. Tests reuse the buffers: new ones would be new
/// pages of memory each time.
template <class Word>
struct Buffers {
  std::vector<Word> a, b, out;
};
}  // namespace

struct PairUnit::State {
  SimulationModel model;
  PairConfig config;
  const cde_pair_api* api = nullptr;
  cde_pair_unit* unit = nullptr;
  bool testing = false;
  Buffers<std::uint32_t> narrow;
  Buffers<std::uint64_t> wide;

  State(const SimulationModel& m, const PairConfig& c) : model(m), config(c) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (unit != nullptr) api->destroy(unit);
  }
};

PairUnit::PairUnit(const SimulationModel& model, const PairConfig& config)
    : state_(std::make_shared<State>(model, config)) {
  State& s = *state_;
  s.api = abi_table<cde_pair_entry_fn>(s.model, "cde_pair_entry", CDE_PAIR_ABI);
  const std::string path = printable_name(model.path().string());
  if (s.api->lanes != config.lanes || s.api->a_words != primary_words(config.pair) ||
      s.api->b_words != secondary_words(config.pair) || s.api->config_hash != s.model.config_hash())
    throw Error(
        ErrorCode::kConfiguration,
        fmt::format("simulation model {} is not the requested {} unit", path, name(config.pair)));
  s.unit = s.api->create();
  if (s.unit == nullptr)
    throw Error(ErrorCode::kDevice, fmt::format("simulation model {}: out of memory", path));
}

PairUnit::PairUnit(const PairConfig& config)
    : PairUnit(SimulationModel::open("pair_unit", config.parameters()), config) {}

PairUnit::~PairUnit() = default;
PairUnit::PairUnit(PairUnit&&) noexcept = default;
PairUnit& PairUnit::operator=(PairUnit&&) noexcept = default;

PairUnit::State& PairUnit::state() const {
  if (!state_) throw Error(ErrorCode::kUsage, "this PairUnit is empty: it was moved from");
  return *state_;
}

PairUnit::State& PairUnit::idle() const {
  if (state().testing)
    throw Error(ErrorCode::kUsage,
                "this PairUnit runs a test(); its gap must not start other work");
  return state();
}

const PairConfig& PairUnit::config() const {
  return state().config;
}
unsigned PairUnit::latency() const {
  return state().api->latency(state().unit);
}
void PairUnit::set_iterations(const PairIterations& iterations) {
  if (!has_iterations(state().config.pair))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} has no iterations to set", name(state().config.pair)));
  iterations.check();
  idle().api->set_iterations(state().unit,
                             iterations.free << 16 | iterations.circle << 8 | iterations.samples);
}
void PairUnit::reset() {
  idle().api->reset(state().unit);
}

namespace {

[[noreturn]] void throw_stuck(const cde_pair_api& api, const cde_pair_unit* unit,
                              std::size_t pairs) {
  const cde_pair_progress p = api.progress(unit);
  DeviceFault fault;
  fault.cycle = p.cycle;
  throw Error(
      ErrorCode::kTimeout,
      fmt::format("pair_unit: {} of {} rows of {} pairs were taken and {} answered, the last at "
                  "cycle {}; {}",
                  p.taken, (pairs + api.lanes - 1) / api.lanes, api.lanes, p.answered, p.cycle,
                  p.disordered != 0
                      ? "then an answer came for another row than the next"
                      : fmt::format("there was no progress for {} cycles", +CDE_PAIR_PATIENCE)),
      fault);
}

/// Converts between the driver's 64-bit words and the unit's width.
template <class Word>
std::uint64_t run(const cde_pair_api& api, cde_pair_unit* unit, Buffers<Word>& words,
                  std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                  std::span<PairResult> results, uint32_t (*gap)(void*), void* context) {
  words.a.assign(a.begin(), a.end());
  words.b.assign(b.begin(), b.end());
  words.out.resize(results.size() * CDE_PAIR_RESULT_WORDS);
  const std::uint64_t cycles = api.test(unit, words.a.data(), words.b.data(), words.out.data(),
                                        results.size(), gap, context);
  if (cycles == CDE_PAIR_STUCK) throw_stuck(api, unit, results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Word* w = &words.out[i * CDE_PAIR_RESULT_WORDS];
    PairResult& r = results[i];
    r.f = w[CDE_PAIR_F] != 0;
    r.bad = w[CDE_PAIR_BAD] != 0;
    r.t = w[CDE_PAIR_T];
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = w[CDE_PAIR_CP + k];
      r.n[k] = w[CDE_PAIR_N + k];
    }
  }
  return cycles;
}

}  // namespace

std::uint64_t PairUnit::test(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                             std::span<PairResult> results, const std::function<unsigned()>& gap) {
  (void)idle();
  const std::shared_ptr<State> kept = state_;
  const cde_pair_api& api = *kept->api;
  if (a.size() != results.size() * api.a_words || b.size() != results.size() * api.b_words)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("PairUnit::test: {} pairs need {} and {} operand words; there are {} and {}",
                    results.size(), results.size() * api.a_words, results.size() * api.b_words,
                    a.size(), b.size()));
  if (results.empty()) return 0;
  auto* context = const_cast<std::function<unsigned()>*>(&gap);
  uint32_t (*call)(void*) = nullptr;
  if (gap) call = [](void* f) { return uint32_t{(*static_cast<std::function<unsigned()>*>(f))()}; };
  kept->testing = true;
  try {
    const std::uint64_t cycles =
        api.word_bytes == 4 ? run(api, kept->unit, kept->narrow, a, b, results, call, context)
                            : run(api, kept->unit, kept->wide, a, b, results, call, context);
    kept->testing = false;
    return cycles;
  } catch (...) {
    api.reset(kept->unit);  // else rows in flight would count for the next test
    kept->testing = false;
    throw;
  }
}

std::vector<PairOperator> PairUnit::operators() const {
  const State& s = state();
  std::vector<PairOperator> all;
  const std::uint32_t count = s.api->operators(s.unit);
  all.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const cde_pair_operator& o = *s.api->operator_at(s.unit, i);
    all.push_back({o.path, static_cast<FpOp>(o.operation), o.latency});
  }
  return all;
}

std::uint64_t PairUnit::watch(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                              std::span<PairResult> results,
                              const std::function<void(const OperatorWords&)>& seen) {
  State& s = idle();
  if (!s.config.tap)
    throw Error(ErrorCode::kConfiguration, "the pair_unit was built without taps of its operators");
  // No exception may pass through the model: an exception from `seen` waits until the model
  // returns.
  struct Watch {
    const std::function<void(const OperatorWords&)>& seen;
    std::exception_ptr failed = nullptr;
  } watch{seen};
  s.api->watch(
      s.unit,
      [](void* context, std::uint32_t which, std::uint64_t cycle, std::uint64_t x, std::uint64_t y,
         std::uint64_t result) {
        auto& w = *static_cast<Watch*>(context);
        if (w.failed) return;
        try {
          w.seen({which, cycle, x, y, result});
        } catch (...) {
          w.failed = std::current_exception();
        }
      },
      &watch);
  const std::shared_ptr<void> end(nullptr, [&s](void*) { s.api->watch(s.unit, nullptr, nullptr); });
  const std::uint64_t cycles = test(a, b, results);
  if (watch.failed) std::rethrow_exception(watch.failed);
  return cycles;
}

void PairUnit::open_trace(const std::string& path, const TraceOptions& which) {
  if (!state().config.trace)
    throw Error(ErrorCode::kConfiguration, "the pair_unit was built without waves");
  constexpr std::uint64_t kClock = 2;  // each half of a cycle is a time of its own
  open_waves(path, which, std::nullopt, kClock, [this](const cde_trace* wanted) {
    return state().api->trace_open(state().unit, wanted);
  });
}
void PairUnit::close_trace() {
  require_whole_waves(state().api->trace_close(state().unit));
}

std::string place_in_unit(PairUnit& unit, std::span<const std::uint64_t> a,
                          std::span<const std::uint64_t> b, std::size_t i) {
  const PairConfig& config = unit.config();
  const std::size_t a_words = primary_words(config.pair), b_words = secondary_words(config.pair);
  const std::size_t row = i / config.lanes,
                    count = std::min(a.size() / a_words, (row + 1) * config.lanes);
  if (i >= count || b.size() < count * b_words)
    throw Error(ErrorCode::kUsage, fmt::format("there is no pair {}", i));
  std::vector<PairResult> again(count);
  const std::uint64_t cycle = unit.test(a.first(count * a_words), b.first(count * b_words), again);
  return fmt::format("cycle {}, lane {}, row {}", cycle, i % config.lanes, row);
}

}  // namespace cde
