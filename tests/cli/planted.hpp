// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace cde::testing {

/// A copy of what bitstreams are made of, with one text of one file replaced.
class Planted {
 public:
  /// In `folder`/share. A text that is not there is a failure of the test.
  Planted(const std::filesystem::path& folder, const std::string& file, const std::string& from,
          const std::string& to);
  /// In which `cde` builds from the copy; warnings of Verilator are none.
  [[nodiscard]] const std::vector<std::string>& environment() const { return environment_; }
  /// Line of the file at which the text begins.
  [[nodiscard]] int line() const { return line_; }

 private:
  std::vector<std::string> environment_;
  int line_ = 0;
};

}  // namespace cde::testing
