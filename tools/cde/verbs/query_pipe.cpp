// SPDX-License-Identifier: Apache-2.0
#include "verbs/query_pipe.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "cde/card/trace_file.hpp"
#include "cde/contract/registers.hpp"
#include "cde/geometry/operand_defect.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"

namespace cde::cli {
namespace {

std::span<const std::uint64_t> operand(std::span<const std::uint64_t> all, std::size_t i,
                                       std::size_t words) {
  return all.subspan(i * words, words);
}

}  // namespace

std::string place_of(const QueryOptions& o, bool array, std::uint64_t number) {
  if (o.file == "-") return fmt::format("{} {}", array ? "pair" : "line", number);
  return fmt::format("{}:{}{}", printable_name(o.file), array ? " pair " : "", number);
}

QueryTotals& QueryTotals::operator+=(const QueryTotals& other) {
  pairs += other.pairs;
  hits += other.hits;
  bad += other.bad;
  malformed += other.malformed;
  cycles += other.cycles;
  compared += other.compared;
  differ += other.differ;
  simulation_seconds += other.simulation_seconds;
  return *this;
}

QueryPipe::QueryPipe(const QueryOptions& o, const PairConfig& config)
    : o_(o),
      config_(config),
      text_(config_.format),
      operands_({config_.pair, o_.exchanged}, text_),
      unit_(config_) {
  if (!o_.iterations.empty()) {
    iterations_ = iterations_of(o_);
    unit_.set_iterations(iterations_);
  }
  if (o_.check && !reference::has_pair(config_.pair, config_.algorithm))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} has no reference to compare with; use --no-check", o_.pair));
}

void QueryPipe::begin(std::string_view header, std::uint64_t pairs, bool array) {
  operands_ = OperandText({config_.pair, o_.exchanged}, text_);
  (void)operands_.take_header(header, "the header");
  operands_.skip(pairs);
  array_ = array;
}

bool QueryPipe::read(std::uint64_t number, std::string_view line) {
  std::string why;
  const OperandLine found = operands_.read(line, place(number), a_, b_, why);
  return take(number, found, std::move(why));
}

bool QueryPipe::read(std::uint64_t number, PairArray& array) {
  array_ = true;
  std::string why;
  const OperandLine found = array.read(number, place(number), a_, b_, why);
  return take(number, found, std::move(why));
}

bool QueryPipe::take(std::uint64_t number, OperandLine found, std::string why) {
  switch (found) {
    case OperandLine::kNothing:
      return false;
    case OperandLine::kMalformed:
      rows_.push_back({number, false});
      unread_.push_back(std::move(why));
      break;
    case OperandLine::kPair:
      rows_.push_back({number, true});
  }
  if (config_.trace && rows_.size() > kQueryTraced)
    throw Error(ErrorCode::kBadInput,
                fmt::format("{}: --trace takes at most {} pairs", place(number), kQueryTraced));
  return rows_.size() == kQueryBatch;
}

QueryAnswers QueryPipe::answer() {
  QueryAnswers answers;
  if (rows_.empty() && !config_.trace) return answers;
  TraceFile waves(
      o_.trace.file,
      [this](const std::string& file) { unit_.open_trace(file, o_.trace.options()); },
      [this] { unit_.close_trace(); });
  answers.totals.pairs = a_.size() / primary_words(config_.pair);
  answers.totals.malformed = unread_.size();
  results_.resize(answers.totals.pairs);
  const auto start = std::chrono::steady_clock::now();
  try {
    answers.totals.cycles = unit_.test(a_, b_, results_);
  } catch (const Error& e) {
    if (is_hang(e)) report(e);
    throw;
  }
  answers.totals.simulation_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  waves.close();  // the waves are whole even if an answer differs
  if (o_.check) compare(answers);
  std::size_t pair = 0, unread = 0;
  for (const Row& row : rows_) {
    if (row.valid) {
      write(answers, row.line, pair++);
    } else {
      answers.messages += fmt::format("cde: {}\n", unread_[unread++]);
      write(answers, {.t = nan(), .cp = {nan(), nan(), nan()}, .n = {nan(), nan(), nan()}},
            "malformed");
    }
  }
  rows_.clear(), unread_.clear(), a_.clear(), b_.clear();
  return answers;
}

void QueryPipe::compare(QueryAnswers& answers) {
  expected_.resize(results_.size());
  reference::test_pairs(config_.pair, config_.algorithm, config_.format, a_, b_, expected_,
                        config_.plane, iterations_, config_.box);
  answers.totals.compared += results_.size();
  for (std::size_t i = 0; i < results_.size(); ++i) {
    if (results_[i] == expected_[i]) continue;
    if (!o_.keep_going) report(i);
    if (answers.totals.differ++ >= kQueryFailures) continue;
    answers.failures.push_back(
        fmt::format("{}: the card's answer differs from the reference in {}\nrepeat with: {}",
                    place_of_pair(i), differing_fields(results_[i], expected_[i]), repeat(i)));
  }
}

std::string QueryPipe::place_of_pair(std::size_t i) const {
  std::size_t k = 0;
  for (std::size_t valid = 0; valid <= i; ++k) valid += rows_[k].valid ? 1 : 0;
  return place(rows_[k - 1].line);
}

/// The command repeats the pair in all lanes.
std::string QueryPipe::repeat(std::size_t i) const {
  return fmt::format(
      "yes {},{} | head -n {} | cde query {}", listed(operand(a_, i, primary_words(config_.pair))),
      listed(operand(b_, i, secondary_words(config_.pair))), config_.lanes, words_of(o_, config_));
}

void QueryPipe::report(std::size_t i) {
  const auto shown = [&](const PairResult& r) {
    return fmt::format("F {}, T {}, CP {}, n {}{}", r.f ? 1 : 0, text_.hexfloat(r.t), listed(r.cp),
                       listed(r.n), r.bad ? ", bad" : "");
  };
  const std::string a = listed(operand(a_, i, primary_words(config_.pair))),
                    b = listed(operand(b_, i, secondary_words(config_.pair)));
  const std::string options = words_of(o_, config_, false), again = repeat(i),
                    message = fmt::format(
                        "{}: the card's answer differs from the reference\n"
                        "  A         {}\n  B         {}\n  card      {}\n  reference {}\n"
                        "  differ in {}\n  where     {}\n"
                        "repeat with: {}\nexplain it:  cde explain {} '{} | {}'",
                        place_of_pair(i), a, b, shown(results_[i]), shown(expected_[i]),
                        differing_fields(results_[i], expected_[i]),
                        place_in_unit(unit_, a_, b_, i), again, options, a, b);
  // Rows well after the pair's row do not matter.
  const std::size_t rows = i / config_.lanes + 5,
                    pairs = std::min(results_.size(), rows * config_.lanes);
  const auto first = [pairs](const std::vector<std::uint64_t>& words, std::size_t each) {
    return std::vector(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(pairs * each));
  };
  throw Error(ErrorCode::kMismatch,
              message + packed(o_.bundle, o_.quiet,
                               {.kind = PairFailure{.config = config_,
                                                    .iterations = iterations_,
                                                    .options = options,
                                                    .a = first(a_, primary_words(config_.pair)),
                                                    .b = first(b_, secondary_words(config_.pair)),
                                                    .at = i,
                                                    .card = results_[i],
                                                    .reference = expected_[i]},
                                .message = message,
                                .repeat = again}));
}

/// Reports that the unit stopped during these pairs.
void QueryPipe::report(const Error& stuck) {
  const std::string message =
      o_.file == "-" && !array_
          ? fmt::format("lines {} to {}: {}", rows_.front().line, rows_.back().line, stuck.what())
          : fmt::format("{} to {}: {}", place(rows_.front().line), rows_.back().line, stuck.what());
  const std::uint64_t cycle = stuck.fault()->cycle;
  std::string pairs;
  for (std::size_t i = 0; i < results_.size(); ++i)
    pairs += listed(operand(a_, i, primary_words(config_.pair))) + " | " +
             listed(operand(b_, i, secondary_words(config_.pair))) + "\n";
  Failure f{
      .kind = HangFailure{.cycle = cycle,
                          .unit = true,
                          .shown = {"pair_unit.clk_i", "pair_unit.valid_i", "pair_unit.ready_o",
                                    "pair_unit.tag_i", "pair_unit.valid_o", "pair_unit.tag_o"}},
      .message = message,
      .repeat = fmt::format("cde query {} < pairs.txt", words_of(o_, config_)),
      .details = json_text(nlohmann::ordered_json{{"pair", name(config_.pair)},
                                                  {"parameters", config_.parameters()}}),
      .files = {{"pairs.txt", pairs}}};
  f.rerun = [&](const std::string& file, const TraceOptions& which) {
    PairConfig config = config_;
    config.trace = true;
    PairUnit unit(config);
    if (has_iterations(config.pair)) unit.set_iterations(iterations_);
    std::vector<PairResult> results(results_.size());
    unit.open_trace(file, which);
    try {
      (void)unit.test(a_, b_, results);
    } catch (const Error& e) {
      if (!is_hang(e)) throw;
    }
    unit.close_trace();
    return true;
  };
  throw Error(stuck.code(), message + packed(o_.bundle, o_.quiet, f), stuck.fault());
}

std::string QueryPipe::listed(std::span<const std::uint64_t> words) const {
  std::string list;
  for (const std::uint64_t word : words) list += (list.empty() ? "" : ",") + text_.hexfloat(word);
  return list;
}

void QueryPipe::write(QueryAnswers& to, std::uint64_t line, std::size_t i) const {
  const PairResult& r = results_[i];
  to.totals.hits += r.f ? 1 : 0;
  if (r.bad) {
    ++to.totals.bad;
    const std::string why =
        operand_defect(config_.pair, config_.format, operand(a_, i, primary_words(config_.pair)),
                       operand(b_, i, secondary_words(config_.pair)));
    to.messages += fmt::format(
        "cde: {}: {}\n", place(line),
        why.empty() ? "the card refuses the pair, but the reference finds no reason" : why);
  }
  const bool differs = o_.check && !(r == expected_[i]);
  write(to, r, differs ? "differs" : r.bad ? "bad" : "");
}

void QueryPipe::write(QueryAnswers& to, const PairResult& r, std::string_view flags) const {
  fmt::memory_buffer out;
  out.push_back(r.f ? '1' : '0');
  const auto put = [&](std::uint64_t word) {
    out.push_back(',');
    if (o_.bits)
      text_.append_bits(out, word);
    else
      text_.append_decimal(out, word);
  };
  put(r.t);
  for (const std::uint64_t word : r.cp) put(word);
  if (has_ray(config_.pair)) {
    out.append(std::string_view(",,,"));
  } else {
    for (const std::uint64_t word : r.n) put(word);
  }
  out.push_back(',');
  out.append(flags);
  out.push_back('\n');
  to.rows.append(out.data(), out.size());
}

}  // namespace cde::cli
