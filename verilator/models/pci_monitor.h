// SPDX-License-Identifier: Apache-2.0
// Protocol checker of a PCI bus with two agents. Once per cycle it checks the wires and their
// drivers, and it keeps the first violated rule. The rules are from PCI Local Bus 2.3, sections 2.1
// (signal types), 3.3 (transactions and their termination), 3.4 (arbitration), 3.7 (parity) and 3.8
// (64 bits).
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>

#include "pci_wires.h"

namespace pci {

class Monitor {
 public:
  /// Checks one clock edge: what the agents drive, the wires, and the grants at the edge.
  /// `excused`: the parity at this edge is wrong on purpose.
  void clock(const Drive& a, const Drive& b, const Wires& w, bool grant_a, bool grant_b,
             bool excused) {
    const Drive* const drives[2] = {&a, &b};
    check_drivers(drives);
    check_transaction(drives, w);
    check_parity(w, excused);
    for (int i = 0; i < 2; ++i) last_drive_[i] = *drives[i];
    last_ = w;
    last_grant_[0] = grant_a;
    last_grant_[1] = grant_b;
    ++clock_;
  }

  /// Counts one cycle in which nothing changed and no check ran.
  void idle_clock() { ++clock_; }

  [[nodiscard]] const std::string& violation() const { return violation_; }
  /// Resets the bus state. The clock count and a violation stay.
  void reset() {
    Monitor fresh;
    fresh.clock_ = clock_;
    fresh.violation_ = violation_;
    *this = fresh;
  }

 private:
  static const char* name(uint32_t s) {
    switch (s) {
      case kFrame:
        return "FRAME#";
      case kReq64:
        return "REQ64#";
      case kIrdy:
        return "IRDY#";
      case kTrdy:
        return "TRDY#";
      case kStop:
        return "STOP#";
      case kDevsel:
        return "DEVSEL#";
      case kAck64:
        return "ACK64#";
      case kPerr:
        return "PERR#";
      case kPar:
        return "PAR";
      case kPar64:
        return "PAR64";
      case kAd:
        return "AD[31:0]";
      case kAd64:
        return "AD[63:32]";
      default:
        return "C/BE#";
    }
  }
  void require(bool holds, const char* rule, uint32_t signal = 0) {
    if (holds || !violation_.empty()) return;
    char text[200];
    std::snprintf(text, sizeof text, "PCI clock %llu: %s%s%s",
                  static_cast<unsigned long long>(clock_), signal != 0 ? name(signal) : "",
                  signal != 0 ? " " : "", rule);
    violation_ = text;
  }

  /// 2.1, 3.3.1 note on turnaround cycles: no contention, a cycle between drivers, high before
  /// release.
  void check_drivers(const Drive* const drives[2]) {
    for (uint32_t s = kFrame; s <= kCbe; s <<= 1) {
      const bool now[2] = {drives[0]->drives(Signal(s)), drives[1]->drives(Signal(s))};
      require(!(now[0] && now[1]), "driven by two agents", s);
      for (int i = 0; i < 2; ++i) {
        const bool before = (last_drive_[i].enable & s) != 0;
        require(!(before && !now[i] && now[1 - i]), "changes its driver without a turnaround clock",
                s);
        if ((s & kSustained) != 0)
          require(!(before && !now[i] && (last_drive_[i].high & s) == 0),
                  "left alone without having been driven high", s);
      }
    }
  }

  void check_transaction(const Drive* const drives[2], const Wires& w) {
    const bool frame = w.asserted(kFrame), irdy = w.asserted(kIrdy);
    const bool was_frame = last_.asserted(kFrame), was_irdy = last_.asserted(kIrdy);
    if (frame && !was_frame) {
      require(!was_irdy, "asserted while IRDY# was: no idle clock before the address phase",
              kFrame);
      for (int i = 0; i < 2; ++i)
        if (drives[i]->drives(kFrame)) {
          require(last_grant_[i], "asserted by a master without GNT#", kFrame);
          master_ = i;
        }
      require(drives[master_]->drives(kAd) && drives[master_]->drives(kCbe), "without an address",
              kFrame);
      in_ = true;
      address_ = true;
      seen_devsel_ = false;
      wide_asked_ = w.asserted(kReq64);
      command_ = w.cbe & 0xF;
      age_ = 0;
      check_idle_target(w);
      return;
    }
    if (!in_) {
      require(!w.asserted(kReq64), "asserted outside a transaction", kReq64);
      require(!irdy, "asserted outside a transaction", kIrdy);
      check_idle_target(w);
      return;
    }
    ++age_;
    require(w.asserted(kReq64) == (wide_asked_ && frame), "does not follow FRAME#", kReq64);
    check_master(drives, w, frame, irdy, was_frame, was_irdy);
    check_target(drives, w);
    address_ = false;
    seen_devsel_ = seen_devsel_ || w.asserted(kDevsel);
    if (!frame && !irdy) in_ = false;
  }

  void check_idle_target(const Wires& w) {
    for (const Signal s : {kTrdy, kStop, kDevsel, kAck64})
      require(!w.asserted(s), "asserted outside a transaction", s);
  }

  void check_master(const Drive* const drives[2], const Wires& w, bool frame, bool irdy,
                    bool was_frame, bool was_irdy) {
    const bool was_trdy = last_.asserted(kTrdy), was_stop = last_.asserted(kStop);
    const bool no_answer = !seen_devsel_ && age_ > 4;
    if (was_frame && !frame) require(irdy, "deasserted without IRDY#", kFrame);
    if (!was_frame && frame) require(false, "asserted again in a transaction", kFrame);
    if (was_irdy && !was_trdy && !was_stop) {
      require(irdy || (no_answer && !was_frame), "withdrawn before the data phase was complete",
              kIrdy);
      require(frame == was_frame || no_answer, "changed while a data phase waited", kFrame);
      require(last_.cbe == w.cbe || no_answer, "changed while a data phase waited", kCbe);
      if (is_write(command_) && !no_answer)
        require(((last_.ad ^ w.ad) & kAdLow) == 0, "changed while a data phase waited", kAd);
    }
    if (was_irdy && was_stop && was_frame) require(!frame && irdy, "kept after STOP#", kFrame);
    if (was_irdy && !was_frame && (was_trdy || was_stop))
      require(!irdy, "kept after the last data phase", kIrdy);
    if (age_ > 6)
      require(seen_devsel_ || w.asserted(kDevsel) || !frame, "kept though nobody answers", kFrame);
    if (!is_write(command_)) {
      require(!drives[master_]->drives(kAd), "driven by the master in the data phases of a read",
              kAd);
      require(!drives[master_]->drives(kAd64), "driven by the master in the data phases of a read",
              kAd64);
    } else if (irdy) {
      require(drives[master_]->drives(kAd), "not driven in a data phase of a write", kAd);
    }
    if (frame || irdy) require(drives[master_]->drives(kCbe), "not driven in a data phase", kCbe);
  }

  void check_target(const Drive* const drives[2], const Wires& w) {
    const bool frame = w.asserted(kFrame), trdy = w.asserted(kTrdy), stop = w.asserted(kStop);
    const bool devsel = w.asserted(kDevsel);
    const bool was_frame = last_.asserted(kFrame), was_irdy = last_.asserted(kIrdy);
    const bool was_trdy = last_.asserted(kTrdy), was_stop = last_.asserted(kStop);
    const bool was_devsel = last_.asserted(kDevsel);
    const bool waited = !(was_irdy && (was_trdy || was_stop));  // a data phase continues
    const bool over = !was_frame && was_irdy && (was_trdy || was_stop);
    if (over) {
      check_idle_target(w);
      return;
    }
    if (address_ && !is_write(command_))
      require(!trdy, "asserted in the turnaround clock of a read", kTrdy);
    require(devsel || !trdy, "asserted without DEVSEL#", kTrdy);
    require(devsel || !stop || seen_devsel_, "asserted before DEVSEL#", kStop);
    if (was_devsel && !devsel) require(stop && !trdy, "withdrawn", kDevsel);
    if (!was_devsel && devsel) require(!seen_devsel_, "asserted again", kDevsel);
    if (waited && (was_trdy || was_stop)) {
      require(trdy == was_trdy, "changed before the data phase was complete", kTrdy);
      require(stop == was_stop, "changed before the data phase was complete", kStop);
      require(devsel == was_devsel, "changed before the data phase was complete", kDevsel);
    }
    if (was_stop && (was_frame || frame)) require(stop, "withdrawn before FRAME#", kStop);
    if (was_stop && was_trdy && was_irdy) require(!trdy, "asserted after a disconnect", kTrdy);
    const bool wide = w.asserted(kAck64);
    require(!wide || (wide_asked_ && devsel), "asserted without REQ64# or DEVSEL#", kAck64);
    if (was_devsel && devsel)
      require(wide == last_.asserted(kAck64), "changed in a transaction", kAck64);
    if (trdy && !is_write(command_)) {
      require(drives[1 - master_]->drives(kAd), "not driven in a data phase of a read", kAd);
      if (wide)
        require(drives[1 - master_]->drives(kAd64), "not driven in a data phase of a read", kAd64);
    }
    if (was_trdy && trdy && waited && !is_write(command_))
      require(((last_.ad ^ w.ad) & kAdLow) == 0, "changed while a data phase waited", kAd);
  }

  /// 3.7.1: PAR follows the address phase by one cycle. It follows data with IRDY# of a write, and
  /// with TRDY# of a read.
  void check_parity(const Wires& w, bool excused) {
    if (par_due_ && !excused) require(w.asserted(kPar) != par_, "is wrong", kPar);
    if (par64_due_ && !excused) require(w.asserted(kPar64) != par64_, "is wrong", kPar64);
    const bool address = in_ && address_now(w);
    const bool data =
        in_ && !address && (is_write(command_) ? w.asserted(kIrdy) : w.asserted(kTrdy));
    par_due_ = address || data;
    par64_due_ = address ? w.asserted(kReq64) : data && w.asserted(kAck64);
    par_ = parity(w);
    par64_ = parity64(w);
  }
  [[nodiscard]] bool address_now(const Wires& w) const {
    return w.asserted(kFrame) && !last_.asserted(kFrame);
  }

  uint64_t clock_ = 0;
  std::string violation_;
  Drive last_drive_[2];
  Wires last_;
  bool last_grant_[2] = {true, true};
  int master_ = 0;
  bool in_ = false, address_ = false, seen_devsel_ = false;
  bool wide_asked_ = false, par_due_ = false, par64_due_ = false, par_ = false, par64_ = false;
  uint8_t command_ = 0;
  uint32_t age_ = 0;
};

}  // namespace pci
