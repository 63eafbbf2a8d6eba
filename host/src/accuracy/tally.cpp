// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/tally.hpp"
#include <nlohmann/json.hpp>
#include "cde/costs/costed_pipe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "cde/fp/number_text.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/reference/pairs.hpp"

namespace cde::accuracy {
namespace {

// Binary64 fractions with the exponents of fp32: larger exponents exceed the contract of all other
// formats.
constexpr oracle::Format kDrawnIn{8, 52};
constexpr double kOracleRounding = 4 * 0x1p-53;

oracle::Format oracle_format(FpFormat format) {
  return {format.exp_bits, format.man_bits};
}

double ulp(const oracle::Format& format, double of) {
  return std::ldexp(1, format.last_place(of));
}

oracle::Vec vector(FpFormat format, const std::uint64_t (&words)[3]) {
  return {format.decode(words[0]), format.decode(words[1]), format.decode(words[2])};
}

/// Counts the decision, and returns whether it is wrong.
bool decide(Tally& tally, bool f, bool certain_hit, bool certain_miss, bool nearer_hit) {
  if (certain_hit) {
    tally.false_misses += f ? 0 : 1;
  } else if (certain_miss) {
    tally.false_hits += f ? 1 : 0;
  } else {
    ++tally.undecided;
    tally.undecided_differ += f == nearer_hit ? 0 : 1;
  }
  return (certain_hit && !f) || (certain_miss && f);
}

ResultErrors judge_solids(Tally& tally, const AccuracyPipe& pipe, const oracle::Case& words,
                          const PairResult& answer) {
  const oracle::Format format = oracle_format(pipe.format);
  const double u = format.u();
  const oracle::Result result{answer.f, pipe.format.decode(answer.t),
                              vector(pipe.format, answer.cp), vector(pipe.format, answer.n)};
  // The interval is u S / 64 wide where binary64 can resolve that and does so fast enough; else it
  // is wider.
  oracle::CheckOptions options{.u = u,
                               .distance = {std::max(1e-13, u / 64), 30000},
                               .lower_bound = oracle::has_cylinder(pipe.pair)};
  const oracle::Decision v = oracle::check(words.shape_a(), words.shape_b(), result, options);
  // The oracle computes in binary64. Far from the world's origin it cannot represent the middle of
  // a box or triangle exactly.
  const double slack =
      kOracleRounding * oracle::largest_coordinate(words.shape_a(), words.shape_b());
  const double tolerance = v.tolerance_t + slack, unit = u * v.scale;
  const bool certain_hit = -v.distance.hi > tolerance, certain_miss = v.distance.lo > tolerance;
  ResultErrors errors;
  if (decide(tally, answer.f, certain_hit, certain_miss, v.distance.middle() <= 0))
    errors.decision = (certain_hit ? -v.distance.hi : v.distance.lo) / unit;
  // S is 0 if all corners coincide; a zero error then stays zero.
  const auto in_units = [unit](double error) { return error == 0 ? 0 : error / unit; };
  if (unit > 0) tally.oracle.add(((v.distance.hi - v.distance.lo) / 2 + slack) / unit);
  if (!has_distance(pipe.pair, pipe.variant)) return errors;
  if (v.failure == oracle::Failure::kNotFinite) {
    ++tally.not_numbers;
    for (ErrorCounts* counts : {&tally.t, &tally.t_ulps, &tally.cp, &tally.n})
      counts->add(std::numeric_limits<double>::infinity());
    errors.t = std::numeric_limits<double>::infinity();
    return errors;
  }
  const double error_t = std::max(0.0, v.error_c2 - slack);
  errors.t = in_units(error_t);
  tally.t.add(*errors.t);
  tally.t_ulps.add(error_t / ulp(format, v.distance.middle()));
  tally.cp.add(std::max(v.witness_a, v.witness_b) / (v.tolerance_p / kBand));
  tally.n.add(in_units(std::max(0.0, v.error_c1 - slack)));
  return errors;
}

ResultErrors judge_ray(Tally& tally, const AccuracyPipe& pipe, const oracle::Case& words,
                       const PairResult& answer) {
  const oracle::Format format = oracle_format(pipe.format);
  const double u = format.u(), band = kBand * u;
  const oracle::RayAnswer exact = oracle::cast(words);
  const double t = pipe.format.decode(answer.t);
  const oracle::RayDecision v =
      oracle::check(words.ray(), exact, answer.f, t, vector(pipe.format, answer.cp), band, band);
  ResultErrors errors;
  if (decide(tally, answer.f, exact.hit && !v.in_band, !exact.hit && !v.in_band, exact.hit))
    errors.decision = exact.margin / u;
  tally.not_numbers += answer.f && !std::isfinite(t) ? 1 : 0;
  // If the answer is another crossing, or the ray is tangent, the error of T is not a rounding
  // error.
  if (!answer.f || !exact.hit || exact.margin_t <= band || exact.cosine * exact.cosine <= band)
    return errors;
  errors.t = v.error_t / u;
  tally.t.add(*errors.t);
  tally.t_ulps.add(std::abs(t - exact.t) / ulp(format, exact.t));
  tally.cp.add(v.error_point / u);
  return errors;
}

/// Passes every counter and error count to `use`, with its name in files of accuracy runs.
template <class Use>
void each_count(Use use) {
  use("cases", &Tally::cases), use("refused", &Tally::refused);
  use("not_numbers", &Tally::not_numbers), use("hits", &Tally::hits);
  use("undecided", &Tally::undecided), use("undecided_differ", &Tally::undecided_differ);
  use("false_hits", &Tally::false_hits), use("false_misses", &Tally::false_misses);
  use("leak_rays", &Tally::leak_rays), use("leaks", &Tally::leaks);
}
template <class Use>
void each_error(Use use) {
  use("t", &Tally::t), use("t_ulps", &Tally::t_ulps), use("cp", &Tally::cp);
  use("n", &Tally::n), use("oracle", &Tally::oracle);
}
template <class Use>
void each_worst(Use use) {
  use("worst_t", &Tally::worst_t), use("worst_decision", &Tally::worst_decision);
  use("worst_leak", &Tally::worst_leak);
}

}  // namespace

std::string AccuracyPipe::name() const {
  std::string text = PipeChoice{pair, algorithm, box, format, iterations}.name();
  if (variant != Variant::kCard) text += fmt::format(" {}", accuracy::name(variant));
  return text;
}

std::string AccuracyPipe::options() const {
  std::string text(cde::name(pair));
  if (pair == Pair::kRayTriangle)
    text += fmt::format(" --algorithm {} {}", cde::name(algorithm), box ? "--box" : "--no-box");
  text += fmt::format(" --format {}", format.name());
  if (has_iterations(pair))
    text += fmt::format(" --iterations {},{},{}", iterations.samples, iterations.circle,
                        iterations.free);
  return text;
}

std::string AccuracyPipe::repeat_command(std::span<const std::uint64_t> a,
                                         std::span<const std::uint64_t> b) const {
  if (variant != Variant::kCard) return {};
  const WordText text(format);
  std::string words;
  for (const std::uint64_t word : a) words += text.hexfloat(word) + ' ';
  words += '|';
  for (const std::uint64_t word : b) words += ' ' + text.hexfloat(word);
  return fmt::format("echo '{}' | cde query {}", words, options());
}

nlohmann::ordered_json WorstCase::to_json() const {
  // JSON cannot represent an infinite size: it becomes null.
  return {{"family", family}, {"index", index}, {"size", size}, {"a", a}, {"b", b}};
}

WorstCase WorstCase::from_json(const nlohmann::ordered_json& json) {
  WorstCase worst;
  json.at("family").get_to(worst.family);
  json.at("index").get_to(worst.index);
  const auto& size = json.at("size");
  worst.size = size.is_null() ? std::numeric_limits<double>::infinity() : size.get<double>();
  json.at("a").get_to(worst.a);
  json.at("b").get_to(worst.b);
  return worst;
}

void keep_worst(std::optional<WorstCase>& kept, const WorstCase& found) {
  if (!kept || found.size > kept->size) kept = found;
}

void Tally::add(const Tally& other) {
  each_count([&](const char*, auto member) { this->*member += other.*member; });
  each_error([&](const char*, auto member) { (this->*member).add(other.*member); });
  each_worst([&](const char*, auto member) {
    if (other.*member) keep_worst(this->*member, *(other.*member));
  });
}

nlohmann::ordered_json Tally::to_json() const {
  nlohmann::ordered_json json;
  each_count([&](const char* key, auto member) { json[key] = this->*member; });
  each_error([&](const char* key, auto member) { json[key] = (this->*member).to_json(); });
  each_worst([&](const char* key, auto member) {
    json[key] = this->*member ? (this->*member)->to_json() : nlohmann::ordered_json();
  });
  return json;
}

Tally Tally::from_json(const nlohmann::ordered_json& json) {
  Tally tally;
  each_count([&](const char* key, auto member) { json.at(key).get_to(tally.*member); });
  each_error(
      [&](const char* key, auto member) { tally.*member = ErrorCounts::from_json(json.at(key)); });
  each_worst([&](const char* key, auto member) {
    if (!json.at(key).is_null()) tally.*member = WorstCase::from_json(json.at(key));
  });
  return tally;
}

DrawnCases drawn(const AccuracyPipe& pipe, const oracle::Family& family, std::uint64_t seed,
                 std::uint64_t count) {
  const oracle::Format format = oracle_format(pipe.format);
  DrawnCases all;
  const auto round = [&](std::vector<double>& numbers, std::vector<std::uint64_t>& words) {
    for (double& x : numbers) {
      x = format.round(x);
      words.push_back(pipe.format.encode(x));
    }
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    oracle::Case c = family.at(pipe.pair, seed, i, kDrawnIn);
    round(c.a, all.a);
    round(c.b, all.b);
    all.cases.push_back(std::move(c));
  }
  return all;
}

std::vector<PairResult> answers(const AccuracyPipe& pipe, const DrawnCases& cases) {
  std::vector<PairResult> results(cases.cases.size());
  if (pipe.variant != Variant::kCard) {
    test_variant(pipe.variant, pipe.pair, pipe.algorithm, pipe.format, cases.a, cases.b, results,
                 pipe.iterations, pipe.box);
    return results;
  }
  reference::test_pairs(pipe.pair, pipe.algorithm, pipe.format, cases.a, cases.b, results,
                        PlaneSide::kSurface, pipe.iterations, pipe.box);
  return results;
}

ResultErrors judge(Tally& tally, const AccuracyPipe& pipe, const oracle::Case& words,
                   const PairResult& answer) {
  ++tally.cases;
  tally.hits += answer.f ? 1 : 0;
  if (answer.bad) {
    ++tally.refused;
    return {};
  }
  return is_solid(pipe.pair) ? judge_solids(tally, pipe, words, answer)
                             : judge_ray(tally, pipe, words, answer);
}

Tally measured(const AccuracyPipe& pipe, const oracle::Family& family, std::uint64_t seed,
               std::uint64_t first, std::uint64_t count) {
  oracle::Family some = family;
  some.first += first * family.step;
  const DrawnCases cases = drawn(pipe, some, seed, count);
  const std::vector<PairResult> results = answers(pipe, cases);
  Tally tally;
  const std::size_t a_words = primary_words(pipe.pair), b_words = secondary_words(pipe.pair);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const ResultErrors errors = judge(tally, pipe, cases.cases[i], results[i]);
    const auto keep = [&](std::optional<WorstCase>& kept, const std::optional<double>& size) {
      if (!size || (kept && kept->size >= *size)) return;
      const auto a = std::span(cases.a).subspan(i * a_words, a_words),
                 b = std::span(cases.b).subspan(i * b_words, b_words);
      keep_worst(kept, {family.name, first + i, *size, {a.begin(), a.end()}, {b.begin(), b.end()}});
    };
    keep(tally.worst_t, errors.t);
    keep(tally.worst_decision, errors.decision);
  }
  return tally;
}

}  // namespace cde::accuracy
