// SPDX-License-Identifier: Apache-2.0
#include "options/device_options.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include "cde/costs/cost_table.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "options/values.hpp"

namespace cde::cli {
namespace {

CLI::Option* named_device(CLI::App& verb, std::string& device, const char* what) {
  std::vector<std::string> names;
  for (const Device& d : devices()) names.push_back(d.name);
  return one_of(verb.add_option("--device", device, what), names);
}

}  // namespace

Device DeviceWords::chosen() const {
  Device d = device_named(device);
  if (mhz > 0) d.clock_mhz = mhz;
  return d;
}

void device_options(CLI::App& verb, DeviceWords& words) {
  named_device(verb, words.device,
               "Device of modelled times: its clock, its latencies, and how many lanes and "
               "traversal units it has (docs/background/costs.md)")
      ->capture_default_str();
  clock_option(verb, words.mhz);
}

CLI::Option* scene_device_option(CLI::App& verb, std::string& device) {
  return named_device(verb, device,
                      "Device of modelled times instead of the scene's (docs/background/costs.md)");
}

void use_device(const std::string& device, Scene& scene) {
  if (device.empty()) return;
  const Device& own = scene.card.device;
  const Device& known = device_named(own.name);
  if (own.clock_mhz != known.clock_mhz || own.latencies != known.latencies)
    throw Error(ErrorCode::kUsage,
                fmt::format("--device is {}, and {} has clock_mhz or latency; only one of them may "
                            "be given",
                            device, printable_name(scene.file)));
  scene.card.device = device_named(device);
}

CLI::Option* target_option(CLI::App& verb, std::string& target, const std::string& what) {
  return text_value(verb.add_option("--target", target, what), "ecp5-85|hx8k|assumed:NMHz",
                    [](const std::string& text) { (void)parse_target(text); });
}

}  // namespace cde::cli
