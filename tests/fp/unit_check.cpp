// SPDX-License-Identifier: Apache-2.0
#include "unit_check.hpp"

#include <fmt/format.h>

#include <array>

#include "cde/support/error.hpp"

namespace cde::testing {

const std::vector<TestUnit>& test_units() {
  static const std::vector<TestUnit> units{
#include "fp_models.inc"
  };
  return units;
}

FpUnit load(const TestUnit& unit) {
  return FpUnit(SimulationModel::load(unit.path, 0));
}

const char* op_name(FpOp op) {
  return kFpOpNames.at(static_cast<std::size_t>(op));
}

UnitCheck::~UnitCheck() {
  fmt::print("{}: {} results and flags compared, {} differ", test_.label, compared_, mismatches_);
  if (test_.any_nan()) fmt::print(", {} NaNs are not the canonical one", other_nans_);
  fmt::print("\n");
}

bool UnitCheck::has(FpOp op) const {
  try {
    return unit_.latency(op) > 0;
  } catch (const Error&) {
    return false;
  }
}

void UnitCheck::add(FpOp op, uint64_t a, uint64_t b) {
  auto& queue = a_.at(static_cast<std::size_t>(op));
  queue.push_back(a);
  if (fp_operands(op) == 2) b_.at(static_cast<std::size_t>(op)).push_back(b);
  if (queue.size() == 1 << 14) run(op);
}

void UnitCheck::finish() {
  for (uint32_t op = 0; op < kFpOps; op++) run(static_cast<FpOp>(op));
  EXPECT_GT(compared_, 0U);
  EXPECT_EQ(mismatches_, 0U);
}

void UnitCheck::run(FpOp op) {
  auto& a = a_.at(static_cast<std::size_t>(op));
  auto& b = b_.at(static_cast<std::size_t>(op));
  if (a.empty()) return;
  std::vector<uint64_t> r(a.size());
  std::vector<uint8_t> flags(a.size());
  unit_.apply(op, a, b, r, flags);
  for (std::size_t i = 0; i < a.size(); i++) {
    const uint64_t second = b.empty() ? 0 : b[i];
    const FpResult got{r[i], flags[i]}, want = fp_reference(op, test_.format, a[i], second);
    compared_++;
    if (got == want) continue;
    if (test_.any_nan() && op <= FpOp::kSqrt && got.flags == want.flags &&
        test_.format.is_nan(got.word) && test_.format.is_nan(want.word)) {
      other_nans_++;
      continue;
    }
    if (mismatches_++ < 10)
      ADD_FAILURE() << fmt::format(
          "{} {}: got {:X} flags {:02X}, reference {:X} flags {:02X}; repeat: echo {:X} {:X} | cde "
          "fp {} -f {} -a {}",
          test_.label, op_name(op), got.word, got.flags, want.word, want.flags, a[i], second,
          op_name(op), test_.format.name(), test_.arith);
  }
  a.clear();
  b.clear();
}

}  // namespace cde::testing
