// SPDX-License-Identifier: Apache-2.0
#include "cde/costs/costed_pipe.hpp"

#include <fmt/format.h>

#include "cde/contract/pairs.hpp"
#include "cde/netlist/pipe_figures.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {
namespace {

/// Cycles for scaling a pair to size one and its answer back (length_scale.sv, length_unscale.sv),
/// around the pipe, which is the same in all formats. An iterative pipeline includes them.
unsigned scaling_cycles(const PipeChoice& pipe) {
  const bool scaled = pipe.format.exp_bits < 8 || contract::has(contract::kScaledPairs, pipe.pair);
  return scaled && !has_iterations(pipe.pair) ? 3 : 0;
}

PipeFigures figures_of(const PipeChoice& pipe, const netlist::Pipe& in_rtl) {
  const netlist::Operators& o = in_rtl.operators;
  PipeFigures figures;
  figures.operators = {.add = o.adders + o.subtractors,
                       .mul = o.multipliers,
                       .div = o.dividers,
                       .sqrt = o.square_roots,
                       .cmp = o.comparators + o.min_max};
  figures.latency = in_rtl.latency + scaling_cycles(pipe), figures.interval = in_rtl.interval;
  if (!has_iterations(pipe.pair)) return figures;
  // A row makes as many passes as its iterations require.
  const unsigned passes = reference::passes(pipe.pair, pipe.iterations),
                 usual = reference::passes(pipe.pair, {});
  figures.interval = passes;
  figures.latency = in_rtl.latency + (passes - usual) * in_rtl.slots;
  return figures;
}

}  // namespace

std::string PipeChoice::name() const {
  std::string text(cde::name(pair));
  if (pair == Pair::kRayTriangle)
    text += fmt::format(" {}{}", cde::name(algorithm), box ? " box" : "");
  text += fmt::format(" {}", format.name());
  if (has_iterations(pair))
    text += fmt::format(" {},{},{}", iterations.samples, iterations.circle, iterations.free);
  return text;
}

std::optional<double> PipeFigures::cycles_per_million() const {
  if (!latency || !interval) return std::nullopt;
  return 1e6 * *interval + *latency - *interval;
}

CostedPipe costed(const PipeChoice& pipe, const PipeFigures& figures) {
  return {pipe.pair, pipe.algorithm, pipe.box, pipe.format, figures.operators};
}

std::vector<PipeFigures> figures_of(const std::vector<PipeChoice>& pipes) {
  std::vector<PipeFigures> all(pipes.size());
  std::vector<netlist::Pipe> wanted;
  std::vector<std::size_t> which;
  for (const PipeChoice& p : pipes) {
    std::size_t k = 0;
    while (k < wanted.size() && !(wanted[k].pair == p.pair && wanted[k].algorithm == p.algorithm &&
                                  wanted[k].box == p.box))
      ++k;
    if (k == wanted.size())
      wanted.push_back({.pair = p.pair, .algorithm = p.algorithm, .absent = "", .box = p.box});
    which.push_back(k);
  }
  try {
    netlist::examine_all(wanted, {});
  } catch (const Error& e) {
    log(fmt::format("cde: latencies and operators are unknown: {}\n", e.what()));
    return all;
  }
  for (std::size_t i = 0; i < pipes.size(); ++i)
    if (wanted[which[i]].absent.empty()) all[i] = figures_of(pipes[i], wanted[which[i]]);
  return all;
}

}  // namespace cde
