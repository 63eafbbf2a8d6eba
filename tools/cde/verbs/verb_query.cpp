// SPDX-License-Identifier: Apache-2.0
// cde query: pairs of primitives from stdin through one simulated pipe, every answer checked
// against the reference.
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/card/pair_unit.hpp"
#include "cde/contract/registers.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "command/line_input.hpp"
#include "command/values.hpp"
#include "command/words.hpp"
#include "output/json_keys.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "output/suffix.hpp"
#include "verbs/bundle.hpp"
#include "verbs/operand_defect.hpp"
#include "verbs/operand_line.hpp"
#include "verbs/pair_options.hpp"
#include "verbs/trace_options.hpp"
#include "verbs/verbs.hpp"
#include "wave/waves.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kBatch = 65536;  // pairs, at most, between two runs of the unit
constexpr std::size_t kTraced = 4096;  // and of all, where there are waves of them

struct Options : PairOptions {
  TraceRequest trace;
  BundleRequest bundle;
  bool bits = false, check = true, json = false, quiet = false;
};

struct Totals {
  std::uint64_t pairs = 0, hits = 0, bad = 0, malformed = 0, clocks = 0, compared = 0;
  double simulation_seconds = 0;
};

/// How much of stdin there is to read, if it is a file.
double stdin_size() {
  struct stat file {};
  return ::fstat(STDIN_FILENO, &file) == 0 && S_ISREG(file.st_mode)
             ? static_cast<double>(file.st_size)
             : 0;
}

class Query {
 public:
  Query(const Options& o, const PairConfig& config)
      : o_(o), config_(config), text_(config_.format), unit_(config_) {
    if (!o_.budget.empty()) {
      budget_ = budget_of(o_);
      unit_.set_budget(budget_);
    }
    if (o_.check && !reference::has_pair(config_.pair, config_.algorithm))
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} has no reference to compare with: use --no-check", o_.pair));
  }

  Totals run() {
    // The first line goes with the answers, so that nothing is written where none follow; ahead of
    // them to who waits for it before asking.
    out_.append(std::string_view("F,T,CPx,CPy,CPz,nx,ny,nz,flags\n"));
    LineInput input;
    if (!config_.trace && LineInput::waits()) flush();
    Progress progress("query", o_.quiet);
    const double size = stdin_size();
    const auto take = [this](std::uint64_t number, std::string_view line) { read(number, line); };
    for (bool more = true; more;) {
      more = input.next(take);
      // Waves are of one run, whose clocks do not depend on how the lines came.
      if (!config_.trace || !more) answer();
      if (size > 0) progress(static_cast<double>(input.bytes()) / size);
    }
    flush();
    return totals_;
  }

 private:
  void read(std::uint64_t number, std::string_view line) {
    std::string why;
    switch (read_operands(config_.pair, text_, fmt::format("line {}", number), line, a_, b_, why)) {
      case OperandLine::kNothing:
        return;
      case OperandLine::kMalformed:
        ++totals_.malformed;
        rows_.push_back({number, false});
        unread_.push_back(std::move(why));
        break;
      case OperandLine::kPair:
        rows_.push_back({number, true});
    }
    if (config_.trace && rows_.size() > kTraced)
      throw Error(ErrorCode::kBadInput,
                  fmt::format("line {}: --trace takes at most {} pairs", number, kTraced));
    if (rows_.size() == kBatch) answer();
  }

  void answer() {
    if (rows_.empty() && !config_.trace) return;
    Waves waves(
        o_.trace.file,
        [this](const std::string& file) { unit_.open_trace(file, o_.trace.options()); },
        [this] { unit_.close_trace(); });
    const std::size_t pairs = a_.size() / primary_words(config_.pair);
    results_.resize(pairs);
    const auto start = std::chrono::steady_clock::now();
    try {
      totals_.clocks += unit_.test(a_, b_, results_);
    } catch (const Error& e) {
      if (is_hang(e)) report(e);
      throw;
    }
    totals_.simulation_seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    waves.close();  // whole, whatever the answers are
    if (o_.check) compare();
    flush();  // the first line: a stdout that cannot be written is known before lines are judged
    std::size_t pair = 0, unread = 0;
    for (const Row& row : rows_) {
      if (row.valid) {
        write(row.line, pair++);
      } else {
        say("cde: {}\n", unread_[unread++]);
        write({.t = nan(), .cp = {nan(), nan(), nan()}, .n = {nan(), nan(), nan()}}, "malformed");
      }
    }
    totals_.pairs += pairs;
    flush();
    rows_.clear(), unread_.clear(), a_.clear(), b_.clear();
  }

  void compare() {
    expected_.resize(results_.size());
    reference::test_pairs(config_.pair, config_.algorithm, config_.format, a_, b_, expected_,
                          config_.plane, budget_, config_.box);
    totals_.compared += results_.size();
    const auto [got, wanted] = std::mismatch(results_.begin(), results_.end(), expected_.begin());
    if (got != results_.end()) report(static_cast<std::size_t>(got - results_.begin()));
  }

  [[noreturn]] void report(std::size_t i) {
    std::uint64_t line = 0;
    for (std::size_t k = 0, valid = 0; valid <= i; ++k) {
      valid += rows_[k].valid ? 1 : 0;
      line = rows_[k].line;
    }
    const auto shown = [&](const PairResult& r) {
      return fmt::format("F {}, T {}, CP {}, n {}{}", r.f ? 1 : 0, text_.hexfloat(r.t),
                         listed(r.cp), listed(r.n), r.bad ? ", bad" : "");
    };
    const std::string a = listed(operand(a_, i, primary_words(config_.pair))),
                      b = listed(operand(b_, i, secondary_words(config_.pair)));
    // All lanes get the pair, whichever it was in.
    const std::string options = words_of(o_, config_, false),
                      repeat = fmt::format("yes {},{} | head -n {} | cde query {}", a, b,
                                           config_.lanes, words_of(o_, config_)),
                      message = fmt::format(
                          "line {}: the card's answer differs from the reference\n"
                          "  A         {}\n  B         {}\n  card      {}\n  reference {}\n"
                          "  differ in {}\n  where     {}\n"
                          "repeat with: {}\nexplain it:  cde explain {} '{} | {}'",
                          line, a, b, shown(results_[i]), shown(expected_[i]),
                          differing_fields(results_[i], expected_[i]),
                          place_in_unit(unit_, a_, b_, i), repeat, options, a, b);
    const auto fill = [&](Bundle& bundle) {
      bundle_pair(bundle, {.config = config_,
                           .budget = budget_,
                           .options = options,
                           .a = a_,
                           .b = b_,
                           .at = i,
                           .card = results_[i],
                           .reference = expected_[i],
                           .message = message,
                           .repeat = repeat});
    };
    throw Error(ErrorCode::kMismatch, message + packed(o_.bundle, o_.quiet, fill));
  }

  /// The unit stopped in the middle of these pairs.
  [[noreturn]] void report(const Error& stuck) {
    const std::string message =
        fmt::format("lines {} to {}: {}", rows_.front().line, rows_.back().line, stuck.what());
    const std::uint64_t clock = stuck.fault()->clock;
    const auto fill = [&](Bundle& bundle) {
      std::string pairs;
      for (std::size_t i = 0; i < results_.size(); ++i)
        pairs += listed(operand(a_, i, primary_words(config_.pair))) + " | " +
                 listed(operand(b_, i, secondary_words(config_.pair))) + "\n";
      bundle.write("pairs.txt", pairs);
      bundle.json().update({{"pair", name(config_.pair)}, {"parameters", config_.parameters()}});
      HangFailure f{.message = message,
                    .repeat = fmt::format("cde query {} < pairs.txt", words_of(o_, config_)),
                    .clock = clock,
                    .unit = true,
                    .shown = {"pair_unit.clk_i", "pair_unit.valid_i", "pair_unit.ready_o",
                              "pair_unit.tag_i", "pair_unit.valid_o", "pair_unit.tag_o"}};
      f.rerun = [&](const std::string& file, const TraceOptions& which) {
        PairConfig config = config_;
        config.trace = true;
        PairUnit unit(config);
        if (has_budget(config.pair)) unit.set_budget(budget_);
        std::vector<PairResult> results(results_.size());
        unit.open_trace(file, which);
        try {
          (void)unit.test(a_, b_, results);
        } catch (const Error& e) {
          if (!is_hang(e)) throw;
        }
        unit.close_trace();
      };
      bundle_hang(bundle, f);
    };
    throw Error(stuck.code(), message + packed(o_.bundle, o_.quiet, fill), stuck.fault());
  }

  [[nodiscard]] std::string listed(std::span<const std::uint64_t> words) const {
    std::string list;
    for (const std::uint64_t word : words) list += (list.empty() ? "" : ",") + text_.hexfloat(word);
    return list;
  }

  static std::span<const std::uint64_t> operand(std::span<const std::uint64_t> all, std::size_t i,
                                                std::size_t words) {
    return all.subspan(i * words, words);
  }

  void write(std::uint64_t line, std::size_t i) {
    const PairResult& r = results_[i];
    totals_.hits += r.f ? 1 : 0;
    if (r.bad) {
      ++totals_.bad;
      const std::string why =
          operand_defect(config_.pair, config_.format, operand(a_, i, primary_words(config_.pair)),
                         operand(b_, i, secondary_words(config_.pair)));
      say("cde: line {}: {}\n", line,
          why.empty() ? "the card refuses the pair, and the reference sees no reason" : why);
    }
    write(r, r.bad ? "bad" : "");
  }

  void write(const PairResult& r, std::string_view flags) {
    out_.push_back(r.f ? '1' : '0');
    const auto put = [this](std::uint64_t word) {
      out_.push_back(',');
      if (o_.bits)
        text_.append_bits(out_, word);
      else
        text_.append_decimal(out_, word);
    };
    put(r.t);
    for (const std::uint64_t word : r.cp) put(word);
    if (has_ray(config_.pair)) {
      out_.append(std::string_view(",,,"));
    } else {
      for (const std::uint64_t word : r.n) put(word);
    }
    out_.push_back(',');
    out_.append(flags);
    out_.push_back('\n');
  }

  void flush() {
    stdout_.write({out_.data(), out_.size()});
    stdout_.flush();
    out_.clear();
  }

  [[nodiscard]] std::uint64_t nan() const { return config_.format.canonical_nan(); }

  struct Row {
    std::uint64_t line;
    bool valid;  ///< the next pair of the batch; else a line that could not be read
  };

  const Options& o_;
  PairConfig config_;
  WordText text_;
  PairUnit unit_;
  PairBudget budget_;
  Totals totals_;
  std::vector<std::uint64_t> a_, b_;
  std::vector<Row> rows_;
  std::vector<std::string> unread_;  ///< messages of the lines that could not be read
  std::vector<PairResult> results_, expected_;
  fmt::memory_buffer out_;
  OutputFile stdout_{"-"};
};

nlohmann::ordered_json as_json(const Options& o, const PairConfig& config, const Totals& t) {
  nlohmann::ordered_json j = program_json();
  j.update(
      {{"pair", o.pair},
       {"algorithm",
        o.pair == "ray-triangle" ? nlohmann::ordered_json(o.algorithm) : nlohmann::ordered_json()},
       {"box", config.pair == Pair::kRayTriangle ? nlohmann::ordered_json(config.box)
                                                 : nlohmann::ordered_json()},
       {"half_space", o.half_space},
       {"format", o.format},
       {"arithmetic", o.arithmetic},
       {"lanes", config.lanes},
       {"facet_interval", o.facet_interval},
       {"budget", o.budget.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(o.budget)},
       {"tests", t.pairs},
       {"hits", t.hits},
       {"bad_pairs", t.bad},
       {"malformed_lines", t.malformed},
       {"device_cycles", t.clocks},
       {"simulation_seconds", t.simulation_seconds},
       {"checked", o.check},
       {"records_compared", t.compared},
       {"records_matching", t.compared}});
  return j;
}

void print_summary(const Options& o, const PairConfig& config, const Totals& t) {
  const auto row = [](const char* name, const std::string& value) {
    say("{:<16} {}\n", name, value);
  };
  row("pair", fmt::format("{}{}, {}, {} arithmetic, {} lanes", o.pair,
                          o.pair == "ray-triangle"
                              ? fmt::format(" by {}{}", o.algorithm, config.box ? ", box rule" : "")
                          : o.half_space ? " of a half-space"
                                         : "",
                          o.format, o.arithmetic, config.lanes));
  row("pairs", fmt::format("{}, {} bad, and {} malformed line{}", t.pairs, t.bad, t.malformed,
                           t.malformed == 1 ? "" : "s"));
  row("hits", fmt::to_string(t.hits));
  row("device cycles", fmt::to_string(t.clocks));
  if (t.pairs != 0)  // none take no time
    row("simulation", fmt::format("{:.3g} s, {:.4g} M pairs/s", t.simulation_seconds,
                                  static_cast<double>(t.pairs) / t.simulation_seconds / 1e6));
  row("check",
      o.check ? fmt::format("{} of {} answers match the reference", t.compared, t.pairs) : "off");
}

void run(const Options& o) {
  o.trace.check();
  if (o.trace.wanted())
    check_outputs(std::vector<FileUse>{{"--trace", o.trace.file}, {"the answers", "-"}},
                  std::vector<FileUse>{{"stdin", "-"}});
  PairConfig config = configuration(o);
  config.trace = o.trace.wanted();
  const Totals totals = Query(o, config).run();
  if (o.json)
    put_json(as_json(o, config, totals), -1);
  else if (!o.quiet)
    print_summary(o, config, totals);
  if (totals.bad + totals.malformed != 0) exit_code = exit_status(ErrorCode::kBadInput);
}

}  // namespace

void add_query(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "query",
      "Test pairs of primitives in one simulated pipe. Reads a pair a line from stdin, the words "
      "of "
      "A and then of B, separated by commas or blanks, with a | between A and B if that helps: "
      "ray o d [tmin tmax] 6 or 8, triangle 9, "
      "sphere c r 4, aabb min max 6, plane n d 4, cylinder c axis half-height radius 8, obb c "
      "half-extents rotation by rows 15. A word is decimal, hexfloat, or 0x and the bits. Prints "
      "F,T,CP,n,flags as CSV; flags: empty, bad (the card refuses an operand) or malformed (the "
      "line cannot be read). Blank lines and lines that start with # are skipped");
  add_pair_options(*verb, *o);
  verb->add_flag("--bits", o->bits, "Print words as 0x and their bits instead of decimals");
  verb->add_flag("--check,!--no-check", o->check,
                 "Compare every answer with the reference, bit for bit (on)");
  add_trace_options(*verb, o->trace,
                    fmt::format("Waves of the pipe, FST, while all pairs, at most {}, go "
                                "through: answers come when stdin has ended. Kept even if an "
                                "answer differs",
                                kTraced));
  add_bundle_options(*verb, o->bundle);
  verb->add_flag("--json", o->json, "Summary as a line of JSON, the last on stdout");
  verb->add_flag("-q,--quiet", o->quiet, "No summary and no progress");
  verb->callback([o] {
    tell_builds(!o->quiet);
    run(*o);
  });
}

}  // namespace cde::cli
