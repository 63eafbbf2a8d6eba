// SPDX-License-Identifier: Apache-2.0
#include "commands/wave_page.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <string>

#include "page/page.hpp"

namespace cde::cli {
extern const PageAsset kWaveBody, kWaveStyle, kWaveValues, kWaveRows, kWaveDrawing, kWaveControls,
    kWaveScript;
}  // namespace cde::cli

namespace cde::wave {

std::string wave_page(const nlohmann::ordered_json& data) {
  const std::string title = data["title"];
  // The name of the file replaces {} in the body.
  const std::string body = fmt::format(fmt::runtime(cli::kWaveBody.text), cli::escaped(title));
  return cli::page(title + ": waves", body, data,
                   {&cli::kWaveValues, &cli::kWaveRows, &cli::kWaveDrawing, &cli::kWaveControls,
                    &cli::kWaveScript},
                   cli::kWaveStyle);
}

}  // namespace cde::wave
