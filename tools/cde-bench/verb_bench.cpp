// SPDX-License-Identifier: Apache-2.0
// cde bench: measures the simulated card and the software baselines in the same run.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <time.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/card/machine.hpp"
#include "cde/support/error.hpp"
#include "options/device_options.hpp"
#include "options/values.hpp"
#include "output/device_output.hpp"
#include "output/streams.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

struct Section {
  const char* name;
  nlohmann::ordered_json (*measure)(const BenchOptions&);
};
constexpr Section kSections[] = {
    {"rays", bench_rays},       {"fp", bench_fp},   {"pairs", bench_pairs}, {"bus", bench_bus},
    {"effects", bench_effects}, {"bvh", bench_bvh}, {"waves", bench_waves}};

std::string field_of(const char* file, const std::string& field) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(field)) return line.substr(std::min(line.size(), line.find(':') + 2));
  }
  return "unknown";
}

/// Facts about the machine, as in other verbs, and facts about its current speed.
nlohmann::ordered_json machine() {
#ifdef __clang__
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "g++ " __VERSION__;
#endif
  nlohmann::ordered_json j = machine_json();
  j.update({{"processor_mhz_now", field_of("/proc/cpuinfo", "cpu MHz")},
            {"load_average",
             [] {
               std::string load;
               std::ifstream("/proc/loadavg") >> load;
               return load;
             }()},
            {"host_compiler", compiler}});
  return j;
}

void run(const BenchOptions& o, const std::vector<std::string>& wanted, bool json) {
  if (o.markdown && wanted != std::vector<std::string>{"effects"})
    throw_usage("--markdown needs only the section effects: cde bench effects --markdown");
  if (json) Figures::beside_json();
  nlohmann::ordered_json all = program_json();
  all.update({{"device", device_json(o.device)}, {"machine", machine()}});
  if (!o.markdown) {
    for (const auto& [key, value] : all["machine"].items())
      print_figure("{:<22} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
    print_figure("{:<22} {}\n", "device", device_row(o.device));
  }
  for (const Section& s : kSections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), s.name) == wanted.end())
      continue;
    all[s.name] = s.measure(o);
  }
  if (json) print_json(all);
}

}  // namespace

double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void add_bench(CLI::App& app) {
  struct Arguments {
    BenchOptions options;
    std::vector<std::string> sections;
    DeviceWords device;
    bool json = false;
  };
  auto a = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand(
      "bench", "Measure simulation speed and device cycles, and software on the same machine");
  named(verb->add_option("section", a->sections,
                         "Sections to run: rays, fp, pairs, bus, effects, bvh, waves")
            ->default_str("all"),
        {"rays", "fp", "pairs", "bus", "effects", "bvh", "waves"}, "SECTION", "section");
  auto* json = verb->add_flag("--json", a->json, "Figures as JSON on stdout");
  quiet_flag(*verb);
  verb->add_flag("--markdown", a->options.markdown,
                 "Section effects only: print the table of docs/tables/effects.md")
      ->excludes(json);
  auto* quick = verb->add_flag("--quick", a->options.quick,
                               "Default models and small scenes, under a minute");
  verb->add_flag("--full", a->options.full, "Up to 10 million triangles, every format")
      ->excludes(quick);
  device_options(*verb, a->device);
  verb->callback([a] {
    a->options.device = a->device.chosen();
    run(a->options, a->sections, a->json);
  });
}

}  // namespace cde::cli
