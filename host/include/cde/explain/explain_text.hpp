// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cde/explain/explanation.hpp"

namespace cde {

/// What `cde explain` prints: operations by their clock, both answers, where they part first.
/// `words` name the pipe; at most `most` operations, 0 for all.
[[nodiscard]] std::string explanation_text(const std::string& words,
                                           const explain::Explanation& explanation, unsigned most);

/// Where they part first, as docs/reference/json.md has it.
[[nodiscard]] nlohmann::ordered_json explanation_differences(
    const explain::Explanation& explanation);

}  // namespace cde
