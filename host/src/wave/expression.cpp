// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/expression.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "wave/expression_tree.hpp"

namespace cde::wave {

using namespace expression;

Value Expression::Parsed::value(Node& n) {
  Value v = own(n);
  if (n.context == 0 || v.real) return v;
  v.is_signed = n.context_signed;
  return extended(std::move(v), n.context);
}

Value Expression::Parsed::own(Node& n) {
  switch (n.kind) {
    case Node::Kind::kText:
    case Node::Kind::kConstant:
      return n.constant;
    case Node::Kind::kView:
      return values[n.view];
    case Node::Kind::kUnary:
      return unary(n);
    case Node::Kind::kBinary:
      return binary(n);
    case Node::Kind::kCall:
      return call(n);
    case Node::Kind::kChoice: {
      const Truth t = truth(value(*n.kids[0]));
      Value a = value(*n.kids[1]), b = value(*n.kids[2]);
      if (n.real && !a.real) a = a.unknown() ? unknown_of(1, true) : of_real(as_real(a));
      if (n.real && !b.real) b = b.unknown() ? unknown_of(1, true) : of_real(as_real(b));
      return t == Truth::kUnknown ? merged(a, b) : t == Truth::kNo ? b : a;
    }
    case Node::Kind::kJoin: {
      std::string bits;
      for (const Tree& kid : n.kids) bits += as_written(value(*kid));
      return of_bits(bits, false);
    }
  }
  return {};
}

Value Expression::Parsed::unary(Node& n) {
  Value a = value(*n.kids[0]);
  if (n.op == "!") return of_truth(inverse(truth(a)));
  if (n.op == "+" || n.op == "-") {
    if (a.real) return a.unknown() ? a : of_real(n.op == "-" ? -a.d : a.d);
    if (a.unknown()) return unknown_of(n.width);
    return n.op == "-" ? negative(a) : a;
  }
  if (n.op == "~") return complement(a);
  return reduction(n.op, a);
}

Value Expression::Parsed::binary(Node& n) {
  Value a = value(*n.kids[0]),
        b = value(*n.kids[1]);  // evaluates both: functions that look back must see every step
  if (is_logical(n.op)) return of_truth(both(n.op == "&&", truth(a), truth(b)));
  if (is_shift(n.op)) return shift(n.op, a, b, {n.width, n.is_signed, n.real});
  if (n.op == "==" || n.op == "===") return equality(a, b, n.op == "===");
  if (n.op == "!=" || n.op == "!==") return of_truth(inverse(truth(equality(a, b, n.op == "!=="))));
  if (is_comparison(n.op)) return order(n.op, a, b);
  if (n.op == "&" || n.op == "|" || n.op == "^") return bitwise(n.op[0], a, b);
  return arithmetic(n.op[0], a, b, {n.width, n.is_signed, n.real});
}

bool Expression::Parsed::of_events(const Node& n) const {
  if (n.kind == Node::Kind::kView) return views[n.view].signal.event;
  return !n.kids.empty() && std::all_of(n.kids.begin(), n.kids.end(), [&](const Tree& kid) {
    return kid->kind == Node::Kind::kConstant || of_events(*kid);
  });
}

/// Before the first instant an event is not triggered. Any other value is unknown then.
void Expression::Parsed::begin(Node& n) {
  if (n.has_last || !is_back(n.op) || !of_events(*n.kids[0])) return;
  const std::vector<Value> now = values;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].signal.event) values[i] = of_bits("0", false);
  n.last = value(*n.kids[0]);
  n.has_last = true;
  values = now;
}

Value Expression::Parsed::call(Node& n) {
  if (needs_history) begin(n);
  const Value a = value(*n.kids[0]);
  if (n.op == "isnan") return a.unknown() ? unknown_of(1) : of_bool(std::isnan(a.d));
  if (n.op == "isinf") return a.unknown() ? unknown_of(1) : of_bool(std::isinf(a.d));
  if (n.op == "isunknown") return of_bool(a.unknown());
  if (n.op == "signed" || n.op == "unsigned") {
    Value r = a;
    r.is_signed = n.op == "signed";
    return r;
  }
  if (n.op == "abs") {
    if (a.unknown()) return unknown_of(n.width, n.real);
    if (a.real) return of_real(std::fabs(a.d));
    return a.is_signed && as_real(a) < 0 ? negative(a) : a;
  }
  if (n.op == "countones") {
    const std::string bits = characters(a);
    Value r;
    r.width = 32;
    r.v = static_cast<std::uint64_t>(std::count(bits.begin(), bits.end(), '1'));
    return r;
  }
  const Value before = n.has_last ? n.last : unknown_of(a.width, a.real);
  const bool had = n.has_last;
  n.last = a;
  n.has_last = true;
  if (n.op == "changed") return of_bool(had && !identical(a, before));
  if (n.op == "prev" || n.op == "past") return before;
  const auto low = [](const Value& of) {
    return of.wide.empty() ? ((of.x & 1) != 0 ? 'x' : (of.v & 1) != 0 ? '1' : '0') : of.wide.back();
  };
  const char wanted = n.op == "rose" ? '1' : '0';
  return of_bool(had && low(a) == wanted && low(before) != wanted);
}

Expression::Expression(Trace& trace, const std::string& text, const std::string& option)
    : parsed_(std::make_unique<Parsed>()) {
  parsed_->root = parse(trace, text, option, *parsed_);
}
Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;

const std::vector<View>& Expression::views() const {
  return parsed_->views;
}
bool Expression::needs_history() const {
  return parsed_->needs_history;
}

void Expression::set(std::uint32_t handle, std::string_view text) {
  for (std::size_t i = 0; i < parsed_->views.size(); ++i) {
    const View& v = parsed_->views[i];
    if (v.signal.handle != handle) continue;
    Value& to = parsed_->values[i];
    const std::string_view bits = v.bits(text);
    if (v.signal.text) {
      to = of_text(text);
    } else if (v.signal.real) {
      const char* const stop = text.data() + text.size();
      double d = 0;
      to = std::from_chars(text.data(), stop, d).ec == std::errc() ? of_real(d)
                                                                   : unknown_of(1, true);
    } else if (parsed_->numbers[i] != 0) {
      const auto d = number(bits, v.form.format);
      to = d ? of_real(*d) : unknown_of(1, true);
    } else {
      to = of_bits(bits, signed_view(v));
    }
  }
}

bool Expression::end_instant() {
  bool any = false;
  for (std::size_t i = 0; i < parsed_->views.size(); ++i) {
    if (!parsed_->views[i].signal.event) continue;
    any = true;
    parsed_->values[i] = of_bits("0", false);
  }
  return any;
}

bool Expression::evaluate() {
  return truth(parsed_->value(*parsed_->root)) == Truth::kYes;
}

}  // namespace cde::wave
