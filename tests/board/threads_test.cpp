// SPDX-License-Identifier: Apache-2.0
// Boards in threads, and software in parallel. The preset `tsan` runs these tests with
// ThreadSanitizer in the driver and the tests. The code of simulation models is not instrumented.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <thread>

#include "cases.hpp"
#include "cde/scene/scene_runner.hpp"

namespace cde::testing {
namespace {

TEST(Threads, BoardsInThreads_AreIndependent) {
  Random random;
  const std::array<RayScene, 2> scenes = {cloud(random, 512, 500), cloud(random, 512, 500)};
  std::vector<std::thread> threads;
  std::array<std::vector<Record>, 2> results;
  for (std::size_t i = 0; i < 2; ++i) {
    threads.emplace_back([&, i] {
      Board board = Board::open(host_config());
      board.upload(scenes[i].triangles);
      results[i] = board.cast(scenes[i].rays);
    });
  }
  for (auto& t : threads) t.join();
  for (std::size_t i = 0; i < 2; ++i) {
    reference::Checker checker(scenes[i].rays, scenes[i].triangles, Mode::kNearest, {}, 256, "");
    checker.check(results[i]);
    checker.finish();
    EXPECT_EQ(checker.compared(), 512u);
  }
}

/// The Verilated model keeps its context in a thread-local variable. With assertions, closing a
/// board after another board of the same thread must not crash.
TEST(Threads, Boards_CloseInAnyOrderAndThread) {
  Random random;
  const RayScene scene = cloud(random, 20, 20);
  for (const bool first_goes_first : {true, false}) {
    auto first = std::make_unique<Board>(Board::open(host_config()));
    auto second = std::make_unique<Board>(Board::open(host_config()));
    cast_and_compare(*second, scene, {});
    cast_and_compare(*first, scene, {});
    (first_goes_first ? first : second).reset();
    cast_and_compare(first_goes_first ? *second : *first, scene, {});
    std::thread([&] { (first_goes_first ? second : first).reset(); }).join();
  }
  Board moved = Board::open(host_config());
  moved = Board::open(small_config());
  EXPECT_EQ(cast_and_compare(moved, scene, {}).size(), 20u);
}

/// Every driver operation on two kinds of boards in parallel: faults, retries, errors, resets, and
/// the first opening of a model by both threads.
TEST(Threads, BoardsOfEveryKind_RunInParallel) {
  const std::array<BoardConfig, 4> kinds = {small_config(), host_config(), small_config(),
                                            rich_config(Bus::kFunctional)};
  std::array<std::uint64_t, 4> records{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    threads.emplace_back([&, i] {
      Random random(static_cast<std::uint32_t>(100 + i));
      for (unsigned round = 0; round < 4; ++round) {
        Board board = Board::open(kinds[i]);
        const RayScene scene = beam(random, 60, 40);
        const Query query{.mode = round % 2 == 0 ? Mode::kAll : Mode::kNearest,
                          .pair = Pair::kRayTriangle};
        records[i] += cast_and_compare(board, scene, query).size();
        board.inject(BusFault::kNoAnswer, kUntilReset);
        EXPECT_THROW(board.load(scene.rays), Error);
        board.reset();
        records[i] += cast_and_compare(board, scene, query).size();
        EXPECT_THROW(board.run(query, RecordSink()), Error);
      }
    });
  }
  for (auto& t : threads) t.join();
  for (const std::uint64_t n : records) EXPECT_EQ(n, 2u * 2 * (2400 + 60));
}

/// Scenes are read, planned and run in parallel.
TEST(Threads, SceneRunners_AreIndependent) {
  std::array<std::uint64_t, 2> compared{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < compared.size(); ++i) {
    threads.emplace_back([&, i] {
      const auto scene = parse_scene(
          "frames = 3\n[[object]]\nname = \"a\"\nrandom = { shape = \"sphere\", count = 60, min = "
          "[-2, -2, -2], max = [2, 2, 2], size = [0.1, 0.7] }\nmotion = { kind = \"velocity\", "
          "linear = [1, 2, 3] }\n[[query]]\nname = \"q\"\npair = \"sphere-sphere\"\nprimaries = "
          "\"a\"\nsecondaries = \"a\"\nmode = \"all\"\n",
          "s.toml");
      Plan p = plan(scene);
      p.board = {.lanes = 8,
                 .pairs = {Pair::kSphereSphere},
                 .swap = true,
                 .normals = true,
                 .ddr_slots = 1000,
                 .sram_records = 64};
      p.card_moves.assign(1, false);
      p.card_moves_primaries.assign(1, false);
      SceneRunner runner(scene, p, {});
      for (std::uint32_t f = 0; f < 3; ++f) {
        const auto frame = runner.run_frame(f);
        EXPECT_EQ(frame[0].mismatches, 0u) << frame[0].first_mismatch;
        compared[i] += frame[0].compared;
      }
    });
  }
  for (auto& t : threads) t.join();
  for (const std::uint64_t n : compared) EXPECT_EQ(n, 3u * 60 * 59 / 2);
}

}  // namespace
}  // namespace cde::testing
