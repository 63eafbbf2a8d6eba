// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/oracle/signed_distance.hpp"

namespace cde::oracle {

/// Result of a pipe for a convex pair.
struct Result {
  bool f;  ///< contact: s <= 0
  double t;
  Vec cp, n;
};

struct CheckOptions {
  double u = 0x1p-24;  ///< unit roundoff of the format under test
  DistanceOptions distance = {};
  /// The result is a lower bound s_K <= s, the best g of a bounded list of normals. A shortfall, a
  /// false hit and the distances of the witness points are then figures to publish, not failures.
  /// All other checks stay, so F = 0 is still a proof.
  bool lower_bound = false;
};

/// Why a result fails; kNone if it passes.
enum class Failure {
  kNone,
  kNotFinite,    ///< T, CP or n is NaN or infinite
  kNegativeT,    ///< T < 0
  kNotUnit,      ///< ||n| - 1| > 16 u
  kFlag,         ///< F is wrong and |s| > tolT
  kCertificate,  ///< |g(n) - s| > tolT (c1)
  kOutside,      ///< s is outside the oracle's interval by more than tolT (c2); for a lower bound:
                 ///< above it
  kWitness,      ///< a witness point is farther than tolP from its shape (c3)
  kOracleTooWide,  ///< hi - lo > tolT: the oracle is too inaccurate for this pair
};
[[nodiscard]] const char* to_string(Failure failure);

/// Lengths are in the unit of the scene. s is the signed distance of the result: -T if F, else T.
struct Decision {
  Failure failure = Failure::kNone;  ///< first condition that fails, in the order of the enum
  double excess = 0;                 ///< by how much the condition exceeds its tolerance
  bool excused = false;    ///< the pair is within tolT of touching and F differs from the middle of
                           ///< the interval: counted, not a failure
  bool in_band = false;    ///< the pair is within tolT of touching
  bool false_hit = false;  ///< F = 1 and s > tolT: counted for a lower bound
  double error_c1 = 0;     ///< |g(n) - s|
  double error_c2 = 0;     ///< distance of s from the interval
  double witness_a = 0;    ///< distance of CP - s n / 2 from A
  double witness_b = 0;    ///< distance of CP + s n / 2 from B
  double shortfall = 0;    ///< max(0, lo - s): by how much s is certainly too low
  double scale = 0;        ///< S
  double tolerance_t = 0;  ///< 16 u S
  double tolerance_p = 0;  ///< tolerance_t + 4 u L
  SignedDistance distance{};  ///< the oracle's result

  [[nodiscard]] bool ok() const { return failure == Failure::kNone; }
  /// One line with all figures, for test messages.
  [[nodiscard]] std::string describe() const;
};

/// Checks a result by its certificate, never by another algorithm's CP or n.
[[nodiscard]] Decision check(const Shape& a, const Shape& b, const Result& result,
                             const CheckOptions& options = {});

}  // namespace cde::oracle
