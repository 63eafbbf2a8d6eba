// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

/// @file
/// Text for people. Parts of it may come from files.
namespace cde {

/// The text with escapes for what would control a terminal. Control characters other than line feed
/// and tab, and characters that change the writing direction, become `\x1b` or `\u202e`. Bytes that
/// are not UTF-8 become `\xff`.
[[nodiscard]] std::string printable(std::string_view text);

/// The same, with line feeds and tabs escaped as well: for names within a line.
[[nodiscard]] std::string printable_name(std::string_view name);

/// A word of a file or of the command line, for a message: escaped, quoted and shortened.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// An error message of readable length. In a word of more than 1,000 characters the middle is left
/// out: `first 100...last 50 (N characters)`. The same holds for a message of more than 6,000
/// characters, which keeps its first 4,000 and last 1,000.
[[nodiscard]] std::string shortened(std::string_view message);

/// The same as printable() for JSON text, whose strings name such characters as `\u001b`. Line
/// feeds stay.
[[nodiscard]] std::string printable_json(std::string_view json);

/// The text with U+FFFD in place of bytes that are not UTF-8, for JSON and pages.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// Writes a message to stderr after printable(). Write errors are ignored; it throws nothing.
void log(std::string_view text);

}  // namespace cde
