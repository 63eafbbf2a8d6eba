// SPDX-License-Identifier: Apache-2.0
// cde explain: runs one pair through one pipe, and compares every operator with the mirror
// reference. The pair may come from a record of a scene or from a line of a failing test.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cde/card/json_keys.hpp"
#include "cde/explain/explain_text.hpp"
#include "cde/explain/explanation.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/geometry/operand_defect.hpp"
#include "cde/geometry/operand_line.hpp"
#include "cde/support/error.hpp"
#include "explain_line.hpp"
#include "explain_record.hpp"
#include "options/help.hpp"
#include "options/pair_options.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "record_story.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

struct Options : PairOptions {
  std::vector<std::string> words;
  std::string record, line;
  unsigned most = 100;
  bool json = false, exact = false;
};

void explain_pair(const Options& o, const std::string& line) {
  const PairConfig config = configuration(o);
  std::vector<std::uint64_t> a, b;
  std::string why;
  switch (read_operands({config.pair, o.exchanged}, WordText(config.format), "the pair", line, a, b,
                        why)) {
    case OperandLine::kNothing:
      throw Error(ErrorCode::kUsage, "the words of a pair are missing");
    case OperandLine::kMalformed:
      throw Error(ErrorCode::kUsage, why);
    case OperandLine::kPair:
      break;
  }
  if (const std::string bad = operand_defect(config.pair, config.format, a, b); !bad.empty())
    throw Error(ErrorCode::kBadInput, "the pair: " + bad);
  const explain::Explanation e = explain::explain(config, a, b, iterations_of(o));
  if (o.json) {
    nlohmann::ordered_json j = {{"schema", "cde.explain.1"}};
    j.update(program_json());
    j.update({{"pair", o.pair},
              {"same", e.same()},
              {"operations", e.operations.size()},
              {"operations_found", e.found},
              {"first_differences", explanation_differences(e)}});
    print_json(j, 2);
  } else {
    print(explanation_text(words_of(o, e.config, false), e, o.most));
  }
  if (!e.same()) exit_code = exit_status(ErrorCode::kMismatch);
}

/// Checks that either PAIR and WORDS, or one option, names the pair.
void check_words(const CLI::App& verb, const Options& o) {
  if (o.json && o.record.empty() && verb.count("--max") != 0) cannot_combine("--max", "--json");
  const std::string from = !o.record.empty() ? "--from-record"
                           : !o.line.empty() ? "--from-test"
                                             : "";
  if (from.empty()) {
    if (o.pair.empty() || o.words.empty())
      throw Error(ErrorCode::kUsage,
                  o.pair.empty()
                      ? "a pair is missing; give PAIR and WORDS, --from-record or --from-test"
                      : "the words of a pair are missing");
    check_pair_options(verb, o);
    return;
  }
  for (const CLI::Option* option : verb.get_options()) {
    const std::string name = option->get_name();
    const bool meant = name == "--help" || name == "--max" || name == "--json" || name == from ||
                       (name == "--exact-card" && !o.record.empty());
    if (option->count() != 0 && !meant)
      cannot_combine(option->get_positional() ? option_head(*option) : name, from,
                     "it already names the pair");
  }
}

void run(const CLI::App& verb, Options& o) {
  check_words(verb, o);
  if (!o.record.empty())
    return explain_record({.name = o.record, .most = o.most, .exact = o.exact, .json = o.json});
  if (o.line.empty()) {
    normalise_pair(o);
    return explain_pair(o, fmt::format("{}", fmt::join(o.words, " ")));
  }
  const NamedPair named = pair_in_line(o.line);
  Options pair = o;
  static_cast<PairOptions&>(pair) = named.options;
  normalise_pair(pair);
  explain_pair(pair, named.words);
}

}  // namespace

void add_explain(CLI::App& app) {
  auto o = std::make_shared<Options>();
  o->arithmetic = "rtl";
  CLI::App* verb = app.add_subcommand(
      "explain",
      "Run one pair through one pipe, and compare every operator of the card with the same "
      "operation of the mirror reference. Prints the cycle and the line of RTL of each operator. A "
      "wrong answer begins at an operator whose operands are right and whose result is wrong. "
      "Other pairs run along, to find which operator does which operation. Exit status 3 if the "
      "answers differ");
  add_pair_options(*verb, *o, false);
  verb->get_option("pair")->required(false);
  known_words(verb->add_option("words", o->words, "Words of A and B, as in cde query"), {},
              "WORDS");
  begin_group(*verb, "Instead of a pair");
  text_value(verb->add_option(
                 "--from-record", o->record,
                 "Explain a record, named by the scene or the folder of a run, query, frame "
                 "and primary. Repeats the frame with waves. Lists the candidates at the "
                 "update engine, which were kept and why, and compares with brute force in "
                 "the reference. Then explains the first pair that differs, or else the winner"),
             "RUN:QUERY:FRAME:PRIMARY", [](const std::string& text) { (void)record_named(text); });
  known_words(verb->add_option("--from-test", o->line,
                               "Explain the pair in a line that a failing test or cde query "
                               "printed, with the command in it"),
              {}, "LINE");
  exact_card_option(*verb, o->exact);
  verb->get_option("--exact-card")->needs(verb->get_option("--from-record"));
  excludes(*verb, "--from-test", {"--from-record", "--exact-card"});
  begin_group(*verb, "Output");
  whole_number_in(
      verb->add_option("--max", o->most, "Most operations and candidates to list, by cycle; 0: all")
          ->capture_default_str(),
      0, 1000000, "");
  verb->add_flag("--json", o->json, "Print the first differences as JSON");
  quiet_flag(*verb);
  verb->callback([o, verb] { run(*verb, *o); });
}

}  // namespace cde::cli
