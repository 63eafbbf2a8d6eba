// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <string>

namespace cde::testing {

/// How many cases: the second number with CDE_FULL=1 (tools/test --full), else the first.
inline int amount(int by_default, int full) {
  const char* value = std::getenv("CDE_FULL");
  return value != nullptr && std::string(value) != "0" ? full : by_default;
}

}  // namespace cde::testing
