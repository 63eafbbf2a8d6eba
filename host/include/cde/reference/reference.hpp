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

/// @file
/// Mirror reference: computes what the card computes, operation by operation, in the same order
/// with the same roundings, so every bit must match. The library is compiled without contraction
/// (-ffp-contract=off). Code that includes the templates must be compiled likewise, because an FMA
/// rounds once where the hardware rounds twice. The templates are in reference/pipes/, one header
/// per pair.
namespace cde::reference {

/// One pair of the card, as the record of mode all. `box`, here and below, means that the card has
/// the box rule. `algorithm` is the card's.
[[nodiscard]] Record record_of(const Ray& ray, const Triangle& triangle, std::uint32_t primary,
                               std::uint32_t index, bool box = false,
                               Algorithm algorithm = Algorithm::kMoller);

/// Whether vector code handles the misses of a BruteForce: moller and watertight in fp32. Other
/// algorithms and formats take longer, and need a copy of the triangles.
[[nodiscard]] bool has_fast_brute_force(Algorithm algorithm, FpFormat format);

/// Records of a cast by brute force, computed in software; see Board::cast. It is fast enough for
/// large scenes: vector code handles the misses, which are nearly all pairs. Hits go through the
/// template.
class BruteForce {
 public:
  /// Each packet of `packet` rays is tested against all triangles, or against the triangles of the
  /// objects (Board::set_objects). Rays and triangles must outlive the object. `format`, here and
  /// below, is the card's: fp32 or a smaller one, to which rays, triangles and transforms are
  /// rounded. Function has_fast_brute_force() tells which are fast. Error kUsage if no card has the
  /// format, or a range of the objects exceeds the triangles.
  BruteForce(const RayView& rays, const TriangleView& triangles, Mode mode,
             const Stencil& stencil = {}, unsigned packet = card::kMostPrimaries,
             std::span<const Object> objects = {}, bool box = false, FpFormat format = {},
             Algorithm algorithm = Algorithm::kMoller);
  ~BruteForce();
  BruteForce(const BruteForce&) = delete;
  BruteForce& operator=(const BruteForce&) = delete;

  /// The next records in the card's order; empty at the end. Valid until the next call.
  [[nodiscard]] std::span<const Record> next();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// All records at once.
[[nodiscard]] std::vector<Record> cast(const RayView& rays, const TriangleView& triangles,
                                       Mode mode = Mode::kNearest, const Stencil& stencil = {},
                                       std::span<const Object> objects = {}, bool box = false,
                                       FpFormat format = {},
                                       Algorithm algorithm = Algorithm::kMoller);

/// Describes differences for rays and triangles. `command` is the start of a command that repeats
/// the query, e.g. "cde cast terrain --lanes 16". Rays and triangles must outlive the result.
[[nodiscard]] RecordCheck::ReportOptions ray_report(const RayView& rays,
                                                    const TriangleView& triangles,
                                                    std::string command);

/// A record check against a BruteForce with the same arguments, which must outlive it.
class Checker : public RecordCheck {
 public:
  Checker(const RayView& rays, const TriangleView& triangles, Mode mode, const Stencil& stencil,
          unsigned packet, std::string command, std::span<const Object> objects = {},
          bool box = false, FpFormat format = {}, Algorithm algorithm = Algorithm::kMoller);

 private:
  Checker(std::shared_ptr<BruteForce> brute_force, ReportOptions report);
};

}  // namespace cde::reference
