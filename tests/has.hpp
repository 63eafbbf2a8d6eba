// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <string_view>

namespace cde {

/// Whether a text has a part, for EXPECT_TRUE and EXPECT_FALSE; both are printed on a failure.
inline ::testing::AssertionResult has(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return ::testing::AssertionResult(found)
         << (found ? "has: " : "lacks: ") << part << "\nsays: " << text << "\n";
}

}  // namespace cde
