// SPDX-License-Identifier: Apache-2.0
#include "operands.hpp"

#include <algorithm>

namespace cde::testing {

std::vector<uint64_t> special_words(FpFormat f) {
  const uint64_t inf = f.infinity(), one = static_cast<uint64_t>(f.bias()) << f.man_bits,
                 unit = uint64_t{1} << f.man_bits;
  std::vector<uint64_t> words{0,
                              1,
                              2,
                              3,
                              f.fraction_mask(),
                              f.fraction_mask() - 1,
                              unit / 2,  // subnormals
                              unit,
                              unit + 1,
                              2 * unit - 1,
                              2 * unit,
                              one - 1,
                              one,
                              one + 1,
                              one + unit / 2,
                              one - unit,
                              one + unit,
                              inf - 1,
                              inf - 2,
                              inf - unit,
                              inf,
                              inf + 1,
                              inf | f.quiet_bit(),
                              f.magnitude_mask(),
                              (inf | f.quiet_bit()) + 1,
                              inf + unit / 2 - 1};
  for (const int power : {f.man_bits, f.man_bits + 1, f.man_bits + 2, 31, 32, 63, 64})
    for (const int sign : {-1, 1})
      if (const int e = f.bias() + sign * power; e > 0 && e < (1 << f.exp_bits) - 1)
        for (const int64_t step : {-1, 0, 1})
          words.push_back((static_cast<uint64_t>(e) << f.man_bits) + static_cast<uint64_t>(step));
  for (uint64_t& w : words) w &= f.magnitude_mask();
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  const std::size_t positive = words.size();
  for (std::size_t i = 0; i < positive; i++) words.push_back(words[i] | f.sign_bit());
  return words;
}

std::vector<std::pair<uint64_t, uint64_t>> boundary_pairs(FpFormat f, std::mt19937_64& random) {
  std::vector<std::pair<uint64_t, uint64_t>> pairs;
  const int largest = (1 << f.exp_bits) - 2;
  const auto word = [&](int e, uint64_t fraction) {
    return (static_cast<uint64_t>(std::clamp(e, 0, largest)) << f.man_bits) |
           (fraction & f.fraction_mask());
  };
  const auto add = [&](uint64_t a, uint64_t b) {
    pairs.emplace_back(a, b);
    pairs.emplace_back(a, b | f.sign_bit());
    pairs.emplace_back(b | f.sign_bit(), a);
  };
  for (int i = 0; i < 400; i++) {
    const uint64_t x = random(), y = random();
    const int e = static_cast<int>(random() % static_cast<uint64_t>(largest + 1));
    for (int below = 0; below <= 3;
         below++) {  // y is about half an ulp of x, or slightly more or less
      const int half = e - f.man_bits - 1 + below;
      if (half > 0)
        for (const uint64_t hair : {uint64_t{0}, uint64_t{1}, f.fraction_mask()})
          add(word(e, x), word(half, hair));
    }
    for (int edge = -f.man_bits - 3; edge <= 3;
         edge++)  // products and quotients near the smallest normal and subnormal numbers
      add(word(e, x), word(edge + f.bias() + 1 - e, y)),
          add(word(e, x), word(e + f.bias() - 1 - edge, y));
    for (int edge = -2; edge <= 2; edge++)  // and near overflow
      add(word(e, x), word(largest + f.bias() + edge - e, y)),
          add(word(e, x), word(e - f.bias() - 1 + edge, y));
    add(word(largest, f.fraction_mask()),
        word(largest - f.man_bits - 1 + static_cast<int>(x % 3) - 1, y & 1));
  }
  return pairs;
}

uint64_t random_word(FpFormat f, std::mt19937_64& random) {
  const uint64_t bits = random(), choice = random() % 8;
  const uint64_t sign = bits & f.sign_bit(), fraction = bits & f.fraction_mask();
  const auto exponent = [&](uint64_t e) { return sign | (e << f.man_bits) | fraction; };
  switch (choice) {
    case 0:
      return sign | fraction;
    case 1:
      return exponent((uint64_t{1} << f.exp_bits) - 2 - random() % 3);
    case 2:
      return exponent(1 + random() % 3);
    case 3:
      return exponent(static_cast<uint64_t>(f.bias()) - 2 + random() % 5);
    case 4: {  // few significant bits: exact results and ties
      const uint64_t few = fraction & ~(f.fraction_mask() >> (random() % 4));
      return (bits & f.infinity()) | sign | few;
    }
    case 5:
      if (random() % 4 == 0) return sign | f.infinity() | (random() % 2 == 0 ? 0 : fraction);
      return bits & (f.sign_bit() | f.magnitude_mask());
    default:
      return bits & (f.sign_bit() | f.magnitude_mask());
  }
}

std::pair<uint64_t, uint64_t> random_pair(FpFormat f, std::mt19937_64& random) {
  const uint64_t a = random_word(f, random);
  uint64_t b = random_word(f, random);
  const auto e = static_cast<int64_t>((a & f.infinity()) >> f.man_bits);
  const int64_t largest = (int64_t{1} << f.exp_bits) - 2;
  const auto with_exponent = [&](int64_t to) {
    return (b & ~f.infinity()) |
           (static_cast<uint64_t>(std::clamp<int64_t>(to, 0, largest)) << f.man_bits);
  };
  switch (random() % 6) {
    case 0:
      b = with_exponent(e + static_cast<int64_t>(random() % 5) - 2);
      break;
    case 1:
      b = (a ^ f.sign_bit()) ^ (random() & ((uint64_t{1} << (random() % 5)) - 1));
      break;
    case 2:
      b = with_exponent(e - static_cast<int64_t>(random() % static_cast<uint64_t>(f.man_bits + 4)));
      break;
    case 3:
      b = with_exponent(f.bias() - e + 2 -
                        static_cast<int64_t>(random() % static_cast<uint64_t>(f.man_bits + 4)));
      break;
    default:
      break;
  }
  return {a, b & (f.sign_bit() | f.magnitude_mask())};
}

uint64_t random_integer(std::mt19937_64& random) {
  constexpr uint64_t kEdges[]{
      0,           1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fffffffffffffff, 0x8000000000000000,
      ~uint64_t{0}};
  if (random() % 16 == 0) return kEdges[random() % 8] + random() % 3 - 1;
  uint64_t v = random() >> (random() % 64);
  if (random() % 3 == 0) v &= ~uint64_t{0} << (random() % 64);
  return random() % 2 == 0 ? v : uint64_t{0} - v;
}

}  // namespace cde::testing
