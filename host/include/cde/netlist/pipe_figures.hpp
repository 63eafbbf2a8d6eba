// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/netlist/elaborate.hpp"

/// @file
/// Figures of whole pipes from the elaborated RTL, cached.
namespace cde::netlist {

/// Latencies of operators in cycles.
struct Profile {
  unsigned add = 1, mul = 1, div = 1, sqrt = 1, cmp = 1;
  bool operator==(const Profile&) const = default;
  [[nodiscard]] std::string text() const {
    return fmt::format("add {}, mul {}, div {}, sqrt {}, cmp {}", add, mul, div, sqrt, cmp);
  }
};

/// A pipe, elaborated with one lane in fp32.
struct Pipe {
  Pair pair;
  Algorithm algorithm;
  std::string absent;         ///< why there is no pipe; the other fields are then empty
  unsigned sat_interval = 1;  ///< requested interval
  bool box = false;           ///< it has the box rule
  std::string module = {};
  Operators operators = {};
  unsigned a_words = 0, b_words = 0, outputs = 0;  ///< 32-bit words; F counts as one
  unsigned latency = 0, latency_profile = 0;  ///< cycles; the first with one cycle per operator
  unsigned interval = 1;                      ///< cycles from one row to the next
  unsigned slots = 0;                         ///< rows in flight in an iterative pipeline

  [[nodiscard]] std::string name() const {
    return pair == Pair::kRayTriangle ? fmt::format("{}, {}", cde::name(pair), cde::name(algorithm))
                                      : std::string(cde::name(pair));
  }
};

/// Fills in the figures of all pipes. Those not in the cache are elaborated, one job per processor.
/// Error kBuild if the RTL cannot be elaborated for any reason other than a missing pipe.
void examine_all(std::vector<Pipe>& wanted, const Profile& profile);

}  // namespace cde::netlist
