// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde::wave {

/// 0, 1, x or z of a port's state in extended VCD (IEEE 1800, 21.7.4.3), whoever drives it.
[[nodiscard]] char port_bit(char state);
/// Of the states that begin a port's value, `width` of them.
void port_bits(std::string_view states, std::size_t width, std::string& to);
/// A port's value of bits 0, 1, x, z, with states of unknown direction and full strengths.
[[nodiscard]] std::string port_value(std::string_view bits);

}  // namespace cde::wave
