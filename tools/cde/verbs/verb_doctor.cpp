// SPDX-License-Identifier: Apache-2.0
// cde doctor: checks everything that the command needs, and whether the card computes correctly.
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "cde/card/board.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "options/values.hpp"
#include "output/streams.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

/// Result of one check. `advice` is empty if nothing is wrong, or if the check was skipped.
struct Finding {
  std::string what, advice;
  bool examined = true;
};

/// The first line that a program prints; empty if there is none.
std::string first_line(const std::vector<std::string>& command) {
  try {
    const process::Result ran = process::run(command);
    return ran.status == 0 ? ran.output.substr(0, ran.output.find('\n')) : "";
  } catch (const Error&) {
    return "";
  }
}

/// Verilator's version and how models are built, as the builder decides.
Finding verilator() {
  if (first_line({"verilator", "--version"}).empty())
    return {"verilator is missing", "apt-get install verilator"};
  std::string version, mode;
  try {
    const process::Result ran = process::run({model_builder().string(), "verilator"});
    std::istringstream lines(ran.output);
    if (ran.status != 0 || !std::getline(lines, version) || !std::getline(lines, mode))
      return {printable(ran.output), "see the message"};
  } catch (const Error&) {
    return {"no builder", ""};  // another check reports it
  }
  const char* plain = std::getenv("CDE_PLAIN");  // NOLINT(concurrency-mt-unsafe)
  const bool chosen = plain != nullptr && std::string_view(plain) == "1";
  return {fmt::format("{}; {}", version,
                      chosen                  ? "models are plain (CDE_PLAIN)"
                      : mode == "accelerated" ? "models are accelerated"
                                              : "models are plain, so slower: the accelerator does "
                                                "not know this version"),
          ""};
}

Finding compiler() {
  const char* chosen = std::getenv("CDE_CLANG");  // NOLINT(concurrency-mt-unsafe)
  const std::string name = chosen != nullptr ? chosen : "clang++";
  const std::string version = first_line({name, "--version"});
  if (version.empty())
    return {name + " is missing", "apt-get install clang, or set CDE_CLANG to the compiler's name"};
  return {version, ""};
}

Finding processor() {
  std::ifstream in("/proc/cpuinfo");
  std::string model = "unknown processor", flags;
  for (std::string line; std::getline(in, line) && flags.empty();) {
    const auto value = [&] { return line.substr(std::min(line.size(), line.find(':') + 2)); };
    if (line.starts_with("model name")) model = value();
    if (line.starts_with("flags")) flags = value() + " ";
  }
  std::string found;
  for (const char* flag : {"avx2", "avx512f", "avx512dq", "avx512vl"}) {
    if (flags.find(fmt::format(" {} ", flag)) != std::string::npos)
      found += fmt::format(" {}", flag);
  }
  return {fmt::format("{};{}", model,
                      found.empty() ? " no wide vectors, so the simulation is slow" : found),
          ""};
}

Finding cache() {
  try {
    const std::filesystem::path folder = model_cache();
    if (::access(folder.c_str(), W_OK) != 0) {
      return {fmt::format("model cache {} cannot be written", printable_name(folder.string())),
              "set CDE_CACHE to a folder of yours"};
    }
    std::uintmax_t files = 0, bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::error_code gone;  // another process may have removed the file
      const std::uintmax_t size = entry.file_size(gone);
      if (entry.path().extension() == ".so" && !gone) ++files, bytes += size;
    }
    return {fmt::format("model cache {}: {}, {:.1f} MB", printable_name(folder.string()),
                        counted(files, "model"), static_cast<double>(bytes) / 1e6),
            ""};
  } catch (const std::exception& e) {
    return {e.what(), "set CDE_CACHE to a folder of yours"};
  }
}

Finding builder() {
  try {
    return {fmt::format("builder {}", printable_name(model_builder().string())), ""};
  } catch (const Error& e) {
    return {e.what(), "reinstall, or set CDE_SHARE"};
  }
}

/// Casts a few rays. `builds`: builds a missing card first.
Finding small_cast(Arithmetic arithmetic, bool builds) {
  const bool host = arithmetic == Arithmetic::kHost;
  const char* name = host ? "host" : "rtl";
  const unsigned quads = host ? 16 : 4;  // simulating gates is a hundred times slower
  try {
    const Mesh mesh = make_terrain({.quads_x = quads, .quads_y = quads});
    const std::vector<Ray> rays = grid_rays(bounds(mesh), {20, 20});
    const BoardConfig card{.arithmetic = arithmetic, .algorithm = kLeakFree, .box = true};
    if (!builds && !model_file(card.top(), card.parameters()).built)
      return {fmt::format("{} arithmetic: the card is not built; cde doctor --build builds and "
                          "checks it, in about {:.0f} s",
                          name, expected_build_seconds(card.parameters())),
              "", false};
    Board board = Board::open(card);  // the card of cde cast
    board.upload(mesh);
    reference::Checker checker(
        rays, mesh, Mode::kAll, {}, board.primaries(),
        fmt::format("cde cast terrain:{},{},1 --mode all --arith {}", quads, quads, name), {}, true,
        {}, kLeakFree);
    board.cast(rays, {.mode = Mode::kAll},
               [&](std::span<const Record> records) { checker.check(records); });
    checker.finish();
    return {fmt::format("{} arithmetic: {} of {} match the reference", name, checker.compared(),
                        counted(rays.size() * mesh.faces.size(), "record")),
            ""};
  } catch (const Error& e) {
    const bool differs = e.code() == ErrorCode::kMismatch;
    return {fmt::format("{} arithmetic: {}", name, e.what()),
            differs ? "the simulation model computes wrong results: remove it from the cache, or "
                      "report this"
                    : "see the message"};
  }
}

void run(bool builds, bool json) {
  bool fine = true;
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  const std::pair<const char*, std::function<Finding()>> examinations[] = {
      {"verilator", verilator},
      {"compiler", compiler},
      {"processor", processor},
      {"builder", builder},
      {"cache", cache},
      {"card, host", [builds] { return small_cast(Arithmetic::kHost, builds); }},
      {"card, rtl", [builds] { return small_cast(Arithmetic::kRtl, builds); }}};
  for (const auto& [name, examine] : examinations) {
    const Finding finding = examine();
    fine = fine && finding.advice.empty();
    if (json) {
      all.push_back({{"name", name},
                     {"examined", finding.examined},
                     {"finding", finding.what},
                     {"advice", finding.advice.empty() ? nlohmann::ordered_json()
                                                       : nlohmann::ordered_json(finding.advice)}});
      continue;
    }
    print("{:<4} {:<10} {}\n",
          !finding.advice.empty() ? "BAD"
          : finding.examined      ? "ok"
                                  : "--",
          name, finding.what);
    if (!finding.advice.empty()) print("     {:<10} -> {}\n", "", finding.advice);
  }
  if (json) {
    nlohmann::ordered_json j = program_json();
    j.update({{"fine", fine}, {"examinations", all}});
    print_json(j);
  }
  if (!fine) exit_code = 1;
}

}  // namespace

void add_doctor(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("doctor",
                         "Check tools, caches and both arithmetic back ends. Exit status 1 if "
                         "something is wrong. A card that is not built is skipped");
  auto builds = std::make_shared<bool>(false);
  verb->add_flag("--build", *builds, "Also build missing cards and check them");
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "Findings as JSON on stdout");
  quiet_flag(*verb);
  verb->callback([builds, json] { run(*builds, *json); });
}

}  // namespace cde::cli
