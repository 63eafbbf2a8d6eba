// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde::wave {

/// The value 0, 1, x or z of a port state in extended VCD (IEEE 1800, 21.7.4.3), for any driver.
[[nodiscard]] char port_bit(char state);
/// Converts the `width` states at the front of a port's value.
void port_bits(std::string_view states, std::size_t width, std::string& to);
/// A port's value for bits 0, 1, x, z, with unknown direction and full strengths.
[[nodiscard]] std::string port_value(std::string_view bits);

}  // namespace cde::wave
