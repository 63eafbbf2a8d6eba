// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace cde::testing {

/// A copy of the sources of simulation models, with one text in one file replaced.
class Planted {
 public:
  /// The copy is in `folder`/share. A missing text fails the test.
  Planted(const std::filesystem::path& folder, const std::string& file, const std::string& from,
          const std::string& to);
  /// Replaces another text of the copy.
  void change(const std::string& file, const std::string& from, const std::string& to);
  /// Environment in which `cde` builds from the copy; Verilator's warnings are not errors.
  [[nodiscard]] const std::vector<std::string>& environment() const { return environment_; }
  /// The line at which the last replaced text begins.
  [[nodiscard]] int line() const { return line_; }

 private:
  std::filesystem::path share_;
  std::vector<std::string> environment_;
  int line_ = 0;
};

/// The environment of a faulty card, with its own cache: a hit needs to lie within only two of
/// three edges.
[[nodiscard]] std::vector<std::string> faulty_card(const std::filesystem::path& folder);

}  // namespace cde::testing
