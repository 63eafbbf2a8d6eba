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
    if (markdown) out += '|';
    for (std::size_t c = 0; c < line.size(); ++c) {
      const bool to_left = c < left.size() && left[c], last = c + 1 == line.size();
      const bool tight = markdown ? !wide_markdown : to_left && last;
      const std::string cell =
          fmt::format(fmt::runtime(to_left ? "{:<{}}" : "{:>{}}"), line[c], tight ? 0 : widths[c]);
      out += markdown ? " " + cell + " |" : std::string(c == 0 ? 0 : gap, ' ') + cell;
    }
    out += '\n';
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

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

}  // namespace cde
