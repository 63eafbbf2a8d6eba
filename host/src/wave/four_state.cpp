// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/four_state.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>

#include "wave/wide_arithmetic.hpp"

namespace cde::wave {

std::uint64_t mask(unsigned width) {
  return width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
}

char four_state(char c) {
  switch (c) {
    case '0':
    case 'l':
    case 'L':
      return '0';
    case '1':
    case 'h':
    case 'H':
      return '1';
    case 'z':
    case 'Z':
      return 'z';
    default:
      return 'x';
  }
}

Value of_bits(std::string_view bits, bool is_signed) {
  Value r;
  r.width = static_cast<unsigned>(bits.size());
  r.is_signed = is_signed;
  if (bits.find_first_not_of("01xzXZ") != std::string_view::npos)
    for (const char c : bits)
      r.exact.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  if (bits.size() > 64) {
    r.wide = bits;
    std::transform(bits.begin(), bits.end(), r.wide.begin(), four_state);
    return r;
  }
  for (const char own : bits) {
    const char c = four_state(own);
    r.v = r.v << 1 | (c == '1' || c == 'z' ? 1u : 0u);
    r.x = r.x << 1 | (c == '0' || c == '1' ? 0u : 1u);
  }
  return r;
}

Value of_bool(bool value) {
  Value r;
  r.v = value ? 1 : 0;
  return r;
}
Value of_real(double value) {
  Value r;
  r.real = true;
  r.d = value;
  return r;
}
Value of_text(std::string_view text) {
  Value r;
  r.exact = '"';
  r.exact += text;
  return r;
}
Value unknown_of(unsigned width, bool real) {
  Value r;
  r.width = width;
  r.real = real;
  if (width > 64)
    r.wide.assign(width, 'x');
  else
    r.x = mask(width);
  return r;
}

std::string characters(const Value& a) {
  if (!a.wide.empty()) return a.wide;
  std::string text;
  for (unsigned i = a.width; i-- > 0;) text.push_back("01xz"[(a.x >> i & 1) * 2 + (a.v >> i & 1)]);
  return text;
}

std::string as_written(const Value& a) {
  return a.exact.empty() ? characters(a) : a.exact;
}

Value extended(Value a, unsigned width) {
  if (a.real || a.width >= width || a.width == 0) return a;
  if (width > 64 || !a.exact.empty()) {
    std::string text = as_written(a);
    text.insert(0, width - text.size(), a.is_signed ? text[0] : '0');
    return of_bits(text, a.is_signed);
  }
  const std::uint64_t more = mask(width) & ~mask(a.width), top = std::uint64_t{1} << (a.width - 1);
  if (a.is_signed && (a.v & top) != 0) a.v |= more;
  if (a.is_signed && (a.x & top) != 0) a.x |= more;
  a.width = width;
  return a;
}

double as_real(const Value& a) {
  if (a.real) return a.d;
  if (a.is_signed && a.width < 65 && (a.v >> (a.width - 1) & 1) != 0)
    return static_cast<double>(static_cast<std::int64_t>(a.v | ~mask(a.width)));
  return static_cast<double>(a.v);
}

Truth truth(const Value& a) {
  if (a.real) return a.x != 0 ? Truth::kUnknown : a.d != 0 ? Truth::kYes : Truth::kNo;
  if (!a.wide.empty())
    return a.wide.find('1') != std::string::npos ? Truth::kYes
           : a.unknown()                         ? Truth::kUnknown
                                                 : Truth::kNo;
  if ((a.v & ~a.x) != 0) return Truth::kYes;
  return a.x != 0 ? Truth::kUnknown : Truth::kNo;
}
Value of_truth(Truth t) {
  return t == Truth::kUnknown ? unknown_of(1) : of_bool(t == Truth::kYes);
}
Truth inverse(Truth t) {
  return t == Truth::kUnknown ? t : t == Truth::kYes ? Truth::kNo : Truth::kYes;
}

bool identical(const Value& a, const Value& b) {
  if (a.real || b.real)
    return a.x == b.x && std::bit_cast<std::uint64_t>(a.d) == std::bit_cast<std::uint64_t>(b.d);
  return a.exact == b.exact && a.wide == b.wide && a.v == b.v && a.x == b.x;
}

Value merged(const Value& a, const Value& b) {
  if (a.real || b.real) return identical(a, b) ? a : unknown_of(1, true);
  std::string bits = characters(a);
  const std::string other = characters(b);
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (bits[i] != other[i] || bits[i] == 'z') bits[i] = 'x';
  return of_bits(bits, a.is_signed && b.is_signed);
}

Value equality(const Value& a, const Value& b, bool exact) {
  if (a.real || b.real) {
    if (a.unknown() || b.unknown()) return unknown_of(1);
    return of_bool(as_real(a) == as_real(b));
  }
  if (exact) return of_bool(identical(a, b));
  if (!a.wide.empty() || !b.wide.empty()) {
    const std::string l = characters(a), r = characters(b);
    bool open = false;
    for (std::size_t i = 0; i < l.size(); ++i) {
      const bool known = (l[i] == '0' || l[i] == '1') && (r[i] == '0' || r[i] == '1');
      if (!known)
        open = true;
      else if (l[i] != r[i])
        return of_bool(false);
    }
    return open ? unknown_of(1) : of_bool(true);
  }
  const std::uint64_t open = a.x | b.x;
  if (((a.v ^ b.v) & ~open) != 0) return of_bool(false);
  return open != 0 ? unknown_of(1) : of_bool(true);
}

Value wild_equality(const Value& a, const Value& b, Wild wild) {
  const std::string l = characters(a), r = characters(b);
  const auto any = [&](char c) { return c == 'z' || (c == 'x' && wild != Wild::kZ); };
  bool open = false;
  for (std::size_t i = 0; i < l.size(); ++i) {
    if (any(r[i]) || (wild != Wild::kRight && any(l[i])) || l[i] == r[i]) continue;
    if (wild != Wild::kRight || l[i] == '0' || l[i] == '1') return of_bool(false);
    open = true;
  }
  return open ? unknown_of(1) : of_bool(true);
}

Value order(const std::string& op, const Value& a, const Value& b) {
  if (a.unknown() || b.unknown()) return unknown_of(1);
  const auto by = [&](auto l, auto r) {
    return of_bool(op == "<" ? l < r : op == "<=" ? l <= r : op == ">" ? l > r : l >= r);
  };
  if (a.real || b.real) return by(as_real(a), as_real(b));
  if (!a.wide.empty() && !b.wide.empty()) {
    std::string l = a.wide, r = b.wide;
    // A leading one makes a signed number the smaller one, and an unsigned one the larger.
    if (a.is_signed && b.is_signed && l[0] != r[0]) std::swap(l[0], r[0]);
    return by(l, r);
  }
  if (a.is_signed && b.is_signed)
    return by(static_cast<std::int64_t>(extended(a, 64).v),
              static_cast<std::int64_t>(extended(b, 64).v));
  return by(a.v, b.v);
}

Value bitwise(char op, const Value& a, const Value& b) {
  if (a.width > 64) {
    std::string bits;
    for (std::size_t at = 0; at < a.wide.size(); at += 64)
      bits += characters(bitwise(op, of_bits(std::string_view(a.wide).substr(at, 64), false),
                                 of_bits(std::string_view(b.wide).substr(at, 64), false)));
    return of_bits(bits, a.is_signed && b.is_signed);
  }
  Value r;
  r.width = a.width;
  r.is_signed = a.is_signed && b.is_signed;
  const std::uint64_t one_a = a.v & ~a.x, one_b = b.v & ~b.x, zero_a = ~a.v & ~a.x,
                      zero_b = ~b.v & ~b.x, all = mask(a.width);
  std::uint64_t one = 0, zero = 0;
  if (op == '&') {
    one = one_a & one_b;
    zero = zero_a | zero_b;
  } else if (op == '|') {
    one = one_a | one_b;
    zero = zero_a & zero_b;
  } else {
    one = (one_a & zero_b) | (zero_a & one_b);
    zero = (one_a & one_b) | (zero_a & zero_b);
  }
  r.v = one & all;
  r.x = ~(one | zero) & all;
  return r;
}

Value complement(const Value& a) {
  std::string bits = characters(a);
  for (char& c : bits) c = c == '0' ? '1' : c == '1' ? '0' : 'x';
  return of_bits(bits, a.is_signed);
}

Value negative(const Value& a) {
  return arithmetic('-', of_bits(std::string(a.width, '0'), a.is_signed), a,
                    {a.width, a.is_signed, false});
}

Truth both(bool conjunction, Truth a, Truth b) {
  const Truth decided = conjunction ? Truth::kNo : Truth::kYes;
  if (a == decided || b == decided) return decided;
  return a == Truth::kUnknown || b == Truth::kUnknown ? Truth::kUnknown : inverse(decided);
}

Value arithmetic(char op, const Value& a, const Value& b, const Shape& n) {
  if (a.unknown() || b.unknown()) return unknown_of(n.width, n.real);
  if (n.real) {
    const double l = as_real(a), r = as_real(b);
    return of_real(op == '+'   ? l + r
                   : op == '-' ? l - r
                   : op == '*' ? l * r
                   : op == '/' ? l / r
                               : std::fmod(l, r));
  }
  if (n.width > 64) {
    const auto bits = wide_arithmetic(op, a.wide, b.wide, n.is_signed);
    return bits.empty() ? unknown_of(n.width) : of_bits(bits, n.is_signed);
  }
  Value v;
  v.width = n.width;
  v.is_signed = n.is_signed;
  if (op == '+') v.v = a.v + b.v;
  if (op == '-') v.v = a.v - b.v;
  if (op == '*') v.v = a.v * b.v;
  if (op == '/' || op == '%') {
    if (b.v == 0) return unknown_of(n.width);
    if (n.is_signed) {
      const auto l = static_cast<std::int64_t>(extended(a, 64).v),
                 r = static_cast<std::int64_t>(extended(b, 64).v);
      // The smallest number divided by -1 overflows.
      if (r == -1)
        v.v = op == '/' ? 0 - static_cast<std::uint64_t>(l) : 0;
      else
        v.v = static_cast<std::uint64_t>(op == '/' ? l / r : l % r);
    } else {
      v.v = op == '/' ? a.v / b.v : a.v % b.v;
    }
  }
  v.v &= mask(n.width);
  return v;
}

Value shift(const std::string& op, const Value& a, const Value& by, const Shape& n) {
  if (by.unknown()) return unknown_of(n.width);
  // Unknown bits are shifted like others.
  std::string bits = characters(a);
  const bool far = by.wide.find('1') < by.wide.size() - std::min<std::size_t>(by.wide.size(), 64);
  const std::uint64_t moved =
      by.wide.empty() ? by.v : of_bits(by.wide.substr(by.wide.size() - 64), false).v;
  const auto count =
      far ? bits.size() : static_cast<std::size_t>(std::min<std::uint64_t>(moved, bits.size()));
  if (op == "<<")
    bits = bits.substr(count) + std::string(count, '0');
  else
    bits = std::string(count, op == ">>>" && n.is_signed ? bits[0] : '0') +
           bits.substr(0, bits.size() - count);
  return of_bits(bits, n.is_signed);
}

Value reduction(const std::string& op, const Value& a) {
  const std::string bits = characters(a);
  const bool open = bits.find_first_of("xz") != std::string::npos;
  Truth t = Truth::kUnknown;
  if (op.back() == '|') {
    t = truth(a);
  } else if (op.back() == '&') {
    if (bits.find('0') != std::string::npos)
      t = Truth::kNo;
    else if (!open)
      t = Truth::kYes;
  } else if (!open) {
    t = std::count(bits.begin(), bits.end(), '1') % 2 == 1 ? Truth::kYes : Truth::kNo;
  }
  return of_truth(op[0] == '~' ? inverse(t) : t);
}

}  // namespace cde::wave
