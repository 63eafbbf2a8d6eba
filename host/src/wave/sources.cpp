// SPDX-License-Identifier: Apache-2.0
// Finds the signal bits that determine given bits of a design's expression.
#include <algorithm>

#include "cde/wave/elaborated.hpp"

namespace cde::wave {

std::uint64_t width_of(const Context& c, const netlist::Element& e) {
  if (e.tag() == "const") return netlist::constant_bits(e).size();
  return c.all.netlist.type_of(e).width;
}

std::optional<Slice> selected(const Context& c, const netlist::Element& e) {
  if (is_reference(e)) return c.all.referred(c.unit, c.scope, e);
  const bool bits = e.tag() == "sel";
  if ((!bits && e.tag() != "arraysel") || e.child(0) == nullptr) return std::nullopt;
  auto inner = selected(c, *e.child(0));
  const auto at = index_value(c, e.child(1));
  const std::uint64_t width = width_of(c, e);
  if (!inner || !at || width == 0 || *at > kMostBits * kMostBits) return std::nullopt;
  const std::uint64_t low = bits ? *at : *at * width;
  if (low + width > inner->width) return std::nullopt;
  inner->low += low;
  inner->width = width;
  return inner;
}

std::optional<Slice> Design::Elaborated::referred(std::uint32_t unit, std::uint32_t scope,
                                                  const netlist::Element& e) const {
  const std::string dotted = with_brackets(e.text("dotted")), own = e.text("name");
  const std::string name = dotted.empty() ? own : dotted + "." + own;
  if (const auto v = body(unit).variable(scope, name); v >= 0)
    return whole(unit, static_cast<std::uint32_t>(v));
  if (dotted.empty()) return std::nullopt;
  // Resolves an instance from this unit or from an enclosing one.
  for (std::int64_t at = unit; at >= 0; at = units[static_cast<std::size_t>(at)].parent) {
    auto here = static_cast<std::uint32_t>(at);
    std::string_view rest = name;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos;) {
      const auto part = body(here).part_by_path.find(rest.substr(0, dot));
      if (part == body(here).part_by_path.end() || units[here].parts[part->second] < 0) {
        dot = rest.find('.', dot + 1);
        continue;
      }
      here = static_cast<std::uint32_t>(units[here].parts[part->second]);
      rest.remove_prefix(dot + 1);
      dot = rest.find('.');
    }
    const auto found = body(here).by_path.find(rest);
    if (found != body(here).by_path.end() && (here != at || at != unit))
      return whole(here, found->second);
  }
  return std::nullopt;
}

namespace {

/// Whether two statements are in different branches of one if or case.
bool is_either(const Drive& a, const Drive& b) {
  for (std::size_t i = 0; i < std::min(a.guards.size(), b.guards.size()); ++i) {
    const Guard &g = a.guards[i], &h = b.guards[i];
    if (g.what != h.what || g.what == nullptr) return false;
    if (g.kind != h.kind || g.item != h.item) return true;
  }
  return false;
}

}  // namespace

bool is_passing(const Context& c, const Slice& slice) {
  if (c.drive == nullptr || slice.unit != c.unit) return false;
  const Body& body = c.all.body(c.unit);
  for (const std::uint32_t number : c.all.variable(slice).drives) {
    const Drive& other = body.drives[number];
    if (!other.blocking || other.process != c.drive->process) continue;
    const bool same_loop = other.loop != nullptr && other.loop == c.drive->loop;
    const bool before = number < c.place;
    if (!same_loop && (before != (c.drive->edges != nullptr) || is_either(*c.drive, other)))
      continue;
    std::vector<Overlap> overlaps;
    collect_overlaps({c.all, c.unit, other.scope}, *other.target, slice, overlaps);
    if (!overlaps.empty()) return true;
  }
  return false;
}

void collect_sources(const Context& c, const netlist::Element& e, std::vector<Slice>& found) {
  collect_sources(c, e, 0, ~std::uint64_t{0}, found);
}

namespace {

void add(const Context& c, Slice s, std::uint64_t low, std::uint64_t width,
         std::vector<Slice>& found) {
  if (c.all.variable(s).local || (c.turn && c.turn->variable == s.variable && s.unit == c.unit))
    return;
  if (s.width != 0 && low < s.width) {
    s.low += low;
    s.width = std::min(width, s.width - low);
  }
  if (std::find(found.begin(), found.end(), s) == found.end()) found.push_back(s);
}

/// Adds what a function's body reads besides its arguments.
void add_globals(const Context& c, const netlist::Element& e, const Body& body, const Function& f,
                 std::vector<Slice>& found) {
  if (is_reference(e)) {
    if (const auto s = c.all.referred(c.unit, f.scope, e)) add(c, *s, 0, ~std::uint64_t{0}, found);
  }
  for (const netlist::Element* child : e.children()) add_globals(c, *child, body, f, found);
}

void collect_chosen(const Context& c, const netlist::Element& e, std::uint64_t low,
                    std::uint64_t width, std::vector<Slice>& found, std::vector<Slice>* selectors) {
  collect_sources(c, *e.child(0), selectors != nullptr ? *selectors : found);
  const char which = c.values == nullptr ? 'x' : chosen(c, *e.child(0));
  if (which != '0') collect_sources(c, *e.child(1), low, width, found, selectors);
  if (which != '1') collect_sources(c, *e.child(2), low, width, found, selectors);
}

}  // namespace

void collect_sources(const Context& c, const netlist::Element& e, std::uint64_t low,
                     std::uint64_t width, std::vector<Slice>& found,
                     std::vector<Slice>* selectors) {
  const std::string_view tag = e.tag();
  if (tag == "const" || width == 0) return;
  if (const auto s = selected(c, e)) {
    add(c, *s, low, width, found);
    // An index that is not constant is also a source.
    for (const netlist::Element* at = &e; at != nullptr && !is_reference(*at); at = at->child(0))
      if (at->child(1) != nullptr) collect_sources(c, *at->child(1), found);
    return;
  }
  const std::uint64_t whole = ~std::uint64_t{0};
  if (tag == "sel" && e.child(1) != nullptr) {
    const auto at = index_value(c, e.child(1));
    const std::uint64_t own = width_of(c, e);
    if (at && own != 0)
      collect_sources(c, *e.child(0), *at + low, std::min(width, own - std::min(own, low)), found,
                      selectors);
    else
      collect_sources(c, *e.child(0), found);
    collect_sources(c, *e.child(1), found);
  } else if (tag == "concat" && e.child(1) != nullptr && width_of(c, *e.child(1)) != 0) {
    const std::uint64_t right = width_of(c, *e.child(1));
    const std::uint64_t end = width > whole - low ? whole : low + width;
    if (end > right) {
      const std::uint64_t from = std::max(low, right);
      collect_sources(c, *e.child(0), from - right, end - from, found, selectors);
    }
    if (low < right)
      collect_sources(c, *e.child(1), low, std::min(end, right) - low, found, selectors);
  } else if (tag == "cond" && e.children().size() == 3) {
    collect_chosen(c, e, low, width, found, selectors);
  } else if (tag == "replicate" && e.child(0) != nullptr) {
    const std::uint64_t own = width_of(c, *e.child(0));
    const bool inside = own != 0 && width <= own && low % own + width <= own;
    collect_sources(c, *e.child(0), inside ? low % own : 0, inside ? width : whole, found,
                    selectors);
  } else if (tag == "extend" && e.child(0) != nullptr) {
    const std::uint64_t own = width_of(c, *e.child(0));
    if (own == 0 || low < own)
      collect_sources(c, *e.child(0), low, own == 0 ? width : std::min(width, own - low), found,
                      selectors);
  } else if (tag == "and" || tag == "or" || tag == "xor" || tag == "xnor" || tag == "not") {
    for (const netlist::Element* child : e.children())
      collect_sources(c, *child, low, width, found, selectors);
  } else {
    for (const netlist::Element* child : e.children())
      collect_sources(c, *child, 0, whole, found, selectors);
    const Body& body = c.all.body(c.unit);
    if (tag == "funcref") {
      const auto f = body.functions.find(e.text("name"));
      if (f != body.functions.end()) add_globals(c, *f->second.declared, body, f->second, found);
    }
  }
}

void collect_overlaps(const Context& c, const netlist::Element& target, const Slice& wanted,
                      std::vector<Overlap>& found) {
  if (target.tag() == "concat") {
    std::uint64_t low = 0;
    for (auto child = target.children().rbegin(); child != target.children().rend(); ++child) {
      const std::size_t before = found.size();
      collect_overlaps(c, **child, wanted, found);
      for (std::size_t i = before; i < found.size(); ++i) found[i].low += low;
      low += width_of(c, **child);
    }
    return;
  }
  if (const auto s = selected(c, target)) {
    if (s->unit != wanted.unit || s->variable != wanted.variable) return;
    const std::uint64_t low = std::max(s->low, wanted.low),
                        high = std::min(s->low + s->width, wanted.low + wanted.width);
    if (s->width == 0 || wanted.width == 0)
      found.push_back({0, ~std::uint64_t{0}, false});
    else if (low < high)
      found.push_back({low - s->low, high - low, true});
    return;
  }
  const netlist::Element* root = &target;
  while (!is_reference(*root) && root->child(0) != nullptr) root = root->child(0);
  if (!is_reference(*root)) return;
  const auto s = c.all.referred(c.unit, c.scope, *root);
  if (s && s->unit == wanted.unit && s->variable == wanted.variable)
    found.push_back({0, ~std::uint64_t{0}, false});
}

}  // namespace cde::wave
