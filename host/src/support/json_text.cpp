// SPDX-License-Identifier: Apache-2.0
#include "cde/support/json_text.hpp"

#include <nlohmann/json.hpp>

#include "cde/support/message.hpp"

namespace cde {

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return printable_json(
      json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace cde
