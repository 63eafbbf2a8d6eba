// SPDX-License-Identifier: Apache-2.0
#include "output/device_output.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

namespace cde::cli {

nlohmann::ordered_json device_json(const Device& d) {
  return {{"name", d.name},
          {"kind", name_of(d.kind)},
          {"fpga", d.fpga},
          {"clock_hz", d.clock_hz()},
          {"lanes", d.lanes},
          {"traversal_units", d.traversal_units},
          {"latencies",
           {{"add", d.latencies.add},
            {"mul", d.latencies.mul},
            {"div", d.latencies.div},
            {"sqrt", d.latencies.sqrt},
            {"compare", d.latencies.compare}}},
          {"memory", d.memory},
          {"why", d.why}};
}

std::string device_row(const Device& device) {
  return fmt::format("{}, cycles of add/mul/div/sqrt/compare: {}", device.text(),
                     device.latencies_text());
}

}  // namespace cde::cli
