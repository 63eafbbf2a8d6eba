// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cde {

/// What a host adds to the card's own cycles on the PCI bus. All values are PCI cycles. A latency
/// is counted from the address phase to the first data phase. The card itself takes about 9 cycles
/// more per burst (docs/reference/pci.md).
struct HostProfile {
  std::string_view name;
  std::uint32_t arbitration;    ///< from REQ# to GNT# if another master had the bus
  std::uint32_t read_latency;   ///< of host memory read by the card
  std::uint32_t write_latency;  ///< of host memory written by the card
  std::string_view source;
};

inline constexpr std::array<HostProfile, 3> kHostProfiles = {{
    {"ideal", 0, 3, 2, "the least that PCI allows with medium DEVSEL#"},
    {"good", 2, 16, 3,
     "assumed: 24 cycles per read burst and 12 per write burst, the card's own included"},
    {"p64-2001", 2, 77, 35,
     "fitted to published measurements of Myrinet cards in 64-bit, 66 MHz hosts of 2001: 147 MB/s "
     "with "
     "256-byte read bursts, 315 MB/s with 512-byte write bursts"},
}};

[[nodiscard]] constexpr std::optional<HostProfile> host_profile(std::string_view name) {
  for (const HostProfile& p : kHostProfiles)
    if (p.name == name) return p;
  return std::nullopt;
}

}  // namespace cde
