// SPDX-License-Identifier: Apache-2.0
// cde advise: names the cheapest pipe that meets demands.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "accuracy/advice.hpp"
#include "accuracy/names.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "options/device_options.hpp"
#include "options/help.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

struct AdviseOptions {
  std::string pair = "ray-triangle", at = "p999", time, target = kDefaultTarget, from;
  double max_error = 0, max_wrong = 0, tests = 1e6;
  bool has_error = false, has_wrong = false, no_leaks = false, sure = false, json = false;
};

/// Length of "1", "1.5", "2e-3" at the front of a text, with at most 3 digits of an exponent; 0 if
/// it begins otherwise.
std::size_t number_length(std::string_view text) {
  const auto behind_digits = [&](std::size_t at) {
    return std::min(text.find_first_not_of("0123456789", at), text.size());
  };
  std::size_t end = behind_digits(0);
  if (end == 0) return 0;
  if (text.substr(end).starts_with('.')) end = behind_digits(end + 1);
  if (!text.substr(end).starts_with('e')) return end;
  const std::size_t digits = end + (text.substr(end).starts_with("e-") ? 2 : 1);
  const std::size_t count = behind_digits(digits) - digits;
  return count >= 1 && count <= 3 ? digits + count : end;
}

double parse_time(const std::string& text) {
  constexpr double kLeast = 1e-12, kMost = 1e9;  // s
  const std::string number = text.substr(0, number_length(text));
  const std::string unit = text.substr(number.size());
  const std::vector<std::string> units = {"ns", "us", "µs", "ms", "s"};
  if (number.empty() || std::find(units.begin(), units.end(), unit) == units.end())
    throw Error(ErrorCode::kUsage,
                fmt::format("--time is {}; it must be a number and ns, us, ms or s, e.g. 1ms",
                            in_quotes(text)));
  // A number beyond the range of double becomes 0 or infinity.
  const double seconds = std::strtod(number.c_str(), nullptr) * (unit == "ns"   ? 1e-9
                                                                 : unit == "ms" ? 1e-3
                                                                 : unit == "s"  ? 1
                                                                                : 1e-6);
  if (!(seconds >= kLeast && seconds <= kMost))
    throw Error(ErrorCode::kUsage,
                fmt::format("--time is {}; it must be 1 ps to 1e9 s", in_quotes(text)));
  return seconds;
}

Demands demands_of(const AdviseOptions& o) {
  Demands d{.pair = pair_in_any_order(o.pair).pair};
  if (o.has_error) d.max_error = o.max_error;
  if (o.has_wrong) d.max_wrong = o.max_wrong;
  d.quantile = o.at == "p99"    ? &Quantiles::p99
               : o.at == "p999" ? &Quantiles::p999
                                : &Quantiles::largest;
  d.no_leaks = o.no_leaks, d.sure = o.sure, d.tests = o.tests;
  if (!o.time.empty()) d.seconds = parse_time(o.time);
  if (d.no_leaks && d.pair != Pair::kRayTriangle)
    cannot_combine("--no-leaks", "--pair " + o.pair, "expected ray-triangle");
  return d;
}

void run(const AdviseOptions& o) {
  const Demands demands = demands_of(o);
  const Target target = parse_target(o.target);
  const std::string file =
      o.from.empty()
          ? (model_builder().parent_path().parent_path() / "docs" / "accuracy.json").string()
          : o.from;
  const SavedSweep sweep = read_sweep(file, target);
  const std::vector<Candidate> all = advise(sweep, demands);
  if (all.empty())
    throw Error(ErrorCode::kUsage,
                fmt::format("{} has no configuration of {}", printable_name(file), o.pair));
  if (o.json) {
    nlohmann::ordered_json report = program_json();
    report.update({{"schema", "cde.advise.2"},
                   {"pair", o.pair},
                   {"target", target.name},
                   {"tests", demands.tests},
                   {"advised", advice_json(sweep, demands, all)}});
    print(json_text(report) + "\n");
  } else {
    print(advice_text(sweep, demands, target, all));
  }
  if (!all.front().unmet.empty()) exit_code = 1;
}

}  // namespace

void add_advise(CLI::App& app) {
  auto o = std::make_shared<AdviseOptions>();
  CLI::App* verb = app.add_subcommand(
      "advise",
      "Name the cheapest pipe that meets demands, by area and then by time, with its figures and "
      "the commands that repeat them. If no pipe meets them, print the unmet demands; the exit "
      "status is then 1. Figures come from a file of cde accuracy --json");
  begin_group(*verb, "Demands");
  pair_value(verb->add_option("--pair", o->pair, "Pair")->capture_default_str(), "PAIR");
  auto* error = number_in(verb->add_option("--max-error", o->max_error,
                                           "Largest allowed error of T, over the size of the pair"),
                          0, 1e6, "");
  one_of(verb->add_option("--at", o->at,
                          "Which error counts: the 99 or 99.9 % quantile, or the largest")
             ->capture_default_str(),
         {"p99", "p999", "largest"});
  verb->add_flag("--no-leaks", o->no_leaks,
                 "Demand that no ray from inside a closed mesh misses the mesh");
  auto* wrong = number_in(verb->add_option("--max-wrong", o->max_wrong,
                                           "Most wrong decisions per million, beyond the band"),
                          0, 1e6, "");
  verb->add_flag("--sure", o->sure,
                 "Compare the upper end of the confidence interval with --max-wrong, not the "
                 "measured share")
      ->needs(wrong);
  text_value(verb->add_option("--time", o->time, "Longest modelled time of the tests"), "TIME",
             [](const std::string& text) { (void)parse_time(text); });
  number_in(
      verb->add_option("--tests", o->tests, "Number of tests for --time")->capture_default_str(), 1,
      1e15, "");
  begin_group(*verb, "Figures");
  target_option(*verb, o->target, "FPGA of the costs per lane, or an assumed clock")
      ->capture_default_str();
  file_value(verb->add_option("--from", o->from, "File of cde accuracy --json")
                 ->default_str("docs/accuracy.json"),
             "FILE");
  begin_group(*verb, "Messages");
  verb->add_flag("--json", o->json, "All configurations of the pair as JSON, best first");
  quiet_flag(*verb);
  verb->callback([o, error, wrong] {
    o->has_error = error->count() > 0, o->has_wrong = wrong->count() > 0;
    run(*o);
  });
}

}  // namespace cde::cli
