// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

/// Text for people, some of which may come from files.
namespace cde {

/// The text without what would control a terminal: control characters but line feeds and tabs, and
/// those that turn the direction of writing, as \x1b and \u202e; bytes that are no UTF-8 as \xff.
[[nodiscard]] std::string printable(std::string_view text);

/// The same without line feeds and tabs: for names that stand within a line.
[[nodiscard]] std::string printable_name(std::string_view name);

/// A word of a file or of the command line within a message: the same in quotes, and not long.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The same as printable() for a text in JSON, whose strings name such characters as \u001b. Line
/// feeds stay.
[[nodiscard]] std::string printable_json(std::string_view json);

/// The text with U+FFFD in place of bytes that are no UTF-8, for JSON and pages.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// A message on stderr, made printable. What cannot be written is lost, and nothing is thrown.
void say(std::string_view text);

}  // namespace cde
