// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "options/cli_fwd.hpp"

/// Manual pages, as text made from the parser.
namespace cde::cli {

/// Page of the program or of one of its verbs, in the man macros: cde(1), cde-cast(1).
[[nodiscard]] std::string manual_page(const CLI::App& app);

/// "cde", "cde-cast", "cde-wave-info".
[[nodiscard]] std::string page_name(const CLI::App& app);

}  // namespace cde::cli
