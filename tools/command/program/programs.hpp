// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "options/cli_fwd.hpp"

/// The programs of the command, and the verbs of each.
namespace cde::cli {

struct VerbEntry {
  const char *verb, *program;
  bool own_verbs;  ///< the program's verbs follow this one: `cde wave info`
  const char* summary;
};
/// All verbs, in the order of the help.
[[nodiscard]] std::span<const VerbEntry> all_verbs();

/// Error kFile if /proc is not mounted. The command needs it.
void need_proc();

/// The name of this program: "cde", "cde-wave".
[[nodiscard]] std::string this_program();
/// The entry of a verb of another program; null for a verb of this program and for an unknown word.
[[nodiscard]] const VerbEntry* verb_elsewhere(std::string_view verb);

/// The path of a program: beside this one, or in ../libexec/cde. If it is in neither, error kFile
/// with the command that builds it.
[[nodiscard]] std::string program_file(std::string_view program);

/// Adds the verbs of other programs, so that help lists them and suggestions include them.
void add_other_verbs(CLI::App& app);

/// The programs beside this one, in the order of their verbs.
[[nodiscard]] std::vector<std::string> other_programs();
/// Runs a program on the streams of this one and waits for it. Returns its exit status, or 2 with a
/// message if it cannot be started.
int run_other_program(const std::string& program, const std::vector<std::string>& words);

/// Replaces this process by the program of a verb; `words` begin with the verb. Returns exit status
/// 2, with a message, if the program cannot be started.
int other_program(const VerbEntry& entry, const std::vector<std::string>& words);

}  // namespace cde::cli
