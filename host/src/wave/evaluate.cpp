// SPDX-License-Identifier: Apache-2.0
// Values of expressions of a design, where the waves tell those of their signals; and which bits of
// which signals some bits of an expression are made of.
#include <algorithm>

#include "cde/wave/elaborated.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {
namespace {

constexpr std::uint64_t kMostBits = 1u << 16;

std::uint64_t width_of(const Context& c, const netlist::Element& e) {
  if (e.tag() == "const") return netlist::constant_bits(e).size();
  return c.all.netlist.type_of(e).width;
}

std::optional<std::uint64_t> small(const std::string& bits) {
  if (bits.empty()) return std::nullopt;
  // Indices are as wide as an int; leading zeros are no matter.
  const std::size_t first = std::min(bits.find_first_not_of('0'), bits.size() - 1);
  return word(std::string_view(bits).substr(first));
}
std::optional<std::uint64_t> index(const Context& c, const netlist::Element* e) {
  return e == nullptr ? std::nullopt : small(evaluate(c, *e));
}

/// 1, 0 or x.
char truth(const std::string& bits) {
  if (bits.find('1') != std::string::npos) return '1';
  return bits.empty() || bits.find_first_not_of('0') != std::string::npos ? 'x' : '0';
}
std::string one(char c) {
  return {1, c};
}
std::string one(bool b) {
  return one(b ? '1' : '0');
}
char inverse(char c) {
  return c == '1' ? '0' : c == '0' ? '1' : 'x';
}

std::string resized(std::string bits, std::uint64_t width, char fill = '0') {
  if (bits.empty() || width == 0 || width > kMostBits) return bits;
  if (bits.size() < width) bits.insert(0, width - bits.size(), fill);
  return bits.substr(bits.size() - width);
}

bool known(const std::string& bits) {
  return !bits.empty() && bits.find_first_not_of("01") == std::string::npos;
}

std::string bitwise(std::string_view tag, std::string a, std::string b) {
  // An operand that is not known is x in all bits: `0 & x` is 0 all the same.
  if (a.empty() && b.empty()) return {};
  if (a.empty()) a.assign(b.size(), 'x');
  if (b.empty()) b.assign(a.size(), 'x');
  const std::size_t n = std::max(a.size(), b.size());
  a = resized(a, n);
  b = resized(b, n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool sure = (a[i] == '0' || a[i] == '1') && (b[i] == '0' || b[i] == '1');
    if (tag == "and")
      a[i] = a[i] == '0' || b[i] == '0' ? '0' : sure ? '1' : 'x';
    else if (tag == "or")
      a[i] = a[i] == '1' || b[i] == '1' ? '1' : sure ? '0' : 'x';
    else
      a[i] = !sure ? 'x' : (a[i] != b[i]) == (tag == "xor") ? '1' : '0';
  }
  return a;
}

std::string compared(std::string_view tag, const std::string& a, const std::string& b) {
  if (!known(a) || !known(b)) {
    if (tag.starts_with("eqcase") && !a.empty() && !b.empty()) return one(a == b);
    return {};
  }
  const std::size_t n = std::max(a.size(), b.size());
  std::string l = resized(a, n), r = resized(b, n);
  if (tag == "eq" || tag == "eqcase" || tag == "eqwild" || tag == "logeq") return one(l == r);
  if (tag == "neq" || tag == "neqcase" || tag == "neqwild") return one(l != r);
  if (tag.ends_with('s')) {  // of signed numbers: the sign's bit the other way round is in order
    l[0] = inverse(l[0]);
    r[0] = inverse(r[0]);
    tag.remove_suffix(1);
  }
  if (tag == "lt") return one(l < r);
  if (tag == "lte") return one(l <= r);
  if (tag == "gt") return one(l > r);
  if (tag == "gte") return one(l >= r);
  return {};
}

std::string computed(std::string_view tag, const std::string& a, const std::string& b,
                     std::uint64_t width) {
  const auto l = word(a), r = word(b);
  if (a.empty() || b.empty() || !l || !r || width > 64 || width == 0) return {};
  std::uint64_t value = 0;
  if (tag == "add")
    value = *l + *r;
  else if (tag == "sub")
    value = *l - *r;
  else if (tag == "mul")
    value = *l * *r;
  else if (tag == "shiftl")
    value = *r < 64 ? *l << *r : 0;
  else
    value = *r < 64 ? *l >> *r : 0;
  std::string bits;
  for (std::uint64_t i = width; i-- > 0;) bits.push_back((value >> i & 1) != 0 ? '1' : '0');
  return bits;
}

std::string operation(const Context& c, const netlist::Element& e) {
  const std::string_view tag = e.tag();
  const std::string a = evaluate(c, *e.child(0));
  const std::string b = e.child(1) != nullptr ? evaluate(c, *e.child(1)) : std::string();
  if (tag == "not") {
    std::string bits = a;
    std::transform(bits.begin(), bits.end(), bits.begin(), inverse);
    return bits;
  }
  if (tag == "and" || tag == "or" || tag == "xor" || tag == "xnor") return bitwise(tag, a, b);
  if (tag == "lognot") return one(inverse(truth(a)));
  if (tag == "logand" || tag == "logor") {
    const bool both = tag == "logand";
    return bitwise(both ? "and" : "or", one(truth(a)), one(truth(b)));
  }
  if (tag == "redor") return one(truth(a));
  if (tag == "redand") return one(a.find('0') != std::string::npos ? '0' : known(a) ? '1' : 'x');
  if (tag == "redxor")
    return known(a) ? one(std::count(a.begin(), a.end(), '1') % 2 == 1) : std::string("x");
  const std::uint64_t width = width_of(c, e);
  if (tag == "extend") return resized(a, width);
  if (tag == "extends") return a.empty() ? a : resized(a, width, a[0]);
  if (tag == "concat") return a.empty() || b.empty() ? std::string() : a + b;
  if (tag == "add" || tag == "sub" || tag == "mul" || tag == "shiftl" || tag == "shiftr")
    return computed(tag, a, b, width);
  return e.child(1) != nullptr ? compared(tag, a, b) : std::string();
}

/// Bits of a whole variable that a reference or a selection of one is.
std::optional<Slice> selected(const Context& c, const netlist::Element& e) {
  if (is_reference(e)) return c.all.referred(c.unit, c.scope, e);
  const bool bits = e.tag() == "sel";
  if ((!bits && e.tag() != "arraysel") || e.child(0) == nullptr) return std::nullopt;
  auto inner = selected(c, *e.child(0));
  const auto at = index(c, e.child(1));
  const std::uint64_t width = width_of(c, e);
  if (!inner || !at || width == 0 || *at > kMostBits * kMostBits) return std::nullopt;
  const std::uint64_t low = bits ? *at : *at * width;
  if (low + width > inner->width) return std::nullopt;
  inner->low += low;
  inner->width = width;
  return inner;
}

/// Bits of a loop's variable, if it is known which turn it is.
std::string in_turn(const Context& c, const Slice& slice) {
  if (!c.turn || c.turn->variable != slice.variable) return {};
  std::string bits;
  for (std::uint64_t i = slice.low + slice.width; i-- > slice.low;)
    bits += i < 64 && (c.turn->number >> i & 1) != 0 ? '1' : '0';
  return bits;
}

}  // namespace

std::string evaluate(const Context& c, const netlist::Element& e) {
  if (e.tag() == "const") return netlist::constant_bits(e);
  if (const auto slice = selected(c, e)) {
    if (c.values == nullptr || slice->width > kMostBits) return {};
    if (c.all.variable(*slice).local) return in_turn(c, *slice);
    return (*c.values)(*slice);
  }
  if (e.child(0) == nullptr || e.tag() == "funcref") return {};
  if (e.tag() == "sel") {  // of an expression
    const std::string from = evaluate(c, *e.child(0));
    const auto at = index(c, e.child(1));
    const std::uint64_t width = width_of(c, e);
    if (!at || *at > from.size() || width > from.size() - *at) return {};
    return from.substr(from.size() - *at - width, width);
  }
  if (e.tag() == "cond" && e.children().size() == 3) {
    const char which = truth(evaluate(c, *e.child(0)));
    return which == 'x' ? std::string() : evaluate(c, *e.child(which == '1' ? 1 : 2));
  }
  return operation(c, e);
}

std::optional<Slice> Design::Elaborated::referred(std::uint32_t unit, std::uint32_t scope,
                                                  const netlist::Element& e) const {
  const std::string dotted = with_brackets(e.text("dotted")), own = e.text("name");
  const std::string name = dotted.empty() ? own : dotted + "." + own;
  if (const auto v = body(unit).variable(scope, name); v >= 0)
    return whole(unit, static_cast<std::uint32_t>(v));
  if (dotted.empty()) return std::nullopt;
  // Of an instance, seen from this unit or from one that it is in.
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

void collect_sources(const Context& c, const netlist::Element& e, std::vector<Slice>& found) {
  collect_sources(c, e, 0, ~std::uint64_t{0}, found);
}

namespace {

void add(const Context& c, Slice s, std::uint64_t low, std::uint64_t width,
         std::vector<Slice>& found) {
  if (c.all.variable(s).local) return;
  if (s.width != 0 && low < s.width) {
    s.low += low;
    s.width = std::min(width, s.width - low);
  }
  if (std::find(found.begin(), found.end(), s) == found.end()) found.push_back(s);
}

/// What a function's body reads beside its arguments.
void add_globals(const Context& c, const netlist::Element& e, const Body& body, const Function& f,
                 std::vector<Slice>& found) {
  if (is_reference(e)) {
    if (const auto s = c.all.referred(c.unit, f.scope, e)) add(c, *s, 0, ~std::uint64_t{0}, found);
  }
  for (const netlist::Element* child : e.children()) add_globals(c, *child, body, f, found);
}

void collect_chosen(const Context& c, const netlist::Element& e, std::uint64_t low,
                    std::uint64_t width, std::vector<Slice>& found) {
  collect_sources(c, *e.child(0), found);
  const char which = c.values == nullptr ? 'x' : truth(evaluate(c, *e.child(0)));
  if (which != '0') collect_sources(c, *e.child(1), low, width, found);
  if (which != '1') collect_sources(c, *e.child(2), low, width, found);
}

}  // namespace

void collect_sources(const Context& c, const netlist::Element& e, std::uint64_t low,
                     std::uint64_t width, std::vector<Slice>& found) {
  const std::string_view tag = e.tag();
  if (tag == "const" || width == 0) return;
  if (const auto s = selected(c, e)) {
    add(c, *s, low, width, found);
    // An index that is no constant is a source as well.
    for (const netlist::Element* at = &e; at != nullptr && !is_reference(*at); at = at->child(0))
      if (at->child(1) != nullptr) collect_sources(c, *at->child(1), found);
    return;
  }
  const std::uint64_t whole = ~std::uint64_t{0};
  if (tag == "sel" && e.child(1) != nullptr) {
    const auto at = index(c, e.child(1));
    const std::uint64_t own = width_of(c, e);
    if (at && own != 0)
      collect_sources(c, *e.child(0), *at + low, std::min(width, own - std::min(own, low)), found);
    else
      collect_sources(c, *e.child(0), found);
    collect_sources(c, *e.child(1), found);
  } else if (tag == "concat" && e.child(1) != nullptr && width_of(c, *e.child(1)) != 0) {
    const std::uint64_t right = width_of(c, *e.child(1));
    const std::uint64_t end = width > whole - low ? whole : low + width;
    if (end > right) {
      const std::uint64_t from = std::max(low, right);
      collect_sources(c, *e.child(0), from - right, end - from, found);
    }
    if (low < right) collect_sources(c, *e.child(1), low, std::min(end, right) - low, found);
  } else if (tag == "cond" && e.children().size() == 3) {
    collect_chosen(c, e, low, width, found);
  } else if (tag == "replicate" && e.child(0) != nullptr) {
    const std::uint64_t own = width_of(c, *e.child(0));
    const bool inside = own != 0 && width <= own && low % own + width <= own;
    collect_sources(c, *e.child(0), inside ? low % own : 0, inside ? width : whole, found);
  } else if (tag == "extend" && e.child(0) != nullptr) {
    const std::uint64_t own = width_of(c, *e.child(0));
    if (own == 0 || low < own)
      collect_sources(c, *e.child(0), low, own == 0 ? width : std::min(width, own - low), found);
  } else if (tag == "and" || tag == "or" || tag == "xor" || tag == "xnor" || tag == "not") {
    for (const netlist::Element* child : e.children())
      collect_sources(c, *child, low, width, found);
  } else {
    for (const netlist::Element* child : e.children()) collect_sources(c, *child, found);
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
