#pragma once
#include <nlohmann/json.hpp>

#include "cde/plan.hpp"

namespace cde::cli {

/// The plan and its bitstream, which is looked for but not built.
[[nodiscard]] nlohmann::ordered_json plan_json(const Scene& scene, const Plan& plan);

/// The same for people, on stdout.
void print_plan(const Scene& scene, const Plan& plan);

/// One line about the built card that is used instead of the planned one; empty if none is.
[[nodiscard]] std::string stand_in_text(const Plan& plan);

}  // namespace cde::cli
