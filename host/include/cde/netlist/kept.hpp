// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cde::netlist {

/// Name in the cache for what this very program reads out of the elaborated RTL: it covers the RTL,
/// Verilator and how it is run, as the file name of the bitstream of `kind` and `parameters` does,
/// and the program's own code. Nothing if that cannot be known; elaboration then says why.
[[nodiscard]] std::optional<std::string> kept_name(const std::string& kind,
                                                   const std::vector<std::string>& parameters,
                                                   std::string_view suffix);

}  // namespace cde::netlist
