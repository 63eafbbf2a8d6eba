// SPDX-License-Identifier: Apache-2.0
// The parameters of the simulation model being built, as the builder writes them.
#pragma once
#include <cstddef>
#include <string_view>

constexpr char kParameters[] =
#include "params.inc"
    ;

/// Value of a numeric parameter of this model, or else `otherwise`, the top module's default.
constexpr long parameter(std::string_view name, long otherwise) {
  const std::string_view all = kParameters;
  for (size_t at = 0; at < all.size(); at = all.find('\n', at) + 1) {
    const std::string_view line = all.substr(at, all.find('\n', at) - at);
    if (line.size() > name.size() && line.substr(0, name.size()) == name &&
        line[name.size()] == '=') {
      long v = 0;
      for (const char c : line.substr(name.size() + 1)) v = v * 10 + (c - '0');
      return v;
    }
  }
  return otherwise;
}
