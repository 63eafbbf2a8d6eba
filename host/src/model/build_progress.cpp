// SPDX-License-Identifier: Apache-2.0
#include "model/build_progress.hpp"

#include "cde/model/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <utility>

namespace cde {
namespace {

constexpr std::string_view kPhase = "phase ";  // as printed by verilator/model_builder
constexpr const char* kAdvice = "first use of this configuration, kept for the next time";

std::atomic<bool> silent{false};

/// Prints to stderr. A closed or full stderr does not end the program.
void print(const std::string& text) {
  if (silent) return;
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

double expected_build_seconds(const std::vector<std::string>& parameters) {
  const bool gates = std::ranges::find(parameters, "ARITH=rtl") != parameters.end();
  return gates ? 60 : 30;
}

BuildProgress::BuildProgress(const std::string& what, double usual) : usual_(usual) {
  print(fmt::format("cde: building simulation model {} ({}; such builds take about {:.0f} s)\n",
                    what, kAdvice, usual));
  if (has_progress_display()) line_.emplace("cde: building a simulation model");
}

void BuildProgress::operator()(std::chrono::duration<double> elapsed, std::string_view printed) {
  elapsed_ = elapsed;
  std::string phase = phase_;
  while (!printed.empty()) {
    const std::string_view line = printed.substr(0, printed.find('\n'));
    if (line.size() == printed.size()) break;  // the line is not complete yet
    if (line.starts_with(kPhase)) phase = line.substr(kPhase.size());
    printed.remove_prefix(line.size() + 1);
  }
  if (std::exchange(phase_, phase) == phase) return;
  if (line_)
    line_->expect(usual_, phase_);
  else
    print(fmt::format("cde: {:.0f} s, {}\n", elapsed.count(), phase_));
}

void BuildProgress::set_quiet(bool quiet) {
  silent = quiet;
}

bool BuildProgress::quiet() {
  return silent;
}

void BuildProgress::end(bool built) {
  line_.reset();
  if (built) print(fmt::format("cde: built in {:.0f} s\n", elapsed_.count()));
}

std::string BuildProgress::without_phases(std::string_view printed) {
  std::string rest;
  while (!printed.empty()) {
    const std::size_t end = std::min(printed.find('\n'), printed.size() - 1) + 1;
    const std::string_view line = printed.substr(0, end);
    if (!line.starts_with(kPhase)) rest += line;
    printed.remove_prefix(end);
  }
  return rest;
}

}  // namespace cde
