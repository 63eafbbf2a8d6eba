// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/operand_line.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cde/support/error.hpp"
#include "geometry/operand_table.hpp"
#include "support/table_text.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

using text::TableText;

/// Word names as in messages about operands, without blanks: "center.x", "rotation[0][1]",
/// "half_height".
std::vector<std::string> word_names(Shape shape, char operand) {
  return with_shape<float>(shape, [operand]<class P>() {
    std::vector<std::string> names;
    const P primitive{};
    P::visit(primitive, [&](std::string name, const auto& field) {
      std::replace(name.begin(), name.end(), ' ', '_');
      name = fmt::format("{}.{}", operand, name);
      if constexpr (requires { field.size(); }) {
        for (int k = 0; k < static_cast<int>(field.size()); ++k)
          names.push_back(field.size() == 3 ? fmt::format("{}.{}", name, "xyz"[k])
                                            : fmt::format("{}[{}][{}]", name, k / 3, k % 3));
      } else {
        names.push_back(name);
      }
    });
    return names;
  });
}

Shape first_shape(PairName named) {
  return named.exchanged ? secondary_shape(named.pair) : primary_shape(named.pair);
}
Shape second_shape(PairName named) {
  return named.exchanged ? primary_shape(named.pair) : secondary_shape(named.pair);
}

std::string words_text(Shape shape) {
  const unsigned all = words(shape);
  return shape == Shape::kRay ? fmt::format("{} or {}", all - 2, all) : fmt::to_string(all);
}

}  // namespace

bool has_ray(Pair pair) {
  return primary_shape(pair) == Shape::kRay;
}

text::TableForm operand_table(PairName named) {
  const Shape a = first_shape(named), b = second_shape(named);
  text::TableForm form{.row = "pair", .names = word_names(a, 'A'), .bars = true};
  const std::size_t a_words = form.names.size();
  for (std::string& name : word_names(b, 'B')) form.names.push_back(std::move(name));
  const std::size_t most = form.names.size();
  for (const std::string& name : form.names)
    form.optional.push_back(name.ends_with(".tmin") || name.ends_with(".tmax"));
  form.widths = {most};
  if (has_ray(named.pair)) form.widths.push_back(most - 2);
  form.groups = {{"A", 0, a_words}, {"B", a_words, most - a_words}};
  form.expected = fmt::format("expected {}, in any order", fmt::join(form.names, ", "));
  if (has_ray(named.pair)) form.expected += "; tmin and tmax are optional";
  form.arrays = fmt::format(
      "pairs are (..., {}) numbers, {} words of A, a {}, and {} of B, a {}, or "
      "structures of A and B",
      has_ray(named.pair) ? fmt::format("{} or {}", most - 2, most) : fmt::to_string(most),
      words_text(a), name(a), words_text(b), name(b));
  return form;
}

void append_operands(PairName named, const std::vector<std::uint64_t>& words,
                     std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b) {
  auto &first = named.exchanged ? b : a, &second = named.exchanged ? a : b;
  const auto middle = words.begin() + cde::words(first_shape(named));
  first.insert(first.end(), words.begin(), middle);
  second.insert(second.end(), middle, words.end());
}

struct OperandText::Table {
  Table(PairName pair, const WordText& words)
      : named(pair), text(words), form(operand_table(pair)), rows(form) {
    for (const std::string& name : form.names)
      none.push_back(name.ends_with(".tmax") ? text.format().infinity() : 0);
  }

  PairName named;
  WordText text;
  text::TableForm form;
  TableText rows;
  std::vector<std::uint64_t> none;  ///< defaults of optional words
  std::vector<std::uint64_t> found;
  std::vector<text::Field> fields;  // of a line with a blank between A and B

  /// The fields, and the number of fields before the separator of A and B, if there is one.
  struct Parts {
    std::span<const text::Field> fields;
    std::size_t before = text::kNoBar;
  };
  [[nodiscard]] Parts parts();
  [[nodiscard]] std::string wrong_count(std::size_t count) const;
  [[nodiscard]] bool read(std::string& why, const std::string& where);
};

/// Finds the separator of A and B. A blank may stand for the | if commas or semicolons separate the
/// words: "0,0,0,1 1.5,0,0,1". More blanks are no separators, as decimal commas would look the
/// same.
OperandText::Table::Parts OperandText::Table::parts() {
  const Parts as_they_are{rows.fields(), rows.bar()};
  if (rows.separator() == text::Separator::kBlank || rows.bar() != text::kNoBar) return as_they_are;
  std::size_t found_at = text::kNoBar;
  for (std::size_t i = 0; i < as_they_are.fields.size(); ++i) {
    const std::string_view text = as_they_are.fields[i].text;
    if (std::none_of(text.begin(), text.end(), text::is_blank)) continue;
    if (found_at != text::kNoBar || as_they_are.fields[i].quoted) return as_they_are;
    found_at = i;
  }
  if (found_at == text::kNoBar) return as_they_are;
  std::string_view rest = as_they_are.fields[found_at].text;
  const std::string_view first = text::next_word(rest), second = text::next_word(rest);
  if (!text::trim(rest).empty()) return as_they_are;
  fields.assign(as_they_are.fields.begin(), as_they_are.fields.end());
  fields[found_at].text = first;
  fields.insert(fields.begin() + static_cast<std::ptrdiff_t>(found_at) + 1,
                {second, fields[found_at].column + (second.data() - first.data()), false});
  return {fields, found_at + 1};
}

std::string OperandText::Table::wrong_count(std::size_t count) const {
  if (rows.named()) return fmt::format("{} words; the header names {}", count, rows.columns());
  const std::size_t most = form.names.size();
  return fmt::format("{} words, must be {}{} ({} of A, {} of B)", count,
                     has_ray(named.pair) ? fmt::format("{} or ", most - 2) : "", most,
                     words_text(first_shape(named)), words_text(second_shape(named)));
}

/// Reads the row's words, in the order of the form's names.
bool OperandText::Table::read(std::string& why, const std::string& where) {
  const Parts parts = this->parts();
  const std::size_t count = parts.fields.size(), most = form.names.size();
  const bool ray = has_ray(named.pair), short_ray = !rows.named() && ray && count == most - 2;
  if (rows.named() ? count != rows.columns() : count != most && !short_ray) {
    why = fmt::format("{}: {}", where, wrong_count(count));
    // Two kinds of separators in a line may explain a wrong number of words.
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view word = parts.fields[i].text;
      if (std::none_of(word.begin(), word.end(),
                       [](char c) { return c == ',' || text::is_blank(c); }))
        continue;
      why = fmt::format("{}, word {}: {}", where, i + 1,
                        text::not_a_number(parts.fields[i], rows.separator()));
      break;
    }
    return false;
  }
  // A ray without an interval gets tmin = 0, tmax = +inf.
  found = none;
  const std::size_t a_words = words(first_shape(named));
  const std::size_t interval = named.exchanged ? most - 2 : 6;
  for (std::size_t i = 0; i < count; ++i) {
    std::string problem;
    const auto value = text.parse(parts.fields[i].text, problem);
    if (!value) {
      if (problem.ends_with(" is not a number") && !parts.fields[i].text.empty())
        problem = text::not_a_number(parts.fields[i], rows.separator());
      why = fmt::format("{}, word {}: {}", where, i + 1, problem);
      return false;
    }
    const std::size_t name = rows.name_of(i);
    found[short_ray && i >= interval ? name + 2 : name] = *value;
  }
  if (parts.before == text::kNoBar || rows.named()) return true;
  const std::size_t first = short_ray && !named.exchanged ? a_words - 2 : a_words;
  if (parts.before == first) return true;
  why = fmt::format("{}: {} word{} before the {}, of {} in all; A has {}", where, parts.before,
                    parts.before == 1 ? "" : "s", rows.bar() == text::kNoBar ? "blank" : "|", count,
                    first);
  return false;
}

OperandText::OperandText(PairName named, const WordText& text)
    : table_(std::make_unique<Table>(named, text)) {}
OperandText::OperandText(OperandText&&) noexcept = default;
OperandText& OperandText::operator=(OperandText&&) noexcept = default;
OperandText::~OperandText() = default;

bool OperandText::take_header(std::string_view line, const std::string& where) {
  bool is_header = false;
  if (const auto problem = table_->rows.read_header(line, is_header); problem && is_header)
    throw Error(ErrorCode::kFile,
                fmt::format("{}, column {}: {}", where, problem->column, problem->why));
  return is_header;
}

void OperandText::no_header() {
  table_->rows.no_header();
}

void OperandText::skip(std::uint64_t pairs) {
  table_->rows.skip_rows(pairs);
}

OperandLine OperandText::read(std::string_view line, const std::string& where,
                              std::vector<std::uint64_t>& a, std::vector<std::uint64_t>& b,
                              std::string& why) {
  why.clear();
  if (!has_pair(line)) {
    (void)take_header(line, where);  // a comment may be a header
    return OperandLine::kNothing;
  }
  if (take_header(line, where)) return OperandLine::kNothing;
  if (const auto problem = table_->rows.read_row(line)) {
    why = fmt::format("{}, column {}: {}", where, problem->column, problem->why);
    return OperandLine::kMalformed;
  }
  if (!table_->read(why, where)) return OperandLine::kMalformed;
  append_operands(table_->named, table_->found, a, b);
  return OperandLine::kPair;
}

bool OperandText::has_pair(std::string_view line) {
  const std::string_view content = text::trim(line);
  return !content.empty() && content.front() != '#';
}

std::string_view OperandText::first_line(std::string_view line, std::string_view name) {
  text::require_utf8(line, name);
  return text::without_mark(line);
}

OperandLine read_operands(PairName named, const WordText& text, const std::string& where,
                          std::string_view line, std::vector<std::uint64_t>& a,
                          std::vector<std::uint64_t>& b, std::string& why) {
  OperandText reader(named, text);
  reader.no_header();
  return reader.read(line, where, a, b, why);
}

}  // namespace cde
