// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/filters.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>

#include "cde/accuracy/error_counts.hpp"
#include "cde/accuracy/tally.hpp"
#include "cde/oracle/oracle.hpp"
#include "cde/support/columns.hpp"
#include "cde/support/progress.hpp"

namespace cde::accuracy {
namespace {

using Json = nlohmann::ordered_json;
using reference::filter::Certain;

constexpr std::uint64_t kAtOnce = 4096;

/// Counts a case. The oracle's interval need only lie on one side of zero, so its tolerance is
/// wide.
void count(FilterCounts& counts, const oracle::Case& pair, Certain certain) {
  const oracle::Shape a = pair.shape_a(), b = pair.shape_b();
  const oracle::SignedDistance distance = oracle::signed_distance(a, b, {.tolerance = 1e-7});
  ++counts.cases;
  switch (certain) {
    case Certain::kMiss:
      ++counts.misses;
      counts.wrong += distance.hi < 0 ? 1 : 0;
      break;
    case Certain::kHit:
      ++counts.hits;
      counts.wrong += distance.lo > 0 ? 1 : 0;
      break;
    case Certain::kNeither:
      ++counts.uncertain;
      const double band = kBand * 0x1p-24 * oracle::scene_size(a, b);
      counts.near += distance.lo <= band && -distance.hi <= band ? 1 : 0;
  }
}

FilterCounts counted(const FilterRow& row, const oracle::Family& family, std::uint64_t seed,
                     std::uint64_t cases) {
  const AccuracyPipe wide{.pair = row.pair, .format = FpFormat::parse("fp32")};
  FilterCounts counts;
  std::vector<Certain> certain;
  for (std::uint64_t first = 0; first < cases; first += kAtOnce) {
    oracle::Family part = family;
    part.first += first * family.step;
    const DrawnCases drawn_cases = drawn(wide, part, seed, std::min(kAtOnce, cases - first));
    certain.assign(drawn_cases.cases.size(), Certain::kNeither);
    test_certain(row.pair, row.narrow, row.iterations, drawn_cases.a, drawn_cases.b, certain);
    for (std::size_t i = 0; i < certain.size(); ++i)
      count(counts, drawn_cases.cases[i], certain[i]);
  }
  return counts;
}

std::string percent(std::uint64_t part, std::uint64_t all) {
  return all == 0
             ? "-"
             : fmt::format("{:.3f}", 100 * static_cast<double>(part) / static_cast<double>(all));
}

std::string iterations_text(const FilterRow& row) {
  return has_iterations(row.pair) ? fmt::format(" {},{},{}", row.iterations.samples,
                                                row.iterations.circle, row.iterations.free)
                                  : "";
}

Json counts_json(const FilterCounts& c) {
  return {{"cases", c.cases},         {"certain_misses", c.misses},  {"certain_hits", c.hits},
          {"uncertain", c.uncertain}, {"uncertain_in_band", c.near}, {"wrong", c.wrong}};
}

}  // namespace

void FilterCounts::add(const FilterCounts& other) {
  cases += other.cases;
  misses += other.misses, hits += other.hits;
  uncertain += other.uncertain, near += other.near, wrong += other.wrong;
}

FilterCounts FilterRow::all() const {
  FilterCounts sum;
  for (const auto& [name, counts] : families) sum.add(counts);
  return sum;
}

void measure_filters(std::vector<FilterRow>& rows, const FilterOptions& options) {
  Progress progress("certified filters", options.quiet);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<oracle::Family> families;
    for (const oracle::Family& family : oracle::families(rows[i].pair))
      if (options.families.empty() ||
          std::ranges::find(options.families, family.name) != options.families.end())
        families.push_back(family);
    for (std::size_t k = 0; k < families.size(); ++k) {
      const auto part = static_cast<double>(k) / static_cast<double>(families.size());
      progress((static_cast<double>(i) + part) / static_cast<double>(rows.size()));
      const std::uint64_t cases =
          options.cases / families.size() + (k < options.cases % families.size() ? 1 : 0);
      rows[i].families.emplace_back(families[k].name,
                                    counted(rows[i], families[k], options.seed, cases));
    }
  }
}

std::string filter_table(const std::vector<FilterRow>& rows, bool by_family, bool markdown) {
  Columns table{
      {"filter", "cases", "miss%", "hit%", "uncertain%", "in the band%", "beyond it%", "wrong"},
      {}};
  const auto line = [&](const std::string& what, const FilterCounts& c) {
    table.lines.push_back({what, fmt::to_string(c.cases), percent(c.misses, c.cases),
                           percent(c.hits, c.cases), percent(c.uncertain, c.cases),
                           percent(c.near, c.cases), percent(c.uncertain - c.near, c.cases),
                           fmt::to_string(c.wrong)});
  };
  for (const FilterRow& row : rows) {
    const std::string pipe =
        fmt::format("{} {}{}", name(row.pair), row.narrow.name(), iterations_text(row));
    line(pipe, row.all());
    if (by_family)
      for (const auto& [family, counts] : row.families) line(pipe + " " + family, counts);
  }
  return table.text(markdown);
}

Json filter_json(const std::vector<FilterRow>& rows) {
  Json all = Json::array();
  for (const FilterRow& row : rows) {
    Json json = {{"pair", name(row.pair)}, {"narrow", row.narrow.name()}, {"wide", "fp32"}};
    json["iterations"] = has_iterations(row.pair) ? Json(iterations_text(row).substr(1)) : Json();
    json["all_families"] = counts_json(row.all());
    json["families"] = Json::array();
    for (const auto& [family, counts] : row.families) {
      Json part = {{"family", family}};
      part.update(counts_json(counts));
      json["families"].push_back(part);
    }
    all.push_back(json);
  }
  return all;
}

}  // namespace cde::accuracy
