// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cde/scene/player.hpp"

/// `cde run --fault`.
namespace cde::cli {

/// Faults for frames first to last of a run. Error kUsage if one of them is for another frame, or
/// the planned board has none like it.
[[nodiscard]] std::vector<ScheduledFault> faults_of(const std::vector<std::string>& texts,
                                                    const Plan& plan, std::uint32_t first,
                                                    std::uint32_t last);

/// What was injected so far, and what the driver did about it.
[[nodiscard]] nlohmann::ordered_json faults_json(const std::vector<ScheduledFault>& faults,
                                                 const Player& player,
                                                 std::uint64_t corrected_words);

/// The same in a line.
[[nodiscard]] std::string faults_text(const nlohmann::ordered_json& json);

}  // namespace cde::cli
