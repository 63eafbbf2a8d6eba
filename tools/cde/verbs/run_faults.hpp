// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cde/scene/scene_runner.hpp"

/// `cde run --fault`.
namespace cde::cli {

/// The faults for the frames first to last of a run. Error kUsage if a fault is for another frame,
/// or is not possible on the planned board.
[[nodiscard]] std::vector<ScheduledFault> faults_of(const std::vector<std::string>& texts,
                                                    const Plan& plan, std::uint32_t first,
                                                    std::uint32_t last);

/// The faults injected so far, and how the driver handled them.
[[nodiscard]] nlohmann::ordered_json faults_json(const std::vector<ScheduledFault>& faults,
                                                 const SceneRunner& runner,
                                                 std::uint64_t corrected_words);

/// The same in one line of text.
[[nodiscard]] std::string faults_text(const nlohmann::ordered_json& json);

}  // namespace cde::cli
