// SPDX-License-Identifier: Apache-2.0
// cde help and cde version.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/version.hpp"
#include "options/help.hpp"
#include "options/values.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "program/programs.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

void print_help(const CLI::App& app, const std::string& verb, const std::string& inner) {
  std::string text;
  if (verb.empty()) {
    text = app.get_formatter()->make_help(&app, "", CLI::AppFormatMode::Normal);
  } else {
    const VerbEntry* entry = verb_elsewhere(verb);
    if (!inner.empty() && (entry == nullptr || !entry->own_verbs))
      throw_usage(fmt::format("cde {} has no inner verbs; remove {}", verb, in_quotes(inner)));
    if (entry != nullptr) {
      std::vector<std::string> words = {verb};
      if (!inner.empty()) words.push_back(inner);
      words.push_back("--help");
      exit_code = other_program(*entry, words);
      return;
    }
    for (const CLI::App* one : shown_verbs(app))
      if (one->get_name() == verb) text = one->help();
  }
  OutputFile out("-");
  out.write(text);
  out.commit();
}

}  // namespace

void add_version(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("version", "Print the versions of cde and its tools");
  verb->callback([] { print("{}\n", version_text()); });
}

void add_help(CLI::App& app) {
  auto verb_name = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("help", "Print the help of the program or of a verb");
  std::vector<std::string> verbs;
  for (const CLI::App* one : shown_verbs(app)) verbs.push_back(one->get_name());
  named(verb->add_option("verb", *verb_name, "A verb")->default_str("all of the program"), verbs,
        "VERB", "verb");
  auto inner = std::make_shared<std::string>();
  known_words(verb->add_option("inner", *inner, "A verb of that verb, as in cde help wave info"),
              {}, "VERB");
  verb->callback([&app, verb_name, inner] { print_help(app, *verb_name, *inner); });
}

}  // namespace cde::cli
