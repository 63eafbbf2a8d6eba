// SPDX-License-Identifier: Apache-2.0
#include "wave/port_states.hpp"

namespace cde::wave {

char port_bit(char state) {
  constexpr std::string_view kLow = "DdLl0", kHigh = "UuHh1", kOpen = "ZTFfz";
  if (kLow.find(state) != std::string_view::npos) return '0';
  if (kHigh.find(state) != std::string_view::npos) return '1';
  return kOpen.find(state) != std::string_view::npos ? 'z' : 'x';
}

void port_bits(std::string_view states, std::size_t width, std::string& to) {
  to.clear();
  for (const char c : states.substr(0, width)) to.push_back(port_bit(c));
  to.resize(width, 'x');
}

std::string port_value(std::string_view bits) {
  std::string states, low, high;
  for (const char c : bits) {
    states.push_back(c == '0' || c == '1' ? c : c == 'z' ? 'F' : '?');
    low.push_back(c == '1' || c == 'z' ? '0' : '6');
    high.push_back(c == '0' || c == 'z' ? '0' : '6');
  }
  return states + ' ' + low + ' ' + high;
}

}  // namespace cde::wave
