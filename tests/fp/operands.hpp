// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "cde/fp/fp_format.hpp"

namespace cde::testing {

inline constexpr uint64_t kSeed = 20231;  // of every random test here

/// Words where formats are at their edge: zeros, subnormals, powers of two, neighbours of 1,
/// largest numbers, infinities, quiet and signalling NaNs; both signs.
std::vector<uint64_t> special_words(FpFormat f);

/// Operand pairs at rounding boundaries of add, mul, div: sums one half or nearly one half of the
/// last place away, products at the edge of the subnormal range and of overflow, quotients next to
/// ties.
std::vector<std::pair<uint64_t, uint64_t>> boundary_pairs(FpFormat f, std::mt19937_64& random);

/// A word from a mix of distributions: uniform bits, uniform near 1, subnormal, largest exponents,
/// few significant bits, special.
uint64_t random_word(FpFormat f, std::mt19937_64& random);

/// Two of them, often related: close exponents, nearly equal magnitudes (cancellation), exponents
/// that sum to an edge.
std::pair<uint64_t, uint64_t> random_pair(FpFormat f, std::mt19937_64& random);

/// An integer of 64 bits of random length, or an edge of 32 or 64 bits.
uint64_t random_integer(std::mt19937_64& random);

}  // namespace cde::testing
