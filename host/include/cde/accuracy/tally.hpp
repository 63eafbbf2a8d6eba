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

/// What a pipe's answers are worth, against the oracles.
namespace cde::accuracy {

/// A pipe, as far as its answers go.
struct AccuracyPipe {
  Pair pair = Pair::kRayTriangle;
  Algorithm algorithm = Algorithm::kMoller;
  bool box = false;
  FpFormat format = {};
  PairBudget budget = {};
  Variant variant = Variant::kCard;

  /// "ray-triangle moller box fp32", "obb-cylinder fp16 8,8,8", "obb-obb fp16 textbook".
  [[nodiscard]] std::string name() const;
  /// The same for `cde query`, behind its name.
  [[nodiscard]] std::string options() const;
  /// "echo 'WORDS OF A | WORDS OF B' | cde query PAIR OPTIONS" with words as hexfloats, as
  /// `cde explain --from-test` reads it, too. Empty for what no card has.
  [[nodiscard]] std::string repeat_command(std::span<const std::uint64_t> a,
                                           std::span<const std::uint64_t> b) const;
};

/// The case that an error, or a wrong decision, is largest of.
struct WorstCase {
  std::string family;
  std::uint64_t index = 0;  ///< in the family
  double size = 0;          ///< in u S; of a decision what must be displaced to make it right
  std::vector<std::uint64_t> a, b;

  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static WorstCase from_json(const nlohmann::ordered_json& json);
};

/// Answers nearer than this to the boundary are not judged, in u S.
inline constexpr double kBand = 16;

/// What was found of so many cases. u is the unit roundoff of the format, S the size of the pair
/// (oracle::scene_size, or a ray's RayAnswer::scale); the band is |s| <= 16 u S, of a ray a
/// displacement by as much.
struct Tally {
  std::uint64_t cases = 0;
  std::uint64_t refused = 0;      ///< by the input contract, once they are rounded to the format
  std::uint64_t not_numbers = 0;  ///< answered with infinities or NaNs, and not refused
  std::uint64_t hits = 0;         ///< answers with F = 1
  std::uint64_t undecided = 0;    ///< in the band, or nearer than the oracle can tell
  std::uint64_t undecided_differ = 0;  ///< of them those that F has otherwise than the oracle
  std::uint64_t false_hits = 0, false_misses = 0;  ///< beyond the band
  std::uint64_t leak_rays = 0, leaks = 0;  ///< rays from inside a closed mesh; those that left it
  ErrorCounts t;                           ///< of T, in u S
  ErrorCounts t_ulps;                      ///< in units of its last place
  ErrorCounts cp;      ///< witness points off their shapes in u (S + L/4), a ray's CP in u
  ErrorCounts n;       ///< |g(n) - s| in u S
  ErrorCounts oracle;  ///< how far the truth may be from the oracle's answer, in u S
  std::optional<WorstCase> worst_t, worst_decision,
      worst_leak;  ///< the first of those that are as large

  void add(const Tally& other);
  /// Cases whose F was judged: all but those refused, and rays of meshes.
  [[nodiscard]] std::uint64_t judged() const { return cases - refused - leak_rays; }

  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static Tally from_json(const nlohmann::ordered_json& json);
};

/// Operands of pairs, as words of a format and as the numbers that these are.
struct DrawnCases {
  std::vector<oracle::Case> cases;
  std::vector<std::uint64_t> a, b;
};
/// Cases of a family from the first on, drawn with the fractions of binary64 and the exponents of
/// binary32, and rounded, so that every format has the same ones.
[[nodiscard]] DrawnCases drawn(const AccuracyPipe& pipe, const oracle::Family& family,
                               std::uint64_t seed, std::uint64_t count);
/// What the mirror reference, and so the card, answers.
[[nodiscard]] std::vector<PairResult> answers(const AccuracyPipe& pipe, const DrawnCases& cases);

/// How far an answer is off, in u S: T, if it was judged, and a decision that is wrong.
struct Judged {
  std::optional<double> t, decision;
};
/// Adds what an answer is worth.
Judged judge(Tally& tally, const AccuracyPipe& pipe, const oracle::Case& words,
             const PairResult& answer);
/// The larger one is kept, of equals the one that is there.
void keep_worst(std::optional<WorstCase>& kept, const WorstCase& found);

/// Cases of a family from number `first` on.
[[nodiscard]] Tally measured(const AccuracyPipe& pipe, const oracle::Family& family,
                             std::uint64_t seed, std::uint64_t first, std::uint64_t count);

/// Names of the families of rays from inside a closed mesh, which ray-triangle has beside those of
/// the oracles.
[[nodiscard]] const std::vector<std::string>& leak_families();
/// So many rays of one of them from number `first` on, each against all triangles of an icosphere.
/// Rounding may leave a mesh that a ray does not start inside of: a leak is a ray that exact
/// arithmetic finds a triangle for, and the pipe none.
[[nodiscard]] Tally measured_leaks(const AccuracyPipe& pipe, const std::string& family,
                                   std::uint64_t seed, std::uint64_t first, std::uint64_t count);

}  // namespace cde::accuracy
