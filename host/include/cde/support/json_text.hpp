// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace cde {

/// JSON as text, with U+FFFD for bytes that are not UTF-8. An indent of -1 gives a single line.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

}  // namespace cde
