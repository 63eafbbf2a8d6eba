// SPDX-License-Identifier: Apache-2.0
#include "tui/tui_canvas.hpp"

#include <algorithm>
#include <cwchar>

namespace cde::wave::tui {
namespace {

/// The columns of a character in the terminal's locale. A character unknown there has the width of
/// a question mark.
std::size_t width_of(char32_t c) {
  if (c >= U' ' && c < 0x7f) return 1;
  const int width = ::wcwidth(static_cast<wchar_t>(c));
  return width < 0 ? 1 : static_cast<std::size_t>(width);
}

}  // namespace

std::u32string characters(std::string_view text) {
  std::u32string all;
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at++]);
    char32_t c = first;
    std::size_t more = 0;
    if (first >= 0xf0) {
      c = first & 7u;
      more = 3;
    } else if (first >= 0xe0) {
      c = first & 15u;
      more = 2;
    } else if (first >= 0xc0) {
      c = first & 31u;
      more = 1;
    }
    for (; more != 0 && at < text.size(); --more)
      c = c << 6 | (static_cast<unsigned char>(text[at++]) & 63u);
    all.push_back(c);
  }
  return all;
}

std::string utf8(std::u32string_view characters) {
  std::string text;
  const auto put = [&](char32_t bits) { text.push_back(static_cast<char>(bits)); };
  for (const char32_t c : characters) {
    if (c < 0x80) {
      put(c);
    } else if (c < 0x800) {
      put(0xc0 | c >> 6);
      put(0x80 | (c & 63));
    } else if (c < 0x10000) {
      put(0xe0 | c >> 12);
      put(0x80 | (c >> 6 & 63));
      put(0x80 | (c & 63));
    } else {
      put(0xf0 | c >> 18);
      put(0x80 | (c >> 12 & 63));
      put(0x80 | (c >> 6 & 63));
      put(0x80 | (c & 63));
    }
  }
  return text;
}

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  for (const char32_t c : characters(text)) columns += width_of(c);
  return columns;
}

std::size_t Canvas::put(std::size_t row, std::size_t column, std::string_view text, Style style,
                        std::size_t most) {
  std::size_t used = 0;
  for (const char32_t c : characters(text)) {
    const std::size_t width = width_of(c);
    if (width == 0) continue;
    if (used + width > most || row >= rows_ || column + used + width > columns_) break;
    at(row, column + used) = {c, style};
    if (width == 2) at(row, column + used + 1) = {0, style};
    used += width;
  }
  return used;
}

void Canvas::fill(std::size_t row, std::size_t column, std::size_t columns, Style style,
                  char32_t c) {
  for (std::size_t i = column; i < std::min(column + columns, columns_) && row < rows_; ++i)
    at(row, i) = {c, style};
}

std::string Canvas::text(std::size_t row) const {
  std::u32string all;
  for (std::size_t i = 0; i < columns_; ++i)
    if (at(row, i).c != 0) all.push_back(at(row, i).c);
  while (!all.empty() && all.back() == U' ') all.pop_back();
  return utf8(all);
}

std::string cut_end(std::string_view text, std::size_t columns, std::string_view cut) {
  if (columns_of(text) <= columns) return std::string(text);
  std::u32string kept;
  std::size_t used = columns_of(cut);
  for (const char32_t c : characters(text)) {
    if (used + width_of(c) > columns) break;
    used += width_of(c);
    kept.push_back(c);
  }
  return columns == 0 ? "" : utf8(kept) + std::string(cut);
}

std::string cut_begin(std::string_view text, std::size_t columns, std::string_view cut) {
  if (columns_of(text) <= columns) return std::string(text);
  const std::u32string all = characters(text);
  std::size_t used = columns_of(cut), first = all.size();
  while (first > 0 && used + width_of(all[first - 1]) <= columns) used += width_of(all[--first]);
  return columns == 0 ? "" : std::string(cut) + utf8(std::u32string_view(all).substr(first));
}

}  // namespace cde::wave::tui
