// SPDX-License-Identifier: Apache-2.0
// DMA in both directions: sizes, alignments, page boundaries, ring wraps, the address check.
#include <algorithm>

#include "bus_card.hpp"

namespace cde::testing {
namespace {

using card::kSpaceDdr;

TEST(PciDma, EverySizeAndPlace_MovesBothWays) {
  for (const bool narrow : {false, true}) {
    SCOPED_TRACE(narrow);
    BusCard card({.narrow = narrow});
    card.enumerate();
    card.map_range(0, 63);
    card.start_ring();
    Numbers numbers(20240611);
    const std::vector<std::uint8_t> beside(8, 0x55);
    for (const std::uint32_t bytes : {8u, 16u, 24u, 40u, 64u, 248u, 4096u, 4104u, 12280u, 65536u})
      for (const std::uint32_t start : {0u, 8u, 4088u, 2048u}) {
        SCOPED_TRACE(::testing::Message() << bytes << " bytes from " << start);
        const std::uint32_t up = BusCard::kFirstFree * 4096 + start, down = up + 30 * 4096;
        const std::uint32_t offset = 8 * numbers.below(1000);
        const auto data = numbers.bytes(bytes);
        card.put(up, data);
        const auto local = card.local(kSpaceDdr);
        std::fill(local.begin(), local.end(), 0xEE);
        const Result in = card.transfer(up, bytes, kSpaceDdr, offset, false);
        ASSERT_EQ(in.code, pci::kCodeOk);
        ASSERT_EQ(in.bytes, bytes);
        card.pass(10'000'000);
        ASSERT_TRUE(same_bytes(local.subspan(offset, bytes), data));
        ASSERT_EQ(local[offset + bytes], 0xEE);
        card.put(down - 8, std::vector<std::uint8_t>(bytes + 16, 0x55));
        const Result out = card.transfer(down, bytes, kSpaceDdr, offset, true);
        ASSERT_EQ(out.code, pci::kCodeOk);
        ASSERT_EQ(out.bytes, bytes);
        ASSERT_TRUE(same_bytes(card.get(down, bytes), data));
        ASSERT_TRUE(same_bytes(card.get(down - 8, 8), beside))
            << "bytes before the transfer changed";
        ASSERT_TRUE(same_bytes(card.get(down + bytes, 8), beside))
            << "bytes after the transfer changed";
      }
  }
}

/// A card with a running ring and pages 0 to 63 mapped.
struct Running : BusCard {
  explicit Running(const BusOptions& options = {}, unsigned ring = 16, std::uint32_t burst = 4096)
      : BusCard(options) {
    enumerate();
    map_range(0, 63);
    start_ring(ring, burst);
  }
};
constexpr std::uint32_t kData = BusCard::kFirstFree * 4096;

TEST(PciDma, Bursts_FollowTheBurstRegister) {
  for (const std::uint32_t burst : {64u, 72u, 256u, 512u, 4096u}) {
    Running card({}, 16, burst);
    const std::uint64_t before = card.read(pci::kRegBursts);
    ASSERT_EQ(card.transfer(kData, 16384, kSpaceDdr, 0, false).code, pci::kCodeOk);
    // Bursts also end with pages; a descriptor and a record take a burst each.
    const std::uint64_t in_page = (4096 + burst - 1) / burst;
    EXPECT_EQ(card.read(pci::kRegBursts) - before, 4 * in_page + 2);
    EXPECT_EQ(card.counters().bytes_read, 16384u + pci::kDescriptorBytes);
    EXPECT_EQ(card.counters().bytes_written, +pci::kCompletionBytes);
  }
  Running card;
  card.write(pci::kRegControl, 1u << pci::kControlStop);
  EXPECT_EQ(card.status_code(), pci::kCodeStopped);
  for (const auto& [given, kept] :
       {std::pair{0u, 64u}, {63u, 64u}, {100u, 96u}, {4097u, 4096u}, {~0u, 4096u}}) {
    card.write(pci::kRegBurst, given);
    EXPECT_EQ(card.read(pci::kRegBurst), kept);
  }
}

/// Several laps, several descriptors together, a full ring, records in order.
TEST(PciDma, RingWraps_KeepRecordsInOrder) {
  for (const unsigned size : {2u, 3u, 16u, 128u}) {
    SCOPED_TRACE(size);
    Running card({}, size);
    Numbers numbers(7);
    const auto data = numbers.bytes(64 * 8);
    card.put(kData, data);
    unsigned next = 0;
    for (unsigned round = 0; round < 30; ++round) {
      const unsigned some = 1 + numbers.below(size - 1);
      for (unsigned i = 0; i < some; ++i)
        card.stage(BusCard::descriptor(kData + 8 * ((next + i) % 64), 8, kSpaceDdr, 8 * (next + i),
                                       false, i + 1 == some));
      card.publish();
      for (unsigned i = 0; i < some; ++i, ++next) {
        const Result r = card.wait();
        ASSERT_EQ(r.code, pci::kCodeOk);
        ASSERT_EQ(r.number, next % size);
      }
    }
    EXPECT_EQ(card.read(pci::kRegRingHead), next % size);
    card.pass(10'000'000);
    for (unsigned i = 0; i < next; ++i)
      ASSERT_EQ(std::memcmp(card.local(kSpaceDdr).data() + 8 * i, data.data() + 8 * (i % 64), 8), 0)
          << i;
  }
}

TEST(PciDma, ScatteredPages_ReachEverySpace) {
  Running card;
  Numbers numbers(8);
  // Three pages in another order, one of them twice.
  card.map(40, 10);
  card.map(41, 7);
  card.map(42, 10);
  // The bridge passes on every space number of the bus; here each is a memory of its own.
  for (std::uint32_t number = 0; number < 1u << card::kSpaceBits; ++number) {
    const auto space = static_cast<card::Space>(number);
    const auto a = numbers.bytes(4096), b = numbers.bytes(4096);
    card.put(10 * 4096, a);
    card.put(7 * 4096, b);
    ASSERT_EQ(card.transfer(40 * 4096, 3 * 4096, space, 0x4000, false).code, pci::kCodeOk);
    card.pass(10'000'000);
    const auto local = card.local(space).subspan(0x4000);
    EXPECT_TRUE(same_bytes(local.first(4096), a));
    EXPECT_TRUE(same_bytes(local.subspan(4096, 4096), b));
    EXPECT_TRUE(same_bytes(local.subspan(8192, 4096), a));
  }
}

TEST(PciDma, InvalidDescriptors_HaltWithTheirCode) {
  struct Case {
    pci::Descriptor descriptor;
    pci::Code code;
    std::uint32_t fault;
  };
  const auto make = [](std::uint32_t at, std::uint32_t bytes, std::uint32_t offset = 0) {
    return BusCard::descriptor(at, bytes, kSpaceDdr, offset, false);
  };
  pci::Descriptor flags = make(kData, 64);
  flags.local |= 1ull << 50;
  pci::Descriptor beside_space = make(kData, 64), below_direction = beside_space;
  beside_space.local |= 1ull << (pci::kDescriptorSpace + card::kSpaceBits);
  below_direction.local |= 1ull << (pci::kDescriptorToHost - 1);
  std::vector<Case> cases = {{make(kData, 0), pci::kCodeLength, kData},
                             {flags, pci::kCodeAlignment, kData},
                             {beside_space, pci::kCodeAlignment, kData},
                             {below_direction, pci::kCodeAlignment, kData}};
  for (const std::uint32_t odd : {1u, 4u, 7u, 12u, 4095u}) {
    cases.push_back({make(kData, odd), pci::kCodeLength, kData});
    cases.push_back({make(kData + odd, 64), pci::kCodeAlignment, kData + odd});
    cases.push_back({make(kData, 64, odd), pci::kCodeAlignment, kData});
  }
  Running card;
  for (const Case& c : cases) {
    const std::uint64_t bursts = card.read(pci::kRegBursts);
    card.submit(c.descriptor);
    card.submit(make(kData, 64));  // not served: the ring has halted
    const Result r = card.wait();
    EXPECT_EQ(r.code, c.code);
    EXPECT_EQ(r.bytes, 0u);
    EXPECT_EQ(r.fault, c.fault);
    EXPECT_TRUE(card.halted());
    EXPECT_EQ(card.status_code(), c.code);
    EXPECT_EQ(card.read(pci::kRegFaultAddr), c.fault);
    EXPECT_EQ(card.read(pci::kRegBursts), bursts + 2)
        << "one burst for the descriptor, one for the record, none for data";
    EXPECT_EQ(card.wait(100).code, kNoRecord);
    card.write(pci::kRegControl, 1u << pci::kControlRun);
    EXPECT_EQ(card.wait(100).code, kNoRecord) << "a halted ring must not run";
    card.clear();
    card.write(pci::kRegControl, 1u << pci::kControlRun);
    EXPECT_EQ(card.transfer(kData, 64, kSpaceDdr, 0, false).code, pci::kCodeOk);
    card.write(pci::kRegControl, 1u << pci::kControlStop);
    card.clear();
    card.write(pci::kRegControl, 1u << pci::kControlRun);
  }
}

/// The address check refuses a transfer before any data moves, wherever in the range the bad page
/// is.
TEST(PciDma, BadPage_IsRefusedBeforeDataMoves) {
  Running card({}, 16, 512);
  const std::vector<std::uint8_t> untouched(20 * 4096, 0x5A);
  for (const bool to_host : {false, true})
    for (const std::uint32_t bad : {20u, 21u, 25u})
      for (const bool read_only : {false, true}) {
        card.map_range(20, 25);
        card.map(bad, bad, !read_only, read_only);
        card.put(20 * 4096, untouched);
        std::fill(card.local(kSpaceDdr).begin(), card.local(kSpaceDdr).end(), 0xA5);
        const std::uint64_t data = card.counters().bytes_read + card.counters().bytes_written;
        const Result r = card.transfer(20 * 4096 + 64, 6 * 4096 - 64, kSpaceDdr, 0, to_host);
        const bool allowed = read_only && !to_host;
        EXPECT_EQ(r.code, allowed     ? pci::kCodeOk
                          : read_only ? pci::kCodeReadOnly
                                      : pci::kCodeUnmapped);
        if (allowed) continue;
        EXPECT_EQ(r.bytes, 0u);
        EXPECT_EQ(r.fault, bad == 20 ? 20 * 4096 + 64 : bad * 4096);
        EXPECT_EQ(card.read(pci::kRegFaultAddr), r.fault);
        EXPECT_EQ(card.counters().bytes_read + card.counters().bytes_written - data, 32u + 16u);
        EXPECT_TRUE(same_bytes(card.get(20 * 4096, 20 * 4096), untouched));
        EXPECT_EQ(card.local(kSpaceDdr)[0], 0xA5);
        EXPECT_TRUE(card.halted());
        card.clear();
        card.write(pci::kRegControl, 1u << pci::kControlRun);
      }
  // Beyond the table, and across its end.
  card.map_range(20, 25);
  for (const std::uint32_t at : {0x01000000u, 0xFFFFF000u, 0x00FFF000u}) {
    const Result r = card.transfer(at, 8192, kSpaceDdr, 0, false);
    EXPECT_EQ(r.code, pci::kCodeUnmapped);
    EXPECT_EQ(r.fault, at);
    card.clear();
    card.write(pci::kRegControl, 1u << pci::kControlRun);
  }
}

/// Transfers that end one word before the end of their page, at it, and one word after it. They
/// start at several places in the page. The next page is checked if and only if data lies in it.
TEST(PciDma, TransferToAPageEnd_ChecksOnlyItsPages) {
  constexpr std::uint32_t kPage = 4096, kFirst = 20 * kPage;
  for (const bool to_host : {false, true})
    for (const std::uint32_t pages : {1u, 2u})
      for (const std::uint32_t start : {0u, 8u, 2048u, kPage - 8})
        for (const int beyond : {-8, 0, 8})
          for (const bool next_mapped : {true, false}) {
            const auto bytes =
                static_cast<std::uint32_t>(static_cast<int>(pages * kPage - start) + beyond);
            if (bytes == 0) continue;
            SCOPED_TRACE(::testing::Message()
                         << (to_host ? "to the host, " : "to the card, ") << bytes << " bytes from "
                         << start << ", next page " << (next_mapped ? "mapped" : "not mapped"));
            Running card;
            const std::uint32_t next = 20 + pages;
            if (!next_mapped) card.map(next, next, true, false);
            Numbers numbers(11);
            const auto data = numbers.bytes(bytes);
            const auto local = card.local(kSpaceDdr);
            if (to_host)
              std::copy(data.begin(), data.end(), local.begin());
            else
              card.put(kFirst + start, data);
            const Result r = card.transfer(kFirst + start, bytes, kSpaceDdr, 0, to_host);
            if (beyond > 0 && !next_mapped) {
              EXPECT_EQ(r.code, pci::kCodeUnmapped);
              EXPECT_EQ(r.bytes, 0u) << "refused before any data moved";
              EXPECT_EQ(r.fault, next * kPage);
              continue;
            }
            ASSERT_EQ(r.code, pci::kCodeOk);
            EXPECT_EQ(r.bytes, bytes);
            card.pass(10'000'000);
            EXPECT_TRUE(to_host ? same_bytes(card.get(kFirst + start, bytes), data)
                                : same_bytes(local.first(bytes), data));
          }
}

/// A core so slow that the FIFO towards it fills up: bursts wait for space, and no word is lost.
TEST(PciDma, FullFifo_MakesBurstsWait) {
  constexpr std::uint32_t kBytes = 32768;
  Running card({.core_period_ps = 400'000});
  Numbers numbers(12);
  const auto data = numbers.bytes(kBytes);
  card.put(kData, data);
  ASSERT_EQ(card.transfer(kData, kBytes, kSpaceDdr, 0, false).code, pci::kCodeOk);
  card.pass(100'000'000);
  EXPECT_TRUE(same_bytes(card.local(kSpaceDdr).first(kBytes), data));
}

/// Ring addresses go through the same table. An error that no record can report is in the
/// registers.
TEST(PciDma, RingsOutsideTheTable_HaltWithStatus) {
  for (const bool descriptors : {true, false}) {
    Running card;
    const std::uint32_t page = descriptors ? BusCard::kRingPage : BusCard::kCompletionPage;
    card.map(page, page, false, descriptors ? false : true);
    card.submit(BusCard::descriptor(kData, 64, kSpaceDdr, 0, false));
    EXPECT_LT(card.api().run(card.handle(), 50'000'000, 1), 50'000'000u) << "no interrupt";
    EXPECT_EQ(card.read(pci::kRegIrqStatus), 1u << pci::kIrqHalted);
    EXPECT_EQ(card.wait().code, kNoRecord);
    EXPECT_TRUE(card.halted());
    EXPECT_EQ(card.status_code(), descriptors ? pci::kCodeUnmapped : pci::kCodeReadOnly);
    EXPECT_EQ(card.status_where(), descriptors ? pci::kWhereDescriptor : pci::kWhereCompletion);
    EXPECT_EQ(card.read(pci::kRegFaultAddr), page * 4096);
  }
}

TEST(PciDma, InvalidSettings_HaltTheRing) {
  BusCard card;
  card.enumerate();
  card.map_range(0, 63);
  const auto go = [&](std::uint64_t base, std::uint64_t records, std::uint64_t size,
                      std::uint64_t tail) {
    card.write(pci::kRegControl, 1u << pci::kControlClear);
    card.write(pci::kRegRingBase, base);
    card.write(pci::kRegCompletionBase, records);
    card.write(pci::kRegRingSize, size);
    card.write(pci::kRegRingTail, tail);
    card.write(pci::kRegControl, 1u << pci::kControlRun);
    const bool halted = card.halted();
    EXPECT_EQ(card.status_code(), halted ? pci::kCodeSettings : pci::kCodeOk);
    return !halted;
  };
  EXPECT_TRUE(go(0, 4096, 16, 0));
  card.write(pci::kRegControl, 1u << pci::kControlStop);
  EXPECT_FALSE(go(16, 4096, 16, 0));
  EXPECT_FALSE(go(0, 4104, 16, 0));
  EXPECT_FALSE(go(0, 4096, 1, 0));
  EXPECT_FALSE(go(0, 4096, 32769, 0));
  EXPECT_FALSE(go(0, 4096, 1ull << 40, 0));
  EXPECT_FALSE(go(0, 4096, 16, 16));
  EXPECT_FALSE(go(1ull << 24, 4096, 16, 0));
  for (const std::uint32_t offset :
       {pci::kRegRingBase, pci::kRegRingSize, pci::kRegCompletionBase, pci::kRegBurst}) {
    EXPECT_TRUE(go(0, 4096, 16, 0));
    card.write(offset, 64);
    EXPECT_TRUE(card.halted()) << "written while the ring runs";
    EXPECT_EQ(card.status_code(), pci::kCodeSettings);
  }
  EXPECT_TRUE(go(0, 4096, 16, 0));
  card.write(pci::kRegRingTail, 16);
  EXPECT_TRUE(card.halted()) << "tail outside the ring";
}

TEST(PciDma, MasteringOff_HaltsTheRing) {
  Running card;
  card.set_config(4, 0x142);
  EXPECT_EQ(card.transfer(kData, 64, kSpaceDdr, 0, false).code, kNoRecord);
  EXPECT_EQ(card.status_code(), pci::kCodeDisabled);
  EXPECT_EQ(card.counters().bytes_read, 0u);
}

TEST(PciDma, Stop_FinishesTheDescriptor) {
  Running card;
  for (int i = 0; i < 3; ++i) card.stage(BusCard::descriptor(kData, 40000, kSpaceDdr, 0, false));
  card.publish();
  card.pass(30'000'000);
  card.write(pci::kRegControl, 1u << pci::kControlStop);
  const Result r = card.wait();
  EXPECT_EQ(r.code, pci::kCodeOk);
  EXPECT_EQ(r.bytes, 40000u);
  EXPECT_TRUE(card.halted());
  EXPECT_EQ(card.status_code(), pci::kCodeStopped);
  EXPECT_EQ(card.read(pci::kRegRingHead), 1u);
}

TEST(PciDma, Completions_InterruptOrPoll) {
  Running card;
  card.write(pci::kRegIrqMask, 0);
  card.submit(BusCard::descriptor(kData, 64, kSpaceDdr, 0, false));
  EXPECT_EQ(card.wait().code, pci::kCodeOk) << "found by polling";
  EXPECT_EQ(card.api().interrupt(card.handle()), 0);
  EXPECT_EQ(card.read(pci::kRegIrqStatus), 1u << pci::kIrqCompletion);
  card.write(pci::kRegIrqMask, 7);
  card.pass(1'000'000);
  EXPECT_EQ(card.api().interrupt(card.handle()), 1);
  EXPECT_EQ(card.config(4) >> 19 & 1, 1u) << "the interrupt status bit";
  card.set_config(4, 0x546);
  card.pass(100'000);
  EXPECT_EQ(card.api().interrupt(card.handle()), 0) << "the interrupt disable bit masks INTA#";
  card.set_config(4, 0x146);
  card.write(pci::kRegIrqStatus, 1u << pci::kIrqCompletion);
  card.pass(1'000'000);
  EXPECT_EQ(card.api().interrupt(card.handle()), 0);
  // The card's own line rises and falls; this register cannot clear it.
  card.api().local_irq(card.handle(), 1);
  card.pass(1'000'000);
  EXPECT_EQ(card.api().interrupt(card.handle()), 1);
  card.write(pci::kRegIrqStatus, ~0ull);
  EXPECT_EQ(card.read(pci::kRegIrqStatus), 1u << pci::kIrqCard);
  card.api().local_irq(card.handle(), 0);
  card.pass(1'000'000);
  EXPECT_EQ(card.api().interrupt(card.handle()), 0);
  // The host loses an interrupt; the record is there anyway.
  card.fault(CDE_PCI_FAULT_LOST_INTERRUPT, 1);
  card.submit(BusCard::descriptor(kData, 64, kSpaceDdr, 0, false));
  EXPECT_EQ(card.api().run(card.handle(), 50'000'000, 1), 50'000'000u);
  EXPECT_EQ(card.wait(1).code, pci::kCodeOk);
}

/// Skipping idle cycles changes neither bits nor times, for any ratio of the clocks.
TEST(PciDma, SkippedCycles_ChangeNothing) {
  for (const std::uint32_t core : {3'000u, 7'001u, 10'000u, 15'000u, 40'000u}) {
    std::vector<std::uint64_t> seen[2];
    for (const bool all : {false, true}) {
      Running card({.core_period_ps = core});
      card.api().evaluate_all(card.handle(), all);
      Numbers numbers(9);
      card.put(kData, numbers.bytes(32768));
      for (int i = 0; i < 20; ++i) {
        card.pass(1000 * numbers.below(5000));
        const std::uint32_t from = kData + 8 * numbers.below(100), n = 8 + 8 * numbers.below(900);
        ASSERT_EQ(card.transfer(from, n, kSpaceDdr, 8 * numbers.below(999), i % 2 != 0).code,
                  pci::kCodeOk);
        card.api().local_irq(card.handle(), i % 3 == 0);
        card.write(pci::kRegIrqMask, numbers.below(8));
        seen[all].push_back(card.api().time_ps(card.handle()));
        seen[all].push_back(card.read(pci::kRegIrqStatus));
      }
      for (std::uint32_t r = pci::kRegBursts; r <= pci::kRegBusy; r += 8)
        seen[all].push_back(card.read(r));
      const auto memory = card.get(kData, 32768);
      for (std::size_t i = 0; i < memory.size(); i += 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, &memory[i], 8);
        seen[all].push_back(word);
      }
      if (all)
        EXPECT_EQ(card.counters().skipped, 0u);
      else
        EXPECT_GT(card.counters().skipped, 1000u);
    }
    EXPECT_EQ(seen[0], seen[1]) << core;
  }
}

/// RST# at any time of a transfer: no state survives, and everything works again.
TEST(PciDma, ResetMidTransfer_ClearsAllState) {
  for (const std::uint64_t when : {0u, 200'000u, 1'000'000u, 5'000'000u, 12'345'678u}) {
    Running card;
    Numbers numbers(10);
    const auto data = numbers.bytes(16384);
    card.put(kData, data);
    card.submit(BusCard::descriptor(kData, 16384, kSpaceDdr, 0, false));
    card.pass(when);
    card.api().reset(card.handle());
    EXPECT_EQ(card.config(0x04), 0x02200000u);
    EXPECT_EQ(card.config(0x10), 0u);
    EXPECT_EQ(card.api().interrupt(card.handle()), 0);
    card.enumerate();
    EXPECT_EQ(card.read(pci::kRegStatus), 0u);
    for (std::uint32_t entry = 0; entry < pci::kPages; entry += 7)
      ASSERT_EQ(card.read(pci::kPageTable + 8 * entry), 0u)
          << "the reset must empty the page table";
    card.map_range(0, 63);
    card.start_ring();
    std::ranges::fill(card.local(kSpaceDdr), 0);
    ASSERT_EQ(card.transfer(kData, 16384, kSpaceDdr, 0, false).code, pci::kCodeOk);
    card.pass(10'000'000);
    EXPECT_TRUE(same_bytes(card.local(kSpaceDdr).first(data.size()), data));
  }
}

}  // namespace
}  // namespace cde::testing
