// SPDX-License-Identifier: Apache-2.0
// The whole card over PCI equals the card on the functional bus, bit for bit and cycle for cycle.
#include <cstring>
#include <utility>

#include "../board/cases.hpp"
#include "bus_card.hpp"
#include "cde/contract/records.hpp"

namespace cde::testing {
namespace {

template <class P>
std::vector<std::uint8_t> words_of(const std::vector<P>& shapes) {
  std::vector<float> words(shapes.size() * P::kWords);
  for (std::size_t i = 0; i < shapes.size(); ++i)
    to_words(shapes[i], std::span<float, P::kWords>(&words[i * P::kWords], P::kWords));
  if (words.size() % 2 != 0) words.push_back(0);
  std::vector<std::uint8_t> bytes(4 * words.size());
  std::memcpy(bytes.data(), words.data(), bytes.size());
  return bytes;
}

struct PciCard : BusCard {
  static constexpr std::uint32_t kTriangles = 2 * 4096, kRays = 32 * 4096, kRecords = 40 * 4096;

  explicit PciCard(const std::string& profile,
                   std::vector<std::string> parameters = small_config().parameters())
      : BusCard({.kind = "card", .parameters = std::move(parameters), .profile = profile}) {
    enumerate();
    map_range(0, 63);
    start_ring();
  }
  void load(const RayScene& scene) {
    const auto triangles = words_of(scene.triangles), rays = words_of(scene.rays);
    put(kTriangles, triangles);
    put(kRays, rays);
    stage(descriptor(kTriangles, static_cast<std::uint32_t>(triangles.size()), card::kSpaceDdr, 0,
                     false, false));
    stage(descriptor(kRays, static_cast<std::uint32_t>(rays.size()), card::kSpacePrim, 0, false));
    publish();
    ASSERT_EQ(wait().code, pci::kCodeOk);
    ASSERT_EQ(wait().code, pci::kCodeOk);
    write(card::kRegPrimCount, scene.rays.size());
    write(card::kRegSecCount, scene.triangles.size());
  }
  /// Records of a pass; a DMA fetches them whenever the card requests it.
  std::vector<Record> cast(Mode mode) {
    write(card::kRegCommand, static_cast<std::uint64_t>(mode));
    write(pci::kRegIrqMask, 1u << pci::kIrqCard);
    write(card::kRegControl, card::kControlGo);
    std::vector<Record> records;
    for (bool done = false; !done;) {
      api().run(handle(), 1'000'000'000, 1);
      EXPECT_EQ(read(pci::kRegIrqStatus) >> pci::kIrqCard & 1, 1u) << "no interrupt from the card";
      const std::uint64_t status = read(card::kRegStatus);
      EXPECT_EQ(status & (1u << card::kStatusCommandError | 1u << card::kStatusBusError), 0u);
      done = (status >> card::kStatusDone & 1) != 0;
      const auto waiting = static_cast<std::uint32_t>(read(card::kRegRecords));
      if (waiting == 0) continue;
      EXPECT_EQ(transfer(kRecords, bytes_of(waiting), card::kSpaceSram, 0, true).code,
                pci::kCodeOk);
      take(waiting, records);
    }
    write(card::kRegControl, card::kControlClear);
    return records;
  }

 private:
  /// Size in whole beats.
  static std::uint32_t bytes_of(std::uint32_t records) {
    return (card::kRecordWords * records + 1) / 2 * 8;
  }
  void take(std::uint32_t count, std::vector<Record>& records) const {
    const auto raw = get(kRecords, bytes_of(count));
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint32_t w[card::kRecordWords];
      std::memcpy(w, &raw[sizeof w * i], sizeof w);
      Record r;
      for (unsigned k = 0; k < 3; ++k) r.cp[k] = std::bit_cast<float>(w[card::kRecordCp + k]);
      r.f = (w[card::kRecordFlags] >> card::kFlagF & 1) != 0;
      r.bad = (w[card::kRecordFlags] >> card::kFlagBad & 1) != 0;
      r.index = w[card::kRecordIndex];
      r.t = std::bit_cast<float>(w[card::kRecordT]);
      r.primary = w[card::kRecordPrimary];
      records.push_back(r);
    }
  }
};

TEST(PciCardTest, Registers_IdentifyTheCard) {
  PciCard card("ideal");
  EXPECT_EQ(card.read(card::kRegId), std::uint64_t{card::kIdMagic} << 32 | card::kInterfaceVersion);
  EXPECT_EQ(card.read(card::kRegConfigHash), card.api().config_hash);
  EXPECT_EQ(card.read(card::kRegConfigHash), model_hash("card", small_config().parameters()));
  EXPECT_EQ(card.read(card::kRegCapacity), 36'000u);
  EXPECT_EQ(card.api().container_bits, 32u);
}

void expect_same(Board& board, PciCard& card) {
  Random random;
  for (const RayScene& scene :
       {beam(random, 60, 700), cloud(random, 64, 300), beam(random, 33, 111)}) {
    board.upload(scene.triangles);
    board.load(scene.rays);
    card.load(scene);
    for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits}) {
      SCOPED_TRACE(name_of(mode));
      Counters counters;
      const auto expected = board.run({.mode = mode}, &counters);
      const auto got = card.cast(mode);
      ASSERT_EQ(got.size(), expected.size());
      unsigned hits = 0;
      for (std::size_t i = 0; i < got.size(); ++i) {
        ASSERT_TRUE(same_bits(got[i], expected[i])) << i;
        hits += got[i].f;
      }
      EXPECT_GT(hits, 0u);
      EXPECT_EQ(card.read(card::kRegRows), counters.rows);
      if (mode != Mode::kHits) {
        EXPECT_EQ(card.read(card::kRegCycles), counters.cycles);
        EXPECT_EQ(card.read(card::kRegWriteback), counters.writeback);
      }
    }
  }
}

TEST(PciCardTest, Pass_EqualsTheFunctionalBusInRecordsAndCycles) {
  Board board = Board::open(small_config());
  for (const char* const profile : {"ideal", "p64-2001"}) {
    SCOPED_TRACE(profile);
    PciCard card(profile);
    expect_same(board, card);
  }
}

/// Each clock domain leaves the reset with its own clock (rtl/bus/reset_sync.sv).
TEST(PciCardTest, WithResetSynchronisers_EqualsTheFunctionalBus) {
  Board board = Board::open(small_config());
  std::vector<std::string> parameters = small_config().parameters();
  parameters.emplace_back("RESET_STAGES=2");
  PciCard card("ideal", parameters);
  expect_same(board, card);
}

/// A DMA that the board refuses shows in its status, as on the functional bus.
TEST(PciCardTest, TransferOutsideASpace_IsReported) {
  PciCard card("ideal");
  EXPECT_EQ(card.transfer(PciCard::kTriangles, 64, card::kSpaceDdr, 36'000 - 32, false).code,
            pci::kCodeOk);
  card.pass(1'000'000);
  EXPECT_EQ(card.read(card::kRegStatus) >> card::kStatusBusError & 1, 1u);
  EXPECT_EQ(card.read(card::kRegFaultAddr),
            card::kFaultSpace(card::kSpaceDdr) | card::kFaultAddr(36'000));
}

/// The bridge does not check space numbers. An unknown number reaches the card, which refuses it.
TEST(PciCardTest, UnknownSpaces_AreRefused) {
  PciCard card("ideal");
  const std::vector<std::uint8_t> before(64, 0xC3);
  for (std::uint32_t number = card::kSpaces; number < 1u << card::kSpaceBits; ++number) {
    SCOPED_TRACE(number);
    for (const bool to_host : {false, true}) {
      card.put(PciCard::kTriangles, before);
      EXPECT_EQ(
          card.transfer(PciCard::kTriangles, 64, static_cast<card::Space>(number), 0x1230, to_host)
              .code,
          pci::kCodeOk);
      card.pass(1'000'000);
      EXPECT_EQ(card.read(card::kRegStatus), 1u << card::kStatusBusError | 1u << card::kStatusIrq);
      EXPECT_EQ(card.read(card::kRegFaultAddr),
                card::kFaultSpace(number) | card::kFaultAddr(0x1230));
      EXPECT_EQ(card.get(PciCard::kTriangles, 64),
                to_host ? std::vector<std::uint8_t>(64, 0) : before);
      card.write(card::kRegControl, card::kControlClear);
      EXPECT_EQ(card.read(card::kRegStatus), 0u);
    }
  }
}

}  // namespace
}  // namespace cde::testing
