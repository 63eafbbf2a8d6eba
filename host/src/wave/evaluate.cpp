// SPDX-License-Identifier: Apache-2.0
// Evaluates expressions of a design with the signal values of the waves.
#include <algorithm>
#include <bit>

#include "cde/wave/elaborated.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {
namespace {

using Known = std::optional<Evaluated>;

/// A result that does not depend on unknown signals is complete.
Known result(Value value, bool complete) {
  complete = complete || !value.unknown();
  return Evaluated{std::move(value), complete};
}
/// A value with a known width only.
Known nothing_of(std::uint64_t width) {
  if (width == 0 || width > kMostBits) return std::nullopt;
  return Evaluated{unknown_of(static_cast<unsigned>(width)), false};
}

/// Truncates or extends to this many bits.
Value sized(Value a, std::uint64_t width, bool is_signed) {
  a.is_signed = is_signed;
  if (width == 0 || width > kMostBits || a.width == width) return a;
  if (a.width < width) return extended(std::move(a), static_cast<unsigned>(width));
  return of_bits(characters(a).substr(a.width - width), is_signed);
}

/// Bits of a loop variable, if the iteration is known.
std::string in_turn(const Context& c, const Slice& slice) {
  if (!c.turn || c.turn->variable != slice.variable) return {};
  std::string bits;
  for (std::uint64_t i = slice.low + slice.width; i-- > slice.low;)
    bits += (c.turn->number >> std::min<std::uint64_t>(i, 63) & 1) != 0 ? '1' : '0';
  return bits;
}

Known of_signal(const Context& c, const Slice& slice) {
  if (c.values == nullptr || slice.width > kMostBits) return nothing_of(slice.width);
  const bool turns = c.all.variable(slice).local || is_passing(c, slice);
  const std::string bits = turns ? in_turn(c, slice) : (*c.values)(slice);
  if (bits.empty() || bits.size() != slice.width) return nothing_of(slice.width);
  return Evaluated{of_bits(bits, false), true};
}

/// The value of a selection whose index is unknown or out of range.
Known of_selection(const Context& c, const netlist::Element& e) {
  const std::uint64_t width = width_of(c, e);
  if (e.tag() != "sel") return nothing_of(width);
  const Known from = evaluate(c, *e.child(0));
  const Known index = e.child(1) == nullptr ? std::nullopt : evaluate(c, *e.child(1));
  if (index && index->complete && index->value.unknown() && width != 0 && width <= kMostBits)
    return Evaluated{unknown_of(static_cast<unsigned>(width)), true};
  const auto at = index_value(c, e.child(1));
  if (!from || !at || width == 0) return nothing_of(width);
  const std::string bits = characters(from->value);
  if (*at > bits.size() || width > bits.size() - *at) return nothing_of(width);
  return result(of_bits(bits.substr(bits.size() - *at - width, width), false), from->complete);
}

Known of_choice(const Context& c, const netlist::Element& e) {
  const Known condition = evaluate(c, *e.child(0));
  const Truth t = condition ? truth(condition->value) : Truth::kUnknown;
  if (t != Truth::kUnknown) return evaluate(c, *e.child(t == Truth::kYes ? 1 : 2));
  const Known a = evaluate(c, *e.child(1)), b = evaluate(c, *e.child(2));
  if (!a || !b || a->value.width != b->value.width) return nothing_of(width_of(c, e));
  return result(merged(a->value, b->value),
                condition && condition->complete && a->complete && b->complete);
}

/// Evaluates bit-counting functions, whose answer depends on all bits.
Known counted(std::string_view tag, const Evaluated& a, std::uint64_t width) {
  const std::string bits = characters(a.value);
  const bool open = a.value.unknown();
  if (open && !a.complete) return nothing_of(width);
  if (tag == "isunknown") return result(of_bool(open), true);
  const auto ones = static_cast<std::uint64_t>(std::count(bits.begin(), bits.end(), '1'));
  if (tag == "onehot") return result(of_bool(ones == 1), true);
  if (tag == "onehot0") return result(of_bool(ones <= 1), true);
  Value count;
  count.width = 64;
  count.v = ones;
  if (tag == "clog2") {
    if (open) return result(unknown_of(static_cast<unsigned>(width)), true);
    const std::size_t first = std::min(bits.find('1'), bits.size());
    count.v = bits.size() - first;  // bits of the number
    if (count.v != 0 && ones == 1) --count.v;
  }
  return result(sized(count, width, false), true);
}

Known unary(const Context& c, const netlist::Element& e, const Evaluated& a) {
  const std::string_view tag = e.tag();
  const std::uint64_t width = width_of(c, e);
  if (tag == "not") return result(complement(a.value), a.complete);
  if (tag == "negate") return result(negative(a.value), a.complete);
  if (tag == "lognot") return result(of_truth(inverse(truth(a.value))), a.complete);
  if (tag == "redor") return result(reduction("|", a.value), a.complete);
  if (tag == "redand") return result(reduction("&", a.value), a.complete);
  if (tag == "redxor") return result(reduction("^", a.value), a.complete);
  if (tag == "extend") return result(sized(a.value, width, false), a.complete);
  if (tag == "extends") return result(sized(a.value, width, true), a.complete);
  if (tag == "countones" || tag == "onehot" || tag == "onehot0" || tag == "clog2" ||
      tag == "isunknown")
    return counted(tag, a, width);
  return nothing_of(width);
}

Known compared(std::string_view tag, const Evaluated& a, const Evaluated& b) {
  const bool is_signed = tag.ends_with('s') && tag != "eqs";
  const unsigned n = std::max(a.value.width, b.value.width);
  const Value l = sized(a.value, n, is_signed), r = sized(b.value, n, is_signed);
  const bool complete = a.complete && b.complete;
  if (tag == "eq" || tag == "neq" || tag == "eqcase" || tag == "neqcase" || tag == "eqwild" ||
      tag == "neqwild") {
    // A signal that is not in the waves may have any value, also for ===.
    const Value same = tag.ends_with("wild") && b.complete
                           ? wild_equality(l, r, Wild::kRight)
                           : equality(l, r, tag.ends_with("case") && complete);
    return result(tag.starts_with('n') ? of_truth(inverse(truth(same))) : same, complete);
  }
  if (is_signed) tag.remove_suffix(1);
  const std::string_view op = tag == "lt"    ? "<"
                              : tag == "lte" ? "<="
                              : tag == "gt"  ? ">"
                              : tag == "gte" ? ">="
                                             : "";
  if (op.empty()) return std::nullopt;
  return result(order(std::string(op), l, r), complete);
}

Value power(Value base, Value exponent, const Shape& n) {
  if (base.unknown() || exponent.unknown()) return unknown_of(n.width);
  Value r = sized(of_bits("01", false), n.width, n.is_signed);
  const std::string bits = characters(exponent);
  for (const char c : bits) {
    r = arithmetic('*', r, r, n);
    if (c == '1') r = arithmetic('*', r, base, n);
  }
  return r;
}

Known computed(std::string_view tag, const Evaluated& a, const Evaluated& b, std::uint64_t width) {
  if (width == 0 || width > kMostBits) return std::nullopt;
  const bool complete = a.complete && b.complete;
  const auto n = static_cast<unsigned>(width);
  if (tag.starts_with("shift")) {
    const bool is_signed = tag == "shiftrs";
    const std::string op = tag == "shiftl" ? "<<" : is_signed ? ">>>" : ">>";
    return result(shift(op, sized(a.value, width, is_signed), b.value, {n, is_signed, false}),
                  complete);
  }
  if (tag.starts_with("pow")) {
    const bool minus = tag.ends_with('s') && tag != "pows" && characters(b.value)[0] == '1';
    if (minus) return nothing_of(width);
    return result(
        power(sized(a.value, width, tag == "powss" || tag == "powsu"), b.value, {n, false, false}),
        complete);
  }
  const bool is_signed = tag.ends_with('s');
  if (is_signed) tag.remove_suffix(1);
  const char op = tag == "add"      ? '+'
                  : tag == "sub"    ? '-'
                  : tag == "mul"    ? '*'
                  : tag == "div"    ? '/'
                  : tag == "moddiv" ? '%'
                                    : ' ';
  if (op == ' ') return nothing_of(width);
  const Value r = sized(b.value, width, is_signed);
  Value value = arithmetic(op, sized(a.value, width, is_signed), r, {n, is_signed, false});
  // Simulators differ about division by zero.
  const bool by_zero = (op == '/' || op == '%') && truth(r) == Truth::kNo;
  return result(std::move(value), complete && !by_zero);
}

/// Evaluates {<<N{a}}: parts of N bits, the lowest first.
Known streamed(const Evaluated& a, std::uint64_t part) {
  if (part == 0) return std::nullopt;
  const std::string bits = characters(a.value);
  std::string turned;
  for (std::size_t end = bits.size(); end != 0;) {
    const std::size_t begin = end > part ? end - part : 0;
    turned.append(bits, begin, end - begin);
    end = begin;
  }
  return result(of_bits(turned, false), a.complete);
}

Known binary(const Context& c, const netlist::Element& e, const Evaluated& a, const Evaluated& b) {
  const std::string_view tag = e.tag();
  const std::uint64_t width = width_of(c, e);
  const bool complete = a.complete && b.complete;
  if (tag == "and" || tag == "or" || tag == "xor" || tag == "xnor") {
    const unsigned n = std::max(a.value.width, b.value.width);
    const Value r = bitwise(tag == "and"  ? '&'
                            : tag == "or" ? '|'
                                          : '^',
                            sized(a.value, n, false), sized(b.value, n, false));
    return result(tag == "xnor" ? complement(r) : r, complete);
  }
  const Truth l = truth(a.value), r = truth(b.value);
  if (tag == "logand" || tag == "logor")
    return result(of_truth(both(tag == "logand", l, r)), complete);
  if (tag == "logif") return result(of_truth(both(false, inverse(l), r)), complete);
  if (tag == "logeq")
    return result(l == Truth::kUnknown || r == Truth::kUnknown ? unknown_of(1) : of_bool(l == r),
                  complete);
  if (tag == "concat") {
    if (a.value.width + std::uint64_t{b.value.width} > kMostBits) return std::nullopt;
    return result(of_bits(characters(a.value) + characters(b.value), false), complete);
  }
  if (tag == "replicate") {
    std::string bits;
    const std::string once = characters(a.value);
    if (b.value.unknown() || !b.value.wide.empty() || b.value.v > kMostBits / once.size())
      return nothing_of(width);
    for (std::uint64_t i = 0; i < b.value.v; ++i) bits += once;
    return result(of_bits(bits, false), complete);
  }
  if (tag == "streaml" || tag == "streamr")
    return tag == "streamr" ? Known(a) : streamed(a, b.value.unknown() ? 0 : b.value.v);
  if (const Known k = compared(tag, a, b)) return k;
  return computed(tag, a, b, width);
}

Truth truth_of(const Known& k) {
  return k ? truth(k->value) : Truth::kUnknown;
}

/// The source text from an element's place on; empty without the source.
std::string_view source_at(const Context& c, const netlist::Element& e) {
  const netlist::Line line = c.all.netlist.line(e);
  const auto& text = c.all.source(line.file);
  if (line.line < 1 || line.line > text.size() || line.column < 1) return {};
  const std::string_view whole = text[line.line - 1];
  return whole.substr(std::min<std::size_t>(line.column - 1, whole.size()));
}

/// Whether `inside` follows the parentheses of a case statement.
bool has_inside(const Context& c, const netlist::Element& choice) {
  const netlist::Line line = c.all.netlist.line(choice);
  const auto& text = c.all.source(line.file);
  std::string rest(source_at(c, choice));
  for (std::size_t i = line.line; i < text.size() && i < line.line + 20; ++i) rest += ' ' + text[i];
  unsigned depth = 0;
  for (std::size_t at = rest.find('('); at < rest.size(); ++at) {
    depth += rest[at] == '(' ? 1 : 0;
    if (rest[at] != ')' || --depth != 0) continue;
    at = rest.find_first_not_of(" \t\r", at + 1);
    return at != std::string::npos && rest.compare(at, 6, "inside") == 0;
  }
  return false;
}

enum class CaseKind { kPlain, kZ, kXZ, kInside };

/// The kind of a case statement. Verilator's XML omits it, so the source tells it, or else the
/// length of its keyword and its items.
CaseKind kind_of(const Context& c, const netlist::Element& choice) {
  std::string_view word = choice.attribute("kwd");
  if (word.empty()) word = source_at(c, choice);
  bool x = false, z = false, range = false;
  for (const netlist::Element* item : choice.children())
    for (const netlist::Element* e : item->children()) {
      if (item->tag() != "caseitem" || is_statement(*e)) break;
      const std::string bits = netlist::constant_bits(*e);
      x = x || bits.find('x') != std::string::npos;
      z = z || bits.find('z') != std::string::npos;
      range = range || e->tag() == "insiderange";
    }
  if (range) return CaseKind::kInside;
  if (word.starts_with("casex")) return CaseKind::kXZ;
  if (word.starts_with("casez")) return CaseKind::kZ;
  if (word.starts_with("case"))
    return (x || z) && has_inside(c, choice) ? CaseKind::kInside : CaseKind::kPlain;
  if (c.all.netlist.line(choice).length == 5) return x ? CaseKind::kXZ : CaseKind::kZ;
  return x || z ? CaseKind::kInside : CaseKind::kPlain;
}

/// Whether an item matches the value. A match that is x in simulation is none.
Truth item_matches(const Context& c, CaseKind kind, const Evaluated& value,
                   const netlist::Element& e) {
  const auto no_match = [&](Truth t, bool complete) {
    return t == Truth::kUnknown && complete ? Truth::kNo : t;
  };
  if (e.tag() == "insiderange") {
    const Known low = evaluate(c, *e.child(0)), high = evaluate(c, *e.child(1));
    if (!low || !high) return Truth::kUnknown;
    const Known above = compared("gte", value, *low), below = compared("lte", value, *high);
    return no_match(both(true, truth_of(above), truth_of(below)),
                    value.complete && low->complete && high->complete);
  }
  const Known item = evaluate(c, e);
  if (!item) return Truth::kUnknown;
  const unsigned n = std::max(value.value.width, item->value.width);
  const Value a = sized(value.value, n, false), b = sized(item->value, n, false);
  if (!item->complete) return truth(equality(a, b, false));
  if (kind == CaseKind::kInside)
    return no_match(truth(wild_equality(a, b, Wild::kRight)), value.complete);
  if (!value.complete)
    return truth(kind == CaseKind::kPlain ? equality(a, b, false)
                                          : wild_equality(a, b, Wild::kRight));
  if (kind == CaseKind::kPlain) return truth(equality(a, b, true));
  return truth(wild_equality(a, b, kind == CaseKind::kZ ? Wild::kZ : Wild::kXZ));
}

}  // namespace

std::optional<Evaluated> evaluate(const Context& c, const netlist::Element& e) {
  if (e.tag() == "const") {
    const std::string bits = netlist::constant_bits(e);
    if (bits.empty() || bits.size() > kMostBits) return std::nullopt;
    return Evaluated{of_bits(bits, false), true};
  }
  if (const auto slice = selected(c, e)) return of_signal(c, *slice);
  if (e.child(0) == nullptr || e.tag() == "funcref") return nothing_of(width_of(c, e));
  if (e.tag() == "sel" || e.tag() == "arraysel") return of_selection(c, e);
  if (e.tag() == "cond" && e.children().size() == 3) return of_choice(c, e);
  const Known a = evaluate(c, *e.child(0));
  if (!a || e.children().size() > 2) return nothing_of(width_of(c, e));
  if (e.child(1) == nullptr) return unary(c, e, *a);
  const Known b = evaluate(c, *e.child(1));
  return b ? binary(c, e, *a, *b) : nothing_of(width_of(c, e));
}

std::optional<std::uint64_t> index_value(const Context& c, const netlist::Element* e) {
  const Known k = e == nullptr ? std::nullopt : evaluate(c, *e);
  if (!k || k->value.unknown()) return std::nullopt;
  // Indices are as wide as an int; leading zeros are ignored.
  const std::string bits = characters(k->value);
  return word(
      std::string_view(bits).substr(std::min(bits.find_first_not_of('0'), bits.size() - 1)));
}

char chosen(const Context& c, const netlist::Element& condition) {
  const Truth t = truth_of(evaluate(c, condition));
  return t == Truth::kYes ? '1' : t == Truth::kNo ? '0' : 'x';
}

char holds(const Context& c, const netlist::Element& condition, bool swapped) {
  const Known k = evaluate(c, condition);
  const Truth t = truth_of(k);
  if (t == Truth::kUnknown && k && k->complete) return swapped ? '1' : '0';
  return t == Truth::kYes ? '1' : t == Truth::kNo ? '0' : 'x';
}

bool is_if_else(const Context& c, const netlist::Element& choice) {
  return source_at(c, choice).starts_with("if");
}

char is_item(const Context& c, const netlist::Element& choice, const netlist::Element& item) {
  const Known value = evaluate(c, *choice.child(0));
  if (!value) return 'x';
  const CaseKind kind = kind_of(c, choice);
  char found = '0';
  for (const netlist::Element* e : item.children()) {
    if (is_statement(*e)) break;
    const Truth t = item_matches(c, kind, *value, *e);
    if (t == Truth::kYes) return '1';
    if (t == Truth::kUnknown) found = 'x';
  }
  return found;
}

}  // namespace cde::wave
