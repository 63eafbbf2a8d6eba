// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/value.hpp"

namespace cde::wave {

/// An expression over signals as in SystemVerilog: four states, with its widths and signs. Signals
/// with a number form (NAME:fp32) are floating-point numbers.
class Expression {
 public:
  /// Error kUsage, with a caret under the position, if the text is invalid. `option` names it.
  Expression(Trace& trace, const std::string& text, const std::string& option);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) = delete;

  /// Views that it reads, in the order of the text.
  [[nodiscard]] const std::vector<View>& views() const;
  /// Sets a new value of a signal, by its handle.
  void set(std::uint32_t handle, std::string_view value);
  /// Ends an instant: events become 0. Returns whether the expression reads events.
  bool end_instant();
  /// Whether it is true now: a known bit of it is 1. Functions that look back (changed, rose, fell,
  /// prev) compare with the previous call.
  [[nodiscard]] bool evaluate();
  /// Whether it has a function that looks back.
  [[nodiscard]] bool needs_history() const;

  struct Parsed;

 private:
  std::unique_ptr<Parsed> parsed_;
};

}  // namespace cde::wave
