// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <string_view>

namespace cde {

/// Whether a text has a part, for EXPECT_TRUE and EXPECT_FALSE. The text is printed if it lacks it.
inline ::testing::AssertionResult has(std::string_view text, std::string_view part) {
  if (text.find(part) != std::string_view::npos)
    return ::testing::AssertionSuccess() << "has: " << part << "\n";
  return ::testing::AssertionFailure() << "lacks: " << part << "\nsays: " << text << "\n";
}

}  // namespace cde
