// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "options/cli_fwd.hpp"

/// Layout of `cde --help` and `cde help VERB`, and parts that the manual shares with them.
namespace cde::cli {

/// Text broken at blanks into lines of at most `width` characters. A longer word has a line of its
/// own.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// The options of an app that help and manual show: the positional ones, or all others.
[[nodiscard]] std::vector<const CLI::Option*> shown_options(const CLI::App& app, bool positional);
/// Puts options that are added to `verb` from here on under this heading. --help goes with the last
/// group.
void begin_group(CLI::App& verb, const std::string& heading);
struct OptionGroup {
  std::string heading;
  std::vector<const CLI::Option*> options;
};
/// The shown options that are not positional, by heading, in the order of adding.
[[nodiscard]] std::vector<OptionGroup> option_groups(const CLI::App& app);
/// Verbs that are not hidden.
[[nodiscard]] std::vector<const CLI::App*> shown_verbs(const CLI::App& app);
/// The words that start an app: "cde", "cde cast", "cde wave info".
[[nodiscard]] std::string command_name(const CLI::App& app);
/// The same without "cde": "", "cast", "wave info".
[[nodiscard]] std::string verb_name(const CLI::App& app);
/// "cde cast MESH [OPTIONS]".
[[nodiscard]] std::string usage_line(const CLI::App& app);
/// "--size WxH", with all names of the option.
[[nodiscard]] std::string option_head(const CLI::Option& option);
/// The description and the default.
[[nodiscard]] std::string option_text(const CLI::Option& option);

/// Whether text on this stream (1 or 2) may be coloured: the stream is a terminal, TERM is not
/// dumb, and NO_COLOR is not set.
[[nodiscard]] bool may_colour(int stream);
[[nodiscard]] std::string in_bold(const std::string& text, bool colour);

/// Formatter of help for the app and its verbs. It is as wide as the terminal on stdout, or 80
/// columns without one.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace cde::cli
