// SPDX-License-Identifier: Apache-2.0
#include "program/programs.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array kVerbs = {
    VerbEntry{"cast", "cde", false, "Cast rays at a mesh; records as CSV, NumPy or JSON lines"},
    VerbEntry{"render", "cde", false, "Draw pictures of a mesh"},
    VerbEntry{"query", "cde", false, "Test pairs of primitives"},
    VerbEntry{"run", "cde", false, "Run a scene, frame by frame"},
    VerbEntry{"plan", "cde", false, "Show which card a scene needs, and why"},
    VerbEntry{"fp", "cde", false, "Run floating-point operands through the simulated units"},
    VerbEntry{"merge", "cde", false, "Merge the journals of shards into the whole run"},
    VerbEntry{"doctor", "cde", false, "Check tools, caches and both arithmetic back ends"},
    VerbEntry{"help", "cde", false, "Show the help of a verb"},
    VerbEntry{"wave", "cde-wave", true, "Answer questions about a wave file (FST, VCD)"},
    VerbEntry{"explain", "cde-explain", false, "Find the operator and RTL line of a wrong answer"},
    VerbEntry{"accuracy", "cde-accuracy", false, "Measure errors, wrong decisions and costs"},
    VerbEntry{"advise", "cde-accuracy", false, "Name the cheapest pipe that meets demands"},
    VerbEntry{"bench", "cde-bench", false, "Measure simulation speed, and software baselines"},
    VerbEntry{"reproduce", "cde-bench", false, "Measure the paper's figures again, as a page"},
    VerbEntry{"inventory", "cde-bench", false, "Count operators and latency of every pipe"},
};

/// The CMake target that builds a program.
std::string target_of(std::string_view program) {
  std::string target(program);
  for (char& c : target)
    if (c == '-') c = '_';
  target += "_cli";
  return target;
}

/// Arguments for exec: pointers into `words`, and a null pointer.
std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

[[noreturn]] void cannot_start(const std::string& file, int error) {
  throw Error(ErrorCode::kFile, fmt::format("{}: {}", file, std::strerror(error)));
}

/// The status that `work` returns, or 2 with a message if it throws.
template <class Work>
int status_of(Work work) {
  try {
    return work();
  } catch (const Error& e) {
    log(fmt::format("cde: {}\n", shortened(e.what())));
    return exit_status(e);
  }
}

}  // namespace

std::span<const VerbEntry> all_verbs() {
  return kVerbs;
}

void need_proc() {
  if (::access("/proc/self/exe", F_OK) != 0)
    throw Error(ErrorCode::kFile,
                "/proc is not mounted; cde needs it to find its programs and to load exactly the "
                "files that it has checked");
}

std::string this_program() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).filename();
}

const VerbEntry* verb_elsewhere(std::string_view verb) {
  for (const VerbEntry& entry : kVerbs)
    if (entry.verb == verb && entry.program != this_program()) return &entry;
  return nullptr;
}

void add_other_verbs(CLI::App& app) {
  for (const VerbEntry& entry : kVerbs)
    if (entry.program != this_program()) app.add_subcommand(entry.verb, entry.summary);
}

std::string program_file(std::string_view program) {
  need_proc();
  std::error_code none;
  const fs::path here = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (const fs::path& folder : {here, here.parent_path() / "libexec" / "cde"})
    if (::access((folder / program).c_str(), X_OK) == 0) return folder / program;
  throw Error(ErrorCode::kFile,
              fmt::format("{} is not installed beside cde or in libexec/cde; build it with: "
                          "cmake --build build --target {}{}",
                          program, target_of(program),
                          program == "cde-accuracy" ? " (needs Boost, libboost-dev)" : ""));
}

std::vector<std::string> other_programs() {
  std::vector<std::string> all;
  for (const VerbEntry& entry : kVerbs)
    if (entry.program != this_program() &&
        std::find(all.begin(), all.end(), entry.program) == all.end())
      all.emplace_back(entry.program);
  return all;
}

int run_other_program(const std::string& program, const std::vector<std::string>& words) {
  return status_of([&] {
    std::vector<std::string> command = {program_file(program)};
    command.insert(command.end(), words.begin(), words.end());
    pid_t child = 0;
    int ended = 0;
    const int error = ::posix_spawn(&child, command[0].c_str(), nullptr, nullptr,
                                    pointers(command).data(), environ);
    if (error != 0) cannot_start(command[0], error);
    while (::waitpid(child, &ended, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  });
}

int other_program(const VerbEntry& entry, const std::vector<std::string>& words) {
  return status_of([&]() -> int {
    std::vector<std::string> command = {program_file(entry.program)};
    command.insert(command.end(), words.begin() + (entry.own_verbs ? 1 : 0), words.end());
    ::execv(command[0].c_str(), pointers(command).data());
    cannot_start(command[0], errno);
  });
}

}  // namespace cde::cli
