// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cde/explain/match.hpp"
#include "cde/netlist/elaborate.hpp"

/// From a pair that a pipe answers wrong to the lines of RTL where it begins.
namespace cde::explain {

/// Lines that make an operator: in the module of the pipe first, then in the parts that it is of.
struct Source {
  std::vector<netlist::Place> places;
  /// "dot_det.axis[0].mul", in the pipe
  [[nodiscard]] std::string name() const;
  /// "ray_triangle_moller.sv:35 dot_det, df_dot.sv:31 cell_u, vec_dot.sv:28 axis[0].mul"
  [[nodiscard]] std::string text() const;
  /// The line that has the operator in the text of a pipe or of one of its parts, not of what all
  /// pipes are made of: "ray_triangle_moller.sv:35"
  [[nodiscard]] std::string line() const;
};

/// A place where the card parts from the reference while all before it is the same.
struct Finding {
  Compared compared;
  std::vector<Source> sources;  ///< the likeliest first
};

struct Explanation {
  PairConfig config;
  PairResult card, reference;
  PairRecording recording;
  std::vector<Compared> operations;  ///< of the reference, each with its operator of the card
  std::vector<Source> sources;       ///< of the card's operators
  std::vector<PairOperator> operators;
  std::vector<Finding> findings;  ///< in the order of the reference
  std::size_t found = 0;          ///< operations that the card has an operator for

  [[nodiscard]] bool same() const { return card == reference; }
};

/// Explains pairs by one pipe, which is opened once.
class Explainer {
 public:
  /// Error kBuild if the pipe cannot be built.
  Explainer(const PairConfig& config, const PairBudget& budget);

  /// Runs one pair, in the midst of others, through the pipe alone. Error kBuild if the RTL cannot
  /// be read.
  [[nodiscard]] Explanation explain(std::span<const std::uint64_t> a,
                                    std::span<const std::uint64_t> b);

 private:
  PairBudget budget_;
  PairUnit unit_;
  std::vector<PairRecording> recordings_;  ///< of all rows, the explained one among them
  std::vector<Seat> seats_;                ///< as the first explanation learnt them
  std::vector<Source> sources_;            ///< of the operators
};

/// One pair by Explainer.
[[nodiscard]] Explanation explain(const PairConfig& config, std::span<const std::uint64_t> a,
                                  std::span<const std::uint64_t> b, const PairBudget& budget);

}  // namespace cde::explain
