// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "cde/wave/card_signals.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {

std::optional<std::string> field_of(const Transaction& t, std::string_view name) {
  if (name == "kind") return t.kind;
  if (name == "label") return t.label;
  if (name == "scope") return t.scope;
  if (name == "outcome") return t.outcome;
  if (name == "begin") return fmt::to_string(t.begin);
  if (name == "end") return fmt::to_string(t.end);
  if (name == "latency") return fmt::to_string(t.end - t.begin);
  if (name == "stalls") return t.stalls ? std::optional(fmt::to_string(*t.stalls)) : std::nullopt;
  for (const auto& [key, value] : t.fields)
    if (key == name) return value;
  return std::nullopt;
}

std::vector<std::string> field_names(const std::vector<std::string>& kinds) {
  std::vector<std::string> names = {"kind", "begin", "end", "latency", "stalls", "outcome"};
  for (const KindSignals& k : card_signals()) {
    if (!kinds.empty() && std::find(kinds.begin(), kinds.end(), k.kind) == kinds.end()) continue;
    for (const auto f : k.fields)
      if (std::find(names.begin(), names.end(), f) == names.end()) names.emplace_back(f);
  }
  names.emplace_back("label");
  names.emplace_back("scope");
  return names;
}

std::optional<double> as_number(std::string_view text) {
  const char* const stop = text.data() + text.size();
  if (text.starts_with("0x")) {
    std::uint64_t whole = 0;
    const auto read = std::from_chars(text.data() + 2, stop, whole, 16);
    if (read.ec != std::errc() || read.ptr != stop) return std::nullopt;
    return static_cast<double>(whole);
  }
  // from_chars also accepts inf and nan, which T may be.
  double value = 0;
  const auto read = std::from_chars(text.data(), stop, value);
  if (text.empty() || read.ec != std::errc() || read.ptr != stop) return std::nullopt;
  return value;
}

struct Filter::Node {
  enum class Kind { kOr, kAnd, kNot, kCompare };
  Kind kind = Kind::kCompare;
  std::unique_ptr<Node> a, b;
  std::string field, op, value;
  std::optional<double> number;  ///< the value as a number
};

namespace {

using Node = Filter::Node;

class FilterParser {
 public:
  FilterParser(const std::string& text, const std::vector<std::string>& kinds, Times& times)
      : text_(text), names_(field_names(kinds)), times_(times) {}

  std::unique_ptr<Node> parse() {
    auto root = either();
    skip();
    if (at_ != text_.size()) fail(at_, "&&, || or the end is expected here");
    return root;
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw Error(ErrorCode::kUsage,
                fmt::format("--where: {}\n  {}\n  {}^", what, printable_name(text_),
                            std::string(std::min(at, text_.size()), ' ')));
  }
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(std::string_view what) {
    skip();
    if (!std::string_view(text_).substr(at_).starts_with(what)) return false;
    at_ += what.size();
    return true;
  }
  static std::unique_ptr<Node> join(Node::Kind kind, std::unique_ptr<Node> a,
                                    std::unique_ptr<Node> b) {
    auto n = std::make_unique<Node>();
    n->kind = kind;
    n->a = std::move(a);
    n->b = std::move(b);
    return n;
  }

  std::unique_ptr<Node> either() {
    auto a = both();
    while (take("||")) a = join(Node::Kind::kOr, std::move(a), both());
    return a;
  }
  std::unique_ptr<Node> both() {
    auto a = one();
    while (take("&&")) a = join(Node::Kind::kAnd, std::move(a), one());
    return a;
  }
  std::unique_ptr<Node> one() {
    if (++depth_ > 200) fail(at_, "this is nested too deeply");
    std::unique_ptr<Node> n;
    if (take("!")) {
      n = join(Node::Kind::kNot, one(), nullptr);
    } else if (take("(")) {
      n = either();
      if (!take(")")) fail(at_, "a ) is expected here");
    } else {
      n = comparison();
    }
    --depth_;
    return n;
  }
  std::unique_ptr<Node> comparison() {
    skip();
    const std::size_t at = at_;
    auto n = std::make_unique<Node>();
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
      n->field.push_back(text_[at_++]);
    if (n->field.empty()) fail(at, "a field is expected here");
    if (std::find(names_.begin(), names_.end(), n->field) == names_.end())
      fail(at,
           fmt::format("no field {}; {}", in_quotes(n->field), suggestion_text(n->field, names_)));
    for (const std::string_view op : {"==", "!=", "<=", ">=", "=", "<", ">", "~"}) {
      if (!take(op)) continue;
      n->op = op == "=" ? "==" : op;
      break;
    }
    if (n->op.empty()) fail(at_, "==, !=, <, <=, >, >= or ~ is expected here");
    value(*n);
    return n;
  }
  void value(Node& n) {
    skip();
    const std::size_t at = at_;
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    const bool quoted = quote == '\'' || quote == '"';
    if (quoted) {
      const std::size_t stop = text_.find(quote, at_ + 1);
      if (stop == std::string::npos) fail(at, "the end of this text is missing");
      n.value = text_.substr(at_ + 1, stop - at_ - 1);
      at_ = stop + 1;
    } else {
      while (at_ < text_.size() &&
             std::string_view(" &|()=<>!~'\"").find(text_[at_]) == std::string_view::npos)
        n.value.push_back(text_[at_++]);
      if (n.value.empty()) fail(at, "a value is expected here");
    }
    n.number = as_number(n.value);
    const bool time = n.field == "begin" || n.field == "end", length = n.field == "latency";
    if (n.number || (!time && !length) || n.op == "~") return;
    // Times are in units of the file.
    if (length) {
      n.number = times_.length(n.value);
      if (!n.number) fail(at, "a length of time is expected here: a number, or 100ns");
      return;
    }
    try {
      n.number = static_cast<double>(times_.parse(n.value));
    } catch (const Error& e) {
      fail(at, e.what());
    }
  }

  const std::string& text_;
  std::vector<std::string> names_;
  Times& times_;
  std::size_t at_ = 0;
  unsigned depth_ = 0;
};

bool holds(const Node& n, const Transaction& t) {
  switch (n.kind) {
    case Node::Kind::kOr:
      return holds(*n.a, t) || holds(*n.b, t);
    case Node::Kind::kAnd:
      return holds(*n.a, t) && holds(*n.b, t);
    case Node::Kind::kNot:
      return !holds(*n.a, t);
    case Node::Kind::kCompare:
      break;
  }
  const auto field = field_of(t, n.field);
  if (!field) return n.op == "!=";
  if (n.op == "~") return matches(n.value, *field);
  const auto number = n.number ? as_number(*field) : std::nullopt;
  if (n.op == "==") return number ? *number == *n.number : *field == n.value;
  if (n.op == "!=") return number ? *number != *n.number : *field != n.value;
  if (!number) return false;
  if (n.op == "<") return *number < *n.number;
  if (n.op == "<=") return *number <= *n.number;
  return n.op == ">" ? *number > *n.number : *number >= *n.number;
}

}  // namespace

Filter::Filter(const std::string& text, const std::vector<std::string>& kinds, Times& times)
    : root_(FilterParser(text, kinds, times).parse()) {}
Filter::~Filter() = default;
Filter::Filter(Filter&&) noexcept = default;

bool Filter::matches(const Transaction& t) const {
  return holds(*root_, t);
}

}  // namespace cde::wave
