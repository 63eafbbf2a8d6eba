// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cde/explain/match.hpp"
#include "cde/netlist/elaborate.hpp"

/// @file
/// From a pair with a wrong result to the RTL lines where the error begins.
namespace cde::explain {

/// RTL lines that create an operator, from the pipe's module down.
struct Source {
  std::vector<netlist::Place> places;
  /// "dot_det.axis[0].mul", within the pipe
  [[nodiscard]] std::string name() const;
  /// "ray_triangle_moller.sv:35 dot_det, df_dot.sv:31 cell_u, vec_dot.sv:28 axis[0].mul"
  [[nodiscard]] std::string text() const;
  /// The line for the operator in the text of a pipe or of its parts, not of common building
  /// blocks: "ray_triangle_moller.sv:35"
  [[nodiscard]] std::string line() const;
};

/// An operation where the card first differs from the reference: everything before it agrees.
struct Finding {
  Compared compared;
  std::vector<Source> sources;  ///< likeliest first
};

struct Explanation {
  PairConfig config;
  PairResult card, reference;
  PairRecording recording;
  std::vector<Compared> operations;  ///< of the reference, each with the card's operator
  std::vector<Source> sources;       ///< of the card's operators
  std::vector<PairOperator> operators;
  std::vector<Finding> findings;  ///< in the order of the reference
  std::size_t found = 0;          ///< number of operations for which the card has an operator

  [[nodiscard]] bool same() const { return card == reference; }
};

/// Explains pairs by one pipe, which is opened once.
class Explainer {
 public:
  /// Error kBuild if the pipe cannot be built.
  Explainer(const PairConfig& config, const PairIterations& iterations);

  /// Runs one pair through the pipe alone, among other pairs. Error kBuild if the RTL cannot be
  /// read.
  [[nodiscard]] Explanation explain(std::span<const std::uint64_t> a,
                                    std::span<const std::uint64_t> b);

 private:
  PairIterations iterations_;
  PairUnit unit_;
  std::vector<PairRecording> recordings_;  ///< of all rows, including the explained one
  std::vector<Seat> seats_;                ///< from the first explanation
  std::vector<Source> sources_;            ///< of the operators
};

/// Explains one pair with an Explainer.
[[nodiscard]] Explanation explain(const PairConfig& config, std::span<const std::uint64_t> a,
                                  std::span<const std::uint64_t> b,
                                  const PairIterations& iterations);

}  // namespace cde::explain
