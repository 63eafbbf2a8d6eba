// SPDX-License-Identifier: Apache-2.0
#include "wave/vcd_body.hpp"

#include <fmt/format.h>

#include <charconv>

#include "cde/support/message.hpp"
#include "wave/vcd_header.hpp"

namespace cde::wave {
namespace {

/// Identifiers with numbers below this limit are looked up in a table.
constexpr std::size_t kMostShort = 1u << 22;
constexpr std::size_t kTooLong = ~std::size_t{0};

/// A unique number for each identifier of up to four characters.
std::size_t identifier_number(std::string_view identifier) {
  if (identifier.empty() || identifier.size() > 4) return kTooLong;
  std::size_t number = 0;
  for (std::size_t i = identifier.size(); i-- > 0;) {
    const auto c = static_cast<unsigned char>(identifier[i]);
    if (c < '!' || c > '~') return kTooLong;
    number = number * 94 + (c - '!' + 1u);
  }
  return number < kMostShort ? number : kTooLong;
}

}  // namespace

VcdIdentifiers::VcdIdentifiers(const std::vector<std::string>& identifiers)
    : next_(identifiers.size() + 1, 0) {
  for (std::size_t i = identifiers.size(); i-- > 0;) {
    const auto handle = static_cast<std::uint32_t>(i + 1);
    const std::size_t number = identifier_number(identifiers[i]);
    std::uint32_t* place = nullptr;
    if (number == kTooLong) {
      place = &long_[identifiers[i]];
    } else {
      if (short_.size() <= number) short_.resize(number + 1, 0);
      place = &short_[number];
    }
    next_[handle] = *place;
    *place = handle;
  }
}

std::uint32_t VcdIdentifiers::find(std::string_view identifier) const {
  const std::size_t number = identifier_number(identifier);
  if (number != kTooLong) return number < short_.size() ? short_[number] : 0;
  const auto found = long_.find(identifier);
  return found == long_.end() ? 0 : found->second;
}

void VcdBody::fail(const std::string& what) const {
  if (words_.cut()) throw VcdCut();
  words_.fail(what);
}

bool VcdBody::step(VcdEvents& events) {
  std::string_view word;
  if (!words_.next(word)) return false;
  offset_ = words_.offset();
  line_ = words_.line();
  switch (word[0]) {
    case '#':
      return time(events, word.substr(1));
    case '0':
    case '1':
    case 'x':
    case 'X':
    case 'z':
    case 'Z':
    case 'U':
    case 'W':
    case 'L':
    case 'H':
    case 'u':
    case 'w':
    case 'l':
    case 'h':
    case '-': {
      if (word.size() > 1) return change(events, 'b', word.substr(0, 1), word.substr(1));
      value_ = word;
      return change(events, 'b', value_, identifier());
    }
    case 'b':
    case 'B':
      return vector(events, 'b', word);
    case 'r':
    case 'R':
      return vector(events, 'r', word);
    case 's':
    case 'S':
      return text(events, word);
    case 'p':
      return port(events, word);
    case '$':
      return keyword(events, word);
    default:
      fail(
          fmt::format("{}; expected a time #N, a value 0, 1, x, z, b..., r... or s... with an "
                      "identifier, or a word with $",
                      in_quotes(word)));
  }
}

bool VcdBody::time(VcdEvents& events, std::string_view digits) {
  std::uint64_t now = 0;
  // Accepts "3.0" from writers that count in floating point.
  if (const std::size_t point = digits.find('.');
      point != std::string_view::npos && point + 1 < digits.size() &&
      digits.find_first_not_of('0', point + 1) == std::string_view::npos)
    digits = digits.substr(0, point);
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), now);
  if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() ||
      now > UINT64_MAX / factor_)
    fail(fmt::format("time {}; expected a whole number from 0 up to {}", in_quotes(digits),
                     UINT64_MAX / factor_));
  return events.time(now * factor_);
}

std::string_view VcdBody::identifier() {
  std::string_view word;
  if (!words_.next(word)) {
    if (words_.cut()) throw VcdCut();
    words_.fail("the file ends after a value; expected its identifier");
  }
  return word;
}

bool VcdBody::change(VcdEvents& events, char kind, std::string_view value,
                     std::string_view identifier) {
  const std::uint32_t first = identifiers_.find(identifier);
  if (first == 0)
    fail(fmt::format("no signal has the identifier {}; expected one of a $var",
                     in_quotes(identifier)));
  for (std::uint32_t handle = first; handle != 0; handle = identifiers_.next(handle))
    if (!events.change(handle, kind, value, dumped_)) return false;
  return true;
}

bool VcdBody::vector(VcdEvents& events, char kind, std::string_view word) {
  value_ = word.substr(1);
  if (value_.starts_with("0b")) value_.erase(0, 2);  // "b0b0101" of PyMTL3
  if (!value_.empty()) return change(events, kind, value_, identifier());
  // Some writers put "b 0101 !". But "b !" is a value without bits.
  value_ = identifier();
  if (identifiers_.find(value_) != 0) return change(events, kind, "", value_);
  return change(events, kind, value_, identifier());
}

/// Reads a text value. Some writers put blanks in it, so its identifier is the last word of the
/// line.
bool VcdBody::text(VcdEvents& events, std::string_view word) {
  value_ = word.substr(1);
  const std::string_view second = identifier();
  if (identifiers_.find(second) != 0 || words_.line() != line_)
    return change(events, 's', value_, second);
  words_.again();
  std::string rest(words_.rest_of_line());
  while (!rest.empty() && static_cast<unsigned char>(rest.back()) <= ' ') rest.pop_back();
  const std::size_t blank = rest.find_last_of(" \t");
  if (blank == std::string::npos) return change(events, 's', value_, rest);
  value_ += ' ' + rest.substr(0, blank);
  return change(events, 's', value_, rest.substr(blank + 1));
}

bool VcdBody::port(VcdEvents& events, std::string_view word) {
  value_ = word.substr(1);
  if (value_.empty()) value_ = identifier();
  (void)identifier();  // two strengths
  (void)identifier();
  return change(events, 'p', value_, identifier());
}

bool VcdBody::keyword(VcdEvents& events, std::string_view word) {
  if (word == "$end") {
    dumped_ = false;
  } else if (word == "$dumpvars" || word == "$dumpall" || word == "$dumpports" ||
             word == "$dumpportsall") {
    dumped_ = true;
  } else if (word == "$dumpoff" || word == "$dumpportsoff") {
    dumped_ = true;
    events.dumps(false);
  } else if (word == "$dumpon" || word == "$dumpportson") {
    dumped_ = true;
    events.dumps(true);
  } else if (word == "$comment" || word == "$vcdclose") {
    const std::string name(word);
    if (words_.cut()) throw VcdCut();
    std::string text = joined(vcd_section(words_, name));
    if (name == "$comment") events.comment(utf8_text(std::move(text)));
  } else if (word != "$dumpflush" && word != "$dumpportsflush" && word != "$dumplimit") {
    fail(
        fmt::format("{} among the changes; expected $dumpvars, $dumpall, $dumpon, $dumpoff, "
                    "$comment or $end",
                    in_quotes(word)));
  }
  return true;
}

}  // namespace cde::wave
