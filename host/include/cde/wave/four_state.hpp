// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

/// @file
/// Values of SystemVerilog and its operators on them (IEEE 1800, clause 11).
namespace cde::wave {

/// A bit vector or a real number. Up to 64 bits are held as words, more as characters.
struct Value {
  unsigned width = 1;
  bool is_signed = false, real = false;
  std::uint64_t v = 0, x = 0;  ///< a bit is unknown if x is 1: z if v is also 1
  double d = 0;
  std::string wide;
  std::string exact = {};  ///< as in the file, lowercase, if a bit is none of 0 1 x z

  [[nodiscard]] bool unknown() const {
    return real ? x != 0 : wide.empty() ? x != 0 : wide.find_first_of("xz") != std::string::npos;
  }
};

/// Width and type of an operator's result.
struct Shape {
  unsigned width = 1;
  bool is_signed = false, real = false;
};

enum class Truth { kNo, kYes, kUnknown };

[[nodiscard]] std::uint64_t mask(unsigned width);
/// Maps one of nine states, in either case, to one of four: L to 0, H to 1, others to x or z.
[[nodiscard]] char four_state(char c);
/// Reads characters of nine states in either case, most significant bit first.
[[nodiscard]] Value of_bits(std::string_view bits, bool is_signed);
[[nodiscard]] Value of_bool(bool value);
[[nodiscard]] Value of_real(double value);
/// A text; it can only be compared for equality.
[[nodiscard]] Value of_text(std::string_view text);
[[nodiscard]] Value of_truth(Truth t);
[[nodiscard]] Value unknown_of(unsigned width, bool real = false);
[[nodiscard]] std::string characters(const Value& a);
/// The same, in the states of the file.
[[nodiscard]] std::string as_written(const Value& a);
/// Extended by its sign or zeros; unchanged if it is wider.
[[nodiscard]] Value extended(Value a, unsigned width);
[[nodiscard]] double as_real(const Value& a);
[[nodiscard]] Truth truth(const Value& a);
[[nodiscard]] Truth inverse(Truth t);
/// Whether all bits are equal, unknown ones included.
[[nodiscard]] bool identical(const Value& a, const Value& b);

/// Result of an unknown choice between two values: equal bits stay, others are x.
[[nodiscard]] Value merged(const Value& a, const Value& b);

/// ==, or with `exact` ===; for reals and texts always ==.
[[nodiscard]] Value equality(const Value& a, const Value& b, bool exact);
/// Operators in which unknown bits are wildcards.
enum class Wild {
  kRight,  ///< x and z on the right: ==? and inside
  kZ,      ///< z on either side, and x is x: casez
  kXZ      ///< x and z on either side: casex
};
[[nodiscard]] Value wild_equality(const Value& a, const Value& b, Wild wild);
/// <, <=, >, >= of words of equal width, or of up to 64 bits.
[[nodiscard]] Value order(const std::string& op, const Value& a, const Value& b);
/// &, | or ^ of words of equal width.
[[nodiscard]] Value bitwise(char op, const Value& a, const Value& b);
/// ~ and the unary -.
[[nodiscard]] Value complement(const Value& a);
[[nodiscard]] Value negative(const Value& a);
/// && or ||.
[[nodiscard]] Truth both(bool conjunction, Truth a, Truth b);
/// +, -, *, / or % of words as wide as the result.
[[nodiscard]] Value arithmetic(char op, const Value& a, const Value& b, const Shape& result);
/// <<, >> or >>>.
[[nodiscard]] Value shift(const std::string& op, const Value& a, const Value& by,
                          const Shape& result);
/// Reduction & | ^ over all bits; a leading ~ inverts it.
[[nodiscard]] Value reduction(const std::string& op, const Value& a);

}  // namespace cde::wave
