// SPDX-License-Identifier: Apache-2.0
// cde reproduce: measures the paper's figures again, and writes a page.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/reproduce.hpp"
#include "cde/card/machine.hpp"
#include "cde/model/device.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suffix.hpp"
#include "options/device_options.hpp"
#include "options/help.hpp"
#include "options/values.hpp"
#include "output/device_output.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

struct Arguments {
  ReproduceOptions options;
  std::string out = "reproduction.html";
  DeviceWords device;
  std::string opencl_device;
  bool json = false, quiet = false;
};

void run(const Arguments& a) {
  if (a.json) Figures::beside_json();
  check_outputs(std::vector<FileUse>{{"--output", a.out}, {"--json", a.json ? "-" : ""}}, {});
  check_suffix("--output", a.out, ".html");
  if (a.out == "-") Figures::beside_json();
  OutputFile page(a.out);  // a missing folder is an error before the work
  print_figure("{:<22} {}\n", "device", device_row(a.options.device));
  print_figure("{:<22} {}\n", "evidence", a.options.device.why);
  if (a.options.opencl) print_figure("{:<22} {}\n", "OpenCL device", a.options.opencl->label());
  const Reproduction r = reproduce(a.options);
  const nlohmann::ordered_json machine = machine_json();
  page.write(reproduction_html(r, machine));
  page.commit();
  for (const auto* figure : {&r.figure5, &r.figure6, &r.figure7}) {
    for (const Experiment& e : *figure) {
      print_figure("{}\n", e.title);
      for (const Entry& entry : e.entries)
        print_figure("  {:<46} {:>9}  {}\n", entry.name, duration(entry.seconds), entry.note);
    }
  }
  print_figure("With a BVH\n");
  for (const WithBvh& row : r.bvh) {
    show_bvh(row.figures);
    print_figure(
        "  brute force with {}, ideal memory: 256 rays with all transfers over PCI 64/66 {}\n",
        counted(a.options.lanes, "lane"), duration(row.brute_force.seconds));
  }
  if (!a.quiet)
    log("check: {} of {} compared with the reference, 0 differ\npage: {}\n", r.records_compared,
        counted(r.records_compared, "record"), printable_name(a.out));
  if (a.json) print_json(reproduction_json(r, machine));
}

}  // namespace

void add_reproduce(CLI::App& app) {
  auto a = std::make_shared<Arguments>();
  CLI::App* verb = app.add_subcommand(
      "reproduce",
      "Measure the paper's Figures 5, 6 and 7 again, and rays with a BVH, and write a page");
  begin_group(*verb, "Figures");
  file_value(verb->add_option("-o,--output,--out", a->out, "The page, one HTML file")
                 ->capture_default_str(),
             "FILE.html");
  verb->add_flag("--json", a->json, "Figures as JSON on stdout");
  verb->add_flag("--quick", a->options.quick,
                 "A small terrain and few spheres, to check that everything works");
  auto* lanes = lanes_value(verb->add_option("--lanes", a->options.lanes,
                                             "Lanes of the best card instead of the device's"));
  begin_group(*verb, "Modelled time");
  device_options(*verb, a->device);
  begin_group(*verb, "OpenCL");
  opencl_device_option(*verb, a->opencl_device);
  begin_group(*verb, "Messages");
  quiet_flag(*verb, &a->quiet);
  verb->callback([a, lanes] {
    a->options.device = a->device.chosen();
    if (a->options.device.narrow_memory)
      throw Error(
          ErrorCode::kUsage,
          fmt::format(
              "{} has a memory of 16 bits; reproduce needs a device with DDR-400, such as {}",
              a->options.device.name, default_device().name));
    if (lanes->empty()) a->options.lanes = a->options.device.lanes;
    a->options.opencl = opencl_for_rows(a->opencl_device);
    run(*a);
  });
}

}  // namespace cde::cli
