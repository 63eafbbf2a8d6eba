// SPDX-License-Identifier: Apache-2.0
#include "cde/card/fp_unit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "card/abi_table.hpp"
#include "cde/abi/abi_fp.h"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

struct FpUnit::State {
  SimulationModel model;
  const cde_fp_api* api = nullptr;
  cde_fp_unit* unit = nullptr;

  explicit State(const SimulationModel& m) : model(m) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (unit != nullptr) api->destroy(unit);
  }
};

std::vector<std::string> fp_unit_parameters(FpFormat format, Arithmetic arithmetic, int lanes,
                                            bool flags) {
  check(arithmetic);
  return {fmt::format("EXP={}", format.exp_bits), fmt::format("MAN={}", format.man_bits),
          fmt::format("LANES={}", lanes),
          fmt::format("ARITH={}", arithmetic == Arithmetic::kRtl ? "rtl" : "host"),
          fmt::format("FLAGS={}", flags ? 1 : 0)};
}

FpUnit::FpUnit(const SimulationModel& model) : state_(std::make_unique<State>(model)) {
  State& s = *state_;
  s.api = abi_table<cde_fp_entry_fn>(s.model, "cde_fp_entry", CDE_FP_ABI);
  s.unit = s.api->create();
  if (s.unit == nullptr)
    throw Error(ErrorCode::kDevice, fmt::format("simulation model {}: out of memory",
                                                printable_name(model.path().string())));
}

FpUnit::FpUnit(FpFormat format, Arithmetic arithmetic, int lanes, bool flags)
    : FpUnit(
          SimulationModel::open("fp_unit", fp_unit_parameters(format, arithmetic, lanes, flags))) {}

FpUnit::~FpUnit() = default;
FpUnit::FpUnit(FpUnit&&) noexcept = default;
FpUnit& FpUnit::operator=(FpUnit&&) noexcept = default;

FpUnit::State& FpUnit::state() const {
  if (!state_) throw Error(ErrorCode::kUsage, "this FpUnit is empty: it was moved from");
  return *state_;
}

FpFormat FpUnit::format() const {
  return {static_cast<int>(state().api->exp_bits), static_cast<int>(state().api->man_bits)};
}

int FpUnit::lanes() const {
  return static_cast<int>(state().api->lanes);
}

int FpUnit::latency(FpOp op) const {
  const uint32_t cycles = state().api->latency(state().unit, static_cast<uint32_t>(op));
  if (cycles == 0)
    throw Error(ErrorCode::kConfiguration,
                fmt::format("the fp_unit has no operation {}", static_cast<uint32_t>(op)));
  return static_cast<int>(cycles);
}

void FpUnit::apply(FpOp op, std::span<const uint64_t> a, std::span<const uint64_t> b,
                   std::span<uint64_t> r, std::span<uint8_t> flags) {
  (void)latency(op);
  const bool sizes = (fp_operands(op) == 1 ? b.empty() : b.size() == a.size()) &&
                     r.size() == a.size() && (flags.empty() || flags.size() == a.size());
  if (!sizes)
    throw Error(ErrorCode::kUsage,
                "FpUnit::apply: operands, results and flags must have the same size");
  if (!flags.empty() && state().api->flags == 0)
    throw Error(ErrorCode::kConfiguration, "the fp_unit was built without flags");
  if (a.empty()) return;
  state().api->apply(state().unit, static_cast<uint32_t>(op), a.data(), b.data(), r.data(),
                     flags.empty() ? nullptr : flags.data(), a.size());
}

double FpUnit::measure(FpOp op, double seconds) {
  (void)latency(op);
  const auto number = static_cast<uint32_t>(op);
  uint64_t cycles = 1000;
  double spent = state().api->measure(state().unit, number, cycles);
  while (spent <
         seconds / 10) {  // until the speed is known well enough to plan the rest of the time
    cycles *= 4;
    spent = state().api->measure(state().unit, number, cycles);
  }
  if (spent < seconds) {
    cycles = static_cast<uint64_t>(std::ceil(static_cast<double>(cycles) * seconds / spent));
    spent = state().api->measure(state().unit, number, cycles);
  }
  return static_cast<double>(cycles) * lanes() / spent;
}

}  // namespace cde
