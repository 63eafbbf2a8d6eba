// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "command/help.hpp"
#include "command/manual.hpp"
#include "command/values.hpp"

namespace cde::cli {
namespace {

using Kind = Takes::Kind;

/// Verbs as completions offer them: those of the help, and `help` takes their names.
std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> all;
  for (const CLI::App* verb : shown_verbs(app)) all.push_back(verb->get_name());
  return all;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> all;
  for (const CLI::Option* o : shown_options(app, false))
    for (const std::string& name : names(*o)) all.push_back(name);
  return all;
}

/// Up to the first full stop or semicolon: a completion has one line.
std::string brief(const std::string& text) {
  return text.substr(0, std::min({text.find(". "), text.find("; "), text.find(": ")}));
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string in_quotes(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

/// What bash does for a value.
std::string bash_value(const Takes& what) {
  switch (what.kind) {
    case Kind::kWord:
      return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", fmt::join(what.words, " "));
    case Kind::kFile:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")";
    case Kind::kFolder:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")";
    default:
      return ":";
  }
}

std::string zsh_value(const Takes& what) {
  const std::string label = replaced(what.label, ":", "\\:");
  switch (what.kind) {
    case Kind::kNothing:
      return "";
    case Kind::kWord:
      return fmt::format(":value:({})", fmt::join(what.words, " "));
    case Kind::kFile:
      return fmt::format(":{}:_files", label);
    case Kind::kFolder:
      return fmt::format(":{}:_files -/", label);
    default:
      return fmt::format(":{}: ", label);
  }
}

std::string zsh_text(const std::string& text) {
  return replaced(replaced(replaced(text, "\\", "\\\\"), "[", "\\["), "]", "\\]");
}

std::string fish_value(const Takes& what) {
  switch (what.kind) {
    case Kind::kNothing:
      return "";
    case Kind::kWord:
      return fmt::format(" -x -a '{}'", fmt::join(what.words, " "));
    case Kind::kFile:
      return " -r -F";
    case Kind::kFolder:
      return " -x -a '(__fish_complete_directories)'";
    default:
      return " -x";
  }
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string text =
      fmt::format(R"(# bash completion of cde. Written by cde itself from its parser.
_cde() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} verb= word
  # --option=value comes as three words.
  [[ $cur != = ]] || cur=
  [[ $prev != = ]] || prev=${{COMP_WORDS[COMP_CWORD-2]}}
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    [[ $word == -* ]] || {{ verb=$word; break; }}
  done
  case $verb in
    '') COMPREPLY=($(compgen -W '{} {}' -- "$cur")) ;;
)",
                  fmt::join(verb_names(app), " "), fmt::join(option_names(app), " "));
  for (const CLI::App* verb : shown_verbs(app)) {
    text += fmt::format("    {})\n      case $prev in\n", verb->get_name());
    for (const CLI::Option* o : shown_options(*verb, false)) {
      const Takes what = takes(*o);
      if (what.kind == Kind::kNothing) continue;
      text +=
          fmt::format("        {}) {}; return ;;\n", fmt::join(names(*o), "|"), bash_value(what));
    }
    text += fmt::format(
        "      esac\n      if [[ $cur == -* ]]; then\n        COMPREPLY=($(compgen -W '{}' -- "
        "\"$cur\"))\n",
        fmt::join(option_names(*verb), " "));
    const auto positional = shown_options(*verb, true);
    if (!positional.empty())
      text += fmt::format("      else\n        {}\n", bash_value(takes(*positional.front())));
    text += "      fi ;;\n";
  }
  return text + "  esac\n}\ncomplete -F _cde cde\n";
}

std::string zsh_completion(const CLI::App& app) {
  std::string text =
      "#compdef cde\n# zsh completion of cde. Written by cde itself from its parser.\n"
      "local curcontext=$curcontext state line\nlocal -a verbs\nverbs=(\n";
  for (const CLI::App* verb : shown_verbs(app))
    text +=
        "  " +
        in_quotes(verb->get_name() + ":" + replaced(brief(verb->get_description()), ":", "\\:")) +
        "\n";
  text += ")\n_arguments -C";
  for (const CLI::Option* o : shown_options(app, false))
    for (const std::string& name : names(*o))
      text += " \\\n  " + in_quotes(name + "[" + zsh_text(brief(o->get_description())) + "]");
  text +=
      " \\\n  '1: :->verb' '*:: :->rest' && return\n"
      "if [[ $state == verb ]]; then _describe verb verbs; return; fi\n"
      "case $words[1] in\n";
  for (const CLI::App* verb : shown_verbs(app)) {
    text += fmt::format("  {})\n    _arguments", verb->get_name());
    for (const CLI::Option* o : shown_options(*verb, false))
      for (const std::string& name : names(*o))
        text += " \\\n      " + in_quotes(name + "[" + zsh_text(brief(o->get_description())) + "]" +
                                          zsh_value(takes(*o)));
    for (const CLI::Option* o : shown_options(*verb, true))
      text +=
          " \\\n      " + in_quotes((o->get_expected_max() > 1 ? "*" : "") + zsh_value(takes(*o)));
    text += " ;;\n";
  }
  return text + "esac\n";
}

std::string fish_completion(const CLI::App& app) {
  const auto names_of = [](const CLI::Option& o) {
    std::string text;
    for (const std::string& name : o.get_snames()) text += " -s " + name;
    for (const std::string& name : o.get_lnames()) text += " -l " + name;
    return text;
  };
  std::string text =
      "# fish completion of cde. Written by cde itself from its parser.\ncomplete -c cde -f\n";
  for (const CLI::Option* o : shown_options(app, false))
    text += fmt::format("complete -c cde -n __fish_use_subcommand{} -d {}\n", names_of(*o),
                        in_quotes(brief(o->get_description())));
  for (const CLI::App* verb : shown_verbs(app)) {
    const std::string when =
        fmt::format("complete -c cde -n '__fish_seen_subcommand_from {}'", verb->get_name());
    text += fmt::format("complete -c cde -n __fish_use_subcommand -a {} -d {}\n", verb->get_name(),
                        in_quotes(brief(verb->get_description())));
    for (const CLI::Option* o : shown_options(*verb, true)) {
      const Takes what = takes(*o);
      if (what.kind == Kind::kWord || what.kind == Kind::kFile)
        text += when + replaced(fish_value(what), " -x", "") + "\n";
    }
    for (const CLI::Option* o : shown_options(*verb, false))
      text += fmt::format("{}{}{} -d {}\n", when, names_of(*o), fish_value(takes(*o)),
                          in_quotes(brief(o->get_description())));
  }
  return text;
}

}  // namespace cde::cli
