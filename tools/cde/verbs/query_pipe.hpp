// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/geometry/operand_line.hpp"
#include "cde/io/pair_array.hpp"
#include "cde/jobs/dealing.hpp"
#include "cde/support/error.hpp"
#include "options/pair_options.hpp"
#include "options/trace_options.hpp"
#include "program/pack_failure.hpp"

/// The pairs of `cde query`: from lines of text to lines of text.
namespace cde::cli {

inline constexpr std::size_t kQueryBatch = 65536;  ///< pairs, at most, between two runs of the unit
inline constexpr std::size_t kQueryTraced = 4096;  ///< and of all, where there are waves of them
inline constexpr std::size_t kQueryFailures = 100;  ///< told one by one, with --keep-going

struct QueryOptions : PairOptions {
  TraceRequest trace;
  BundleRequest bundle;
  DealOptions deal;
  std::string file = "-", output = "-";
  bool bits = false, check = true, keep_going = false, json = false, quiet = false;
};

/// "line 7", "pairs.csv:7", "pair 7" or "pairs.npy: pair 7": a pair of an array or a line of a
/// text.
[[nodiscard]] std::string place_of(const QueryOptions& options, bool array, std::uint64_t number);

struct QueryTotals {
  std::uint64_t pairs = 0, hits = 0, bad = 0, malformed = 0, clocks = 0, compared = 0, differ = 0;
  double simulation_seconds = 0;
  QueryTotals& operator+=(const QueryTotals& other);
};

/// What comes of some lines.
struct QueryAnswers {
  QueryTotals totals;
  std::string messages;  ///< about lines, each with its end
  /// About the first kQueryFailures answers that differ from the reference, and how to repeat each.
  std::vector<std::string> failures;
  std::string rows;  ///< CSV
};

/// One pipe and lines for it.
class QueryPipe {
 public:
  /// Error kUsage if answers are to be compared with a reference that there is not. The options
  /// must outlive it.
  QueryPipe(const QueryOptions& options, const PairConfig& config);

  /// Lines behind this header, or none, and so many pairs of the same input; or pairs of an array.
  void begin(std::string_view header, std::uint64_t pairs, bool array);
  /// A line of the input. True once no more must come before answer(). Error kFile for a header
  /// that cannot be read.
  [[nodiscard]] bool read(std::uint64_t number, std::string_view line);
  /// A pair of an array.
  [[nodiscard]] bool read(std::uint64_t number, PairArray& array);
  /// Runs what was read. Where an answer differs from the reference: a failure if the options say
  /// so, else error kMismatch, with a command that repeats it. And whatever the unit throws.
  [[nodiscard]] QueryAnswers answer();

 private:
  bool take(std::uint64_t number, OperandLine line, std::string why);
  void compare(QueryAnswers& answers);
  [[nodiscard]] std::string place(std::uint64_t number) const {
    return place_of(o_, array_, number);
  }
  [[nodiscard]] std::string place_of_pair(std::size_t i) const;
  [[nodiscard]] std::string repeat(std::size_t i) const;
  [[noreturn]] void report(std::size_t i);
  [[noreturn]] void report(const Error& stuck);
  [[nodiscard]] std::string listed(std::span<const std::uint64_t> words) const;
  void write(QueryAnswers& to, std::uint64_t line, std::size_t i) const;
  void write(QueryAnswers& to, const PairResult& r, std::string_view flags) const;
  [[nodiscard]] std::uint64_t nan() const { return config_.format.canonical_nan(); }

  struct Row {
    std::uint64_t line;
    bool valid;  ///< the next pair of the batch; else a line that could not be read
  };

  const QueryOptions& o_;
  PairConfig config_;
  WordText text_;
  OperandText operands_;
  bool array_ = false;  ///< numbers are those of pairs, not of lines
  PairUnit unit_;
  PairBudget budget_;
  std::vector<std::uint64_t> a_, b_;
  std::vector<Row> rows_;
  std::vector<std::string> unread_;  ///< messages of the lines that could not be read
  std::vector<PairResult> results_, expected_;
};

}  // namespace cde::cli
