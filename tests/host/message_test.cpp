// SPDX-License-Identifier: Apache-2.0
// Text from files, before it is printed.
#include "cde/support/message.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "cde/support/shell_word.hpp"

namespace cde {
namespace {

using namespace std::string_literals;

TEST(ShellWord, ControlCharacters_StayOnOneLine) {
  EXPECT_EQ(shell_word("a/b.toml"), "a/b.toml");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("1\n2\x1b'\\"), "$'1\\0122\\033\\'\\\\'");
}

TEST(Message, ControlCharacters_ArePrintedEscaped) {
  EXPECT_EQ(printable("plain, \xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\n\t"),
            "plain, \xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\n\t");
  EXPECT_EQ(printable("\x1b[31m\r\a\x7f\0."s), "\\x1b[31m\\x0d\\x07\\x7f\\x00.");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m")
      << "CSI in eight bits";
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b\xe2\x81\xa6"),
            "a\\u202eb\\u2066");
  EXPECT_EQ(printable_name("two\nlines\tand"), "two\\x0alines\\x09and");
  EXPECT_EQ(printable("a\xd8\x9c."), "a\\u061c.");
  EXPECT_EQ(printable_json("{\n \"a\x7f\xc2\x9b\"}"), "{\n \"a\\u007f\\u009b\"}");
}

TEST(Message, LongWords_LoseTheirMiddle) {
  const std::string path(990, 'p');
  EXPECT_EQ(shortened(path + ":12: wrong"), path + ":12: wrong");
  const std::string word = std::string(100, 'a') + std::string(1'000'000, 'b');
  const std::string cut =
      std::string(100, 'a') + "..." + std::string(50, 'b') + " (1000100 characters)";
  EXPECT_EQ(shortened("x: '" + word + "': wrong\nsecond line"),
            "x: '" + cut + "': wrong\nsecond line");
  EXPECT_EQ(shortened(word + ": wrong " + word), cut + ": wrong " + cut);
  std::string accents;
  for (int i = 0; i < 1001; ++i) accents += "\xc3\xa9";
  EXPECT_EQ(shortened(accents),
            accents.substr(0, 200) + "..." + accents.substr(0, 100) + " (1001 characters)");
  EXPECT_EQ(shortened(std::string(2000, ':')).size(), 2000u) << "marks alone are no word";
}

TEST(Message, LongMessages_LoseTheirMiddle) {
  std::string words = "first ";
  while (words.size() < 1'000'000) words += "12 ";
  const std::string cut = shortened(words + "last");
  EXPECT_TRUE(cut.starts_with("first 12 "));
  EXPECT_TRUE(cut.ends_with(fmt::format("last ({} characters)", words.size() + 4))) << cut;
  EXPECT_LT(cut.size(), 5100u);
  EXPECT_EQ(shortened(words.substr(0, 6000)), words.substr(0, 6000));
}

/// The sequences of Unicode's table 3-8, and others at the edges of table 3-7.
TEST(Message, InvalidUtf8_IsReplaced) {
  const auto replaced = [](std::string_view text) { return valid_utf8(text); };
  const std::string mark = "\xef\xbf\xbd";
  EXPECT_EQ(replaced("\x61\xf1\x80\x80\xe1\x80\xc2\x62\x80\x63\x80\xbf\x64"),
            "a" + mark + mark + mark + "b" + mark + "c" + mark + mark + "d");
  for (const char* bad : {"\xc0\x80", "\xc1\xbf", "\xf5\x80", "\xff\xfe"})
    EXPECT_EQ(replaced(bad), mark + mark) << bad;
  EXPECT_EQ(replaced("\xed\xa0\x80"), mark + mark + mark) << "a surrogate";
  EXPECT_EQ(replaced("\xe0\x9f\xbf"), mark + mark + mark) << "overlong form";
  EXPECT_EQ(replaced("\xf4\x90\x80\x80"), mark + mark + mark + mark) << "beyond U+10FFFF";
  for (const char* good : {"\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_EQ(replaced(good), good);
  EXPECT_EQ(replaced("\xe2\x82"), mark) << "cut short";
  EXPECT_EQ(printable("\xff\xe2\x82."), "\\xff\\xe2\\x82.");
}

}  // namespace
}  // namespace cde
