// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "cde/fp/fp_format.hpp"

namespace cde::testing {

inline constexpr uint64_t kSeed = 20231;  // seed of every random test here

/// Words at the edges of a format: zeros, subnormals, powers of two, neighbours of 1, largest
/// numbers, infinities, quiet and signalling NaNs; both signs.
std::vector<uint64_t> special_words(FpFormat f);

/// Operand pairs at rounding boundaries of add, mul and div. Sums are half an ulp away, or nearly
/// so. Products are at the edge of the subnormal range and of overflow. Quotients are next to ties.
std::vector<std::pair<uint64_t, uint64_t>> boundary_pairs(FpFormat f, std::mt19937_64& random);

/// A word from a mix of distributions: uniform bits, uniform near 1, subnormal, largest exponents,
/// few significant bits, special.
uint64_t random_word(FpFormat f, std::mt19937_64& random);

/// Two such words, often related: close exponents, nearly equal magnitudes (cancellation),
/// exponents whose sum is at an edge.
std::pair<uint64_t, uint64_t> random_pair(FpFormat f, std::mt19937_64& random);

/// A 64-bit integer of random length, or an edge of the 32-bit or 64-bit range.
uint64_t random_integer(std::mt19937_64& random);

}  // namespace cde::testing
