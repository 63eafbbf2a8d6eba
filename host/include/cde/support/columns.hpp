// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace cde {

/// Text in columns with headings.
struct Columns {
  using Cells = std::vector<std::string>;
  Cells heads;
  std::vector<Cells> lines = {};
  std::size_t gap = 1;  ///< blanks between columns
  /// Columns that text aligns to the left; the others are aligned to the right.
  std::vector<bool> left = {true};
  bool wide_markdown = false;  ///< pads cells of a Markdown table to the width of their column

  /// Columns separated by blanks, or a Markdown table.
  [[nodiscard]] std::string text(bool markdown = false) const;
};

/// A CSV field. It is quoted if it holds a comma, a quote or a line end.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace cde
