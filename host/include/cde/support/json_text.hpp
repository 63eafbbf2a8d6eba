// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace cde {

/// JSON as text, with U+FFFD for bytes that are not UTF-8. An indent of -1 gives a single line.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

/// Levels of arrays and objects in a file. Destructors and copies of JSON recurse.
constexpr unsigned kDeepestJson = 200;

/// Whether arrays and objects of a JSON text are nested in more levels than `most`.
[[nodiscard]] bool nested_deeper(std::string_view text, unsigned most = kDeepestJson);

/// Parses JSON of a file. The result is discarded (is_discarded()) if the text is not JSON or is
/// nested_deeper().
[[nodiscard]] nlohmann::ordered_json parse_json(std::string_view text);

}  // namespace cde
