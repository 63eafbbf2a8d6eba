// SPDX-License-Identifier: Apache-2.0
#include "cde/support/shell_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

namespace cde {

std::string shell_word(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::strchr("_-./:,+=@%", c) != nullptr;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  const auto control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
  if (std::any_of(word.begin(), word.end(), control)) {
    std::string quoted = "$'";
    for (const char c : word) {
      if (control(c))
        quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
      else if (c == '\'' || c == '\\')
        quoted += std::string{'\\', c};
      else
        quoted += c;
    }
    return quoted + "'";
  }
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace cde
