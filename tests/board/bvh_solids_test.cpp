// SPDX-License-Identifier: Apache-2.0
// Spheres, OBBs and triangles against a card's BVH. Records equal the records of the card's own
// brute-force pass and of the reference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "bvh_cards.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "expect_error.hpp"
#include "hard_solids.hpp"

namespace cde::testing {
namespace {

using namespace through;
using hard::kScenes;

constexpr Mode kSolidModes[] = {Mode::kNearest, Mode::kAny, Mode::kHits, Mode::kOccluded};

template <class Solid>
constexpr Pair kPairOf = std::is_same_v<Solid, Sphere> ? Pair::kTriangleSphere
                         : std::is_same_v<Solid, Obb>  ? Pair::kTriangleObb
                                                       : Pair::kTriangleTriangle;

/// Hard solids. Some of them are bad input.
template <class Solid>
std::vector<Solid> hard_solids(const TriangleScene& scene, std::size_t count) {
  hard::Solids draw(scene, 7);
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < count; ++i) {
    const auto kind = static_cast<unsigned>(i % hard::Solids::kKinds);
    if constexpr (std::is_same_v<Solid, Sphere>) {
      solids.push_back(draw.sphere(kind));
      if (i % 61 == 7) solids.back().r = -1;
    } else if constexpr (std::is_same_v<Solid, Triangle>) {
      solids.push_back(draw.triangle(kind));
      if (i % 127 == 9) solids.back().v1.x() = std::numeric_limits<float>::quiet_NaN();
    } else {
      solids.push_back(draw.obb(kind));
      if (i % 61 == 7) solids.back().rotation(1, 2) += 0.25f;
    }
    if constexpr (!std::is_same_v<Solid, Triangle>)
      if (i % 127 == 9) solids.back().c.x() = std::numeric_limits<float>::quiet_NaN();
  }
  return solids;
}

Query query_of(Pair pair, Mode mode, Through through) {
  Query query{.mode = mode, .pair = pair};
  query.swap = pair != Pair::kTriangleTriangle;
  query.through = through;
  return query;
}

/// All modes and scenes of at most `most` triangles, compared with the reference traversal and the
/// card's own brute-force pass.
template <class Solid>
void expect_all(Board& board, std::size_t count, std::size_t most = 2000) {
  std::size_t found = 0;
  for (const auto& one : kScenes) {
    SCOPED_TRACE(one.name);
    const TriangleScene scene = one.make();
    if (scene.size() > most) continue;
    const Bvh bvh = Bvh::build(scene, {.leaf = scene.size() % 2 == 0 ? 1u : 2u});
    board.upload(scene, bvh);
    const std::vector<Solid> solids = hard_solids<Solid>(scene, count);
    for (const Mode mode : kSolidModes) {
      SCOPED_TRACE(name_of(mode));
      Counters c;
      const std::vector<Record> records =
          cast(board, solids, query_of(kPairOf<Solid>, mode, Through::kBvh), &c);
      found += expect_same(records, expected(scene, bvh, solids, mode));
      EXPECT_EQ(c.secondaries, 0u);
      if (mode == Mode::kNearest) {
        reference::Traversal traversal(scene, bvh);
        for (std::uint32_t i = 0; i < solids.size(); ++i) (void)traversal.trace(solids[i], i, mode);
        expect_read(c, traversal.counts(), solids.size());
      }
      expect_same(records,
                  cast(board, solids, query_of(kPairOf<Solid>, mode, Through::kBruteForce)));
    }
  }
  EXPECT_GT(found, 2 * count);
}

const Card kSolids{"solids", solids_config};
const Card kSolidsDdr{"solids_ddr", solids_config, {.memory = Memory::kCycle}};
const Card kMeshes{"meshes", meshes_config}, kSolidsGates{"gates", spheres_gates_config},
    kSpherePairs{"spheres", sphere_pairs_config};

class BvhSolidCards : public ::testing::TestWithParam<Card> {
 protected:
  /// The first count, or the second one with CDE_FULL=1.
  static std::size_t some(std::size_t quick, std::size_t thorough) {
    return std::getenv("CDE_FULL") != nullptr ? thorough : quick;
  }
};
INSTANTIATE_TEST_SUITE_P(Cards, BvhSolidCards,
                         ::testing::Values(kSolids, kSolidsDdr, kSlow, kLate, kMeshes, kSolidsGates,
                                           kSpherePairs, kCached),
                         [](const auto& card) { return std::string(card.param.name); });

/// CDE_FULL=1: 20,000 of each shape on the first card, and of triangles on the card of meshes.
TEST_P(BvhSolidCards, AllSolids_EqualBruteForceAndReference) {
  Board board = Board::open(GetParam().config(), GetParam().options);
  const bool fast = GetParam().name == kSolids.name || GetParam().name == kSpherePairs.name;
  const bool late = GetParam().name == kLate.name;
  if (GetParam().config == spheres_gates_config)
    return expect_all<Sphere>(board, some(10, 60), 300);
  if (GetParam().config == meshes_config) return expect_all<Triangle>(board, some(130, 2500));
  expect_all<Sphere>(board, fast ? some(300, 2500) : late ? 10 : 30);
  if (GetParam().config == solids_config) expect_all<Obb>(board, fast ? some(130, 2500) : 30);
}

/// One card, alternating passes: rays, and solids that take one or two places of the traversal
/// ring.
TEST(BvhForSolids, AlternatingShapes_GiveCorrectRecords) {
  Board board = Board::open(solids_config());
  const TriangleScene scene = kScenes[6].make();
  const Bvh bvh = Bvh::build(scene);
  board.upload(scene, bvh);
  const std::vector<Ray> rays = hard_rays(scene, 5000);
  const std::vector<Sphere> spheres = hard_solids<Sphere>(scene, 5000);
  const std::vector<Obb> boxes = hard_solids<Obb>(scene, 2500);
  for (const Mode mode : {Mode::kNearest, Mode::kOccluded}) {
    const Query query{.mode = mode, .pair = Pair::kRayTriangle, .through = Through::kBvh};
    expect_same(cast(board, boxes, query_of(Pair::kTriangleObb, mode, Through::kBvh)),
                expected(scene, bvh, boxes, mode));
    expect_same(board.cast(rays, query), expected(scene, bvh, rays, mode));
    expect_same(cast(board, spheres, query_of(Pair::kTriangleSphere, mode, Through::kBvh)),
                expected(scene, bvh, spheres, mode));
  }
  Stencil stencil;
  for (std::size_t i = 0; i < stencil.size(); i += 3) stencil[i] = true;
  board.load_shapes<Obb>(std::span(boxes).first(100), false);  // bad boxes among them
  for (const Mode mode : kSolidModes) {
    Query query = query_of(Pair::kTriangleObb, mode, Through::kBruteForce);
    query.stencil = stencil;
    const std::vector<Record> brute_force = board.run(query);
    query.through = Through::kBvh;
    expect_same(board.run(query), brute_force);
  }
}

/// A second record follows each record. A small record ring fills up between the two.
TEST(BvhForSolids, WithNormals_EqualsBruteForce) {
  for (const Card& card : {kSolids, kSolidsDdr}) {
    Board board = Board::open(card.config(), card.options);
    const TriangleScene scene = kScenes[5].make();
    board.upload(scene, Bvh::build(scene));
    const auto compare = [&]<class Solid>(const std::vector<Solid>& solids) {
      std::size_t with = 0;
      for (const Mode mode : kSolidModes) {
        SCOPED_TRACE(name_of(mode));
        Query query = query_of(kPairOf<Solid>, mode, Through::kBruteForce);
        query.normals = true;
        const std::vector<Record> brute_force = cast(board, solids, query);
        query.through = Through::kBvh;
        Counters c;
        const std::vector<Record> records = cast(board, solids, query, &c);
        expect_same(records, brute_force);
        EXPECT_EQ(c.records, records.size());
        for (const Record& r : records) with += r.n.norm() > 0.9f;
      }
      EXPECT_GT(with, solids.size());
    };
    compare(hard_solids<Sphere>(scene, 500));
    compare(hard_solids<Obb>(scene, 200));
  }
}

/// The triangles of one mesh against the triangles of another: one record each, followed by
/// normals.
TEST(BvhForSolids, MeshAgainstMesh_EqualsBruteForce) {
  Board board = Board::open(meshes_config());
  const TriangleScene ground = kScenes[6].make(), ball = hard::icosphere({1, 1, 0.4f}, 0.7f);
  const Bvh bvh = Bvh::build(ground);
  board.upload(ground, bvh);
  for (const Mode mode : kSolidModes) {
    Query query = query_of(Pair::kTriangleTriangle, mode, Through::kBvh);
    const std::vector<Record> records = cast(board, ball, query);
    expect_same(records, expected(ground, bvh, ball, mode));
    query.normals = true;
    const std::vector<Record> with = cast(board, ball, query);
    query.through = Through::kBruteForce;
    expect_same(with, cast(board, ball, query));
  }
}

TEST(BvhForSolids, MovingObjects_EqualBruteForce) {
  Board board = Board::open(solids_config());
  const TriangleScene scene = kScenes[0].make();
  std::vector<Object> objects = {{.first = 0, .count = 640}, {.first = 640, .count = 640}};
  board.upload(scene);
  board.set_objects(objects);
  board.upload(bvh_of(scene, objects));
  hard::Draw draw(3);
  for (int frame = 0; frame < 3; ++frame) {
    const std::vector<Triangle> moved = reference::pass_secondaries(scene, objects).shapes;
    const std::vector<Sphere> spheres = hard_solids<Sphere>(moved, 300);
    const std::vector<Obb> boxes = hard_solids<Obb>(moved, 60);
    const Bvh bvh = Bvh::build(moved);
    for (const Mode mode : kSolidModes) {
      SCOPED_TRACE(name_of(mode));
      expect_same(cast(board, spheres, query_of(Pair::kTriangleSphere, mode, Through::kBvh)),
                  expected(moved, bvh, spheres, mode));
      expect_same(cast(board, boxes, query_of(Pair::kTriangleObb, mode, Through::kBvh)),
                  cast(board, boxes, query_of(Pair::kTriangleObb, mode, Through::kBruteForce)));
    }
    Transform& pose = objects[1].transform;
    pose.rotation = Eigen::Quaternionf(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1))
                        .normalized()
                        .toRotationMatrix();
    pose.translation = draw.point() * 3 + Eigen::Vector3f::Constant(frame == 1 ? 1e5f : 0);
    board.move_object(1, pose);
    board.refit();
  }
}

TEST(BvhForSolids, WhyNotTraversable_NamesTheReason) {
  Board board = Board::open(solids_config());
  const TriangleScene scene = kScenes[2].make();
  board.upload(scene, Bvh::build(scene));
  const auto why = [&](Query query) { return board.why_not_traversable(query).value_or(""); };
  Query query = query_of(Pair::kTriangleSphere, Mode::kNearest, Through::kAuto);
  EXPECT_EQ(why(query), "");
  query.swap = false;
  EXPECT_EQ(why(query), "the BVH is over triangles");
  query = {.pair = Pair::kRayTriangle};
  query.swap = true;
  EXPECT_EQ(why(query), "ray-triangle with its roles swapped cannot traverse a BVH");
  query = query_of(Pair::kTriangleObb, Mode::kFarthest, Through::kAuto);
  EXPECT_NE(why(query).find("farthest"), std::string::npos);
  query.mode = Mode::kAll;
  EXPECT_NE(why(query).find("mode all"), std::string::npos);
  const std::vector<Sphere> one = {{{0, 0, 0}, 1}};
  query = query_of(Pair::kTriangleSphere, Mode::kFarthest, Through::kBvh);
  expect_error(ErrorCode::kUsage, "farthest", [&] { (void)cast(board, one, query); });
  query.through = Through::kAuto;  // brute force
  EXPECT_EQ(cast(board, one, query).size(), 1u);
  expect_error(ErrorCode::kUsage, "sphere", [&] {
    (void)cast(board, one, query_of(Pair::kTriangleObb, Mode::kNearest, Through::kAuto));
  });
}

TEST(BvhForSolids, ImpossibleConfigurations_AreRefused) {
  BoardConfig config = solids_config();
  config.pairs = {Pair::kTriangleSphere};
  EXPECT_NO_THROW((void)config.parameters());
  config.swap = false;
  EXPECT_NO_THROW((void)config.parameters());
  config.pairs = {Pair::kTriangleCylinder};
  config.box = false;
  expect_error(ErrorCode::kUsage, "no pair of this card can traverse a BVH",
               [&] { (void)config.parameters(); });
  config = solids_config();
  config.pairs = {Pair::kTriangleSphere};
  config.filter = FpFormat{5, 10};
  expect_error(ErrorCode::kUsage, "the certified filter cannot be combined with a BVH",
               [&] { (void)config.parameters(); });
  config = {.pairs = {Pair::kSphereSphere}, .box = true};
  expect_error(ErrorCode::kUsage, "the box rule", [&] { (void)config.parameters(); });
}

}  // namespace
}  // namespace cde::testing
