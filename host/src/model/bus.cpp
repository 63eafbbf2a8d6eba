// SPDX-License-Identifier: Apache-2.0
#include "cde/model/bus.hpp"

#include <algorithm>
#include <array>

#include "support/text.hpp"

namespace cde {
namespace {

constexpr std::array<const char*, kBusFaults> kFaultNames = {
    "retry",        "slow",           "disconnect", "disconnect-empty", "parity",   "target-abort",
    "master-abort", "lost-interrupt", "grant",      "no-answer",        "no-grant", "hang"};

}  // namespace

const char* name_of(BusFault fault) {
  return text::entry(kFaultNames, fault, "fault of the bus");
}

std::optional<BusFault> fault_named(std::string_view name) {
  const auto* found = std::find(kFaultNames.begin(), kFaultNames.end(), name);
  if (found == kFaultNames.end()) return std::nullopt;
  return static_cast<BusFault>(found - kFaultNames.begin());
}

}  // namespace cde
