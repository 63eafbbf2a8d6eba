// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "options/values.hpp"

/// The verbs and options of a program as data. One program writes the completions of all programs
/// from these tables.
namespace cde::cli {

struct OptionEntry {
  std::vector<std::string> short_names, long_names;  ///< without hyphens; none if positional
  std::string text;
  Takes takes;
  bool positional = false, list = false;
};
struct VerbTable {
  std::string name, text;
  std::vector<OptionEntry> options;
  std::vector<VerbTable> verbs = {};  ///< inner verbs, as in `cde wave info`
};

/// The shown options of an app, and its shown verbs.
[[nodiscard]] VerbTable table_of(const CLI::App& app);
[[nodiscard]] nlohmann::ordered_json to_json(const VerbTable& table);
/// The inverse of to_json, without `Takes::check`.
[[nodiscard]] VerbTable table_from_json(const nlohmann::ordered_json& json);

}  // namespace cde::cli
