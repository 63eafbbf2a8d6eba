// SPDX-License-Identifier: Apache-2.0
#include "pair_failure.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "cde/explain/bundle.hpp"
#include "cde/reference/pairs.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRowsAround = 4;

/// Words of pair i: "0x3f800000 0x0 | ...".
std::string words_of(const FailedPair& p, std::size_t i) {
  std::string text;
  const auto words = [&](std::span<const std::uint64_t> all, unsigned n) {
    for (unsigned k = 0; k < n; ++k) {
      std::array<char, 40> word{};
      std::snprintf(word.data(), word.size(), "0x%0*llx", p.config.format.hex_digits(),
                    static_cast<unsigned long long>(all[i * n + k]));
      if (!text.empty() && !text.ends_with(' ')) text += ' ';
      text += word.data();
    }
  };
  words(p.a, primary_words(p.config.pair));
  text += " | ";
  words(p.b, secondary_words(p.config.pair));
  return text;
}

/// PAIR and the options of its pipe. Operator latencies have no option: they do not change the
/// bits.
std::string options_of(const FailedPair& p, bool lanes) {
  const PairConfig& c = p.config;
  std::string text = std::string(name(c.pair)) + " --format " + c.format.name() + " --arith " +
                     (c.arithmetic == Arithmetic::kRtl ? "rtl" : "host");
  if (lanes) text += " --lanes " + std::to_string(c.lanes);
  if (c.pair == Pair::kRayTriangle)
    text += " --algorithm " + std::string(name(c.algorithm)) + (c.box ? " --box" : " --no-box");
  else if (c.box)
    text += " --box";
  if (c.plane == PlaneSide::kHalfSpace) text += " --half-space";
  if (c.sat_interval != 1) text += " --sat-interval " + std::to_string(c.sat_interval);
  if (has_iterations(c.pair) && p.iterations != PairIterations{})
    text += " --iterations " + std::to_string(p.iterations.samples) + "," +
            std::to_string(p.iterations.circle) + "," + std::to_string(p.iterations.free);
  return text;
}

/// Runs pairs [first, end) in a pair unit of their own. Returns the first pair that differs.
std::optional<Failure> failure_of(const FailedPair& p, std::size_t first, std::size_t end) {
  const std::size_t aw = primary_words(p.config.pair), bw = secondary_words(p.config.pair);
  const auto some = [&](std::span<const std::uint64_t> all, std::size_t each) {
    const auto part = all.subspan(first * each, (end - first) * each);
    return std::vector<std::uint64_t>(part.begin(), part.end());
  };
  PairFailure f{.config = p.config,
                .iterations = p.iterations,
                .options = options_of(p, false),
                .a = some(p.a, aw),
                .b = some(p.b, bw)};
  std::vector<PairResult> card(end - first), expected(end - first);
  PairUnit unit(p.config);
  if (has_iterations(p.config.pair)) unit.set_iterations(p.iterations);
  unit.test(f.a, f.b, card);
  reference::test_pairs(p.config.pair, p.config.algorithm, p.config.format, f.a, f.b, expected,
                        p.config.plane, p.iterations, p.config.box);
  for (f.at = 0; f.at < card.size() && card[f.at] == expected[f.at];) ++f.at;
  if (f.at == card.size()) return std::nullopt;
  f.card = card[f.at], f.reference = expected[f.at];
  return Failure{.kind = f,
                 .message = "differ in " + differing_fields(f.card, f.reference) + "\n",
                 .repeat = query_line(p)};
}

}  // namespace

std::string quoted(const std::string& path) {
  std::string text = "'";
  for (const char c : path) {
    if (c == '\'') text += "'\\'";
    text += c;
  }
  return text + "'";
}

std::string test_name() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  if (test == nullptr) return "";
  std::string text = std::string(test->test_suite_name()) + "." + test->name();
  std::replace(text.begin(), text.end(), '/', '_');
  return text;
}

fs::path failures_folder() {
  const char* asked = std::getenv("CDE_FAILURES");
  return asked != nullptr && *asked != '\0' ? asked : CDE_FAILURES_DIR;
}

Ran run_shell(const std::string& command) {
  Ran ran;
  std::FILE* out = ::popen(command.c_str(), "r");
  if (out == nullptr) return ran;
  std::array<char, 256> piece{};
  while (std::fgets(piece.data(), piece.size(), out) != nullptr) ran.said += piece.data();
  const int status = ::pclose(out);
  if (WIFEXITED(status)) ran.status = WEXITSTATUS(status);
  return ran;
}

std::string query_line(const FailedPair& p) {
  return "echo '" + words_of(p, p.at) + "' | cde query " + options_of(p, true);
}

std::string explain_line(const FailedPair& p) {
  return "explain: cde explain " + options_of(p, false) + " '" + words_of(p, p.at) + "'";
}

std::string pack_failure(const FailedPair& p) {
  static std::string last;
  const std::string test = test_name();
  if (test == last) return "";
  last = test;
  std::error_code error;
  fs::create_directories(failures_folder(), error);
  if (error) return "  not packed: " + failures_folder().string() + ": " + error.message() + "\n";
  const std::size_t lanes = p.config.lanes, row = p.at / lanes,
                    pairs = p.a.size() / primary_words(p.config.pair);
  const std::size_t first = row > kRowsAround ? (row - kRowsAround) * lanes : 0,
                    end = std::min(pairs, (row + kRowsAround + 1) * lanes);
  try {
    std::optional<Failure> failure = failure_of(p, first, end);
    if (!failure && first > 0) failure = failure_of(p, 0, end);
    if (!failure)
      return "  not packed: these pairs alone give the answers of the reference: " + query_line(p) +
             "\n";
    const Packed packed = pack((failures_folder() / test).string(), *failure);
    return "  packed in:   " + packed.folder.string() +
           (packed.missing.empty() ? "" : ", incomplete: " + packed.missing) + "\n";
  } catch (const Error& e) {
    return std::string("  not packed: ") + e.what() + "\n";
  }
}

std::string failure_report(const FailedPair& p) {
  return "  " + query_line(p) + "\n  " + explain_line(p) + "\n" + pack_failure(p);
}

}  // namespace cde::testing
