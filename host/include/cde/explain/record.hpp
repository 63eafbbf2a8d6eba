// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/explain/recorded.hpp"

namespace cde::explain {

/// Steps of the mirror reference for one pair of operands.
struct PairRecording {
  std::vector<Step> steps;
  /// Operators among the steps, without the operators of the input contract's check. References are
  /// straight-line code, except where a number of iterations repeats something. Without iterations
  /// the k-th operator is the same operation for any pair.
  std::vector<std::int32_t> operators;
  PairResult result;
  std::array<std::int32_t, 7> outputs{};  ///< steps that produced T, CP and n; -1: none
};

/// Runs the reference of the unit's configuration on operands in slot order. Error kUsage for a
/// format without reference.
[[nodiscard]] PairRecording record(const PairConfig& config, std::span<const std::uint64_t> a,
                                   std::span<const std::uint64_t> b,
                                   const PairIterations& iterations);

}  // namespace cde::explain
