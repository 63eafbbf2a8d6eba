// SPDX-License-Identifier: Apache-2.0
// Scene files: their values, and errors that name the line and key.
#include "cde/scene/scene.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cmath>
#include <string>

#include "../has.hpp"
#include "cde/scene/plan.hpp"
#include "scenes.hpp"

namespace cde::testing {
namespace {

void malformed(const std::string& text, const std::string& why) {
  refused(text, why, ErrorCode::kFile);
}
void impossible(const std::string& text, const std::string& why) {
  refused(text, why, ErrorCode::kUsage);
}

std::string ball_with(const std::string& motion) {
  return kBall + "[object.motion]\n" + motion + "\n" + kRays + kHit;
}

TEST(SceneFile, Text_ParsesToItsScene) {
  const Scene s = parse_scene(
      "title = \"t\"\nframes = 7\nrate = 10\ncheck = \"sample\"\n"
      "[card]\nlanes = 8\nclock_mhz = 50\n"
      "[report]\nresults = \"binary\"\nbits = true\n" +
          kGood + "mode = \"any\"\n",
      "s.toml");
  EXPECT_EQ(s.title, "t");
  EXPECT_EQ(s.frames, 7u);
  EXPECT_EQ(s.check, Check::kSample);
  EXPECT_EQ(s.results, Results::kBinary);
  EXPECT_EQ(parse_scene("[report]\nresults = \"npy\"\n" + kGood, "s.toml").results, Results::kNpy);
  EXPECT_EQ(s.card.lanes, 8u);
  EXPECT_EQ(s.card.device.clock_mhz, 50);
  ASSERT_EQ(s.objects.size(), 2u);
  const auto& ball = std::get<std::vector<Sphere>>(s.objects[0].shapes).at(0);
  EXPECT_EQ(ball.c, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(ball.r, 0.5f);
  ASSERT_EQ(s.queries.size(), 1u);
  EXPECT_EQ(s.queries[0].mode, Mode::kAny);
  EXPECT_FALSE(s.queries[0].swap);
  EXPECT_EQ(seconds(s, 5), 0.5);
}

TEST(SceneFile, ObjectsThatNoQueryUses_AreNamed) {
  EXPECT_EQ(parse_scene(kGood, "s.toml").warnings, std::vector<std::string>{});
  const std::string idle =
      "[[object]]\nname = \"idle\"\nsphere = { center = [0, 0, 0], radius = 1 }\n";
  EXPECT_EQ(parse_scene(kBall + kRays + idle + kHit, "s.toml").warnings,
            std::vector<std::string>{"s.toml: no query uses object 'idle'"});
  // An object that is the parent of another one is used.
  const std::string child =
      "[[object]]\nname = \"ball\"\nsphere = { center = [1, 2, 3], radius = 0.5 }\nparent = "
      "\"idle\"\n";
  EXPECT_EQ(parse_scene(idle + child + kRays + kHit, "s.toml").warnings,
            std::vector<std::string>{});
}

TEST(SceneFile, RepositoryScenes_ArePlanned) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(CDE_MESHES) / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().string());
    const Plan p = plan(load_scene(entry.path()));
    EXPECT_GE(p.effects.size(), 10u);
    for (const Effect& e : p.effects) {
      EXPECT_FALSE(e.cost.empty()) << e.name;
      if (e.name == "memory timing") continue;
      EXPECT_FALSE(has(e.cost, "not measured")) << e.name;
    }
    ++scenes;
  }
  EXPECT_GE(scenes, 5);
}

TEST(SceneFile, EveryPrimitive_IsParsed) {
  const Scene s = parse_scene(
      "[[object]]\nname=\"a\"\ntriangle={v0=[0,0,0],v1=[1,0,0],v2=[0,1,0]}\n"
      "[[object]]\nname=\"b\"\naabb={min=[0,0,0],max=[1,2,3]}\n"
      "[[object]]\nname=\"c\"\nplane={normal=[0,0,2],d=1}\n"
      "[[object]]\nname=\"d\"\ncylinder={center=[0,0,0],axis=[0,3,0],half_height=2,radius=1}\n"
      "[[object]]\nname=\"e\"\nobb={center=[0,0,0],half=[1,2,3],axis=[0,0,1],degrees=90}\n"
      "[[object]]\nname=\"f\"\nsphere=[{center=[0,0,0],radius=1},{center=[1,0,0],radius=2}]\n"
      "[[object]]\nname=\"g\"\nray={origin=[0,0,0],direction=[0,0,2],tmin=1,tmax=inf}\n"
      "[[query]]\nname=\"q\"\npair=\"triangle-aabb\"\nprimaries=\"a\"\nsecondaries=\"b\"\n",
      "s.toml");
  EXPECT_EQ(std::get<std::vector<Plane>>(s.objects[2].shapes)[0].n, Eigen::Vector3f::UnitZ());
  EXPECT_EQ(std::get<std::vector<Cylinder>>(s.objects[3].shapes)[0].axis, Eigen::Vector3f::UnitY());
  const Obb& box = std::get<std::vector<Obb>>(s.objects[4].shapes)[0];
  EXPECT_LE((box.rotation.col(0) - Eigen::Vector3f::UnitY()).norm(), 1e-6f);
  EXPECT_EQ(size(s.objects[5].shapes), 2u);
  EXPECT_TRUE(std::isinf(std::get<std::vector<Ray>>(s.objects[6].shapes)[0].tmax));
  for (const char* shape : {"ray", "triangle", "sphere", "aabb", "plane", "cylinder", "obb"}) {
    const bool sized = std::string(shape) != "ray" && std::string(shape) != "plane";
    const std::string text = fmt::format(
        "[[object]]\nname=\"r\"\nrandom={{shape=\"{}\",count=50,min=[-1,-1,-1],max=[1,1,1]{}}}\n",
        shape, sized ? ",size=[0.1,0.2]" : "");
    const Scene one = parse_scene(text + kGood, "s.toml");
    EXPECT_EQ(name(shape_of(one.objects[0].shapes)), shape);
    EXPECT_EQ(size(one.objects[0].shapes), 50u);
  }
}

TEST(SceneFile, APairsNameInEitherOrder_IsThePair) {
  for (const std::string name : {"ray-sphere", "sphere-ray"}) {
    const Scene s = parse_scene(kBall + kRays + "[[query]]\nname=\"q\"\npair=\"" + name +
                                    "\"\nprimaries=\"rays\"\nsecondaries=\"ball\"\n",
                                "s.toml");
    EXPECT_EQ(s.queries[0].pair, Pair::kRaySphere);
    EXPECT_FALSE(s.queries[0].swap);
  }
  impossible(kBall + kRays +
                 "[[query]]\nname=\"q\"\npair=\"sphere-cylinder\"\nprimaries=\"rays\"\n"
                 "secondaries=\"ball\"\n",
             "pair: ");
}

TEST(SceneFile, UnknownKeys_GetSuggestions) {
  malformed("framse = 3\n" + kGood,
            "s.toml:1:1: there is no key 'framse' here (did you mean 'frames'?)");
  malformed("[card]\nlane = 8\n" + kGood,
            "s.toml:2:1: card: there is no key 'lane' here (did you mean 'lanes'?)");
  malformed(kGood + "mod = \"any\"\n",
            "s.toml:12:1: query 'q': there is no key 'mod' here (did you mean 'mode'?)");
  malformed("[[object]]\nname = \"x\"\nspehre = { center = [0,0,0], radius = 1 }\n" + kGood,
            "s.toml:3:1: object 'x': there is no key 'spehre' here (did you mean 'sphere'?)");
  malformed(
      "[[object]]\nname = \"x\"\nsphere = { center = [0,0,0], radius = 1, colour = 3 }\n" + kGood,
      "there is no key 'colour' here");
  malformed("[[object]]\nname = \"x\"\nsphere = { center = [0,0,0], raduis = 1 }\n" + kGood,
            "the key 'radius' is missing; 'raduis' is not a key");
  malformed(ball_with("kind = \"velocity\"\nliner = [0,0,0]"), "(did you mean 'linear'?)");
  refused(kGood + "mode = \"neerest\"\n", "did you mean 'nearest'?");
  refused(ball_with("kind = \"pth\""), "did you mean 'path'?");
  malformed("[[objekt]]\n" + kGood, "there is no key 'objekt' here (did you mean 'object'?)");
}

TEST(SceneFile, TruncatedText_IsAnErrorOrAValidScene) {
  const std::string text = "frames = 2\n" + ball_with("kind = \"velocity\"\nlinear = [1, 0, 0]");
  int errors = 0;
  for (std::size_t n = 0; n < text.size(); ++n) {
    try {
      (void)parse_scene(text.substr(0, n), "s.toml");
    } catch (const Error& e) {
      ++errors;
      ASSERT_EQ(std::string(e.what()).rfind("s.toml:", 0), 0u) << e.what();
    }
  }
  EXPECT_GE(errors, static_cast<int>(text.size()) - 30) << "only a cut in the tail may be accepted";
  EXPECT_NO_THROW((void)parse_scene(text, "s.toml"));
}

TEST(SceneFile, InvalidToml_IsAnErrorWithItsPlace) {
  malformed("= 3", "s.toml:1:1");
  malformed("a = [1,\n", "s.toml:");
  malformed(std::string("a = \"\0\"", 7), "s.toml:1:");
  malformed("a = \"\xff\xfe\"", "s.toml:1:");
  malformed(std::string(100'000, '['), "s.toml:1:");
  malformed("a = " + std::string(5000, '[') + std::string(5000, ']'), "s.toml:1:");
  malformed("frames = 1\nframes = 2\n" + kGood, "s.toml:2:1");
}

/// toml++ recurses over nested tables, and the stack overflows.
TEST(SceneFile, DeepNesting_IsAnErrorWithItsLine) {
  const auto times = [](std::size_t n, std::string_view text) {
    std::string all;
    for (std::size_t i = 0; i < n; ++i) all += text;
    return all;
  };
  const std::string many = times(199'999, "a.") + "a", most = times(99, "a.") + "a";
  const std::string part = "a key of 200000 parts; expected at most 100";
  malformed("title = \"t\"\n" + many + " = 1\n", "s.toml:2: " + part);
  malformed("# '\n\n[" + many + "]\n", "s.toml:3: " + part);
  malformed(times(199'999, "\"a\\\"#\" . ") + "a = 1", "s.toml:1: " + part);
  malformed(many, "s.toml:1: " + part);
  // The first of four quotes belongs to the text.
  malformed("a = {t = \"\"\"\n\\\"\"\"\"\", " + many + " = 1}", "s.toml:2: " + part);
  malformed("a = " + times(100'000, "[") + times(100'000, "]"),
            "s.toml:1: arrays and tables are nested 101 deep; expected at most 100");
  malformed("a = " + times(1000, "{" + times(10, "a.") + "a = "), "s.toml:1: arrays and tables");
  // At the limit, in strings and in comments it is no such error.
  malformed(most + " = 1\n" + kGood, "there is no key 'a' here");
  EXPECT_NO_THROW(
      (void)parse_scene("title = '''\n" + many + "'''\n# " + many + "\n" + kGood, "s.toml"));
}

TEST(SceneFile, WrongTypes_AreErrors) {
  malformed("frames = \"3\"\n" + kGood, "s.toml:1:10: frames: must be a whole number, not a text");
  malformed("frames = 3.5\n" + kGood, "must be a whole number");
  malformed("frames = [3]\n" + kGood, "not an array");
  malformed("frames = 1979-05-27\n" + kGood, "not a date or time");
  malformed("title = 3\n" + kGood, "title: must be a text, not a number");
  malformed("card = 3\n" + kGood, "card: must be a table");
  malformed("object = 3\n" + kHit, "object: must be a table or an array of tables");
  malformed("object = [1, 2]\n" + kHit, "object: must be a table");
  malformed("[[object]]\nname = \"x\"\nsphere = 3\n" + kGood,
            "object 'x', sphere: must be a table");
  malformed("[[object]]\nname = \"x\"\nsphere = { center = [0, 0], radius = 1 }\n" + kGood,
            "object 'x', sphere, center: must be an array of 3 numbers; it has 2");
  malformed("[[object]]\nname = \"x\"\nsphere = { center = [0, 0, true], radius = 1 }\n" + kGood,
            "must be a number, not true or false");
  malformed("[card]\necc = 1\n" + kGood, "card, ecc: must be true or false, not a number");
  malformed(kBall + kRays +
                "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=3\nsecondaries=\"ball\"",
            "primaries: must be a text or an array of texts");
}

TEST(SceneFile, NumbersOutOfRange_AreErrors) {
  for (const char* number : {"0", "-1", "1000001", "9223372036854775807"})
    refused(fmt::format("frames = {}\n", number) + kGood, "it must be 1 to 1000000");
  malformed("frames = 9223372036854775808\n" + kGood, "s.toml:1:");
  for (const char* rate : {"0", "-3", "nan", "inf", "1e300"})
    refused(fmt::format("rate = {}\n", rate) + kGood, "rate: is");
  const auto ball = [](const char* c, const char* r) {
    return fmt::format("[[object]]\nname=\"x\"\nsphere={{center=[{},0,0],radius={}}}\n", c, r) +
           kGood;
  };
  for (const char* c : {"nan", "inf", "-inf", "1e39", "-1e300"})
    refused(ball(c, "1"), "sphere, center: is");
  for (const char* r : {"0", "-1", "-0.0", "nan", "inf", "1e39"})
    refused(ball("0", r), "sphere, radius: is");
  refused(ball("0", "1e-60"), "radius is 0, must be > 0");
  refused("[[object]]\nname=\"x\"\naabb={min=[0,0,0],max=[1,0,1]}\n" + kGood,
          "max.y is 0, must be > min.y = 0");
  refused("[[object]]\nname=\"x\"\nray={origin=[0,0,0],direction=[0,0,0]}\n" + kGood,
          "direction is zero");
  refused(
      "[[object]]\nname=\"x\"\nrandom={shape=\"sphere\",count=-5,min=[0,0,0],max=[1,1,1],size=[1,2]"
      "}\n" +
          kGood,
      "count: is -5; it must be 1 to");
  refused(
      "[[object]]\nname=\"x\"\nrandom={shape=\"sphere\",count=5,min=[0,0,0],max=[1,-1,1],size=[1,2]"
      "}\n" +
          kGood,
      "max: must be at least min");
  refused(
      "[[object]]\nname=\"x\"\nrandom={shape=\"sphere\",count=5,min=[0,0,0],max=[1,1,1],size=[2,1]}"
      "\n" +
          kGood,
      "size: must be [SMALLEST, LARGEST]");
  refused("[[object]]\nname=\"x\"\ncamera={eye=[0,0,0],target=[0,0,0],width=4,height=4}\n" + kGood,
          "camera");
  refused("[card]\nlanes = 24\n" + kGood, "is 24; it must be a power of two");
  refused("[card]\nclock_mhz = 0\n" + kGood, "clock_mhz: is 0");
}

TEST(SceneFile, EmptyArrays_AreErrors) {
  refused("object = []\n" + kHit, "s.toml:1:10: object: is empty");
  refused("[[object]]\nname=\"x\"\nsphere=[]\n" + kGood, "object 'x', sphere: is empty");
  refused(kBall + kRays +
              "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=[]\nsecondaries=\"ball\"",
          "primaries: is empty");
  refused(ball_with("kind = \"path\"\npoints = []\nduration = 1"), "points: is empty");
  refused(ball_with("kind = \"keyframes\"\nkeyframe = []"), "keyframe: is empty");
  malformed(kBall, "there is no [[query]]");
  malformed("", "there is no [[object]]");
}

TEST(SceneFile, MissingOrCircularReferences_AreErrors) {
  refused(kBall + kRays +
              "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=\"rays\"\nsecondaries=\"bal\"",
          "there is no object 'bal' (did you mean 'ball'?)");
  const auto child = [](const char* name, const char* parent) {
    return fmt::format(
        "[[object]]\nname=\"{}\"\nparent=\"{}\"\nsphere={{center=[0,0,0],radius=1}}\n", name,
        parent);
  };
  refused(child("a", "b") + child("b", "c") + child("c", "a") + kGood, "form a cycle");
  refused(child("a", "a") + kGood, "form a cycle");
  refused(child("a", "nobody") + kGood, "there is no object 'nobody'");
  EXPECT_NO_THROW((void)parse_scene(child("a", "b") + child("b", "ball") + kGood, "s.toml"));
  refused(kBall + kGood, "another object has that name");
  refused(kGood + kHit, "another query has that name");
  refused(
      kBall + kRays +
          "[[query]]\nname=\"../q\"\npair=\"ray-sphere\"\nprimaries=\"rays\"\nsecondaries=\"ball\"",
      "becomes part of file names");
}

/// Every object follows the object behind it in the file.
TEST(SceneFile, LongChainsOfParents_AreRefusedInLinearTime) {
  const auto chain = [](unsigned objects) {
    std::string text;
    for (unsigned i = 0; i < objects; ++i)
      text += fmt::format("[[object]]\nname=\"o{}\"\nsphere={{center=[0,0,0],radius=1}}\n{}", i,
                          i + 1 < objects ? fmt::format("parent=\"o{}\"\n", i + 1) : "");
    return text + kGood;
  };
  const Scene longest = parse_scene(chain(kMostParents + 1), "s.toml");
  EXPECT_TRUE(is_still(longest, longest.objects[0]));
  EXPECT_TRUE(pose(longest, longest.objects[0], 0).translation.isZero());
  refused(chain(kMostParents + 2), "s.toml:4:8: object 'o0', parent: more than 1000 parents");
  refused(chain(40'000), "more than 1000 parents");
  // Objects without end, behind a chain that was followed before.
  refused(chain(50) +
              "[[object]]\nname=\"a\"\nparent=\"b\"\nsphere={center=[0,0,0],radius=1}\n"
              "[[object]]\nname=\"b\"\nparent=\"a\"\nsphere={center=[0,0,0],radius=1}\n",
          "the parents of 'a' and 'a' form a cycle");
}

TEST(SceneFile, MissingMeshesAndFiles_AreErrors) {
  const Folder folder;
  const std::string name = folder.write("s.toml", "").string();
  const auto with = [&](const std::string& source) {
    return "[[object]]\nname=\"x\"\n" + source + "\n" + kGood;
  };
  const auto fails = [&](const std::string& source, const std::string& why) {
    expect_error(ErrorCode::kFile, why, [&] { (void)parse_scene(with(source), name); });
  };
  fails("mesh = \"none.obj\"", "s.toml:3:8: object 'x', mesh: ");
  fails("rays_csv = \"none.csv\"", "object 'x', rays_csv: ");
  folder.write("bad.csv", "1,2,3\n");
  fails("rays_csv = \"bad.csv\"", "bad.csv:1");
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  fails("rays_csv = \"fifo\"", "fifo: is not a regular file");
  ASSERT_EQ(::mkfifo((folder / "fifo.obj").c_str(), 0600), 0);
  fails("mesh = \"fifo.obj\"", "fifo.obj: is not a regular file");
  folder.write("empty.csv", "\n");
  expect_error(ErrorCode::kBadInput, "empty.csv has no rays",
               [&] { (void)parse_scene(with("rays_csv = \"empty.csv\""), name); });
  folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(size(parse_scene(with("mesh = \"one.obj\""), name).objects[0].shapes), 1u)
      << "relative to the scene's folder";
  malformed(with("mesh = \"one.obj\"\nsphere = { center = [0,0,0], radius = 1 }"),
            "there must be one of");
}

TEST(SceneFile, ImpossibleRequests_AreRefused) {
  const std::string box = "[[object]]\nname=\"box\"\naabb={min=[0,0,0],max=[1,1,1]}\n";
  const std::string why = "an AABB cannot be rotated; use obb";
  impossible(box + "motion={kind=\"velocity\",angular=[0,0,1]}\n" + kGood, why);
  impossible(box + "motion={kind=\"still\",axis=[0,0,1],degrees=5}\n" + kGood, why);
  impossible(box +
                 "motion={kind=\"random\",each=true,min=[-9,-9,-9],max=[9,9,9],speed=1,spin=3}\n" +
                 kGood,
             why);
  impossible(
      box +
          "parent=\"turner\"\n[[object]]\nname=\"turner\"\nsphere={center=[0,0,0],radius=1}\n"
          "motion={kind=\"velocity\",angular=[0,0,1]}\n" +
          kGood,
      why);
  EXPECT_NO_THROW(
      (void)parse_scene(box + "motion={kind=\"velocity\",linear=[1,0,0]}\n" + kGood, "s.toml"));
  impossible(
      kBall + kRays +
          "[[query]]\nname=\"q\"\npair=\"obb-obb\"\nprimaries=\"rays\"\nsecondaries=\"ball\"",
      "obb-obb takes obbs and obbs, but the primaries are rays");
  impossible(kBall + kRays +
                 "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=[\"rays\",\"ball\"]"
                 "\nsecondaries=\"ball\"",
             "a query takes one shape on each side");
  impossible(kGood + "normals = true\n", "rays have no normals");
  impossible(kGood + "iterations = { samples = 8 }\n", "has no iterations");
  impossible(kGood + "mask = [0]\n", "leaves out every primary");
  refused(kGood + "mask = [5]\n", "must be ascending and within 0..0");
  malformed(kGood + "mask = [\"a..b\"]\n", "is not FIRST..LAST");
  impossible(
      "[[object]]\nname=\"x\"\nsphere={center=[0,0,0],radius=1}\n"
      "deform={kind=\"wave\",amplitude=[0,0,1],period=1,wavelength=1}\n" +
          kGood,
      "moves the vertices of a mesh");
  const std::string many =
      "[[object]]\nname=\"many\"\nrandom={shape=\"ray\",count=257,min=[0,0,0],max=[1,1,1]}\n";
  impossible(many + kGood +
                 "[[query]]\nname=\"p\"\npair=\"ray-sphere\"\nprimaries=\"many\"\n"
                 "secondaries=\"ball\"\npackets=1\n",
             "257 primaries overflow 1 packet of 256 and need 2");
}

TEST(SceneFile, InvalidMotions_AreErrors) {
  malformed(ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0]]"),
            "there must be one of duration, speed");
  malformed(ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0]]\nduration = 1\nspeed = 2"),
            "excludes");
  refused(ball_with("kind = \"path\"\npoints = [[0,0,0]]\nduration = 1"), "must be at least 2");
  refused(ball_with("kind = \"path\"\npoints = [[0,0,0],[0,0,0]]\nduration = 1"),
          "0 and the next point are the same");
  refused(
      ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0],[0,0,0]]\nloop = true\nduration = 1"),
      "a loop closes itself");
  const std::string key = "{time=0,position=[0,0,0]}";
  refused(ball_with("kind = \"keyframes\"\nkeyframe = [" + key + ", " + key + "]"),
          "times must increase");
  refused(ball_with("kind = \"still\"\nquaternion = [2, 0, 0, 0]"), "has length 2; it must be 1");
  refused(ball_with("kind = \"still\"\naxis = [0, 0, 0]\ndegrees = 3"), "has no direction");
  refused(ball_with("kind = \"random\"\nmin = [5, 5, 5]\nmax = [6, 6, 6]\nspeed = 1"),
          "starts outside the box");
  refused(ball_with("kind = \"random\"\neach = true\nmin = [5, 5, 5]\nmax = [6, 6, 6]\nspeed = 1"),
          "shape 0 starts outside the box");
}

TEST(SceneShapes, ChainsOfParents_AddTheirPoses) {
  const Scene s = parse_scene(
      "rate = 1\n[[object]]\nname=\"arm\"\nsphere={center=[0,0,0],radius=1}\n"
      "motion={kind=\"velocity\",angular=[0,0,90]}\n"
      "[[object]]\nname=\"hand\"\nparent=\"arm\"\nsphere={center=[1,0,0],radius=1}\n"
      "motion={kind=\"still\",position=[2,0,0]}\n" +
          kGood,
      "s.toml");
  const Shapes at = posed(local_shapes(s, s.objects[1], 1), pose(s, s.objects[1], 1));
  EXPECT_LE((std::get<std::vector<Sphere>>(at)[0].c - Eigen::Vector3f(0, 3, 0)).norm(), 1e-6f);
  EXPECT_FALSE(is_still(s, s.objects[1]));
  EXPECT_TRUE(is_still(s, s.objects[2]));
}

/// Only triangles at moving vertices change, and the ranges contain all of them.
TEST(SceneShapes, Deformation_StaysInItsRanges) {
  for (const char* kind : {"kind=\"random\"", "kind=\"wave\",period=1,wavelength=30"}) {
    const Scene s = parse_scene(fmt::format("[[object]]\nname=\"t\"\nmesh=\"terrain:10,10,1\"\n"
                                            "deform={{{},vertices=[30,45],amplitude=[1,2,3]}}\n",
                                            kind) +
                                    kGood,
                                "s.toml");
    const SceneObject& t = s.objects[0];
    const auto a = std::get<std::vector<Triangle>>(local_shapes(s, t, 3)),
               b = std::get<std::vector<Triangle>>(local_shapes(s, t, 4)),
               again = std::get<std::vector<Triangle>>(local_shapes(s, t, 3));
    const std::vector<Range> ranges = deforming(t);
    ASSERT_FALSE(ranges.empty());
    std::size_t changed = 0, in_ranges = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool same = to_words(a[i]) == to_words(b[i]);
      EXPECT_EQ(to_words(a[i]), to_words(again[i]));
      bool inside = false;
      for (const Range& r : ranges) inside = inside || (i >= r.first && i < r.first + r.count);
      changed += same ? 0 : 1;
      in_ranges += inside ? 1 : 0;
      EXPECT_TRUE(same || inside) << i;
      for (int k = 0; k < 3; ++k)
        EXPECT_LE(std::fabs(a[i].v0[k] - t.mesh->triangle(i).v0[k]),
                  1.0f + static_cast<float>(k) + 1e-3f);
    }
    EXPECT_GT(changed, 20u);
    EXPECT_LT(in_ranges, a.size() / 2);
  }
}

/// Poses in binary32 compared with binary64.
TEST(SceneShapes, Poses_AreRigid) {
  std::string text = "rate = 30\n";
  for (const char* shape : {"ray", "triangle", "sphere", "plane", "cylinder", "obb"}) {
    const bool sized = std::string(shape) != "ray" && std::string(shape) != "plane";
    text += fmt::format(
        "[[object]]\nname=\"{0}\"\nrandom={{shape=\"{0}\",count=20,min=[-1,-1,-1],max=[1,1,1]{1}}}"
        "\n"
        "motion={{kind=\"velocity\",linear=[1,2,3],angular=[40,50,60]}}\n",
        shape, sized ? ",size=[0.1,0.2]" : "");
  }
  const Scene s = parse_scene(text + kGood, "s.toml");
  for (std::size_t i = 0; i < 6; ++i) {
    const SceneObject& object = s.objects[i];
    const Pose exact = pose(object.motion, seconds(s, 77));
    const Shapes at = posed(object.shapes, pose(s, object, 77));
    std::visit(
        [](const auto& list) {
          for (const auto& shape : list) EXPECT_FALSE(defect(shape)) << *defect(shape);
        },
        at);
    if (const auto* boxes = std::get_if<std::vector<Obb>>(&at)) {
      const auto& before = std::get<std::vector<Obb>>(object.shapes);
      for (std::size_t k = 0; k < boxes->size(); ++k) {
        const Eigen::Vector3d c = exact * before[k].c.cast<double>();
        EXPECT_LE(((*boxes)[k].c.cast<double>() - c).norm(), 1e-5);
        const Eigen::Matrix3d r = exact.linear() * before[k].rotation.cast<double>();
        EXPECT_LE(((*boxes)[k].rotation.cast<double>() - r).cwiseAbs().maxCoeff(), 1e-6);
      }
    }
    if (const auto* planes = std::get_if<std::vector<Plane>>(&at)) {
      const auto& before = std::get<std::vector<Plane>>(object.shapes);
      for (std::size_t k = 0; k < planes->size(); ++k) {
        const Eigen::Vector3d on =
            exact * (before[k].n.cast<double>() * static_cast<double>(before[k].d));
        EXPECT_NEAR((*planes)[k].n.cast<double>().dot(on), (*planes)[k].d, 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace cde::testing
