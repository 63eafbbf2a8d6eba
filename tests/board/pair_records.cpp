// SPDX-License-Identifier: Apache-2.0
#include "pair_records.hpp"

#include <algorithm>

namespace cde::testing {
namespace {

Record record(Pair pair, const PairResult& r, std::uint32_t primary, std::uint32_t index,
              bool normals, FpFormat format) {
  const auto number = [format](std::uint64_t w) {
    return format == FpFormat{} || format.is_nan(w)
               ? std::bit_cast<float>(static_cast<std::uint32_t>(
                     w == format.canonical_nan() ? FpFormat{}.canonical_nan() : w))
               : static_cast<float>(format.decode(w));
  };
  Record out;
  out.f = r.f;
  out.bad = r.bad;
  out.t = number(r.t);
  out.primary = primary;
  out.index = r.f || (is_solid(pair) && !r.bad) ? index : ~0u;
  for (int k = 0; k < 3; ++k) {
    out.cp[k] = number(r.cp[k]);
    if (normals) out.n[k] = number(r.n[k]);
  }
  return out;
}

}  // namespace

std::vector<Record> expected(Pair pair, const std::vector<PairResult>& results,
                             const std::vector<std::uint32_t>& slots,
                             const std::vector<bool>& bad_primary, Mode mode, bool normals,
                             FpFormat format) {
  const std::size_t primaries = bad_primary.size(), secondaries = slots.size();
  std::vector<Record> all;
  for (std::size_t s = 0; s < secondaries; ++s)
    for (std::uint32_t p = 0; p < primaries; ++p)
      all.push_back(record(pair, results[s * primaries + p], p, slots[s], normals, format));
  if (mode == Mode::kAll) return all;
  std::vector<Record> kept;
  if (mode == Mode::kHits) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(kept),
                 [](const Record& r) { return r.f; });
    return kept;
  }
  const bool solid = is_solid(pair);
  const auto key = [solid](const Record& r) { return solid && r.f ? -r.t : r.t; };
  const auto better = [&](const Record& r, const Record& best) {
    if (mode == Mode::kAny) return false;
    if (key(r) == key(best)) return r.index < best.index;
    return (key(r) < key(best)) == (mode == Mode::kNearest);
  };
  for (std::uint32_t p = 0; p < primaries; ++p) {
    const Record* best = nullptr;
    for (std::size_t s = 0; s < secondaries; ++s) {
      const Record& r = all[s * primaries + p];
      if (r.bad || (!r.f && (!solid || mode == Mode::kAny))) continue;
      if (best == nullptr || better(r, *best)) best = &r;
    }
    Record none;
    none.primary = p;
    if (bad_primary[p]) {
      none.bad = true;
      none.t = std::bit_cast<float>(0x7fc00000u);
      none.cp.setConstant(none.t);
      if (normals) none.n.setConstant(none.t);
    }
    kept.push_back(best != nullptr ? *best : none);
  }
  return kept;
}

void compare(const std::vector<Record>& got, const std::vector<Record>& wanted, Mode mode) {
  ASSERT_EQ(got.size(), wanted.size()) << name_of(mode);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    if (same_bits(got[i], wanted[i])) continue;
    if (++wrong > 3) continue;
    ADD_FAILURE() << name_of(mode) << " record " << i << ": primary " << got[i].primary << " index "
                  << got[i].index << " F " << got[i].f << " bad " << got[i].bad << " T " << got[i].t
                  << ", expected primary " << wanted[i].primary << " index " << wanted[i].index
                  << " F " << wanted[i].f << " bad " << wanted[i].bad << " T " << wanted[i].t;
  }
  EXPECT_EQ(wrong, 0u) << name_of(mode) << ", of " << got.size();
}

}  // namespace cde::testing
