// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <span>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/reference/pairs.hpp"

/// Records of any pair from the mirror references.
namespace cde::testing {

/// All pairs by the reference, secondary by secondary; `swap`: A is the secondary.
template <class A, class B>
std::vector<PairResult> all_pairs(Pair pair, const std::vector<A>& a, const std::vector<B>& b,
                                  bool swap, const PairIterations& iterations = {},
                                  FpFormat format = {}) {
  std::vector<std::uint64_t> wa, wb;
  const auto push = [format](std::vector<std::uint64_t>& to, const auto& shape) {
    for (const float x : to_words(shape))
      to.push_back(format == FpFormat{} ? std::bit_cast<std::uint32_t>(x) : format.encode(x));
  };
  const auto one = [&](const A& x, const B& y) {
    push(wa, x);
    push(wb, y);
  };
  if (swap) {
    for (const A& x : a)
      for (const B& y : b) one(x, y);
  } else {
    for (const B& y : b)
      for (const A& x : a) one(x, y);
  }
  std::vector<PairResult> r(a.size() * b.size());
  reference::test_pairs(pair, Algorithm::kMoller, format, wa, wb, r, PlaneSide::kSurface,
                        iterations);
  return r;
}

/// Uploads the secondaries and loads the primaries; A is the primary unless `swap`. Returns which
/// primaries are bad input.
template <class A, class B>
std::vector<bool> load_shapes(Board& board, const std::vector<A>& a, const std::vector<B>& b,
                              bool swap) {
  const auto load = [&board]<class P, class S>(const std::vector<P>& primaries,
                                               const std::vector<S>& secondaries) {
    board.upload_shapes(std::span<const S>(secondaries), false);
    board.load_shapes(std::span<const P>(primaries), false);
    std::vector<bool> bad;
    std::transform(primaries.begin(), primaries.end(), std::back_inserter(bad),
                   [](const P& shape) { return defect(shape).has_value(); });
    return bad;
  };
  return swap ? load(b, a) : load(a, b);
}

/// 0, 1, ...: the slots of secondaries in the order of a pass without objects.
inline std::vector<std::uint32_t> in_order(std::size_t count) {
  std::vector<std::uint32_t> slots(count);
  std::iota(slots.begin(), slots.end(), 0u);
  return slots;
}

/// Expected records of the card for `results`: every primary with the secondary in slots[0], then
/// with the one in slots[1], and so on.
std::vector<Record> expected(Pair pair, const std::vector<PairResult>& results,
                             const std::vector<std::uint32_t>& slots,
                             const std::vector<bool>& bad_primary, Mode mode, bool normals,
                             FpFormat format = {});

/// Fails with the first records that differ in any bit.
void compare(const std::vector<Record>& got, const std::vector<Record>& wanted, Mode mode);

}  // namespace cde::testing
