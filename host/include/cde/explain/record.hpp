// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/explain/recorded.hpp"

namespace cde::explain {

/// What the mirror reference of a pair did with one pair of operands.
struct PairRecording {
  std::vector<Step> steps;
  /// The operators among the steps, without those of the check of the input contract. References
  /// are straight-line code where no budget says how often something is done: there the k-th one is
  /// the same operation of any pair.
  std::vector<std::int32_t> operators;
  PairResult result;
  std::array<std::int32_t, 7> outputs{};  ///< steps that T, CP and n are of; -1: none
};

/// Runs the reference of the unit's configuration on operands in slot order. Error kUsage for a
/// format that pairs have no reference in.
[[nodiscard]] PairRecording record(const PairConfig& config, std::span<const std::uint64_t> a,
                                   std::span<const std::uint64_t> b, const PairBudget& budget);

}  // namespace cde::explain
