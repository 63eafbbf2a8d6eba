// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cde/scene/plan.hpp"

namespace cde::cli {

/// The plan and its simulation model. The model is looked for but not built.
[[nodiscard]] nlohmann::ordered_json plan_json(const Scene& scene, const Plan& plan);

/// Prints the same as text on stdout.
void print_plan(const Scene& scene, const Plan& plan);

/// One line about the built card that replaces the planned one.
[[nodiscard]] std::string stand_in_text(const BoardConfig& used, const BuiltCard& planned);
/// "stands_in_for": the planned card and the estimate, or null if the planned card is used.
[[nodiscard]] nlohmann::ordered_json stand_in_json(const std::optional<BuiltCard>& planned);

}  // namespace cde::cli
