// SPDX-License-Identifier: Apache-2.0
// Every pipe against its mirror reference, bit for bit. Inputs are cases of the oracle's generators
// (half of them near the decision), random words, and bad input. Rows come with and without gaps.
// Runs cover both back ends, every format, and operators of one and of several cycles.
//
// Each pair runs in every format with the host's arithmetic, and with gates in fp32. CDE_FULL=1
// (tools/test --full) runs more cases. It also runs tests that are skipped otherwise: other
// iterations, operators of several cycles in gates, and fp64 with operators of one cycle.
// CDE_PAIRS restricts the run to pairs whose name contains it, CDE_CASES sets the number of cases,
// CDE_LANES the number of lanes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>

#include "cde/card/pair_unit.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/pipes/cylinder/schedule.hpp"
#include "cde/reference/pipes/scale.hpp"
#include "numerics/operators.hpp"
#include "pair_failure.hpp"
#include "printed.hpp"

namespace {

using cde::Algorithm;
using cde::Pair;
using cde::PairConfig;
using cde::PairResult;
using cde::testing::explain_line;
using cde::testing::FailedPair;
using cde::testing::pack_failure;
using cde::testing::query_line;

constexpr std::uint64_t kSeed = 20261121;

/// The configuration in a test's name: "obb_plane_half_space_fp32_host".
std::string label(const PairConfig& config) {
  std::ostringstream text;
  text << name(config.pair);
  if (config.pair == Pair::kRayTriangle) text << '_' << name(config.algorithm);
  if (config.box) text << "_box";
  if (config.plane == cde::PlaneSide::kHalfSpace) text << "_half_space";
  text << '_' << config.format.name()
       << (config.arithmetic == cde::Arithmetic::kRtl ? "_rtl" : "_host");
  std::string result = text.str();
  std::replace(result.begin(), result.end(), '-', '_');
  return result;
}

struct Operands {
  std::vector<std::uint64_t> a, b;
};

/// Turns the plane of the last pair over if the centre of the box is below it.
void face_the_box(const cde::oracle::Case& c, cde::FpFormat f, Operands& o) {
  double height = -c.b[3];
  for (std::size_t k = 0; k < 3; ++k) height += c.a[k] * c.b[k];
  if (height >= 0) return;
  for (std::size_t k = 0; k < 4; ++k)
    o.b.end()[-1 - static_cast<std::ptrdiff_t>(k)] ^= f.sign_bit();
}

/// Operand words in the format: `count` generator cases, starting with case `first`. In every
/// sixteenth case some words are special values of the format or cover its full range.
Operands operands(const PairConfig& config, std::size_t first, std::size_t count,
                  std::mt19937_64& random) {
  Operands o;
  const cde::FpFormat f = config.format;
  const auto special = [&]() -> std::uint64_t {
    const std::uint64_t all[] = {0,
                                 f.sign_bit(),
                                 1,
                                 f.infinity(),
                                 f.infinity() | f.sign_bit(),
                                 f.canonical_nan(),
                                 f.infinity() | 1,
                                 f.infinity() - 1,
                                 f.fraction_mask(),
                                 f.fraction_mask() + 1,
                                 f.encode(1.0)};
    return all[random() % std::size(all)];
  };
  for (std::size_t i = first; i < first + count; ++i) {
    // Every eighth case comes from a family of everyday shapes, each family in turn.
    const auto make = i % 8 == 7 ? cde::oracle::everyday : cde::oracle::generate;
    const cde::oracle::Case c =
        make(static_cast<cde::oracle::Pair>(config.pair), kSeed, i % 8 == 7 ? i / 8 : i,
             {.exp_bits = f.exp_bits, .man_bits = f.man_bits});
    const bool odd = i % 16 == 15;
    const auto push = [&](std::vector<std::uint64_t>& to, const std::vector<double>& from) {
      for (const double x : from) {
        std::uint64_t word = f.encode(x);
        if (odd && random() % 8 == 0)
          word = random() % 2 == 0 ? special() : random() & f.magnitude_mask();
        to.push_back(word);
      }
    };
    push(o.a, c.a);
    push(o.b, c.b);
    // A half-space keeps half of the separated boxes below a plane, so a quarter of the pairs.
    if (config.plane == cde::PlaneSide::kHalfSpace && i % 4 != 0) face_the_box(c, f, o);
  }
  return o;
}

std::string describe(const PairResult& r) {
  char text[200];
  std::snprintf(text, sizeof text, "F %d bad %d T %llx CP %llx %llx %llx n %llx %llx %llx", r.f,
                r.bad, static_cast<unsigned long long>(r.t),
                static_cast<unsigned long long>(r.cp[0]), static_cast<unsigned long long>(r.cp[1]),
                static_cast<unsigned long long>(r.cp[2]), static_cast<unsigned long long>(r.n[0]),
                static_cast<unsigned long long>(r.n[1]), static_cast<unsigned long long>(r.n[2]));
  return text;
}

/// Text about pair i, which differs: a command that repeats it, the fields, the place, and the
/// input of `cde explain`.
std::string difference(cde::PairUnit& unit, const Operands& o, std::size_t i, const PairResult& got,
                       const PairResult& expected, const cde::PairIterations& iterations = {}) {
  const FailedPair pair{unit.config(), o.a, o.b, i, iterations};
  return "  " + query_line(pair) + "\n  pipe      " + describe(got) + "\n  reference " +
         describe(expected) + "\n  differ in " + differing_fields(got, expected) +
         "\n  where     " + place_in_unit(unit, o.a, o.b, i) + "\n  " + explain_line(pair) + "\n";
}

/// The same text for a failing test, with a line about the failure package.
std::string failure(cde::PairUnit& unit, const Operands& o, std::size_t i, const PairResult& got,
                    const PairResult& expected, const cde::PairIterations& iterations = {}) {
  return difference(unit, o, i, got, expected, iterations) +
         pack_failure({unit.config(), o.a, o.b, i, iterations});
}

/// Cycles of the pipe with operators of one cycle, from the references; 0 for iterative pipelines.
unsigned pipe_latency(const PairConfig& config) {
  constexpr unsigned kBoxRule[] = {3, 0, 0, 2};  // cycles added, by Algorithm
  // Besides the depth in operators: the output register, and waits between the parts of a candidate
  // axis where a triangle meets a box or a triangle.
  constexpr unsigned kOutput = 1, kMeet = 4;
  if (config.latency != cde::OperatorLatencies{}) return 0;
  if (has_iterations(config.pair)) return 0;
  const bool meets = config.pair == Pair::kTriangleObb || config.pair == Pair::kTriangleAabb ||
                     config.pair == Pair::kTriangleTriangle;
  const bool ray = config.pair == Pair::kRayTriangle;
  const unsigned rule = !config.box ? 0
                        : ray       ? kBoxRule[static_cast<unsigned>(config.algorithm)]
                                    : 1;  // for solids, a comparison after the pipe
  return static_cast<unsigned>(cde::testing::operators(config.pair, config.algorithm).depth) +
         kOutput + (meets ? kMeet : 0) + rule;
}

/// That latency, plus three cycles for the largest exponent and the two shifts if the pair is
/// scaled.
unsigned stated_latency(const PairConfig& config) {
  const unsigned pipe = pipe_latency(config);
  const bool scaled = cde::reference::is_scaled(
      primary_shape(config.pair), secondary_shape(config.pair), config.format.exp_bits);
  return pipe == 0 || !scaled ? pipe : pipe + 3;
}

/// A configuration and its number of cases.
struct Parameter : PairConfig {
  std::size_t cases = 20000, full_cases = 1000000;  ///< by default, and with CDE_FULL
  /// Why the test runs only with CDE_FULL; empty if it always runs.
  const char* left_out = nullptr;

  /// ctest shows this text beside a test's name.
  friend void PrintTo(const Parameter& p, std::ostream* out) {
    for (const std::string& word : p.parameters()) *out << word << ' ';
  }
};

/// Loops of a pair through the iterative pipeline of a cylinder pair.
unsigned passes(Pair pair, const cde::PairIterations& iterations) {
  using cde::reference::cylinder::Body;
  const Body body = pair == Pair::kCylinderCylinder ? Body::kCylinder
                    : pair == Pair::kObbCylinder    ? Body::kBox
                                                    : Body::kTriangle;
  return static_cast<unsigned>(cde::reference::cylinder::passes(
      body, {static_cast<int>(iterations.samples), static_cast<int>(iterations.circle),
             static_cast<int>(iterations.free)}));
}

/// Rows in flight in a cylinder pipe: the cycles that one more loop adds to the latency.
unsigned rows_in_flight(cde::PairUnit& unit) {
  const Pair pair = unit.config().pair;
  const cde::PairIterations less{4, 0, 0}, more{4, 3, 0};
  unit.set_iterations(less);
  const unsigned start = unit.latency();
  unit.set_iterations(more);
  const unsigned added = passes(pair, more) - passes(pair, less);
  return added == 0 ? 0 : (unit.latency() - start) / added;
}

/// Cycles from the first input row to the last result, for rows without gaps. A pipelined pair unit
/// accepts one row per cycle. An iterative pipeline accepts one row per cycle until it is full, and
/// again when these rows have finished.
std::uint64_t stated_cycles(cde::PairUnit& unit, std::uint64_t rows,
                            const cde::PairIterations& iterations) {
  const std::uint64_t in_flight =
      cde::has_iterations(unit.config().pair) ? rows_in_flight(unit) : 0;
  if (in_flight == 0) return rows - 1 + unit.latency();
  unit.set_iterations(iterations);
  return (rows - 1) / in_flight * in_flight * passes(unit.config().pair, iterations) +
         (rows - 1) % in_flight + unit.latency();
}

bool full() {
  const char* value = std::getenv("CDE_FULL");
  return value != nullptr && std::string(value) != "0";
}

/// The reason to skip the test, if any.
std::optional<std::string> reason_to_skip(const Parameter& parameter) {
  const char* only = std::getenv("CDE_PAIRS");
  if (only != nullptr && std::string(name(parameter.pair)).find(only) == std::string::npos)
    return "CDE_PAIRS asks for others";
  if (parameter.left_out != nullptr && !full())
    return std::string(parameter.left_out) + ": left to CDE_FULL=1";
  return std::nullopt;
}

class PairPipe : public ::testing::TestWithParam<Parameter> {
 protected:
  /// Pairs per block, which are in memory together.
  static constexpr std::size_t kBlock = 20000;

  void compare(cde::PairUnit& unit, std::size_t first, std::size_t count);

  std::size_t hits_ = 0, bad_ = 0, wrong_ = 0;
  std::mt19937_64 words_{kSeed};
  std::mt19937 gaps_{1};
};

/// One block of cases, in rows without gaps and again with random gaps.
void PairPipe::compare(cde::PairUnit& unit, std::size_t first, std::size_t count) {
  const PairConfig& config = unit.config();
  const Operands o = operands(config, first, count, words_);
  std::vector<PairResult> expected(count), got(count), stalled(count);
  cde::reference::test_pairs(config.pair, config.algorithm, config.format, o.a, o.b, expected,
                             config.plane, {}, config.box);
  const std::uint64_t rows = (count + config.lanes - 1) / config.lanes;
  const std::uint64_t stated = stated_cycles(unit, rows, {});
  EXPECT_EQ(unit.test(o.a, o.b, got), stated);
  for (std::size_t i = 0; i < count; ++i) {
    hits_ += expected[i].f;
    bad_ += expected[i].bad;
    if (got[i] == expected[i]) continue;
    if (++wrong_ <= 3)
      ADD_FAILURE() << "case " << first + i << "\n" << failure(unit, o, i, got[i], expected[i]);
  }
  (void)unit.test(o.a, o.b, stalled, [this] { return gaps_() % 3 == 0 ? gaps_() % 4 : 0u; });
  EXPECT_TRUE(stalled == got) << "gaps between rows must not change results";
}

/// Witness points so close that fp16 has no direction between them. The card and the reference must
/// then agree on the result.
TEST(PairRegression, PointsTooCloseForADirection_EqualTheReference) {
  struct Line {
    cde::Pair pair;
    std::vector<double> a, b;
  };
  const Line lines[] = {
      {cde::Pair::kObbCylinder,
       {8, 10, 16, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1},
       {6, 9, 17.5, 0, 1, 0, 1, 1}},
      {cde::Pair::kObbCylinder,
       {32, 0, 60, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1},
       {33.25, 1.5, 58, 1, 0, 0, 1, 1}},
      {cde::Pair::kTriangleCylinder,
       {7.75, 0, 8, 9, 0, 8.5, 7.75, 1, 7},
       {7.75, -.5, 8.75, 1, 0, 0, 1, .5}},
      {cde::Pair::kTriangleCylinder,
       {0, 31, 60.5, 1, 32.75, 60, .5, 33, 59.25},
       {.5, 30.75, 61, 0, 1, 0, .25, .25}},
  };
  const cde::FpFormat fp16{5, 10};
  for (const Line& line : lines) {
    const auto words = [&](const std::vector<double>& from) {
      std::vector<std::uint64_t> to;
      for (const double x : from) to.push_back(fp16.encode(x));
      return to;
    };
    const std::vector<std::uint64_t> a = words(line.a), b = words(line.b);
    std::vector<PairResult> expected(1), got(1);
    const PairConfig config{.pair = line.pair, .format = fp16, .lanes = 1};
    cde::reference::test_pairs(line.pair, config.algorithm, fp16, a, b, expected);
    cde::PairUnit unit(config);
    (void)unit.test(a, b, got);
    EXPECT_EQ(got[0], expected[0]) << failure(unit, {a, b}, 0, got[0], expected[0]);
    EXPECT_FALSE(expected[0].f || expected[0].bad);
  }
}

/// Runs the line of a failure as a user would type it. Returns the exit status, then the output.
std::string typed(std::string line) {
  const std::string command = "cde query", end = "; echo $?";
  line.replace(line.find(command), command.size(), "'" CDE_COMMAND "' query");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(
      ::popen((line + " --bits -q 2>&1" + end).c_str(), "r"), ::pclose);
  std::string text;
  char piece[256];
  while (std::fgets(piece, sizeof piece, out.get()) != nullptr) text += piece;
  return text;
}

/// The failure text of a test is correct: `cde query` repeats the pair and prints the reference's
/// answer, and the text names the differing fields and the pair's place.
TEST(PairFailure, Message_RepeatsThePairAndNamesTheFields) {
  const std::vector<std::pair<PairConfig, cde::PairIterations>> all = {
      {{.pair = Pair::kSphereSphere}, {}},
      {{.pair = Pair::kSphereSphere, .format = {5, 10}, .lanes = 1}, {}},
      {{.box = true}, {}},
      {{.pair = Pair::kTriangleSphere, .box = true}, {}},
      {{.algorithm = Algorithm::kPluecker}, {}},
      {{.pair = Pair::kObbPlane, .plane = cde::PlaneSide::kHalfSpace}, {}},
      {{.pair = Pair::kCylinderCylinder}, {4, 0, 0}},
  };
  for (const auto& [config, iterations] : all) {
    const std::size_t count = 40, i = 27;
    std::mt19937_64 words(kSeed);
    const Operands o = operands(config, 0, count, words);
    std::vector<PairResult> expected(count), got(count);
    cde::reference::test_pairs(config.pair, config.algorithm, config.format, o.a, o.b, expected,
                               config.plane, iterations, config.box);
    cde::PairUnit unit(config);
    if (cde::has_iterations(config.pair)) unit.set_iterations(iterations);
    (void)unit.test(o.a, o.b, got);
    ASSERT_EQ(got, expected);
    PairResult wrong = got[i];
    wrong.f = !wrong.f;
    wrong.t ^= 1;
    wrong.cp[2] ^= 1;
    const std::string text = difference(unit, o, i, wrong, expected[i], iterations);
    SCOPED_TRACE(text);
    EXPECT_NE(text.find("\n  differ in F, T, CPz\n"), std::string::npos);
    const std::size_t row = i / config.lanes;
    EXPECT_NE(text.find("\n  where     cycle " + std::to_string(unit.latency() + row) + ", lane " +
                        std::to_string(i % config.lanes) + ", row " + std::to_string(row)),
              std::string::npos);
    const std::string line = text.substr(2, text.find('\n') - 2), answer = typed(line);
    EXPECT_NE(line.find(" | "), std::string::npos);
    char t[32];
    std::snprintf(t, sizeof t, "\n%d,0x%0*llx,", expected[i].f, config.format.hex_digits(),
                  static_cast<unsigned long long>(expected[i].t));
    EXPECT_NE(answer.find(t), std::string::npos) << answer;
    EXPECT_EQ(answer.substr(answer.size() - 2), "0\n") << answer;
    EXPECT_FALSE(expected[i].bad) << "the pair must be valid input";
    EXPECT_NE(text.find("\n  explain: cde explain " + std::string(name(config.pair))),
              std::string::npos);
  }
}

TEST_P(PairPipe, Pipe_EqualsItsReferenceBitForBit) {
  const Parameter& parameter = GetParam();
  if (const auto reason = reason_to_skip(parameter)) GTEST_SKIP() << *reason;
  PairConfig config = parameter;
  if (const char* lanes = std::getenv("CDE_LANES"); lanes != nullptr)
    config.lanes = static_cast<unsigned>(std::strtoul(lanes, nullptr, 10));
  const char* cases = std::getenv("CDE_CASES");
  const std::size_t count = cases != nullptr ? std::strtoull(cases, nullptr, 10)
                            : full()         ? parameter.full_cases
                                             : parameter.cases;
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
  const Clock::time_point start = Clock::now();
  cde::PairUnit unit(config);
  const Clock::time_point opened = Clock::now();
  if (const unsigned stated = stated_latency(config); stated != 0) {
    EXPECT_EQ(unit.latency(), stated);
  }
  for (std::size_t first = 0; first < count; first += kBlock)
    compare(unit, first, std::min(kBlock, count - first));

  EXPECT_EQ(wrong_, 0u) << "of " << count;
  std::printf(
      "%s: seed %llu, %zu pairs, %.1f %% hits, %zu bad input, latency %u; opened in %.1f s, "
      "run in %.1f s\n",
      label(config).c_str(), static_cast<unsigned long long>(kSeed), count,
      100.0 * static_cast<double>(hits_) / static_cast<double>(count), bad_, unit.latency(),
      seconds(opened - start), seconds(Clock::now() - opened));
  EXPECT_GE(hits_, count * 3 / 10);
  EXPECT_LE(hits_, count * 7 / 10);
  EXPECT_GT(bad_, 0u);
}

class CylinderIterations : public ::testing::TestWithParam<Parameter> {};

TEST_P(CylinderIterations, Iterations_SetTheWorkOfAPair) {
  if (const auto reason = reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
  const PairConfig config = GetParam();
  cde::PairUnit unit(config);
  const std::size_t count = 1500;
  std::mt19937_64 words(kSeed);
  const Operands o = operands(config, 0, count, words);
  std::vector<PairResult> before;
  for (const cde::PairIterations iterations : {cde::PairIterations{8, 8, 8},
                                               {4, 0, 0},
                                               {16, 3, 5},
                                               {4, 12, 1},
                                               {8, 0, 7},
                                               {16, 1, 0},
                                               {4, 64, 64}}) {
    SCOPED_TRACE(std::to_string(iterations.samples) + "," + std::to_string(iterations.circle) +
                 "," + std::to_string(iterations.free));
    std::vector<PairResult> expected(count), got(count), stalled(count);
    cde::reference::test_pairs(config.pair, config.algorithm, config.format, o.a, o.b, expected,
                               config.plane, iterations);
    const std::uint64_t rows = (count + config.lanes - 1) / config.lanes;
    const std::uint64_t stated = stated_cycles(unit, rows, iterations);
    unit.set_iterations(iterations);
    EXPECT_EQ(unit.test(o.a, o.b, got), stated);
    if (const auto [g, e] = std::mismatch(got.begin(), got.end(), expected.begin()); g != got.end())
      ADD_FAILURE() << failure(unit, o, static_cast<std::size_t>(g - got.begin()), *g, *e,
                               iterations);
    EXPECT_FALSE(got == before) << "other iterations must give other signed distances";
    std::mt19937 random(1);
    (void)unit.test(o.a, o.b, stalled,
                    [&random] { return random() % 9 == 0 ? random() % 99 : 0u; });
    EXPECT_TRUE(stalled == expected) << "gaps between rows must not change results";
    before = got;
  }
}

std::string test_name(const ::testing::TestParamInfo<Parameter>& info) {
  return label(info.param);
}

/// Every pipe once, as a PairConfig.
std::vector<PairConfig> pipes() {
  std::vector<PairConfig> all;
  for (unsigned p = 0; p < cde::kPairs; ++p)
    for (unsigned a = 0; a < 4; ++a) {
      const PairConfig config{.pair = static_cast<Pair>(p), .algorithm = static_cast<Algorithm>(a)};
      if (cde::reference::has_pair(config.pair, config.algorithm)) all.push_back(config);
    }
  for (std::size_t i = 0; i < all.size(); ++i)
    if (secondary_shape(all[i].pair) == cde::Shape::kPlane &&
        all[i].plane == cde::PlaneSide::kSurface)
      all.push_back({.pair = all[i].pair, .plane = cde::PlaneSide::kHalfSpace});
  return all;
}

/// Box and cylinder pairs, which have several times the operators of other pairs.
bool is_large(Pair pair) {
  return cde::has_iterations(pair) || pair == Pair::kObbObb || pair == Pair::kTriangleAabb ||
         pair == Pair::kTriangleObb || pair == Pair::kTriangleTriangle;
}

/// fp32, both back ends.
std::vector<Parameter> fp32() {
  std::vector<Parameter> all;
  for (const PairConfig& pipe : pipes()) {
    all.push_back({pipe});
    Parameter gates{pipe, is_large(pipe.pair) ? 2000u : 20000u, 200000};
    gates.arithmetic = cde::Arithmetic::kRtl;
    gates.lanes = 1;  // eight take two to three times as long to build
    if (pipe.pair == Pair::kTriangleObb)
      gates.left_out = "gates of triangle-obb, minutes to build: triangle-aabb has the same units";
    all.push_back(gates);
  }
  return all;
}

std::vector<Parameter> cylinder_pairs() {
  std::vector<Parameter> all;
  for (Parameter parameter : fp32()) {
    if (!cde::has_iterations(parameter.pair)) continue;
    if (parameter.arithmetic == cde::Arithmetic::kRtl)
      parameter.left_out = "other iterations in gates";
    all.push_back(parameter);
  }
  return all;
}

/// The other formats, with the back end that builds and runs fast. One lane: words that are not
/// floats are computed lane by lane, and clang needs minutes for eight such lanes.
std::vector<Parameter> other_formats() {
  std::vector<Parameter> all;
  unsigned turn = 0;
  for (const PairConfig& pipe : pipes()) {
    for (const cde::FpFormat format : cde::kPairFormats) {
      if (format == cde::FpFormat{}) continue;
      Parameter other{pipe, 2000, 20000};
      other.format = format;
      other.lanes = 1;
      if (format == cde::FpFormat{11, 52})
        other.left_out = "fp64 with operators of one clock (SlowOperators has it with slow ones)";
      else if (format != cde::FpFormat{5, 10} && turn++ % 3 != 0)
        other.left_out = "two of bf16, tf32 and fp24 a pipe";
      all.push_back(other);
    }
    // The next pipe runs in another of the three formats.
    ++turn;
  }
  return all;
}

/// Operators of several cycles, all different: every operand must still meet its partner. The
/// host's arithmetic runs in fp64, so that every pipe runs in that format; gates run in fp32.
std::vector<Parameter> slow_operators() {
  std::vector<Parameter> all;
  for (const PairConfig& pipe : pipes())
    for (const cde::Arithmetic arithmetic : {cde::Arithmetic::kHost, cde::Arithmetic::kRtl}) {
      Parameter slow{pipe, 2000, 20000};
      slow.lanes = 1;
      slow.arithmetic = arithmetic;
      slow.latency.add = 2;
      slow.latency.mul = 3;
      slow.latency.div = 7;
      slow.latency.sqrt = 11;
      slow.latency.compare = 4;
      if (arithmetic == cde::Arithmetic::kHost) slow.format = {11, 52};
      if (arithmetic == cde::Arithmetic::kRtl && pipe.pair != Pair::kSphereObb)
        slow.left_out = "gates with operators of several cycles, but for sphere-obb";
      all.push_back(slow);
    }
  return all;
}

/// The box rule in each of the four algorithms, and for triangles and solids: both back ends, words
/// wider than a vector's lane, and operators of several cycles.
std::vector<Parameter> box_rule() {
  std::vector<Parameter> all;
  for (unsigned a = 0; a < 4; ++a) {
    const PairConfig pipe{.algorithm = static_cast<Algorithm>(a), .box = true};
    all.push_back({pipe});
    Parameter gates{pipe, 4000, 200000};
    gates.arithmetic = cde::Arithmetic::kRtl;
    gates.lanes = 1;
    all.push_back(gates);
    Parameter half{pipe, 2000, 20000};
    half.format = {5, 10};
    half.lanes = 1;
    all.push_back(half);
    Parameter slow{pipe, 2000, 20000};
    slow.format = {11, 52};
    slow.lanes = 1;
    slow.latency.add = 2, slow.latency.mul = 3, slow.latency.div = 7, slow.latency.compare = 4;
    all.push_back(slow);
  }
  for (const Pair pair : {Pair::kTriangleSphere, Pair::kTriangleObb, Pair::kTriangleTriangle}) {
    const PairConfig pipe{.pair = pair, .box = true};
    Parameter host{pipe};
    if (pair == Pair::kTriangleTriangle)
      host.left_out = "triangle-triangle with the box rule, a card of which has tests";
    all.push_back(host);
    Parameter gates{pipe, 500, 20000};
    gates.arithmetic = cde::Arithmetic::kRtl;
    gates.lanes = 1;
    gates.latency.add = 2, gates.latency.compare = 3;
    if (pair != Pair::kTriangleSphere)
      gates.left_out = "gates of triangle-obb and triangle-triangle with the box rule";
    all.push_back(gates);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(BoxRule, PairPipe, ::testing::ValuesIn(box_rule()), test_name);
INSTANTIATE_TEST_SUITE_P(Fp32, PairPipe, ::testing::ValuesIn(fp32()), test_name);
INSTANTIATE_TEST_SUITE_P(Fp32, CylinderIterations, ::testing::ValuesIn(cylinder_pairs()),
                         test_name);
INSTANTIATE_TEST_SUITE_P(Formats, PairPipe, ::testing::ValuesIn(other_formats()), test_name);
INSTANTIATE_TEST_SUITE_P(SlowOperators, PairPipe, ::testing::ValuesIn(slow_operators()), test_name);

}  // namespace
