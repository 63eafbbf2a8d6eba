// SPDX-License-Identifier: Apache-2.0
// Which scenes use a BVH for their rays, and what the plan prints about it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "../has.hpp"
#include "cde/scene/plan.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

const Effect& bvh(const Plan& p) {
  for (const Effect& e : p.effects)
    if (e.name == "bvh") return e;
  throw std::runtime_error("no effect of a BVH");
}

const std::string kManyRays =
    "[[object]]\nname = \"rays\"\nrandom_rays = { count = 300, seed = 7 }\n[object.motion]\n"
    "kind = \"velocity\"\nposition = [100, 100, 300]\nlinear = [1, 0, 0]\n";
std::string ground(int quads) {
  return fmt::format("[[object]]\nname = \"ground\"\nmesh = \"terrain:{0},{0},3\"\n", quads);
}
std::string query(const std::string& more = "", const std::string& secondaries = "\"ground\"") {
  return "[[query]]\nname = \"hit\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\nsecondaries "
         "= " +
         secondaries + "\n" + more;
}
Plan of(const std::string& text) {
  return plan(parse_scene("frames = 3\n" + text, "s.toml"));
}

TEST(PlanBvh, CheaperBvh_IsUsed) {
  const Plan p = of(ground(40) + kManyRays + query());
  EXPECT_TRUE(bvh(p).used);
  EXPECT_EQ(p.board.traversal_units, 2u);
  EXPECT_EQ(p.board.nodes, BoardConfig{}.nodes);
  EXPECT_EQ(p.board.lanes, 4u) << "no query uses brute force";
  EXPECT_TRUE(p.queries[0].bvh);
  ASSERT_TRUE(p.queries[0].bvh_cycles);
  EXPECT_LT(*p.queries[0].bvh_cycles, p.queries[0].rows / 2);
  EXPECT_TRUE(has(bvh(p).why, "rays of hit traverse a BVH of"));
  EXPECT_TRUE(has(bvh(p).cost, fmt::format("brute force on 16 lanes takes {}", p.queries[0].rows)));
  EXPECT_EQ(p.board.transform, Transformer::kNone) << "the host moves rays";

  const Plan small = of(ground(20) + kManyRays + query());
  EXPECT_FALSE(bvh(small).used);
  EXPECT_EQ(small.board.traversal_units, 0u);
  EXPECT_TRUE(has(bvh(small).why, "from about 2048 triangles on; there are 800"));
}

TEST(PlanBvh, RequestedBvh_IsUsedOrNot) {
  const std::string on = "[card]\nbvh = \"on\"\n", off = "[card]\nbvh = \"off\"\n";
  const Plan small = of(on + ground(20) + kManyRays + query());
  EXPECT_TRUE(bvh(small).used);
  EXPECT_EQ(bvh(small).why.find("asked for: rays of hit"), 0u);
  EXPECT_FALSE(bvh(of(off + ground(40) + kManyRays + query())).used);
  const auto refused = [&](const std::string& text, const std::string& why) {
    expect_error(ErrorCode::kUsage, "s.toml: card, bvh = \"on\": " + why,
                 [&] { (void)of(on + text); });
  };
  refused(ground(40) + kManyRays + query("mode = \"all\"\n"), "hit: mode all reports every");
  const std::string other = "[[object]]\nname = \"other\"\nmesh = \"terrain:9,9,1\"\n";
  refused(ground(40) + other + kManyRays + query() +
              "[[query]]\nname = \"b\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\n"
              "secondaries = \"other\"\n",
          "hit: queries have different secondaries");
  const auto with = [&](const std::string& card, const std::string& why) {
    expect_error(ErrorCode::kUsage, why,
                 [&] { (void)of(on + card + ground(40) + kManyRays + query()); });
    const Plan p = of("[card]\n" + card + ground(40) + kManyRays + query());
    EXPECT_FALSE(bvh(p).used);
    EXPECT_TRUE(has(bvh(p).why, why));
  };
  with("format = \"bf16\"\n", "by percents");
  with("box = false\n", "box rule");
}

/// Another query of the same triangles uses brute force: the card has lanes for it.
TEST(PlanBvh, OtherQueriesByBruteForce_KeepTheirLanes) {
  const Plan p = of(ground(40) + kManyRays + query() +
                    "[[query]]\nname = \"b\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\n"
                    "secondaries = \"ground\"\nmode = \"all\"\n");
  EXPECT_TRUE(p.queries[0].bvh);
  EXPECT_FALSE(p.queries[1].bvh);
  EXPECT_EQ(p.queries[1].bvh_cycles, std::nullopt);
  EXPECT_EQ(p.board.lanes, 16u);
}

/// Rays that the card moves in its register file cannot use the BVH.
TEST(PlanBvh, RaysForABvh_AreMovedByTheHost) {
  const std::string ray = "{ origin = [0, 0, 0], direction = [0, 0, -1] }";
  const std::string rays = "[[object]]\nname = \"rays\"\nray = [" + ray + ", " + ray +
                           "]\nmotion = { kind = \"velocity\", linear = [1, 0, 0] }\n";
  const std::string all = query("mode = \"all\"\n").replace(18, 3, "all");
  const auto card_moves = [&](const char* bvh) {
    const Plan p =
        of(fmt::format("[card]\nbvh = \"{}\"\n", bvh) + ground(40) + rays + query() + all);
    return std::find(p.card_moves_primaries.begin(), p.card_moves_primaries.end(), true) !=
           p.card_moves_primaries.end();
  };
  EXPECT_TRUE(card_moves("off"));
  EXPECT_FALSE(card_moves("on"));
}

TEST(PlanBvh, MovingObjects_UseABvh) {
  const std::string moving =
      "[[object]]\nname = \"ball\"\nmesh = \"terrain:30,30,5\"\n"
      "motion = { kind = \"velocity\", angular = [0, 0, 9] }\n";
  const std::string text = ground(40) + moving + kManyRays + query("", R"(["ground", "ball"])");
  const Plan p = of(text);
  EXPECT_TRUE(bvh(p).used);
  EXPECT_EQ(p.board.transform, Transformer::kSecondaries);
  // 1,800 of 5,000 move.
  EXPECT_TRUE(has(bvh(p).cost, "of them to refit boxes"));
  const Plan whole = of("[card]\ntransform_site = \"host\"\n" + text);
  const auto refit = [](const Plan& plan) {
    const std::string cost = bvh(plan).cost;
    return std::stoul(cost.substr(cost.find("per frame, ") + 11));
  };
  EXPECT_LT(refit(p), refit(whole) / 2) << bvh(p).cost;
}

std::string solids(const std::string& shape, const std::string& more = "") {
  return "[[object]]\nname = \"things\"\nrandom = { shape = \"" + shape +
         "\", count = 200, min = [0, 0, 0], max = [400, 400, 300], size = [2, 9], seed = 3 }\n"
         "[[query]]\nname = \"touch\"\npair = \"triangle-" +
         shape + "\"\nprimaries = \"things\"\nsecondaries = \"ground\"\n" + more;
}

TEST(PlanBvh, SolidPrimaries_UseABvh) {
  for (const char* shape : {"sphere", "obb"}) {
    SCOPED_TRACE(shape);
    const Plan p = of(ground(60) + solids(shape, "normals = true\nmode = \"hits\"\n"));
    EXPECT_TRUE(bvh(p).used) << bvh(p).why;
    EXPECT_EQ(bvh(p).why.find("primaries of touch traverse a BVH"), 0u);
    EXPECT_TRUE(p.board.box) << "the BVH needs the box rule";
    EXPECT_EQ(p.board.lanes, shape == std::string("sphere") ? 4u : 8u)
        << "no query uses brute force";
    EXPECT_LT(*p.queries[0].bvh_cycles, p.queries[0].rows / 2);
    EXPECT_NO_THROW((void)p.board.parameters());
    const Plan off = of("[card]\nbvh = \"off\"\n" + ground(60) + solids(shape));
    EXPECT_TRUE(off.board.box) << "records must not depend on the BVH";
    EXPECT_EQ(off.board.traversal_units, 0u);
    // Primaries that meet most of the ground use brute force, and others in the same scene use the
    // BVH.
    if (shape == std::string("sphere")) {
      const std::string giants =
          "[[object]]\nname = \"giants\"\nrandom = { shape = \"sphere\", count = 200, min = [0, 0, "
          "0], "
          "max = [400, 400, 300], size = [900, 1000], seed = 3 }\n"
          "[[query]]\nname = \"hits\"\npair = \"triangle-sphere\"\nprimaries = \"giants\"\n"
          "secondaries = \"ground\"\nmode = \"hits\"\n";
      const Plan large = of(ground(60) + giants);
      EXPECT_FALSE(bvh(large).used);
      EXPECT_EQ(bvh(large).why, "brute force takes less");
      EXPECT_GT(*large.queries[0].bvh_cycles, large.queries[0].rows);
      const Plan both = of(ground(60) + giants + solids(shape, "mode = \"hits\"\n"));
      EXPECT_FALSE(both.queries[0].bvh);
      EXPECT_TRUE(both.queries[1].bvh);
      EXPECT_EQ(bvh(both).why.find("primaries of touch traverse"), 0u);
    }
    const auto brute_force = [&](const std::string& card, const std::string& more,
                                 const char* why) {
      const Plan none = of(card + ground(60) + solids(shape, more));
      EXPECT_FALSE(bvh(none).used);
      EXPECT_TRUE(has(bvh(none).why, why));
    };
    brute_force("", "mode = \"farthest\"\n", "farthest shape from a solid");
    brute_force("[card]\nbox = false\n", "", "the box rule");
    brute_force("[card]\nfilter = \"fp16\"\n", "", "certified filter");
  }
}

/// A mesh against a mesh, and spheres that move among each other, with a BVH that is rebuilt.
TEST(PlanBvh, MeshesAndSpheres_UseABvh) {
  const Plan meshes =
      of(ground(60) +
         "[[object]]\nname = \"other\"\nmesh = \"terrain:10,10,5\"\n"
         "[[query]]\nname = \"meet\"\npair = \"triangle-triangle\"\nprimaries = \"other\"\n"
         "secondaries = \"ground\"\nmode = \"hits\"\n");
  EXPECT_TRUE(bvh(meshes).used) << bvh(meshes).why;
  EXPECT_TRUE(meshes.board.box);
  const auto cloud = [](const std::string& count, const std::string& primaries,
                        const std::string& shape = "sphere") {
    return of(
        "[[object]]\nname = \"cloud\"\nrandom = { shape = \"" + shape + "\", count = " + count +
        ", min = [0, 0, 0], max = [9, 9, 9], size = [0.1, 0.2], seed = 3 }\n" +
        "motion = { kind = \"random\", speed = 1, min = [0, 0, 0], max = [9, 9, 9], each = true }\n"
        "[[object]]\nname = \"probes\"\nrandom = { shape = \"sphere\", count = 900, min = [0, "
        "0, 0], max = [9, 9, 9], size = [0.1, 0.2], seed = 4 }\n"
        "[[query]]\nname = \"near\"\npair = \"sphere-" +
        shape + "\"\nprimaries = \"" + primaries + "\"\nsecondaries = \"cloud\"\n");
  };
  const Plan spheres = cloud("4000", "probes");
  EXPECT_TRUE(bvh(spheres).used) << bvh(spheres).why << bvh(spheres).cost;
  EXPECT_FALSE(spheres.board.box) << "no pair of this card has the rule";
  EXPECT_TRUE(has(bvh(spheres).cost, "of them to refit boxes"));
  EXPECT_EQ(bvh(cloud("200", "probes")).why,
            "a BVH pays off from about 256 spheres on; there are 200");
  EXPECT_TRUE(has(bvh(cloud("4000", "cloud")).why, "no shape is tested with itself"));
  const Plan boxes = cloud("4000", "probes", "obb");
  EXPECT_TRUE(bvh(boxes).used) << bvh(boxes).why << bvh(boxes).cost;
  EXPECT_TRUE(boxes.board.box) << "the pair needs the box rule";
  EXPECT_EQ(bvh(cloud("200", "probes", "obb")).why,
            "a BVH pays off from about 256 obbs on; there are 200");
}

/// The swapped roles of a pair: the triangles of a mesh among boxes.
TEST(PlanBvh, MeshAmongBoxes_UsesABvh) {
  for (const char* shape : {"obb", "aabb"}) {
    SCOPED_TRACE(shape);
    const Plan p = of(std::string("[[object]]\nname = \"boxes\"\nrandom = { shape = \"") + shape +
                      "\", count = 3000, min = [0, 0, 0], max = [200, 200, 60], size = [0.5, 2], "
                      "seed = 3 }\n[[object]]\nname = \"other\"\nmesh = \"terrain:10,10,5\"\n"
                      "[[query]]\nname = \"meet\"\npair = \"triangle-" +
                      shape +
                      "\"\nprimaries = \"other\"\nsecondaries = \"boxes\"\nmode = "
                      "\"hits\"\n");
    EXPECT_TRUE(bvh(p).used) << bvh(p).why << bvh(p).cost;
  }
}

/// Many shapes that move among each other leave little of a BVH valid.
TEST(PlanBvh, ManyMovingShapes_UseBruteForce) {
  const auto dust = [](const char* each) {
    return of(std::string("[[object]]\nname = \"ground\"\nrandom = { shape = \"triangle\", count = "
                          "3000, min = [0, 0, 0], max = [1000, 1000, 1000], size = [5, 30] }\n"
                          "motion = { kind = \"random\", speed = 100, min = [-100, -100, -100], "
                          "max = [1100, 1100, 1100], each = ") +
              each + " }\n" + kManyRays + query());
  };
  EXPECT_TRUE(bvh(dust("false")).used);
  const Plan p = dust("true");
  EXPECT_FALSE(bvh(p).used);
  EXPECT_EQ(bvh(p).why, "brute force takes less");
  EXPECT_GT(*p.queries[0].bvh_cycles, p.queries[0].rows);
}

}  // namespace
}  // namespace cde::testing
