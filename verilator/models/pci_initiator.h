// SPDX-License-Identifier: Apache-2.0
// The host bridge as a bus master: one transaction of the CPU at a time. clock() receives the wires
// before the edge and sets what is driven after it.
#pragma once
#include <cstdint>

#include "cde/abi/abi_pci.h"
#include "pci_wires.h"

namespace pci {

class Initiator {
 public:
  Drive drive;

  /// Starts; `t` stays in use until done().
  void start(cde_pci_transaction& t) {
    t_ = &t;
    t.done = t.stopped = t.took_wide = t.devsel = 0;
    state_ = State::kRequest;
    result_ = CDE_PCI_OK;
    drive.request = true;
  }
  /// Releases the caller's transaction; the bus continues with a copy.
  void abandon() {
    abandoned_ = *t_;
    t_ = &abandoned_;
  }
  [[nodiscard]] bool busy() const { return state_ != State::kIdle; }
  [[nodiscard]] bool addressing() const { return state_ == State::kAddress; }
  [[nodiscard]] int result() const { return result_; }
  [[nodiscard]] bool own() const { return drive.drives(kFrame) || drive.drives(kIrdy); }
  [[nodiscard]] bool idsel() const {
    return state_ == State::kAddress && (t_->command == kConfigRead || t_->command == kConfigWrite);
  }

  /// Returns whether PAR of this cycle's AD must be wrong.
  bool clock(const Wires& w, bool granted) {
    bool spoil = false;
    check_parity(w);
    switch (state_) {
      case State::kIdle:
        park(w, granted);
        break;
      case State::kRequest:
        park(w, granted);
        if (granted && w.idle() && !own()) address();
        break;
      case State::kAddress:
        spoil = t_->bad_address_parity != 0;
        first_data();
        break;
      case State::kData:
        spoil =
            is_write(command()) && t_->bad_data_parity != 0 && phase_ + 1 == t_->bad_data_parity;
        data(w);
        break;
      case State::kTurn:
        drive.enable &= ~uint32_t{kIrdy};
        if (++settle_ == 3) state_ = State::kIdle;
        break;
    }
    return spoil;
  }

 private:
  enum class State { kIdle, kRequest, kAddress, kData, kTurn };

  [[nodiscard]] uint8_t command() const { return static_cast<uint8_t>(t_->command); }

  void park(const Wires& w, bool granted) {
    if (granted && w.idle() && !own())
      drive.enable |= kAd | kCbe;
    else
      drive.enable &= ~uint32_t{kAd | kCbe};
  }

  void address() {
    drive.request = false;
    drive.ad = t_->address | ~kAdLow;
    drive.cbe = static_cast<uint8_t>(0xF0 | t_->command);
    drive.enable |= kFrame | kReq64 | kAd | kCbe | (t_->wide != 0 ? kAd64 : 0);
    drive.set(kFrame, true);
    drive.set(kReq64, t_->wide != 0);
    state_ = State::kAddress;
    age_ = phase_ = 0;
    seen_ = wide_ = moved_ = aborted_ = false;
    wait_ = t_->waits;
    check_[0] = check_[1] = false;
  }

  void first_data() {
    drive.enable |= kIrdy;
    drive.set(kIrdy, false);
    if (!is_write(command())) drive.enable &= ~uint32_t{kAd | kAd64};
    present();
    state_ = State::kData;
    if (wait_ > 0)
      --wait_;
    else
      ready();
  }

  /// Drives data and byte enables of the next phase.
  void present() {
    const uint32_t at = t_->done;
    const bool upper = t_->wide != 0 && (!seen_ || wide_) && at + 1 < t_->dwords;
    drive.ad = t_->data[at] | (upper ? uint64_t{t_->data[at + 1]} << 32 : ~kAdLow);
    drive.cbe = static_cast<uint8_t>(~(t_->enable[at] | (upper ? t_->enable[at + 1] << 4 : 0)));
  }

  /// Asserts IRDY#, unless the bus width decides whether this is the last phase and is not known
  /// yet.
  void ready() {
    const uint32_t left = t_->dwords - t_->done;
    if (t_->wide != 0 && left == 2 && !seen_) return;
    drive.set(kIrdy, true);
    if (left <= (wide_ || (t_->wide != 0 && !seen_) ? 2u : 1u)) frame_off();
  }
  void frame_off() { drive.set(kFrame | kReq64, false); }

  void data(const Wires& w) {
    const bool devsel = w.asserted(kDevsel), stop = w.asserted(kStop);
    const bool irdy = w.asserted(kIrdy), frame = w.asserted(kFrame);
    ++age_;
    if (devsel && !seen_) {
      seen_ = true;
      wide_ = t_->wide != 0 && w.asserted(kAck64);
      t_->devsel = age_;
      t_->took_wide = wide_;
    }
    const bool no_answer = !seen_ && age_ >= 5;
    const bool transfer = irdy && devsel && w.asserted(kTrdy);
    if (transfer) take(w);
    if (irdy && !frame && (transfer || stop || aborted_)) {
      if (stop && !devsel && !transfer) result_ = CDE_PCI_TARGET_ABORT;
      if (aborted_) result_ = CDE_PCI_MASTER_ABORT;
      t_->stopped = stop;
      drive.set(kIrdy, false);
      drive.enable &= ~uint32_t{kFrame | kReq64 | kAd | kAd64 | kCbe};
      state_ = State::kTurn;
      settle_ = 0;
    } else if (stop || no_answer) {
      if (transfer && t_->done < t_->dwords) present();
      drive.set(kIrdy, true);
      frame_off();
      aborted_ = no_answer;
    } else if (transfer) {
      present();
      drive.set(kIrdy, false);
      wait_ = t_->waits;
      if (wait_ > 0)
        --wait_;
      else
        ready();
    } else if (!irdy) {
      if (wait_ > 0)
        --wait_;
      else
        ready();
    }
  }

  void take(const Wires& w) {
    const uint32_t at = t_->done;
    if (!is_write(command())) {
      t_->data[at] = static_cast<uint32_t>(w.ad);
      if (wide_) t_->data[at + 1] = static_cast<uint32_t>(w.ad >> 32);
    }
    t_->done += wide_ ? 2 : 1;
    ++phase_;
    moved_ = true;
    check_[0] = true;
    expected_ = parity(w);
    expected64_ = parity64(w);
  }

  /// Drives PAR one cycle after the data; PERR# from the card comes another cycle later.
  void check_parity(const Wires& w) {
    const bool read = t_ != nullptr && !is_write(command());
    const bool bad =
        (w.asserted(kPar) == expected_) || (wide_ && w.asserted(kPar64) == expected64_);
    const bool perr = check_[0] && read && bad;
    if (perr || (check_[1] && !read && w.asserted(kPerr))) result_ = CDE_PCI_PARITY;
    check_[1] = check_[0];
    check_[0] = false;
    if (!perr && !w.asserted(kPerr)) drive.enable &= ~uint32_t{kPerr};
    drive.set(kPerr, perr);
    if (perr) drive.enable |= kPerr;
  }

  cde_pci_transaction* t_ = nullptr;
  cde_pci_transaction abandoned_{};
  State state_ = State::kIdle;
  int result_ = CDE_PCI_OK;
  uint32_t age_ = 0, wait_ = 0, phase_ = 0, settle_ = 0;
  bool seen_ = false, wide_ = false, moved_ = false, aborted_ = false;
  bool check_[2] = {false, false}, expected_ = false, expected64_ = false;
};

}  // namespace pci
