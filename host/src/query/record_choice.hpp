// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/geometry/ops.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/query/record.hpp"

/// Chooses one record of a primary among the records of its pairs, as the card's update engine
/// does. Private to the library.
namespace cde {

/// Whether a pair's record may be kept: hits for rays, and every pair for solids except in mode
/// any.
[[nodiscard]] inline bool is_candidate(Pair pair, Mode mode, const Record& r) {
  return !r.bad && r.index != ~0u && (r.f || (is_solid(pair) && mode != Mode::kAny));
}

/// Whether a pair's record replaces the best record so far of the same primary; index ~0 means
/// none. Records come in ascending order of secondaries. For solids the signed distance decides. +0
/// and -0 tie.
[[nodiscard]] inline bool better(Pair pair, Mode mode, const Record& r, const Record& best) {
  if (!is_candidate(pair, mode, r)) return false;
  if (best.index == ~0u) return true;
  const bool solid = is_solid(pair);
  const auto signed_t = [solid](const Record& of) { return solid && of.f ? -of.t : of.t; };
  if (mode == Mode::kNearest) return signed_t(r) < signed_t(best);
  return mode == Mode::kFarthest && signed_t(r) > signed_t(best);
}

/// The record of a primary without any answered pair.
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
