// SPDX-License-Identifier: Apache-2.0
// Random traffic and random faults with a scoreboard. Every byte of host memory, card memory,
// registers and page table is in its place: none lost, repeated or wrong, and no hang. CDE_FULL=1
// runs 1,000,000 bus transactions and 10,000 faults, the default 20,000 transactions.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bus_card.hpp"

namespace cde::testing {
namespace {

class Soak {
 public:
  Soak(std::uint32_t seed, bool narrow, const std::string& profile, std::uint32_t core_ps)
      : numbers_(seed),
        card_({.profile = profile, .narrow = narrow, .core_period_ps = core_ps, .seed = seed}),
        host_(kPages * 4096),
        local_(kLocal) {
    card_.enumerate();
    card_.map_range(0, BusCard::kFirstFree + kPages - 1);
    table_.assign(64, 0);
    registers_.assign(64, 0);
    for (std::uint32_t i = 0; i < 64; ++i) card_.write(kRegister + 8 * i, 0);
    host_ = numbers_.bytes(host_.size());
    card_.put(kBase, host_);
    restart();
  }

  void run(std::uint64_t transactions, std::uint64_t faults) {
    while ((card_.counters().transactions + accesses_ < transactions || faults_ < faults) &&
           !::testing::Test::HasFatalFailure()) {
      batch();
      ASSERT_LT(batches_, transactions) << "too few transactions or faults";
      if (++batches_ % 64 == 0) compare_all();
      if (batches_ % 500 == 0) restart_with_other_settings();
    }
    compare_all();
    EXPECT_EQ(card_.api().violation(card_.handle()), nullptr);
  }
  [[nodiscard]] std::uint64_t transactions() const {
    return card_.counters().transactions + accesses_;
  }
  [[nodiscard]] std::uint64_t faults() const { return faults_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  [[nodiscard]] std::uint64_t unrecorded() const { return unrecorded_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  static constexpr std::uint32_t kPages = 24, kBase = BusCard::kFirstFree * 4096;
  static constexpr std::uint32_t kLocal = 65536, kRegister = 0x200, kEntry = 1000;

  struct Move {
    std::uint32_t at, bytes, offset;
    bool to_host;
  };

  void restart() {
    card_.start_ring(8, 64 << numbers_.below(7));
    card_.write(pci::kRegRetryLimit, 60);
  }
  void restart_with_other_settings() {
    card_.write(pci::kRegControl, 1u << pci::kControlStop);
    card_.set_config(0x0C, numbers_.below(256) << 8);
    restart();
  }

  /// A few descriptors together, with host accesses and faults in between.
  void batch() {
    std::vector<Move> moves(1 + numbers_.below(4));
    for (Move& m : moves) {
      m.bytes = 8 + 8 * numbers_.below(numbers_.below(8) == 0 ? 1500 : 60);
      m.at = 8 * numbers_.below((kPages * 4096 - m.bytes) / 8);
      m.offset = 8 * numbers_.below((kLocal - m.bytes) / 8);
      m.to_host = numbers_.below(2) != 0;
      card_.stage(BusCard::descriptor(kBase + m.at, m.bytes, card::kSpaceDdr, m.offset, m.to_host));
    }
    // The fault comes before the fetch of the descriptor, or anywhere in its transfer.
    const bool faulty = numbers_.below(3) == 0, early = numbers_.below(4) == 0;
    if (faulty && early) fault();
    card_.publish();
    if (faulty && !early) {
      card_.pass(15'000 * numbers_.below(1000));
      fault();
    }
    ++accesses_;
    for (std::uint32_t n = numbers_.below(4); n > 0; --n) access();
    for (const Move& m : moves) {
      const Result r = card_.wait(5'000);
      if (r.code == kNoRecord) {  // the ring halted without a record for this move
        ASSERT_TRUE(card_.halted()) << "hang";
        ASSERT_NE(card_.status_code(), pci::kCodeOk);
        ++failed_;
        ++unrecorded_;
        uncertain(m);
        recover();
        return;
      }
      ASSERT_LE(r.bytes, m.bytes);
      ASSERT_TRUE(r.code != pci::kCodeOk || r.bytes == m.bytes);
      apply(m, r.bytes);
      if (r.code != pci::kCodeOk) {
        ++failed_;
        if (m.to_host)
          uncertain({m.at + r.bytes, std::min(m.bytes - r.bytes, 40u), m.offset + r.bytes, true});
        recover();
        return;
      }
    }
  }

  void apply(const Move& m, std::uint32_t bytes) {
    bytes_ += bytes;
    if (m.to_host)
      std::copy_n(local_.begin() + m.offset, bytes, host_.begin() + m.at);
    else
      std::copy_n(host_.begin() + m.at, bytes, local_.begin() + m.offset);
  }

  /// Bytes of an unfinished write: each is old or new. The scoreboard takes them over after the
  /// check.
  void uncertain(const Move& m) {
    card_.pass(5'000'000);
    const auto now = m.to_host ? card_.get(kBase + m.at, m.bytes)
                               : std::vector<std::uint8_t>(
                                     card_.local(card::kSpaceDdr).begin() + m.offset,
                                     card_.local(card::kSpaceDdr).begin() + m.offset + m.bytes);
    auto& mine = m.to_host ? host_ : local_;
    const auto& other = m.to_host ? local_ : host_;
    const std::uint32_t to = m.to_host ? m.at : m.offset, from = m.to_host ? m.offset : m.at;
    for (std::uint32_t i = 0; i < m.bytes; ++i) {
      ASSERT_TRUE(now[i] == mine[to + i] || now[i] == other[from + i]) << "byte " << i;
      mine[to + i] = now[i];
    }
  }

  void recover() {
    for (unsigned kind = 0; kind < CDE_PCI_FAULT_HANG; ++kind) card_.fault(kind, 0);
    card_.set_config(0x04, 0xFFFF0146);
    restart();
  }

  void fault() {
    static constexpr std::uint32_t kHarmless[] = {
        CDE_PCI_FAULT_RETRY,      CDE_PCI_FAULT_SLOW,
        CDE_PCI_FAULT_DISCONNECT, CDE_PCI_FAULT_DISCONNECT_EMPTY,
        CDE_PCI_FAULT_GRANT,      CDE_PCI_FAULT_LOST_INTERRUPT,
        CDE_PCI_FAULT_NO_GRANT};
    static constexpr std::uint32_t kFatal[] = {CDE_PCI_FAULT_PARITY, CDE_PCI_FAULT_TARGET_ABORT,
                                               CDE_PCI_FAULT_MASTER_ABORT, CDE_PCI_FAULT_RETRY};
    ++faults_;
    if (numbers_.below(2) != 0) {
      const std::uint32_t kind = kHarmless[numbers_.below(std::size(kHarmless))];
      card_.fault(kind, 1 + numbers_.below(12), 1 + numbers_.below(20));
    } else {
      const std::uint32_t kind = kFatal[numbers_.below(4)];
      card_.fault(kind, kind == CDE_PCI_FAULT_RETRY ? 70 : 1, numbers_.below(20));
    }
  }

  /// Accesses to registers of the card, unused page-table entries, and bad parity.
  void access() {
    ++accesses_;
    const std::uint32_t i = numbers_.below(64);
    const bool table = numbers_.below(2) != 0;
    const std::uint32_t offset = table ? pci::kPageTable + 8 * (kEntry + i) : kRegister + 8 * i;
    std::uint64_t& mine = table ? table_[i] : registers_[i];
    const std::uint64_t value =
        (std::uint64_t{numbers_.bits()} << 32 | numbers_.bits()) & (table ? 0xFFFFF003 : ~0ull);
    switch (numbers_.below(5)) {
      case 0:
        card_.write(offset, mine = value);
        break;
      case 1:
        card_.write32(offset, static_cast<std::uint32_t>(value));
        mine = value & 0xFFFFFFFF;
        break;
      case 2:
        ASSERT_EQ(card_.read(offset), mine);
        break;
      case 3:
        ASSERT_EQ(card_.read32(offset + 4), mine >> 32);
        break;
      default: {
        cde_pci_transaction t{};
        t.command = pci::kMemoryWrite;
        t.address = BusCard::kBar + offset;
        t.dwords = 2;
        t.bad_data_parity = 1 + numbers_.below(2);
        t.waits = numbers_.below(3);
        t.enable[0] = t.enable[1] = 0xF;
        const Ending result = card_.transact(t);
        // If one half is bad, neither is written. A retry for lack of space has no data phase.
        ASSERT_TRUE(result == CDE_PCI_PARITY ||
                    (result == CDE_PCI_OK && t.done < t.bad_data_parity))
            << ::testing::PrintToString(result);
        if (t.done == 1 && t.bad_data_parity == 2) mine = 0;
        ASSERT_EQ(card_.read(offset), mine);
      }
    }
  }

  void compare_all() {
    card_.pass(5'000'000);
    const auto host = card_.get(kBase, static_cast<std::uint32_t>(host_.size()));
    const auto local = card_.local(card::kSpaceDdr).first(kLocal);
    ASSERT_EQ(std::ranges::mismatch(host, host_).in1 - host.begin(),
              static_cast<std::ptrdiff_t>(host.size()))
        << "first difference in host memory";
    ASSERT_EQ(std::ranges::mismatch(local, local_).in1 - local.begin(),
              static_cast<std::ptrdiff_t>(local.size()))
        << "first difference in card memory";
    for (std::uint32_t i = 0; i < 64; ++i) {
      ASSERT_EQ(card_.read(kRegister + 8 * i), registers_[i]);
      ASSERT_EQ(card_.read(pci::kPageTable + 8 * (kEntry + i)), table_[i]);
    }
    accesses_ += 128;
  }

  Numbers numbers_;
  BusCard card_;
  std::vector<std::uint8_t> host_, local_;
  std::vector<std::uint64_t> table_, registers_;
  std::uint64_t accesses_ = 0, faults_ = 0, failed_ = 0, unrecorded_ = 0, batches_ = 0, bytes_ = 0;
};

TEST(PciSoak, RandomTrafficAndFaults_LoseOrRepeatNoByte) {
  const char* const full = std::getenv("CDE_FULL");
  const bool all = full != nullptr && *full == '1';
  std::uint64_t transactions = 0, faults = 0, failed = 0, unrecorded = 0, bytes = 0;
  std::uint32_t seed = 20240611;
  struct Setting {
    const char* profile;
    bool narrow;
    std::uint32_t core_ps;
  };
  for (const Setting& s : {Setting{"ideal", false, 10'000},
                           {"ideal", true, 10'000},
                           {"good", false, 23'456},
                           {"p64-2001", false, 4'001}}) {
    SCOPED_TRACE(::testing::Message() << s.profile << " seed " << seed);
    Soak soak(seed++, s.narrow, s.profile, s.core_ps);
    soak.run(all ? 250'000 : 5'000, all ? 2'500 : 50);
    if (HasFatalFailure()) return;
    transactions += soak.transactions();
    faults += soak.faults();
    failed += soak.failed();
    unrecorded += soak.unrecorded();
    bytes += soak.bytes();
  }
  EXPECT_GT(failed - unrecorded, faults / 20) << "too few transfers failed in their data";
  EXPECT_GT(unrecorded, 0u) << "no descriptor or record failed";
  std::printf(
      "seed 20240611: %llu bus transactions, %llu faults, %llu failed transfers (%llu without a "
      "record), %llu "
      "bytes compared\n",
      static_cast<unsigned long long>(transactions), static_cast<unsigned long long>(faults),
      static_cast<unsigned long long>(failed), static_cast<unsigned long long>(unrecorded),
      static_cast<unsigned long long>(bytes));
}

}  // namespace
}  // namespace cde::testing
