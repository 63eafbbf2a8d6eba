// SPDX-License-Identifier: Apache-2.0
// The host bridge as a target: host memory for the card's transactions, with a profile's latencies
// and with faults. The function clock() receives the wires before the edge and sets what is driven
// after it.
#pragma once
#include <cstdint>
#include <cstring>

#include "cde/abi/abi_pci.h"
#include "pci_memory.h"
#include "pci_wires.h"

namespace pci {

/// Faults that wait for the card's next transactions.
class Faults {
 public:
  bool add(uint32_t kind, uint32_t count, uint32_t value) {
    if (kind >= CDE_PCI_FAULTS) return false;
    left_[kind] = count;
    value_[kind] = value;
    return true;
  }
  /// Uses up one fault. Returns whether there was one, and its value.
  bool take(uint32_t kind, uint32_t& value) {
    if (left_[kind] == 0) return false;
    if (left_[kind] != CDE_PCI_UNTIL_RESET) --left_[kind];
    ++taken_[kind];
    value = value_[kind];
    return true;
  }
  [[nodiscard]] bool waits(uint32_t kind) const { return left_[kind] != 0; }
  bool take(uint32_t kind) {
    uint32_t unused = 0;
    return take(kind, unused);
  }
  [[nodiscard]] const uint64_t (&taken() const)[CDE_PCI_FAULTS] { return taken_; }
  void reset() {
    for (uint32_t& left : left_)
      if (left == CDE_PCI_UNTIL_RESET) left = 0;
  }

 private:
  uint32_t left_[CDE_PCI_FAULTS] = {}, value_[CDE_PCI_FAULTS] = {};
  uint64_t taken_[CDE_PCI_FAULTS] = {};
};

class HostTarget {
 public:
  HostTarget(const cde_pci_options& options, HostMemory& memory, Faults& faults)
      : options_(options), memory_(memory), faults_(faults) {}

  Drive drive;

  [[nodiscard]] bool busy() const { return active_ || drive.enable != 0 || frame_; }
  [[nodiscard]] uint64_t bytes_read() const { return bytes_[0]; }
  [[nodiscard]] uint64_t bytes_written() const { return bytes_[1]; }
  [[nodiscard]] uint64_t transactions() const { return transactions_; }

  void reset() {
    drive = Drive();
    frame_ = active_ = check_ = false;
  }

  /// `own`: the host itself is the master. Returns whether PAR of this cycle's AD must be wrong.
  bool clock(const Wires& w, bool own) {
    const bool frame = w.asserted(kFrame);
    check_parity(w);
    bool spoil = false;
    if (frame && !frame_ && !own) {
      begin(w);
    } else if (active_) {
      ++age_;
      spoil = !write_ && w.asserted(kTrdy) && beats_ + 1 == spoilt_beat_;
      const bool transfer = w.asserted(kTrdy) && w.asserted(kIrdy);
      if (transfer) move(w);
      if (!frame && w.asserted(kIrdy) && (transfer || w.asserted(kStop)))
        finish();
      else
        next(w, transfer);
    } else if ((drive.enable & kTargetSignals) != 0) {
      drive.enable &= ~kTargetSignals;  // they have been high for a cycle
    }
    frame_ = frame;
    return spoil;
  }

 private:
  static constexpr uint32_t kNever = ~0u;

  void begin(const Wires& w) {
    const uint8_t command = w.cbe & 0xF;
    ++transactions_;
    addr_ = static_cast<uint32_t>(w.ad) & ~3u;
    write_ = is_write(command);
    wide_ = w.asserted(kReq64) && options_.narrow == 0 && (addr_ & 7) == 0;
    page_ = memory_.page(addr_ / kPageBytes);
    const bool memory = command == kMemoryRead || command == kMemoryWrite || command == kReadLine ||
                        command == kReadMultiple || command == kWriteInvalidate;
    active_ = page_ != nullptr && memory && !faults_.take(CDE_PCI_FAULT_MASTER_ABORT);
    if (!active_) return;
    drive.enable &= ~kTargetSignals;  // released if the last transaction has just ended
    age_ = beats_ = 0;
    stopping_ = false;
    retry_ = faults_.take(CDE_PCI_FAULT_RETRY);
    if (!faults_.take(CDE_PCI_FAULT_SLOW, slow_)) slow_ = 0;
    // Each way of cutting a transaction short has its own beat number.
    if (!faults_.take(CDE_PCI_FAULT_DISCONNECT, last_beat_)) last_beat_ = kNever;
    if (!faults_.take(CDE_PCI_FAULT_DISCONNECT_EMPTY, stop_beat_)) stop_beat_ = kNever;
    if (!faults_.take(CDE_PCI_FAULT_TARGET_ABORT, abort_beat_)) abort_beat_ = kNever;
    if (!faults_.take(CDE_PCI_FAULT_PARITY, spoilt_beat_)) spoilt_beat_ = kNever;
    countdown_ = (write_ ? options_.profile.write_latency : options_.profile.read_latency) - 2;
    if (retry_ || (abort_beat_ == 0 && countdown_ == 0)) countdown_ = 1;
  }

  void move(const Wires& w) {
    uint8_t* const p = page_ + addr_ % kPageBytes;
    const uint32_t size = wide_ ? 8 : 4;
    if (write_) {
      late_ = {.p = p, .data = w.ad, .enable = static_cast<uint8_t>(~w.cbe), .size = size};
      par_ = parity(w);
      par64_ = parity64(w);
      check_ = true;
      late_bad_ = beats_ + 1 == spoilt_beat_;
    } else {
      bytes_[0] += size;
    }
    addr_ += size;
    ++beats_;
    countdown_ = slow_;
    if (options_.profile.wait_every != 0 && beats_ % options_.profile.wait_every == 0)
      countdown_ += options_.profile.waits;
  }

  /// DEVSEL# one cycle after the address phase (medium), then each data phase at its time.
  void next(const Wires& w, bool transfer) {
    if (age_ == 1) {
      drive.enable |= kTargetSignals | (write_ ? 0 : kAd | (wide_ ? kAd64 : 0));
      drive.set(kTargetSignals, false);
      drive.set(kDevsel | (wide_ ? kAck64 : 0), true);
    }
    if (transfer && w.asserted(kStop)) stopping_ = true;
    if (transfer) drive.set(kTrdy, false);
    if (stopping_ || (!transfer && w.asserted(kTrdy))) return;
    if (countdown_ > 0) {
      --countdown_;
      return;
    }
    if (beats_ == abort_beat_) {
      drive.set(kDevsel | kAck64, false);
      drive.set(kStop, true);
      stopping_ = true;
    } else if (retry_ || beats_ == stop_beat_) {
      drive.set(kStop, true);
      stopping_ = true;
    } else {
      const uint32_t size = wide_ ? 8 : 4;
      drive.set(kTrdy, true);
      drive.set(kStop, beats_ + 1 == last_beat_ || (addr_ + size) % kPageBytes == 0);
      if (!write_) {
        drive.ad = ~0ull;
        std::memcpy(&drive.ad, page_ + addr_ % kPageBytes, size);
      }
    }
  }

  void finish() {
    drive.set(kTargetSignals, false);
    drive.enable &= ~uint32_t{kAd | kAd64};
    active_ = false;
  }

  /// Checks data written by the card. PAR comes one cycle later, and only good data are stored.
  void check_parity(const Wires& w) {
    bool perr = false;
    if (check_) {
      perr = late_bad_ || w.asserted(kPar) == par_ ||
             (late_.size == 8 && w.asserted(kPar64) == par64_);
      if (!perr) {
        for (uint32_t b = 0; b < late_.size; ++b)
          if ((late_.enable >> b & 1) != 0) late_.p[b] = static_cast<uint8_t>(late_.data >> 8 * b);
        bytes_[1] += late_.size;
      }
      check_ = false;
    }
    if (!perr && !w.asserted(kPerr)) drive.enable &= ~uint32_t{kPerr};
    drive.set(kPerr, perr);
    if (perr) drive.enable |= kPerr;
  }

  struct Late {
    uint8_t* p = nullptr;
    uint64_t data = 0;
    uint8_t enable = 0;
    uint32_t size = 0;
  };
  const cde_pci_options& options_;
  HostMemory& memory_;
  Faults& faults_;
  uint8_t* page_ = nullptr;
  Late late_;
  uint32_t addr_ = 0, age_ = 0, beats_ = 0, countdown_ = 0, slow_ = 0;
  uint32_t last_beat_ = kNever, stop_beat_ = kNever, abort_beat_ = kNever, spoilt_beat_ = kNever;
  bool frame_ = false, active_ = false, write_ = false, wide_ = false, retry_ = false,
       stopping_ = false;
  bool check_ = false, late_bad_ = false, par_ = false, par64_ = false;
  uint64_t bytes_[2] = {0, 0}, transactions_ = 0;
};

}  // namespace pci
