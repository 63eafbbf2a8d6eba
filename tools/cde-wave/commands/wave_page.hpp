// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "commands/commands.hpp"

/// The page of cde wave serve. Its scripts and its style sheet are in tools/cde-wave/pages.
namespace cde::wave {

/// Adds the transactions in the window, if the file has a card's waves. `bytes` is the packed data
/// of the page.
void add_transactions(nlohmann::ordered_json& data, Trace& trace, const Window& w,
                      std::string& bytes);
/// Adds the source lines that declare and drive the signals, if the design is known.
void add_sources(nlohmann::ordered_json& data, Trace& trace, const std::string& structure,
                 const std::vector<View>& shown, std::string& bytes);

/// The whole page around the data for its scripts.
[[nodiscard]] std::string wave_page(const nlohmann::ordered_json& data);

}  // namespace cde::wave
