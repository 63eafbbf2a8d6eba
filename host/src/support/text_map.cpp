// SPDX-License-Identifier: Apache-2.0
#include "cde/support/text_map.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>

namespace cde {
namespace {

__extension__ using Product = unsigned __int128;
constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;

std::uint64_t random_point() {
  std::random_device random;
  return (std::uint64_t{random()} << 32 | random()) % kPrime;
}

}  // namespace

/// The text is a polynomial with coefficients of 7 bytes, whose value at a random point is the
/// hash. Two texts of n coefficients collide with probability n / 2^61.
std::size_t TextHash::operator()(std::string_view text) const noexcept {
  static const std::uint64_t point = random_point();
  std::uint64_t sum = text.size();
  while (!text.empty()) {
    const std::size_t bytes = std::min<std::size_t>(text.size(), 7);
    std::uint64_t coefficient = 0;
    std::memcpy(&coefficient, text.data(), bytes);
    text.remove_prefix(bytes);
    const Product next = Product{sum} * point + coefficient;
    sum = static_cast<std::uint64_t>(next & kPrime) + static_cast<std::uint64_t>(next >> 61);
    if (sum >= kPrime) sum -= kPrime;
  }
  return sum;
}

}  // namespace cde
