// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::wave {

/// +, -, *, / or % of words of any width, of which every bit is 0 or 1. Both have the width of the
/// result. Empty for a division by zero.
[[nodiscard]] std::string wide_arithmetic(char op, const std::string& a, const std::string& b,
                                          bool is_signed);

}  // namespace cde::wave
