// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace cde::oracle {
namespace {

/// Replaces n by the plane's normal if it is within `angle` of it. A plane has a finite signed
/// distance only along its normal, so the rounded n stands for the normal.
Vec snapped_to_plane(const Shape& a, const Shape& b, const Vec& n, double angle) {
  const auto* plane = std::get_if<Plane>(&a);
  if (!plane) plane = std::get_if<Plane>(&b);
  if (!plane) return n;
  const Vec normal = plane->n.normalized();
  const Vec facing = n.dot(normal) < 0 ? Vec(-normal) : normal;
  return (n - facing).norm() <= angle ? facing : n;
}

void fail(Decision& decision, Failure failure, double excess) {
  if (decision.failure != Failure::kNone || !(excess > 0)) return;
  decision.failure = failure;
  decision.excess = excess;
}

}  // namespace

const char* to_string(Failure failure) {
  switch (failure) {
    case Failure::kNone:
      return "none";
    case Failure::kNotFinite:
      return "not finite";
    case Failure::kNegativeT:
      return "negative T";
    case Failure::kNotUnit:
      return "n is not unit";
    case Failure::kCertificate:
      return "c1, g(n) is not s";
    case Failure::kOutside:
      return "c2, s outside the interval";
    case Failure::kFlag:
      return "wrong F";
    case Failure::kWitness:
      return "c3, witness point off its shape";
    case Failure::kOracleTooWide:
      return "oracle's interval too wide";
  }
  return "?";
}

std::string Decision::describe() const {
  std::ostringstream out;
  out.precision(9);
  out << to_string(failure);
  if (!ok()) out << " by " << excess;
  out << "; oracle s in [" << distance.lo << ", " << distance.hi << "], |g(n) - s| " << error_c1
      << ", s off the interval by " << error_c2 << ", witness A " << witness_a << " B " << witness_b
      << " off, tolT " << tolerance_t << ", tolP " << tolerance_p << ", S " << scale;
  if (in_band) out << ", in the band";
  return out.str();
}

Decision check(const Shape& a, const Shape& b, const Result& result, const CheckOptions& options) {
  Decision decision;
  decision.scale = scene_size(a, b);
  const double tol_t = decision.tolerance_t = 16 * options.u * decision.scale;
  const double tol_p = decision.tolerance_p = tol_t + 4 * options.u * largest_coordinate(a, b);
  const SignedDistance bounds = decision.distance = signed_distance(a, b, options.distance);
  decision.in_band = bounds.lo <= tol_t && bounds.hi >= -tol_t;

  if (!std::isfinite(result.t) || !result.cp.allFinite() || !result.n.allFinite()) {
    fail(decision, Failure::kNotFinite, std::numeric_limits<double>::infinity());
    return decision;
  }
  fail(decision, Failure::kNegativeT, -result.t);
  fail(decision, Failure::kNotUnit, std::abs(result.n.norm() - 1) - 16 * options.u);

  decision.false_hit = result.f && bounds.lo > tol_t;
  const bool false_miss = !result.f && bounds.hi < -tol_t;
  if (false_miss || (decision.false_hit && !options.lower_bound))
    fail(decision, Failure::kFlag, std::max(bounds.lo, -bounds.hi));
  decision.excused = decision.in_band && result.f != (bounds.middle() <= 0);

  const double s = result.f ? -result.t : result.t;
  decision.shortfall = std::max(0.0, bounds.lo - s);
  if (result.n.norm() > 0) {
    const Vec n = snapped_to_plane(a, b, result.n.normalized(), 16 * options.u);
    decision.error_c1 = std::abs(distance_along(a, b, n) - s);
    fail(decision, Failure::kCertificate, decision.error_c1 - tol_t);
  }
  decision.error_c2 = std::max({0.0, bounds.lo - s, s - bounds.hi});
  fail(decision, Failure::kOutside,
       (options.lower_bound ? std::max(0.0, s - bounds.hi) : decision.error_c2) - tol_t);

  decision.witness_a = distance(result.cp - 0.5 * s * result.n, a);
  decision.witness_b = distance(result.cp + 0.5 * s * result.n, b);
  if (!options.lower_bound)
    fail(decision, Failure::kWitness, std::max(decision.witness_a, decision.witness_b) - tol_p);
  fail(decision, Failure::kOracleTooWide, bounds.hi - bounds.lo - tol_t);
  return decision;
}

}  // namespace cde::oracle
