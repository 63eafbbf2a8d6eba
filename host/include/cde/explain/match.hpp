// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/explain/record.hpp"

/// @file
/// Matches the card's operators with the operators of the mirror reference. Other pairs, run in the
/// failing model, show which operator computes the k-th operation of the reference. It has the same
/// operands a fixed number of cycles after each pair has entered.
namespace cde::explain {

/// Values at an operator, one word per cycle. Every NaN is the canonical one; a mask is 0 or 1.
struct Track {
  std::vector<std::uint64_t> a, b, result;
};

/// The operators of a unit while rows of one pair each went through it. Row r enters at cycle r *
/// interval.
struct Observed {
  FpFormat format{8, 23};
  std::vector<PairOperator> operators;
  std::vector<Track> tracks;        ///< of the operators
  std::vector<PairResult> results;  ///< of the rows
  unsigned interval = 1;
};

/// Runs pairs through a unit with taps. At most as many rows as an iterative pipeline has slots.
[[nodiscard]] Observed observe(PairUnit& unit, std::span<const std::uint64_t> a,
                               std::span<const std::uint64_t> b);

/// An operation as the card computed it.
struct Operation {
  FpOp operation = FpOp::kAdd;
  std::uint64_t a = 0, b = 0, result = 0;
};

/// Where the card computes an operation of the reference.
struct Seat {
  std::int32_t which = -1;  ///< operator of the card; -1: not found
  unsigned offset = 0;      ///< cycles from the pair's entry to its operands
  unsigned operands = 0;    ///< pairs for which it had the operands, none of them zero, or agreed
  unsigned agree = 0;       ///< pairs for which its result also agreed
};

/// A seat for each operation of the reference. `rows` selects the pairs to learn from, by their
/// rows in the observation. All recordings must have the same number of operators.
[[nodiscard]] std::vector<Seat> learn(const Observed& card, std::span<const PairRecording> pairs,
                                      std::span<const std::size_t> rows);

enum class Comparison {
  kSame,
  kResult,    ///< operands agree, results differ
  kOperands,  ///< an operand differs
  kMissing,   ///< no operator of the card has these operands
  kUnknown,  ///< not found, but its operands say little (e.g. zeros), or the result does not depend
             ///< on it
};

/// An operation of one pair, on card and reference.
struct Compared {
  std::size_t operation = 0;  ///< of the reference
  Seat seat;
  Comparison comparison = Comparison::kMissing;
  Operation card;                    ///< unless it is missing
  bool first = false;                ///< everything that it depends on agrees
  std::vector<std::int32_t> others;  ///< if missing: operators of the card that may compute it
};

/// Compares every operation of the pair in row `row`. For an iterative pipeline (`iterative`) only
/// seats on which all pairs agree count: such a pipeline may select before an operation where the
/// reference selects after it.
[[nodiscard]] std::vector<Compared> compare(const Observed& card,
                                            std::span<const PairRecording> pairs, std::size_t row,
                                            std::span<const Seat> seats,
                                            std::span<const std::size_t> learnt_from,
                                            bool iterative);

}  // namespace cde::explain
