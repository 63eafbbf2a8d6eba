// DMA both ways: sizes, alignments, page boundaries, the ring's laps, the address check.
#include "bus_card.hpp"

namespace cde::testing {
namespace {

using card::kSpaceDdr;

TEST(PciDma, BothWaysEverySizeAndPlace) {
  for (const bool narrow : {false, true}) {
    SCOPED_TRACE(narrow);
    BusCard card({.narrow = narrow});
    card.enumerate();
    card.map_range(0, 63);
    card.start_ring();
    Numbers numbers(20240611);
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
        card.api().run(card.handle(), 10'000'000);
        ASSERT_TRUE(std::equal(data.begin(), data.end(), local.begin() + offset));
        ASSERT_EQ(local[offset + bytes], 0xEE);
        card.put(down - 8, std::vector<std::uint8_t>(bytes + 16, 0x55));
        const Result out = card.transfer(down, bytes, kSpaceDdr, offset, true);
        ASSERT_EQ(out.code, pci::kCodeOk);
        ASSERT_EQ(out.bytes, bytes);
        ASSERT_EQ(card.get(down, bytes), data);
        ASSERT_EQ(card.get(down - 8, 8), std::vector<std::uint8_t>(8, 0x55));
        ASSERT_EQ(card.get(down + bytes, 8), std::vector<std::uint8_t>(8, 0x55));
      }
  }
}

}  // namespace
}  // namespace cde::testing
