// SPDX-License-Identifier: Apache-2.0
// Scenes on the card behind PCI with bus faults: correct records, or one clear error.
#include "cde/scene/scene_runner.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../board/board_configs.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

const char* const kScene = R"(frames = 6
[card]
bus = "cycle"
[[object]]
name = "terrain"
mesh = "terrain:12,9,3"
scale = 0.1
deform = { kind = "wave", vertices = [20, 45], amplitude = [0, 0, 0.5], period = 1, wavelength = 4 }
[[object]]
name = "rays"
random_rays = { count = 70, seed = 7, half_angle = 80 }
motion = { kind = "still", position = [5, 4, 30] }
[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = "terrain"
mode = "all"
)";

class SceneRunnerFaults : public ::testing::Test {
 protected:
  /// The model of the driver's tests: a small DDR, a ring of 64 records.
  static Plan planned(const Scene& scene) {
    Plan p = plan(scene);
    p.board = pci_config();
    return p;
  }
  SceneRunner& open(std::vector<ScheduledFault> faults) {
    return runner_.emplace(scene_, planned(scene_), RunnerOptions{.faults = std::move(faults)});
  }
  void play(std::uint32_t frames) {
    for (std::uint32_t f = 0; f < frames; ++f) {
      const auto results = runner_->run_frame(f);
      ASSERT_EQ(results[0].mismatches, 0u) << results[0].first_mismatch;
      ASSERT_EQ(results[0].compared, 70u * 216);
    }
  }

  Scene scene_ = parse_scene(kScene, "s.toml");
  std::optional<SceneRunner> runner_;
};

TEST_F(SceneRunnerFaults, EveryFaultKind_GivesCorrectRecords) {
  std::vector<ScheduledFault> faults;
  for (const char* text : {"retry:5@1", "slow:9:3@1", "disconnect:4:2@1", "disconnect-empty:4:2@2",
                           "grant:6:1@2", "lost-interrupt:2@2", "parity:2:1@3", "parity:1:5@4",
                           "target-abort:1:0@4", "master-abort@5"})
    faults.push_back(fault_of(text));
  const SceneRunner& runner = open(faults);
  EXPECT_EQ(runner.injected(), std::vector<bool>(10, false));
  play(5);
  std::vector<bool> injected(10, true);
  injected[9] = false;
  EXPECT_EQ(runner.injected(), injected) << "frame 5 has not run yet";
  play(6);
  EXPECT_EQ(runner.injected(), std::vector<bool>(10, true));
  const BusCounters c = runner.board().bus_counters();
  EXPECT_GE(c.lost_interrupts, 1u);
  EXPECT_GE(c.transfer_retries + c.access_retries + c.pass_retries, 3u);
}

TEST_F(SceneRunnerFaults, PersistentFault_IsOneError) {
  SceneRunner& runner = open({fault_of("target-abort:1000:0@2")});
  play(2);
  try {
    (void)runner.run_frame(2);
    FAIL() << "the upload must fail";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kDevice);
    EXPECT_EQ(exit_status(error.code()), 4);
    ASSERT_TRUE(error.fault()) << error.what();
    EXPECT_NE(std::string(error.what()).find("target abort"), std::string::npos) << error.what();
  }
  EXPECT_EQ(runner.injected(), std::vector<bool>{true});
}

TEST_F(SceneRunnerFaults, UnsupportedFault_IsRefusedBeforeTheRun) {
  Plan functional = planned(scene_);
  functional.board.bus = Bus::kFunctional;
  EXPECT_THROW(SceneRunner(scene_, functional, {.faults = {fault_of("retry@0")}}), Error);
}

}  // namespace
}  // namespace cde::testing
