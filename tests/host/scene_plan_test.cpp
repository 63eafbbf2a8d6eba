// SPDX-License-Identifier: Apache-2.0
// The card that `plan` chooses for a scene.
#include "cde/scene/plan.hpp"

#include <fmt/format.h>

#include <string>

#include "../has.hpp"
#include "scenes.hpp"

namespace cde::testing {
namespace {

const Effect& effect(const Plan& p, const std::string& name) {
  for (const Effect& e : p.effects)
    if (e.name == name) return e;
  throw std::runtime_error("no effect " + name);
}

TEST(Plan, Scene_GetsTheCardItNeeds) {
  const Scene s = parse_scene(kGood, "s.toml");
  const Plan p = plan(s);
  EXPECT_EQ(p.board.pairs, std::vector<Pair>{Pair::kRaySphere});
  EXPECT_EQ(p.board.lanes, 16u) << "the device's";
  EXPECT_FALSE(p.board.swap || p.board.normals || p.board.trace || p.board.parallel);
  EXPECT_FALSE(effect(p, "transformer").used);
  EXPECT_EQ(effect(p, "transformer").why, "no secondary moves as a rigid body");
  EXPECT_FALSE(effect(p, "normals").used);
  EXPECT_FALSE(effect(p, "trace").used);
}

TEST(Plan, Effects_HaveMeasuredCosts) {
  const Plan p = plan(parse_scene(kGood, "s.toml"));
  for (const char* name : {"pipes", "gates", "transformer", "normals", "exchange of roles",
                           "two pairs at a time", "bus timing", "memory timing", "ecc", "trace"}) {
    const std::optional<double> times = simulation_cost(name);
    ASSERT_TRUE(times) << name;
    EXPECT_GT(*times, 0.8) << name << ": no option makes a simulation much faster";
    EXPECT_LT(*times, 100) << name;
    EXPECT_TRUE(has(effect(p, name).cost, fmt::format("takes {:.1f} times as long", *times)));
  }
  EXPECT_FALSE(simulation_cost("lanes")) << "computed from the scene";
}

TEST(Plan, MorePrimaries_GetMoreLanes) {
  const auto lanes = [](unsigned count, const char* card = "") {
    return plan(parse_scene(
                    fmt::format("{}[[object]]\nname=\"many\"\nrandom={{shape=\"ray\",count={}"
                                ",min=[0,0,0],max=[1,1,1]}}\n{}[[query]]\nname=\"q\"\n"
                                "pair=\"ray-sphere\"\nprimaries=\"many\"\nsecondaries=\"ball\"\n",
                                card, count, kBall),
                    "s.toml"))
        .board.lanes;
  };
  for (const unsigned any : {1u, 16u, 17u, 256u, 5000u})
    EXPECT_EQ(lanes(any), default_device().lanes);
  EXPECT_EQ(lanes(5000, "[card]\ndevice = \"ecp5-85\"\n"), 1u);
  EXPECT_EQ(lanes(5000, "[card]\nlanes = 2\n"), 2u);
  EXPECT_EQ(lanes(5000, "[card]\narithmetic = \"rtl\"\n"), 8u);
  EXPECT_EQ(lanes(3, "[card]\narithmetic = \"rtl\"\n"), 4u) << "gates take minutes to build";
}

/// The card has everything that any query needs, in any order of queries.
TEST(Plan, NeedsOfAnyQuery_AreMet) {
  const std::string objects =
      "[[object]]\nname = \"balls\"\nsphere = { center = [1, 2, 3], radius = 0.5 }\n"
      "[[object]]\nname = \"box\"\nobb = { center = [0, 0, 0], half = [1, 2, 3] }\n";
  const auto query = [](const char* name, bool swap, bool normals) {
    return fmt::format(
        "[[query]]\nname = \"{}\"\npair = \"sphere-obb\"\nprimaries = \"{}\"\n"
        "secondaries = \"{}\"\nnormals = {}\n",
        name, swap ? "box" : "balls", swap ? "balls" : "box", normals);
  };
  for (unsigned which = 0; which < 3; ++which)
    for (const bool swap : {false, true})
      for (const bool normals : {false, true}) {
        std::string scene = objects;
        for (unsigned q = 0; q < 3; ++q)
          scene += query(fmt::format("q{}", q).c_str(), q == which && swap, q == which && normals);
        SCOPED_TRACE(scene);
        const Plan p = plan(parse_scene(scene, "s.toml"));
        EXPECT_EQ(p.board.swap, swap);
        EXPECT_EQ(p.board.normals, normals);
        EXPECT_EQ(effect(p, "exchange of roles").used, swap);
        EXPECT_EQ(effect(p, "normals").used, normals);
      }
}

TEST(Plan, Work_IsCounted) {
  const Plan p = plan(load_scene(std::filesystem::path(CDE_MESHES) / "scenes/spheres.toml"));
  ASSERT_EQ(p.queries.size(), 1u);
  const QueryWork& w = p.queries[0];
  EXPECT_EQ(w.primaries, 1000u);
  EXPECT_EQ(w.packets, 4u);
  EXPECT_EQ(w.passes, 4u);
  EXPECT_TRUE(w.self_pairs);
  EXPECT_EQ(w.tests, 256u * (999 + 743 + 487) + 232 * 231)
      << "each packet meets the secondaries after it";
  EXPECT_EQ(w.most_records, 499'500u);
  EXPECT_EQ(p.board.lanes, 16u);
  EXPECT_EQ(w.rows, 16u * (999 + 743 + 487) + 15 * 231) << "16 lanes; 232 in the last packet";
  EXPECT_EQ(w.secondary_words, 4000u);
  EXPECT_EQ(w.moved_words, 4000u);
  EXPECT_TRUE(has(effect(p, "transformer").cost, "12000"));
  const Plan objects =
      plan(load_scene(std::filesystem::path(CDE_MESHES) / "scenes/flight_objects.toml"));
  EXPECT_EQ(effect(objects, "transformer").cost, "24 words per frame; the host would upload 20736");
  EXPECT_EQ(objects.queries[0].moved_words, 24u);
}

TEST(Plan, RequestedModelWithoutThePair_IsRefused) {
  const Scene s =
      parse_scene("[card]\npairs = [\"obb-obb\", \"ray-triangle\"]\n" + kGood, "s.toml");
  expect_error(
      ErrorCode::kUsage,
      "query 'q' needs a pipe for ray-sphere, but [card] has pairs = ray-triangle, obb-obb",
      [&] { (void)plan(s); });
}

TEST(Plan, Objects_MoveWhereFewerWordsAreSent) {
  const auto mesh = [](const char* name, const std::string& more) {
    return fmt::format("[[object]]\nname=\"{}\"\nmesh=\"terrain:12,9,3\"\n{}", name, more);
  };
  const std::string turning = "motion={kind=\"velocity\",angular=[0,0,9]}\n";
  const std::string band = "deform={kind=\"random\",vertices=[3,9],amplitude=[0,0,1],seed=5}\n";
  const auto query = [](const char* name, const char* secondaries) {
    return fmt::format(
        "[[query]]\nname=\"{}\"\npair=\"ray-triangle\"\nprimaries=\"rays\"\nsecondaries={}\n", name,
        secondaries);
  };
  const std::string objects =
      kRays + mesh("a", turning) + mesh("b", band + turning) + mesh("c", band) + mesh("d", "");
  const auto of = [](const std::string& text) { return plan(parse_scene(text, "s.toml")); };
  const std::string all = objects + query("q", R"(["a","b","c","d"])");
  const std::vector<bool> none(5, false), moved{false, true, true, false, false};

  const Plan card = of("frames=2\n" + all);
  EXPECT_EQ(card.board.transform, Transformer::kSecondaries);
  EXPECT_EQ(card.board.objects, 1024u);
  EXPECT_EQ(card.card_moves, moved);
  EXPECT_EQ(card.card_moves_primaries, none);
  EXPECT_EQ(effect(card, "transformer").why, "moving an object takes 12 words");
  const Plan host = of("frames=2\n[card]\ntransform_site=\"host\"\n" + all);
  EXPECT_EQ(host.board.transform, Transformer::kNone);
  EXPECT_EQ(host.card_moves, none);
  const std::uint64_t vertices = card.queries[0].moved_words - 24;  // of b and c
  EXPECT_EQ(vertices % (2 * 9), 0u);
  EXPECT_GT(vertices, 0u);
  EXPECT_EQ(host.queries[0].moved_words, 2 * 216 * 9 + vertices / 2);
  EXPECT_EQ(effect(card, "transformer").cost,
            fmt::format("{} words per frame; the host would upload 3888", 24 + vertices / 2));
  EXPECT_EQ(effect(host, "transformer").cost,
            fmt::format("uploads 3888 words per frame; a transformer would take {} for 2 objects",
                        24 + vertices / 2));

  EXPECT_EQ(of(all).board.transform, Transformer::kNone) << "one frame";
  const std::string two = objects + query("q", "\"a\"") + query("r", "\"b\"");
  EXPECT_EQ(of("frames=2\n" + two).board.transform, Transformer::kNone)
      << "uploaded in every frame";
  EXPECT_EQ(of("frames=2\n[card]\ntransform_site=\"card\"\n" + two).card_moves, moved);
}

TEST(Plan, LoadedPrimaries_AreMovedByTheCard) {
  const auto of = [](const std::string& rays, const std::string& more = "") {
    return plan(parse_scene(
        "frames=2\n" + more + "[[object]]\nname=\"rays\"\n" + rays + kBall + kHit, "s.toml"));
  };
  const std::string moving = "motion={kind=\"velocity\",linear=[1,0,0]}\n";
  const auto drawn = [](int count, const char* redraw) {
    return fmt::format("random_rays={{count={},redraw={}}}\n", count, redraw);
  };
  const Plan card = of(drawn(256, "false") + moving);
  EXPECT_EQ(card.board.transform, Transformer::kBoth);
  EXPECT_EQ(card.card_moves_primaries, (std::vector<bool>{true, false}));
  EXPECT_EQ(card.queries[0].primary_words, 12u);
  const Plan still = of(drawn(256, "false"));
  EXPECT_EQ(still.board.transform, Transformer::kNone);
  EXPECT_EQ(still.queries[0].primary_words, 0u) << "loaded once";
  const auto loaded = [&](const Plan& p, std::uint64_t words, const char* why) {
    EXPECT_EQ(p.board.transform, Transformer::kNone);
    EXPECT_EQ(p.queries[0].primary_words, words);
    EXPECT_EQ(effect(p, "transformer of primaries").why, why);
  };
  loaded(of(drawn(256, "true") + moving), 256 * 8, "they deform, so they differ in every frame");
  loaded(of(drawn(257, "false") + moving), 257 * 8, "they are loaded packet by packet");
  loaded(of(drawn(256, "false") + moving, "[card]\ntransform_site=\"host\"\n"), 256 * 8,
         "transform_site = \"host\"");
  loaded(of(drawn(1, "false") + moving), 8, "loading them again takes no more words");
}

TEST(Plan, TooManyObjects_AreMovedByTheHost) {
  const auto of = [](int boxes, const char* transform_site) {
    return plan(parse_scene(
        fmt::format("frames=2\n[card]\ntransform_site=\"{}\"\n[[object]]\nname=\"boxes\"\n"
                    "random={{shape=\"obb\",count={},min=[-1,-1,-1],max=[1,1,1],size=[0.1,0.2]}}\n"
                    "motion={{kind=\"random\",each=true,min=[-1,-1,-1],max=[1,1,1],speed=1}}\n"
                    "{}[[query]]\nname=\"q\"\npair=\"sphere-obb\"\nprimaries=\"ball\"\n"
                    "secondaries=\"boxes\"\n",
                    transform_site, boxes, kBall),
        "s.toml"));
  };
  EXPECT_EQ(of(1024, "auto").board.objects, 1024u);
  EXPECT_EQ(of(1025, "auto").board.objects, 2048u);
  EXPECT_EQ(of(2048, "card").queries[0].moved_words, 2048u * 12);
  const Plan host = of(2049, "auto");
  EXPECT_EQ(host.board.transform, Transformer::kNone);
  EXPECT_EQ(effect(host, "transformer").why, "more objects than the 2048 of a card's table");
  expect_error(
      ErrorCode::kUsage,
      "s.toml: card, transform_site = \"card\": query 'q' has 2049 objects among its secondaries "
      "(each shape that moves on its own counts as one), but a card's table holds 2048; "
      "use transform_site = \"host\"",
      [&] { (void)of(2049, "card"); });
}

/// A range that the host writes again is one entry, however many of its shapes move.
TEST(Plan, HostMovedRange_IsOneEntry) {
  const Plan p = plan(parse_scene(
      "frames=2\n" + kRays +
          "[[object]]\nname=\"shards\"\n"
          "random={shape=\"triangle\",count=1500,min=[-1,-1,-1],max=[1,1,1],size=[0.1,0.2]}\n"
          "motion={kind=\"random\",each=true,min=[-3,-3,-3],max=[3,3,3],speed=1}\n"
          "[[object]]\nname=\"land\"\nmesh=\"terrain:12,9,3\"\n"
          "motion={kind=\"velocity\",angular=[0,0,9]}\n"
          "[[query]]\nname=\"q\"\npair=\"ray-triangle\"\nprimaries=\"rays\"\n"
          "secondaries=[\"shards\",\"land\"]\n",
      "s.toml"));
  EXPECT_EQ(p.card_moves, (std::vector<bool>{false, false, true}));
  EXPECT_EQ(p.queries[0].moved_words, 1500u * 9 + 12);
  EXPECT_EQ(p.board.objects, 1024u);
}

/// DDR holds the secondaries of one query: they stay only if every query has the same.
TEST(Plan, SameSecondariesInAllQueries_StayLoaded) {
  const auto resident = [](std::initializer_list<const char*> secondaries) {
    std::string scene =
        kBall + kRays + "[[object]]\nname=\"other\"\nsphere={center=[0,0,0]" + ",radius=1}\n";
    for (const char* name : secondaries)
      scene += fmt::format(
          "[[query]]\nname=\"q{}\"\npair=\"ray-sphere\"\nprimaries=\"rays\"\n"
          "secondaries=\"{}\"\n",
          scene.size(), name);
    return plan(parse_scene(scene, "s.toml")).resident;
  };
  EXPECT_TRUE(resident({"ball"}));
  EXPECT_TRUE(resident({"ball", "ball", "ball"}));
  EXPECT_FALSE(resident({"ball", "other"}));
  EXPECT_FALSE(resident({"ball", "other", "ball"}));
}

TEST(Plan, RequestedBusAndCheckBits_AreUsed) {
  const Plan bare = plan(parse_scene(kGood, "s.toml"));
  EXPECT_EQ(bare.board.bus, Bus::kFunctional);
  EXPECT_FALSE(bare.board.ecc);
  EXPECT_FALSE(effect(bare, "bus timing").used);
  const Plan both =
      plan(parse_scene(std::string("[card]\nbus = \"cycle\"\necc = true\n") + kGood, "s.toml"));
  EXPECT_STREQ(both.board.top(), "card");
  EXPECT_TRUE(both.board.ecc);
  EXPECT_TRUE(effect(both, "bus timing").used);
  EXPECT_TRUE(effect(both, "ecc").used);
}

TEST(Plan, RequestedFilters_AreUsedOrRefused) {
  const auto spheres = [](const char* card, const char* mode) {
    return fmt::format(
        "[card]\n{}\n{}[[query]]\nname=\"q\"\npair=\"sphere-sphere\"\nprimaries=\"ball\"\n"
        "secondaries=\"ball\"\nmode=\"{}\"\n",
        card, kBall, mode);
  };
  const Plan none = plan(parse_scene(spheres("", "hits"), "s.toml"));
  EXPECT_FALSE(none.board.filter);
  EXPECT_FALSE(effect(none, "filter").used);
  const Plan hits = plan(parse_scene(spheres("filter = \"bf16\"", "hits"), "s.toml"));
  EXPECT_EQ(hits.board.filter, FpFormat::parse("bf16"));
  EXPECT_TRUE(effect(hits, "filter").used);
  EXPECT_EQ(effect(hits, "filter").choice, "bf16 lanes before one of fp32");
  EXPECT_EQ(effect(hits, "filter").why, "asked for; q can omit misses");
  const Plan nearest = plan(parse_scene(spheres("filter = \"bf16\"", "nearest"), "s.toml"));
  EXPECT_TRUE(has(effect(nearest, "filter").why, "every pair goes through the wide lane"));
  const auto refused = [&](const char* card, const char* why) {
    try {
      (void)plan(parse_scene(spheres(card, "hits"), "s.toml"));
      ADD_FAILURE() << "not refused: " << card;
    } catch (const Error& e) {
      EXPECT_TRUE(has(e.what(), why));
    }
  };
  refused("filter = \"fp33\"", "card, filter: ");
  refused("filter = 16", "card, filter: must be a text");
  refused("filter = \"fp32\"",
          "s.toml:2:10: card, filter: a certified filter in fp32 cannot precede fp32");
  refused("filter = \"fp24\"\nformat = \"fp16\"", "a certified filter in fp24 cannot precede fp16");
  refused("filter = \"fp16\"\nlanes = 64", "with the certified filter it must be 1 to 32");
  try {
    (void)plan(parse_scene("[card]\nfilter = \"fp16\"\n" + kGood, "s.toml"));
    ADD_FAILURE() << "rays have no certified filter";
  } catch (const Error& e) {
    EXPECT_TRUE(has(e.what(), "the card has none"));
  }
}

TEST(Plan, ModelledTimes_NameTheirSource) {
  const Plan bare = plan(parse_scene(kGood, "s.toml"));
  EXPECT_TRUE(has(effect(bare, "bus timing").why, "host ideal, 64 bits, bursts of 4096 bytes"));
  EXPECT_FALSE(effect(bare, "memory timing").used);
  const Scene s = parse_scene(std::string("[card]\nhost = \"p64-2001\"\nburst = 256\nnarrow = "
                                          "true\nmemory = \"cycle\"\n") +
                                  kGood,
                              "s.toml");
  EXPECT_EQ(s.card.host.name, "p64-2001");
  EXPECT_EQ(s.card.burst, 256u);
  EXPECT_TRUE(s.card.narrow);
  const Plan old = plan(s);
  EXPECT_EQ(old.board.bus, Bus::kFunctional);
  EXPECT_TRUE(has(effect(old, "bus timing").why, "host p64-2001, 32 bits, bursts of 256 bytes"));
  EXPECT_TRUE(effect(old, "memory timing").used);
  const auto refuses = [](const std::string& line, const std::string& why,
                          ErrorCode code = ErrorCode::kBadInput) {
    expect_error(code, why, [&] { (void)parse_scene("[card]\n" + line + "\n" + kGood, "s.toml"); });
  };
  refuses("host = \"pentium\"", "host");
  refuses("burst = 32", "burst");
  refuses("burst = 8192", "burst");
  refuses("burst = 100", "multiple of 8");
  refuses("narrow = 32", "narrow", ErrorCode::kFile);
}

TEST(Plan, TooLargeScene_IsRefused) {
  Scene s = parse_scene(kGood, "s.toml");
  // 2^24 spheres per group, more groups than DDR holds. Built by hand, because a file would take
  // minutes.
  SceneObject big = s.objects[0];
  big.shapes = std::vector<Sphere>(1 << 22, {Eigen::Vector3f::Zero(), 1});
  for (int i = 0; i < 30; ++i) {
    s.queries[0].secondaries.push_back(1);
  }
  s.objects.push_back(big);
  s.queries[0].secondaries.assign(30, 2);
  expect_error(ErrorCode::kCapacity, "but the card's DDR holds 499999995", [&] { (void)plan(s); });
  s.queries[0].secondaries.assign(29, 2);
  EXPECT_NO_THROW((void)plan(s));
  s.queries[0].mode = Mode::kAll;
  s.objects[1].shapes =
      std::vector<Ray>(256, Ray{Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitX()});
  expect_error(ErrorCode::kCapacity, "more than the 2^32 - 1", [&] { (void)plan(s); });
}

}  // namespace
}  // namespace cde::testing
