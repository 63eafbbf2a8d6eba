// SPDX-License-Identifier: Apache-2.0
// The host: bridge (initiator and target), arbiter, memory, and parity of what it drives.
#pragma once
#include "pci_arbiter.h"
#include "pci_host_target.h"
#include "pci_initiator.h"

namespace pci {

class Host {
 public:
  explicit Host(const cde_pci_options& options)
      : options_(options),
        memory_(options.memory_bytes, options.seed),
        target_(options_, memory_, faults_),
        arbiter_(options.profile.arbitration) {}

  [[nodiscard]] const Drive& drive() const { return drive_; }
  [[nodiscard]] bool idsel() const { return initiator_.idsel() && !unheard_; }
  /// Bits of AD that the card receives inverted. In an address phase that the card must ignore
  /// these are two bits, so the address is not the card's and parity stays right.
  [[nodiscard]] uint64_t misheard() const { return unheard_ ? 0xC0000000 : 0; }
  [[nodiscard]] bool grant() const { return arbiter_.host(); }
  [[nodiscard]] bool grant_card() const { return arbiter_.card(); }
  /// Whether the current PAR is wrong on purpose.
  [[nodiscard]] bool spoilt() const { return spoilt_; }
  HostMemory& memory() { return memory_; }
  Faults& faults() { return faults_; }
  [[nodiscard]] const Faults& faults() const { return faults_; }
  Initiator& initiator() { return initiator_; }
  [[nodiscard]] const HostTarget& target() const { return target_; }

  /// Whether a clock edge changes nothing while the card's outputs stay the same.
  [[nodiscard]] bool idle() const { return settled_ && !initiator_.busy() && !target_.busy(); }

  void clock(const Wires& w, bool card_requests) {
    const Drive before = drive_;
    const bool host_granted = arbiter_.host();
    const bool own = initiator_.own();
    // Takes effect as soon as it is requested: the bus may be parked at the card.
    const bool denied = faults_.waits(CDE_PCI_FAULT_NO_GRANT);
    if (denied && card_requests) faults_.take(CDE_PCI_FAULT_NO_GRANT);
    withdraw(w, own, denied);
    arbiter_.clock(w, initiator_.drive.request, card_requests && !denied);
    const bool spoilt_address = initiator_.clock(w, host_granted);
    unheard_ = initiator_.addressing() && faults_.take(CDE_PCI_FAULT_NO_ANSWER);
    const bool spoil = target_.clock(w, own) || spoilt_address;
    const Drive &i = initiator_.drive, &t = target_.drive;
    drive_.enable = i.enable | t.enable;
    drive_.ad = t.drives(kAd) ? t.ad : i.ad;
    drive_.cbe = i.cbe;
    drive_.high = (i.high | ~i.enable) & (t.high | ~t.enable) & kControls;
    drive_.request = i.request;
    // PAR follows AD by one cycle.
    drive_.high &= ~uint32_t{kPar | kPar64};
    if (before.drives(kAd)) drive_.enable |= kPar;
    if (before.drives(kAd64)) drive_.enable |= kPar64;
    if (parity(w) != spoil) drive_.high |= kPar;
    if (parity64(w)) drive_.high |= kPar64;
    spoilt_ = spoil;
    settled_ = drive_ == before && w.idle() && !card_requests && arbiter_.host() == host_granted;
  }

  void reset() {
    drive_ = Drive();
    initiator_ = Initiator();
    target_.reset();
    arbiter_ = Arbiter(options_.profile.arbitration);
    faults_.reset();
    spoilt_ = settled_ = frame_ = withdrawing_ = unheard_ = false;
  }

 private:
  void withdraw(const Wires& w, bool own, bool denied) {
    const bool frame = w.asserted(kFrame);
    if (frame && !frame_ && !own) {
      withdrawing_ = faults_.take(CDE_PCI_FAULT_GRANT, withdraw_after_);
      age_ = 0;
    }
    if (w.idle()) withdrawing_ = false;
    arbiter_.withhold(denied || (withdrawing_ && age_++ >= withdraw_after_));
    frame_ = frame;
  }

  cde_pci_options options_;
  HostMemory memory_;
  Faults faults_;
  Initiator initiator_;
  HostTarget target_;
  Arbiter arbiter_;
  Drive drive_;
  bool spoilt_ = false, settled_ = false, frame_ = false, withdrawing_ = false, unheard_ = false;
  uint32_t withdraw_after_ = 0, age_ = 0;
};

}  // namespace pci
