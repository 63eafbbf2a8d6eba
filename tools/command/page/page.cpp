// SPDX-License-Identifier: Apache-2.0
#include "page/page.hpp"
#include <nlohmann/json.hpp>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/xml_text.hpp"
#include "output/streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace cde::cli {
namespace {

/// "'sha256-...'": the name of an allowed script or style sheet in a content security policy.
std::string policy_hash(const PageAsset& asset) {
  std::vector<std::uint8_t> bytes(asset.sha256.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    std::from_chars(&asset.sha256[2 * i], &asset.sha256[2 * i] + 2, bytes[i], 16);
  return fmt::format("'sha256-{}'", base64(bytes));
}

}  // namespace

std::string escaped(std::string_view text) {
  return xml_text(printable(valid_utf8(text)));
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string grouped(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i != 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string table(std::string_view caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<Cell>>& rows) {
  std::string html = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\"><table><caption><span>{}</span></caption>\n",
      escaped(caption));
  if (!head.empty()) {
    html += "<thead><tr>";
    for (std::size_t i = 0; i < head.size(); ++i) {
      const bool number = !rows.empty() && i < rows[0].size() && rows[0][i].number;
      html += fmt::format("<th scope=\"col\"{}>{}</th>", number ? " class=\"n\"" : "",
                          escaped(head[i]));
    }
    html += "</tr></thead>\n";
  }
  html += "<tbody>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += i == 0
                  ? fmt::format("<th scope=\"row\">{}</th>", row[i].html)
                  : fmt::format("<td{}>{}</td>", row[i].number ? " class=\"n\"" : "", row[i].html);
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string duration(double seconds) {
  if (!(seconds > 0)) return "0";
  constexpr std::array<const char*, 4> kUnits = {"s", "ms", "µs", "ns"};
  std::size_t unit = 0;
  while (seconds < 0.9995 && unit + 1 < kUnits.size()) seconds *= 1000, ++unit;
  if (seconds >= 999.5) return fmt::format("{:.0f} {}", seconds, kUnits[unit]);
  const int digits = seconds < 9.995 ? 2 : seconds < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f} {}", seconds, digits, kUnits[unit]);
}

std::string page(std::string_view title, std::string_view body, const nlohmann::ordered_json& data,
                 const std::vector<const PageAsset*>& scripts, const PageAsset& style) {
  std::string allowed = "'none'";
  if (!scripts.empty()) allowed.clear();
  for (const PageAsset* script : scripts)
    allowed += fmt::format("{}{}", allowed.empty() ? "" : " ", policy_hash(*script));
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {}; "
      "style-src {}; img-src data:; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n",
      allowed, policy_hash(style), escaped(title));
  html += fmt::format("<style>{}</style>\n</head>\n<body>\n", style.text);
  html += body;
  if (!data.is_null()) {
    html += "<script type=\"application/json\" id=\"data\">";
    for (const char c : json_text(data, -1)) {  // "</script" in a name must not end the element
      if (c == '<')
        html += "\\u003c";
      else
        html += c;
    }
    html += "</script>\n";
  }
  for (const PageAsset* script : scripts)
    html += fmt::format("<script>{}</script>\n", script->text);
  return html + "</body>\n</html>\n";
}

void need_three(std::string_view option) {
  if (kThreeScript.text.empty())
    throw Error(ErrorCode::kUsage,
                fmt::format("{}: this program was built without three.js; install libjs-three and "
                            "build it again",
                            option));
}

}  // namespace cde::cli
