// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/promise.hpp"

#include <fmt/format.h>

#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"

namespace cde::accuracy {
namespace {

constexpr double kSolids = 16;  // in u S (oracle/certificate.hpp)

Promise of_triangle(const AccuracyPipe& pipe) {
  switch (pipe.algorithm) {
    case Algorithm::kMoller:
      return {"F beyond moller_bound (fp32)", {}};
    case Algorithm::kBadouel:
      return {fmt::format("F beyond {} u (L + slim/4) / cos", reference::kBadouelBand), {}};
    case Algorithm::kPluecker:
      return {fmt::format("F beyond {} u L / cos", reference::kPlueckerBand), {}};
    case Algorithm::kWatertight:
      return {fmt::format("F beyond {} u R / cos, no leak", reference::kWatertightBand),
              {},
              true,
              true};
  }
  return {};
}

}  // namespace

Promise promise_of(const AccuracyPipe& pipe) {
  if (pipe.variant != Variant::kCard) return {"nothing", {}};
  if (pipe.pair == Pair::kRayTriangle) return of_triangle(pipe);
  if (pipe.pair == Pair::kRaySphere)
    return {fmt::format("T and F, {} u S", reference::kRaySphereBand), reference::kRaySphereBand,
            true, true};
  if (pipe.pair == Pair::kRayCylinder)
    return {fmt::format("T and F, {} u S", reference::kRayCylinderBand),
            reference::kRayCylinderBand, true, true};
  if (has_iterations(pipe.pair))
    return {fmt::format("F = 0 is right, {} u S", kSolids), {}, false, true};
  return {fmt::format("T and F, {} u S", kSolids), kSolids, true, true};
}

std::string promise_outcome(const Promise& promise, const Tally& found) {
  const std::uint64_t wrong = (promise.hits ? found.false_hits : 0) +
                              (promise.misses ? found.false_misses : 0) +
                              (promise.text.ends_with("no leak") ? found.leaks : 0);
  if (wrong != 0) return fmt::format("{} wrong", wrong);
  if (promise.t && found.t.largest() > *promise.t)
    return fmt::format("T by {:.3g} u S", found.t.largest());
  // Bounds in other units are not checked here. Neither are bounds below the oracle's own error.
  if (promise.t && found.oracle.quantile(0.99) > *promise.t) return "-";
  return promise.hits || promise.misses || promise.t ? "yes" : "-";
}

}  // namespace cde::accuracy
