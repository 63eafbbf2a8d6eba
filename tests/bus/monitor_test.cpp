// SPDX-License-Identifier: Apache-2.0
// The protocol checker itself: legal transactions pass, and each broken rule is named.
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "models/pci_monitor.h"

namespace {

using pci::Drive;

struct Clock {
  Drive master, target;
  bool granted = true;
  bool spoil = false;  // wrong PAR
};
using Trace = std::vector<Clock>;

void drive(Drive& d, uint32_t signals, bool asserted) {
  d.enable |= signals;
  d.set(signals, asserted);
}
void address(Drive& d, uint64_t ad, uint8_t cbe, bool ad64 = false) {
  d.enable |= pci::kAd | pci::kCbe | (ad64 ? uint32_t{pci::kAd64} : 0);
  d.ad = ad;
  d.cbe = cbe;
}

/// Two data phases with one wait state; 64 bits if `wide`.
Trace transaction(bool write, bool wide) {
  Trace t(10);
  const uint32_t frame = pci::kFrame | (wide ? uint32_t{pci::kReq64} : 0);
  const uint32_t devsel = pci::kDevsel | (wide ? uint32_t{pci::kAck64} : 0);
  for (const int c : {2, 3, 4, 5, 6}) drive(t[c].master, pci::kFrame | pci::kReq64, false);
  for (const int c : {2, 3, 4, 5}) drive(t[c].master, frame, true);
  address(t[2].master, 0x1000, write ? 7 : 6, wide);
  for (const int c : {3, 4, 5, 6}) {
    drive(t[c].master, pci::kIrdy, true);
    if (write)
      address(t[c].master, c == 6 ? 0x1111222233334444 : 0x5555666677778888, 0, wide);
    else
      t[c].master.enable |= pci::kCbe, t[c].master.cbe = 0;
  }
  drive(t[7].master, pci::kIrdy, false);
  for (const int c : {4, 5, 6, 7}) drive(t[c].target, pci::kTargetSignals, false);
  for (const int c : {4, 5, 6}) {
    drive(t[c].target, devsel, true);
    if (!write) {
      t[c].target.enable |= pci::kAd | (wide ? uint32_t{pci::kAd64} : 0);
      t[c].target.ad = c == 6 ? 0x1234567890ABCDEF : 0x1111111122222222;
    }
  }
  for (const int c : {5, 6}) drive(t[c].target, pci::kTrdy, true);
  return t;
}

/// A disconnect with data in the first phase, which is then the last.
Trace disconnected(bool write) {
  Trace t = transaction(write, false);
  drive(t[5].target, pci::kStop, true);
  drive(t[6].target, pci::kStop, true);
  drive(t[6].target, pci::kTrdy, false);
  return t;
}

std::string check(const Trace& trace) {
  pci::Monitor monitor;
  bool ad[2] = {false, false}, ad64[2] = {false, false};
  bool par = false, par64 = false;
  for (const Clock& clock : trace) {
    Drive d[2] = {clock.master, clock.target};
    for (int i = 0; i < 2; ++i) {
      if (ad[i]) d[i].enable |= pci::kPar;
      if (ad64[i]) d[i].enable |= pci::kPar64;
      d[i].set(pci::kPar, par == clock.spoil);  // signals are active low
      d[i].set(pci::kPar64, !par64);
      ad[i] = d[i].drives(pci::kAd);
      ad64[i] = d[i].drives(pci::kAd64);
    }
    const pci::Wires w = resolve(d[0], d[1]);
    par = parity(w);
    par64 = parity64(w);
    monitor.clock(d[0], d[1], w, clock.granted, !clock.granted, false);
  }
  return monitor.violation();
}

TEST(PciMonitor, LegalTransactions_Pass) {
  for (const bool write : {false, true}) {
    for (const bool wide : {false, true}) EXPECT_EQ(check(transaction(write, wide)), "");
    EXPECT_EQ(check(disconnected(write)), "");
    Trace twice = transaction(write, true);
    const Trace again = transaction(!write, false);
    twice.insert(twice.end(), again.begin(), again.end());
    EXPECT_EQ(check(twice), "");
  }
}

TEST(PciMonitor, UnexcusedBadParity_IsReported) {
  Trace t = transaction(true, false);
  t[3].spoil = true;
  EXPECT_EQ(check(t), "PCI clock 3: PAR is wrong");
}

struct Broken {
  const char* name;
  bool write;
  std::function<void(Trace&)> spoil;
  const char* complaint;

  friend void PrintTo(const Broken& b, std::ostream* out) { *out << b.name; }
};

class PciMonitorRule : public ::testing::TestWithParam<Broken> {};

TEST_P(PciMonitorRule, BrokenRule_IsNamed) {
  const Broken& b = GetParam();
  Trace t = transaction(b.write, true);
  b.spoil(t);
  EXPECT_EQ(check(t), b.complaint);
}

const Broken kBroken[] = {
    {"Contention", true, [](Trace& t) { t[5].target.enable |= pci::kAd; },
     "PCI clock 5: AD[31:0] driven by two agents"},
    {"Turnaround", true, [](Trace& t) { t[7].target.enable |= pci::kAd; },
     "PCI clock 7: AD[31:0] changes its driver without a turnaround clock"},
    {"Release", true, [](Trace& t) { t[7].master.enable &= ~uint32_t{pci::kIrdy}; },
     "PCI clock 7: IRDY# left alone without having been driven high"},
    {"Grant", true, [](Trace& t) { t[1].granted = false; },
     "PCI clock 2: FRAME# asserted by a master without GNT#"},
    {"NoAddress", true, [](Trace& t) { t[2].master.enable &= ~uint32_t{pci::kCbe}; },
     "PCI clock 2: FRAME# without an address"},
    {"FrameWithoutIrdy", true,
     [](Trace& t) {
       drive(t[3].master, pci::kIrdy, false);
       drive(t[3].master, pci::kFrame | pci::kReq64, false);
     },
     "PCI clock 3: FRAME# deasserted without IRDY#"},
    {"FrameAgain", true, [](Trace& t) { drive(t[4].master, pci::kFrame | pci::kReq64, false); },
     "PCI clock 4: FRAME# changed while a data phase waited"},
    {"IrdyWithdrawn", true, [](Trace& t) { drive(t[4].master, pci::kIrdy, false); },
     "PCI clock 4: IRDY# withdrawn before the data phase was complete"},
    {"IrdyOutside", true, [](Trace& t) { drive(t[1].master, pci::kIrdy, true); },
     "PCI clock 1: IRDY# asserted outside a transaction"},
    {"DataChanged", true, [](Trace& t) { t[4].master.ad = 1; },
     "PCI clock 4: AD[31:0] changed while a data phase waited"},
    {"EnablesChanged", false, [](Trace& t) { t[4].master.cbe = 1; },
     "PCI clock 4: C/BE# changed while a data phase waited"},
    {"ReadDriven", false, [](Trace& t) { t[3].master.enable |= pci::kAd; },
     "PCI clock 3: AD[31:0] driven by the master in the data phases of a read"},
    {"WriteNotDriven", true, [](Trace& t) { t[4].master.enable &= ~uint32_t{pci::kAd}; },
     "PCI clock 4: AD[31:0] changed while a data phase waited"},
    {"KeptAfterLast", true, [](Trace& t) { drive(t[7].master, pci::kIrdy, true); },
     "PCI clock 7: IRDY# kept after the last data phase"},
    {"DevselWithdrawn", true, [](Trace& t) { drive(t[5].target, pci::kTargetSignals, false); },
     "PCI clock 5: DEVSEL# withdrawn"},
    {"TrdyWithoutDevsel", true,
     [](Trace& t) {
       drive(t[4].target, pci::kDevsel | pci::kAck64, false), drive(t[4].target, pci::kTrdy, true);
     },
     "PCI clock 4: TRDY# asserted without DEVSEL#"},
    {"TrdyInTurnaround", false,
     [](Trace& t) { t[3].target = t[5].target, t[3].target.enable = pci::kTargetSignals; },
     "PCI clock 3: TRDY# asserted in the turnaround clock of a read"},
    {"StopWithdrawn", true,
     [](Trace& t) { drive(t[5].target, pci::kStop, true), drive(t[6].target, pci::kTrdy, false); },
     "PCI clock 6: STOP# withdrawn before FRAME#"},
    {"StopIgnored", true,
     [](Trace& t) {
       drive(t[4].target, pci::kStop, true);
       drive(t[5].target, pci::kStop, true);
       drive(t[5].target, pci::kTrdy, false);
     },
     "PCI clock 5: FRAME# kept after STOP#"},
    {"TrdyAfterDisconnect", true,
     [](Trace& t) { drive(t[5].target, pci::kStop, true), drive(t[6].target, pci::kStop, true); },
     "PCI clock 6: TRDY# asserted after a disconnect"},
    {"Ack64WithoutReq64", true,
     [](Trace& t) {
       for (const int c : {2, 3, 4, 5}) drive(t[c].master, pci::kReq64, false);
     },
     "PCI clock 4: ACK64# asserted without REQ64# or DEVSEL#"},
    {"Req64Alone", true, [](Trace& t) { drive(t[4].master, pci::kReq64, false); },
     "PCI clock 4: REQ64# does not follow FRAME#"},
    {"ReadDataNotDriven", false, [](Trace& t) { t[6].target.enable &= ~uint32_t{pci::kAd64}; },
     "PCI clock 6: AD[63:32] not driven in a data phase of a read"},
    {"AddressParity", false, [](Trace& t) { t[3].spoil = true; }, "PCI clock 3: PAR is wrong"},
    {"DataParity", false, [](Trace& t) { t[6].spoil = true; }, "PCI clock 6: PAR is wrong"},
    {"NobodyAnswers", true,
     [](Trace& t) {
       for (Clock& c : t) c.target = Drive();
       t.resize(5);
       for (int i = 0; i < 6; ++i) t.push_back(t[4]);
     },
     "PCI clock 9: FRAME# kept though nobody answers"},
};

INSTANTIATE_TEST_SUITE_P(Each, PciMonitorRule, ::testing::ValuesIn(kBroken),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
