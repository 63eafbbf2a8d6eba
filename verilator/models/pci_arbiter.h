// SPDX-License-Identifier: Apache-2.0
// Arbiter of two masters, the host and the card. It alternates if both request the bus, and stays
// with the last master if neither does. On an idle bus it leaves one cycle between two grants.
#pragma once
#include <cstdint>

#include "pci_wires.h"

namespace pci {

class Arbiter {
 public:
  explicit Arbiter(uint32_t latency) : latency_(latency) {}

  [[nodiscard]] bool host() const { return grant_ == 0; }
  [[nodiscard]] bool card() const { return grant_ == 1; }
  /// Withholds the grant from the card.
  void withhold(bool on) { withheld_ = on; }

  void clock(const Wires& w, bool host_asks, bool card_asks) {
    const bool starts = w.asserted(kFrame) && !frame_;
    frame_ = w.asserted(kFrame);
    if (starts) served_ = owner_;
    int wanted = owner_;
    if (host_asks && card_asks)
      wanted = served_ == 0 ? 1 : 0;
    else if (host_asks)
      wanted = 0;
    else if (card_asks)
      wanted = 1;
    if (wanted == owner_) {
      age_ = 0;
    } else if (age_ < latency_) {
      ++age_;
    } else {
      // The last owner of an idle bus may be driving AD: one cycle without an owner releases it.
      grant_ = w.idle() && grant_ != -1 ? -1 : wanted;
      if (grant_ == wanted) {
        owner_ = wanted;
        age_ = 0;
      }
      return;
    }
    grant_ = withheld_ && owner_ == 1 ? -1 : owner_;
  }

 private:
  uint32_t latency_, age_ = 0;
  int owner_ = 0, grant_ = 0, served_ = 0;
  bool frame_ = false, withheld_ = false;
};

}  // namespace pci
