// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cde/model/device.hpp"

/// The device of modelled times, as all outputs name it.
namespace cde::cli {

[[nodiscard]] nlohmann::ordered_json device_json(const Device& device);
/// "large (projected, 100 MHz), cycles of add/mul/div/sqrt/compare: 9/11/34/32/3".
[[nodiscard]] std::string device_row(const Device& device);

}  // namespace cde::cli
