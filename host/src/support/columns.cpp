// SPDX-License-Identifier: Apache-2.0
#include "cde/support/columns.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cde {

std::string Columns::text(bool markdown) const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < heads.size(); ++c) {
    widths.push_back(heads[c].size());
    for (const Cells& line : lines) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string out;
  const auto add = [&](const Cells& line) {
    std::string row = markdown ? "|" : "";
    for (std::size_t c = 0; c < line.size(); ++c)
      row += markdown ? fmt::format(" {} |", line[c])
             : c == 0 ? fmt::format("{:<{}}", line[c], widths[c])
                      : fmt::format(" {:>{}}", line[c], widths[c]);
    out += row + "\n";
  };
  add(heads);
  if (markdown) {
    out += "| ---";
    for (std::size_t c = 1; c < heads.size(); ++c) out += " | ---:";
    out += " |\n";
  }
  for (const Cells& line : lines) add(line);
  return out;
}

}  // namespace cde
