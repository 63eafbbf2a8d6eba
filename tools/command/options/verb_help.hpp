// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

/// The last sections of the help and of the manual page of each verb. A verb is named by its words:
/// "cast", "wave show". The empty name is the whole command.
namespace cde::cli {

struct Example {
  std::string command, what;
};
[[nodiscard]] const std::vector<Example>& examples(std::string_view verb);

struct HelpEntry {
  std::string name, text;
};
/// The exit statuses that the verb may have.
[[nodiscard]] std::vector<HelpEntry> exit_statuses(std::string_view verb);
/// The environment variables that the verb reads.
[[nodiscard]] std::vector<HelpEntry> environment(std::string_view verb);

}  // namespace cde::cli
