// SPDX-License-Identifier: Apache-2.0
#include "cde/fp/fp_format.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "cde/support/error.hpp"
#include "operands.hpp"

namespace cde::testing {
namespace {

TEST(FpFormat, Names_ParseAndPrint) {
  for (const NamedFpFormat& f : kFpFormats) {
    EXPECT_EQ(FpFormat::parse(f.name), f.format);
    EXPECT_EQ(f.format.name(), f.name);
  }
  EXPECT_EQ(FpFormat::parse("F32"), (FpFormat{8, 23}));
  EXPECT_EQ(FpFormat::parse("e6m9"), (FpFormat{6, 9}));
  EXPECT_EQ(FpFormat::parse("e6m9").name(), "e6m9");
  for (const char* bad :
       {"", "fp", "fp128", "e2m5", "e12m5", "e5m1", "e5m53", "e5m10x", "e-5m10", "m10e5"})
    EXPECT_THROW(FpFormat::parse(bad), Error) << bad;
}

TEST(FpFormat, ExactValues_SurviveDecodeAndEncode) {
  std::mt19937_64 random(kSeed);
  for (const NamedFpFormat& named : kFpFormats) {
    const FpFormat f = named.format;
    for (int i = 0; i < 65536; i++) {
      const uint64_t word = f.width() <= 16
                                ? static_cast<uint64_t>(i) & (f.sign_bit() | f.magnitude_mask())
                                : random_word(f, random);
      EXPECT_EQ(f.encode(f.decode(word)), f.is_nan(word) ? f.canonical_nan() : word)
          << named.name << " " << std::hex << word;
    }
  }
}

TEST(FpFormat, Fp32AndFp64_EqualTheHosts) {
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 100000; i++) {
    const uint64_t w = random();
    const auto single = std::bit_cast<float>(static_cast<uint32_t>(w));
    const auto twice = std::bit_cast<double>(w);
    if (!std::isnan(single)) {
      EXPECT_EQ((FpFormat{8, 23}).decode(static_cast<uint32_t>(w)), static_cast<double>(single));
    }
    if (std::isnan(twice)) continue;
    EXPECT_EQ((FpFormat{11, 52}).decode(w), twice);
    EXPECT_EQ((FpFormat{8, 23}).encode(twice), std::bit_cast<uint32_t>(static_cast<float>(twice)));
  }
}

TEST(FpFormat, KnownValues_HaveTheirWords) {
  EXPECT_EQ((FpFormat{5, 10}).encode(65504.0), 0x7bffu);
  EXPECT_EQ((FpFormat{5, 10}).encode(65520.0), 0x7c00u);
  EXPECT_EQ((FpFormat{5, 10}).encode(-std::ldexp(1.0, -24)), 0x8001u);
  EXPECT_EQ((FpFormat{8, 7}).encode(1.0), 0x3f80u);
  EXPECT_EQ((FpFormat{4, 3}).encode(240.0), 0x77u);
  EXPECT_EQ((FpFormat{3, 2}).decode(0x01), 0.0625);
}

}  // namespace
}  // namespace cde::testing
