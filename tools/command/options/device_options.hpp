// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/model/device.hpp"
#include "cde/scene/scene.hpp"
#include "options/cli_fwd.hpp"

/// The device of modelled times: --device, and --clock.
namespace cde::cli {

struct DeviceWords {
  std::string device = default_device().name;
  double mhz = 0;  ///< 0: the clock of the device

  [[nodiscard]] Device chosen() const;
};
/// Adds --device and --clock.
void device_options(CLI::App& verb, DeviceWords& words);

/// Adds --device to a verb that reads a scene, which names its own device.
CLI::Option* scene_device_option(CLI::App& verb, std::string& device);
/// Gives the scene this device, if the name is not empty. Error kUsage if the scene has its own
/// clock or latencies.
void use_device(const std::string& device, Scene& scene);

/// --target of costs per lane: an FPGA of docs/costs.json, or assumed:NUMBERMHz.
CLI::Option* target_option(CLI::App& verb, std::string& target, const std::string& what);

}  // namespace cde::cli
