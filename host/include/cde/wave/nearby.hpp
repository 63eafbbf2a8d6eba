// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cde/wave/design.hpp"

namespace cde::wave {

/// A line, and its distance from the signals in statements.
struct Near {
  Place place;
  unsigned drivers = 0;
};

/// Special treatment of statements.
struct Passing {
  std::function<bool(const Place&)> wire = {};  ///< counts as no step
  std::function<bool(const Place&)> end = {};   ///< neither reported nor followed
};

/// Lines of the statements that drive signals, then of the statements that drive their sources, up
/// to `steps` statements away, nearest first. Ports and plain wires between modules are not steps.
/// At most `most` lines. Signals that the design lacks are skipped.
[[nodiscard]] std::vector<Near> driving_statements(const Design& design,
                                                   const std::vector<std::string>& signals,
                                                   unsigned steps, std::size_t most,
                                                   const Passing& passing = {});

}  // namespace cde::wave
