// SPDX-License-Identifier: Apache-2.0
// The reference devices of docs/devices.json.
#include "cde/model/device.hpp"

#include <gtest/gtest.h>

#include <set>

#include "../expect_error.hpp"

namespace cde {
namespace {

TEST(Devices, Default_IsOneThatCouldExist) {
  EXPECT_NE(default_device().kind, DeviceKind::kIdeal);
  for (const unsigned cycles : cycles_of(default_device().latencies)) EXPECT_GT(cycles, 1u);
}

TEST(Devices, EveryRow_IsACardOfTheRtl) {
  std::set<std::string> names;
  for (const Device& d : devices()) {
    SCOPED_TRACE(d.name);
    EXPECT_TRUE(names.insert(d.name).second);
    EXPECT_FALSE(d.fpga.empty());
    EXPECT_FALSE(d.why.empty());
    const BoardConfig card = on(
        d,
        {.lanes = d.lanes, .format = d.format, .box = true, .traversal_units = d.traversal_units});
    EXPECT_NO_THROW((void)card.parameters());
    EXPECT_EQ(card.latency, d.latencies);
    EXPECT_EQ(card.node_cycles, d.node_cycles);
    EXPECT_LE(d.leaf_lanes(), d.lanes);
    EXPECT_EQ(d.kind == DeviceKind::kIdeal, d.latencies == OperatorLatencies{});
    EXPECT_NEAR(1e12 / d.clock_period_ps(), d.clock_hz(), 1e-3 * d.clock_hz());
  }
}

TEST(Devices, CardWithoutTraversalUnits_HasNoCyclesPerNode) {
  EXPECT_EQ(on(device_named("ecp5-85"), {}).node_cycles, 1u);
}

TEST(Devices, AnotherCardThanThePlacedOne_IsProjected) {
  const Device& d = device_named("ecp5-85");
  ASSERT_EQ(d.kind, DeviceKind::kPlaced);
  const BoardConfig placed = on(d, {.lanes = 1, .box = true});
  EXPECT_EQ(placed.shared_lane, d.shared_lane);
  EXPECT_EQ(device_for(d, placed).text(), d.text());
  BoardConfig gates = placed;
  gates.arithmetic = Arithmetic::kRtl;
  EXPECT_EQ(device_for(d, gates).kind, DeviceKind::kPlaced) << "the same card in gates";
  for (const BoardConfig& other :
       {on(d, {.lanes = 1}), on(d, {.lanes = 2, .box = true}),
        on(d, {.lanes = 1, .pairs = {Pair::kSphereSphere}}),
        on(d, {.lanes = 1, .format = FpFormat::parse("fp16"), .box = true}),
        on(d, {.lanes = 1, .box = true, .ecc = true})}) {
    const Device projected = device_for(d, other);
    EXPECT_EQ(projected.kind, DeviceKind::kProjected);
    EXPECT_TRUE(projected.text().starts_with("ecp5-85 with another card (projected, "))
        << projected.text();
  }
  BoardConfig pinned = placed;
  pinned.pinned_nodes /= 4;
  EXPECT_EQ(device_for(d, pinned).kind, DeviceKind::kProjected);
  BoardConfig few = placed;
  few.nodes = few.pinned_nodes = 256;
  EXPECT_EQ(device_for(d, few).kind, DeviceKind::kPlaced) << "no more nodes fit";
  Device faster = d;
  faster.clock_mhz *= 2;
  EXPECT_EQ(device_for(faster, placed).kind, DeviceKind::kProjected);
  EXPECT_TRUE(device_for(faster, on(faster, {}))
                  .text()
                  .starts_with("ecp5-85 with another card and clock (projected, "));
  EXPECT_EQ(device_for(default_device(), placed).text(), default_device().text());
}

TEST(Devices, Text_NamesWhatIsNotOfTheTable) {
  Device d = device_named("large");
  EXPECT_EQ(d.text(), "large (projected, 100 MHz)");
  d.clock_mhz = 50;
  EXPECT_EQ(d.text(), "large with another clock (projected, 50 MHz)");
  d.latencies.div = 3;
  EXPECT_EQ(d.text(), "large with another clock and latencies (projected, 50 MHz)");
  d.clock_mhz = 100;
  EXPECT_EQ(d.text(), "large with other latencies (projected, 100 MHz)");
  EXPECT_EQ(d.latencies_text(), "9/11/3/32/3");
}

TEST(Devices, UnknownName_IsRefused) {
  testing::expect_error(ErrorCode::kUsage, "there is no device 'huge'; expected one of large, ",
                        [] { (void)device_named("huge"); });
}

}  // namespace
}  // namespace cde
