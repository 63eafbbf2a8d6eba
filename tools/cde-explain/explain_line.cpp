// SPDX-License-Identifier: Apache-2.0
#include "explain_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <vector>

#include "cde/support/error.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::kUsage,
              fmt::format("--from-test: {}; expected a line with \"cde explain PAIR OPTIONS 'WORDS "
                          "OF A | WORDS OF B'\" or \"echo 'WORDS' | cde query PAIR OPTIONS\", as "
                          "failing tests and cde query print it",
                          why));
}

struct Word {
  std::string text;
  bool quoted = false;
};

/// Splits a line into words as a shell does, without expansions. A | that is not quoted is a word
/// by itself.
std::vector<Word> shell_words(const std::string& line) {
  std::vector<Word> words;
  Word word;
  bool open = false;
  const auto end = [&] {
    if (open) words.push_back(word);
    word = {};
    open = false;
  };
  char quote = 0;
  for (const char c : line) {
    const bool blank = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
      open = word.quoted = true;
    } else if (quote == 0 && (blank || c == '|' || c == ';')) {
      end();
      if (!blank) words.push_back({std::string(1, c)});
    } else {
      open = true;
      word.text += c;
    }
  }
  if (quote != 0) refuse("a quote is not closed");
  end();
  return words;
}

bool is_end(const Word& w) {
  return !w.quoted && (w.text == "|" || w.text == ";");
}
bool is_command(const Word& w) {
  return w.text == "cde" || w.text.ends_with("/cde");
}

}  // namespace

NamedPair pair_in_line(const std::string& line) {
  const std::vector<Word> words = shell_words(line);
  // The begin of the command. A command of explain comes first, because it contains its operands.
  std::optional<std::size_t> at;
  for (const char* verb : {"explain", "query"})
    for (std::size_t i = 0; !at && i + 1 < words.size(); ++i)
      if (is_command(words[i]) && words[i + 1].text == verb) at = i;
  if (!at) refuse(fmt::format("there is no such command in {}", in_quotes(line)));
  std::vector<std::string> typed;
  for (std::size_t i = *at + 1; i < words.size() && !is_end(words[i]); ++i)
    typed.push_back(words[i].text);

  NamedPair found;
  std::vector<std::string> operands;
  CLI::App app("", "cde");
  CLI::App* verb = app.add_subcommand(typed[0], "");
  if (typed[0] == "explain") found.options.arithmetic = "rtl";
  add_pair_options(*verb, found.options);
  known_words(verb->add_option("words", operands, ""), {}, "WORDS");
  // Further options of cde query change no answer, and are accepted.
  bool flag = false;
  std::string ignored;
  if (typed[0] == "query") {
    for (const char* option :
         {"--bits", "--json", "--no-bundle", "-q,--quiet", "--check,--no-check"})
      verb->add_flag(option, flag, "");
    for (const char* option : {"--trace", "--trace-window", "--trace-scope", "--bundle"})
      known_words(verb->add_option(option, ignored, ""), {}, "WORD");
  }
  try {
    std::vector<std::string> rest = normalise_arguments(app, typed);
    std::reverse(rest.begin(), rest.end());
    app.parse(rest);
  } catch (const CLI::ParseError& e) {
    refuse(e.what());
  } catch (const Error& e) {
    refuse(e.what());
  }
  if (operands.empty())
    for (std::size_t i = 0; i + 1 < *at; ++i)
      if (words[i].text == "echo" || words[i].text == "yes") operands = {words[i + 1].text};
  if (operands.empty()) refuse("the words of the pair are missing");
  found.words = fmt::format("{}", fmt::join(operands, " "));
  return found;
}

}  // namespace cde::cli
