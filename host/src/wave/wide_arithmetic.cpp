// SPDX-License-Identifier: Apache-2.0
#include "wave/wide_arithmetic.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace cde::wave {
namespace {

using Limbs = std::vector<std::uint32_t>;  // the lowest first

Limbs limbs_of(const std::string& bits) {
  Limbs all((bits.size() + 31) / 32, 0);
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (bits[bits.size() - 1 - i] == '1') all[i / 32] |= 1u << i % 32;
  return all;
}
std::string bits_of(const Limbs& limbs, std::size_t width) {
  std::string bits(width, '0');
  for (std::size_t i = 0; i < width; ++i)
    if ((limbs[i / 32] >> i % 32 & 1) != 0) bits[width - 1 - i] = '1';
  return bits;
}

/// a + b + carry; with `inverted`, a + ~b + carry.
Limbs sum(const Limbs& a, const Limbs& b, bool inverted, std::uint64_t carry) {
  Limbs r(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    carry += std::uint64_t{a[i]} + (inverted ? ~b[i] : b[i]);
    r[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32;
  }
  return r;
}

Limbs product(const Limbs& a, const Limbs& b) {
  Limbs r(a.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; i + j < a.size(); ++j) {
      carry += std::uint64_t{a[i]} * b[j] + r[i + j];
      r[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  }
  return r;
}

bool less(const Limbs& a, const Limbs& b) {
  return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
}

/// Quotient and remainder, by bitwise long division.
std::pair<Limbs, Limbs> divided(const std::string& a, const Limbs& b) {
  // The remainder has one bit more than the divisor before it is reduced.
  Limbs divisor = b, quotient(b.size(), 0);
  divisor.push_back(0);
  Limbs rest(divisor.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::uint32_t carry = a[i] == '1' ? 1 : 0;
    for (std::uint32_t& limb : rest) {
      const std::uint32_t next = limb >> 31;
      limb = limb << 1 | carry;
      carry = next;
    }
    if (less(rest, divisor)) continue;
    rest = sum(rest, divisor, true, 1);
    const std::size_t bit = a.size() - 1 - i;
    quotient[bit / 32] |= 1u << bit % 32;
  }
  rest.pop_back();
  return {quotient, rest};
}

std::string negated(const std::string& bits) {
  const Limbs zero((bits.size() + 31) / 32, 0);
  return bits_of(sum(zero, limbs_of(bits), true, 1), bits.size());
}

}  // namespace

std::string wide_arithmetic(char op, const std::string& a, const std::string& b, bool is_signed) {
  if (op == '+' || op == '-')
    return bits_of(sum(limbs_of(a), limbs_of(b), op == '-', op == '-' ? 1 : 0), a.size());
  if (op == '*') return bits_of(product(limbs_of(a), limbs_of(b)), a.size());
  if (b.find('1') == std::string::npos) return {};
  const bool minus_a = is_signed && a[0] == '1', minus_b = is_signed && b[0] == '1';
  const auto [quotient, rest] =
      divided(minus_a ? negated(a) : a, limbs_of(minus_b ? negated(b) : b));
  const std::string r = bits_of(op == '/' ? quotient : rest, a.size());
  const bool minus = op == '/' ? minus_a != minus_b : minus_a;
  return minus ? negated(r) : r;
}

}  // namespace cde::wave
