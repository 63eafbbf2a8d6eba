// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde::netlist {

/// What Verilator writes with --json-only, `tree` and `meta`, in the form of --xml-only, which
/// older versions write: elements, attributes and their order are what Netlist reads, without what
/// it does not. NetlistError if it is none.
[[nodiscard]] std::string xml_of_json(const std::string& tree, const std::string& meta);

}  // namespace cde::netlist
