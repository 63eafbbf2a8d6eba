// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Figures that a test measures and a page of docs/ states.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace cde::testing {

/// Prints the lines, and expects each of them in docs/`page`.
inline void expect_in_docs(const char* page, const std::vector<std::string>& lines) {
  std::ifstream file(std::string(CDE_SOURCE_DIR "/docs/") + page);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ASSERT_FALSE(text.empty());
  for (const std::string& line : lines) {
    std::printf("%s\n", line.c_str());
    EXPECT_NE(text.find(line + '\n'), std::string::npos)
        << "missing in docs/" << page << ": " << line;
  }
}

}  // namespace cde::testing
