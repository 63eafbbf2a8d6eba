// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <string_view>

namespace cde {

/// Whether `text` contains `part`, for EXPECT_TRUE and EXPECT_FALSE. A failure prints the text.
inline ::testing::AssertionResult has(std::string_view text, std::string_view part) {
  if (text.find(part) != std::string_view::npos)
    return ::testing::AssertionSuccess() << "has: " << part << "\n";
  return ::testing::AssertionFailure() << "lacks: " << part << "\nsays: " << text << "\n";
}

}  // namespace cde
