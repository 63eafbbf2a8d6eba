// SPDX-License-Identifier: Apache-2.0
#include "cde/model/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

/// docs/devices.json, which CMake compiles in.
extern const char* const kDevicesJson;

namespace {

using Json = nlohmann::json;

constexpr std::pair<const char*, DeviceKind> kKinds[] = {{"placed", DeviceKind::kPlaced},
                                                         {"projected", DeviceKind::kProjected},
                                                         {"ideal", DeviceKind::kIdeal}};

DeviceKind kind_of(const std::string& word) {
  const auto* const kind = std::ranges::find(
      kKinds, word, [](const auto& known) { return std::string_view(known.first); });
  if (kind == std::end(kKinds))
    throw Error(ErrorCode::kFile, fmt::format("docs/devices.json: there is no kind {}", word));
  return kind->second;
}

Device device_of(const Json& row) {
  const Json& cycles = row.at("latencies");
  return {.name = row.at("name"),
          .kind = kind_of(row.at("kind")),
          .fpga = row.at("fpga"),
          .clock_mhz = row.at("clock_mhz"),
          .format = FpFormat::parse(row.at("format").get<std::string>()),
          .lanes = row.at("lanes"),
          .traversal_units = row.at("traversal_units"),
          .node_cycles = row.at("node_cycles"),
          .node_cache = row.value("node_cache", 0u),
          .node_ways = row.value("node_ways", BoardConfig{}.node_ways),
          .pinned_nodes = row.value("pinned_nodes", BoardConfig{}.pinned_nodes),
          .contexts = row.value("contexts", BoardConfig{}.contexts),
          .shared_lane = row.value("shared_lane", 0u),
          .ray_places = row.value("ray_places", BoardConfig{}.ray_places),
          .narrow_memory = row.value("narrow_memory", false),
          .latencies = {.add = cycles.at("add"),
                        .mul = cycles.at("mul"),
                        .div = cycles.at("div"),
                        .sqrt = cycles.at("sqrt"),
                        .compare = cycles.at("compare")},
          .memory = row.at("memory"),
          .why = row.at("why")};
}

std::vector<Device> read_devices() {
  const Json table = Json::parse(kDevicesJson);
  std::vector<Device> all;
  for (const Json& row : table.at("devices")) all.push_back(device_of(row));
  return all;
}

}  // namespace

const char* name_of(DeviceKind kind) {
  return std::ranges::find(kKinds, kind, [](const auto& known) { return known.second; })->first;
}

std::span<const Device> devices() {
  static const std::vector<Device> all = read_devices();
  return all;
}

const Device& device_named(std::string_view name) {
  const auto all = devices();
  const auto found = std::ranges::find(all, name, &Device::name);
  if (found != all.end()) return *found;
  std::string known;
  for (const Device& d : all) known += (known.empty() ? "" : ", ") + d.name;
  throw Error(ErrorCode::kUsage, fmt::format("there is no device {}; expected one of {}",
                                             in_quotes(std::string(name)), known));
}

std::uint32_t Device::clock_period_ps() const {
  return static_cast<std::uint32_t>(std::clamp(1e6 / clock_mhz, 1.0, 4e9));
}

unsigned Device::leaf_lanes() const {
  return std::min(2 * traversal_units, lanes);
}

std::string Device::latencies_text() const {
  return fmt::format("{}", fmt::join(cycles_of(latencies), "/"));
}

std::string Device::text() const {
  const Device& known = device_named(name);
  const bool clock = clock_mhz != known.clock_mhz, cycles = latencies != known.latencies;
  std::vector<const char*> others;
  if (other_card) others.push_back("card");
  if (clock) others.push_back("clock");
  if (cycles) others.push_back("latencies");
  std::string with = others.size() == 1 && cycles ? " with other "
                     : others.empty()             ? ""
                                                  : " with another ";
  for (std::size_t i = 0; i < others.size(); ++i)
    with += fmt::format("{}{}", i == 0 ? "" : i + 1 < others.size() ? ", " : " and ", others[i]);
  return fmt::format("{}{} ({}, {:g} MHz)", name, with, name_of(kind), clock_mhz);
}

namespace {

void set_node_memory(const Device& device, BoardConfig& card) {
  card.node_cycles = device.node_cycles;
  card.contexts = device.contexts;
  card.ray_places = device.ray_places;
  card.shared_lane = card.can_share_lane() ? device.shared_lane : 0;
  card.node_cache = device.node_cache;
  if (device.node_cache == 0) return;
  card.node_ways = device.node_ways;
  card.pinned_nodes = std::min(device.pinned_nodes, card.nodes);
}

}  // namespace

void add_traversal_units(const Device& device, unsigned nodes, BoardConfig& card) {
  card.traversal_units = device.traversal_units;
  card.nodes = nodes;
  set_node_memory(device, card);
}

BoardConfig on(const Device& device, BoardConfig card) {
  card.latency = device.latencies;
  if (device.shared_lane != 0 && card.can_share_lane() && card.box && card.format == FpFormat())
    card.traversal_units = device.traversal_units;
  if (card.traversal_units != 0) set_node_memory(device, card);
  return card;
}

Device device_for(Device device, const BoardConfig& card) {
  if (device.kind != DeviceKind::kPlaced) return device;
  BoardConfig placed = on(device, {.lanes = device.lanes, .box = true});
  placed.arithmetic = card.arithmetic;
  placed.nodes = card.nodes;
  placed.pinned_nodes = std::min(device.pinned_nodes, card.nodes);
  placed.ddr_slots = card.ddr_slots;
  placed.sram_records = card.sram_records;
  placed.trace = card.trace;
  const Device& known = device_named(device.name);
  device.other_card = card.parameters() != placed.parameters();
  if (device.other_card || device.clock_mhz != known.clock_mhz ||
      device.latencies != known.latencies)
    device.kind = DeviceKind::kProjected;
  return device;
}

}  // namespace cde
