// SPDX-License-Identifier: Apache-2.0
#include "options/manual.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <algorithm>

#include "cde/support/version.hpp"
#include "options/help.hpp"
#include "options/verb_help.hpp"

namespace cde::cli {
namespace {

/// Text escaped for troff: hyphens stay the hyphens of options, and no line begins with a request.
std::string troff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  if (out.starts_with('.') || out.starts_with('\'')) out = "\\&" + out;
  return out;
}

std::string tagged(const std::string& head, const std::string& text) {
  return fmt::format(".TP\n\\fB{}\\fR\n{}\n", troff(head), troff(text));
}

/// Sections of arguments and options. Options with a heading are below it.
std::string options_of(const CLI::App& app) {
  std::string page;
  const auto positional = shown_options(app, true);
  if (!positional.empty()) page += ".SH ARGUMENTS\n";
  for (const CLI::Option* o : positional) page += tagged(option_head(*o), option_text(*o));
  page += ".SH OPTIONS\n";
  const auto groups = option_groups(app);
  for (const OptionGroup& group : groups) {
    if (groups.size() > 1) page += fmt::format(".SS {}\n", troff(group.heading));
    for (const CLI::Option* o : group.options) page += tagged(option_head(*o), option_text(*o));
  }
  return page;
}

}  // namespace

std::string page_name(const CLI::App& app) {
  std::string name = command_name(app);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string manual_page(const CLI::App& app) {
  const bool program = app.get_parent() == nullptr;
  const std::string name = page_name(app);
  const std::string text = app.get_description();
  const std::string first = text.substr(0, text.find(". "));
  std::string page = fmt::format(".TH {} 1 \"\" \"cde {}\" \"cde manual\"\n", name, kVersion);
  // apropos reads NAME, in one line.
  page += fmt::format(".SH NAME\n{} \\- {}\n", troff(name),
                      troff(program ? first.substr(first.find(": ") + 2) : first));
  page += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR\n", troff(usage_line(app)));
  page += fmt::format(".SH DESCRIPTION\n{}\n", troff(text));
  if (program) {
    page += ".SH VERBS\n";
    for (const CLI::App* verb : shown_verbs(app))
      page += tagged(page_name(*verb) + "(1)", verb->get_description());
  }
  page += options_of(app);
  page += ".SH EXAMPLES\n";
  for (const Example& e : examples(verb_name(app)))
    page += fmt::format(".PP\n{}:\n.PP\n.RS\n.nf\n{}\n.fi\n.RE\n", troff(e.what), troff(e.command));
  page += ".SH EXIT STATUS\n";
  for (const HelpEntry& e : exit_statuses(verb_name(app))) page += tagged(e.name, e.text);
  page += ".SH ENVIRONMENT\n";
  for (const HelpEntry& e : environment(verb_name(app))) page += tagged(e.name, e.text);
  page += ".SH SEE ALSO\n";
  const std::string documents =
      ".PP\n" +
      troff(
          "The documents are in share/doc/cde below the prefix of the installation, "
          "beside share/man: guides/accuracy.md, guides/scenes.md, guides/waves.md, "
          "reference/command.md and others.") +
      "\n";
  if (!program) return page + "\\fBcde\\fR(1)\n" + documents;
  std::string others;
  for (const CLI::App* verb : shown_verbs(app))
    others += fmt::format("{}\\fB{}\\fR(1)", others.empty() ? "" : ",\n", troff(page_name(*verb)));
  return page + others + "\n" + documents;
}

}  // namespace cde::cli
