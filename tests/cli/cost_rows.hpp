// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace cde::testing {

/// A row of a cost table, as tools/synthesis writes it, with three seeds.
inline nlohmann::json cost_row(const std::string& what, const std::string& format,
                               const std::string& lat, double lut, double dsp, double mhz,
                               const std::string& algorithm = "") {
  return {{"what", what},
          {"style", "cde"},
          {"algorithm", algorithm},
          {"format", format},
          {"lat", lat},
          {"lanes", 1},
          {"lut", lut},
          {"carry", 10},
          {"ff", 100},
          {"dsp", dsp},
          {"ram", 0},
          {"lutram", 0},
          {"mux", 0},
          {"target", "ecp5-85"},
          {"fmax", {{"1", mhz}, {"2", mhz + 5}, {"3", mhz - 5}}}};
}

/// Operators of fp16 and bf16, and one lane of each kind of table: measured, and too large.
inline nlohmann::json some_costs() {
  nlohmann::json rows = nlohmann::json::array();
  for (const char* format : {"fp16", "bf16"}) {
    rows.push_back(cost_row("add", format, "1", 250, 0, 30));
    rows.push_back(cost_row("add", format, "8", 300, 0, 140));
    rows.push_back(cost_row("mul", format, "9", 200, 1, 130));
    rows.push_back(cost_row("div", format, "19", 900, 0, 120));
    rows.push_back(cost_row("sqrt", format, "17", 700, 0, 125));
    rows.push_back(cost_row("lt", format, "1", 60, 0, 150));
  }
  rows.push_back(cost_row("ray-triangle", "fp16", "8/9/19/17/2", 20000, 27, 110, "moller"));
  rows.push_back(cost_row("ray-triangle", "fp32", "8/9/32/30/2", 90000, 108, 100, "moller"));
  return {{"rows", rows}};
}

}  // namespace cde::testing
