// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "commands/commands.hpp"

/// The page of cde wave serve: tools/cde-wave/pages has its scripts and its style sheet.
namespace cde::wave {

/// Transactions of the window, if the file is of a card. `bytes` is what the page has packed.
void add_transactions(nlohmann::ordered_json& data, Trace& trace, const Window& w,
                      std::string& bytes);
/// Lines of source that declare and drive the signals, if the design is known.
void add_sources(nlohmann::ordered_json& data, Trace& trace, const std::string& structure,
                 const std::vector<View>& shown, std::string& bytes);

/// The whole page around what its scripts read.
[[nodiscard]] std::string wave_page(const nlohmann::ordered_json& data);

}  // namespace cde::wave
