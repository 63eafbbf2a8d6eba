// SPDX-License-Identifier: Apache-2.0
// cde bench waves: measures commands on a wave file as processes, from start to end, and GTKWave's
// tools on the same file.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>

#include "bench/bench.hpp"
#include "cde/card/board.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/error.hpp"
#include "cde/support/process.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/scratch.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "output/streams.hpp"
#include "program/programs.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kWhole = 70'000'000, kQuick = 4'000'000;  // bytes
constexpr int kRounds = 5;

/// Writes waves of a card that casts rays at a terrain. A first window shows the bytes per cycle;
/// the second has enough cycles for about `bytes`.
void write_waves(const fs::path& file, std::uint64_t bytes) {
  Board board = Board::open({.lanes = 8, .trace = true});
  const Mesh mesh = make_terrain({});
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); i += 8) triangles.push_back(mesh.triangle(i));
  board.upload(triangles);
  const auto cast = [&](std::uint64_t cycles) {
    board.trace_open(file, {.to = cycles});
    for (const std::uint64_t begin = board.cycles(); board.cycles() - begin < cycles;)
      (void)board.cast(grid_rays(bounds(mesh), {16, 16}), {}, [](std::span<const Record>) {});
    board.trace_close();
  };
  // The cast goes on after the window, but the file has only the window.
  constexpr std::uint64_t kFirst = 60'000;
  cast(kFirst);
  const double each = static_cast<double>(fs::file_size(file)) / static_cast<double>(kFirst);
  cast(static_cast<std::uint64_t>(static_cast<double>(bytes) / each));
}

struct Cost {
  double seconds = 0;           ///< time of the fastest run
  std::uint64_t kilobytes = 0;  ///< largest resident size
  bool ran = false;
};

/// Runs a program and drops its output. `ran` is false if the program is not installed.
Cost measure(const std::vector<std::string>& words, int rounds = kRounds) {
  Cost cost;
  for (int i = 0; i < rounds; ++i) {
    const auto start = Clock::now();
    process::Result ran;
    try {
      ran = process::run(words);
    } catch (const Error&) {
      return {};
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    constexpr int kNotFound = 127;  // a shell's status for it
    if (ran.status == kNotFound) return {};
    if (ran.status > 1)
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: exit status {}", fmt::join(words, " "), ran.status));
    cost.seconds = cost.ran ? std::min(cost.seconds, seconds) : seconds;
    cost.kilobytes = std::max(cost.kilobytes, ran.resident_kb);
    cost.ran = true;
  }
  return cost;
}

struct Row {
  std::string what;
  std::vector<std::string> words;
};

/// The measured commands, about the middle of the file.
std::vector<Row> rows_of(const std::string& self, const std::string& file) {
  wave::Trace trace(file);
  wave::Times times(trace, "");
  const std::uint64_t middle = (trace.start() + trace.end()) / 2;
  std::string wide, bit;
  for (const wave::Signal& s : trace.signals()) {
    if (wide.empty() && s.name.ends_with(".engine.index_i")) wide = s.name;
    if (bit.empty() && s.name.ends_with(".engine.valid_i")) bit = s.name;
  }
  if (wide.empty()) wide = trace.signals().back().name;
  if (bit.empty()) bit = trace.signals().front().name;
  const auto wave = [&](std::vector<std::string> words) {
    std::vector<std::string> all = {self, words.front()};
    all.push_back(file);
    all.insert(all.end(), words.begin() + 1, words.end());
    return all;
  };
  const std::string at = std::to_string(middle);
  return {
      {"only the start of the command", {self, "--version"}},
      {fmt::format("ls, {} signals", trace.signals().size()), wave({"ls", "--max", "0"})},
      {"at, one signal", wave({"at", at, wide})},
      {"show, 4 cycles", wave({"show", wide, bit, "--around", at, "--window", "2"})},
      {"find, first match after the middle",
       wave({"find", fmt::format("changed({})", wide), "--from", at, "--first"})},
      {"find, one signal, the whole file",
       wave({"find", fmt::format("changed({})", wide), "--count"})},
      {"stat, all signals, the whole file", wave({"stat", "--max", "1"})},
      {"export, a VCD of all", wave({"export", "--format", "vcd"})},
      {"tx, what the card did", wave({"tx", "--max", "1"})},
      {"fst2vcd (GTKWave), a VCD of all", {"fst2vcd", "-f", file}},
      {"fst2vcd | grep -c, one signal",
       {"bash", "-c",
        "command -v fst2vcd >/dev/null || exit 127; fst2vcd -f \"$1\" | grep -c '^b.* !'", "bash",
        file}},
      {"fstminer -x (GTKWave), first match of a value", {"fstminer", "-x", "1", file}},
  };
}

}  // namespace

ordered_json bench_waves(const BenchOptions& o) {
  const Scratch folder("cde-bench-waves");
  const fs::path file = folder / "waves.fst";
  {
    const Progress busy("writing waves");
    write_waves(file, o.quick ? kQuick : kWhole);
  }
  wave::Trace trace(file);
  std::uint64_t changes = 0;
  std::vector<std::uint32_t> all;
  for (const wave::Signal& s : trace.signals()) all.push_back(s.handle);
  const auto start = Clock::now();
  trace.stream(all, trace.start(), trace.end(), [&](auto, auto, auto) { return ++changes, true; });
  const double streamed = std::chrono::duration<double>(Clock::now() - start).count();

  ordered_json j = {{"file_bytes", fs::file_size(file)},
                    {"signals", trace.signals().size()},
                    {"changes", changes}};
  print_figure(
      "\nwaves: {:.1f} MB, {} signals, {} changes; time of whole processes, the fastest of {}\n",
      static_cast<double>(fs::file_size(file)) / 1e6, trace.signals().size(), changes, kRounds);
  print_figure("{:<46} {:>9} {:>8}\n", "", "ms", "MB");
  print_figure("{:<46} {:>9.1f} {:>8}\n", "all changes, in this process", 1e3 * streamed, "");
  ordered_json list = ordered_json::array();
  const std::string self = program_file("cde-wave");
  const std::vector<Row> rows = rows_of(self, file.string());
  Progress progress("waves");
  for (const Row& row : rows) {
    progress(static_cast<double>(list.size()) / static_cast<double>(rows.size()), row.what);
    const Cost cost = measure(row.words, row.words.front() == self ? kRounds : 2);
    list.push_back(
        {{"what", row.what},
         {"wall_seconds", cost.ran ? ordered_json(cost.seconds) : ordered_json()},
         {"resident_bytes", cost.ran ? ordered_json(1024 * cost.kilobytes) : ordered_json()}});
    if (cost.ran)
      print_figure("{:<46} {:>9.1f} {:>8.0f}\n", row.what, 1e3 * cost.seconds,
                   static_cast<double>(cost.kilobytes) / 1e3);
    else
      print_figure("{:<46} {:>9}\n", row.what, "not installed");
  }
  j["questions"] = list;
  return j;
}

}  // namespace cde::cli
