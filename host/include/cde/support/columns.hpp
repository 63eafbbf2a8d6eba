// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace cde {

/// Columns of text under heads.
struct Columns {
  using Cells = std::vector<std::string>;
  Cells heads;
  std::vector<Cells> lines = {};
  std::size_t gap = 1;              ///< blanks between columns
  std::vector<bool> left = {true};  ///< in text: set to the left; the others to the right
  bool wide_markdown = false;       ///< cells of Markdown are as wide as their column

  /// With blanks between the columns, or as a table in Markdown.
  [[nodiscard]] std::string text(bool markdown = false) const;
};

/// A field of CSV, in quotes if it holds a comma, a quote or the end of a line.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace cde
