// SPDX-License-Identifier: Apache-2.0
// The shared wires of a PCI bus: what each agent drives, and the resulting levels.
#pragma once
#include <cstdint>

#include "cde/contract/pci.hpp"

namespace pci {

/// Control signals as bits. The wires are low when asserted.
enum Signal : uint32_t {
  kFrame = 1u << 0,
  kReq64 = 1u << 1,
  kIrdy = 1u << 2,
  kTrdy = 1u << 3,
  kStop = 1u << 4,
  kDevsel = 1u << 5,
  kAck64 = 1u << 6,
  kPerr = 1u << 7,
  kPar = 1u << 8,  // high is 1, as for AD
  kPar64 = 1u << 9,
  kAd = 1u << 10,  // from here on only in Drive::enable
  kAd64 = 1u << 11,
  kCbe = 1u << 12,
};
constexpr uint32_t kTargetSignals = kTrdy | kStop | kDevsel | kAck64;
/// Sustained tri-state: driven high for one cycle before release.
constexpr uint32_t kSustained = kFrame | kReq64 | kIrdy | kTargetSignals | kPerr;
constexpr uint32_t kControls = kSustained | kPar | kPar64;

using namespace cde::pci;  // the commands
constexpr bool is_write(uint8_t command) {
  return (command & 1) != 0 && command != 0xD;
}

/// What one agent drives after a clock edge. Only signals in `enable` have levels.
struct Drive {
  uint64_t ad = ~0ull;
  uint32_t high = kControls;  // levels of the control signals
  uint32_t enable = 0;
  uint8_t cbe = 0xFF;
  bool request = false;  // REQ#
  bool serr = false;     // open drain
  bool inta = false;

  [[nodiscard]] bool drives(Signal s) const { return (enable & s) != 0; }
  void set(uint32_t signals, bool asserted) { high = asserted ? high & ~signals : high | signals; }
  bool operator==(const Drive&) const = default;
};

/// The wires, pulled up where no agent drives.
struct Wires {
  uint64_t ad = ~0ull;
  uint32_t high = kControls;
  uint8_t cbe = 0xFF;
  bool serr = false;
  bool inta = false;
  bool idsel = false;

  [[nodiscard]] bool asserted(Signal s) const { return (high & s) == 0; }
  [[nodiscard]] bool idle() const { return !asserted(kFrame) && !asserted(kIrdy); }
};

constexpr uint64_t kAdLow = 0xFFFFFFFFull;

inline Wires resolve(const Drive& a, const Drive& b) {
  const auto ad = [](const Drive& d) {
    return d.ad | (d.drives(kAd) ? 0 : kAdLow) | (d.drives(kAd64) ? 0 : ~kAdLow);
  };
  Wires w;
  w.ad = ad(a) & ad(b);
  w.high = (a.high | ~a.enable) & (b.high | ~b.enable) & kControls;
  w.cbe = static_cast<uint8_t>((a.drives(kCbe) ? a.cbe : 0xFF) & (b.drives(kCbe) ? b.cbe : 0xFF));
  w.serr = a.serr || b.serr;
  w.inta = a.inta || b.inta;
  return w;
}

/// Even parity of AD[31:0] and C/BE#[3:0], and of the upper halves.
inline bool parity(const Wires& w) {
  return __builtin_parityll((w.ad & kAdLow) | static_cast<uint64_t>(w.cbe & 0xF) << 32) != 0;
}
inline bool parity64(const Wires& w) {
  return __builtin_parityll(w.ad >> 32 | static_cast<uint64_t>(w.cbe >> 4) << 32) != 0;
}

}  // namespace pci
