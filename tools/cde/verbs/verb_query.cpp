// SPDX-License-Identifier: Apache-2.0
// cde query: tests pairs of primitives in one simulated pipe, and compares every answer with the
// reference.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cde/card/json_keys.hpp"
#include "cde/jobs/work_distributor.hpp"
#include "cde/model/model.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "options/distribution_options.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "verbs/query_input.hpp"
#include "verbs/query_pipe.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

constexpr const char* kHeader = "F,T,CPx,CPy,CPz,nx,ny,nz,flags\n";

/// Writes answers to a file or stdout.
class Answers {
 public:
  Answers(const std::string& file, std::string_view first) : out_(first), file_(file) {}
  /// Writes the header. If a process waits for it, it goes out before the answers. Otherwise it
  /// goes out with them, so that without answers nothing is written.
  void begin() { flush(); }
  void add(const QueryAnswers& answers) {
    totals_ += answers.totals;
    if (answers.rows.empty()) return;
    flush();  // a write error comes before errors about lines
    if (!answers.messages.empty()) log(answers.messages);
    for (const std::string& failure : answers.failures)
      if (printed_++ < kQueryFailures) log("cde: {}\n", failure);
    out_ += answers.rows;
    flush();
  }
  [[nodiscard]] const QueryTotals& end() {
    flush();
    file_.commit();
    return totals_;
  }

 private:
  void flush() {
    file_.write(out_);
    file_.flush();
    out_.clear();
  }
  std::string out_;
  QueryTotals totals_;
  std::size_t printed_ = 0;  ///< failures printed so far
  OutputFile file_;
};

/// Answers pairs as they arrive.
QueryTotals answer_pairs(const QueryOptions& o, const PairConfig& config) {
  QueryInput input(o.file);
  QueryPipe pipe(o, config);
  Answers answers(o.output, kHeader);
  if (!config.trace && input.waits()) answers.begin();
  Progress progress("query", o.quiet);
  if (auto array = input.array({config.pair, o.exchanged}, WordText(config.format))) {
    const std::uint64_t pairs = array->size();
    for (std::uint64_t i = 0; i < pairs; ++i) {
      if (!pipe.read(i, *array)) continue;
      answers.add(pipe.answer());
      progress(static_cast<double>(i) / static_cast<double>(pairs));
    }
    answers.add(pipe.answer());
    return answers.end();
  }
  for (bool more = true; more;) {
    more = input.next([&](std::uint64_t number, std::string_view line) {
      if (pipe.read(number, line)) answers.add(pipe.answer());
    });
    // With waves there is only one run, so that their cycles do not depend on the timing of the
    // input.
    if (!config.trace || !more) answers.add(pipe.answer());
    if (const auto share = input.share()) progress(*share);
  }
  return answers.end();
}

/// The answers as text: totals as a line of JSON, then messages and rows.
std::string as_text(const QueryAnswers& a) {
  const QueryTotals& t = a.totals;
  return json_text(
             nlohmann::ordered_json{
                 {"totals", {t.pairs, t.hits, t.bad, t.malformed, t.cycles, t.compared, t.differ}},
                 {"failures", a.failures},
                 {"simulation_seconds", t.simulation_seconds},
                 {"message_bytes", a.messages.size()}},
             -1) +
         "\n" + a.messages + a.rows;
}
QueryAnswers answers_in(const std::string& text) {
  const std::size_t line = text.find('\n') + 1;
  const auto head = parse_json(text.substr(0, line));
  const auto n = head.at("totals").get<std::vector<std::uint64_t>>();
  const auto messages = head.at("message_bytes").get<std::size_t>();
  if (n.size() != 7)
    throw Error(ErrorCode::kFile, fmt::format("it has {} totals instead of 7", n.size()));
  if (messages > text.size() - line)
    throw Error(ErrorCode::kFile, fmt::format("it states messages of {} bytes; {} bytes follow",
                                              messages, text.size() - line));
  return {.totals = {.pairs = n.at(0),
                     .hits = n.at(1),
                     .bad = n.at(2),
                     .malformed = n.at(3),
                     .cycles = n.at(4),
                     .compared = n.at(5),
                     .differ = n.at(6),
                     .simulation_seconds = head.at("simulation_seconds")},
          .messages = text.substr(line, messages),
          .failures = head.at("failures").get<std::vector<std::string>>(),
          .rows = text.substr(line + messages)};
}

/// Answers pairs in chunks. Returns nothing if not all answers are in this process.
std::optional<QueryTotals> distribute_pairs(const QueryOptions& o, const PairConfig& config) {
  WorkDistributor& distributor = WorkDistributor::instance();
  nlohmann::ordered_json run = {{"verb", "query"},
                                {"pair", o.pair},
                                {"parameters", config.parameters()},
                                {"exchanged", o.exchanged},
                                {"iterations", o.iterations},
                                {"bits", o.bits},
                                {"checked", o.check},
                                {"keep_going", o.keep_going}};
  if (!distributor.merges())
    run["config_hash"] = fmt::format("{:016x}", model_hash("pair_unit", config.parameters()));
  distributor.begin(o.distribution, run, o.quiet);
  QueryChunks pairs(o, config);
  std::optional<QueryPipe> pipe;
  std::optional<Answers> answers;
  if (distributor.leads() && !distributor.is_shard()) answers.emplace(o.output, kHeader);
  const bool whole = distributor.run_part(
      {.what = "query",
       .chunks = std::nullopt,
       .input = [&](std::uint64_t) { return pairs.next(); },
       .inputs_again = false,  // stdin cannot be read again
       .run =
           [&](std::uint64_t, const std::string& chunk) {
             if (!pipe) pipe.emplace(o, config);
             return as_text(answers_to(*pipe, chunk));
           },
       .check = [](std::uint64_t, const std::string& result) { (void)answers_in(result); },
       .take = [&](std::uint64_t,
                   const std::string& result) { answers->add(answers_in(result)); }});
  return whole ? std::optional(answers->end()) : std::nullopt;
}

nlohmann::ordered_json as_json(const QueryOptions& o, const PairConfig& config,
                               const QueryTotals& t) {
  nlohmann::ordered_json j = program_json();
  j.update({{"pair", o.pair},
            {"algorithm", o.pair == "ray-triangle" ? nlohmann::ordered_json(o.algorithm)
                                                   : nlohmann::ordered_json()},
            {"box", config.pair == Pair::kRayTriangle ? nlohmann::ordered_json(config.box)
                                                      : nlohmann::ordered_json()},
            {"half_space", o.half_space},
            {"format", o.format},
            {"arithmetic", o.arithmetic},
            {"lanes", config.lanes},
            {"sat_interval", o.sat_interval},
            {"iterations", o.iterations.empty() ? nlohmann::ordered_json()
                                                : nlohmann::ordered_json(o.iterations)},
            {"tests", t.pairs},
            {"hits", t.hits},
            {"bad_pairs", t.bad},
            {"malformed_lines", t.malformed},
            {"device_cycles", t.cycles},
            {"simulation_seconds", t.simulation_seconds},
            {"checked", o.check},
            {"records_compared", t.compared},
            {"records_matching", t.compared - t.differ}});
  return j;
}

void print_summary(const QueryOptions& o, const PairConfig& config, const QueryTotals& t) {
  const auto row = [](const char* name, const std::string& value) {
    log("{:<16} {}\n", name, value);
  };
  row("pair", fmt::format("{}{}, {}, {} arithmetic, {}", o.pair,
                          o.pair == "ray-triangle"
                              ? fmt::format(" by {}{}", o.algorithm, config.box ? ", box rule" : "")
                          : o.half_space ? " of a half-space"
                                         : "",
                          o.format, o.arithmetic, counted(config.lanes, "lane")));
  row("pairs",
      fmt::format("{}, {} bad, and {}", t.pairs, t.bad, counted(t.malformed, "malformed line")));
  row("hits", fmt::to_string(t.hits));
  row("device cycles", fmt::to_string(t.cycles));
  if (t.pairs != 0)  // without pairs there is no rate
    row("simulation", fmt::format("{:.3g} s, {:.4g} M pairs/s", t.simulation_seconds,
                                  static_cast<double>(t.pairs) / t.simulation_seconds / 1e6));
  row("check", o.check ? fmt::format("{} of {} {} the reference", t.compared - t.differ,
                                     counted(t.pairs, "answer"), t.pairs == 1 ? "matches" : "match")
                       : "off");
}

void run(const QueryOptions& o) {
  o.trace.check();
  std::vector<FileUse> inputs = {{o.file == "-" ? "stdin" : "FILE", o.file}};
  WorkDistributor::instance().add_inputs(inputs);
  if (o.trace.wanted() || !o.distribution.resume.empty() || o.output != "-")
    check_outputs(std::vector<FileUse>{{"--trace", o.trace.wanted() ? o.trace.file : ""},
                                       {"--resume", o.distribution.resume},
                                       {o.output == "-" ? "the answers" : "--output", o.output}},
                  inputs);
  if (o.keep_going && !o.check) cannot_combine("--keep-going", "--no-check");
  o.bundle.check(o.check, "--no-check");
  PairConfig config = configuration(o);
  config.trace = o.trace.wanted();
  const bool distributed = WorkDistributor::instance().is_chunked(o.distribution);
  if (distributed && o.trace.wanted())
    throw Error(
        ErrorCode::kUsage,
        "--trace works only in one process; it cannot be combined with ranks, --resume or --shard");
  const auto totals = distributed ? distribute_pairs(o, config) : answer_pairs(o, config);
  if (!totals) return;
  if (o.json)
    print_json(as_json(o, config, *totals), -1);
  else if (!o.quiet)
    print_summary(o, config, *totals);
  if (totals->differ > kQueryFailures)
    log("cde: {} from the reference\n",
        totals->differ - kQueryFailures == 1
            ? "1 more answer differs"
            : fmt::format("{} more answers differ", totals->differ - kQueryFailures));
  if (totals->differ != 0)
    exit_code = exit_status(ErrorCode::kMismatch);
  else if (totals->bad + totals->malformed != 0)
    exit_code = exit_status(ErrorCode::kBadInput);
}

}  // namespace

void add_query(CLI::App& app) {
  auto o = std::make_shared<QueryOptions>();
  CLI::App* verb = app.add_subcommand(
      "query",
      "Test pairs of primitives in one simulated pipe. Reads one pair per line from stdin or a "
      "file: the words of A, then the words of B, separated by commas, semicolons, tabs or blanks, "
      "optionally with a | between A and B. Words of each shape: ray o d [tmin tmax] 6 or 8, "
      "triangle 9, sphere c r 4, aabb min max 6, plane n d 4, cylinder c axis half-height radius "
      "8, obb c half-extents rotation by rows 15. A word is decimal, hexfloat, or 0x and the bits. "
      "A header may name the columns (A.center.x, ...). Skips blank lines and lines that start "
      "with #. Prints F,T,CP,n,flags as CSV. flags is empty, bad (the card refuses an operand), "
      "malformed (the line cannot be read) or differs (--keep-going)");
  add_pair_options(*verb, *o);
  file_value(verb->add_option("file", o->file,
                              "Pairs as text, or as a NumPy array (.npy, .npz) of shape (..., "
                              "words of A and B) or of structures; - is stdin, also for arrays")
                 ->capture_default_str(),
             "FILE");
  begin_group(*verb, "Answers");
  file_value(verb->add_option(
                     "-o,--output", o->output,
                     "File for the answers, written only if all is done; - is stdout, line by line")
                 ->capture_default_str(),
             "FILE");
  verb->add_flag("--bits", o->bits, "Print words as 0x and bits, not as decimals");
  begin_group(*verb, "Checks");
  verb->add_flag("--check,!--no-check", o->check,
                 "Compare every answer with the reference, bit for bit")
      ->default_str("on");
  CLI::Option* const keep_going =
      verb->add_flag("-k,--keep-going", o->keep_going,
                     fmt::format("Go on after a wrong answer: its flags say differs, and the first "
                                 "{} are printed with the command that repeats and packs each",
                                 kQueryFailures));
  add_bundle_options(*verb, o->bundle);
  keep_going->excludes(verb->get_option("--bundle"));
  begin_group(*verb, "Waves");
  add_trace_options(*verb, o->trace,
                    fmt::format("Waves of the pipe with all pairs (at most {}), FST. Answers come "
                                "after the end of stdin. Kept even if an answer differs",
                                kQueryTraced));
  begin_group(*verb, "Several machines");
  add_distribution_options(*verb, o->distribution);
  begin_group(*verb, "Messages");
  verb->add_flag("--json", o->json, "Summary as a line of JSON, after the answers on stdout");
  verb->add_flag("-q,--quiet", o->quiet, "No summary and no progress");
  verb->callback([o, verb] {
    report_builds(!o->quiet);
    check_pair_options(*verb, *o);
    normalise_pair(*o);
    run(*o);
  });
}

}  // namespace cde::cli
