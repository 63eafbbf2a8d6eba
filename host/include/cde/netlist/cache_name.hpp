// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cde::netlist {

/// Cache name of what this program reads from the elaborated RTL. Like the file name of the
/// simulation model of `kind` and `parameters`, it covers the RTL, Verilator and its switches. It
/// also covers the program's own code. Nothing if it cannot be determined; elaboration then reports
/// why.
[[nodiscard]] std::optional<std::string> cache_name(const std::string& kind,
                                                    const std::vector<std::string>& parameters,
                                                    std::string_view suffix);

}  // namespace cde::netlist
