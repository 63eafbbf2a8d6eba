// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/expression.hpp"
#include "cde/wave/four_state.hpp"

/// Expressions as trees. The parser builds them and the evaluation walks them. Private to both.
namespace cde::wave {
namespace expression {

struct Node {
  enum class Kind { kConstant, kText, kView, kUnary, kBinary, kChoice, kCall, kJoin };
  Kind kind = Kind::kConstant;
  std::string op;
  std::size_t at = 0;
  std::vector<std::unique_ptr<Node>> kids;
  unsigned width = 1;
  bool is_signed = false, real = false;
  bool text = false;            ///< a text, neither bits nor a number
  bool plain = false;           ///< a literal without a base
  bool may_be_real = false;     ///< the file has a number format for the view
  unsigned context = 0;         ///< width that the surroundings impose; 0: none
  bool context_signed = false;  ///< sign that the surroundings impose
  Value constant;
  std::size_t view = 0;
  Value last;  ///< last value, for functions that look back
  bool has_last = false;
};
using Tree = std::unique_ptr<Node>;

/// In SystemVerilog parts of a signal are unsigned, even a range of all its bits.
inline bool signed_view(const View& v) {
  return v.form.kind == Form::Kind::kSigned ||
         (v.form.kind == Form::Kind::kHex && v.signal.is_signed && !v.indexed);
}

inline bool is_comparison(std::string_view op) {
  return op == "==" || op == "!=" || op == "===" || op == "!==" || op == "<" || op == "<=" ||
         op == ">" || op == ">=";
}
inline bool is_logical(std::string_view op) {
  return op == "&&" || op == "||";
}
inline bool is_shift(std::string_view op) {
  return op == "<<" || op == ">>" || op == ">>>";
}

/// Functions that compare with the last evaluation of the expression.
inline bool is_back(std::string_view op) {
  return op == "changed" || op == "rose" || op == "fell" || op == "prev" || op == "past";
}

}  // namespace expression

struct Expression::Parsed {
  std::vector<View> views;
  std::vector<Value> values;
  std::vector<char> numbers;  ///< by view: 1 if it is read as a floating-point number
  expression::Tree root;
  bool needs_history = false;

  /// The node's value in its context.
  Value value(expression::Node& n);
  Value own(expression::Node& n);
  Value unary(expression::Node& n);
  Value binary(expression::Node& n);
  Value call(expression::Node& n);
  /// Whether all signals in it are events.
  [[nodiscard]] bool of_events(const expression::Node& n) const;
  void begin(expression::Node& n);
};

namespace expression {

/// Parses a text, and adds the signals that it names to `to`. Error kUsage with the option and the
/// place.
Tree parse(Trace& trace, const std::string& text, const std::string& option,
           Expression::Parsed& to);

}  // namespace expression
}  // namespace cde::wave
