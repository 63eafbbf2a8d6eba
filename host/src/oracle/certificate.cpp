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

void fail(Verdict& verdict, Failure failure, double excess) {
  if (verdict.failure != Failure::kNone || !(excess > 0)) return;
  verdict.failure = failure;
  verdict.excess = excess;
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

std::string Verdict::describe() const {
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

Verdict check(const Shape& a, const Shape& b, const Result& result, const CheckOptions& options) {
  Verdict verdict;
  verdict.scale = scene_size(a, b);
  const double tol_t = verdict.tolerance_t = 16 * options.u * verdict.scale;
  const double tol_p = verdict.tolerance_p = tol_t + 4 * options.u * largest_coordinate(a, b);
  const SignedDistance bounds = verdict.distance = signed_distance(a, b, options.distance);
  verdict.in_band = bounds.lo <= tol_t && bounds.hi >= -tol_t;

  if (!std::isfinite(result.t) || !result.cp.allFinite() || !result.n.allFinite()) {
    fail(verdict, Failure::kNotFinite, std::numeric_limits<double>::infinity());
    return verdict;
  }
  fail(verdict, Failure::kNegativeT, -result.t);
  fail(verdict, Failure::kNotUnit, std::abs(result.n.norm() - 1) - 16 * options.u);

  verdict.false_hit = result.f && bounds.lo > tol_t;
  const bool false_miss = !result.f && bounds.hi < -tol_t;
  if (false_miss || (verdict.false_hit && !options.lower_bound))
    fail(verdict, Failure::kFlag, std::max(bounds.lo, -bounds.hi));
  verdict.excused = verdict.in_band && result.f != (bounds.middle() <= 0);

  const double s = result.f ? -result.t : result.t;
  verdict.shortfall = std::max(0.0, bounds.lo - s);
  if (result.n.norm() > 0) {
    const Vec n = snapped_to_plane(a, b, result.n.normalized(), 16 * options.u);
    verdict.error_c1 = std::abs(distance_along(a, b, n) - s);
    fail(verdict, Failure::kCertificate, verdict.error_c1 - tol_t);
  }
  verdict.error_c2 = std::max({0.0, bounds.lo - s, s - bounds.hi});
  fail(verdict, Failure::kOutside,
       (options.lower_bound ? std::max(0.0, s - bounds.hi) : verdict.error_c2) - tol_t);

  verdict.witness_a = distance(result.cp - 0.5 * s * result.n, a);
  verdict.witness_b = distance(result.cp + 0.5 * s * result.n, b);
  if (!options.lower_bound)
    fail(verdict, Failure::kWitness, std::max(verdict.witness_a, verdict.witness_b) - tol_p);
  fail(verdict, Failure::kOracleTooWide, bounds.hi - bounds.lo - tol_t);
  return verdict;
}

}  // namespace cde::oracle
