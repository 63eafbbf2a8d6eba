// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/accuracy/error_counts.hpp"
#include "cde/accuracy/variant.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/oracle/families.hpp"
#include "cde/query/pair_result.hpp"

/// @file
/// Quality of a pipe's results, judged by the oracles.
namespace cde::accuracy {

/// A pipe, reduced to what its results depend on.
struct AccuracyPipe {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  PairIterations iterations = {};
  Variant variant = Variant::kCard;

  /// "ray-triangle moller box fp32", "obb-cylinder fp16 8,8,8", "obb-obb fp16 textbook".
  [[nodiscard]] std::string name() const;
  /// Options of `cde query` for the pipe, which follow its pair name.
  [[nodiscard]] std::string options() const;
  /// "echo 'WORDS OF A | WORDS OF B' | cde query PAIR OPTIONS" with words as hexfloats. `cde
  /// explain --from-test` also reads it. Empty for variants that no card has.
  [[nodiscard]] std::string repeat_command(std::span<const std::uint64_t> a,
                                           std::span<const std::uint64_t> b) const;
};

/// The case with the largest error, or the worst wrong decision.
struct WorstCase {
  std::string family;
  std::uint64_t index = 0;  ///< within the family
  double size = 0;          ///< in u S; for a decision, the displacement that would make it right
  std::vector<std::uint64_t> a, b;

  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static WorstCase from_json(const nlohmann::ordered_json& json);
};

/// Results nearer to the boundary than this are not judged, in u S.
inline constexpr double kBand = 16;

/// Statistics over cases. u is the unit roundoff of the format. S is the size of the pair
/// (oracle::scene_size, or a ray's RayAnswer::scale). The band is |s| <= 16 u S; for a ray it is a
/// displacement of 16 u S.
struct Tally {
  std::uint64_t cases = 0;
  std::uint64_t refused = 0;           ///< by the input contract, after rounding to the format
  std::uint64_t not_numbers = 0;       ///< not refused, with infinities or NaNs as result
  std::uint64_t hits = 0;              ///< results with F = 1
  std::uint64_t undecided = 0;         ///< within the band, or nearer than the oracle can tell
  std::uint64_t undecided_differ = 0;  ///< undecided cases for which F differs from the oracle
  std::uint64_t false_hits = 0, false_misses = 0;  ///< outside the band
  std::uint64_t leak_rays = 0, leaks = 0;  ///< rays from inside a closed mesh; those that left it
  ErrorCounts t;                           ///< error of T, in u S
  ErrorCounts t_ulps;                      ///< error of T in units of its last place
  ErrorCounts cp;  ///< distance of witness points from their shapes in u (S + L/4); a ray's CP in u
  ErrorCounts n;   ///< |g(n) - s| in u S
  ErrorCounts oracle;  ///< uncertainty of the oracle, in u S
  std::optional<WorstCase> worst_t, worst_decision,
      worst_leak;  ///< the first case of the largest size

  void add(const Tally& other);
  /// Cases whose F was judged: all except refused ones and rays of meshes.
  [[nodiscard]] std::uint64_t judged() const { return cases - refused - leak_rays; }

  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static Tally from_json(const nlohmann::ordered_json& json);
};

/// Operands of pairs, as words of a format and as the numbers that they represent.
struct DrawnCases {
  std::vector<oracle::Case> cases;
  std::vector<std::uint64_t> a, b;
};
/// The first cases of a family. They are drawn with fractions of binary64 and exponents of binary32
/// and then rounded, so that every format gets the same cases.
[[nodiscard]] DrawnCases drawn(const AccuracyPipe& pipe, const oracle::Family& family,
                               std::uint64_t seed, std::uint64_t count);
/// Results of the mirror reference, equal to the results of the card.
[[nodiscard]] std::vector<PairResult> answers(const AccuracyPipe& pipe, const DrawnCases& cases);

/// Errors of a result in u S: of T if it was judged, and of a wrong decision.
struct ResultErrors {
  std::optional<double> t, decision;
};
/// Judges a result and adds it to the tally.
ResultErrors judge(Tally& tally, const AccuracyPipe& pipe, const oracle::Case& words,
                   const PairResult& answer);
/// Keeps the larger case; of equal ones the earlier.
void keep_worst(std::optional<WorstCase>& kept, const WorstCase& found);

/// Statistics of a family's cases from number `first` on.
[[nodiscard]] Tally measured(const AccuracyPipe& pipe, const oracle::Family& family,
                             std::uint64_t seed, std::uint64_t first, std::uint64_t count);

/// Names of the families of rays from inside a closed mesh. Ray-triangle has them in
/// addition to the families of the oracles.
[[nodiscard]] const std::vector<std::string>& leak_families();
/// Statistics of `count` rays of a family from number `first` on, each against all triangles of an
/// icosphere. After rounding, a ray may no longer start inside the mesh. A leak is therefore a ray
/// for which exact arithmetic finds a triangle and the pipe finds none.
[[nodiscard]] Tally measured_leaks(const AccuracyPipe& pipe, const std::string& family,
                                   std::uint64_t seed, std::uint64_t first, std::uint64_t count);

}  // namespace cde::accuracy
