// SPDX-License-Identifier: Apache-2.0
// Section fp of cde bench: measures the gate-level floating-point units alone, in simulated
// operations per second on one core.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <string_view>
#include <vector>

#include "bench/bench.hpp"
#include "cde/card/fp_unit.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

struct Operation {
  const char* name;
  FpOp op;
};
constexpr std::array kOperations = {Operation{"add", FpOp::kAdd}, Operation{"mul", FpOp::kMul},
                                    Operation{"div", FpOp::kDiv}, Operation{"sqrt", FpOp::kSqrt}};

/// Measures one operation in a model of its own, so that nothing else is simulated.
double measure(FpFormat format, const Operation& operation, int lanes, double seconds) {
  std::vector<std::string> parameters = fp_unit_parameters(format, Arithmetic::kRtl, lanes, false);
  parameters.push_back(fmt::format("OPS={}", 1u << static_cast<unsigned>(operation.op)));
  FpUnit unit(SimulationModel::open("fp_unit", parameters));
  return unit.measure(operation.op, seconds);
}

}  // namespace

nlohmann::ordered_json bench_fp(const BenchOptions& o) {
  std::vector<std::string_view> formats = {"fp32"};
  if (o.full)
    for (const NamedFpFormat& f : kFpFormats)
      if (f.name != "fp32") formats.push_back(f.name);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  print_figure(
      "\ngate-level units, latency 1, no flags, one core, processor time\n{:<7}{:>6}{:>16}\n",
      "format", "lanes", "M operations/s");
  // An upper bound on the number of measurements: all operations, and all lane counts of fp32.
  const auto most = static_cast<double>(kOperations.size() * (formats.size() + 2));
  double done = 0;
  Progress progress("fp");
  for (const std::string_view name : formats) {
    const FpFormat format = FpFormat::parse(name);
    // The best number of lanes depends on the operation and on the processor, whose vectors hold
    // fewer wide words.
    std::vector<int> counts = {32, 64, 128};
    if (o.quick) counts = {64};
    if (name != "fp32") counts = {name == "fp64" ? 16 : 64};
    for (const Operation& operation : kOperations)
      for (const int lanes : counts) {
        if (o.quick && operation.op > FpOp::kMul) continue;
        progress(done++ / most, fmt::format("{} lanes of {}, {}", lanes, name, operation.name));
        const double rate = measure(format, operation, lanes, o.quick ? 0.2 : 1.0);
        print_figure("{:<7}{:>6}{:>16.1f}  {}\n", name, lanes, rate / 1e6, operation.name);
        rows.push_back({{"format", name},
                        {"operation", operation.name},
                        {"arithmetic", "rtl"},
                        {"lanes", lanes},
                        {"operations_per_second_simulated", rate}});
      }
  }
  return {{"what",
           "simulated operations per second of processor time, gate level, latency 1, flags off"},
          {"units", rows}};
}

}  // namespace cde::cli
