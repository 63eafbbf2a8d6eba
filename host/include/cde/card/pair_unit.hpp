// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/bitstream/bitstream.hpp"
#include "cde/card/trace.hpp"
#include "cde/contract/formats.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/pair_result.hpp"

namespace cde {

/// One elaborated configuration of rtl/pair_unit.sv.
struct PairConfig {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;  ///< of ray-triangle only
  bool box = false;                       ///< of pairs that has_box_rule() says, as in BoardConfig
  PlaneSide plane = PlaneSide::kSurface;  ///< of pairs with a plane
  FpFormat format = {8, 23};
  unsigned lanes = 8;  ///< pairs a clock, 1 to 256
  Arithmetic arithmetic = Arithmetic::kHost;
  unsigned facet_interval = 1;  ///< clocks from row to row of pairs with facets, 1 or 3: with 3 the
                                ///< gates of three facets are one unit's (has_facets)
  unsigned latency_add = 1;     ///< clocks of an operator, at least 1
  unsigned latency_mul = 1;
  unsigned latency_div = 1;
  unsigned latency_sqrt = 1;
  unsigned latency_compare = 1;
  bool trace = false;  ///< waves can be written (and everything runs slower)
  bool tap = false;    ///< operators tell what they do (PairUnit::watch); of one lane

  /// NAME=VALUE for the builder. Error kUsage if a value is out of range, naming it.
  [[nodiscard]] std::vector<std::string> parameters() const;
};

/// An operator of a pipe, an instance of rtl/fp/fp_lanes.sv.
struct PairOperator {
  std::string path;  ///< in the hierarchy, with the names of generate blocks: "TOP.pair_unit..."
  FpOp operation;    ///< up to kMax
  unsigned latency = 0;  ///< clocks from operands to result; 0 of host arithmetic
};

/// What is at an operator in one clock, which is counted from the first row of a test().
struct OperatorWords {
  std::uint32_t which = 0;  ///< index in PairUnit::operators()
  std::uint64_t clock = 0;
  std::uint64_t a = 0, b = 0;  ///< operands; b of a square root says nothing. All ones while
                               ///< nobody looks at the result, as in host arithmetic
  std::uint64_t result = 0;    ///< of the operands that came `latency` clocks before; a mask is 0
                               ///< or all ones
};

/// One simulated pipe: a pair_unit bitstream. Not for use by two threads at once. Every call of one
/// that was moved from is an Error kUsage.
class PairUnit {
 public:
  /// The unit of that configuration, built on first use.
  explicit PairUnit(const PairConfig& config);
  /// Of a loaded bitstream; `config` is what it was built from. Error kConfiguration if it is not.
  PairUnit(const Bitstream& bitstream, const PairConfig& config);
  ~PairUnit();
  PairUnit(PairUnit&&) noexcept;
  PairUnit& operator=(PairUnit&&) noexcept;

  [[nodiscard]] const PairConfig& config() const;
  /// Clocks from operands to results; with a budget, they grow with it.
  [[nodiscard]] unsigned latency() const;
  /// Work for a pair from here on; 8, 8, 8 before. Resets the unit. Error kUsage if the budget is
  /// out of range or the pair takes none.
  void set_budget(const PairBudget& budget);

  /// Pairs of operand words in slot order, primary_words and secondary_words a pair; one result a
  /// pair (Error kUsage if sizes do not fit together). A row of lanes enters a clock, after as many
  /// idle clocks as `gap` says, as soon as the unit is ready for it. Returns the clocks from the
  /// first row in to the last result out. What `gap` throws comes out of the call, which resets the
  /// unit; it may not give the unit other work (kUsage), but may move or destroy it. Error
  /// kTimeout, whose fault() has the clock of this call since which the unit did not go on, if rows
  /// are neither taken nor answered any more, or not in their order; that resets it too.
  std::uint64_t test(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                     std::span<PairResult> results, const std::function<unsigned()>& gap = {});

  /// The pipe's operators in the order in which the model was made; none unless built with `tap`.
  [[nodiscard]] std::vector<PairOperator> operators() const;
  /// test() with a look at every operator in every clock, also of those between the rows, in no
  /// order within a clock. Error kConfiguration if the unit was built without `tap`.
  std::uint64_t watch(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                      std::span<PairResult> results,
                      const std::function<void(const OperatorWords&)>& seen);

  /// Reset in mid-stream: what is in flight is gone.
  void reset();
  /// Waves, of TraceOptions but for `secondary`, which a unit does not have. Error kConfiguration
  /// if the bitstream was built without trace, kFile if the file cannot
  /// be written.
  void open_trace(const std::string& path, const TraceOptions& which = {});
  /// Error kFile if not all of the waves could be written; the file is then of no use.
  void close_trace();

 private:
  struct State;
  [[nodiscard]] State& state() const;  ///< kUsage if it was moved from
  [[nodiscard]] State& idle() const;   ///< and in a test()
  std::shared_ptr<State> state_;       ///< a test() keeps it over a gap that drops the unit
};

/// Where result i of a test() of these pairs without gaps comes out: "clock 12, lane 3, row 1". The
/// clock is counted from the first row in, which is clock 0. Runs the rows up to there again.
[[nodiscard]] std::string place_in_unit(PairUnit& unit, std::span<const std::uint64_t> a,
                                        std::span<const std::uint64_t> b, std::size_t i);

}  // namespace cde
