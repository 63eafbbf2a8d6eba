// SPDX-License-Identifier: Apache-2.0
// Configuration space and BAR0 as a host sees them: identity, sizing, every access width, and
// refusals.
#include <algorithm>

#include "bus_card.hpp"

namespace cde::testing {
namespace {

using namespace pci;
constexpr std::uint32_t kSignaledTargetAbort = 1u << 27, kDetectedParity = 1u << 31,
                        kSignaledSerr = 1u << 30;

cde_pci_transaction single(std::uint32_t command, std::uint32_t address, std::uint32_t data = 0,
                           std::uint8_t enable = 0xF) {
  cde_pci_transaction t{};
  t.command = command;
  t.address = address;
  t.dwords = 1;
  t.data[0] = data;
  t.enable[0] = enable;
  return t;
}
cde_pci_transaction wide(std::uint32_t command, std::uint32_t address, std::uint64_t data = 0,
                         std::uint8_t enable = 0xFF) {
  cde_pci_transaction t = single(command, address, static_cast<std::uint32_t>(data), enable & 0xF);
  t.wide = 1;
  t.dwords = 2;
  t.data[1] = static_cast<std::uint32_t>(data >> 32);
  t.enable[1] = enable >> 4;
  return t;
}

TEST(PciConfig, ConfigurationSpace_IdentifiesTheCard) {
  const BusCard card;
  EXPECT_EQ(card.config(0x00), pci::kDeviceId << 16 | pci::kVendorId);
  EXPECT_EQ(card.config(0x04), 0x02200000u) << "66 MHz, medium DEVSEL#, all commands off";
  EXPECT_EQ(card.config(0x08), pci::kClass);
  EXPECT_EQ(card.config(0x08) >> 8, 0x0B4000u);
  EXPECT_EQ(card.config(0x0C), 0u);
  EXPECT_EQ(card.config(0x2C), pci::kSubsystem);
  EXPECT_EQ(card.config(0x3C), 0x100u) << "INTA#";
  for (std::uint32_t offset = 0x14; offset < 0x2C; offset += 4)
    EXPECT_EQ(card.config(offset), 0u) << offset;
  for (std::uint32_t offset = 0x40; offset < 0x100; offset += 4)
    EXPECT_EQ(card.config(offset), 0u) << offset;
}

TEST(PciConfig, BarSizing_ReportsItsSize) {
  const BusCard card;
  card.set_config(0x10, ~0u);
  EXPECT_EQ(card.config(0x10), 0xFFFF0000u) << "64 KB of 32-bit memory, not prefetchable";
  card.set_config(0x10, 0x12345678);
  EXPECT_EQ(card.config(0x10), 0x12340000u);
  for (std::uint32_t offset = 0x14; offset < 0x28; offset += 4) {
    card.set_config(offset, ~0u);
    EXPECT_EQ(card.config(offset), 0u);
  }
}

TEST(PciConfig, WritableBits_FollowByteEnables) {
  const BusCard card;
  card.set_config(0x04, 0xFFFF);
  EXPECT_EQ(card.config(0x04) & 0xFFFF, 0x0546u)
      << "memory, master, parity, SERR#, interrupt disable";
  cde_pci_transaction t = single(kConfigWrite, 0x0C, 0x11223344, 0b0010);
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  EXPECT_EQ(card.config(0x0C), 0x3300u) << "only the byte of the latency timer";
  t = single(kConfigWrite, 0x3C, 0xFFFFFFAA, 0b1111);
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  EXPECT_EQ(card.config(0x3C), 0x1AAu);
  t = single(kConfigWrite, 0x00, 0);
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  EXPECT_EQ(card.config(0x00), pci::kDeviceId << 16 | pci::kVendorId);
}

/// Every set of byte enables on every writable register: disabled bytes keep their value.
TEST(PciConfig, AnyByteEnables_KeepDisabledBytes) {
  struct Register {
    std::uint32_t offset, writable;
  };
  for (const Register& r :
       {Register{0x04, 0x0546}, {0x0C, 0xFFFF}, {0x10, 0xFFFF0000}, {0x3C, 0xFF}})
    for (std::uint8_t enable = 0; enable < 16; ++enable) {
      SCOPED_TRACE(::testing::Message() << "register " << r.offset << " enables " << +enable);
      const BusCard card;
      std::uint32_t bytes = 0;
      for (unsigned k = 0; k < 4; ++k) bytes |= (enable >> k & 1u) * 0xFFu << 8 * k;
      for (const std::uint32_t before : {0u, ~0u}) {
        card.set_config(r.offset, before);
        cde_pci_transaction t = single(kConfigWrite, r.offset, ~before, enable);
        EXPECT_EQ(card.transact(t), CDE_PCI_OK);
        EXPECT_EQ(card.config(r.offset) & r.writable, (before ^ bytes) & r.writable);
      }
    }
}

/// A 1 in an enabled byte clears a bit of the status register.
TEST(PciConfig, StatusBits_ClearByEnabledOnes) {
  BusCard card;
  card.enumerate();
  cde_pci_transaction hole = single(kMemoryRead, BusCard::kBar + 0x2000);
  EXPECT_EQ(card.transact(hole), CDE_PCI_TARGET_ABORT);
  for (unsigned enable = 0; enable < 16; ++enable) {
    const bool clears = (enable & 8) != 0;
    cde_pci_transaction t =
        single(kConfigWrite, 0x04, 0xFFFF0146, static_cast<std::uint8_t>(enable));
    EXPECT_EQ(card.transact(t), CDE_PCI_OK);
    EXPECT_EQ(card.config(0x04) & kSignaledTargetAbort, clears ? 0 : kSignaledTargetAbort)
        << "enables " << enable;
    if (clears) {
      EXPECT_EQ(card.transact(hole), CDE_PCI_TARGET_ABORT);
    }
  }
}

TEST(PciConfig, Bursts_AreCutAndOtherFunctionsAreAbsent) {
  const BusCard card;
  cde_pci_transaction t = single(kConfigRead, 0);
  t.dwords = 3;
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  EXPECT_EQ(t.done, 1u);
  EXPECT_EQ(t.stopped, 1u) << "disconnect with the first data phase";
  EXPECT_EQ(t.devsel, 2u) << "medium";
  for (const std::uint32_t address : {0x100u, 0x700u, 0x001u}) {
    t = single(kConfigRead, address);
    EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT) << address;
  }
}

TEST(PciConfig, Memory_AnswersOnlyWhenEnabledAndAddressed) {
  BusCard card;
  cde_pci_transaction t = single(kMemoryRead, BusCard::kBar + pci::kRegStatus);
  EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT) << "memory space is off";
  card.enumerate();
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  for (const std::uint32_t address : {BusCard::kBar - 8, BusCard::kBar + 0x10000u}) {
    t = single(kMemoryRead, address);
    EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT);
  }
  for (const std::uint32_t command : {0u, 1u, 2u, 3u, 4u, 5u, 8u, 9u, 0xDu}) {
    t = single(command, BusCard::kBar + pci::kRegStatus);
    EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT) << "command " << command;
  }
}

TEST(PciBar, DelayedRead_IsRetriedOnce) {
  BusCard card;
  card.enumerate();
  card.write(pci::kRegIrqMask, 5);
  for (const std::uint32_t command : {0x6u, 0xEu, 0xCu}) {  // read, read line, read multiple
    cde_pci_transaction t = wide(command, BusCard::kBar + pci::kRegIrqMask);
    EXPECT_EQ(card.transact(t), CDE_PCI_OK);
    EXPECT_EQ(t.done, 0u);
    EXPECT_EQ(t.stopped, 1u) << "the first attempt is retried";
    card.pass(1'000'000);
    EXPECT_EQ(card.transact(t), CDE_PCI_OK);
    EXPECT_EQ(t.done, 2u);
    EXPECT_EQ(t.took_wide, 1u);
    EXPECT_EQ(t.data[0], 5u);
    EXPECT_EQ(t.data[1], 0u);
  }
}

TEST(PciBar, UnfetchedRead_IsDropped) {
  BusCard card;
  card.enumerate();
  card.write(pci::kRegIrqMask, 5);
  cde_pci_transaction t = wide(kMemoryRead, BusCard::kBar + pci::kRegIrqMask);
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  cde_pci_transaction other = wide(kMemoryRead, BusCard::kBar + pci::kRegBurst);
  card.pass(32000ull * 15'000);
  EXPECT_EQ(card.transact(other), CDE_PCI_OK);
  EXPECT_EQ(other.done, 0u) << "another read is pending";
  card.pass(1000ull * 15'000);
  EXPECT_EQ(card.transact(other), CDE_PCI_OK);
  EXPECT_EQ(card.read(pci::kRegBurst), 4096u);
}

/// A register of the card over the local bus, one of the bridge, and one of the page table.
TEST(PciBar, EveryWidth_ReadsAndWritesARegister) {
  for (const bool narrow : {false, true}) {
    SCOPED_TRACE(narrow);
    BusCard card({.narrow = narrow});
    card.enumerate();
    for (const std::uint32_t offset : {0x028u, +pci::kRegRingBase, pci::kPageTable + 8 * 77}) {
      SCOPED_TRACE(offset);
      const std::uint64_t mask = offset == pci::kRegRingBase ? 0xFFFFFF
                                 : offset < 0x1000           ? ~0ull
                                                             : 0xFFFFF003;
      for (const std::uint64_t value : {0x12345ull, 0x00ABCDEFull & mask}) {
        card.write(offset, value);
        EXPECT_EQ(card.read(offset), value & mask);
        EXPECT_EQ(card.read32(offset), value & mask & 0xFFFFFFFF);
        EXPECT_EQ(card.read32(offset + 4), (value & mask) >> 32);
      }
      card.write32(offset, 0x4321);
      EXPECT_EQ(card.read(offset), 0x4321 & mask)
          << "writing only the low half clears the high half";
    }
    card.write(0x028, 0x1122334455667788);
    EXPECT_EQ(card.read(0x028), 0x1122334455667788u);
    EXPECT_EQ(card.read32(0x028), 0x55667788u);
    EXPECT_EQ(card.read32(0x02C), 0x11223344u);
    card.write32(0x028, 0xAABBCCDD);
    EXPECT_EQ(card.read(0x028), 0xAABBCCDDu);
  }
}

TEST(PciBar, PartialOrUnmappedAccess_AbortsWithoutEffect) {
  BusCard card;
  card.enumerate();
  card.write(0x028, 0x1122334455667788);
  const auto refused = [&](cde_pci_transaction t) {
    EXPECT_EQ(card.transact(t), CDE_PCI_TARGET_ABORT);
    EXPECT_EQ(card.config(4) & kSignaledTargetAbort, kSignaledTargetAbort);
    card.set_config(4, kSignaledTargetAbort | 0x146);
    EXPECT_EQ(card.config(4) & kSignaledTargetAbort, 0u);
    EXPECT_EQ(card.read(0x028), 0x1122334455667788u);
  };
  for (unsigned enable = 1; enable < 15; ++enable)
    refused(single(kMemoryWrite, BusCard::kBar + 0x028, 99, static_cast<std::uint8_t>(enable)));
  refused(single(kMemoryWrite, BusCard::kBar + 0x02C, 99));  // an upper half alone
  for (unsigned enable = 1; enable < 255; ++enable)
    if (enable != 0x0F)
      refused(wide(kMemoryWrite, BusCard::kBar + 0x028, 99, static_cast<std::uint8_t>(enable)));
  for (const std::uint32_t hole : {0x2000u, 0x7FF8u}) {
    refused(wide(kMemoryWrite, BusCard::kBar + hole, 1));
    refused(single(kMemoryRead, BusCard::kBar + hole));
  }
  cde_pci_transaction none = wide(kMemoryWrite, BusCard::kBar + 0x028, 99, 0);
  EXPECT_EQ(card.transact(none), CDE_PCI_OK) << "a data phase without bytes writes nothing";
  EXPECT_EQ(card.read(0x028), 0x1122334455667788u);
  cde_pci_transaction low = wide(kMemoryWrite, BusCard::kBar + 0x028, 99, 0x0F);
  EXPECT_EQ(card.transact(low), CDE_PCI_OK);
  EXPECT_EQ(card.read(0x028), 99u);
}

TEST(PciBar, PostedBursts_WriteEveryWord) {
  for (const bool narrow : {false, true})
    for (const std::uint32_t waits : {0u, 1u, 5u}) {
      SCOPED_TRACE(waits);
      BusCard card({.narrow = narrow});
      card.enumerate();
      cde_pci_transaction t{};
      t.command = kMemoryWrite;
      t.address = BusCard::kBar + 0x100;
      t.wide = !narrow;
      t.dwords = 40;
      t.waits = waits;
      for (unsigned i = 0; i < t.dwords; ++i) {
        t.data[i] = 0x01010101 * i + waits;
        t.enable[i] = 0xF;
      }
      EXPECT_EQ(card.transact(t), CDE_PCI_OK);
      EXPECT_GT(t.done, 16u) << "more than one word per transaction";
      EXPECT_EQ(t.took_wide, !narrow);
      for (unsigned i = 0; i < t.done; ++i) EXPECT_EQ(card.read32(0x100 + 4 * i), t.data[i]) << i;
    }
}

/// Bursts longer than the FIFO, and bursts up to the end of BAR0.
TEST(PciBar, LongBursts_ContinueToTheEnd) {
  for (const bool narrow : {false, true}) {
    BusCard card({.narrow = narrow});
    card.enumerate();
    std::vector<std::uint64_t> entries(512);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = i << 12 | 3;
    const std::uint32_t first = 0x10000 - 8 * 512;
    EXPECT_EQ(card.api().mmio_write(card.handle(), first, entries.data(), 4096), CDE_PCI_OK);
    for (std::uint32_t i = 0; i < 512; i += 37)
      EXPECT_EQ(card.read(first + 8 * i), entries[i]) << i;
    EXPECT_EQ(card.read(0x10000 - 8), entries[511]);
    std::vector<std::uint64_t> back(512);
    EXPECT_EQ(card.api().mmio_read(card.handle(), first, back.data(), 4096), CDE_PCI_OK);
    EXPECT_EQ(back, entries);
  }
}

/// A core so slow that the FIFO of posted writes is mostly full. Bursts write as far as there is
/// space, and no accepted word is lost.
TEST(PciBar, PostedWritesThatFillTheFifo_LoseNothing) {
  constexpr std::uint32_t kBursts = 40, kRegisters = 512;
  for (const bool narrow : {false, true}) {
    SCOPED_TRACE(narrow ? "32 bits" : "64 bits");
    BusCard card({.narrow = narrow, .core_period_ps = 400'000});
    card.enumerate();
    std::uint32_t cut = 0, first = 0;
    for (std::uint32_t burst = 0; burst < kBursts; ++burst) {
      // Bursts of every length, so that the last FIFO entries fill in every phase of a burst.
      const std::uint32_t qwords = 2 + 7 * burst % 19;
      cde_pci_transaction t{};
      t.command = kMemoryWrite;
      t.wide = !narrow;
      std::fill(std::begin(t.enable), std::end(t.enable), std::uint8_t{0xF});
      for (std::uint32_t done = 0, tries = 0; done < 2 * qwords; done += t.done, ++tries) {
        ASSERT_LT(tries, 1000u) << "burst " << burst << " is never accepted";
        t.address = BusCard::kBar + 8 * first + 4 * done;
        t.dwords = 2 * qwords - done;
        for (std::uint32_t i = 0; i < t.dwords; ++i) t.data[i] = 2 * first + done + i;
        ASSERT_EQ(card.transact(t), CDE_PCI_OK);
        cut += t.done < t.dwords ? 1 : 0;
      }
      first += qwords;
    }
    ASSERT_LE(first, kRegisters);
    EXPECT_GT(cut, kBursts) << "the FIFO was never full";
    for (std::uint64_t q = 0; q < first; ++q)
      ASSERT_EQ(card.read(8 * static_cast<std::uint32_t>(q)), (2 * q + 1) << 32 | 2 * q)
          << "register " << q;
  }
}

/// A burst past the end of BAR0 ends there and does not wrap to the beginning.
TEST(PciBar, BurstBeyondTheBar_EndsWithIt) {
  constexpr std::uint32_t kInside = 4, kEnd = 0x10000;
  for (const bool narrow : {false, true}) {
    SCOPED_TRACE(narrow ? "32 bits" : "64 bits");
    BusCard card({.narrow = narrow});
    card.enumerate();
    for (std::uint32_t q = 0; q < 8; ++q) card.write(8 * q, 0x100 + q);
    cde_pci_transaction t{};
    t.command = kMemoryWrite;
    t.wide = !narrow;
    t.address = BusCard::kBar + kEnd - 8 * kInside;
    t.dwords = 2 * (kInside + 4);
    for (std::uint32_t i = 0; i < t.dwords; ++i) {
      t.data[i] = i % 2 == 0 ? (i << 12 | 3) : 0;
      t.enable[i] = 0xF;
    }
    EXPECT_EQ(card.transact(t), CDE_PCI_OK);
    EXPECT_EQ(t.done, 2 * kInside);
    EXPECT_EQ(t.stopped, 1u);
    for (std::uint32_t q = 0; q < kInside; ++q)
      EXPECT_EQ(card.read(kEnd - 8 * (kInside - q)), t.data[2 * q]) << "entry " << q;
    for (std::uint32_t q = 0; q < 8; ++q)
      EXPECT_EQ(card.read(8 * q), 0x100 + q) << "register " << q;
  }
}

TEST(PciBar, NonlinearBurst_GetsOnePhase) {
  BusCard card;
  card.enumerate();
  cde_pci_transaction t = wide(kMemoryWrite, BusCard::kBar + 0x100 + 2, 0x77);
  t.dwords = 4;
  t.enable[2] = t.enable[3] = 0xF;
  EXPECT_EQ(card.transact(t), CDE_PCI_OK);
  EXPECT_EQ(t.done, 2u);
  EXPECT_EQ(t.stopped, 1u);
}

TEST(PciBar, BadAddressParity_IsNotClaimed) {
  BusCard card;
  card.enumerate();
  card.write(0x028, 1);
  cde_pci_transaction t = wide(kMemoryWrite, BusCard::kBar + 0x028, 99);
  t.bad_address_parity = 1;
  EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT);
  EXPECT_EQ(card.config(4) & (kDetectedParity | kSignaledSerr), kDetectedParity | kSignaledSerr);
  EXPECT_EQ(card.read(0x028), 1u);
  EXPECT_EQ(card.read(pci::kRegParityErrors), 1u);
  card.set_config(4, 0xFFFF0146);
  EXPECT_EQ(card.config(4), 0x02200146u);
  card.set_config(4, 0x46);  // SERR# off
  EXPECT_EQ(card.transact(t), CDE_PCI_MASTER_ABORT);
  EXPECT_EQ(card.config(4) & (kDetectedParity | kSignaledSerr), kDetectedParity);
}

TEST(PciBar, BadDataParity_IsNotWritten) {
  for (const bool narrow : {false, true}) {
    BusCard card({.narrow = narrow});
    card.enumerate();
    for (std::uint32_t i = 0; i < 4; ++i) card.write(0x100 + 8 * i, 1000 + i);
    cde_pci_transaction t{};
    t.command = kMemoryWrite;
    t.address = BusCard::kBar + 0x100;
    t.wide = !narrow;
    t.dwords = 8;
    t.bad_data_parity = narrow ? 3 : 2;
    for (unsigned i = 0; i < 8; ++i) {
      t.data[i] = i;
      t.enable[i] = 0xF;
    }
    EXPECT_EQ(card.transact(t), CDE_PCI_PARITY) << "PERR#";
    EXPECT_EQ(t.done, 8u);
    EXPECT_EQ(card.config(4) & kDetectedParity, kDetectedParity);
    EXPECT_EQ(card.read(0x100), 1ull << 32);
    EXPECT_EQ(card.read(0x108), 1001u) << "the bad word is not written";
    EXPECT_EQ(card.read(0x110), 4 | 5ull << 32);
    card.set_config(4, 0xFFFF0006);  // parity response off: detected, not reported
    t.bad_data_parity = 1;
    EXPECT_EQ(card.transact(t), CDE_PCI_OK);
    EXPECT_EQ(card.config(4) & kDetectedParity, kDetectedParity);
  }
}

}  // namespace
}  // namespace cde::testing
