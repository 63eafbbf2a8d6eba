// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <sstream>
#include <string>
#include <vector>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {

using Words = std::vector<std::string>;

inline const std::string kHeader = "F,T,CPx,CPy,CPz,nx,ny,nz,flags\n";

class Query : public Cli {
 protected:
  /// Runs `cde query` with this text on stdin.
  [[nodiscard]] Ran query(const Words& words, const std::string& text,
                          const Words& environment = {}) {
    Words all = {"query"};
    all.insert(all.end(), words.begin(), words.end());
    const int own = ::dup(STDIN_FILENO);
    const int file = ::open((folder_ / write("stdin", text)).c_str(), O_RDONLY);
    ::dup2(file, STDIN_FILENO);
    ::close(file);
    Ran ran = cde(all, environment);
    ::dup2(own, STDIN_FILENO);
    ::close(own);
    return ran;
  }

  /// Expects a refusal before the first answer.
  void refused(const Words& words, const std::string& text) {
    const Ran ran = query(words, "0,0,0,1,2,0,0,1\n");
    SCOPED_TRACE(fmt::format("{}", fmt::join(words, " ")));
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, text));
    EXPECT_EQ(ran.out, "");
  }
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

}  // namespace cde::testing
