// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdlib>
#include <string>

namespace cde::testing {

/// Whether CDE_FULL=1 requests all cases.
inline bool full() {
  const char* value = std::getenv("CDE_FULL");
  return value != nullptr && std::string(value) != "0";
}

/// The number of cases.
inline int amount(int by_default, int in_full) {
  return full() ? in_full : by_default;
}

}  // namespace cde::testing
