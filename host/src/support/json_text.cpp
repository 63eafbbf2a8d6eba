// SPDX-License-Identifier: Apache-2.0
#include "cde/support/json_text.hpp"

#include <nlohmann/json.hpp>

#include "cde/support/message.hpp"

namespace cde {

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return printable_json(
      json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

bool nested_deeper(std::string_view text, unsigned most) {
  unsigned depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
      continue;
    }
    quoted = c == '"';
    if ((c == '{' || c == '[') && ++depth > most) return true;
    if ((c == '}' || c == ']') && depth > 0) --depth;
  }
  return false;
}

nlohmann::ordered_json parse_json(std::string_view text) {
  using Json = nlohmann::ordered_json;
  return nested_deeper(text) ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
}

}  // namespace cde
