// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/oracle/cases.hpp"

namespace cde::oracle {

/// One family of cases of a pair. Families of generate() and hard() have their own names
/// ("near-contact"), families of everyday() are called "everyday-...".
struct Family {
  std::string name;  ///< with dashes instead of blanks
  Case (*make)(Pair, std::uint64_t seed, std::uint64_t index, const Format&) = nullptr;
  std::uint64_t first = 0, step = 1;  ///< indices at which `make` produces this family

  [[nodiscard]] Case at(Pair pair, std::uint64_t seed, std::uint64_t i,
                        const Format& format) const {
    return make(pair, seed, first + i * step, format);
  }
};

/// All families of a pair: of generate(), everyday() and hard().
[[nodiscard]] std::vector<Family> families(Pair pair);

}  // namespace cde::oracle
