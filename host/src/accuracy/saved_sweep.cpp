// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/saved_sweep.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "cde/accuracy/sweep.hpp"
#include "cde/support/error.hpp"
#include "cde/support/input_file.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"

namespace cde::accuracy {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t count_of(const Json& json, const char* key) {
  const Json& value = json.at(key);
  if (!value.is_number_unsigned())
    throw Error(ErrorCode::kFile,
                fmt::format("{} is {}; it must be a whole number, 0 or more", key, value.dump()));
  return value.get<std::uint64_t>();
}

double finite_or_infinite(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

Quantiles quantiles_of(const Json& json) {
  Quantiles q;
  q.count = count_of(json, "count");
  if (q.count == 0) return q;
  q.median = finite_or_infinite(json.at("median")), q.p99 = finite_or_infinite(json.at("p99"));
  q.p999 = finite_or_infinite(json.at("p999"));
  q.largest = finite_or_infinite(json.at("largest"));
  return q;
}

std::optional<SavedCase> case_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return SavedCase{.family = json.at("family"),
                   .command = json.at("repeat_command").is_null()
                                  ? std::string()
                                  : json.at("repeat_command").get<std::string>(),
                   .index = count_of(json, "case_index"),
                   .size = finite_or_infinite(json.at("error_u"))};
}

unsigned small_count_of(const Json& json, const char* key) {
  const std::uint64_t count = count_of(json, key);
  if (count > std::numeric_limits<unsigned>::max())
    throw Error(ErrorCode::kFile, fmt::format("{} is {}; expected at most {}", key, count,
                                              std::numeric_limits<unsigned>::max()));
  return static_cast<unsigned>(count);
}

std::optional<unsigned> optional_count_of(const Json& json, const char* key) {
  return json.at(key).is_null() ? std::nullopt : std::optional(small_count_of(json, key));
}

SavedTally tally_of(const Json& json) {
  SavedTally t;
  t.family = json.value("family", "");
  t.cases = count_of(json, "cases"), t.refused = count_of(json, "refused");
  t.leak_rays = count_of(json, "leak_rays");
  t.judged = t.cases - std::min(t.cases, t.refused + t.leak_rays);
  const std::uint64_t hits = count_of(json.at("false_hits"), "count");
  t.wrong = hits + count_of(json.at("false_misses"), "count");
  t.leaks = count_of(json.at("leaks"), "count");
  if (t.refused > t.cases || t.leak_rays > t.cases - t.refused || t.wrong > t.judged ||
      t.wrong < hits || t.leaks > t.leak_rays)
    throw Error(ErrorCode::kFile,
                fmt::format("{} cases, of these {} refused and {} rays that may leak, then {} "
                            "wrong and {} leaked rays: these counts contradict each other",
                            t.cases, t.refused, t.leak_rays, t.wrong, t.leaks));
  t.t = quantiles_of(json.at("t_error_u"));
  t.oracle = quantiles_of(json.at("oracle_u"));
  t.worst_t = case_of(json.at("worst_t"));
  t.worst_decision = case_of(json.at("worst_decision"));
  t.worst_leak = case_of(json.at("worst_leak"));
  return t;
}

PipeFigures figures_of(const Json& cost) {
  PipeFigures f;
  f.latency = optional_count_of(cost, "latency_levels");
  f.interval = optional_count_of(cost, "initiation_interval");
  const Json& kinds = cost.at("operators_by_kind");
  if (!kinds.is_null())
    f.operators = {.add = small_count_of(kinds, "add"),
                   .mul = small_count_of(kinds, "mul"),
                   .div = small_count_of(kinds, "div"),
                   .sqrt = small_count_of(kinds, "sqrt"),
                   .cmp = small_count_of(kinds, "compare")};
  return f;
}

AccuracyPipe pipe_of(const Json& json) {
  AccuracyPipe pipe;
  const auto pair = pair_named(json.at("pair").get<std::string>());
  if (!pair) throw Error(ErrorCode::kFile, "no pair " + json.at("pair").dump());
  pipe.pair = *pair;
  pipe.format = FpFormat::parse(json.at("format").get<std::string>());
  if (pipe.pair == Pair::kRayTriangle) {
    const auto algorithm = algorithm_named(json.at("algorithm").get<std::string>());
    if (!algorithm) throw Error(ErrorCode::kFile, "no algorithm " + json.at("algorithm").dump());
    pipe.algorithm = *algorithm;
    json.at("box").get_to(pipe.box);
  }
  const std::string variant = json.value("variant", "card");
  const auto known = std::ranges::find(variants(), variant, [](Variant v) { return name(v); });
  if (known == variants().end()) throw Error(ErrorCode::kFile, "no variant " + in_quotes(variant));
  pipe.variant = *known;
  if (!has_iterations(pipe.pair)) return pipe;
  const auto iterations = json.at("iterations").get<std::string>();
  if (std::sscanf(iterations.c_str(), "%2u,%2u,%2u", &pipe.iterations.samples,
                  &pipe.iterations.circle, &pipe.iterations.free) != 3)
    throw Error(ErrorCode::kFile, "iterations are " + in_quotes(iterations) + "; expected M,K1,K2");
  pipe.iterations.check();
  return pipe;
}

/// Checks what the page reads of `profiles`.
void check_profiles(const Json& profiles) {
  for (const Json& p : profiles) {
    for (const char* key : {"format", "along", "algorithm"})
      (void)p.at(key).get_ref<const std::string&>();
    for (const Json& point : p.at("profile_points")) {
      (void)point.at("axis_value").get<double>();
      for (const char* key : {"median", "p99"}) (void)finite_or_infinite(point.at(key));
    }
  }
}

}  // namespace

double SavedTally::error(double Quantiles::*quantile, bool* bounded) const {
  const double least = oracle.*quantile;
  if (bounded != nullptr) *bounded = t.*quantile < least;
  return std::max(t.*quantile, least);
}

double SavedTally::wrong_per_million() const {
  return judged == 0 ? 0 : 1e6 * static_cast<double>(wrong) / static_cast<double>(judged);
}

Interval95 SavedTally::wrong_interval() const {
  const Interval95 share = wilson(wrong, judged);
  return {1e6 * share.low, 1e6 * share.high};
}

double SavedPipe::u() const {
  return std::ldexp(1, -1 - pipe.format.man_bits);
}

std::string SavedSweep::command(const AccuracyPipe& pipe) const {
  std::string text = fmt::format("cde accuracy --pair {}", name(pipe.pair));
  if (pipe.pair == Pair::kRayTriangle)
    text += fmt::format(" --algorithms {} --box {}", name(pipe.algorithm), pipe.box ? "on" : "off");
  text += fmt::format(" --formats {}", pipe.format.name());
  if (has_iterations(pipe.pair))
    text += fmt::format(" --iterations {},{},{}", pipe.iterations.samples, pipe.iterations.circle,
                        pipe.iterations.free);
  if (pipe.variant != Variant::kCard) text += fmt::format(" --variants {}", name(pipe.variant));
  const std::vector<std::string> known = family_names({pipe});
  std::string own;  // the families that this pair has
  for (const std::string& family : families)
    if (std::ranges::find(known, family) != known.end()) own += (own.empty() ? "" : ",") + family;
  if (!own.empty()) text += " --families " + own;
  if (target != kDefaultTarget) text += " --target " + target;
  return text + fmt::format(" --cases {} --seed {} --by-family", cases, seed);
}

SavedSweep sweep_of(const Json& json, const std::string& where, const Target& target) {
  if (!json.is_object() || !json.contains("schema") || json.at("schema") != kSweepSchema)
    throw Error(ErrorCode::kFile, fmt::format("{}: not an accuracy file of schema {}, which cde "
                                              "accuracy --json writes; its schema is {}",
                                              where, kSweepSchema,
                                              json.is_object() && json.contains("schema")
                                                  ? in_quotes(json.at("schema").dump())
                                                  : "missing"));
  SavedSweep sweep{.json = json, .target = target.name};
  const CostTable table = CostTable::of_project();
  std::size_t number = 0;
  try {
    sweep.seed = count_of(json, "seed"), sweep.cases = count_of(json, "cases");
    if (json.contains("only_families")) json.at("only_families").get_to(sweep.families);
    for (const Json& one : json.at("configurations")) {
      ++number;
      SavedPipe kept;
      kept.pipe = pipe_of(one);
      kept.figures = figures_of(one.at("cost"));
      kept.cost = cost_of(kept.pipe, kept.figures, target, table);
      kept.all = tally_of(one.at("all_families"));
      for (const Json& family : one.at("families")) kept.families.push_back(tally_of(family));
      sweep.pipes.push_back(std::move(kept));
    }
    number = 0;
    if (json.contains("profiles")) check_profiles(json.at("profiles"));
  } catch (const std::exception& e) {
    const bool of_json = dynamic_cast<const Json::exception*>(&e) != nullptr;
    const std::string why = e.what();  // of JSON: "[json.exception.type_error.304] cannot ..."
    throw Error(
        ErrorCode::kFile,
        fmt::format("{}: {}{}", where, number == 0 ? "" : fmt::format("configuration {}: ", number),
                    of_json
                        ? fmt::format("a value is missing or has another type than `cde accuracy "
                                      "--json` writes ({})",
                                      why.substr(why.find("] ") + 2))
                        : why));
  }
  return sweep;
}

SavedSweep read_sweep(const std::string& file, const Target& target) {
  const Json json = parse_json(read_file(file));
  if (json.is_discarded())
    throw Error(ErrorCode::kFile, fmt::format("{}: not the JSON of one accuracy run; read a file "
                                              "of --resume with --resume and --page",
                                              printable_name(file)));
  return sweep_of(json, printable_name(file), target);
}

}  // namespace cde::accuracy
