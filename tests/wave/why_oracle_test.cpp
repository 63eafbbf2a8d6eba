// SPDX-License-Identifier: Apache-2.0
// cde wave why: the executed ones among random statements, compared with another simulator
// (Icarus).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "cde/wave/cone.hpp"
#include "random_design.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

class WhyOracle : public Cli {
 protected:
  /// Simulates the waves and writes the structure of the same source.
  void simulate(const RandomDesign& design) {
    write("dut.v", design.source);
    write("bench.v", design.bench);
    const Ran ran = shell(
        "iverilog -g2012 -o dut.vvp bench.v dut.v && vvp -n dut.vvp -fst && "
        "verilator -O0 --xml-only -Wno-fatal -Wno-lint --xml-output dut.xml --top-module dut "
        "dut.v");
    ASSERT_EQ(ran.status, 0) << ran.err;
  }

  /// The answer of `why` for a mark at a time: executed statements.
  struct Answer {
    std::vector<wave::Node::Statement> statements;
    std::vector<std::string> causes;  ///< names of the first statement's causes
  };
  Answer why(const std::string& name, std::uint64_t time) {
    const auto slice = design_->find(name);
    if (!slice) throw std::runtime_error(name + " is not in the design");
    wave::Lines lines(0);
    const wave::Cone cone(*trace_, *times_, *design_, *slice, time, 0, lines);
    Answer a;
    for (const auto& s : cone.nodes().front().statements)
      if (!s.kept) a.statements.push_back(s);
    if (!a.statements.empty())
      for (const wave::Slice& s : a.statements.front().driver.sources)
        a.causes.push_back(design_->local_name(s));
    return a;
  }
  void open() {
    trace_.emplace((folder_ / "dut.fst").string());
    times_.emplace(*trace_, "");
    design_.emplace(wave::Design::of(*trace_, (folder_ / "dut.xml").string()));
  }

  std::optional<wave::Trace> trace_;
  std::optional<wave::Times> times_;
  std::optional<wave::Design> design_;
};

TEST_F(WhyOracle, RandomStatements_ExecutedOnesAreNamed) {
  if (shell("iverilog -V && vvp -V").status != 0) GTEST_SKIP() << "needs Icarus Verilog";
  unsigned statements = 0, choices = 0, wrong = 0;
  for (unsigned seed = 1; seed <= 5 && wrong == 0; ++seed) {
    const RandomDesign design = random_design(seed, 150, "dut.fst");
    simulate(design);
    if (HasFatalFailure()) return;
    open();
    for (unsigned m = 0; m < design.marks; ++m) {
      const std::string name = fmt::format("bench.dut.m{}", m);
      const auto& all = trace_->signals();
      const auto signal = std::find_if(all.begin(), all.end(),
                                       [&](const wave::Signal& s) { return s.name == name; });
      if (signal == all.end()) continue;  // a process that reads nothing never runs
      for (std::uint64_t time = 3 + m % 5; time < 240; time += 10 + m % 7 * 10) {
        std::string bits;
        trace_->stream(std::array{signal->handle}, time, time,
                       [&](auto, auto, std::string_view value) {
                         bits = value;
                         return true;
                       });
        const auto value = wave::word(bits);
        if (!value) continue;
        const Answer a = why(name, time);
        std::string found;
        for (const auto& s : a.statements)
          found += fmt::format(" line {}{}", s.driver.place.line, s.driver.sure ? "" : " in doubt");
        if (const auto c = design.choices.find(m); c != design.choices.end()) {
          const auto is_cause = [&](unsigned k) {
            const std::string own = fmt::format("k{}", k);
            return std::count(a.causes.begin(), a.causes.end(), own) == 1;
          };
          if (*value != c->second.yes && *value != c->second.no) continue;  // x ? a : b
          ++choices;
          const bool yes = *value == c->second.yes;
          if (is_cause(c->second.yes) == yes && is_cause(c->second.no) == !yes) continue;
          found += fmt::format(" from {}", fmt::join(a.causes, " "));
        } else {
          ++statements;
          const unsigned line = design.lines.at(static_cast<unsigned>(*value));
          if (found == fmt::format(" line {}", line)) continue;
          found += fmt::format(", not {}", line);
        }
        if (++wrong <= 10)
          ADD_FAILURE() << fmt::format("seed {}: {} at {}:{}", seed, name, time, found);
      }
    }
    if (wrong != 0) ADD_FAILURE() << wrong << " answers are wrong in " << design.source;
  }
  EXPECT_GE(statements, 2000u);
  EXPECT_GE(choices, 500u);
  RecordProperty("statements", static_cast<int>(statements));
}

}  // namespace
}  // namespace cde::testing
