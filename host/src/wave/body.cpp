// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <utility>

namespace cde::wave {
namespace {

constexpr std::array<std::string_view, 14> kStatements = {
    "assign",   "assigndly", "if",        "case",      "begin",   "while", "taskref",
    "stmtexpr", "display",   "jumpblock", "jumplabel", "comment", "stop",  "finish"};

/// Line and column of the first element with a place.
std::pair<unsigned, unsigned> begin_of(const netlist::Element& e) {
  const std::string_view place = e.attribute("loc");
  std::pair<unsigned, unsigned> at{};
  if (const std::size_t comma = place.find(','); comma != std::string_view::npos) {
    const char* const stop = place.data() + place.size();
    const auto line = std::from_chars(place.data() + comma + 1, stop, at.first);
    if (line.ptr != stop) std::from_chars(line.ptr + 1, stop, at.second);
    return at;
  }
  for (const netlist::Element* child : e.children()) {
    at = begin_of(*child);
    if (at.first != 0) break;
  }
  return at;
}

/// Whether Verilator has turned if (!c) a; else b; into if (c) b; else a;.
bool is_swapped(const netlist::Element& e) {
  if (e.children().size() != 3) return false;
  const auto yes = begin_of(*e.child(1)), no = begin_of(*e.child(2));
  return yes.first != 0 && no.first != 0 && no < yes;
}

/// Reads one module, variables first, since statements may precede them.
class Reader {
 public:
  Reader(const netlist::Element& module, BodyBytes& bytes) : bytes_(bytes) {
    body_.name = module.text("name");
    body_.source_name = module.text("origName");
    body_.scopes.emplace_back();
    for (const netlist::Element* e : module.children()) declare(*e, 0, false);
    for (const netlist::Element* e : module.children()) item(*e);
    body_.outputs.resize(body_.variables.size());
    for (std::uint32_t p = 0; p < body_.parts.size(); ++p)
      for (std::uint32_t i = 0; i < body_.parts[p].ports.size(); ++i) {
        const Port& port = body_.parts[p].ports[i];
        if (port.input || port.expression == nullptr) continue;
        each_target(*port.expression, body_.parts[p].scope, [&](std::uint32_t v) {
          body_.outputs[v].push_back({p, i});
        });
      }
  }
  Body take() { return std::move(body_); }

 private:
  std::uint32_t open(const netlist::Element& e, std::uint32_t parent) {
    Scope scope;
    scope.parent = static_cast<int>(parent);
    scope.prefix = body_.scopes[parent].prefix;
    const std::string name = e.text("name");
    // A loop may be a block with the loop's name, which contains a block with the name and the
    // iteration's number.
    const std::string outer = names_.contains(parent) ? names_.at(parent) : "";
    if (!outer.empty() && name.starts_with(outer + "["))
      scope.prefix.resize(scope.prefix.size() - outer.size() - 1);
    bytes_.add(scope.prefix.size() + name.size());
    if (!name.empty()) scope.prefix += name + ".";
    const auto id = static_cast<std::uint32_t>(body_.scopes.size());
    names_[id] = name;
    scopes_[&e] = id;
    body_.scopes.push_back(std::move(scope));
    return id;
  }

  void declare(const netlist::Element& e, std::uint32_t scope, bool local) {
    if (e.tag() == "var") {
      Variable v;
      const std::string name = e.text("name");
      bytes_.add(body_.scopes[scope].prefix.size() + name.size());
      v.path = body_.scopes[scope].prefix + name;
      v.declared = &e;
      v.type = e.number("dtype_id");
      v.local = local || !e.attribute("param").empty() || !e.attribute("localparam").empty();
      v.input = e.attribute("dir") == "input";
      v.output = e.attribute("dir") == "output";
      v.in_process = in_process_;
      const auto id = static_cast<std::uint32_t>(body_.variables.size());
      body_.scopes[scope].names.emplace(name, id);
      if (!local) body_.by_path.emplace(v.path, id);
      body_.variables.push_back(std::move(v));
      return;
    }
    const bool function = e.tag() == "func" || e.tag() == "task";
    if (e.tag() == "always") in_process_ = true;
    if (e.tag() == "begin" || function) scope = open(e, scope);
    if (function) body_.functions[e.text("name")] = {&e, scope};
    for (const netlist::Element* child : e.children()) declare(*child, scope, local || function);
    if (e.tag() == "always") in_process_ = false;
  }

  void item(const netlist::Element& e) {
    if (e.tag() == "contassign" || e.tag() == "assignw") {
      ++process_;
      drive(e, nullptr);
    } else if (e.tag() == "always" || e.tag() == "alwayspublic") {
      ++process_;
      const netlist::Element* edges = nullptr;
      for (const netlist::Element* child : e.children())
        if (child->tag() == "sentree") edges = of_edges(*child) ? child : nullptr;
      for (const netlist::Element* child : e.children())
        if (child->tag() != "sentree") statement(*child, edges);
    } else if (e.tag() == "instance") {
      part(e);
    } else if (e.tag() == "begin") {
      const std::uint32_t outer = std::exchange(scope_, scopes_.at(&e));
      for (const netlist::Element* child : e.children()) item(*child);
      scope_ = outer;
    }
  }

  static bool of_edges(const netlist::Element& sentree) {
    return std::any_of(sentree.children().begin(), sentree.children().end(),
                       [](const netlist::Element* i) {
                         const std::string_view edge = i->attribute("edgeType");
                         return edge == "POS" || edge == "NEG" || edge == "BOTH";
                       });
  }

  void part(const netlist::Element& e) {
    Part p;
    const std::string name = e.text("name");
    bytes_.add(body_.scopes[scope_].prefix.size() + name.size());
    p.path = body_.scopes[scope_].prefix + name;
    p.module = e.text("defName");
    p.declared = &e;
    p.scope = scope_;
    for (const netlist::Element* port : e.children())
      if (port->tag() == "port")
        p.ports.push_back(
            {port->text("name"), port->child(0), port->attribute("direction") != "out"});
    body_.part_by_path.emplace(p.path, static_cast<std::uint32_t>(body_.parts.size()));
    body_.parts.push_back(std::move(p));
  }

  /// Reads an assignment. Its target is the last child.
  void drive(const netlist::Element& e, const netlist::Element* edges) {
    if (e.children().size() < 2) return;
    const bool blocking = e.tag() == "assign";
    add({&e, e.children().back(), e.child(0), edges, scope_, process_, guards_, blocking, loop_});
  }
  void add(Drive d) {
    bytes_.add(d.guards.size() * sizeof(Guard));
    const auto id = static_cast<std::uint32_t>(body_.drives.size());
    each_target(*d.target, scope_, [&](std::uint32_t v) {
      auto& drives = body_.variables[v].drives;
      if (drives.empty() || drives.back() != id) drives.push_back(id);
    });
    body_.drives.push_back(std::move(d));
  }

  /// Visits the variables that an expression on the left-hand side assigns, wholly or in part.
  void each_target(const netlist::Element& e, std::uint32_t scope,
                   const std::function<void(std::uint32_t)>& visit) const {
    if (is_reference(e)) {
      const std::string dotted = with_brackets(e.text("dotted"));
      const auto v = body_.variable(scope, (dotted.empty() ? "" : dotted + ".") + e.text("name"));
      if (v >= 0) visit(static_cast<std::uint32_t>(v));
    } else if (e.tag() == "concat") {
      for (const netlist::Element* child : e.children()) each_target(*child, scope, visit);
    } else if (e.child(0) != nullptr) {
      each_target(*e.child(0), scope, visit);  // of a selection
    }
  }

  void guarded(Guard guard, const netlist::Element& e, const netlist::Element* edges) {
    guard.first = static_cast<std::uint32_t>(body_.drives.size());
    guards_.push_back(guard);
    statement(e, edges);
    guards_.pop_back();
  }

  void statement(const netlist::Element& e, const netlist::Element* edges) {
    const std::string_view tag = e.tag();
    if (tag == "assign" || tag == "assigndly" || tag == "contassign") {
      drive(e, edges);
    } else if (tag == "begin") {
      const std::uint32_t outer = std::exchange(scope_, scopes_.at(&e));
      for (const netlist::Element* child : e.children()) statement(*child, edges);
      scope_ = outer;
    } else if (tag == "if") {
      for (std::size_t i = 1; i < e.children().size(); ++i)
        guarded(
            {i == 1 ? Guard::Kind::kIf : Guard::Kind::kElse, e.child(0), nullptr, is_swapped(e)},
            *e.child(i), edges);
    } else if (tag == "case") {
      choice(e, edges);
    } else if (tag == "while") {
      loop(e, edges);
    } else if (tag == "funcref" || tag == "taskref") {
      call(e, edges);
    } else {
      for (const netlist::Element* child : e.children())
        guarded({Guard::Kind::kUnknown, nullptr, nullptr}, *child, edges);
    }
  }

  void choice(const netlist::Element& e, const netlist::Element* edges) {
    for (const netlist::Element* item : e.children()) {
      if (item->tag() != "caseitem") continue;
      const bool otherwise = item->child(0) == nullptr || is_statement(*item->child(0));
      const Guard guard{otherwise ? Guard::Kind::kDefault : Guard::Kind::kItem, &e, item};
      for (const netlist::Element* child : item->children())
        if (is_statement(*child)) guarded(guard, *child, edges);
    }
  }

  /// Reads a loop: the part before the condition, the condition, the body, and the step. The step's
  /// variables count iterations and are no signals.
  void loop(const netlist::Element& e, const netlist::Element* edges) {
    if (const netlist::Element* step = e.child(3))
      for (const netlist::Element* s : step->children())
        if (s->children().size() >= 2)
          each_target(*s->children().back(), scope_,
                      [&](std::uint32_t v) { body_.variables[v].local = true; });
    const netlist::Element* const outer = std::exchange(loop_, loop_ != nullptr ? loop_ : &e);
    for (const std::size_t part : {2u, 3u})
      if (e.child(part) != nullptr)
        guarded({Guard::Kind::kUnknown, nullptr, nullptr}, *e.child(part), edges);
    loop_ = outer;
  }

  /// Reads a task call. Each argument that the task writes depends on all others.
  void call(const netlist::Element& e, const netlist::Element* edges) {
    const auto function = body_.functions.find(e.text("name"));
    if (function == body_.functions.end()) return;
    std::size_t at = 0;
    for (const netlist::Element* v : function->second.declared->children()) {
      if (v->tag() != "var" || v->attribute("dir").empty() ||
          v->attribute("name") == e.attribute("name"))
        continue;
      const netlist::Element* const argument = e.child(at++);
      if (argument == nullptr || argument->child(0) == nullptr) break;
      if (v->attribute("dir") != "input")
        add({&e, argument->child(0), nullptr, edges, scope_, process_, guards_, true, loop_});
    }
  }

  BodyBytes& bytes_;
  Body body_;
  std::map<std::uint32_t, std::string> names_;  ///< by scope
  std::map<const netlist::Element*, std::uint32_t> scopes_;
  std::vector<Guard> guards_;
  const netlist::Element* loop_ = nullptr;
  std::uint32_t scope_ = 0, process_ = 0;
  bool in_process_ = false;
};

}  // namespace

bool is_statement(const netlist::Element& e) {
  return std::find(kStatements.begin(), kStatements.end(), e.tag()) != kStatements.end();
}

bool is_reference(const netlist::Element& e) {
  return e.tag() == "varref" || e.tag() == "varxref";
}

std::string with_brackets(std::string text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kCodes = {
      {{"__BRA__", "["}, {"__KET__", "]"}, {"__DOT__", "."}}};
  for (const auto& [code, character] : kCodes)
    for (std::size_t at = text.find(code); at != std::string::npos; at = text.find(code, at))
      text.replace(at, code.size(), character);
  return text;
}

std::int64_t Body::variable(std::uint32_t scope, std::string_view name) const {
  const bool dotted = name.find('.') != std::string_view::npos;
  for (int s = static_cast<int>(scope); s >= 0; s = scopes[static_cast<std::size_t>(s)].parent) {
    const Scope& here = scopes[static_cast<std::size_t>(s)];
    if (!dotted) {
      const auto found = here.names.find(name);
      if (found != here.names.end()) return found->second;
    } else {
      const auto found = by_path.find(here.prefix + std::string(name));
      if (found != by_path.end()) return found->second;
    }
  }
  return -1;
}

void BodyBytes::add(std::uint64_t bytes) {
  if ((all_ += bytes) > most_)
    throw netlist::NetlistError(fmt::format(
        "the full names and conditions of its statements have {} bytes so far; expected "
        "at most {} in {} bytes of XML",
        all_, most_, file_));
}

Body read_body(const netlist::Element& module, BodyBytes& bytes) {
  return Reader(module, bytes).take();
}

}  // namespace cde::wave
