// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "options/table.hpp"

/// Completions of `cde` for three shells. `program` has the verbs of all programs.
namespace cde::cli {

[[nodiscard]] std::string bash_completion(const VerbTable& program);
[[nodiscard]] std::string zsh_completion(const VerbTable& program);
[[nodiscard]] std::string fish_completion(const VerbTable& program);

}  // namespace cde::cli
