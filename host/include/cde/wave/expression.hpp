// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/value.hpp"

namespace cde::wave {

/// An expression over signals, in the manner of SystemVerilog: four states, widths and signs as
/// there, and floating-point numbers where a signal has the form of one (NAME:fp32).
class Expression {
 public:
  /// Error kUsage, with a caret under the place, if it makes no sense. `option` names it.
  Expression(Trace& trace, const std::string& text, const std::string& option);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) = delete;

  /// What it reads, in the order in which it is written.
  [[nodiscard]] const std::vector<View>& views() const;
  /// A new value of a signal, by its handle.
  void set(std::uint32_t handle, std::string_view value);
  /// Events of it are over: 0 from now on. Whether it has any.
  bool end_instant();
  /// Whether it is true now: a known bit of it is 1. What looks back (changed, rose, fell, prev)
  /// looks at the last time that this was called.
  [[nodiscard]] bool evaluate();
  /// Whether it has something that looks back.
  [[nodiscard]] bool looks_back() const;

  struct Parsed;

 private:
  std::unique_ptr<Parsed> parsed_;
};

}  // namespace cde::wave
