// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::wave {

/// +, -, *, / or % of binary words of any width. Both operands have the width of the result. Empty
/// for a division by zero.
[[nodiscard]] std::string wide_arithmetic(char op, const std::string& a, const std::string& b,
                                          bool is_signed);

}  // namespace cde::wave
