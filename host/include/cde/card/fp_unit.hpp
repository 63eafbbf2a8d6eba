// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/fp/fp_reference.hpp"
#include "cde/model/model.hpp"

namespace cde {

/// Parameters of an fp_unit simulation model as `NAME=VALUE`.
[[nodiscard]] std::vector<std::string> fp_unit_parameters(FpFormat format, Arithmetic arithmetic,
                                                          int lanes, bool flags);

/// The simulated floating-point units of one format: an fp_unit simulation model. Two threads must
/// not use it at once. Every call of a moved-from object is an Error kUsage.
class FpUnit {
 public:
  /// Uses a loaded model. Error kConfiguration if it is not an fp_unit of this version.
  explicit FpUnit(const SimulationModel& model);
  /// The unit of this configuration, built on first use.
  FpUnit(FpFormat format, Arithmetic arithmetic, int lanes = 16, bool flags = true);
  ~FpUnit();
  FpUnit(FpUnit&&) noexcept;
  FpUnit& operator=(FpUnit&&) noexcept;

  [[nodiscard]] FpFormat format() const;
  [[nodiscard]] int lanes() const;
  /// Cycles from operands to result. Error kConfiguration if the model lacks the operation.
  [[nodiscard]] int latency(FpOp op) const;

  /// r[i] = op(a[i], b[i]), streamed one row of lanes per cycle. b is empty for operations of one
  /// operand, and flags may be empty. Otherwise all have the size of a (Error kUsage). Comparisons
  /// return 0 or 1.
  void apply(FpOp op, std::span<const uint64_t> a, std::span<const uint64_t> b,
             std::span<uint64_t> r, std::span<uint8_t> flags = {});

  /// Simulated operations per second of processor time, with all lanes busy and new operands in
  /// every cycle. The measurement takes about `seconds`.
  [[nodiscard]] double measure(FpOp op, double seconds);

 private:
  struct State;
  [[nodiscard]] State& state() const;  ///< kUsage if moved from
  std::unique_ptr<State> state_;
};

}  // namespace cde
