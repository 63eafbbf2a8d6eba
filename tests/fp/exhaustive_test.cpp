// SPDX-License-Identifier: Apache-2.0
// Every operand of the tiny formats, every fp16 square root and conversion, all pairs of special
// values, and rounding boundaries.
#include "operands.hpp"
#include "unit_check.hpp"

namespace cde::testing {
namespace {

class Unit : public ::testing::TestWithParam<TestUnit> {};
class TinyFormat : public Unit {};
class SixteenBitFormat : public Unit {};
class Narrowing : public Unit {};

constexpr FpOp op_at(uint32_t i) {
  return static_cast<FpOp>(i);
}
bool from_integer(FpOp op) {
  return op >= FpOp::kFromI32 && op <= FpOp::kFromUi64;
}

TEST_P(TinyFormat, EveryOperand_EqualsTheReference) {
  const FpFormat f = GetParam().format;
  UnitCheck check(GetParam());
  const uint64_t words = uint64_t{1} << f.width();
  for (uint32_t i = 0; i < kFpOps; i++) {
    const FpOp op = op_at(i);
    if (!check.has(op) || from_integer(op)) continue;
    for (uint64_t a = 0; a < words; a++)
      for (uint64_t b = 0; b < (fp_operands(op) == 2 ? words : 1); b++) check.add(op, a, b);
  }
  for (uint32_t i = static_cast<uint32_t>(FpOp::kFromI32);
       i <= static_cast<uint32_t>(FpOp::kFromUi64); i++)
    for (int64_t n = -70000; check.has(op_at(i)) && n <= 70000; n++)
      check.add(op_at(i), static_cast<uint64_t>(n));
  check.finish();
}

TEST_P(SixteenBitFormat, EveryUnaryOperand_EqualsTheReference) {
  UnitCheck check(GetParam());
  for (uint32_t i = 0; i < kFpOps; i++) {
    const FpOp op = op_at(i);
    if (!check.has(op) || fp_operands(op) == 2 || from_integer(op)) continue;
    for (uint64_t a = 0; a < 65536; a++) check.add(op, a);
  }
  check.finish();
}

/// Every fp16 and bf16 number, every midpoint of two neighbours, and the words next to both,
/// narrowed from a wider format.
TEST_P(Narrowing, EveryRoundingBoundary_EqualsTheReference) {
  const FpFormat f = GetParam().format;
  UnitCheck check(GetParam());
  for (const std::size_t target : {0, 1, 6, 7}) {
    const FpFormat to = kFpFormats.at(target).format;
    for (uint64_t word = 0; word < to.infinity(); word++) {
      const double here = to.decode(word), next = word + 1 == to.infinity()
                                                      ? 2 * here - to.decode(word - 1)
                                                      : to.decode(word + 1);
      for (const uint64_t at : {f.encode(here), f.encode((here + next) / 2)})
        for (const uint64_t step : {~uint64_t{0}, uint64_t{0}, uint64_t{1}})
          check.add(op_at(static_cast<uint32_t>(FpOp::kToFp16) + static_cast<uint32_t>(target)),
                    ((at + step) & f.magnitude_mask()) | ((word & 1) != 0 ? f.sign_bit() : 0));
    }
  }
  check.finish();
}

TEST_P(Unit, AllSpecialValuePairs_EqualTheReference) {
  UnitCheck check(GetParam());
  const auto words = special_words(GetParam().format);
  for (uint32_t i = 0; i < kFpOps; i++) {
    const FpOp op = op_at(i);
    if (!check.has(op) || from_integer(op)) continue;
    for (const uint64_t a : words) {
      if (fp_operands(op) == 1)
        check.add(op, a);
      else
        for (const uint64_t b : words) check.add(op, a, b);
    }
  }
  check.finish();
  EXPECT_EQ(check.other_nans() > 0, GetParam().any_nan()) << "the back end must follow CANON";
}

TEST_P(Unit, RoundingBoundaries_EqualTheReference) {
  UnitCheck check(GetParam());
  std::mt19937_64 random(kSeed);
  for (const auto& [a, b] : boundary_pairs(GetParam().format, random))
    for (const FpOp op : {FpOp::kAdd, FpOp::kSub, FpOp::kMul, FpOp::kDiv, FpOp::kMin, FpOp::kLt})
      if (check.has(op)) check.add(op, a, b);
  check.finish();
}

INSTANTIATE_TEST_SUITE_P(Models, Unit, ::testing::ValuesIn(test_units()), unit_name);
INSTANTIATE_TEST_SUITE_P(Models, TinyFormat, ::testing::ValuesIn(units_where([](const TestUnit& u) {
                           return u.format.width() <= 8;
                         })),
                         unit_name);
INSTANTIATE_TEST_SUITE_P(Models, SixteenBitFormat,
                         ::testing::ValuesIn(units_where([](const TestUnit& u) {
                           return u.format.width() == 16;
                         })),
                         unit_name);
/// fp32 and fp64, in gates without register cuts.
INSTANTIATE_TEST_SUITE_P(Models, Narrowing, ::testing::ValuesIn(units_where([](const TestUnit& u) {
                           return u.format.width() >= 32 && !u.gives("OPS=") &&
                                  (u.arith == "host" || u.parameters.empty());
                         })),
                         unit_name);

}  // namespace
}  // namespace cde::testing
