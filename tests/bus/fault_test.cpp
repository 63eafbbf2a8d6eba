// SPDX-License-Identifier: Apache-2.0
// Faults of a host in the middle of a transfer: each fault in both directions, with 32 and 64 bits.
// Faults that PCI recovers from must not change the data. The others end in a record with the
// number of bytes moved, and in a halted ring.
#include <algorithm>

#include "bus_card.hpp"

namespace cde::testing {
namespace {

struct FaultSetting {
  bool to_host, narrow;

  friend void PrintTo(const FaultSetting& s, std::ostream* out) {
    *out << (s.to_host ? "to the host" : "to the card") << (s.narrow ? ", 32 bits" : ", 64 bits");
  }
};
std::string name_of(const ::testing::TestParamInfo<FaultSetting>& info) {
  return std::string(info.param.to_host ? "ToHost" : "ToCard") + (info.param.narrow ? "32" : "64");
}

class PciFault : public ::testing::TestWithParam<FaultSetting> {
 protected:
  static constexpr std::uint32_t kData = BusCard::kFirstFree * 4096, kBytes = 10'000 / 8 * 8;

  PciFault() : card({.narrow = GetParam().narrow}) {
    card.enumerate();
    card.map_range(0, 63);
    card.start_ring(16, 512);
    fresh();
  }
  void fresh() {
    source = numbers.bytes(kBytes);
    if (GetParam().to_host) {
      std::copy(source.begin(), source.end(), card.local(card::kSpaceDdr).begin());
      card.put(kData, std::vector<std::uint8_t>(kBytes, 0xCC));
    } else {
      card.put(kData, source);
      std::ranges::fill(card.local(card::kSpaceDdr), 0xCC);
    }
  }
  Result move() { return card.transfer(kData, kBytes, card::kSpaceDdr, 0, GetParam().to_host); }
  std::vector<std::uint8_t> moved() {
    card.pass(10'000'000);
    const auto local = card.local(card::kSpaceDdr).first(kBytes);
    return GetParam().to_host ? card.get(kData, kBytes)
                              : std::vector<std::uint8_t>(local.begin(), local.end());
  }
  /// Runs cycle by cycle, at most as long as the longest transfer.
  template <class F>
  void pass_until(F&& over) {
    for (unsigned clock = 0; !over(); ++clock) {
      ASSERT_LT(clock, 100'000u) << "the transfer makes no progress";
      card.pass(15'000);
    }
  }
  /// Fetching the descriptor is a transaction as well; the fault comes after it.
  template <class F>
  void after_fetch(F&& fault) {
    card.submit(BusCard::descriptor(kData, kBytes, card::kSpaceDdr, 0, GetParam().to_host));
    const std::uint64_t read = card.counters().bytes_read;
    pass_until([&] { return card.counters().bytes_read >= read + pci::kDescriptorBytes; });
    fault();
  }
  void recovers() {
    EXPECT_EQ(card.wait().code, pci::kCodeOk);
    EXPECT_TRUE(same_bytes(moved(), source));
    EXPECT_FALSE(card.halted());
  }
  /// `exact`: no byte beyond the recorded count has changed.
  void fails(pci::Code code, bool exact = true) {
    const Result r = card.wait();
    EXPECT_EQ(r.code, code);
    ASSERT_LT(r.bytes, kBytes);
    EXPECT_EQ(r.bytes % 8, 0u);
    const auto got = moved();
    EXPECT_TRUE(same_bytes(std::span(got).first(r.bytes), std::span(source).first(r.bytes)));
    const std::uint32_t page =
        card.api().frame(card.handle(), BusCard::kFirstFree + r.bytes / 4096);
    EXPECT_EQ(r.fault & ~7u, (page << 12) + r.bytes % 4096) << "bus address of the fault";
    if (exact) {
      // If only the first half of a word moved, the word counts as not moved.
      for (std::uint32_t i = r.bytes + 8; i < kBytes; ++i) ASSERT_EQ(got[i], 0xCC) << i;
    }
    EXPECT_TRUE(card.halted());
    EXPECT_EQ(card.status_code(), code);
    EXPECT_EQ(card.read(pci::kRegFaultAddr), r.fault);
    card.clear();
    card.write(pci::kRegControl, 1u << pci::kControlRun);
    fresh();
    EXPECT_EQ(move().code, pci::kCodeOk);
    EXPECT_TRUE(same_bytes(moved(), source));
  }

  Numbers numbers{20240611};
  BusCard card;
  std::vector<std::uint8_t> source;
};

TEST_P(PciFault, Retries_MoveAllData) {
  card.fault(CDE_PCI_FAULT_RETRY, 25);
  EXPECT_EQ(move().code, pci::kCodeOk);
  EXPECT_TRUE(same_bytes(moved(), source));
  EXPECT_EQ(card.read(pci::kRegRetries), 25u);
}

TEST_P(PciFault, RetryLimit_EndsTheTransfer) {
  card.write(pci::kRegRetryLimit, 10);
  after_fetch([&] { card.fault(CDE_PCI_FAULT_RETRY, 10); });
  fails(pci::kCodeRetryLimit);
  card.fault(CDE_PCI_FAULT_RETRY, 9);
  EXPECT_EQ(move().code, pci::kCodeOk);
}

TEST_P(PciFault, SlowTarget_MovesAllData) {
  card.fault(CDE_PCI_FAULT_SLOW, 1000, 3);
  EXPECT_EQ(move().code, pci::kCodeOk);
  EXPECT_TRUE(same_bytes(moved(), source));
  EXPECT_GT(card.read(pci::kRegWaits), 2u * kBytes / 8);
}

TEST_P(PciFault, Disconnects_MoveAllData) {
  for (const std::uint32_t kind : {CDE_PCI_FAULT_DISCONNECT, CDE_PCI_FAULT_DISCONNECT_EMPTY})
    for (const std::uint32_t beat : {1u, 2u, 3u, 7u, 63u, 64u, 127u}) {
      SCOPED_TRACE(::testing::Message() << kind << " at " << beat);
      fresh();
      card.fault(kind, 20, beat);
      EXPECT_EQ(move().code, pci::kCodeOk);
      EXPECT_TRUE(same_bytes(moved(), source));
      card.fault(kind, 0);
    }
  EXPECT_GT(card.read(pci::kRegDisconnects), 100u);
}

TEST_P(PciFault, ParityError_EndsTheTransfer) {
  for (const std::uint32_t beat : {1u, 2u, 5u, 32u}) {
    SCOPED_TRACE(beat);
    fresh();
    const std::uint64_t before = card.read(pci::kRegParityErrors);
    after_fetch([&] { card.fault(CDE_PCI_FAULT_PARITY, 1, beat); });
    fails(pci::kCodeParity, !GetParam().to_host);
    EXPECT_EQ(card.config(4) >> 24 & 1, 1u) << "master data parity error";
    EXPECT_EQ(card.config(4) >> 31, GetParam().to_host ? 0u : 1u)
        << "the card must detect the error in a read";
    EXPECT_EQ(card.read(pci::kRegParityErrors), before + (GetParam().to_host ? 0 : 1));
    card.set_config(4, 0xFFFF0146);
  }
}

TEST_P(PciFault, TargetAbort_EndsTheTransfer) {
  for (const std::uint32_t beat : {0u, 1u, 8u, 31u}) {
    SCOPED_TRACE(beat);
    fresh();
    after_fetch([&] { card.fault(CDE_PCI_FAULT_TARGET_ABORT, 1, beat); });
    fails(pci::kCodeTargetAbort);
    EXPECT_EQ(card.config(4) >> 28 & 1, 1u) << "received target abort";
    card.set_config(4, 0xFFFF0146);
  }
  EXPECT_EQ(card.read(pci::kRegAborts), 4u);
}

TEST_P(PciFault, MasterAbort_EndsTheTransfer) {
  after_fetch([&] { card.fault(CDE_PCI_FAULT_MASTER_ABORT, 1); });
  fails(pci::kCodeMasterAbort);
  EXPECT_EQ(card.config(4) >> 29 & 1, 1u) << "received master abort";
}

/// The frame is a valid page, but no memory answers there.
TEST_P(PciFault, PageWithoutMemory_IsAMasterAbort) {
  card.write(pci::kPageTable + 8 * 50, 0xE0000003);
  const Result r = card.transfer(50 * 4096 + 80, 64, card::kSpaceDdr, 0, GetParam().to_host);
  EXPECT_EQ(r.code, pci::kCodeMasterAbort);
  EXPECT_EQ(r.fault, 0xE0000050u);
  EXPECT_EQ(r.bytes, 0u);
}

/// Without GNT# the latency timer ends the burst, and the card resumes it later.
TEST_P(PciFault, RemovedGrant_ResumesTheBurst) {
  for (const std::uint32_t timer : {0u, 8u, 40u, 255u}) {
    SCOPED_TRACE(timer);
    fresh();
    card.set_config(0x0C, timer << 8);
    const std::uint64_t before = card.read(pci::kRegBursts);
    card.fault(CDE_PCI_FAULT_GRANT, 1000, 1);
    EXPECT_EQ(move().code, pci::kCodeOk);
    EXPECT_TRUE(same_bytes(moved(), source));
    card.fault(CDE_PCI_FAULT_GRANT, 0);
    const std::uint64_t bursts = card.read(pci::kRegBursts) - before;
    const std::uint64_t whole = 2 + 20;  // descriptor, record, bursts of 512 bytes within pages
    if (timer == 255)
      EXPECT_EQ(bursts, whole);
    else
      EXPECT_GT(bursts, whole + 500 / (timer + 8));
  }
}

TEST_P(PciFault, UnreachableDescriptorOrRecord_HaltsTheRing) {
  card.fault(CDE_PCI_FAULT_TARGET_ABORT, 1);
  EXPECT_EQ(move().code, kNoRecord);
  EXPECT_EQ(card.status_code(), pci::kCodeTargetAbort);
  EXPECT_EQ(card.status_where(), pci::kWhereDescriptor);
  EXPECT_EQ(card.read(pci::kRegFaultAddr), card.api().frame(card.handle(), 0) << 12);
  card.clear();
  card.write(pci::kRegControl, 1u << pci::kControlRun);
  const auto bytes = [&] { return card.counters().bytes_read + card.counters().bytes_written; };
  const std::uint64_t before = bytes();
  card.submit(BusCard::descriptor(kData, kBytes, card::kSpaceDdr, 0, GetParam().to_host));
  pass_until([&] { return bytes() >= before + pci::kDescriptorBytes + kBytes; });
  card.fault(CDE_PCI_FAULT_MASTER_ABORT, 1);
  EXPECT_EQ(card.wait().code, kNoRecord);
  EXPECT_EQ(card.status_code(), pci::kCodeMasterAbort);
  EXPECT_EQ(card.status_where(), pci::kWhereCompletion);
  EXPECT_EQ(card.read(pci::kRegFaultAddr), card.api().frame(card.handle(), 1) << 12);
}

INSTANTIATE_TEST_SUITE_P(Directions, PciFault,
                         ::testing::Values(FaultSetting{false, false}, FaultSetting{false, true},
                                           FaultSetting{true, false}, FaultSetting{true, true}),
                         name_of);

}  // namespace
}  // namespace cde::testing
