// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/families.hpp"

#include <algorithm>

namespace cde::oracle {

std::vector<Family> families(Pair pair) {
  std::vector<Family> all;
  // The cases name their family. A family may have several ranges of indices: the first one counts.
  const auto add = [&](const std::string& prefix, Family family) {
    family.name = prefix + family.at(pair, 0, 0, {}).family;
    std::ranges::replace(family.name, ' ', '-');
    if (std::ranges::none_of(all, [&](const Family& f) { return f.name == family.name; }))
      all.push_back(family);
  };
  const std::uint64_t directed = has_ray(pair) ? detail::kRayFamilies : detail::kConvexFamilies;
  add("", {"", generate, 0, 2});
  for (std::uint64_t k = 0; k < directed; ++k) add("", {"", generate, 2 * k + 1, 2 * directed});
  for (std::uint64_t k = 0; k < detail::kEverydayFamilies; ++k)
    add("everyday-", {"", everyday, k, detail::kEverydayFamilies});
  const std::uint64_t most = has_ray(pair) ? detail::kHardRayFamilies : detail::kHardConvexFamilies;
  for (std::uint64_t k = 0; k < most; ++k) add("", {"", hard, k, most});
  return all;
}

}  // namespace cde::oracle
