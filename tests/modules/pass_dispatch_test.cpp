// SPDX-License-Identifier: Apache-2.0
// Passes handed to three units with random ready times and durations. Some passes are aborted
// before or after they began.
#include <gtest/gtest.h>

#include <array>

#include "PassDispatch.h"
#include "PassDispatchOne.h"
#include "clocked.hpp"

namespace cde::testing {
namespace {

constexpr unsigned kUnits = 3;  // as in CMakeLists.txt

TEST(PassDispatch, EveryPass_RunsOnceOnItsUnit) {
  Clocked<PassDispatch> dispatch;
  Dice dice;
  struct Unit {
    unsigned left = 0, started = 0, done = 0, aborted = 0;  // cycles left; numbers of passes
  };
  std::array<Unit, kUnits> units;
  unsigned waiting = 0;  // bit of the unit whose pass is requested but not begun
  unsigned asked = 0, dones = 0, dropped = 0, at_once = 0, waited = 0, idle_aborts = 0;
  dispatch->rst_i = 1;
  dispatch->go_i = 0;
  dispatch.clock();
  dispatch->rst_i = 0;
  for (int clock = 0; clock < 20'000; ++clock) {
    unsigned busy = 0, done = 0, ready = 0;
    for (unsigned u = 0; u < kUnits; ++u) {
      busy |= unsigned{units.at(u).left != 0} << u;
      done |= unsigned{units.at(u).left == 1} << u;
      ready |= unsigned{units.at(u).left == 0 && dice.once_in(4)} << u;
    }
    const bool free = busy == 0 && waiting == 0;
    const bool go = free && dice.once_in(3), abort = dice.once_in(20);
    dispatch->go_i = go;
    dispatch->unit_i = static_cast<CData>(dice.below(kUnits));
    dispatch->abort_i = abort;
    dispatch->ready_i = static_cast<CData>(ready);
    dispatch->busy_i = static_cast<CData>(busy);
    dispatch->done_i = static_cast<CData>(done);
    dispatch.settle();

    // An abort applies to earlier requests.
    if (abort && waiting != 0) {
      waiting = 0;
      ++dropped;
      ASSERT_EQ(dispatch->busy_o, 1u);
    } else {
      ASSERT_EQ(dispatch->busy_o, unsigned{!free}) << "cycle " << clock;
    }
    idle_aborts += abort && free;
    if (go) waiting = 1u << dispatch->unit_i, ++asked;
    ASSERT_EQ(dispatch->valid_o, waiting) << "cycle " << clock;
    ASSERT_EQ(dispatch->done_o, unsigned{done != 0});
    ASSERT_EQ(dispatch->abort_o, abort ? (1u << kUnits) - 1 : 0u);
    for (unsigned u = 0; u < kUnits; ++u) {
      Unit& unit = units.at(u);
      if (unit.left != 0) {
        --unit.left;
        if (unit.left == 0) {
          ++unit.done, ++dones;
        } else if (abort) {
          unit.left = 0, ++unit.aborted;
        }
      } else if (((waiting & ready) >> u & 1) != 0) {
        ++(go ? at_once : waited);
        ++unit.started;
        unit.left = 1 + dice.below(30);
        waiting = 0;
      }
    }
    dispatch.clock();
  }
  unsigned started = 0;
  for (const Unit& unit : units) {
    EXPECT_GT(unit.started, 100u);
    EXPECT_GT(unit.aborted, 20u);
    EXPECT_GT(unit.done, 50u);
    EXPECT_EQ(unit.started, unit.done + unit.aborted + (unit.left != 0));
    started += unit.started;
  }
  EXPECT_EQ(asked, started + dropped + (waiting != 0));
  EXPECT_GT(dropped, 20u);
  EXPECT_GT(at_once, 50u);
  EXPECT_GT(waited, 100u);
  EXPECT_GT(idle_aborts, 50u);
}

/// With one unit there is no delay and no state between the registers and the engine.
TEST(PassDispatch, OneUnit_IsWiredThrough) {
  Clocked<PassDispatchOne> dispatch;
  Dice dice;
  unsigned gos = 0, busies = 0;
  for (int i = 0; i < 1000; ++i) {
    dispatch->rst_i = dice.once_in(50);
    dispatch->busy_i = dice.once_in(2);
    dispatch->ready_i = !dispatch->busy_i;
    dispatch->go_i = !dispatch->busy_i && dice.once_in(2);
    dispatch->unit_i = 0;
    dispatch->abort_i = dice.once_in(4);
    dispatch->done_i = dice.once_in(4);
    dispatch.settle();
    EXPECT_EQ(dispatch->valid_o, dispatch->go_i);
    EXPECT_EQ(dispatch->busy_o, dispatch->busy_i);
    EXPECT_EQ(dispatch->done_o, dispatch->done_i);
    EXPECT_EQ(dispatch->abort_o, dispatch->abort_i);
    gos += dispatch->go_i;
    busies += dispatch->busy_i;
    dispatch.clock();
  }
  EXPECT_TRUE(gos > 150 && busies > 300 && busies < 700);
}

}  // namespace
}  // namespace cde::testing
