// SPDX-License-Identifier: Apache-2.0
// Cards with other number formats than fp32: every record equals the reference in the card's
// format.
#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "../expect_error.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/reference/pass.hpp"
#include "moving_cases.hpp"

namespace cde::testing {
namespace {

constexpr FpFormat kFp16{5, 10}, kBf16{8, 7}, kTf32{8, 10}, kFp24{7, 16}, kFp64{11, 52};

struct Kind {
  const char* name;
  FpFormat format;
  std::vector<Pair> pairs;
  unsigned lanes;
  bool moves = true;
  Arithmetic arithmetic = Arithmetic::kHost;

  friend void PrintTo(const Kind& k, std::ostream* out) { *out << k.name; }
};

/// The card of `cde cast --format fp16 --lanes 4`.
const Kind kFp16Rays{"Fp16", kFp16, {Pair::kRayTriangle}, 4, false};
const Kind kBf16Solids{"Bf16", kBf16, {Pair::kSphereSphere, Pair::kObbPlane}, 4};
const Kind kTf32Rays{"Tf32", kTf32, {Pair::kRayTriangle, Pair::kRayCylinder}, 4};
const Kind kFp24Solids{"Fp24", kFp24, {Pair::kTriangleSphere, Pair::kSphereObb}, 4};
const Kind kFp16Gates{"Fp16Gates", kFp16, {Pair::kRayTriangle, Pair::kObbPlane},
                      2,           true,  Arithmetic::kRtl};

BoardConfig config_of(const Kind& kind) {
  BoardConfig c;
  c.lanes = kind.lanes;
  c.arithmetic = kind.arithmetic;
  c.format = kind.format;
  c.pairs = kind.pairs;
  if (!kind.moves) {
    c.box = true;
    return c;
  }
  c.swap = true;
  c.normals = kind.pairs[0] != Pair::kRayTriangle;
  c.transform = Transformer::kBoth;
  c.ddr_slots = 4000;
  c.sram_records = 1024;
  return c;
}

bool is_legal(const Kind& kind, float word, WordKind of) {
  return of != WordKind::kInterval ||
         !std::isfinite(word) == !std::isfinite(kind.format.decode(kind.format.encode(word)));
}

/// Random shapes. In some, one word is at the edge of the format's range, beyond it, special, or
/// halfway between two numbers of the format.
template <class P>
std::vector<P> odd_shapes(const Kind& kind, Random& random, std::size_t count) {
  const LengthRange range = LengthRange::of(kind.format.exp_bits, kind.format.man_bits);
  const float unit = std::ldexp(1.0f, -kind.format.man_bits), inf = INFINITY;
  const float odd[] = {NAN,
                       -inf,
                       inf,
                       -0.0f,
                       std::ldexp(1.0f, range.high),
                       std::ldexp(1.0f + unit, range.high),
                       std::ldexp(1.0f + unit / 4, range.high),
                       std::ldexp(1.0f, range.low),
                       std::ldexp(1.0f, kind.format.emin() - kind.format.man_bits),
                       std::ldexp(1.0f, kind.format.emin()) / 3,
                       1 + unit / 2,
                       1 + 3 * unit / 2,
                       std::nextafter(1 + unit / 2, 2.0f),
                       3e38f};
  std::vector<P> all;
  while (all.size() < count) {
    auto words = to_words(shape<P>(random));
    if (random.below(8) == 0) {
      const std::uint32_t k = random.below(static_cast<std::uint32_t>(words.size()));
      words[k] = odd[random.below(std::size(odd))];
      if (!is_legal(kind, words[k], contract::word_kind(kShapeOf<P>, k))) continue;
    }
    all.push_back(from_words<P>(words));
  }
  return all;
}

/// Objects within the contract. Some translations move their shapes out of the contract.
std::vector<Object> moving_objects(const Kind& kind, Random& random, std::uint32_t slots,
                                   std::size_t count) {
  const LengthRange range = LengthRange::of(kind.format.exp_bits, kind.format.man_bits);
  std::vector<Object> all = objects(random, slots, count, false);
  for (Object& o : all)
    if (o.transform.translation.x() == 0x1p40f)
      o.transform.translation.x() = std::ldexp(1.0f, range.high);
  return all;
}

class CardFormats : public ::testing::TestWithParam<Kind> {
 protected:
  template <class P, class S>
  void check_role(Pair pair, bool swap) {
    const Kind& kind = GetParam();
    for (const std::size_t n : {std::size_t{0}, std::size_t{6}}) {
      const auto primaries = odd_shapes<P>(kind, random_, 40);
      const auto secondaries = odd_shapes<S>(kind, random_, 60);
      if (kind.moves) {
        board_.set_objects({});
        board_.set_primary_objects({});
      }
      board_.upload_shapes(std::span<const S>(secondaries), false);
      board_.load_shapes(std::span<const P>(primaries), false);
      const auto moving = moving_objects(kind, random_, 60, kind.moves ? n : 0);
      const auto posing = moving_objects(kind, random_, 40, kind.moves ? n / 2 : 0);
      if (kind.moves) {
        board_.set_objects(moving);
        board_.set_primary_objects(posing);
      }
      const auto posed = reference::posed(std::span<const P>(primaries),
                                          std::span<const Object>(posing), kind.format);
      const auto tested =
          reference::pass_secondaries(secondaries, std::span<const Object>(moving), kind.format);
      for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kAll, Mode::kHits})
        if (n == 0) check_against_pass(pair, swap, mode, posed, tested.shapes);
      if (kind.moves) check_pass(board_, pair, swap, primaries, secondaries, posing, moving);
    }
  }

  /// Compares the card with reference::Pass, which models swap, normals and the box rule.
  void check_against_pass(Pair pair, bool swap, Mode mode, const Shapes& primaries,
                          const Shapes& secondaries) {
    const BoardConfig config = config_of(GetParam());
    const bool normals = config.normals;
    reference::Pass pass({.pair = pair,
                          .box = config.box,
                          .swap = swap,
                          .mode = mode,
                          .normals = normals,
                          .format = config.format},
                         primaries, in_order(size(primaries)), secondaries);
    std::vector<Record> wanted;
    for (auto some = pass.next(); !some.empty(); some = pass.next())
      wanted.insert(wanted.end(), some.begin(), some.end());
    const auto got = board_.run({.mode = mode, .pair = pair, .swap = swap, .normals = normals});
    compare(got, wanted, mode);
    if (mode != Mode::kAll) return;
    for (const Record& r : got) ++records_, hits_ += r.f ? 1 : 0, bad_ += r.bad ? 1 : 0;
  }

  template <class A, class B>
  void check_roles(Pair pair) {
    check_role<A, B>(pair, false);
    if (GetParam().moves) check_role<B, A>(pair, true);
  }

  Board board_ = Board::open(config_of(GetParam()));
  Random random_;
  std::size_t records_ = 0, hits_ = 0, bad_ = 0;
};

TEST_P(CardFormats, AllPairsAndModes_EqualTheReference) {
  EXPECT_EQ(board_.format(), GetParam().format);
  for (const Pair pair : GetParam().pairs) {
    if (pair == Pair::kRayTriangle) check_roles<Ray, Triangle>(pair);
    if (pair == Pair::kSphereSphere) check_roles<Sphere, Sphere>(pair);
    if (pair == Pair::kObbPlane) check_roles<Obb, Plane>(pair);
    if (pair == Pair::kRayCylinder) check_roles<Ray, Cylinder>(pair);
    if (pair == Pair::kTriangleSphere) check_roles<Triangle, Sphere>(pair);
    if (pair == Pair::kSphereObb) check_roles<Sphere, Obb>(pair);
  }
  fmt::print("{} records of pairs: {} hits, {} bad\n", records_, hits_, bad_);
  EXPECT_GT(hits_, records_ / 50);
  EXPECT_GT(bad_, records_ / 50);
  EXPECT_LT(hits_ + bad_, records_ * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Boards, CardFormats,
                         ::testing::Values(kFp16Rays, kBf16Solids, kTf32Rays, kFp24Solids,
                                           kFp16Gates),
                         [](const auto& info) { return info.param.name; });

/// The reference of a whole cast, with packets, a stencil and the box rule. Its records equal those
/// for the same rays and triangles rounded to the format.
TEST(FormatCast, WholeCast_EqualsTheReference) {
  Board board = Board::open(config_of(kFp16Rays));
  Random random;
  const RayScene scene = beam(random, 300, 80, 3.0f);
  Stencil stencil;
  stencil[3] = stencil[77] = true;
  std::size_t hits = 0, other = 0;
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits, Mode::kAll}) {
    SCOPED_TRACE(name_of(mode));
    board.upload(scene.triangles);
    reference::Checker checker(scene.rays, scene.triangles, mode, stencil, board.primaries(),
                               "cast", {}, true, kFp16);
    Query query{.mode = mode};
    query.stencil = stencil;
    (void)board.cast(scene.rays, query, [&](std::span<const Record> some) {
      checker.compare(some);
      for (const Record& r : some) {
        hits += r.f ? 1 : 0;
        EXPECT_EQ(kFp16.decode(kFp16.encode(r.t)), static_cast<double>(r.t));
      }
    });
    checker.compare_end();
    EXPECT_EQ(checker.matching(), checker.compared()) << checker.difference();
    if (mode != Mode::kNearest) continue;
    const auto wide = reference::cast(scene.rays, scene.triangles, mode, stencil, {}, true);
    const auto narrow =
        reference::cast(scene.rays, scene.triangles, mode, stencil, {}, true, kFp16);
    ASSERT_EQ(wide.size(), narrow.size());
    for (std::size_t i = 0; i < wide.size(); ++i) other += same_bits(wide[i], narrow[i]) ? 0 : 1;
  }
  EXPECT_GT(hits, 10000u);
  EXPECT_GT(other, 100u) << "T in fp16 differs from T in fp32";
}

/// Overlapping objects in any order: the slot breaks ties, not the order of the pass.
TEST(FormatCast, OverlappingObjects_BreakTiesBySlot) {
  Board board = Board::open(config_of(kTf32Rays));
  Random random;
  const MovingRays scene = rays(random, 100, 60);
  board.upload(scene.secondaries);
  const auto moving = moving_objects(kTf32Rays, random, 60, 8);
  board.set_objects(moving);
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits, Mode::kAll}) {
    SCOPED_TRACE(name_of(mode));
    const auto got = board.cast(scene.primaries, {.mode = mode, .pair = Pair::kRayTriangle});
    compare(got,
            reference::cast(scene.primaries, scene.secondaries, mode, {}, moving, false, kTf32),
            mode);
  }
}

TEST(FormatConfig, UnsupportedFormat_IsNamed) {
  BoardConfig c;
  c.format = kFp64;
  expect_error(ErrorCode::kUsage, "a card cannot use fp64: the words of its buses",
               [&] { (void)c.parameters(); });
  c.format = {6, 9};
  expect_error(ErrorCode::kUsage, "a card cannot use e6m9; expected fp16, bf16, tf32, fp24, fp32",
               [&] { (void)c.parameters(); });
  for (const Kind& kind : {kFp16Rays, kBf16Solids, kTf32Rays, kFp24Solids, kFp16Gates}) {
    const auto back = BoardConfig::of(config_of(kind).parameters());
    ASSERT_TRUE(back) << kind.name;
    EXPECT_EQ(back->format, kind.format);
    EXPECT_EQ(back->parameters(), config_of(kind).parameters());
  }
  EXPECT_FALSE(BoardConfig::of({"ARITH=host", "EXP=11", "MAN=52"}));
}

/// The card's number format differs from the requested one.
TEST(FormatConfig, CardOfAnotherFormat_IsRefused) {
  const BoardConfig narrow = config_of(kFp16Rays);
  BoardConfig wide = narrow;
  wide.format = {};
  const auto file = model_path(narrow.top(), narrow.parameters());
  const std::uint64_t hash = model_hash(narrow.top(), narrow.parameters());
  expect_error(ErrorCode::kConfiguration, "exponent width is 5; expected 8",
               [&] { (void)Board::open(wide, {.file = file, .config_hash = hash}); });
}

/// The rounded word decides whether input is valid. No word silently becomes infinite.
TEST(FormatInput, RoundedWords_DecideValidity) {
  Board board = Board::open(config_of(kFp16Rays));
  const Triangle small{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const auto upload = [&](const Triangle& t) {
    const std::vector<Triangle> all{small, t};
    board.upload(all);
  };
  EXPECT_NO_THROW(upload({{0, 0, 128}, {1, 0, 128.03f}, {0, 1, -128}}))
      << "128.03 is rounded to 128";
  expect_error(ErrorCode::kBadInput, "triangle 1: v1.z is 128.125, must be at most 2^7", [&] {
    upload({{0, 0, 1}, {1, 0, 128.1f}, {0, 1, 1}});
  });
  expect_error(ErrorCode::kBadInput, "v1.z is 70000, above the largest number, 65504 in fp16", [&] {
    upload({{0, 0, 1}, {1, 0, 70000}, {0, 1, 1}});
  });
  EXPECT_EQ(defect(Sphere{{0, 0, 0}, 1e-8f}, kFp16), "radius is 0, must be > 0 in fp16");
  EXPECT_EQ(defect(Aabb{{1, 1, 1}, {2, 2, 1.0002f}}, kFp16),
            "max.z is 1, must be > min.z = 1 in fp16");
  EXPECT_EQ(defect(Plane{{0.6f, 0.8f, 0}, 1}, kBf16), std::nullopt);
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, 1}, 0, INFINITY}, kFp16), std::nullopt);

  board.upload(std::vector<Triangle>{small});
  const std::vector<Ray> rays{{{0.25f, 0.25f, 0}, {0, 0, 1}},
                              {{0.25f, 0.25f, 0}, {0, 0, 1}, -INFINITY, 65519},
                              {{0.25f, 0.25f, 70000}, {0, 0, 1}}};
  board.load(rays);
  const auto records = board.run({.mode = Mode::kNearest});
  ASSERT_EQ(records.size(), 3u);
  EXPECT_TRUE(records[0].f && records[1].f && !records[1].bad);
  EXPECT_EQ(records[1].t, 1);
  EXPECT_TRUE(records[2].bad) << "the card flags an origin beyond the format";
  EXPECT_EQ(std::bit_cast<std::uint32_t>(records[2].t), 0x7fc00000u) << "the canonical NaN";
  expect_error(ErrorCode::kBadInput,
               "ray 1: its interval has an end of 65520, beyond the largest number of fp16, 65504",
               [&] {
                 board.load(std::vector<Ray>{rays[0], {{0, 0, 0}, {0, 0, 1}, 0, 65520}});
               });
}

TEST(FormatWords, Words_RoundToNearestAndReadBackExactly) {
  Random random;
  for (const FpFormat format : kPairFormats) {
    if (!is_card_format(format)) continue;
    const FloatWords words(format);
    for (int i = 0; i < 20000; ++i) {
      const auto x = std::bit_cast<float>(random.bits());
      if (std::isnan(x) && format == FpFormat{}) continue;
      const std::uint64_t word = words.encode(x);
      ASSERT_EQ(word, format.encode(x)) << format.name() << " " << x;
      const float back = words.decode(word);
      if (std::isnan(x)) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(back), 0x7fc00000u);
      } else {
        ASSERT_EQ(static_cast<double>(back), format.decode(word)) << format.name() << " " << x;
      }
    }
  }
  const FloatWords fp16(kFp16);
  EXPECT_NE(std::bit_cast<std::uint32_t>(fp16.decode(0xfe00)), 0x7fc00000u);
  EXPECT_NE(std::bit_cast<std::uint32_t>(fp16.decode(0x7e01)), 0x7fc00000u);
  EXPECT_THROW((void)FloatWords(FpFormat{6, 9}), Error);
}

}  // namespace
}  // namespace cde::testing
