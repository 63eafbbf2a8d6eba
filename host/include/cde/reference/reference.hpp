// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/contract/records.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/difference.hpp"
#include "cde/query/query.hpp"
#include "cde/reference/record_check.hpp"

/// Mirror reference: what the card computes, operation by operation in the same order with the same
/// roundings, so that every bit must match. The library is compiled without contraction; whoever
/// includes the template must do the same (-ffp-contract=off), as an FMA rounds once where the
/// hardware rounds twice. The templates are in reference/, one header a pair of primitives.
namespace cde::reference {

/// One pair of the card, as the record that mode all writes. `box`, here and below: the card has
/// the box rule; `algorithm`, too, is the card's.
[[nodiscard]] Record record_of(const Ray& ray, const Triangle& triangle, std::uint32_t primary,
                               std::uint32_t index, bool box = false,
                               Algorithm algorithm = Algorithm::kMoller);

/// Whether vector code sorts out the misses of a Sweep: moller and watertight in fp32. The sweep of
/// others takes longer, and a copy of the triangles.
[[nodiscard]] bool sweeps_fast(Algorithm algorithm, FpFormat format);

/// The records of a cast, computed in software; see Board::cast. Fast enough for large scenes (the
/// misses, nearly all pairs, are sorted out by vector code), the hits go through the template.
class Sweep {
 public:
  /// Up to `packet` rays meet all triangles at a time, or those of the objects (Board::set_objects;
  /// kUsage if their ranges do not lie within the triangles). Rays and triangles must outlive the
  /// sweep. `format`, here and below, is of the card, fp32 or a smaller one, which rounds rays,
  /// triangles and transforms to it. Error kUsage if no card has it. sweeps_fast() says which are
  /// fast.
  Sweep(const RayView& rays, const TriangleView& triangles, Mode mode, const Stencil& stencil = {},
        unsigned packet = card::kMostPrimaries, std::span<const Object> objects = {},
        bool box = false, FpFormat format = {}, Algorithm algorithm = Algorithm::kMoller);
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  /// The next records in the card's order; empty at the end. Valid until the next call.
  [[nodiscard]] std::span<const Record> next();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// All of them at once.
[[nodiscard]] std::vector<Record> cast(const RayView& rays, const TriangleView& triangles,
                                       Mode mode = Mode::kNearest, const Stencil& stencil = {},
                                       std::span<const Object> objects = {}, bool box = false,
                                       FpFormat format = {},
                                       Algorithm algorithm = Algorithm::kMoller);

/// Tells differences of rays and triangles. `command` is the start of a command that repeats the
/// query, e.g. "cde cast terrain --lanes 16". Rays and triangles must outlive the result.
[[nodiscard]] RecordCheck::Told told_of_rays(const RayView& rays, const TriangleView& triangles,
                                             std::string command);

/// A check against a Sweep of the same arguments, which must outlive the checker.
class Checker : public RecordCheck {
 public:
  Checker(const RayView& rays, const TriangleView& triangles, Mode mode, const Stencil& stencil,
          unsigned packet, std::string command, std::span<const Object> objects = {},
          bool box = false, FpFormat format = {}, Algorithm algorithm = Algorithm::kMoller);

 private:
  Checker(std::shared_ptr<Sweep> sweep, Told told);
};

}  // namespace cde::reference
