// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/operand_line.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cde {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Takes a word off the front of a line: up to a comma or blank, with the blanks and the one comma
/// behind it. False at the end. Between two commas, and behind a last one, is an empty word. A | is
/// a word, also without blanks around it.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) { skip_blanks(); }
  bool next(std::string_view& word) {
    if (rest_.empty() && !comma_) return false;
    std::size_t length = 0;
    while (length < rest_.size() && rest_[length] != ',' && rest_[length] != '|' &&
           !is_blank(rest_[length]))
      ++length;
    if (rest_.starts_with('|')) length = 1;
    word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    skip_blanks();
    comma_ = !rest_.empty() && rest_.front() == ',';
    if (comma_) rest_.remove_prefix(1), skip_blanks();
    return true;
  }

 private:
  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
  }
  std::string_view rest_;
  bool comma_ = false;
};

}  // namespace

bool has_ray(Pair pair) {
  return name(pair).starts_with("ray-");
}

OperandLine read_operands(PairName named, const WordText& text, const std::string& where,
                          std::string_view line, std::vector<std::uint64_t>& a,
                          std::vector<std::uint64_t>& b, std::string& why) {
  Words words(line);
  const std::size_t a_words = primary_words(named.pair), b_words = secondary_words(named.pair);
  const std::size_t most = a_words + b_words, least = has_ray(named.pair) ? most - 2 : most;
  const std::size_t a_before = a.size();
  why.clear();
  std::size_t count = 0, before_bar = 0;
  bool bar = false;
  for (std::string_view word; words.next(word);) {
    if (word == "|" && !bar) {
      bar = true;
      before_bar = count;
      continue;
    }
    if (count == 0 && word.starts_with('#')) return OperandLine::kNothing;
    ++count;
    if (count > most || !why.empty()) continue;
    std::string problem;
    if (const auto value = text.parse(word, problem))
      a.push_back(*value);  // all of them for now
    else
      why = fmt::format("{}, word {}: {}", where, count, problem);
  }
  if (count == 0) return OperandLine::kNothing;
  const std::size_t first_words = named.exchanged ? b_words : count - b_words;
  if (count != most && count != least) {
    const std::string a_text =
        least == most ? fmt::to_string(a_words) : fmt::format("{} or {}", a_words - 2, a_words);
    const std::string b_text = fmt::to_string(b_words);
    why = fmt::format("{}: {} words, must be {}{} ({} of A, {} of B)", where, count,
                      least == most ? "" : fmt::format("{} or ", least), most,
                      named.exchanged ? b_text : a_text, named.exchanged ? a_text : b_text);
  } else if (bar && why.empty() && before_bar != first_words) {
    why = fmt::format("{}: {} words before the |, of {} in all; A has {}", where, before_bar, count,
                      first_words);
  }
  if (!why.empty()) {
    a.resize(a_before);
    return OperandLine::kMalformed;
  }
  // A ray without an interval has all of it: tmin = 0, tmax = +inf.
  const auto begin = static_cast<std::ptrdiff_t>(a_before);
  if (named.exchanged)
    std::rotate(a.begin() + begin, a.begin() + begin + static_cast<std::ptrdiff_t>(b_words),
                a.end());
  if (count < most) a.insert(a.begin() + begin + 6, {0, text.format().infinity()});
  const auto middle = a.begin() + begin + static_cast<std::ptrdiff_t>(a_words);
  b.insert(b.end(), middle, a.end());
  a.erase(middle, a.end());
  return OperandLine::kPair;
}

}  // namespace cde
