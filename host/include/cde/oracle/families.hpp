// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/oracle/cases.hpp"

namespace cde::oracle {

/// One set of cases of a pair by itself: those of generate() under their names ("near-contact"),
/// those of everyday() as "everyday-...", those of hard().
struct Family {
  std::string name;  ///< blanks are dashes
  Case (*make)(Pair, std::uint64_t seed, std::uint64_t index, const Format&) = nullptr;
  std::uint64_t first = 0, step = 1;  ///< of the indices that `make` gives this family for

  [[nodiscard]] Case at(Pair pair, std::uint64_t seed, std::uint64_t i,
                        const Format& format) const {
    return make(pair, seed, first + i * step, format);
  }
};

/// All of a pair, in the order of the lists above.
[[nodiscard]] std::vector<Family> families(Pair pair);

}  // namespace cde::oracle
