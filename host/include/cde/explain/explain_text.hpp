// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cde/explain/explanation.hpp"

namespace cde {

/// The output of `cde explain`: operations by cycle, both results, and their first differences.
/// `words` name the pipe. Shows at most `most` operations; 0: all.
[[nodiscard]] std::string explanation_text(const std::string& words,
                                           const explain::Explanation& explanation, unsigned most);

/// The first differences as JSON (docs/reference/json.md).
[[nodiscard]] nlohmann::ordered_json explanation_differences(
    const explain::Explanation& explanation);

}  // namespace cde
