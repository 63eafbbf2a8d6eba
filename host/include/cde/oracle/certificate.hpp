// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/oracle/gap.hpp"

namespace cde::oracle {

/// What a pipe says about a convex pair.
struct Result {
  bool f;  ///< contact: s <= 0
  double t;
  Vec cp, n;
};

struct CheckOptions {
  double u = 0x1p-24;  ///< unit roundoff of the format under test
  GapOptions gap = {};
  /// The result is s_K <= s, the best g of a bounded list of normals: a shortfall, a false hit and
  /// the distances of the witness points are figures to publish, not failures. Everything else is
  /// checked as ever, so F = 0 stays a proof.
  bool lower_bound = false;
};

/// Why a result fails; kNone if it does not.
enum class Failure {
  kNone,
  kNotFinite,      ///< T, CP or n is NaN or infinite
  kNegativeT,      ///< T < 0
  kNotUnit,        ///< ||n| - 1| > 16 u
  kFlag,           ///< F is wrong although |s| > tolT
  kCertificate,    ///< |g(n) - s| > tolT (c1)
  kOutside,        ///< s is farther than tolT from the oracle's interval (c2); for a lower bound:
                   ///< above it
  kWitness,        ///< a witness point is farther than tolP from its shape (c3)
  kOracleTooWide,  ///< hi - lo > tolT: the oracle cannot judge this pair
};
[[nodiscard]] const char* to_string(Failure failure);

/// Everything is in units of the scene. s is the signed gap of the result, -T if F, else T.
struct Verdict {
  Failure failure = Failure::kNone;  ///< the first condition that fails, in the order of the enum
  double excess = 0;                 ///< by how much that condition misses its tolerance
  bool excused = false;    ///< the pair is within tolT of touching and F differs from what the
                           ///< middle of the interval says: not a failure, to be counted
  bool in_band = false;    ///< the pair is within tolT of touching
  bool false_hit = false;  ///< F = 1 although s > tolT: for a lower bound, to be counted
  double error_c1 = 0;     ///< |g(n) - s|
  double error_c2 = 0;     ///< distance of s from the interval
  double witness_a = 0;    ///< distance of CP - s n / 2 from A
  double witness_b = 0;    ///< distance of CP + s n / 2 from B
  double shortfall = 0;    ///< max(0, lo - s): how far s is certainly too low
  double scale = 0;        ///< S
  double tolerance_t = 0;  ///< 16 u S
  double tolerance_p = 0;  ///< tolerance_t + 4 u L
  Gap gap{};               ///< the oracle's answer

  [[nodiscard]] bool ok() const { return failure == Failure::kNone; }
  /// One line with every figure, for a test's message.
  [[nodiscard]] std::string describe() const;
};

/// Judges a result by its certificate, never by another algorithm's CP or n.
[[nodiscard]] Verdict check(const Shape& a, const Shape& b, const Result& result,
                            const CheckOptions& options = {});

}  // namespace cde::oracle
