// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "cde/contract/registers.hpp"

/// Values of the contract in C++, under the names of the packages in rtl/contract.
namespace cde::contract_values {

using Values = std::map<std::string, std::uint64_t>;
using Fields = std::map<std::string, Field>;

/// The name as packages write it: "ray-triangle" becomes RAY_TRIANGLE.
std::string upper(std::string_view name);

Values formats();
Values pairs();
Values records();
Values registers();
Values pci_side();
/// Fields of registers and records, by structure and name. Fields of ports inside the card are not
/// listed.
Fields fields();

}  // namespace cde::contract_values
