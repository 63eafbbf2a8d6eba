// SPDX-License-Identifier: Apache-2.0
#include "cde/costs/cost_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "cde/card/board.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/input_file.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"

namespace cde {
namespace {

using Json = nlohmann::ordered_json;

/// A device, as in tools/costs/targets.py.
struct TargetDevice {
  const char* name;
  double logic, ff, dsp, ram;
  bool ecp5;  ///< a carry cell takes two LUT places, and a LUT used as RAM takes six
};
constexpr std::array kDevices = {TargetDevice{"ecp5-85", 83640, 83640, 156, 208, true},
                                 TargetDevice{"hx8k", 7680, 7680, 0, 32, false}};
constexpr double kRoutable = 0.85;
constexpr std::string_view kAssumed = "assumed:";
constexpr double kMostCells = 1e9;
constexpr const char* kCells = "a whole number, 0 to 1e9";
constexpr unsigned kMostLatency = 999;

[[noreturn]] void wrong_field(const char* key, const Json& row, const char* must_be) {
  const auto at = row.find(key);
  throw Error(ErrorCode::kFile, fmt::format("{} is {}; it must be {}", key,
                                            at == row.end() ? "not there" : at->dump(), must_be));
}

std::string word(const Json& row, const char* key) {
  const auto at = row.find(key);
  if (at == row.end() || !at->is_string()) wrong_field(key, row, "a word");
  return *at;
}

double cells(const Json& row, const char* key) {
  const auto at = row.find(key);
  if (at == row.end() || !at->is_number()) wrong_field(key, row, kCells);
  const double count = *at;
  if (!(count >= 0 && count <= kMostCells && count == std::floor(count)))
    wrong_field(key, row, kCells);
  return count;
}

/// Latency of an operator, or of the five kinds of operators, separated by slashes.
std::string latencies(const Json& row) {
  const std::string text = word(row, "lat");
  const char *at = text.data(), *const end = at + text.size();
  while (true) {
    unsigned cycles = 0;
    const auto [stop, error] = std::from_chars(at, end, cycles);
    if (error != std::errc() || cycles < 1 || cycles > kMostLatency)
      wrong_field("lat", row, "cycles per kind of operator, 1 to 999 each, with / between them");
    if (stop == end) return text;
    if (*stop != '/') wrong_field("lat", row, "cycles with / between them");
    at = stop + 1;
  }
}

/// The median of a row's clock rates, one per seed.
std::optional<double> median_mhz(const Json& row) {
  constexpr const char* kMustBe = "clock rates in MHz, more than 0 and at most 10000, one per seed";
  const auto all = row.find("fmax");
  if (all == row.end() || !all->is_object()) wrong_field("fmax", row, kMustBe);
  std::vector<double> rates;
  for (const Json& rate : *all) {
    if (!rate.is_number() || !(rate.get<double>() > 0 && rate.get<double>() <= kMostClockMhz))
      wrong_field("fmax", row, kMustBe);
    rates.push_back(rate);
  }
  if (rates.empty()) return std::nullopt;
  std::sort(rates.begin(), rates.end());
  return rates[(rates.size() - 1) / 2];
}

CostRow row_of(const Json& json) {
  CostRow row;
  for (const auto& [key, text] : {std::pair{"what", &row.what},
                                  {"algorithm", &row.algorithm},
                                  {"format", &row.format},
                                  {"target", &row.target}})
    *text = word(json, key);
  row.lat = latencies(json);
  CellCounts& c = row.cells;
  for (const auto& [key, count] : {std::pair{"lut", &c.lut},
                                   {"carry", &c.carry},
                                   {"ff", &c.ff},
                                   {"dsp", &c.dsp},
                                   {"ram", &c.ram},
                                   {"lutram", &c.lutram}})
    *count = cells(json, key);
  if (c.lut + c.carry + c.ff + c.dsp + c.ram + c.lutram == 0)
    wrong_field("lut", json, "more than 0, as no other cells are there");
  row.mhz = median_mhz(json);
  return row;
}

}  // namespace

void CellCounts::add(const CellCounts& other, double times) {
  lut += times * other.lut, carry += times * other.carry, ff += times * other.ff;
  dsp += times * other.dsp, ram += times * other.ram, lutram += times * other.lutram;
}

Target parse_target(const std::string& text) {
  for (const TargetDevice& d : kDevices)
    if (text == d.name) return {text, std::nullopt};
  double mhz = 0;
  if (text.starts_with(kAssumed) && text.ends_with("MHz")) {
    const char *from = text.data() + kAssumed.size(), *to = text.data() + text.size() - 3;
    const auto [stop, error] = std::from_chars(from, to, mhz);
    if (error == std::errc() && stop == to && mhz >= kLeastClockMhz && mhz <= kMostClockMhz)
      return {text, mhz};
  }
  throw Error(ErrorCode::kUsage,
              fmt::format("--target is {}; it must be ecp5-85, hx8k or assumed:NUMBERMHz, {:g} to "
                          "{:g}, e.g. assumed:100MHz",
                          in_quotes(text), kLeastClockMhz, kMostClockMhz));
}

LanesThatFit lanes_that_fit(const CellCounts& lane, const std::string& target) {
  const auto* device = std::ranges::find(kDevices, target, &TargetDevice::name);
  if (device == kDevices.end()) return {};
  const double logic = lane.lut + (device->ecp5 ? 2 * lane.carry + 6 * lane.lutram : 0);
  struct Resource {
    const char* what;
    double has, used;
  };
  LanesThatFit fit;
  double least = std::numeric_limits<double>::infinity();
  for (const Resource& resource : {Resource{"logic", kRoutable * device->logic, logic},
                                   {"ff", kRoutable * device->ff, lane.ff},
                                   {"dsp", device->dsp, lane.dsp},
                                   {"ram", device->ram, lane.ram}}) {
    if (resource.used <= 0 || resource.has / resource.used >= least) continue;
    if (resource.has <= 0) return {0, resource.what, std::numeric_limits<double>::infinity()};
    least = resource.has / resource.used;
    fit = {static_cast<unsigned>(least), resource.what, 1 / least};
  }
  return fit;
}

CostTable CostTable::of_project() {
  CostTable table;
  const char* const named = std::getenv("CDE_COSTS");
  const bool given = named != nullptr && *named != '\0';
  table.file_ =
      given ? std::string(named)
            : (model_builder().parent_path().parent_path() / "docs" / "costs.json").string();
  if (!given && !std::filesystem::exists(table.file_)) return table;
  const Json all = parse_json(read_file(table.file_));
  const auto rows = all.is_object() ? all.find("rows") : all.end();
  if (!all.is_object() || rows == all.end() || !rows->is_array())
    throw Error(ErrorCode::kFile,
                fmt::format("{}: not a cost table: no list \"rows\" (tools/synthesis makes one)",
                            table.file_));
  for (std::size_t i = 0; i < rows->size(); ++i) {
    try {
      const Json& row = (*rows)[i];
      if (!row.is_object()) throw Error(ErrorCode::kFile, "not an object");
      // Costs are for one lane in the project's own style.
      if (cells(row, "lanes") < 1) wrong_field("lanes", row, "1 or more");
      if (word(row, "style") == "cde" && cells(row, "lanes") == 1)
        table.rows_.push_back(row_of(row));
    } catch (const Error& e) {
      throw Error(ErrorCode::kFile, fmt::format("{}: row {}: {}", table.file_, i + 1, e.what()));
    }
  }
  return table;
}

const CostRow* CostTable::fastest(std::string_view what, std::string_view algorithm,
                                  const std::string& format, const std::string& target) const {
  const CostRow* best = nullptr;
  for (const CostRow& row : rows_) {
    if (row.what != what || row.algorithm != algorithm || row.format != format ||
        row.target != target || !row.mhz)
      continue;
    if (best == nullptr || *row.mhz > *best->mhz ||
        (*row.mhz == *best->mhz && row.cells.lut < best->cells.lut))
      best = &row;
  }
  return best;
}

LaneCostOr CostTable::estimate(const CostedPipe& pipe, const std::string& target) const {
  if (!pipe.operators) return {{}, "its operators were not counted"};
  const OperatorCounts& n = *pipe.operators;
  struct Kind {
    const char* what;
    unsigned count;
  };
  LaneCost cost{.estimated = true, .mhz = std::numeric_limits<double>::infinity()};
  for (const Kind& kind :
       {Kind{"add", n.add}, {"mul", n.mul}, {"div", n.div}, {"sqrt", n.sqrt}, {"lt", n.cmp}}) {
    if (kind.count == 0) continue;
    const CostRow* row = fastest(kind.what, "", pipe.format.name(), target);
    if (row == nullptr)
      return {{}, fmt::format("no row of {} {} on {}", kind.what, pipe.format.name(), target)};
    cost.cells.add(row->cells, kind.count);
    cost.mhz = std::min(cost.mhz, *row->mhz);
    unsigned of_row = 1;
    std::from_chars(row->lat.data(), row->lat.data() + row->lat.size(), of_row);
    cost.longest = std::max(cost.longest, of_row);
    cost.of +=
        fmt::format("{}{} {} LAT {}", cost.of.empty() ? "" : ", ", kind.count, kind.what, row->lat);
  }
  if (cost.of.empty()) return {{}, "it has no operators"};
  cost.fit = lanes_that_fit(cost.cells, target);
  return {cost, ""};
}

LaneCostOr CostTable::lane(const CostedPipe& pipe, const std::string& target) const {
  const bool triangle = pipe.pair == Pair::kRayTriangle;
  // Lanes are measured without the box rule.
  const CostRow* row = triangle && pipe.box
                           ? nullptr
                           : fastest(name(pipe.pair), triangle ? name(pipe.algorithm) : "",
                                     pipe.format.name(), target);
  if (row == nullptr) return estimate(pipe, target);
  LaneCost cost{.cells = row->cells, .mhz = *row->mhz};
  cost.fit = lanes_that_fit(row->cells, target);
  cost.of = fmt::format("the whole lane, LAT {}", row->lat);
  unsigned cycles_of_one = 0;
  for (const char *at = row->lat.data(), *const end = at + row->lat.size(); at < end; ++at) {
    at = std::from_chars(at, end, cycles_of_one).ptr;
    cost.longest = std::max(cost.longest, cycles_of_one);
  }
  return {cost, ""};
}

}  // namespace cde
