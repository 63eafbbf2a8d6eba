// SPDX-License-Identifier: Apache-2.0
// The adder and multiplier in the ordinary style (tools/costs/ordinary/), whose area is compared
// with rtl/fp, compute the same values as fp_add and fp_mul. Tests every pair of operands of small
// formats, and hard and random operands of the others.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "../modules/clocked.hpp"
#include "OrdinaryBf16.h"
#include "OrdinaryE3m2.h"
#include "OrdinaryE4m3.h"
#include "OrdinaryFp16.h"
#include "OrdinaryFp24.h"
#include "OrdinaryFp32.h"

namespace {

struct Format {
  unsigned exp;
  unsigned man;
  [[nodiscard]] unsigned width() const { return 1 + exp + man; }
};

template <class Module>
void compare(cde::testing::Clocked<Module>& units, std::uint32_t a, std::uint32_t b) {
  units->a_i = a;
  units->b_i = b;
  units.clock();
  ASSERT_EQ(units->ordinary_add_o, units->add_o) << std::hex << a << " + " << b;
  ASSERT_EQ(units->ordinary_mul_o, units->mul_o) << std::hex << a << " * " << b;
}

template <class Module>
void compare_all(Format format) {
  cde::testing::Clocked<Module> units;
  for (std::uint32_t a = 0; a < 1U << format.width(); ++a)
    for (std::uint32_t b = 0; b < 1U << format.width(); ++b)
      ASSERT_NO_FATAL_FAILURE(compare(units, a, b));
}

/// Magnitudes at the edges of every range, with both signs.
std::vector<std::uint32_t> hard_operands(Format format) {
  const std::uint32_t fraction = (1U << format.man) - 1;
  const std::uint32_t sign = 1U << (format.width() - 1);
  const std::uint32_t most = (1U << format.exp) - 1;
  std::vector<std::uint32_t> operands;
  for (const std::uint32_t e :
       {0U, 1U, 2U, most / 2 - 1, most / 2, most / 2 + 1, most - 2, most - 1, most})
    for (const std::uint32_t f :
         {0U, 1U, 2U, fraction / 2, fraction / 2 + 1, fraction / 2 + 2, fraction - 1, fraction})
      for (const std::uint32_t s : {0U, sign}) operands.push_back(s | e << format.man | f);
  return operands;
}

template <class Module>
void compare_many(Format format) {
  cde::testing::Clocked<Module> units;
  const std::vector<std::uint32_t> hard = hard_operands(format);
  for (const std::uint32_t a : hard)
    for (const std::uint32_t b : hard) ASSERT_NO_FATAL_FAILURE(compare(units, a, b));
  std::mt19937 dice(20240611);
  const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << format.width()) - 1);
  const std::uint32_t exponents = ((1U << format.exp) - 1) << format.man;
  for (int i = 0; i < 2'000'000; ++i) {
    const std::uint32_t a = dice() & mask;
    std::uint32_t b = dice() & mask;
    switch (i % 4) {
      case 1:  // nearly the same exponent
        b = (b & ~exponents) | (((a & exponents) + ((dice() % 4) << format.man)) & exponents);
        break;
      case 2:  // a product near the smallest normal number
        b = (b & ~exponents) | (((1U << (format.exp - 1 + format.man)) - (a & exponents) -
                                 ((dice() % format.width()) << format.man)) &
                                exponents);
        break;
      case 3:  // a hard operand with any operand
        b = hard[dice() % hard.size()];
        break;
      default:
        break;
    }
    ASSERT_NO_FATAL_FAILURE(compare(units, a, b));
  }
}

TEST(Ordinary, EveryPairOfE4m3_EqualsOurs) {
  compare_all<OrdinaryE4m3>({4, 3});
}
TEST(Ordinary, EveryPairOfE3m2_EqualsOurs) {
  compare_all<OrdinaryE3m2>({3, 2});
}
TEST(Ordinary, HardPairsOfFp16_EqualOurs) {
  compare_many<OrdinaryFp16>({5, 10});
}
TEST(Ordinary, HardPairsOfBf16_EqualOurs) {
  compare_many<OrdinaryBf16>({8, 7});
}
TEST(Ordinary, HardPairsOfFp24_EqualOurs) {
  compare_many<OrdinaryFp24>({7, 16});
}
TEST(Ordinary, HardPairsOfFp32_EqualOurs) {
  compare_many<OrdinaryFp32>({8, 23});
}

}  // namespace
