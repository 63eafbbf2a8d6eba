#pragma once
#include <nlohmann/json.hpp>

namespace cde::cli {

/// The processor and system that this runs on, for files that hold wall times.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace cde::cli
