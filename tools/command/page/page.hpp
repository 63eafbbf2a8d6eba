// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// HTML pages of one file each. They load nothing. Their content security policy allows only the
/// scripts and the style sheet that were built into the command.
namespace cde::cli {

/// The text of a script, style sheet or other file, as it was when the command was built.
struct PageAsset {
  std::string_view text;
  std::string_view sha256;  ///< SHA-256 of the text, hexadecimal
};
extern const PageAsset kPageStyle, kReportScript, kChartScript, kAccuracyScript, kFilterScript,
    kWrongScript, kThreeScript, kThreeLicence;

/// Text escaped for an element or a quoted attribute.
[[nodiscard]] std::string escaped(std::string_view text);

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);
/// The words of a vector as bytes in memory order. Every supported host is little endian.
template <class T>
[[nodiscard]] std::string base64_of(const std::vector<T>& words) {
  return base64({reinterpret_cast<const std::uint8_t*>(words.data()), words.size() * sizeof(T)});
}

/// A cell of a table: text, or HTML from the caller.
struct Cell {
  std::string html;
  bool number = false;                                    ///< aligned to the right
  Cell(std::string_view text) : html(escaped(text)) {}    // NOLINT(google-explicit-constructor)
  Cell(const std::string& text) : html(escaped(text)) {}  // NOLINT(google-explicit-constructor)
  Cell(const char* text) : html(escaped(text)) {}         // NOLINT(google-explicit-constructor)
  static Cell figure(std::string_view text) {
    Cell cell(text);
    cell.number = true;
    return cell;
  }
};

/// A number with commas: "259,572".
[[nodiscard]] std::string grouped(std::uint64_t number);

/// A table that scrolls sideways on narrow screens. The first cell of a row is its heading.
[[nodiscard]] std::string table(std::string_view caption, const std::vector<std::string>& head,
                                const std::vector<std::vector<Cell>>& rows);

/// Seconds with three figures and a unit: "31.2 ms".
[[nodiscard]] std::string duration(double seconds);

/// A whole page around `body`. `data` becomes the element with the id "data" for the scripts,
/// unless it is null. Scripts run in the given order.
[[nodiscard]] std::string page(std::string_view title, std::string_view body,
                               const nlohmann::ordered_json& data,
                               const std::vector<const PageAsset*>& scripts,
                               const PageAsset& style = kPageStyle);

/// Error kUsage, naming the option and the package, if this program was built without three.js.
void need_three(std::string_view option);

}  // namespace cde::cli
