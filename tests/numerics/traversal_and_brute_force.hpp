// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "bvh_pair.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/traversal.hpp"

/// Primaries against a BVH, compared with brute force.
namespace cde::testing {

/// Whether CDE_FULL=1 requests thorough runs.
inline bool full() {
  return std::getenv("CDE_FULL") != nullptr;
}

/// Brute-force records, by ascending primary, then index.
template <class P, class Secondary>
std::vector<Record> brute_force(const std::vector<Secondary>& all, const std::vector<P>& primaries,
                                Mode mode) {
  const auto [pair, swap] = bvh_pair<P, Secondary>();
  std::vector<Record> records;
  const Shapes secondaries = all;
  for (std::size_t first = 0; first < primaries.size(); first += 256) {
    const std::size_t n = std::min<std::size_t>(256, primaries.size() - first);
    const auto begin = primaries.begin() + static_cast<long>(first);
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < n; ++i) numbers.push_back(static_cast<std::uint32_t>(first + i));
    reference::Pass pass({.pair = pair, .box = has_box_rule(pair), .swap = swap, .mode = mode},
                         std::vector<P>(begin, begin + static_cast<long>(n)), numbers, secondaries);
    std::vector<Record> some;
    for (auto next = pass.next(); !next.empty(); next = pass.next()) {
      some.insert(some.end(), next.begin(), next.end());
      if (mode != Mode::kHits) break;  // one per primary, over all secondaries
    }
    std::stable_sort(some.begin(), some.end(), [](const Record& a, const Record& b) {
      return a.primary != b.primary ? a.primary < b.primary : a.index < b.index;
    });
    records.insert(records.end(), some.begin(), some.end());
  }
  return records;
}

/// Compares records in these modes with brute force, for BVHs with leaves of one and of two. `text`
/// describes a primary. More than `least` records must be hits.
template <class P, class Secondary, class Text>
void expect_all_records(const std::vector<Secondary>& all, const std::vector<P>& primaries,
                        std::span<const Mode> modes, std::size_t least, const Text& text) {
  std::size_t meet = 0;
  for (const Mode mode : modes) {
    const std::vector<Record> should = brute_force(all, primaries, mode);
    for (const unsigned leaf : {1u, 2u}) {
      const Bvh bvh = Bvh::build(all, {.leaf = leaf});
      reference::Traversal traversal(all, bvh);
      std::vector<Record> own;
      for (std::uint32_t i = 0; i < primaries.size(); ++i) {
        const std::vector<Record> some = traversal.trace(primaries[i], i, mode);
        own.insert(own.end(), some.begin(), some.end());
        if (mode == Mode::kAny) {
          EXPECT_EQ(traversal.occluded(primaries[i]), some[0].f);
        }
      }
      ASSERT_EQ(own.size(), should.size()) << name_of(mode);
      std::size_t different = 0;
      for (std::size_t i = 0; i < own.size(); ++i) {
        meet += own[i].f;
        if (same_bits(own[i], should[i])) continue;
        if (different++ < 3)
          ADD_FAILURE() << name_of(mode) << ", " << text(primaries[should[i].primary])
                        << ", number " << should[i].primary << ": T " << own[i].t << " of "
                        << own[i].index << ", expected " << should[i].t << " of "
                        << should[i].index;
      }
      EXPECT_EQ(different, 0u);
    }
  }
  fmt::print("{} primaries, {} records that meet\n", primaries.size(), meet);
  EXPECT_GT(meet, least);
}

}  // namespace cde::testing
