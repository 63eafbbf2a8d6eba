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
#include "cde/jobs/work_distributor.hpp"
#include "cde/support/error.hpp"
#include "options/pair_options.hpp"
#include "options/trace_options.hpp"
#include "program/pack_failure.hpp"

/// The pairs of `cde query`, from input lines to answer lines.
namespace cde::cli {

inline constexpr std::size_t kQueryBatch = 65536;   ///< most pairs per run of the unit
inline constexpr std::size_t kQueryTraced = 4096;   ///< most pairs of all with waves
inline constexpr std::size_t kQueryFailures = 100;  ///< most failures that --keep-going prints

struct QueryOptions : PairOptions {
  TraceRequest trace;
  BundleRequest bundle;
  DistributionOptions distribution;
  std::string file = "-", output = "-";
  bool bits = false, check = true, keep_going = false, json = false, quiet = false;
};

/// "line 7", "pairs.csv:7", "pair 7" or "pairs.npy: pair 7": the place of a line of text or of a
/// pair in an array.
[[nodiscard]] std::string place_of(const QueryOptions& options, bool array, std::uint64_t number);

struct QueryTotals {
  std::uint64_t pairs = 0, hits = 0, bad = 0, malformed = 0, cycles = 0, compared = 0, differ = 0;
  double simulation_seconds = 0;
  QueryTotals& operator+=(const QueryTotals& other);
};

/// The answers to some lines.
struct QueryAnswers {
  QueryTotals totals;
  std::string messages;  ///< messages about lines, each with a line end
  /// The first kQueryFailures answers that differ from the reference, with the command that repeats
  /// each.
  std::vector<std::string> failures;
  std::string rows;  ///< CSV
};

/// One pipe and the lines for it.
class QueryPipe {
 public:
  /// Error kUsage if answers should be compared but the pair has no reference. The options must
  /// outlive the object.
  QueryPipe(const QueryOptions& options, const PairConfig& config);

  /// Begins a piece: lines after this header (which may be empty) and after `pairs` pairs of the
  /// same input, or pairs of an array.
  void begin(std::string_view header, std::uint64_t pairs, bool array);
  /// Reads a line of the input. Returns true if answer() must be called before the next line. Error
  /// kFile for a header that cannot be read.
  [[nodiscard]] bool read(std::uint64_t number, std::string_view line);
  /// Reads a pair of an array.
  [[nodiscard]] bool read(std::uint64_t number, PairArray& array);
  /// Runs the pairs that were read. An answer that differs from the reference is a failure with
  /// --keep-going, else error kMismatch, with a command that repeats it. Errors of the unit pass
  /// through.
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
    bool valid;  ///< true: the next pair of the batch; false: a line that could not be read
  };

  const QueryOptions& o_;
  PairConfig config_;
  WordText text_;
  OperandText operands_;
  bool array_ = false;  ///< numbers count pairs, not lines
  PairUnit unit_;
  PairIterations iterations_;
  std::vector<std::uint64_t> a_, b_;
  std::vector<Row> rows_;
  std::vector<std::string> unread_;  ///< messages of the lines that could not be read
  std::vector<PairResult> results_, expected_;
};

}  // namespace cde::cli
