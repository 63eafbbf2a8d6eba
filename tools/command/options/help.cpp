// SPDX-License-Identifier: Apache-2.0
#include "options/help.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "options/values.hpp"
#include "options/verb_help.hpp"
#include "output/output.hpp"

namespace cde::cli {
namespace {

constexpr std::size_t kIndent = 2, kColumn = 26;

std::size_t terminal_width() {
  std::size_t columns = 0;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  // COLUMNS sets the width where stdout is a pipe, for example into a pager.
  if (columns == 0)
    if (const char* text = std::getenv("COLUMNS"))  // NOLINT(concurrency-mt-unsafe)
      columns = std::strtoul(text, nullptr, 10);
  if (columns == 0) columns = 80;
  return std::clamp<std::size_t>(columns, 40, 120);
}

/// Text of a help page, wrapped as it is added.
class Page {
 public:
  Page(std::size_t width, bool colour) : width_(width), colour_(colour) {}

  void paragraph(std::string_view text, std::size_t indent = 0) {
    for (const std::string& line : wrapped(text, width_ - indent))
      text_ += std::string(indent, ' ') + line + "\n";
  }
  /// Adds a line without wrapping, so that a command can be copied.
  void line(const std::string& text) { text_ += text + "\n"; }
  void heading(const std::string& text) { text_ += "\n" + in_bold(text, colour_) + "\n"; }

  /// A name on the left and its meaning on the right, or below a long name.
  void entry(const std::string& name, std::string_view text) {
    const std::size_t column = std::min(kColumn, width_ / 2);
    std::string line = std::string(kIndent, ' ') + in_bold(name, colour_);
    std::size_t used = kIndent + name.size();
    if (used + 1 >= column) {
      text_ += line + "\n";
      line.clear();
      used = 0;
    }
    for (const std::string& part : wrapped(text, width_ - column)) {
      text_ += line + std::string(column - used, ' ') + part + "\n";
      line.clear();
      used = 0;
    }
    if (!line.empty()) text_ += line + "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::size_t width_;
  bool colour_;
  std::string text_;
};

void add_options(Page& page, const CLI::App& app) {
  const auto positional = shown_options(app, true);
  if (!positional.empty()) page.heading("Arguments");
  for (const CLI::Option* o : positional) page.entry(option_head(*o), option_text(*o));
  for (const OptionGroup& group : option_groups(app)) {
    page.heading(group.heading);
    for (const CLI::Option* o : group.options) page.entry(option_head(*o), option_text(*o));
  }
}

class Formatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string /*name*/,
                        CLI::AppFormatMode /*mode*/) const override {
    Page page(terminal_width(), may_colour(STDOUT_FILENO));
    page.paragraph(app->get_description());
    page.heading("Usage");
    page.paragraph(usage_line(*app), kIndent);
    const auto verbs = shown_verbs(*app);
    if (!verbs.empty()) page.heading("Verbs");
    for (const CLI::App* verb : verbs) {
      const std::string text = verb->get_description();
      page.entry(verb->get_name(), text.substr(0, text.find(". ")));
    }
    add_options(page, *app);
    const auto& all = examples(verb_name(*app));
    if (!all.empty()) page.heading("Examples");
    for (const Example& example : all) {
      page.paragraph(example.what + ":", kIndent);
      page.line("    " + example.command);
    }
    page.heading("Exit status");
    for (const HelpEntry& e : exit_statuses(verb_name(*app))) page.entry(e.name, e.text);
    page.heading("Environment");
    for (const HelpEntry& e : environment(verb_name(*app))) page.entry(e.name, e.text);
    return page.text();
  }
};

}  // namespace

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t stop = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, stop - at);
    at = stop + 1;
    if (word.empty()) continue;
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      lines.push_back(line);
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<const CLI::Option*> shown_options(const CLI::App& app, bool positional) {
  return app.get_options([positional](const CLI::Option* o) {
    return !o->get_group().empty() && o->get_positional() == positional;
  });
}

void begin_group(CLI::App& verb, const std::string& heading) {
  verb.option_defaults()->group(heading);
  verb.get_help_ptr()->group(heading);
}

std::vector<OptionGroup> option_groups(const CLI::App& app) {
  std::vector<const CLI::Option*> options = shown_options(app, false);
  std::stable_partition(options.begin(), options.end(),
                        [&](const CLI::Option* o) { return o != app.get_help_ptr(); });
  std::vector<OptionGroup> groups;
  for (const CLI::Option* o : options) {
    const auto same = [o](const OptionGroup& g) { return g.heading == o->get_group(); };
    auto group = std::find_if(groups.begin(), groups.end(), same);
    if (group == groups.end()) group = groups.insert(group, {o->get_group(), {}});
    group->options.push_back(o);
  }
  return groups;
}

std::vector<const CLI::App*> shown_verbs(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* verb) { return !verb->get_group().empty() && !verb->get_name().empty(); });
}

std::string command_name(const CLI::App& app) {
  if (app.get_parent() == nullptr) return app.get_name();
  return command_name(*app.get_parent()) + ' ' + app.get_name();
}

std::string verb_name(const CLI::App& app) {
  const std::string name = command_name(app);
  return name == "cde" ? "" : name.substr(name.find(' ') + 1);
}

std::string usage_line(const CLI::App& app) {
  std::string line = command_name(app) + (app.get_parent() == nullptr ? " VERB" : "");
  for (const CLI::Option* o : shown_options(app, true)) {
    const std::string head = option_head(*o);
    line += o->get_required() ? " " + head : " [" + head + "]";
  }
  return line + " [OPTIONS]";
}

std::string option_head(const CLI::Option& option) {
  const Takes what = takes(option);
  if (option.get_positional()) {
    std::string name = option.get_name(true);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name + (option.get_expected_max() > 1 ? " ..." : "");
  }
  const std::string head = fmt::format("{}", fmt::join(names(option), ", "));
  return what.label.empty() ? head : head + " " + what.label;
}

std::string option_text(const CLI::Option& option) {
  std::string text = option.get_description();
  const std::string value = option.get_default_str();
  if (!value.empty() && value.front() == '[')
    text += " " + value;  // a list
  else if (!value.empty())
    text += fmt::format(" [{}]", value);
  return text;
}

bool may_colour(int stream) {
  const char* no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe)
  const char* terminal = std::getenv("TERM");       // NOLINT(concurrency-mt-unsafe)
  return on_terminal(stream) && (no_colour == nullptr || *no_colour == '\0') &&
         terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string in_bold(const std::string& text, bool colour) {
  return colour ? "\033[1m" + text + "\033[0m" : text;
}

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  return std::make_shared<Formatter>();
}

}  // namespace cde::cli
