// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "cde/fp/fp_format.hpp"
#include "cde/model/model.hpp"

/// @file
/// Reference devices of modelled times: docs/devices.json (docs/background/costs.md).
namespace cde {

enum class DeviceKind {
  kPlaced,     ///< the whole card was placed and routed
  kProjected,  ///< computed from parts that were placed and routed
  kIdeal,      ///< for comparison: no FPGA has such operators
};

/// A card on an FPGA. Modelled times assume its clock and its latencies.
struct Device {
  std::string name;
  DeviceKind kind = DeviceKind::kIdeal;
  std::string fpga;
  double clock_mhz = 100;
  FpFormat format = {};
  unsigned lanes = 1;
  unsigned traversal_units = 1;
  unsigned node_cycles = 1;  ///< BoardConfig::node_cycles
  unsigned node_cache = 0;   ///< 0: all nodes are on chip, as in BoardConfig
  unsigned node_ways = BoardConfig{}.node_ways;
  unsigned pinned_nodes = BoardConfig{}.pinned_nodes;
  unsigned contexts = BoardConfig{}.contexts;
  unsigned shared_lane = 0;  ///< BoardConfig::shared_lane, of cards that can share it
  unsigned ray_places = BoardConfig{}.ray_places;
  bool narrow_memory = false;  ///< DDR is a memory of 16 bits at the core's clock, not DDR-400
  OperatorLatencies latencies = {};
  std::string memory;  ///< where triangles and nodes are
  std::string why;     ///< evidence for the figures
  bool other_card =
      false;  ///< the figures are of a card that is not the one placed: see device_for()

  [[nodiscard]] double clock_hz() const { return 1e6 * clock_mhz; }
  /// Period of the core clock, for OpenOptions::clock_period_ps.
  [[nodiscard]] std::uint32_t clock_period_ps() const;
  /// Lanes of a card whose queries all traverse a BVH: two per traversal unit, if the device has so
  /// many. More would be idle.
  [[nodiscard]] unsigned leaf_lanes() const;
  /// "large (projected, 100 MHz)". If card, clock or latencies differ from the table, it says
  /// "large with another clock (projected, 50 MHz)".
  [[nodiscard]] std::string text() const;
  /// "9/11/34/32/3".
  [[nodiscard]] std::string latencies_text() const;
};

/// All rows of the table; the first is the default.
[[nodiscard]] std::span<const Device> devices();
[[nodiscard]] inline const Device& default_device() {
  return devices().front();
}
/// Error kUsage for an unknown name, with the known ones.
[[nodiscard]] const Device& device_named(std::string_view name);
/// "placed", "projected" or "ideal".
[[nodiscard]] const char* name_of(DeviceKind kind);

/// Gives the card traversal units of the device, and memory for so many nodes.
void add_traversal_units(const Device& device, unsigned nodes, BoardConfig& card);
/// The card with the latencies of the device and, if it has traversal units, their kind. A device
/// whose lane is shared gives its traversal unit to every card that can have it.
[[nodiscard]] BoardConfig on(const Device& device, BoardConfig card);
/// The device of this card's figures. If another card, clock or latencies were placed, it is
/// projected. Arithmetic, waves, and the sizes of DDR and of the record ring make no other card.
[[nodiscard]] Device device_for(Device device, const BoardConfig& card);

}  // namespace cde
