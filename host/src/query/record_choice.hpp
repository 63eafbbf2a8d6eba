// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/geometry/ops.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/record.hpp"

/// How one record of a primary is chosen among those of its pairs, as the card's update engine
/// does. Private to the library.
namespace cde {

/// Whether a record of a pair may be kept: of rays hits, of solids, but for mode any, every pair.
[[nodiscard]] inline bool is_candidate(Pair pair, Mode mode, const Record& r) {
  return !r.bad && r.index != ~0u && (r.f || (is_solid(pair) && mode != Mode::kAny));
}

/// Whether a record of a pair replaces the best one so far (index ~0: there is none) of the same
/// primary, in ascending order of secondaries: of solids the signed gap decides. The two zeros tie.
[[nodiscard]] inline bool better(Pair pair, Mode mode, const Record& r, const Record& best) {
  if (!is_candidate(pair, mode, r)) return false;
  if (best.index == ~0u) return true;
  const bool solid = is_solid(pair);
  const auto gap = [solid](const Record& of) { return solid && of.f ? -of.t : of.t; };
  if (mode == Mode::kNearest) return gap(r) < gap(best);
  return mode == Mode::kFarthest && gap(r) > gap(best);
}

/// The record of a primary that no pair has answered.
template <class P>
[[nodiscard]] Record unanswered(const P& primary, std::uint32_t number, bool normals,
                                FpFormat format) {
  Record r;
  r.primary = number;
  if (!defect(primary, format)) return r;
  r.bad = true;
  r.t = reference::canonical_nan<float>();
  r.cp.setConstant(r.t);
  if (normals) r.n.setConstant(r.t);
  return r;
}

}  // namespace cde
