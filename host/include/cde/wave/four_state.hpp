// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

/// Values of SystemVerilog and what operators make of them (IEEE 1800, clause 11).
namespace cde::wave {

/// Bits of up to 64 as words, of more as characters; or a real number.
struct Value {
  unsigned width = 1;
  bool is_signed = false, real = false;
  std::uint64_t v = 0, x = 0;  ///< a bit is unknown where x is 1: z if v is 1 as well
  double d = 0;
  std::string wide;
  std::string exact = {};  ///< as the file has it in small letters, where a bit is none of 0 1 x z

  [[nodiscard]] bool unknown() const {
    return real ? x != 0 : wide.empty() ? x != 0 : wide.find_first_of("xz") != std::string::npos;
  }
};

/// What an operator's result is.
struct Shape {
  unsigned width = 1;
  bool is_signed = false, real = false;
};

enum class Truth { kNo, kYes, kUnknown };

[[nodiscard]] std::uint64_t mask(unsigned width);
/// One of nine states, in either case, as one of four: L is 0, H is 1, what is neither is x or z.
[[nodiscard]] char four_state(char c);
/// Reads characters of nine states in either case, the most significant bit first.
[[nodiscard]] Value of_bits(std::string_view bits, bool is_signed);
[[nodiscard]] Value of_bool(bool value);
[[nodiscard]] Value of_real(double value);
/// A text, which is the same as another one or not.
[[nodiscard]] Value of_text(std::string_view text);
[[nodiscard]] Value of_truth(Truth t);
[[nodiscard]] Value unknown_of(unsigned width, bool real = false);
[[nodiscard]] std::string characters(const Value& a);
/// The same, but in the states that the file has.
[[nodiscard]] std::string as_written(const Value& a);
/// With its sign, or zeros, in front; as it is if it is wider.
[[nodiscard]] Value extended(Value a, unsigned width);
[[nodiscard]] double as_real(const Value& a);
[[nodiscard]] Truth truth(const Value& a);
[[nodiscard]] Truth inverse(Truth t);
/// Whether all bits are the same, unknown ones as well.
[[nodiscard]] bool identical(const Value& a, const Value& b);

/// What a choice between them is that nothing is known of: bits that are the same, others x.
[[nodiscard]] Value merged(const Value& a, const Value& b);

/// == or, exact, ===; of numbers that are no bits always ==.
[[nodiscard]] Value equality(const Value& a, const Value& b, bool exact);
/// Operators in which unknown bits stand for any.
enum class Wild {
  kRight,  ///< x and z on the right: ==? and inside
  kZ,      ///< z on either side, and x is x: casez
  kXZ      ///< x and z on either side: casex
};
[[nodiscard]] Value wild_equality(const Value& a, const Value& b, Wild wild);
/// <, <=, >, >= of words of the same width, or of up to 64 bits.
[[nodiscard]] Value order(const std::string& op, const Value& a, const Value& b);
/// &, | or ^ of words of the same width.
[[nodiscard]] Value bitwise(char op, const Value& a, const Value& b);
/// ~ and the unary -.
[[nodiscard]] Value complement(const Value& a);
[[nodiscard]] Value negative(const Value& a);
/// && or ||.
[[nodiscard]] Truth both(bool conjunction, Truth a, Truth b);
/// +, -, *, / or % of words that are as wide as the result.
[[nodiscard]] Value arithmetic(char op, const Value& a, const Value& b, const Shape& result);
/// <<, >> or >>>.
[[nodiscard]] Value shift(const std::string& op, const Value& a, const Value& by,
                          const Shape& result);
/// & | ^ of all bits, with ~ in front its inverse.
[[nodiscard]] Value reduction(const std::string& op, const Value& a);

}  // namespace cde::wave
