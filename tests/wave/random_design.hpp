// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

namespace cde::testing {

/// A design of random statements. Each statement leaves a mark when it is executed.
struct RandomDesign {
  std::string source;                  ///< of module dut
  std::string bench;                   ///< module bench, which writes waves of a simulation
  unsigned marks = 0;                  ///< variables m0, m1, ... of 16 bits, one per process
  std::map<unsigned, unsigned> lines;  ///< value that a statement assigns to its mark -> its line
  /// Assignments of cond ? k0 : k1, where signals k0 and k1 hold these numbers.
  struct Choice {
    unsigned line = 0, yes = 0, no = 0;
  };
  std::map<unsigned, Choice> choices;  ///< mark -> choice of its process
};

/// Makes `processes` processes with several statements each. The waves are `file`.
[[nodiscard]] RandomDesign random_design(unsigned seed, unsigned processes,
                                         const std::string& file);

}  // namespace cde::testing
