// SPDX-License-Identifier: Apache-2.0
// The choice of an OpenCL device by name. It needs no OpenCL.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "baselines/baseline_opencl.hpp"
#include "cde/support/error.hpp"

namespace cde::baseline {
namespace {

std::string lower(std::string_view text) {
  std::string low(text);
  std::transform(low.begin(), low.end(), low.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return low;
}

bool fits(const OpenClDevice& device, const std::string& words) {
  if (fmt::to_string(device.number) == words) return true;
  return lower(device.name).find(words) != std::string::npos ||
         lower(device.platform).find(words) != std::string::npos;
}

std::string listed(std::span<const OpenClDevice> devices) {
  std::string text;
  for (const OpenClDevice& d : devices)
    text += fmt::format("{}{} {} ({}, {})", text.empty() ? "" : "; ", d.number, d.name, d.kind,
                        d.platform);
  return text;
}

}  // namespace

std::string OpenClDevice::label() const {
  return is_gpu() ? fmt::format("GPU {}", name) : fmt::format("{} {} through OpenCL", kind, name);
}

std::string OpenClDevice::short_label() const {
  return is_gpu() ? kind : kind + " through OpenCL";
}

OpenClDevice choose_opencl_device(std::span<const OpenClDevice> devices, std::string_view words) {
  if (devices.empty()) throw_usage("there is no OpenCL device");
  if (words.empty()) {
    const auto gpu = std::find_if(devices.begin(), devices.end(),
                                  [](const OpenClDevice& d) { return d.is_gpu(); });
    return gpu != devices.end() ? *gpu : devices.front();
  }
  const std::string wanted = lower(words);
  std::vector<OpenClDevice> fitting;
  std::copy_if(devices.begin(), devices.end(), std::back_inserter(fitting),
               [&](const OpenClDevice& d) { return fits(d, wanted); });
  // A number alone is clear, even if names also contain it.
  const auto numbered = std::find_if(fitting.begin(), fitting.end(), [&](const OpenClDevice& d) {
    return fmt::to_string(d.number) == wanted;
  });
  if (numbered != fitting.end()) return *numbered;
  if (fitting.empty())
    throw_usage(
        fmt::format("--opencl-device is '{}'; expected the number or a part of the name of "
                    "one of: {}",
                    words, listed(devices)));
  if (fitting.size() > 1)
    throw_usage(fmt::format("--opencl-device is '{}', which fits several devices: {}", words,
                            listed(fitting)));
  return fitting.front();
}

}  // namespace cde::baseline
