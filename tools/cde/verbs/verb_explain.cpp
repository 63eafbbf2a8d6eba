// SPDX-License-Identifier: Apache-2.0
// cde explain: one pair through one pipe, every operator beside the mirror reference's.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cde/support/error.hpp"
#include "command/values.hpp"
#include "command/words.hpp"
#include "explain/explanation.hpp"
#include "output/json_keys.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "verbs/explain_text.hpp"
#include "verbs/operand_defect.hpp"
#include "verbs/operand_line.hpp"
#include "verbs/pair_options.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

struct Options : PairOptions {
  std::vector<std::string> words;
  unsigned most = 100;
  bool json = false;
};

void run(const Options& o) {
  const PairConfig config = configuration(o);
  std::vector<std::uint64_t> a, b;
  std::string why;
  const std::string line = fmt::format("{}", fmt::join(o.words, " "));
  switch (read_operands(config.pair, WordText(config.format), "the pair", line, a, b, why)) {
    case OperandLine::kNothing:
      throw Error(ErrorCode::kUsage, "the words of a pair are missing");
    case OperandLine::kMalformed:
      throw Error(ErrorCode::kUsage, why);
    case OperandLine::kPair:
      break;
  }
  const explain::Explanation e = explain::explain(config, a, b, budget_of(o));
  if (o.json) {
    nlohmann::ordered_json j = {{"schema", "cde.explain.1"}};
    j.update(program_json());
    j.update({{"pair", o.pair},
              {"same", e.same()},
              {"operations", e.operations.size()},
              {"operations_found", e.found},
              {"first_differences", explanation_differences(e)}});
    put_json(j, 2);
  } else {
    put(explanation_text(words_of(o, e.config, false), e, o.most));
  }
  if (e.reference.bad) say("cde: {}\n", operand_defect(config.pair, config.format, a, b));
  if (!e.same()) exit_code = exit_status(ErrorCode::kMismatch);
}

}  // namespace

void add_explain(CLI::App& app) {
  auto o = std::make_shared<Options>();
  o->arithmetic = "rtl";
  CLI::App* verb = app.add_subcommand(
      "explain",
      "Send one pair through one pipe alone and set every operator of the card beside the same "
      "operation of the mirror reference, with its clock and its line of RTL. Where they part "
      "while "
      "all before is the same is where a wrong answer begins. Which operator does what is learnt "
      "from other pairs that go through with it. Exit status 3 if the answers differ");
  add_pair_options(*verb, *o, false);
  known_words(verb->add_option("words", o->words, "Words of A and of B, as cde query reads them")
                  ->required(),
              {}, "WORDS");
  whole_number_in(
      verb->add_option("--max", o->most, "Operations that are listed, by their clock; 0 for all")
          ->capture_default_str(),
      0, 1000000, "");
  verb->add_flag("--json", o->json, "The places where the sides part, as JSON");
  verb->callback([o] { run(*o); });
}

}  // namespace cde::cli
