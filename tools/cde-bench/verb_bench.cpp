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

#include "baselines/baseline_opencl.hpp"
#include "bench/bench.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/card/machine.hpp"
#include "cde/support/error.hpp"
#include "options/device_options.hpp"
#include "options/help.hpp"
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
    {"effects", bench_effects}, {"bvh", bench_bvh}, {"gpu", bench_gpu},     {"waves", bench_waves}};

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

void list_devices(bool json) {
  if (json) Figures::beside_json();
  nlohmann::ordered_json all = program_json();
  all["opencl_devices"] = list_opencl_devices();
  if (json) print_json(all);
}

/// Checks options that only some sections use, before any work.
void check_sections(const BenchOptions& o, bool mesh, const std::vector<std::string>& wanted) {
  if (o.markdown && wanted != std::vector<std::string>{"effects"})
    throw_usage("--markdown needs only the section effects: cde bench effects --markdown");
  if (mesh && wanted != std::vector<std::string>{"gpu"})
    throw_usage("--mesh needs only the section gpu: cde bench gpu --mesh MESH");
  if (!o.opencl_device.empty()) {
    const auto uses = [](const std::string& s) { return s == "gpu" || s == "rays" || s == "bvh"; };
    if (!wanted.empty() && std::none_of(wanted.begin(), wanted.end(), uses))
      throw_usage("--opencl-device needs the section gpu, rays or bvh");
  }
  if (o.needs_opencl || !o.opencl_device.empty())
    (void)baseline::choose_opencl_device(baseline::opencl_devices(), o.opencl_device);
}

void run(const BenchOptions& o, const std::vector<std::string>& wanted, bool json) {
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

CLI::Option* opencl_device_option(CLI::App& verb, std::string& words) {
  return text_value(
      verb.add_option("--opencl-device", words,
                      "OpenCL device, by number or part of its name, also if it is no GPU "
                      "[the first GPU; section gpu: else the first device]"),
      "NAME", {});
}

void add_bench(CLI::App& app) {
  struct Arguments {
    BenchOptions options;
    std::vector<std::string> sections;
    std::string mesh;
    DeviceWords device;
    bool json = false, list = false;
  };
  auto a = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand(
      "bench", "Measure simulation speed and device cycles, and software on the same machine");
  named(verb->add_option("section", a->sections,
                         "Sections to run: rays, fp, pairs, bus, effects, bvh, gpu, waves")
            ->default_str("all"),
        {"rays", "fp", "pairs", "bus", "effects", "bvh", "gpu", "waves"}, "SECTION", "section");
  begin_group(*verb, "Figures");
  auto* json = verb->add_flag("--json", a->json, "Figures as JSON on stdout");
  auto* markdown = verb->add_flag("--markdown", a->options.markdown,
                                  "Section effects only: print the table of docs/tables/effects.md")
                       ->excludes(json);
  auto* quick = verb->add_flag("--quick", a->options.quick,
                               "Default models and small scenes, under a minute");
  auto* full = verb->add_flag("--full", a->options.full,
                              "Up to 10 million triangles, every format; gpu: every cast")
                   ->excludes(quick);
  begin_group(*verb, "Modelled time");
  device_options(*verb, a->device);
  begin_group(*verb, "OpenCL");
  auto* mesh =
      file_value(verb->add_option("--mesh", a->mesh,
                                  "Section gpu only: the mesh, a file or terrain:QX,QY,SEED "
                                  "[259,572 triangles of terrain]"),
                 "MESH");
  auto* opencl = opencl_device_option(*verb, a->options.opencl_device);
  auto* list = verb->add_flag("--list", a->list, "Print the OpenCL devices, and measure nothing");
  for (CLI::Option* option : {markdown, quick, full, mesh, opencl}) list->excludes(option);
  begin_group(*verb, "Messages");
  quiet_flag(*verb);
  verb->callback([a] {
    if (a->list) {
      if (!a->sections.empty() && a->sections != std::vector<std::string>{"gpu"})
        throw_usage("--list needs only the section gpu: cde bench gpu --list");
      return list_devices(a->json);
    }
    a->options.device = a->device.chosen();
    a->options.needs_opencl =
        std::find(a->sections.begin(), a->sections.end(), "gpu") != a->sections.end();
    check_sections(a->options, !a->mesh.empty(), a->sections);
    if (!a->mesh.empty()) a->options.mesh = load_mesh_or_builtin(a->mesh);
    run(a->options, a->sections, a->json);
  });
}

}  // namespace cde::cli
