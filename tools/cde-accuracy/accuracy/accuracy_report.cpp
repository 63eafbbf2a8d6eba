// SPDX-License-Identifier: Apache-2.0
#include "accuracy/accuracy_report.hpp"
#include <nlohmann/json.hpp>

#include "cde/accuracy/promise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cde/fp/number_text.hpp"
#include "cde/support/columns.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// A quantile of errors as text. A value below the width of the oracle's interval is printed as
/// "<width", or as 0 if the width is negligible.
std::string quantile(const ErrorCounts& errors, double share, const ErrorCounts& oracle) {
  if (errors.count() == 0) return "-";
  const double value = share == 1 ? errors.largest() : errors.quantile(share);
  const double width = oracle.count() == 0 ? 0
                       : share == 1        ? oracle.largest()
                                           : oracle.quantile(share);
  if (value >= width) return compact(value);
  return width < 0.01 ? "0" : fmt::format("<{}", compact(width));
}

/// The 95 % interval of a share, per million.
std::string per_million(std::uint64_t found, std::uint64_t all) {
  if (all == 0) return "-";
  const Interval95 share = wilson(found, all);
  return fmt::format("{}..{}", compact(1e6 * share.low), compact(1e6 * share.high));
}

std::string percent(std::uint64_t part, std::uint64_t all) {
  return all == 0
             ? "-"
             : fmt::format("{:.1f}", 100.0 * static_cast<double>(part) / static_cast<double>(all));
}

template <class T>
std::string or_dash(const std::optional<T>& value) {
  return value ? compact(static_cast<double>(*value)) : "-";
}

Columns::Cells errors_line(const std::string& name, const Tally& t) {
  static const ErrorCounts kExact;        // the oracle's width does not count in ulps
  const auto ulps = [&t](double share) {  // none below the oracle's width
    return quantile(t.t, share, t.oracle).starts_with('<') ? "-"
                                                           : quantile(t.t_ulps, share, kExact);
  };
  return {name,
          fmt::to_string(t.cases),
          percent(t.refused, t.cases),
          quantile(t.t, 0.5, t.oracle),
          quantile(t.t, 0.99, t.oracle),
          quantile(t.t, 0.999, t.oracle),
          quantile(t.t, 1, t.oracle),
          ulps(0.5),
          ulps(0.99),
          quantile(t.cp, 0.99, kExact),
          quantile(t.cp, 1, kExact),
          quantile(t.n, 1, kExact)};
}

Columns::Cells decisions_line(const std::string& name, const Tally& t, const Cost* cost) {
  Columns::Cells line = {name,
                         fmt::to_string(t.false_hits),
                         per_million(t.false_hits, t.judged()),
                         fmt::to_string(t.false_misses),
                         per_million(t.false_misses, t.judged()),
                         percent(t.undecided, t.judged()),
                         t.leak_rays == 0 ? "-" : fmt::format("{}/{}", t.leaks, t.leak_rays)};
  if (cost == nullptr) {
    line.insert(line.end(), 8, "");
    return line;
  }
  const PipeFigures& f = cost->figures;
  const auto& lane = cost->lane;
  // A ~ marks an estimate.
  const std::string luts =
      lane ? fmt::format("{}{}", lane->estimated ? "~" : "", compact(lane->cells.lut)) : "-";
  const std::optional<double> seconds = cost->seconds(1e6);
  line.insert(
      line.end(),
      {or_dash(f.latency), or_dash(f.interval), f.operators ? compact(f.operators->total()) : "-",
       or_dash(f.cycles_per_million()), luts, or_dash(cost->mhz()),
       cost->mhz() ? fmt::to_string(cost->lanes()) : "-", seconds ? compact(1e3 * *seconds) : "-"});
  return line;
}

Json errors_json(const ErrorCounts& errors) {
  const auto at = [&](double share) {
    const double value = share == 1 ? errors.largest() : errors.quantile(share);
    return errors.count() == 0 || !std::isfinite(value) ? Json() : Json(value);
  };
  return {{"count", errors.count()},
          {"median", at(0.5)},
          {"p99", at(0.99)},
          {"p999", at(0.999)},
          {"largest", at(1)}};
}

Json worst_json(const AccuracyPipe& pipe, const std::optional<WorstCase>& worst) {
  if (!worst) return {};
  const WordText text(pipe.format);
  Json a = Json::array(), b = Json::array();
  for (const std::uint64_t word : worst->a) a.push_back(text.hexfloat(word));
  for (const std::uint64_t word : worst->b) b.push_back(text.hexfloat(word));
  return {
      {"family", worst->family},
      {"case_index", worst->index},
      {"error_u", std::isfinite(worst->size) ? Json(worst->size) : Json()},
      {"a_words", a},
      {"b_words", b},
      {"repeat_command",
       pipe.variant == Variant::kCard ? Json(pipe.repeat_command(worst->a, worst->b)) : Json()}};
}

Json tally_json(const AccuracyPipe& pipe, const Tally& t) {
  return {{"cases", t.cases},
          {"refused", t.refused},
          {"not_numbers", t.not_numbers},
          {"hits", t.hits},
          {"undecided", t.undecided},
          {"undecided_differ", t.undecided_differ},
          {"false_hits", share_json(t.false_hits, t.judged())},
          {"false_misses", share_json(t.false_misses, t.judged())},
          {"leak_rays", t.leak_rays},
          {"leaks", share_json(t.leaks, t.leak_rays)},
          {"t_error_u", errors_json(t.t)},
          {"t_error_ulps", errors_json(t.t_ulps)},
          {"cp_error_u", errors_json(t.cp)},
          {"n_error_u", errors_json(t.n)},
          {"oracle_u", errors_json(t.oracle)},
          {"worst_t", worst_json(pipe, t.worst_t)},
          {"worst_decision", worst_json(pipe, t.worst_decision)},
          {"worst_leak", worst_json(pipe, t.worst_leak)}};
}

}  // namespace

std::string compact(double value) {
  if (std::isinf(value)) return "inf";
  if (value == 0) return "0";
  std::string text;
  if (value >= 0.00995 && value < 99999.5) {
    text = value >= 99.95 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
  } else {
    const std::string digits = fmt::format("{:.1e}", value);  // "1.2e+05"
    const std::size_t e = digits.find('e');
    const std::string_view mantissa = std::string_view(digits).substr(0, e);
    text = fmt::format("{}e{}", mantissa.ends_with(".0") ? mantissa.substr(0, 1) : mantissa,
                       std::stoi(digits.substr(e + 1)));
  }
  return text;
}

std::string accuracy_tables(const std::vector<AccuracyRow>& rows, bool by_family, bool markdown) {
  Columns errors{{"errors, in u S", "cases", "refused%", "T p50", "p99", "p99.9", "max", "ulps p50",
                  "p99", "CP p99", "max", "n max"},
                 {}};
  Columns decisions{{"decisions, costs", "hits", "false/M", "misses", "false/M", "band%", "leaks",
                     "latency", "II", "ops", "cyc/M", "LUT", "MHz", "lanes", "ms/M"},
                    {}};
  for (const AccuracyRow& row : rows) {
    const std::string name = row.measured.pipe.name();
    const Tally all = row.measured.all();
    errors.lines.push_back(errors_line(name, all));
    decisions.lines.push_back(decisions_line(name, all, &row.cost));
    if (!by_family) continue;
    for (const auto& [family, tally] : row.measured.families) {
      if (tally.leak_rays == 0)
        errors.lines.push_back(errors_line(fmt::format("  {}", family), tally));
      decisions.lines.push_back(decisions_line(fmt::format("  {}", family), tally, nullptr));
    }
  }
  Columns worst{
      {"worst cases", "T, case", "in u S", "decision, case", "in u S", "leak, case", "in u S"}, {}};
  for (const AccuracyRow& row : rows) {
    if (!by_family) break;
    for (const auto& [family, t] : row.measured.families) {
      Columns::Cells line = {fmt::format("{} {}", row.measured.pipe.name(), family)};
      for (const auto* w : {&t.worst_t, &t.worst_decision, &t.worst_leak})
        line.insert(line.end(),
                    {*w ? fmt::to_string((*w)->index) : "-", *w ? compact((*w)->size) : "-"});
      worst.lines.push_back(line);
    }
  }
  Columns simulation{{"simulated pipes", "arith", "lanes", "answers", "as reference", "s/M tests"},
                     {}};
  for (const AccuracyRow& row : rows)
    for (const Simulated& s : row.simulated)
      simulation.lines.push_back({row.measured.pipe.name(), name_of(s.arithmetic),
                                  fmt::to_string(s.lanes), fmt::to_string(s.compared), "all",
                                  compact(s.seconds_per_million())});
  std::string text = errors.text(markdown);
  for (const Columns& more : {decisions, worst, simulation})
    if (!more.lines.empty()) text.append("\n").append(more.text(markdown));
  return text;
}

std::string promise_table(const std::vector<AccuracyRow>& rows) {
  Columns table{{"pipe", "promised", "kept", "cases", "refused", "T max, u S", "wrong F",
                 "in the band", "of them otherwise", "leaks"},
                {}};
  for (const AccuracyRow& row : rows) {
    const Tally t = row.measured.all();
    const Promise promise = promise_of(row.measured.pipe);
    table.lines.push_back({row.measured.pipe.name(), promise.text, promise_outcome(promise, t),
                           fmt::to_string(t.cases), fmt::to_string(t.refused),
                           quantile(t.t, 1, t.oracle),
                           fmt::to_string(t.false_hits + t.false_misses),
                           fmt::to_string(t.undecided), fmt::to_string(t.undecided_differ),
                           t.leak_rays == 0 ? "-" : fmt::format("{}/{}", t.leaks, t.leak_rays)});
  }
  return table.text(true);
}

std::string picture_table(const std::vector<PictureAccuracy>& rows, bool markdown) {
  Columns table{{"pixels", "rays", "hits", "wrong", "wrong/M", "hit", "miss", "other", "ties",
                 "by pipe", "depth p50", "p99", "max", "refused"},
                {}};
  for (const PictureAccuracy& row : rows) {
    const PixelCounts& c = row.of_scene;
    const auto depth = [&](double share) {
      return c.depth.count() == 0
                 ? std::string("-")
                 : compact(share == 1 ? c.depth.largest() : c.depth.quantile(share));
    };
    table.lines.push_back({row.pipe.name(), fmt::to_string(row.rays), fmt::to_string(row.hits),
                           fmt::to_string(c.wrong()), per_million(c.wrong(), row.rays),
                           fmt::to_string(c.false_hits), fmt::to_string(c.false_misses),
                           fmt::to_string(c.other), fmt::to_string(c.ties),
                           fmt::to_string(row.of_words.wrong()), depth(0.5), depth(0.99), depth(1),
                           fmt::to_string(row.refused)});
  }
  return table.text(markdown);
}

std::string scene_table(const std::vector<SceneAccuracy>& rows, double clock_hz, bool markdown) {
  Columns table{{"frame", "query", "format", "records", "hits", "wrong", "hit", "miss", "other",
                 "ties", "T p50", "p99", "max", "refused", "rows ms"},
                {}};
  for (const SceneAccuracy& row : rows) {
    const auto error = [&](double share) {
      if (row.t.count() == 0) return std::string("-");
      return compact(share == 1 ? row.t.largest() : row.t.quantile(share));
    };
    table.lines.push_back(
        {fmt::to_string(row.frame), row.query, row.format.name(), fmt::to_string(row.records),
         fmt::to_string(row.hits), fmt::to_string(row.wrong()), fmt::to_string(row.false_hits),
         fmt::to_string(row.false_misses), fmt::to_string(row.other), fmt::to_string(row.ties),
         error(0.5), error(0.99), error(1), fmt::to_string(row.refused),
         compact(1e3 * static_cast<double>(row.rows) / clock_hz)});
  }
  return table.text(markdown);
}

Json accuracy_json(const std::vector<AccuracyRow>& rows) {
  Json all = Json::array();
  for (const AccuracyRow& row : rows) {
    const AccuracyPipe& pipe = row.measured.pipe;
    const bool triangle = pipe.pair == Pair::kRayTriangle;
    Json json = {
        {"pair", name(pipe.pair)},
        {"format", pipe.format.name()},
        {"algorithm", triangle ? Json(name(pipe.algorithm)) : Json()},
        {"box", triangle ? Json(pipe.box) : Json()},
        {"iterations", has_iterations(pipe.pair)
                           ? Json(fmt::format("{},{},{}", pipe.iterations.samples,
                                              pipe.iterations.circle, pipe.iterations.free))
                           : Json()},
        {"variant", name(pipe.variant)}};
    json["cost"] = row.cost.to_json();
    json["all_families"] = tally_json(pipe, row.measured.all());
    json["families"] = Json::array();
    for (const auto& [family, tally] : row.measured.families) {
      Json part = {{"family", family}};
      part.update(tally_json(pipe, tally));
      json["families"].push_back(part);
    }
    json["simulated"] = Json::array();
    for (const Simulated& s : row.simulated) json["simulated"].push_back(s.to_json());
    all.push_back(json);
  }
  return all;
}

}  // namespace cde::cli
