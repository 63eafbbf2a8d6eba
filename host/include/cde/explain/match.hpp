// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/explain/record.hpp"

/// The card's operators beside those of the mirror reference. Which operator of the card does the
/// k-th operation of the reference is learnt from other pairs, in the very model that fails: it is
/// the one that has the same operands, so many clocks after each pair has entered.
namespace cde::explain {

/// What was at an operator, a word a clock; every NaN is the canonical one, a mask is 0 or 1.
struct Track {
  std::vector<std::uint64_t> a, b, result;
};

/// The operators of a unit while rows went through it, one pair each. Row r enters at clock
/// r * interval.
struct Observed {
  FpFormat format{8, 23};
  std::vector<PairOperator> operators;
  std::vector<Track> tracks;        ///< of the operators
  std::vector<PairResult> results;  ///< of the rows
  unsigned interval = 1;
};

/// Runs pairs through a unit that has taps. No more rows than a ring has slots.
[[nodiscard]] Observed observe(PairUnit& unit, std::span<const std::uint64_t> a,
                               std::span<const std::uint64_t> b);

/// An operation as the card did it.
struct Operation {
  FpOp operation = FpOp::kAdd;
  std::uint64_t a = 0, b = 0, result = 0;
};

/// Where the card does an operation of the reference.
struct Seat {
  std::int32_t which = -1;  ///< operator of the card; -1: none was found
  unsigned offset = 0;      ///< clocks from the pair's entry to its operands
  unsigned operands = 0;    ///< pairs of which it had the operands, none of them zero, or agreed
  unsigned agree = 0;       ///< and gave the reference's result
};

/// A seat for each operation of the reference. `rows` says which pairs to learn from, by their
/// places in the observation; all recordings have as many operators.
[[nodiscard]] std::vector<Seat> learn(const Observed& card, std::span<const PairRecording> pairs,
                                      std::span<const std::size_t> rows);

enum class Verdict {
  kSame,
  kResult,    ///< the operands are the reference's, the result is not
  kOperands,  ///< an operand is another
  kMissing,   ///< no operator of the card has these operands
  kUnknown,  ///< none was found, but its operands say little, as zeros, or the answer leaves it out
};

/// An operation of one pair, on both sides.
struct Compared {
  std::size_t operation = 0;  ///< of the reference
  Seat seat;
  Verdict verdict = Verdict::kMissing;
  Operation card;                    ///< unless it is missing
  bool first = false;                ///< everything that it depends on is the same
  std::vector<std::int32_t> others;  ///< of a missing one: operators of the card that may be it
};

/// Every operation of the pair in row `row`. Of a ring only seats count that all pairs agree about:
/// it selects before an operation where the reference selects behind it.
[[nodiscard]] std::vector<Compared> compare(const Observed& card,
                                            std::span<const PairRecording> pairs, std::size_t row,
                                            std::span<const Seat> seats,
                                            std::span<const std::size_t> learnt_from, bool ring);

}  // namespace cde::explain
