// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cde/wave/design.hpp"

namespace cde::wave {

/// A line, and how many statements it is from the signals.
struct Near {
  Place place;
  unsigned drivers = 0;
};

/// Statements that are taken for what they are not.
struct Passing {
  std::function<bool(const Place&)> wire = {};  ///< no step
  std::function<bool(const Place&)> end = {};   ///< neither named nor followed
};

/// Lines of the statements that give signals their value, and those that give these theirs, `steps`
/// statements far, the nearest first; ports and plain wires between modules are no step. At most
/// `most` lines. Signals that the design does not have are passed over.
[[nodiscard]] std::vector<Near> fed_by(const Design& design,
                                       const std::vector<std::string>& signals, unsigned steps,
                                       std::size_t most, const Passing& passing = {});

}  // namespace cde::wave
