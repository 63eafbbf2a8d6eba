// SPDX-License-Identifier: Apache-2.0
// Text of faults that are ordered for a frame of a scene.
#include "cde/card/fault.hpp"

#include "testing.hpp"

namespace cde::testing {
namespace {

TEST(ScheduledFaults, Text_ParsesToItsFault) {
  const ScheduledFault parity = fault_of("parity:3:7@12");
  EXPECT_EQ(parity.bus, BusFault::kParity);
  EXPECT_EQ(parity.count, 3u);
  EXPECT_EQ(parity.value, 7u);
  EXPECT_EQ(parity.frame, 12u);
  const ScheduledFault ddr = fault_of("ddr@0");
  EXPECT_FALSE(ddr.bus);
  EXPECT_EQ(ddr.count, 1u);
  EXPECT_EQ(ddr.value, 1u);
  EXPECT_EQ(fault_of("target-abort:all:0@1").count, kUntilReset);
  for (const char* text : {"parity:3:7@12", "ddr:9:32@4294967295", "target-abort:all:0@1",
                           "disconnect-empty:1:1@0", "retry:20@1", "hang:all@7"})
    EXPECT_EQ(text_of(fault_of(text)), text);
  for (std::uint32_t i = 0; i < kBusFaults; ++i) {
    const auto kind = static_cast<BusFault>(i);
    EXPECT_EQ(fault_of(std::string(name_of(kind)) + "@3").bus, kind);
  }
}

TEST(ScheduledFaults, Mistakes_AreNamed) {
  const auto refused = [](const char* text, const char* why) {
    SCOPED_TRACE(text);
    expect_error(ErrorCode::kUsage, why, [&] { (void)fault_of(text); });
  };
  for (const char* text : {"", "parity", "parity:1:2:3@4", "parity@1@2", "parity:1:2"})
    refused(text, "it must be KIND[:COUNT[:VALUE]]@FRAME");
  refused("partiy@1", "there is no kind 'partiy'; it must be one of retry, slow, disconnect, ");
  refused("@1", "there is no kind ''");
  refused("parity@", "FRAME is ''; it must be a whole number from 0 on");
  refused("parity@-1", "FRAME is '-1'");
  refused("parity@4294967296", "FRAME is '4294967296'");
  refused("parity:0@1", "COUNT is '0'; it must be a whole number from 1 on");
  refused("parity:x@1", "COUNT is 'x'");
  refused("parity:@1", "COUNT is ''");
  refused("parity:1:@1", "VALUE is ''");
  refused("ddr:all@1", "COUNT is 'all'");
  refused("ddr:1:0@1", "VALUE is 0; a word of DDR can have 1 to 32 wrong bits");
  refused("ddr:1:33@1", "VALUE is 33");
  for (const char* kind :
       {"retry", "master-abort", "lost-interrupt", "no-answer", "no-grant", "hang"})
    refused((kind + std::string(":1:5000@1")).c_str(),
            (kind + std::string(" takes no VALUE; it must be KIND[:COUNT]@FRAME")).c_str());
}

TEST(ScheduledFaults, UnsupportingBus_IsRefused) {
  BoardConfig board;
  EXPECT_NO_THROW(check_fault(fault_of("ddr:3@0"), board));
  expect_error(ErrorCode::kUsage,
               "fault 'retry:1@2': the functional bus has no such fault; it needs bus = "
               "\"cycle\"",
               [&] { check_fault(fault_of("retry@2"), board); });
  board.bus = Bus::kCycle;
  EXPECT_NO_THROW(check_fault(fault_of("retry@2"), board));
}

}  // namespace
}  // namespace cde::testing
