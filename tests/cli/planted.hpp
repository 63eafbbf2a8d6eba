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
  /// Replaces another text of the copy.
  void change(const std::string& file, const std::string& from, const std::string& to);
  /// In which `cde` builds from the copy; warnings of Verilator are none.
  [[nodiscard]] const std::vector<std::string>& environment() const { return environment_; }
  /// Line of its file at which the last text that was replaced begins.
  [[nodiscard]] int line() const { return line_; }

 private:
  std::filesystem::path share_;
  std::vector<std::string> environment_;
  int line_ = 0;
};

/// A card with a fault, as an environment with a cache of its own: a hit needs to lie within two
/// edges of three.
[[nodiscard]] std::vector<std::string> faulty_card(const std::filesystem::path& folder);

}  // namespace cde::testing
