// SPDX-License-Identifier: Apache-2.0
// cde query in every format: how it reads and writes numbers.
#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "query.hpp"

namespace cde::testing {
namespace {

struct Format {
  const char* name;
  int exponent_bits, fraction_bits;
};
void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

class QueryFormat : public Query, public ::testing::WithParamInterface<Format> {};

/// The exact value of a word, computed from its bits alone.
long double value_of(const Format& f, std::uint64_t word) {
  const std::uint64_t fraction = word & ((std::uint64_t{1} << f.fraction_bits) - 1);
  const auto exponent = static_cast<int>((word >> f.fraction_bits) & ((1u << f.exponent_bits) - 1));
  const int bias = (1 << (f.exponent_bits - 1)) - 1;
  const long double significand =
      static_cast<long double>(fraction) + (exponent == 0 ? 0 : std::ldexp(1.0L, f.fraction_bits));
  return std::ldexp(significand, std::max(exponent, 1) - bias - f.fraction_bits);
}

/// The number with all its decimal digits.
std::string exact_decimal(long double value) {
  std::string text(2000, ' ');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.1200Lf", value)));
  return text;
}

/// Decimals halfway between two words, and 1e-1200 above and below. Concentric spheres of one
/// radius have CP at their centre, so CP shows the word. Values go up to the largest coordinate of
/// the contract. In formats that scale their pairs, only values that stay normal are used.
TEST_P(QueryFormat, Decimals_RoundOnceToNearestEven) {
  const Format f = GetParam();
  std::mt19937_64 random(7);
  std::string input;
  std::vector<std::uint64_t> wanted;
  const auto add = [&](const std::string& x, std::uint64_t word) {
    input += x + ",0,0,1," + x + ",0,0,1\n";
    wanted.push_back(word);
  };
  const int bias = (1 << (f.exponent_bits - 1)) - 1;
  const bool scales = f.exponent_bits < 8;
  const int high = scales ? (bias - 1) / 2 : (bias - 7) / 3;
  const auto word_of = [&](int exponent) {
    return static_cast<std::uint64_t>(bias + exponent) << f.fraction_bits;
  };
  const std::uint64_t least_normal = std::uint64_t{1} << f.fraction_bits;
  const std::uint64_t least = scales ? word_of(-high) : 0;
  for (int i = 0; i < 200; ++i) {
    const std::uint64_t word = i % 4 == 0 && !scales ? random() % least_normal
                                                     : least + random() % (word_of(high) - least);
    const long double low = value_of(f, word), middle = (low + value_of(f, word + 1)) / 2;
    std::string above = exact_decimal(middle), below = above;
    above.back() = '1';
    // One less in the last place: borrow through the zeros after the last digit.
    std::size_t at = below.size() - 1;
    while (below[at] == '0' || below[at] == '.') {
      if (below[at] == '0') below[at] = '9';
      --at;
    }
    --below[at];
    add(exact_decimal(middle), word + (word & 1));
    add(above, word + 1);
    add(below, word);
    add(exact_decimal(low), word);
  }
  const Ran ran = query({"sphere-sphere", "--format", f.name, "--bits", "-q"}, input);
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto lines = lines_of(ran.out);
  ASSERT_EQ(lines.size(), wanted.size() + 1);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_EQ(std::stoull(fields_of(lines[i + 1])[2], nullptr, 16), wanted[i])
        << lines_of(input)[i] << "\n"
        << lines[i + 1];
}

/// Printed numbers read back as the same word: as decimals, as bits and with --no-check.
TEST_P(QueryFormat, Decimals_ReadBackAsTheSameWord) {
  const Format f = GetParam();
  std::mt19937_64 random(11);
  std::string input;
  for (int i = 0; i < 500; ++i) {
    for (int k = 0; k < 8; ++k) {
      const double x = static_cast<double>(random() >> 11) * 0x1p-53;
      input += fmt::format("{}{}", k == 0 ? "" : ",", k % 4 == 3 ? x + 0.1 : 4 * x - 2);
    }
    input += '\n';
  }
  const Words words = {"sphere-sphere", "--format", f.name, "-q"};
  Words with_bits = words, unchecked = words;
  with_bits.emplace_back("--bits");
  unchecked.emplace_back("--no-check");
  const Ran decimals = query(words, input), bits = query(with_bits, input);
  ASSERT_EQ(decimals.status, 0) << decimals.err;
  ASSERT_EQ(bits.status, 0) << bits.err;
  EXPECT_EQ(query(unchecked, input).out, decimals.out);
  // Concentric spheres return their centre as CP (the offset along z is 0).
  const auto concentric = [](const std::string& csv) {
    std::string text;
    const auto lines = lines_of(csv);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const auto field = fields_of(lines[i]);
      for (const std::size_t k : {1u, 2u, 3u, 4u, 5u, 6u, 7u})
        text += fmt::format("{0},0,0,1,{0},0,0,1\n", field[k]);
    }
    return text;
  };
  EXPECT_EQ(query(with_bits, concentric(decimals.out)).out,
            query(with_bits, concentric(bits.out)).out);
  const auto digits = static_cast<std::size_t>((1 + f.exponent_bits + f.fraction_bits + 3) / 4);
  EXPECT_EQ(fields_of(lines_of(bits.out)[1])[1].size(), 2 + digits);
}

TEST_P(QueryFormat, NumbersAtAndBeyondTheLargest_AreClassified) {
  const Format f = GetParam();
  const std::uint64_t infinity = ((std::uint64_t{1} << f.exponent_bits) - 1) << f.fraction_bits;
  const std::uint64_t nan = infinity | (std::uint64_t{1} << (f.fraction_bits - 1));
  const std::string largest =
      f.fraction_bits == 52 ? "1.7976931348623157e308" : exact_decimal(value_of(f, infinity - 1));
  const Ran ran = query({"sphere-sphere", "--format", f.name, "--bits", "-q", "--no-check"},
                        fmt::format("0,0,0,1,{},0,0,1\n0,0,0,1,0,0,0,{:#x}\n0,0,0,1,9{},0,0,1\n",
                                    largest, infinity, largest));
  EXPECT_EQ(ran.status, 2);
  const auto lines = lines_of(ran.out);
  ASSERT_EQ(lines.size(), 4u) << ran.err;
  EXPECT_EQ(fields_of(lines[1])[8], "bad") << "a number of the format that is not a valid length";
  EXPECT_TRUE(has(ran.err, "line 1: sphere B: center.x is"));
  EXPECT_EQ(fields_of(lines[2])[8], "bad");
  EXPECT_EQ(std::stoull(fields_of(lines[2])[1], nullptr, 16), nan);
  EXPECT_EQ(fields_of(lines[3])[8], "malformed");
  EXPECT_TRUE(has(ran.err, "line 2: sphere B: radius is inf, must be finite"));
  EXPECT_TRUE(has(ran.err, fmt::format("is beyond the largest {} number", f.name)));
}

INSTANTIATE_TEST_SUITE_P(Formats, QueryFormat,
                         ::testing::Values(Format{"fp16", 5, 10}, Format{"bf16", 8, 7},
                                           Format{"fp24", 7, 16}, Format{"fp32", 8, 23},
                                           Format{"fp64", 11, 52}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace cde::testing
