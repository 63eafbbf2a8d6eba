// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::netlist {

/// Converts Verilator's --json-only output, `tree` and `meta`, to the form of --xml-only, which
/// older versions write. It has the elements and attributes that Netlist reads, in their order, and
/// no others. NetlistError if the input is not such output.
[[nodiscard]] std::string xml_of_json(const std::string& tree, const std::string& meta);

}  // namespace cde::netlist
