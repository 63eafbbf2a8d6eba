// SPDX-License-Identifier: Apache-2.0
#include "scene/toml_reader.hpp"

// For some bad files toml++ asserts what it then reports as an error. With assertions enabled such
// a file would end the program.
#define TOML_ASSERT(expr) static_cast<void>(0)
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "support/text.hpp"

namespace cde::toml_reader {
namespace {

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string range_text(const Limits& limits) {
  const Limits all;
  if (limits.min <= all.min && limits.max >= all.max) return "a number of fp32";
  if (limits.max >= all.max) return fmt::format("{} {}", limits.above ? ">" : ">=", limits.min);
  return fmt::format("{} {} and <= {}", limits.above ? ">" : ">=", limits.min, limits.max);
}

/// Walks over the text outside of strings and comments, and refuses what toml++ would read with a
/// recursion that exceeds the stack. It agrees with toml++ up to the first syntax error.
class DepthCheck {
 public:
  DepthCheck(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  void run() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
      } else if (c == '"' || c == '\'') {
        skip_string(c);
      } else if (c == '.') {
        ++parts_;
      } else if (c == '[' || c == '{') {
        open_.push_back(depth_);
        depth_ += key_ + 1;
        key_ = 0;
        if (depth_ > kMost)
          fail(fmt::format("arrays and tables are nested {} deep; expected at most {}", depth_,
                           kMost));
      } else if (c == '=' || c == ',' || c == ']' || c == '}' || c == '\n') {
        end_key(c);
      }
    }
    end_key('\n');
  }

 private:
  static constexpr std::size_t kMost = 100;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::kFile, fmt::format("{}:{}: {}", printable_name(file_), line_, what));
  }

  void end_key(char c) {
    if (parts_ > kMost) fail(fmt::format("a key of {} parts; expected at most {}", parts_, kMost));
    key_ = c == '=' ? parts_ : 0;
    parts_ = 1;
    if (c == '\n') ++line_;
    if ((c != ']' && c != '}') || open_.empty()) return;
    depth_ = open_.back();
    open_.pop_back();
  }

  /// Moves to the last character of a string. A string that never ends is left to toml++.
  void skip_string(char quote) {
    const bool multiline = text_.substr(at_, 3) == std::string(3, quote);
    const std::size_t quotes = multiline ? 3 : 1;
    for (at_ += quotes; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\n') {
        if (!multiline) break;
        ++line_;
      }
      if (text_[at_] == '\\' && quote == '"' && text_.substr(at_ + 1, 1) != "\n") {
        ++at_;
      } else if (text_.substr(at_, quotes) == std::string(quotes, quote)) {
        at_ += quotes;
        // Two more quotes may belong to the text of a multi-line string.
        for (int i = 0; multiline && i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
        break;
      }
    }
    --at_;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0, line_ = 1;
  std::size_t parts_ = 1;          ///< of the key at this place
  std::size_t key_ = 0;            ///< parts of the key whose value begins
  std::size_t depth_ = 0;          ///< parts of keys count as tables
  std::vector<std::size_t> open_;  ///< depth around each open bracket
};

}  // namespace

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string* best = nullptr;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  if (word.size() > kLongestTyped) return "";
  const std::string_view now = new_name(word);
  if (std::find(candidates.begin(), candidates.end(), now) != candidates.end())
    return fmt::format("; it is now '{}'", now);
  for (const std::string& candidate : candidates) {
    const std::size_t d = edit_distance(word, candidate, least);
    if (d < least && d < candidate.size()) least = d, best = &candidate;
  }
  return best != nullptr ? fmt::format(" (did you mean '{}'?)", *best) : "";
}

std::shared_ptr<const toml::table> parse(std::string_view text, const std::string& file) {
  DepthCheck(text, file).run();
  try {
    return std::make_shared<const toml::table>(toml::parse(text, file));
  } catch (const toml::parse_error& e) {
    throw Error(ErrorCode::kFile,
                fmt::format("{}:{}:{}: {}", printable_name(file), e.source().begin.line,
                            e.source().begin.column, e.description()));
  }
}

// ---- Messages ----

std::string Table::path(const char* key) const {
  if (where_.empty()) return key;
  return *key == '\0' ? where_ : fmt::format("{}, {}", where_, key);
}

void Table::fail_at(ErrorCode code, const toml::source_position& at, const char* key,
                    const std::string& why) const {
  const std::string path = this->path(key);
  throw Error(code, fmt::format("{}:{}:{}: {}{}{}", printable_name(*file_), at.line, at.column,
                                path, path.empty() ? "" : ": ", printable_name(why)));
}

void Table::fail(ErrorCode code, const char* key, const std::string& why) const {
  const toml::node* node = *key != '\0' ? table_->get(key) : nullptr;
  fail_at(code, (node != nullptr ? *node : *table_).source().begin, key, why);
}

void Table::wrong_type(const char* key, const toml::node& node, const char* wanted) const {
  fail_at(ErrorCode::kFile, node.source().begin, key,
          fmt::format("must be {}, not {}", wanted, type_name(node)));
}

std::string Table::place() const {
  const auto& at = table_->source().begin;
  return fmt::format("{}:{}:{}", *file_, at.line, at.column);
}

void Table::also_known(const std::vector<std::string>& keys) {
  known_.insert(known_.end(), keys.begin(), keys.end());
}

const toml::node* Table::find(const char* key, bool optional) {
  known_.emplace_back(key);
  const toml::node* node = table_->get(key);
  if (node == nullptr && !optional) {
    std::string near;
    for (const auto& [other, value] : *table_) {
      if (std::find(known_.begin(), known_.end(), other.str()) == known_.end() &&
          !suggestion(other.str(), {key}).empty())
        near = fmt::format("; '{}' is not a key", other.str());
    }
    fail(ErrorCode::kFile, "", fmt::format("the key '{}' is missing{}", key, near));
  }
  return node;
}

void Table::finish() const {
  for (const auto& [key, value] : *table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    const std::string name(key.str());
    fail_at(ErrorCode::kFile, key.source().begin, "",
            fmt::format("there is no key {} here{}", in_quotes(name), suggestion(name, known_)));
  }
}

// ---- Values ----

bool Table::has(const char* key) const {
  return table_->contains(key);
}

std::string Table::text(const char* key, std::optional<std::string> fallback) {
  const toml::node* node = find(key, fallback.has_value());
  if (node == nullptr) return *fallback;
  const auto* value = node->as_string();
  if (value == nullptr) wrong_type(key, *node, "a text");
  return value->get();
}

bool Table::flag(const char* key, bool fallback) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return fallback;
  const auto* value = node->as_boolean();
  if (value == nullptr) wrong_type(key, *node, "true or false");
  return value->get();
}

double Table::number_of(const char* key, const toml::node& node, const Limits& limits) const {
  if (!node.is_number()) wrong_type(key, node, "a number");
  const double value = *node.value<double>();
  const bool legal =
      std::isinf(value)
          ? limits.infinite
          : value <= limits.max && (limits.above ? value > limits.min : value >= limits.min);
  if (!legal || std::isnan(value))
    fail_at(ErrorCode::kBadInput, node.source().begin, key,
            fmt::format("is {}; it must be {}", value, range_text(limits)));
  return value;
}

double Table::number(const char* key, std::optional<double> fallback, const Limits& limits) {
  const toml::node* node = find(key, fallback.has_value());
  return node != nullptr ? number_of(key, *node, limits) : *fallback;
}

std::optional<std::int64_t> Table::whole(const char* key, bool optional, std::int64_t min,
                                         std::int64_t max) {
  const toml::node* node = find(key, optional);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_integer();
  if (value == nullptr) wrong_type(key, *node, "a whole number");
  if (value->get() < min || value->get() > max)
    fail(key, fmt::format("is {}; it must be {} to {}", value->get(), min, max));
  return value->get();
}

Eigen::Vector3d Table::vector_of(const char* key, const toml::node& node) const {
  const toml::array* array = node.as_array();
  if (array == nullptr) wrong_type(key, node, "an array of 3 numbers");
  if (array->size() != 3)
    fail_at(ErrorCode::kFile, node.source().begin, key,
            fmt::format("must be an array of 3 numbers; it has {}", array->size()));
  Eigen::Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = number_of(key, (*array)[static_cast<std::size_t>(k)], {});
  return v;
}

Eigen::Vector3d Table::vector(const char* key, std::optional<Eigen::Vector3d> fallback) {
  const toml::node* node = find(key, fallback.has_value());
  return node != nullptr ? vector_of(key, *node) : *fallback;
}

std::vector<double> Table::numbers(const char* key, std::size_t count) {
  const toml::node* node = find(key, false);
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count)
    wrong_type(key, *node, fmt::format("an array of {} numbers", count).c_str());
  std::vector<double> values;
  for (const toml::node& value : *array) values.push_back(number_of(key, value, {}));
  return values;
}

std::vector<Eigen::Vector3d> Table::vectors(const char* key) {
  const toml::node* node = find(key, false);
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, *node, "an array of points");
  if (array->empty()) fail(key, "is empty");
  std::vector<Eigen::Vector3d> values;
  for (const toml::node& value : *array) values.push_back(vector_of(key, value));
  return values;
}

std::vector<std::string> Table::texts(const char* key) {
  const toml::node* node = find(key, false);
  const char* const wanted = "a text or an array of texts";
  if (const auto* one = node->as_string()) return {one->get()};
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, *node, wanted);
  if (array->empty()) fail(key, "is empty");
  std::vector<std::string> values;
  for (const toml::node& value : *array) {
    if (value.as_string() == nullptr) wrong_type(key, value, wanted);
    values.push_back(value.as_string()->get());
  }
  return values;
}

std::vector<Range> Table::number_ranges(const char* key, std::int64_t max) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, *node, "an array of numbers and \"FIRST..LAST\"");
  std::vector<Range> all;
  const auto add = [&](const toml::node& at, std::int64_t first, std::int64_t last) {
    if (first < 0 || last < first || last > max)
      fail_at(ErrorCode::kBadInput, at.source().begin, key,
              fmt::format("{}..{} must be ascending and within 0..{}", first, last, max));
    all.push_back({static_cast<std::size_t>(first), static_cast<std::size_t>(last - first + 1)});
  };
  for (const toml::node& value : *array) {
    if (const auto* number = value.as_integer()) {
      add(value, number->get(), number->get());
      continue;
    }
    if (value.as_string() == nullptr) wrong_type(key, value, "a number or \"FIRST..LAST\"");
    const std::string& range = value.as_string()->get();
    const std::size_t dots = range.find("..");
    std::int64_t first = 0, last = 0;
    if (dots == std::string::npos ||
        !text::parse_int(std::string_view(range).substr(0, dots), first) ||
        !text::parse_int(std::string_view(range).substr(dots + 2), last))
      fail_at(ErrorCode::kFile, value.source().begin, key,
              fmt::format("{} is not FIRST..LAST", in_quotes(range)));
    add(value, first, last);
  }
  std::sort(all.begin(), all.end(),
            [](const Range& a, const Range& b) { return a.first < b.first; });
  std::vector<Range> merged;
  for (const Range& range : all) {
    if (merged.empty() || range.first > merged.back().first + merged.back().count) {
      merged.push_back(range);
      continue;
    }
    Range& before = merged.back();
    before.count = std::max(before.count, range.first + range.count - before.first);
  }
  return merged;
}

std::size_t Table::choice(const char* key, const std::vector<std::string>& words,
                          std::optional<std::size_t> fallback) {
  if (fallback && !has(key)) {
    (void)find(key, true);
    return *fallback;
  }
  const std::string word = text(key);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    fail(key, fmt::format("{} is not one of {}{}", in_quotes(word), fmt::join(words, ", "),
                          suggestion(word, words)));
  return static_cast<std::size_t>(found - words.begin());
}

std::optional<Table> Table::table(const char* key) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) wrong_type(key, *node, "a table");
  return Table(*file_, *node->as_table(), path(key));
}

Tables Table::tables(const char* key) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return {};
  if (node->is_table()) return {Table(*file_, *node->as_table(), path(key))};
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, *node, "a table or an array of tables");
  if (array->empty()) fail(key, "is empty");
  Tables all;
  for (const toml::node& value : *array) {
    if (!value.is_table()) wrong_type(key, value, "a table");
    all.emplace_back(*file_, *value.as_table(), fmt::format("{} {}", path(key), all.size()));
  }
  return all;
}

std::string Table::one_of(const std::vector<std::string>& keys) {
  also_known(keys);
  std::vector<std::string> there;
  for (const std::string& key : keys)
    if (has(key.c_str())) there.push_back(key);
  if (there.size() > 1)
    fail(ErrorCode::kFile, there[1].c_str(),
         fmt::format("excludes '{}'; there must be one of {}", there[0], fmt::join(keys, ", ")));
  if (there.empty()) {
    for (const auto& [key, value] : *table_) {
      const std::string name(key.str()), meant = suggestion(name, keys);
      if (!meant.empty() && std::find(known_.begin(), known_.end(), name) == known_.end())
        fail_at(ErrorCode::kFile, key.source().begin, "",
                fmt::format("there is no key {} here{}", in_quotes(name), meant));
    }
    fail(ErrorCode::kFile, "", fmt::format("there must be one of {}", fmt::join(keys, ", ")));
  }
  return there[0];
}

}  // namespace cde::toml_reader
