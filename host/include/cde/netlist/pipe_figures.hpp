// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/netlist/elaborate.hpp"

/// What the elaborated RTL says of whole pipes, kept in the cache.
namespace cde::netlist {

/// Clocks of an operator.
struct Profile {
  unsigned add = 1, mul = 1, div = 1, sqrt = 1, cmp = 1;
  bool operator==(const Profile&) const = default;
  [[nodiscard]] std::string text() const {
    return fmt::format("add {}, mul {}, div {}, sqrt {}, cmp {}", add, mul, div, sqrt, cmp);
  }
};

/// A pipe as it is elaborated with one lane in fp32.
struct Pipe {
  Pair pair;
  Algorithm algorithm;
  std::string absent;           ///< why there is none; the rest is empty then
  unsigned facet_interval = 1;  ///< that was asked for
  bool box = false;             ///< it has the box rule
  std::string module = {};
  Operators operators = {};
  unsigned a_words = 0, b_words = 0, outputs = 0;  ///< words of 32 bits, F as one
  unsigned latency = 0, latency_profile = 0;       ///< clocks; the first at one an operator
  unsigned interval = 1;                           ///< clocks from a row to the next
  unsigned ring = 0;                               ///< rows in flight in a pipe that is a ring

  [[nodiscard]] std::string name() const {
    return pair == Pair::kRayTriangle ? fmt::format("{}, {}", cde::name(pair), cde::name(algorithm))
                                      : std::string(cde::name(pair));
  }
};

/// Fills in the figures of all of them: those that are kept from earlier times, and the others by
/// elaboration, as many at a time as there are processors. Error kBuild if the RTL cannot be
/// elaborated for any other reason than that there is no pipe.
void examine_all(std::vector<Pipe>& wanted, const Profile& profile);

}  // namespace cde::netlist
