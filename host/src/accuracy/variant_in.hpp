// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/accuracy/variant.hpp"

namespace cde::accuracy {

/// The variants in the scalar S. Each build of variant_in.cpp compiles a few scalars.
template <class S>
struct VariantIn {
  static void textbook(Pair pair, std::span<const std::uint64_t> a,
                       std::span<const std::uint64_t> b, std::span<PairResult> r);
  static void fused(Pair pair, Algorithm algorithm, bool box, const PairIterations& iterations,
                    std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                    std::span<PairResult> r);
};

}  // namespace cde::accuracy
