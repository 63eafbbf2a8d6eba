// SPDX-License-Identifier: Apache-2.0
#include "support/table_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cde/support/message.hpp"
#include "support/text.hpp"

namespace cde::text {
namespace {

constexpr std::string_view kUnnamed = "Unnamed: 0";  // as written by pandas

char character(Separator separator) {
  constexpr std::string_view kAll = " \t,;";
  return kAll[static_cast<std::size_t>(separator)];
}
std::string_view plural(Separator separator) {
  constexpr std::string_view kAll[] = {"blanks", "tabs", "commas", "semicolons"};
  return kAll[static_cast<std::size_t>(separator)];
}

Separator separator_of(std::string_view line, const SplitLine& known) {
  if (!known.may_have_quotes || line.find('"') == std::string_view::npos) {
    if (known.may_have_semicolons && line.find(';') != std::string_view::npos)
      return Separator::kSemicolon;
    if (line.find(',') != std::string_view::npos) return Separator::kComma;
    const std::string_view inner = trim(line);
    return inner.find('\t') != std::string_view::npos ? Separator::kTab : Separator::kBlank;
  }
  bool quoted = false, comma = false, tab = false;
  for (const char c : trim(line)) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == ';') return Separator::kSemicolon;
    comma = comma || c == ',';
    tab = tab || c == '\t';
  }
  return comma ? Separator::kComma : tab ? Separator::kTab : Separator::kBlank;
}

/// Splits fields off the front of a line.
class Splitter {
 public:
  Splitter(std::string_view line, bool bars, SplitLine& to)
      : line_(line), bars_(bars), to_(to), mark_(character(to.separator)) {}

  std::optional<Problem> split() {
    const bool blanks = to_.separator == Separator::kBlank;
    for (;;) {
      start_ = at_;
      skip_pad();
      if (blanks && at_ == line_.size()) return std::nullopt;
      if (!(blanks && at_bar()))
        if (auto problem = take()) return problem;
      if (at_bar()) {
        if (to_.bar != kNoBar) return Problem{at_ + 1, "a second |; expected one, between A and B"};
        to_.bar = to_.fields.size();
      }
      if (at_ == line_.size()) return std::nullopt;
      if (!blanks || at_bar()) ++at_;
    }
  }

 private:
  [[nodiscard]] bool at_bar() const { return bars_ && at_ < line_.size() && line_[at_] == '|'; }
  [[nodiscard]] bool at_separator() const {
    return to_.separator == Separator::kBlank ? is_blank(line_[at_]) : line_[at_] == mark_;
  }
  void skip_pad() {
    while (at_ < line_.size() && is_blank(line_[at_]) && line_[at_] != mark_) ++at_;
    if (to_.separator == Separator::kBlank)
      while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
  }

  std::optional<Problem> take() {
    const std::size_t first = at_;
    if (at_ < line_.size() && line_[at_] == '"') return take_quoted();
    while (at_ < line_.size() && !at_separator() && !at_bar()) ++at_;
    std::size_t end = at_;
    while (end > first && is_blank(line_[end - 1])) --end;
    to_.fields.push_back(
        {line_.substr(first, end - first), (end == first ? start_ : first) + 1, false});
    return std::nullopt;
  }

  std::optional<Problem> take_quoted() {
    const std::size_t first = at_, close = line_.find('"', first + 1);
    if (close == std::string_view::npos) return Problem{first + 1, "a quote is not closed"};
    to_.fields.push_back({trim(line_.substr(first + 1, close - first - 1)), first + 1, true});
    at_ = close + 1;
    if (at_ < line_.size() && to_.separator == Separator::kBlank && at_separator())
      return std::nullopt;
    skip_pad();
    if (at_ < line_.size() && !at_separator() && !at_bar())
      return Problem{at_ + 1,
                     fmt::format("text after a closing quote; {} separate the fields of this line",
                                 plural(to_.separator))};
    return std::nullopt;
  }

  std::string_view line_;
  bool bars_;
  SplitLine& to_;
  char mark_;
  std::size_t start_ = 0, at_ = 0;
};

/// Whether the text may be a name, and is not a number.
bool is_name(std::string_view text) {
  if (text.empty()) return false;
  const char c = text.front();
  if (!(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && c != '_') return false;
  float value = 0;
  return parse_float(text, value) == Number::kMalformed;
}

}  // namespace

std::optional<Problem> split(std::string_view line, bool bars, SplitLine& to) {
  to.fields.clear();
  to.bar = kNoBar;
  to.separator = separator_of(line, to);
  return Splitter(line, bars, to).split();
}

std::string not_a_number(const Field& field, Separator separator) {
  std::string text = in_quotes(field.text) + " is not a number";
  if (field.text.find(',') != std::string_view::npos)
    text += separator == Separator::kSemicolon
                ? ""
                : "; a decimal comma is read where semicolons separate the fields";
  else if (std::any_of(field.text.begin(), field.text.end(), is_blank))
    text += fmt::format("; {} separate the fields of this line", plural(separator));
  return text;
}

std::optional<Problem> TableText::read(std::string_view line, Kind& kind) {
  kind = Kind::kNothing;
  const std::string_view content = trim(line);
  if (content.empty()) return std::nullopt;
  if (content.front() == '#') {
    take_comment(content.substr(1), kind);
    return std::nullopt;
  }
  if (!begun_) {
    bool is_header = false;
    if (auto problem = read_header(line, is_header)) return problem;
    if (is_header) {
      kind = Kind::kHeader;
      return std::nullopt;
    }
  }
  kind = Kind::kRow;
  return read_row(line);
}

std::optional<Problem> TableText::read_header(std::string_view line, bool& is_header) {
  is_header = false;
  if (begun_) return std::nullopt;
  const std::string_view content = trim(line);
  if (content.empty()) return std::nullopt;
  if (content.front() == '#') {
    Kind kind = Kind::kNothing;
    take_comment(content.substr(1), kind);
    is_header = kind == Kind::kHeader;
    return std::nullopt;
  }
  if (auto problem = split(line, form_.bars, line_)) return problem;
  if (!looks_like_header()) return std::nullopt;
  is_header = begun_ = true;
  return take_names(line);
}

void TableText::look_at(std::string_view all) {
  line_.may_have_quotes = all.find('"') != std::string_view::npos;
  line_.may_have_semicolons = all.find(';') != std::string_view::npos;
}

bool TableText::looks_like_header() const {
  const auto& fields = line_.fields;
  if (fields.empty()) return false;
  const std::size_t first = fields.size() > 1 && fields[0].text.empty() ? 1 : 0;
  return is_name(fields[first].text);
}

std::optional<Problem> TableText::take_names(std::string_view line) {
  const auto& fields = line_.fields;
  named_ = true;
  numbered_ = fields[0].text.empty() || fields[0].text == kUnnamed;
  // An empty first name appears only as a blank.
  may_be_numbered_ = !numbered_ && line_.separator == Separator::kBlank && is_blank(line.front());
  names_.clear();
  std::vector<bool> seen(form_.names.size());
  for (std::size_t i = numbered_ ? 1 : 0; i < fields.size(); ++i) {
    const auto found = std::find(form_.names.begin(), form_.names.end(), fields[i].text);
    if (found == form_.names.end())
      return Problem{fields[i].column, fmt::format("unknown column {}; {}",
                                                   in_quotes(fields[i].text), form_.expected)};
    const auto name = static_cast<std::size_t>(found - form_.names.begin());
    if (seen[name])
      return Problem{fields[i].column,
                     fmt::format("column '{}' appears twice; {}", *found, form_.expected)};
    seen[name] = true;
    names_.push_back(name);
  }
  for (std::size_t name = 0; name < seen.size(); ++name)
    if (!seen[name] && !form_.optional[name])
      return Problem{line.size() + 1,
                     fmt::format("column '{}' is missing; {}", form_.names[name], form_.expected)};
  return std::nullopt;
}

void TableText::take_comment(std::string_view line, Kind& kind) {
  if (begun_ || split(line, form_.bars, line_) || line_.fields.empty()) return;
  for (const Field& field : line_.fields)
    if (std::find(form_.names.begin(), form_.names.end(), field.text) == form_.names.end()) return;
  TableText named(form_);
  named.line_ = line_;
  if (named.take_names(trim(line))) return;  // a comment about some columns, not a header
  named_ = true;
  names_ = std::move(named.names_);
  kind = Kind::kHeader;
}

std::optional<Problem> TableText::read_row(std::string_view line) {
  begun_ = true;
  fields_ = {};
  const std::uint64_t row = rows_++;
  if (auto problem = split(line, form_.bars, line_)) return problem;
  fields_ = line_.fields;
  if (std::exchange(may_be_numbered_, false)) numbered_ = fields_.size() == names_.size() + 1;
  if (numbered_)
    if (auto problem = take_row_number(row)) return problem;
  return line_.separator == Separator::kSemicolon ? take_decimal_commas(line) : std::nullopt;
}

std::optional<Problem> TableText::take_row_number(std::uint64_t row) {
  constexpr std::string_view kWhy =
      "the first column has no name, so it must hold row numbers, counted from 0 or 1";
  if (fields_.empty()) return std::nullopt;
  const Field& field = fields_.front();
  std::uint64_t number = 0;
  if (!parse_int(field.text, number))
    return Problem{field.column,
                   fmt::format("{} is not a row number: {}", in_quotes(field.text), kWhy)};
  if (!first_number_ && (number == row || number == row + 1)) first_number_ = number - row;
  if (!first_number_ || number != row + *first_number_)
    return Problem{field.column, fmt::format("row number {}, expected {}: {}", number,
                                             first_number_ ? fmt::to_string(row + *first_number_)
                                             : row == 0    ? "0 or 1"
                                                           : fmt::format("{} or {}", row, row + 1),
                                             kWhy)};
  fields_ = fields_.subspan(1);
  if (line_.bar != kNoBar && line_.bar > 0) --line_.bar;
  return std::nullopt;
}

/// Replaces decimal commas by points. A table with both is an error, since one of them would
/// separate thousands.
std::optional<Problem> TableText::take_decimal_commas(std::string_view line) {
  if (form_.bars) mark_ = 0;  // several readers may share the lines of pairs
  bool copied = false;
  for (Field& field : fields_) {
    const std::size_t mark = field.text.find_first_of(".,");
    if (mark == std::string_view::npos) continue;
    const char c = field.text[mark];
    if (mark_ != 0 && mark_ != c)
      return Problem{field.column + mark,
                     fmt::format("{} has a decimal {}, and a number before it a decimal {}",
                                 in_quotes(field.text), c == ',' ? "comma" : "point",
                                 mark_ == ',' ? "comma" : "point")};
    mark_ = c;
    if (c != ',') continue;
    if (!std::exchange(copied, true)) points_ = line;
    const auto first = static_cast<std::size_t>(field.text.data() - line.data());
    points_[first + mark] = '.';
    const std::string_view number = std::string_view(points_).substr(first, field.text.size());
    float value = 0;
    if (parse_float(number, value) != Number::kMalformed) field.text = number;
  }
  return std::nullopt;
}

}  // namespace cde::text
