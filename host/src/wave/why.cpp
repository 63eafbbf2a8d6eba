// SPDX-License-Identifier: Apache-2.0
// cde wave why: explains a signal's value.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/text_map.hpp"
#include "cde/wave/cone.hpp"
#include "cde/wave/origin.hpp"
#include "cde/wave/request.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostValue = 24;   // characters per line
constexpr std::size_t kMostColumn = 56;  // of the column of names
constexpr const char* kInDoubt = "  (in doubt)";

/// The parts of SIGNAL@TIME.
struct Asked {
  Slice slice;
  Form form;
  std::uint64_t time = 0;
};

/// The design's bits for a signal of the waves, under any of its names.
std::optional<Slice> slice_of(Trace& trace, const Design& design, const Signal& signal) {
  if (const auto found = design.find(signal.name)) return found;
  for (const Signal& other : trace.signals()) {
    if (other.handle != signal.handle || other.width != signal.width) continue;
    if (const auto found = design.find(other.name)) return found;
  }
  return std::nullopt;
}

/// A signal that is not in the waves: by its full name, or by its name below the top module.
std::optional<Slice> hidden(const Design& design, const std::string& name) {
  const auto found = design.find(name);
  return found ? found : design.find(design.prefix() + "." + name);
}

Asked asked(const Request& r, Trace& trace, Times& times, const Design& design) {
  const std::string& word = r.words.front();
  const std::size_t sign = word.rfind('@');
  if (sign == std::string::npos || sign == 0 || sign + 1 == word.size())
    throw Error(ErrorCode::kUsage, fmt::format("{} is not SIGNAL@TIME", in_quotes(word)));
  Asked a;
  a.time = times.parse(word.substr(sign + 1));
  const std::string name = word.substr(0, sign);
  const std::size_t colon = name.rfind(':');
  a.form = r.default_form();
  std::string plain = name;
  if (colon != std::string::npos && name.find(']', colon) == std::string::npos) {
    if (const auto form = parse_form(name.substr(colon + 1))) {
      a.form = *form;
      plain = name.substr(0, colon);
    }
  }
  a.slice = slice_named(trace, design, name, plain, r.default_form());
  return a;
}

/// Formats values in the requested form, or in the file's form for each signal.
class Texts {
 public:
  Texts(Trace& trace, const Design& design, const Form& form) : design_(design), form_(form) {
    if (form.kind != Form::Kind::kFile) return;
    file_forms_.emplace(trace);
    for (const Signal& s : trace.signals()) {
      named_.try_emplace(s.name, &s);
      if (s.name.ends_with(']')) named_.try_emplace(without_array_scope(s.name), &s);
    }
  }
  [[nodiscard]] std::string of(const Node& n) const {
    if (!n.in_waves) return "not in the waves";
    if (n.value.empty()) return "?";
    View v;
    v.width = v.signal.width = static_cast<unsigned>(n.value.size());
    v.form = fitting(form_of(n), v.width);
    return v.text(n.value);
  }

 private:
  [[nodiscard]] Form form_of(const Node& n) const {
    if (form_.kind != Form::Kind::kFile) return form_;
    std::string name = design_.name(n.slice);
    auto found = named_.find(name);
    if (found == named_.end())
      found = named_.find(name.erase(std::min(name.rfind('['), name.size())));
    if (found == named_.end()) return {};
    const Form form = file_forms_->of(*found->second, form_);
    return form.kind == Form::Kind::kNames && n.value.size() != found->second->width ? Form{}
                                                                                     : form;
  }

  const Design& design_;
  const Form form_;
  std::optional<FileForms> file_forms_;  ///< if form_ leaves the form to the file
  TextMap<const Signal*> named_;
};

std::string shortened(const std::string& text) {
  return text.size() <= kMostValue ? text : text.substr(0, kMostValue - 3) + "...";
}

/// The longest scope that all names share, with the dot after it.
std::string common_scope(const std::vector<std::string>& names) {
  std::string scope = names.front();
  for (const std::string& name : names) {
    std::size_t n = 0;
    while (n < scope.size() && n < name.size() && scope[n] == name[n]) ++n;
    scope.resize(n);
  }
  const std::size_t dot = scope.rfind('.');
  return dot == std::string::npos ? "" : scope.substr(0, dot + 1);
}

/// Prints the tree as lines.
class Picture {
 public:
  Picture(const Cone& cone, const Design& design, const Times& times, const Texts& texts)
      : nodes_(cone.nodes()), design_(design), times_(times), texts_(texts) {
    std::vector<std::string> names;
    for (const Node& n : nodes_) names.push_back(design.name(n.slice));
    for (const Node& n : nodes_) names.push_back(design.name(n.driven));
    scope_ = common_scope(names);
    rows(0, 0);
  }

  [[nodiscard]] const std::string& scope() const { return scope_; }
  [[nodiscard]] std::string text() const {
    std::size_t name = 6, value = 5, clock = 5, place = 4;
    for (const Row& r : rows_) {
      name = std::max(name, std::min(r.name.size(), kMostColumn));
      value = std::max(value, r.value.size());
      clock = std::max(clock, r.clock.size());
      place = std::max(place, r.place.size());
    }
    std::string all = fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<{}}  {}\n", "signal", name, "value",
                                  value, "taken", clock, "line", place, "source");
    for (const Row& r : rows_)
      all += fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<{}}  {}\n", r.name, name, r.value, value,
                         r.clock, clock, r.place, place, r.source);
    return without_spaces(all);
  }

 private:
  struct Row {
    std::string name, value, clock, place, source;
  };

  /// The signal's name in the statement, and its connection if that is in another instance.
  [[nodiscard]] std::string name_of(const Node& node, bool root) const {
    std::string name =
        root ? design_.name(node.slice).substr(scope_.size()) : design_.local_name(node.slice);
    if (node.slice.unit == node.driven.unit) return name;
    const std::string here = design_.instance(node.slice), whole = design_.name(node.driven);
    const std::string there = whole.substr(whole.starts_with(here) ? here.size() : scope_.size());
    return there == name ? name : name + " <- " + there;
  }

  /// The label of a later statement, relative to the statements before it.
  [[nodiscard]] static const char* label(const Node& node, const Node::Statement& s) {
    if (node.statements.front().kept) return "since";
    return s.driver.sure ? "and" : "or";
  }

  void rows(std::size_t n, std::size_t depth) {
    const Node& node = nodes_[n];
    Row row;
    row.name = std::string(2 * depth, ' ') + (node.condition ? "if " : "") +
               printable_name(name_of(node, depth == 0));
    row.value = shortened(texts_.of(node));
    if (node.again) row.source = "(as elsewhere)";
    if (!node.remark.empty()) row.source = fmt::format("({})", node.remark);
    bool first = true;
    for (const Node::Statement& s : node.statements) {
      if (!first) row = Row{std::string(2 * depth, ' ') + label(node, s), "", "", "", ""};
      first = false;
      row.clock = s.edge ? times_.text(*s.edge) : "";
      row.place = printable_name(s.driver.place.name());
      row.source =
          s.kept ? "(kept: no statement was executed)" : printable_name(s.driver.place.text);
      if (!s.kept && !s.driver.sure) row.source += row.source.empty() ? kInDoubt + 2 : kInDoubt;
      rows_.push_back(row);
      for (const std::size_t cause : s.causes) rows(cause, depth + 1);
    }
    if (first) rows_.push_back(std::move(row));
  }

  const std::vector<Node>& nodes_;
  const Design& design_;
  const Times& times_;
  const Texts& texts_;
  std::string scope_;
  std::vector<Row> rows_;
};

/// `handed`: the bits that a node passes on if it is not in the waves.
Json json_of(const Cone& cone, const Design& design, const Times& times, const Texts& texts,
             std::size_t n, const std::string& handed = "") {
  const Node& node = cone.nodes()[n];
  const std::string& bits = node.value.empty() ? handed : node.value;
  Json j = {{"name", design.name(node.slice)}};
  if (node.driven != node.slice) j["driven_name"] = design.name(node.driven);
  j.update({{"time", times.number(node.time)},
            {"at", times.text(node.time)},
            {"in_waves", node.in_waves},
            {"value", node.value.empty() ? Json() : Json(texts.of(node))},
            {"bits", node.value.empty() ? Json() : Json(node.value)},
            {"condition", node.condition},
            {"repeated", node.again},
            {"remark", node.remark}});
  Json statements = Json::array();
  for (const Node::Statement& s : node.statements) {
    Json causes = Json::array(), as_it_is;
    const auto same = forwarded_cause(cone.nodes(), bits, s);
    for (const std::size_t cause : s.causes) {
      if (cause == same) as_it_is = causes.size();
      causes.push_back(json_of(cone, design, times, texts, cause, cause == same ? bits : ""));
    }
    statements.push_back({{"source_file", s.driver.place.file},
                          {"line", s.driver.place.line},
                          {"source_text", s.driver.place.text},
                          {"register", s.driver.kind == Driver::Kind::kRegister},
                          {"certain", s.driver.sure},
                          {"kept", s.kept},
                          {"forwarded_cause", as_it_is},
                          {"taken_time", s.edge ? Json(*s.edge) : Json()},
                          {"taken_at", s.edge ? Json(times.text(*s.edge)) : Json()},
                          {"causes", causes}});
  }
  j["statements"] = statements;
  return j;
}

}  // namespace

Slice slice_named(Trace& trace, const Design& design, const std::string& name,
                  const std::string& plain, const Form& form) {
  View v;
  try {
    v = view(trace, name, form);
  } catch (const Error&) {
    if (const auto found = hidden(design, plain)) return *found;
    throw;
  }
  if (v.signal.real || v.signal.event)
    throw Error(ErrorCode::kUsage, fmt::format("{} has kind {}; expected a signal of bits",
                                               printable_name(v.signal.name), v.signal.kind));
  auto found = slice_of(trace, design, v.signal);
  if (!found || found->width != v.signal.width)
    throw Error(
        ErrorCode::kUsage,
        fmt::format(
            "{} is in the waves, but {}: the design is {}", printable_name(v.signal.name),
            found ? fmt::format("has {} bits in the design", found->width) : "not in the design",
            printable_name(design.prefix())));
  found->low += v.signal.width - v.first - v.width;
  found->width = v.width;
  return *found;
}

std::string why_text(const Request& r) {
  if (r.words.size() != 1)
    throw Error(ErrorCode::kUsage,
                "cde wave why takes one signal and time: cde wave why FILE SIGNAL@TIME");
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  const Design design = Design::of(trace, r.structure);
  const Asked a = asked(r, trace, times, design);
  const Texts texts(trace, design, a.form);
  Lines lines(r.max);
  const Cone cone(trace, times, design, a.slice, a.time, static_cast<unsigned>(r.depth), lines);
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"top_scope", design.prefix()},
              {"depth", r.depth},
              {"cone", json_of(cone, design, times, texts, 0)},
              {"more", lines.more()}});
    return json_text(j) + '\n';
  }
  const Picture picture(cone, design, times, texts);
  const Node& root = cone.nodes().front();
  std::string cycle;
  if (times.clock_if_any() != nullptr)
    if (const auto number = times.cycle(a.time)) cycle = fmt::format(", cyc:{}", *number);
  std::string text = fmt::format("{} is {} at {}{}\n", printable_name(design.name(root.slice)),
                                 texts.of(root), times.text(a.time), cycle);
  if (cone.nodes().size() > 1 && !picture.scope().empty())
    text += fmt::format("names below are in {}\n",
                        printable_name(picture.scope().substr(0, picture.scope().size() - 1)));
  return text + picture.text() + lines.rest();
}

}  // namespace cde::wave
