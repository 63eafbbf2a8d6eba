// SPDX-License-Identifier: Apache-2.0
// Random operands on every simulation model: results and flags of both back ends equal the
// reference.
#include "operands.hpp"
#include "unit_check.hpp"

namespace cde::testing {
namespace {

class RandomOperands : public ::testing::TestWithParam<TestUnit> {};

TEST_P(RandomOperands, RandomOperands_EqualTheReference) {
  const TestUnit& unit = GetParam();
  UnitCheck check(unit);
  std::mt19937_64 random(kSeed);
  const bool plain = unit.parameters.empty();
  const int arithmetic = plain ? 100000 : 20000, conversions = plain ? 20000 : 5000;
  for (uint32_t i = 0; i < kFpOps; i++) {
    const auto op = static_cast<FpOp>(i);
    if (!check.has(op)) continue;
    for (int n = 0; n < (op <= FpOp::kSqrt ? arithmetic : conversions); n++) {
      if (op >= FpOp::kFromI32 && op <= FpOp::kFromUi64) {
        check.add(op, random_integer(random));
      } else {
        const auto [a, b] = random_pair(unit.format, random);
        check.add(op, a, b);
      }
    }
  }
  check.finish();
}

INSTANTIATE_TEST_SUITE_P(Models, RandomOperands, ::testing::ValuesIn(test_units()), unit_name);

}  // namespace
}  // namespace cde::testing
