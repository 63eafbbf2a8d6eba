// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace cde {

/// Columns of text; the first is set to the left, the others to the right.
struct Columns {
  using Cells = std::vector<std::string>;
  Cells heads;
  std::vector<Cells> lines;

  /// With blanks between the columns, or as a table in Markdown.
  [[nodiscard]] std::string text(bool markdown) const;
};

}  // namespace cde
