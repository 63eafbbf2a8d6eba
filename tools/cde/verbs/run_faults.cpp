// SPDX-License-Identifier: Apache-2.0
#include "verbs/run_faults.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::cli {

std::vector<ScheduledFault> faults_of(const std::vector<std::string>& texts, const Plan& plan,
                                      std::uint32_t first, std::uint32_t last) {
  std::vector<ScheduledFault> faults;
  for (const std::string& text : texts) {
    faults.push_back(fault_of(text));
    check_fault(faults.back(), plan.board);
    const std::uint32_t frame = faults.back().frame;
    if (frame < first || frame > last)
      throw Error(ErrorCode::kUsage,
                  fmt::format("--fault {}: frame {} is not among the frames of the run, {}..{}",
                              in_quotes(text), frame, first, last));
  }
  return faults;
}

nlohmann::ordered_json faults_json(const std::vector<ScheduledFault>& faults,
                                   const SceneRunner& runner, std::uint64_t corrected_words) {
  nlohmann::ordered_json scheduled = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < faults.size(); ++i)
    scheduled.push_back({{"fault", text_of(faults[i])}, {"injected", bool{runner.injected()[i]}}});
  const BusCounters bus = runner.board().bus_counters();
  return {{"scheduled", scheduled},
          {"injected", std::count(runner.injected().begin(), runner.injected().end(), true)},
          {"transfer_retries", bus.transfer_retries},
          {"access_retries", bus.access_retries},
          {"pass_retries", bus.pass_retries},
          {"lost_interrupts", bus.lost_interrupts},
          {"corrected_words", corrected_words}};
}

std::string faults_text(const nlohmann::ordered_json& json) {
  const auto n = [&](const char* key) { return json[key].get<std::uint64_t>(); };
  return fmt::format(
      "{} of {} injected; repeated: {} transfers, {} accesses, {} passes; lost interrupts: {}; "
      "corrected words of DDR: {}",
      n("injected"), json["scheduled"].size(), n("transfer_retries"), n("access_retries"),
      n("pass_retries"), n("lost_interrupts"), n("corrected_words"));
}

}  // namespace cde::cli
