// SPDX-License-Identifier: Apache-2.0
// Scenes whose objects the card's transformer moves: every record equals the reference, and the
// upload of each frame has the expected size.
#include "cde/scene/scene_runner.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

#include "board_configs.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

const std::string kTurning =
    "motion = { kind = \"velocity\", linear = [3, -2, 1], angular = [20, 30, 40] }\n";

/// The model of the object tests has every pipe of these scenes and a small DDR.
Plan planned(const Scene& scene) {
  Plan p = plan(scene);
  p.board = BoardConfig{};
  p.board.lanes = 8;
  p.board.pairs = {Pair::kRayTriangle, Pair::kSphereSphere, Pair::kRayCylinder, Pair::kObbPlane};
  p.board.swap = true;
  p.board.transform = Transformer::kBoth;
  p.board.ddr_slots = 4000;
  p.board.sram_records = 1024;
  return p;
}

/// Runs a scene frame by frame and compares every record.
class SceneRun {
 public:
  explicit SceneRun(const std::string& text)
      : scene_(parse_scene("frames = 100\n" + text, "s.toml")),
        plan_(planned(scene_)),
        runner_(scene_, plan_, {}) {}

  std::vector<QueryFrame> frame(std::uint32_t number) {
    SCOPED_TRACE(fmt::format("frame {}", number));
    const std::uint64_t before = runner_.board().words_uploaded();
    auto results = runner_.run_frame(number, [&](std::size_t query, std::span<const Record> some) {
      if (query >= records_.size()) records_.resize(query + 1);
      records_[query].insert(records_[query].end(), some.begin(), some.end());
    });
    std::uint64_t words = 0;
    for (const QueryFrame& f : results) {
      EXPECT_EQ(f.mismatches, 0u) << f.first_mismatch;
      EXPECT_EQ(f.compared, f.counters.records);
      EXPECT_GT(f.compared, 0u);
      words += f.secondary_words + f.primary_words;
      hits_ += f.hits;
    }
    EXPECT_EQ(runner_.board().words_uploaded() - before, words) << "words counted by the board";
    return results;
  }
  /// Words uploaded for query 0.
  std::uint64_t secondary_words(std::uint32_t number) { return frame(number)[0].secondary_words; }
  std::uint64_t primary_words(std::uint32_t number) { return frame(number)[0].primary_words; }

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  std::vector<std::vector<Record>> take() { return std::exchange(records_, {}); }

 private:
  Scene scene_;
  Plan plan_;
  SceneRunner runner_;
  std::uint64_t hits_ = 0;
  std::vector<std::vector<Record>> records_;
};

const std::string kRays =
    "[[object]]\nname = \"rays\"\n"
    "random_rays = { count = 300, seed = 7, redraw = false, half_angle = 80 }\n"
    "motion = { kind = \"still\", position = [5, 4, 30] }\n";
const std::string kBand =
    "deform = { kind = \"wave\", vertices = [20, 45], amplitude = [0, 0, 5], period = 1, "
    "wavelength = 40 }\n";

std::string terrain(const char* name, const std::string& more) {
  return fmt::format("[[object]]\nname = \"{}\"\nmesh = \"terrain:12,9,3\"\nscale = 0.1\n{}", name,
                     more);
}
std::string query(const char* name, const std::string& secondaries, const std::string& more = "") {
  return fmt::format(
      "[[query]]\nname = \"{}\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\n"
      "secondaries = {}\n{}",
      name, secondaries, more);
}

TEST(SceneRunnerMoves, MovedObject_CostsTwelveWords) {
  SceneRun ran(terrain("still", "") + terrain("moving", kTurning) +
               terrain("child",
                       "parent = \"moving\"\nmotion = { kind = \"velocity\", position = "
                       "[0, 0, -30], angular = [0, 90, 0] }\n") +
               kRays + query("hit", R"(["still", "moving", "child"])", "mask = [3, \"10..40\"]\n"));
  EXPECT_EQ(ran.plan().card_moves, (std::vector<bool>{false, true, true, false}));
  EXPECT_EQ(ran.plan().queries[0].moved_words, 24u);
  EXPECT_EQ(ran.secondary_words(0), 3u * 216 * 9 + 3 * 14);
  for (const std::uint32_t f : {1u, 2u, 50u, 3u}) EXPECT_EQ(ran.secondary_words(f), 24u);
  EXPECT_EQ(ran.secondary_words(3), 0u) << "the frame is repeated";
  EXPECT_GT(ran.hits(), 100u);
}

/// The host updates vertices in the object's frame; the object table holds the pose.
TEST(SceneRunnerMoves, DeformingMovingMesh_CostsChangedVerticesAndAPose) {
  SceneRun ran(terrain("heaving", kBand) + terrain("both", kBand + kTurning) + kRays +
               query("hit", R"(["heaving", "both"])"));
  const std::uint64_t moved = ran.plan().queries[0].moved_words;
  EXPECT_EQ(ran.plan().card_moves, (std::vector<bool>{false, true, false}));
  EXPECT_LT(moved, 216u * 9);
  EXPECT_EQ(ran.secondary_words(0), 2u * 216 * 9 + 2 * 14);
  for (const std::uint32_t f : {1u, 2u, 7u}) {
    const std::uint64_t words = ran.secondary_words(f);
    EXPECT_GE(words, moved);
    EXPECT_LE(words, moved + 40) << "ranges are rounded up to whole beats";
  }
  EXPECT_GT(ran.hits(), 50u);
}

/// Transforms on the host and on the card give bit-identical records.
TEST(SceneRunnerMoves, HostTransforms_GiveTheSameRecords) {
  const std::string scene = terrain("moving", kTurning) + terrain("still", "") + kRays +
                            query("hit", R"(["moving", "still"])");
  SceneRun card(scene), host("[card]\ntransform_site = \"host\"\n" + scene);
  EXPECT_EQ(host.plan().card_moves, std::vector<bool>(3, false));
  for (const std::uint32_t f : {0u, 5u, 9u}) {
    EXPECT_EQ(card.secondary_words(f), f == 0 ? 2u * 216 * 9 + 28 : 12u);
    EXPECT_EQ(host.secondary_words(f), f == 0 ? 2u * 216 * 9 : 216u * 9);
    const auto a = card.take(), b = host.take();
    ASSERT_EQ(a[0].size(), b[0].size());
    for (std::size_t i = 0; i < a[0].size(); ++i) EXPECT_TRUE(same_bits(a[0][i], b[0][i])) << i;
  }
}

TEST(SceneRunnerMoves, StoppedObject_CostsNothing) {
  SceneRun ran(terrain("path",
                       "motion = { kind = \"path\", points = [[0, 0, 0], [4, 0, 0]], duration = "
                       "0.1 }\n") +
               terrain("moving", kTurning) + kRays + query("hit", R"(["path", "moving"])"));
  EXPECT_EQ(ran.secondary_words(0), 2u * 216 * 9 + 28);
  EXPECT_EQ(ran.secondary_words(2), 24u);
  EXPECT_EQ(ran.secondary_words(50), 24u);
  EXPECT_EQ(ran.secondary_words(60), 12u) << "one of two objects still moves";
}

/// Each query has other objects in DDR: all are written again, and the records stay correct.
TEST(SceneRunnerMoves, QueriesOfDifferentObjects_GiveCorrectRecords) {
  const std::string scene = terrain("a", kTurning) + terrain("b", kBand + "parent = \"a\"\n") +
                            kRays + query("one", R"(["b", "a"])") +
                            query("two", "\"a\"", "mode = \"hits\"\nmask = [\"0..250\"]\n") +
                            query("three", "\"a\"", "mode = \"any\"\n");
  EXPECT_EQ(plan(parse_scene("frames = 9\n" + scene, "s.toml")).board.transform, Transformer::kNone)
      << "transforms on the card would save no words";
  SceneRun ran("[card]\ntransform_site = \"card\"\n" + scene);
  for (const std::uint32_t f : {0u, 1u, 2u}) {
    const auto results = ran.frame(f);
    EXPECT_EQ(results[0].secondary_words, 2u * 216 * 9 + 28);
    EXPECT_EQ(results[1].secondary_words, 216u * 9 + 14);
    EXPECT_EQ(results[2].secondary_words, 0u) << "same objects as the previous query";
  }
  EXPECT_GT(ran.hits(), 50u);
}

std::string shapes(const char* name, const char* shape, int count, const std::string& motion) {
  const bool sized = std::string(shape) != "plane";
  return fmt::format(
      "[[object]]\nname = \"{}\"\nrandom = {{ shape = \"{}\", count = {}, seed = 5, "
      "min = [-3, -3, -3], max = [3, 3, 3]{} }}\n{}",
      name, shape, count, sized ? ", size = [0.2, 0.9]" : "", motion);
}
const std::string kEach =
    "motion = { kind = \"random\", each = true, min = [-3, -3, -3], max = [3, 3, 3], speed = 2, "
    "spin = 90, seed = 3 }\n";
std::string boxes_and_planes(const char* primaries, const char* secondaries) {
  return fmt::format(
      "[[query]]\nname = \"q\"\npair = \"obb-plane\"\nprimaries = {}\nsecondaries = {}\n"
      "mode = \"all\"\n",
      primaries, secondaries);
}

/// A box has 15 words and a sphere has 4. A transform per box is therefore cheaper, and a transform
/// per sphere is not.
TEST(SceneRunnerMoves, SeparatelyMovingShapes_UseTheCheaperTransform) {
  SceneRun boxes(shapes("boxes", "obb", 40, kEach) + shapes("planes", "plane", 9, "") +
                 boxes_and_planes("\"planes\"", "\"boxes\""));
  EXPECT_EQ(boxes.secondary_words(0), 40u * (15 + 14));
  EXPECT_EQ(boxes.secondary_words(1), 40u * 12);
  EXPECT_EQ(boxes.secondary_words(2), 40u * 12);
  EXPECT_GT(boxes.hits(), 100u);

  const std::string balls =
      shapes("balls", "sphere", 40, kEach) + shapes("cloud", "sphere", 20, kTurning) +
      "[[query]]\nname = \"q\"\npair = \"sphere-sphere\"\n"
      "primaries = \"balls\"\nsecondaries = [\"balls\", \"cloud\"]\n"
      "self = true\n";  // otherwise passes are ranges, and the host moves the objects
  SceneRun mixed(balls);
  EXPECT_EQ(mixed.plan().card_moves, (std::vector<bool>{false, true}));
  EXPECT_EQ(mixed.secondary_words(0), 60u * 4 + 2 * 14) << "the balls stay one object";
  EXPECT_EQ(mixed.secondary_words(1), 40u * 4 + 12);
  SceneRun forced("[card]\ntransform_site = \"card\"\n" + balls);
  EXPECT_EQ(forced.secondary_words(0), 60u * 4 + 41 * 14);
  EXPECT_EQ(forced.secondary_words(1), 41u * 12);
}

/// Primaries that fit one packet stay in the register file.
TEST(SceneRunnerMoves, PrimariesOfOnePacket_StayLoaded) {
  SceneRun ran(shapes("robot", "obb", 30, kTurning) + shapes("base", "obb", 5, "") +
               shapes("hand", "obb", 3, "parent = \"robot\"\n" + kEach) +
               shapes("planes", "plane", 9, kTurning) +
               boxes_and_planes(R"(["base", "robot", "hand"])", "\"planes\""));
  EXPECT_EQ(ran.plan().card_moves_primaries, (std::vector<bool>{true, false, true, false}));
  EXPECT_EQ(ran.primary_words(0), 38u * 16 + 4 * 14);
  EXPECT_EQ(ran.primary_words(1), 4u * 12);
  const auto results = ran.frame(7);
  EXPECT_EQ(results[0].primary_words, 4u * 12);
  EXPECT_EQ(results[0].secondary_words, 12u);
  EXPECT_EQ(ran.primary_words(7), 0u);
  EXPECT_GT(ran.hits(), 100u);
}

/// Primaries that do not move are loaded once, for all pairs.
TEST(SceneRunnerMoves, UnmovedPrimaries_AreLoadedOnce) {
  SceneRun ran("[[object]]\nname = \"rays\"\nrandom_rays = { count = 200, redraw = false }\n" +
               terrain("ground", "") + shapes("pipes", "cylinder", 30, kEach) +
               query("ground", "\"ground\"") +
               "[[query]]\nname = \"pipes\"\npair = \"ray-cylinder\"\nprimaries = \"rays\"\n"
               "secondaries = \"pipes\"\nmode = \"all\"\n");
  EXPECT_EQ(ran.primary_words(0), 200u * 16)
      << "slots have the size of the card's largest primary, a box";
  for (const QueryFrame& f : ran.frame(1)) {
    EXPECT_EQ(f.primary_words, 0u);
    EXPECT_EQ(f.primary_cycles, 0u);
    EXPECT_EQ(f.counters.upload_cycles, 0u);
    EXPECT_EQ(f.counters.total_cycles,
              f.counters.cycles + f.counters.writeback + f.download_cycles);
  }
  EXPECT_GT(ran.hits(), 100u);
}

/// An error in the middle of a frame leaves a card that can run the next frame.
TEST(SceneRunnerMoves, ErrorInAFrame_NextFrameRuns) {
  const Scene scene = parse_scene(
      "frames = 9\n" + terrain("moving", kTurning) + kRays + query("hit", "\"moving\""), "s.toml");
  bool stop = false;
  SceneRunner runner(scene, planned(scene), {.progress = [&](std::uint32_t, double) {
                       if (stop) throw Error(ErrorCode::kUsage, "stopped");
                     }});
  EXPECT_EQ(runner.run_frame(0)[0].mismatches, 0u);
  stop = true;
  EXPECT_THROW((void)runner.run_frame(1), Error);
  stop = false;
  EXPECT_EQ(runner.run_frame(2)[0].mismatches, 0u);
  EXPECT_EQ(runner.run_frame(0)[0].mismatches, 0u);
}

// ---- Wrong bits in DDR ----

class SceneRunnerFlips : public ::testing::Test {
 protected:
  SceneRunner open(bool ecc, const char* fault) {
    Plan p = plan(scene_);
    p.board = small_config();
    p.board.ecc = ecc;
    return {scene_, p, {.faults = {fault_of(fault)}}};
  }
  Scene scene_ = parse_scene("frames = 4\n" + terrain("ground", "") + kRays +
                                 query("hit", "\"ground\"", "mode = \"all\"\n"),
                             "s.toml");
};

TEST_F(SceneRunnerFlips, OneBit_IsCorrectedAndCounted) {
  SceneRunner runner = open(true, "ddr:17@1");
  for (const std::uint32_t f : {0u, 1u, 2u}) {
    const QueryFrame result = runner.run_frame(f)[0];
    EXPECT_EQ(result.mismatches, 0u) << result.first_mismatch;
    EXPECT_EQ(result.counters.corrected_words, f == 0 ? 0u : 2u * 17) << "one word per pass";
  }
  EXPECT_EQ(runner.injected(), std::vector<bool>{true});
}

TEST_F(SceneRunnerFlips, TwoBits_GiveOneError) {
  SceneRunner runner = open(true, "ddr:3:2@1");
  EXPECT_EQ(runner.run_frame(0)[0].mismatches, 0u);
  try {
    (void)runner.run_frame(1);
    FAIL() << "the check bits found no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kDevice);
    EXPECT_NE(std::string(error.what()).find("3 words of DDR have uncorrectable errors"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(SceneRunnerFlips, WithoutCheckBits_ReferenceFindsTheFlip) {
  SceneRunner runner = open(false, "ddr:200:20@1");
  EXPECT_EQ(runner.run_frame(0)[0].mismatches, 0u);
  EXPECT_GT(runner.run_frame(1)[0].mismatches, 0u);
}

TEST_F(SceneRunnerFlips, FlipBeyondTheData_IsRefused) {
  SceneRunner runner = open(false, "ddr:1945@0");
  EXPECT_THROW((void)runner.run_frame(0), Error);
}

}  // namespace
}  // namespace cde::testing
