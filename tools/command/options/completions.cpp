// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "options/completions.hpp"

namespace cde::cli {
namespace {

using Kind = Takes::Kind;

std::vector<std::string> verb_names(const VerbTable& table) {
  std::vector<std::string> all;
  for (const VerbTable& verb : table.verbs) all.push_back(verb.name);
  return all;
}

/// "-o", "--output".
std::vector<std::string> names_of(const OptionEntry& o) {
  std::vector<std::string> all;
  for (const std::string& name : o.short_names) all.push_back("-" + name);
  for (const std::string& name : o.long_names) all.push_back("--" + name);
  return all;
}

std::vector<std::string> option_names(const VerbTable& table) {
  std::vector<std::string> all;
  for (const OptionEntry& o : table.options)
    for (std::string& name : names_of(o)) all.push_back(std::move(name));
  return all;
}

const OptionEntry* first_positional(const VerbTable& table) {
  for (const OptionEntry& o : table.options)
    if (o.positional) return &o;
  return nullptr;
}

/// The text up to the first full stop or semicolon. A completion has one line.
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

/// The bash command that completes a value.
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

/// The bash case for the words after a verb. `key` is the verb, or the verb and its inner verb.
std::string bash_verb(const std::string& key, const VerbTable& verb) {
  std::string text = fmt::format("    '{}')\n      case $prev in\n", key);
  for (const OptionEntry& o : verb.options)
    if (!o.positional && o.takes.kind != Kind::kNothing)
      text += fmt::format("        {}) {}; return ;;\n", fmt::join(names_of(o), "|"),
                          bash_value(o.takes));
  text += fmt::format(
      "      esac\n      if [[ $cur == -* ]]; then\n        COMPREPLY=($(compgen -W '{}' -- "
      "\"$cur\"))\n",
      fmt::join(option_names(verb), " "));
  if (const OptionEntry* o = first_positional(verb))
    text += fmt::format("      else\n        {}\n", bash_value(o->takes));
  return text + "      fi ;;\n";
}

std::string zsh_arguments(const VerbTable& verb, const std::string& indent) {
  std::string text = indent + "_arguments";
  for (const OptionEntry& o : verb.options)
    for (const std::string& name : names_of(o))
      text += " \\\n" + indent + "  " +
              in_quotes(name + "[" + zsh_text(brief(o.text)) + "]" + zsh_value(o.takes));
  for (const OptionEntry& o : verb.options)
    if (o.positional)
      text += " \\\n" + indent + "  " + in_quotes((o.list ? "*" : "") + zsh_value(o.takes));
  return text;
}

std::string fish_options(const std::string& when, const VerbTable& verb) {
  std::string text;
  for (const OptionEntry& o : verb.options) {
    if (o.positional) {
      if (o.takes.kind == Kind::kWord || o.takes.kind == Kind::kFile)
        text += when + replaced(fish_value(o.takes), " -x", "") + "\n";
      continue;
    }
    std::string names;
    for (const std::string& name : o.short_names) names += " -s " + name;
    for (const std::string& name : o.long_names) names += " -l " + name;
    text +=
        fmt::format("{}{}{} -d {}\n", when, names, fish_value(o.takes), in_quotes(brief(o.text)));
  }
  return text;
}

}  // namespace

std::string bash_completion(const VerbTable& program) {
  std::string nested;
  for (const VerbTable& verb : program.verbs)
    if (!verb.verbs.empty()) nested += verb.name + ' ';
  std::string text = fmt::format(R"(# bash completion of cde. Written by cde itself from its parser.
_cde() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} verb= word
  # bash passes --option=value as three words.
  [[ $cur != = ]] || cur=
  [[ $prev != = ]] || prev=${{COMP_WORDS[COMP_CWORD-2]}}
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    [[ $word == -* ]] && continue
    [[ -z $verb ]] || {{ verb+=" $word"; break; }}
    verb=$word
    [[ ' {}' == *" $verb "* ]] || break
  done
  case $verb in
    '') COMPREPLY=($(compgen -W '{} {}' -- "$cur")) ;;
)",
                                 nested, fmt::join(verb_names(program), " "),
                                 fmt::join(option_names(program), " "));
  for (const VerbTable& verb : program.verbs) {
    if (verb.verbs.empty()) {
      text += bash_verb(verb.name, verb);
      continue;
    }
    text += fmt::format("    {}) COMPREPLY=($(compgen -W '{} {}' -- \"$cur\")) ;;\n", verb.name,
                        fmt::join(verb_names(verb), " "), fmt::join(option_names(verb), " "));
    for (const VerbTable& inner : verb.verbs)
      text += bash_verb(verb.name + ' ' + inner.name, inner);
  }
  return text + "  esac\n}\ncomplete -F _cde cde\n";
}

std::string zsh_completion(const VerbTable& program) {
  const auto described = [](const VerbTable& table) {
    std::string text = "(\n";
    for (const VerbTable& verb : table.verbs)
      text += "  " + in_quotes(verb.name + ":" + replaced(brief(verb.text), ":", "\\:")) + "\n";
    return text + ")\n";
  };
  std::string text =
      "#compdef cde\n# zsh completion of cde. Written by cde itself from its parser.\n"
      "local curcontext=$curcontext state line\nlocal -a verbs\nverbs=" +
      described(program) + "_arguments -C";
  for (const OptionEntry& o : program.options)
    for (const std::string& name : names_of(o))
      text += " \\\n  " + in_quotes(name + "[" + zsh_text(brief(o.text)) + "]");
  text +=
      " \\\n  '1: :->verb' '*:: :->rest' && return\n"
      "if [[ $state == verb ]]; then _describe verb verbs; return; fi\n"
      "case $words[1] in\n";
  for (const VerbTable& verb : program.verbs) {
    text += fmt::format("  {})\n", verb.name);
    if (verb.verbs.empty()) {
      text += zsh_arguments(verb, "    ") + " ;;\n";
      continue;
    }
    text += "    if (( CURRENT == 2 )); then verbs=" + described(verb) +
            "      _describe verb verbs; return; fi\n    shift words; (( CURRENT-- ))\n"
            "    case $words[1] in\n";
    for (const VerbTable& inner : verb.verbs)
      text += fmt::format("    {})\n{} ;;\n", inner.name, zsh_arguments(inner, "      "));
    text += "    esac ;;\n";
  }
  return text + "esac\n";
}

std::string fish_completion(const VerbTable& program) {
  std::string text =
      "# fish completion of cde. Written by cde itself from its parser.\ncomplete -c cde -f\n";
  text += fish_options("complete -c cde -n __fish_use_subcommand", program);
  const auto verb_line = [](const std::string& when, const VerbTable& verb) {
    return fmt::format("complete -c cde -n {} -a {} -d {}\n", when, verb.name,
                       in_quotes(brief(verb.text)));
  };
  for (const VerbTable& verb : program.verbs) {
    text += verb_line("__fish_use_subcommand", verb);
    const std::string seen = "__fish_seen_subcommand_from " + verb.name;
    if (verb.verbs.empty())
      text += fish_options(fmt::format("complete -c cde -n '{}'", seen), verb);
    const std::string inner_names = fmt::format("{}", fmt::join(verb_names(verb), " "));
    for (const VerbTable& inner : verb.verbs) {
      text += verb_line(
          fmt::format("'{}; and not __fish_seen_subcommand_from {}'", seen, inner_names), inner);
      text +=
          fish_options(fmt::format("complete -c cde -n '{}; and __fish_seen_subcommand_from {}'",
                                   seen, inner.name),
                       inner);
    }
  }
  return text;
}

}  // namespace cde::cli
