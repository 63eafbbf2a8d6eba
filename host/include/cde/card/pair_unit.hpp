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

#include "cde/card/trace.hpp"
#include "cde/contract/formats.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/model/model.hpp"
#include "cde/query/pair_result.hpp"

namespace cde {

/// One elaborated configuration of rtl/pair_unit.sv.
struct PairConfig {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;  ///< ray-triangle only
  bool box = false;                          ///< pairs of has_box_rule(), as in BoardConfig
  PlaneSide plane = PlaneSide::kSurface;     ///< pairs with a plane
  FpFormat format = {8, 23};
  unsigned lanes = 8;  ///< pairs per cycle, 1 to 256
  Arithmetic arithmetic = Arithmetic::kHost;
  unsigned sat_interval = 1;  ///< cycles from row to row of SAT pairs, 1 or 3. With 3, one unit
                              ///< tests three candidate axes in turn (has_sat_interval)
  OperatorLatencies latency = {};
  bool trace = false;  ///< waves can be written; the simulation is slower
  bool tap = false;    ///< operators can be watched (PairUnit::watch); one lane only

  /// NAME=VALUE for the builder. Error kUsage, naming it, if a value is out of range.
  [[nodiscard]] std::vector<std::string> parameters() const;
};

/// An operator of a pipe, an instance of rtl/fp/fp_lanes.sv.
struct PairOperator {
  /// In the module hierarchy, with the names of generate blocks: "TOP.pair_unit...".
  std::string path;
  FpOp operation;        ///< up to kMax
  unsigned latency = 0;  ///< cycles from operands to result; 0 for host arithmetic
};

/// Words at an operator in one cycle, counted from the first row of a test().
struct OperatorWords {
  std::uint32_t which = 0;  ///< index in PairUnit::operators()
  std::uint64_t cycle = 0;
  std::uint64_t a = 0, b = 0;  ///< operands; b of a square root is undefined. All ones while no
                               ///< consumer uses the result, as in host arithmetic
  std::uint64_t result = 0;  ///< of the operands `latency` cycles earlier; a mask is 0 or all ones
};

/// One simulated pipe: a pair_unit simulation model. Two threads must not use it at once. Every
/// call of a moved-from unit is an Error kUsage.
class PairUnit {
 public:
  /// The unit of this configuration, built on first use.
  explicit PairUnit(const PairConfig& config);
  /// Uses a loaded model that was built from `config`. Error kConfiguration if it was not.
  PairUnit(const SimulationModel& model, const PairConfig& config);
  ~PairUnit();
  PairUnit(PairUnit&&) noexcept;
  PairUnit& operator=(PairUnit&&) noexcept;

  [[nodiscard]] const PairConfig& config() const;
  /// Cycles from operands to results. They grow with the number of iterations.
  [[nodiscard]] unsigned latency() const;
  /// Sets the iterations per pair from here on; the default is 8, 8, 8. Resets the unit. Error
  /// kUsage if a value is out of range or the pair takes none.
  void set_iterations(const PairIterations& iterations);

  /// Tests pairs of operand words in slot order: primary_words and secondary_words words per pair,
  /// one result per pair. Error kUsage if the sizes do not match. A row of lanes enters as soon as
  /// the unit is ready, after as many idle cycles as `gap` returns. Returns the cycles from the
  /// first row in to the last result out.
  /// An exception of `gap` leaves the call, which resets the unit. `gap` may not give the unit
  /// other work (kUsage), but may move or destroy it. Error kTimeout if rows are no longer taken or
  /// answered, or are answered out of order. Its fault() has the cycle of this call at which the
  /// unit stopped. That also resets the unit.
  std::uint64_t test(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                     std::span<PairResult> results, const std::function<unsigned()>& gap = {});

  /// Operators of the pipe in the order of the model; none unless built with `tap`.
  [[nodiscard]] std::vector<PairOperator> operators() const;
  /// test() that reports every operator in every cycle, also between rows, in no particular order
  /// within a cycle. Error kConfiguration if the unit was built without `tap`.
  std::uint64_t watch(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                      std::span<PairResult> results,
                      const std::function<void(const OperatorWords&)>& seen);

  /// Resets in mid-stream: rows in flight are lost.
  void reset();
  /// Writes waves as TraceOptions say. `secondary` is ignored, because a unit has none. Error
  /// kConfiguration if the model was built without trace; kFile if the file cannot be written.
  void open_trace(const std::string& path, const TraceOptions& which = {});
  /// Error kFile if the waves could not be written completely; the file is then unusable.
  void close_trace();

 private:
  struct State;
  [[nodiscard]] State& state() const;  ///< kUsage if moved from
  [[nodiscard]] State& idle() const;   ///< kUsage also during a test()
  std::shared_ptr<State> state_;       ///< a test() keeps it alive if its gap drops the unit
};

/// Where result i of a gapless test() of these pairs comes out: "cycle 12, lane 3, row 1". The
/// first row enters at cycle 0. Runs the rows up to this one again.
[[nodiscard]] std::string place_in_unit(PairUnit& unit, std::span<const std::uint64_t> a,
                                        std::span<const std::uint64_t> b, std::size_t i);

}  // namespace cde
