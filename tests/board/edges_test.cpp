// SPDX-License-Identifier: Apache-2.0
// Edge cases of the driver: boards that were moved from, boards that their own sink destroys or
// uses, invalid enumeration values, and empty sinks. Each is an Error with its own code before the
// driver sends anything, and the card stays usable.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "cases.hpp"
#include "cde/card/fp_unit.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/reference/pairs.hpp"

namespace cde::testing {
namespace {

std::string refused(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}
void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

class BoardEdgeCases : public ::testing::Test {
 protected:
  BoardEdgeCases()
      : board(Board::open(rich_config(Bus::kFunctional))), scene(beam(random, 20, 30)) {
    board->upload(scene.triangles);
    board->load(scene.rays);
  }
  void expect_right() {
    const auto got = board->run(query);
    ASSERT_EQ(got.size(), scene.rays.size());
    const auto expected = reference::cast(scene.rays, scene.triangles);
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_TRUE(same_bits(got[i], expected[i])) << i;
  }
  Random random;
  std::optional<Board> board;
  RayScene scene;
  Query query{.pair = Pair::kRayTriangle};
  RecordSink nothing = [](std::span<const Record>) {};
};

TEST_F(BoardEdgeCases, EveryCallAfterMove_IsAnError) {
  Board other = std::move(*board);
  Board& gone = *board;
  std::vector<std::uint64_t> beats{1, 2};
  const std::vector<Object> objects{{.first = 0, .count = 3}};
  const std::vector<std::function<void()>> calls = {
      [&] { gone.upload(scene.triangles); },
      [&] { gone.upload_shapes<Triangle>(scene.triangles); },
      [&] { gone.update_shapes<Triangle>(0, scene.triangles); },
      [&] { gone.set_objects(objects); },
      [&] { gone.move_object(0, {}); },
      [&] { gone.set_primary_objects(objects); },
      [&] { gone.move_primary_object(0, {}); },
      [&] { gone.load(scene.rays); },
      [&] { gone.load_second_shapes<Sphere>(std::vector<Sphere>(1)); },
      [&] { gone.run(query, nothing); },
      [&] { (void)gone.run(query); },
      [&] { gone.cast(scene.rays, query, nothing); },
      [&] { (void)gone.cast(scene.rays, query); },
      [&] { (void)gone.cast({}, query); },
      [&] { gone.reset(); },
      [&] { (void)gone.time_ps(); },
      [&] { (void)gone.bus_counters(); },
      [&] { (void)gone.memory_counters(); },
      [&] { (void)gone.bus_violation(); },
      [&] { gone.inject(BusFault::kHang); },
      [&] { gone.trace_open("waves.fst"); },
      [&] { gone.trace_close(); },
      [&] { (void)gone.lanes(); },
      [&] { (void)gone.primaries(); },
      [&] { (void)gone.capacity(); },
      [&] { (void)gone.sram_records(); },
      [&] { (void)gone.pipe_latency(); },
      [&] { (void)gone.upload_cycles(); },
      [&] { (void)gone.words_uploaded(); },
      [&] { (void)gone.model_path(); },
      [&] { (void)gone.config_hash(); },
      [&] { (void)gone.read_register(card::kRegId); },
      [&] { gone.write_register(card::kRegControl, 0); },
      [&] { gone.bus_write(card::kSpaceDdr, 0, beats); },
      [&] { gone.bus_read(card::kSpaceSram, 0, beats); },
      [&] { gone.wait(10); },
      [&] { (void)gone.cycles(); },
      [&] { gone.flip_ddr(0, 1); },
      [&] { gone.flip_check(0, 1); },
  };
  for (std::size_t i = 0; i < calls.size(); ++i) {
    SCOPED_TRACE(i);
    expect_in("moved from", refused(calls[i]));
  }
  *board = std::move(other);
  expect_right();
}

TEST(MovedFrom, UnitsAndPassesAfterMove_AreErrors) {
  FpUnit fp({5, 10}, Arithmetic::kHost, 4);
  const FpUnit fp_now = std::move(fp);
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { (void)fp.format(); }, [&] { (void)fp.lanes(); },
           [&] { (void)fp.latency(FpOp::kAdd); }, [&] { fp.apply(FpOp::kAdd, {}, {}, {}); },
           [&] { (void)fp.measure(FpOp::kAdd, 0.001); }})
    expect_in("moved from", refused(call));
  EXPECT_EQ(fp_now.format(), (FpFormat{5, 10}));

  PairUnit unit({.pair = Pair::kSphereSphere});
  const PairUnit unit_now = std::move(unit);
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { (void)unit.config(); }, [&] { (void)unit.latency(); },
           [&] { unit.set_iterations({}); }, [&] { unit.test({}, {}, {}); }, [&] { unit.reset(); },
           [&] { unit.open_trace("waves.fst"); }, [&] { unit.close_trace(); }})
    expect_in("moved from", refused(call));
  EXPECT_EQ(unit_now.config().pair, Pair::kSphereSphere);
}

/// When the gap callback throws, rows stay in flight. Their results must not reach the next test.
TEST(PairUnitCallback, ThrowingOrNestedCallback_LeavesNoStaleResult) {
  std::optional<PairUnit> unit(std::in_place, PairConfig{.pair = Pair::kSphereSphere});
  constexpr FpFormat kFp32{8, 23};
  constexpr std::size_t kCount = 100;
  std::vector<std::uint64_t> a, b;
  for (std::size_t i = 0; i < kCount; ++i)
    for (const double x : {0.0, 0.0, 0.0, 1.0}) {
      a.push_back(kFp32.encode(x));
      b.push_back(kFp32.encode(x == 0 ? static_cast<double>(i) / 7 : x));
    }
  std::vector<PairResult> expected(kCount), got(kCount), other(kCount);
  reference::test_pairs(Pair::kSphereSphere, Algorithm::kMoller, kFp32, a, b, expected);
  for (unsigned row = 1; row <= 13; ++row) {
    unsigned calls = 0;
    const auto throws = [&]() -> unsigned {
      if (++calls == row) throw row;
      return 0;
    };
    EXPECT_THROW(unit->test(a, b, got, throws), unsigned) << row;
    const auto few = std::span<const std::uint64_t>(b).first(4);
    EXPECT_EQ(
        unit->test(std::span<const std::uint64_t>(a).first(4), few, std::span(other).first(1)),
        unit->latency());
    EXPECT_EQ(other[0], expected[0]) << row;
  }
  for (const std::function<void()>& work : std::vector<std::function<void()>>{
           [&] { unit->reset(); }, [&] { unit->test(a, b, other); }}) {
    const auto gap = [&]() -> unsigned {
      work();
      return 0;
    };
    expect_in("runs a test()", refused([&] { unit->test(a, b, got, gap); }));
    unit->test(a, b, got);
    EXPECT_EQ(got, expected);
  }
  unsigned calls = 0;
  got.assign(kCount, {});
  unit->test(a, b, got, [&] {
    if (++calls == 3) unit.reset();
    return 0u;
  });
  EXPECT_EQ(got, expected) << "the unit must live until the call returns";
}

/// NaN is not a time: comparisons with NaN are false, so such a watchdog would never fire.
TEST_F(BoardEdgeCases, InvalidWatchdog_IsRefused) {
  for (const double seconds : {std::nan(""), -1.0, -std::numeric_limits<double>::infinity()}) {
    Query q = query;
    q.watchdog = std::chrono::duration<double>(seconds);
    expect_in("watchdog", refused([&] { (void)board->run(q); }));
    expect_in("watchdog", refused([&] { (void)board->cast(scene.rays, q); }));
    expect_in("watchdog",
              refused([&] { (void)Board::open(host_config(), {.watchdog = q.watchdog}); }));
  }
  query.watchdog = std::chrono::duration<double>(std::numeric_limits<double>::infinity());
  expect_right();
}

TEST(ReferenceObjects, ObjectsBeyondTheTriangles_AreRefused) {
  Random random;
  const RayScene scene = beam(random, 4, 30);
  for (const auto& [first, count] : {std::pair{20u, 11u}, {31u, 1u}, {~0u, 2u}, {5u, ~0u - 3}}) {
    const std::vector<Object> objects{{.first = first, .count = count}};
    expect_in("exceeds the 30", refused([&] {
                (void)reference::cast(scene.rays, scene.triangles, Mode::kNearest, {}, objects);
              }));
  }
  const std::vector<Object> all{{.first = 0, .count = 30}};
  EXPECT_EQ(reference::cast(scene.rays, scene.triangles, Mode::kAll, {}, all).size(), 120u);
}

/// The driver touches no register.
TEST_F(BoardEdgeCases, InvalidEnumerations_AreRefusedBeforeAnyAccess) {
  const std::uint64_t before = board->bus_counters().register_accesses;
  for (const unsigned mode : {6u, 9u, 255u}) {
    Query q = query;
    q.mode = static_cast<Mode>(mode);
    expect_in("mode", refused([&] { (void)board->run(q); }));
    expect_in("mode", refused([&] { (void)board->cast(scene.rays, q); }));
    expect_in("mode", refused([&] { (void)name_of(q.mode); }));
  }
  for (const unsigned pair : {kPairs, 40u, 99u, 1u << 31}) {
    const auto none = static_cast<Pair>(pair);
    expect_in("pair", refused([&] { (void)board->run({.pair = none}); }));
    Query q = query;
    q.second = SecondPair{.pair = none};
    expect_in("pair", refused([&] { (void)board->run(q); }));
    expect_in("pair", refused([&] { (void)primary_shape(none); }));
    expect_in("pair", refused([&] { (void)BoardConfig{.pairs = {none}}.parameters(); }));
    expect_in("pair", refused([&] { (void)PairConfig{.pair = none}.parameters(); }));
  }
  (void)refused([&] { (void)board->capacity(static_cast<Shape>(7)); });
  (void)refused([&] { board->inject(static_cast<BusFault>(77)); });
  (void)refused([&] { (void)BoardConfig{.arithmetic = static_cast<Arithmetic>(2)}.parameters(); });
  (void)refused([&] { (void)BoardConfig{.algorithm = static_cast<Algorithm>(4)}.parameters(); });
  (void)refused([&] { (void)BoardConfig{.transform = static_cast<Transformer>(3)}.parameters(); });
  (void)refused([&] { (void)BoardConfig{.bus = static_cast<Bus>(2)}.parameters(); });
  (void)refused([&] { (void)PairConfig{.plane = static_cast<PlaneSide>(2)}.parameters(); });
  (void)refused([&] {
    (void)Board::open(rich_config(Bus::kFunctional), {.memory = static_cast<Memory>(2)});
  });
  (void)refused([&] { (void)fp_reference(static_cast<FpOp>(kFpOps), {8, 23}, 0, 0); });
  (void)refused([&] { (void)reference::cast(scene.rays, scene.triangles, static_cast<Mode>(7)); });
  EXPECT_EQ(board->bus_counters().register_accesses, before);
  expect_right();
}

TEST_F(BoardEdgeCases, EmptySink_IsRefusedBeforeAnyAccess) {
  const std::uint64_t before = board->bus_counters().register_accesses;
  expect_in("sink", refused([&] { board->run(query, RecordSink()); }));
  expect_in("sink", refused([&] { board->cast(scene.rays, query, RecordSink()); }));
  expect_in("sink", refused([&] { board->cast({}, query, RecordSink()); }));
  EXPECT_EQ(board->bus_counters().register_accesses, before);
  expect_right();
}

/// One sink per kind of call that would give the board other work during a pass.
TEST_F(BoardEdgeCases, OtherWorkDuringAPass_IsRefused) {
  const std::vector<std::function<void()>> calls = {
      [&] { board->upload(scene.triangles); },
      [&] { board->update_shapes<Triangle>(0, scene.triangles); },
      [&] { board->load(scene.rays); },
      [&] { board->load_second_shapes<Sphere>(std::vector<Sphere>(1)); },
      [&] { board->set_objects({}); },
      [&] { board->move_object(0, {}); },
      [&] { board->set_primary_objects({}); },
      [&] { board->move_primary_object(0, {}); },
      [&] { (void)board->run(query); },
      [&] { (void)board->cast(scene.rays, query); },
      [&] { board->reset(); },
  };
  for (std::size_t i = 0; i < calls.size(); ++i) {
    SCOPED_TRACE(i);
    expect_in("runs a pass",
              refused([&] { board->run(query, [&](std::span<const Record>) { calls[i](); }); }));
    Query q = query;
    q.mode = Mode::kAll;  // the ring fills, so the sink runs before the pass ends
    q.progress = [&](double) { calls[i](); };
    expect_in("runs a pass", refused([&] { (void)board->run(q); }));
    expect_right();
  }
}

TEST_F(BoardEdgeCases, SinkDestroysItsBoard_EndsThePass) {
  unsigned pieces = 0;
  const RecordSink destroys = [&](std::span<const Record> some) {
    EXPECT_FALSE(some.empty());
    ++pieces;
    board.reset();
  };
  expect_in("destroyed", refused([&] {
              board->run({.mode = Mode::kAll, .pair = Pair::kRayTriangle}, destroys);
            }));
  EXPECT_EQ(pieces, 1u);
  board.emplace(Board::open(rich_config(Bus::kCycle)));
  board->upload(scene.triangles);
  const std::vector<Ray> many(600, scene.rays[0]);
  expect_in("destroyed", refused([&] { board->cast(many, query, destroys); }));
  EXPECT_EQ(pieces, 2u);
  board.emplace(Board::open(rich_config(Bus::kFunctional)));
  board->upload(scene.triangles);
  board->load(scene.rays);
  Query q = query;
  q.mode = Mode::kAll;
  q.progress = [&](double) { board.reset(); };
  expect_in("destroyed", refused([&] { board->run(q, nothing); }));
}

/// Same as destruction: the pass belongs to the replaced board.
TEST_F(BoardEdgeCases, SinkReplacesItsBoard_EndsThePass) {
  expect_in("destroyed", refused([&] {
              board->run(query, [&](std::span<const Record>) {
                *board = Board::open(rich_config(Bus::kFunctional));
              });
            }));
  board->upload(scene.triangles);
  board->load(scene.rays);
  expect_right();
}

TEST_F(BoardEdgeCases, SinkMovesItsBoard_PassContinues) {
  std::optional<Board> other;
  const std::vector<Ray> many(300, scene.rays[0]);
  std::size_t records = 0;
  const RecordSink moves = [&](std::span<const Record> some) {
    records += some.size();
    if (!other) other.emplace(std::move(*board));
  };
  board->run(query, moves);
  EXPECT_EQ(records, scene.rays.size());
  EXPECT_EQ(other->run(query).size(), scene.rays.size());
  *board = std::move(*other);
  other.reset();
  expect_in("moved from", refused([&] { board->cast(many, query, moves); }));
}

/// A pass over a range of secondaries equals a pass over a board that holds only that range.
TEST_F(BoardEdgeCases, RangeOfSecondaries_EqualsABoardWithThatRange) {
  const std::uint64_t first = 7, count = 11;
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits}) {
    SCOPED_TRACE(name_of(mode));
    for (const bool to_the_end : {false, true}) {
      const std::span<const Triangle> all(scene.triangles);
      const auto some = to_the_end ? all.subspan(first) : all.subspan(first, count);
      auto expected = reference::cast(scene.rays, {some}, mode);
      for (Record& r : expected) r.index += r.index == ~0u ? 0 : first;
      Query q = query;
      q.mode = mode;
      q.first_secondary = first;
      q.secondary_count = to_the_end ? 0 : count;
      Counters counters;
      const auto got = board->run(q, &counters);
      ASSERT_EQ(got.size(), expected.size());
      ASSERT_FALSE(got.empty());
      for (std::size_t i = 0; i < got.size(); ++i) EXPECT_TRUE(same_bits(got[i], expected[i])) << i;
      if (mode != Mode::kAny) {
        EXPECT_EQ(counters.secondaries, some.size());
      }
    }
  }
  for (const auto& [from, n] : {std::pair{30u, 0u}, {0u, 31u}, {29u, 2u}, {~0u, ~0u}}) {
    Query q = query;
    q.first_secondary = from, q.secondary_count = n;
    expect_in("exceed the 30 uploaded", refused([&] { (void)board->run(q); }));
  }
  board->set_objects(std::vector<Object>{{.first = 0, .count = 3}});
  Query q = query;
  q.first_secondary = 1;
  expect_in("cannot be combined with objects", refused([&] { (void)board->run(q); }));
}

}  // namespace
}  // namespace cde::testing
