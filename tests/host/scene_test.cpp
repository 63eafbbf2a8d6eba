// SPDX-License-Identifier: Apache-2.0
// Scene files: what they say, and that whatever is wrong is named with its line and key.
#include "cde/scene/scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "cde/scene/plan.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

const std::string kBall =
    "[[object]]\nname = \"ball\"\nsphere = { center = [1, 2, 3], radius = 0.5 }\n";
const std::string kRays =
    "[[object]]\nname = \"rays\"\nray = { origin = [0, 0, 0], direction = [0, 0, 1] }\n";
const std::string kHit =
    "[[query]]\nname = \"q\"\npair = \"ray-sphere\"\nprimaries = \"rays\"\nsecondaries = "
    "\"ball\"\n";
const std::string kGood = kBall + kRays + kHit;

void refused(const std::string& text, const std::string& why,
             ErrorCode code = ErrorCode::kBadInput) {
  SCOPED_TRACE(text.substr(0, 2000));
  expect_error(code, why, [&] { (void)parse_scene(text, "s.toml"); });
}

void malformed(const std::string& text, const std::string& why) {
  refused(text, why, ErrorCode::kFile);
}
void impossible(const std::string& text, const std::string& why) {
  refused(text, why, ErrorCode::kUsage);
}

std::string ball_with(const std::string& motion) {
  return kBall + "[object.motion]\n" + motion + "\n" + kRays + kHit;
}

TEST(SceneFile, SaysWhatItSays) {
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
  EXPECT_EQ(s.card.lanes, 8u);
  EXPECT_EQ(s.card.clock_hz, 50e6);
  ASSERT_EQ(s.objects.size(), 2u);
  const auto& ball = std::get<std::vector<Sphere>>(s.objects[0].shapes).at(0);
  EXPECT_EQ(ball.c, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(ball.r, 0.5f);
  ASSERT_EQ(s.queries.size(), 1u);
  EXPECT_EQ(s.queries[0].mode, Mode::kAny);
  EXPECT_FALSE(s.queries[0].swap);
  EXPECT_EQ(seconds(s, 5), 0.5);
}

TEST(SceneFile, EverySceneOfTheRepositoryIsPlanned) {
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
      EXPECT_EQ(e.cost.find("not measured"), std::string::npos) << e.name;
    }
    ++scenes;
  }
  EXPECT_GE(scenes, 5);
}

TEST(SceneFile, EveryPrimitive) {
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

TEST(SceneFile, UnknownKeysAreErrorsWithTheNearestKnownOne) {
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
            "the key 'radius' is missing; 'raduis' is no key");
  malformed(ball_with("kind = \"velocity\"\nliner = [0,0,0]"), "(did you mean 'linear'?)");
  refused(kGood + "mode = \"neerest\"\n", "did you mean 'nearest'?");
  refused(ball_with("kind = \"pth\""), "did you mean 'path'?");
  malformed("[[objekt]]\n" + kGood, "there is no key 'objekt' here (did you mean 'object'?)");
}

TEST(SceneFile, TruncatedAtEveryByte) {
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
  EXPECT_GE(errors, static_cast<int>(text.size()) - 30) << "only the tail can be missing";
  EXPECT_NO_THROW((void)parse_scene(text, "s.toml"));
}

TEST(SceneFile, NotToml) {
  malformed("= 3", "s.toml:1:1");
  malformed("a = [1,\n", "s.toml:");
  malformed(std::string("a = \"\0\"", 7), "s.toml:1:");
  malformed("a = \"\xff\xfe\"", "s.toml:1:");
  malformed(std::string(100'000, '['), "s.toml:1:");
  malformed("a = " + std::string(5000, '[') + std::string(5000, ']'), "s.toml:1:");
  malformed("frames = 1\nframes = 2\n" + kGood, "s.toml:2:1");
}

TEST(SceneFile, WrongTypes) {
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
            "object 'x', sphere, center: must be an array of 3 numbers, not of 2");
  malformed("[[object]]\nname = \"x\"\nsphere = { center = [0, 0, true], radius = 1 }\n" + kGood,
            "must be a number, not true or false");
  malformed("[card]\necc = 1\n" + kGood, "card, ecc: must be true or false, not a number");
  malformed(kBall + kRays +
                "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=3\nsecondaries=\"ball\"",
            "primaries: must be a text or an array of texts");
}

TEST(SceneFile, NumbersOutOfRange) {
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

TEST(SceneFile, EmptyArrays) {
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

TEST(SceneFile, ReferencesToNothingOrInACircle) {
  refused(kBall + kRays +
              "[[query]]\nname=\"q\"\npair=\"ray-sphere\"\nprimaries=\"rays\"\nsecondaries=\"bal\"",
          "there is no object 'bal' (did you mean 'ball'?)");
  const auto child = [](const char* name, const char* parent) {
    return fmt::format(
        "[[object]]\nname=\"{}\"\nparent=\"{}\"\nsphere={{center=[0,0,0],radius=1}}\n", name,
        parent);
  };
  refused(child("a", "b") + child("b", "c") + child("c", "a") + kGood, "in a circle");
  refused(child("a", "a") + kGood, "in a circle");
  refused(child("a", "nobody") + kGood, "there is no object 'nobody'");
  EXPECT_NO_THROW((void)parse_scene(child("a", "b") + child("b", "ball") + kGood, "s.toml"));
  refused(kBall + kGood, "there is another object of that name");
  refused(kGood + kHit, "there is another query of that name");
  refused(
      kBall + kRays +
          "[[query]]\nname=\"../q\"\npair=\"ray-sphere\"\nprimaries=\"rays\"\nsecondaries=\"ball\"",
      "becomes part of file names");
}

TEST(SceneFile, MeshesAndFilesThatAreNotThere) {
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
  folder.write("empty.csv", "\n");
  expect_error(ErrorCode::kBadInput, "empty.csv has no rays",
               [&] { (void)parse_scene(with("rays_csv = \"empty.csv\""), name); });
  folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(size(parse_scene(with("mesh = \"one.obj\""), name).objects[0].shapes), 1u)
      << "relative to the scene's folder";
  malformed(with("mesh = \"one.obj\"\nsphere = { center = [0,0,0], radius = 1 }"),
            "there must be one of");
}

TEST(SceneFile, ImpossibleRequests) {
  const std::string box = "[[object]]\nname=\"box\"\naabb={min=[0,0,0],max=[1,1,1]}\n";
  const std::string why = "an AABB cannot be rotated, it would become an OBB";
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
  impossible(kGood + "budget = { samples = 8 }\n", "always takes the same work");
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

TEST(SceneFile, MotionsThatMakeNoSense) {
  malformed(ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0]]"),
            "there must be one of duration, speed");
  malformed(ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0]]\nduration = 1\nspeed = 2"),
            "excludes");
  refused(ball_with("kind = \"path\"\npoints = [[0,0,0]]\nduration = 1"), "must be at least 2");
  refused(ball_with("kind = \"path\"\npoints = [[0,0,0],[0,0,0]]\nduration = 1"),
          "0 and the next are the same");
  refused(
      ball_with("kind = \"path\"\npoints = [[0,0,0],[1,0,0],[0,0,0]]\nloop = true\nduration = 1"),
      "a loop closes by itself");
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

TEST(SceneShapes, ChainsOfParents) {
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

/// Only triangles at the moving vertices change, and the ranges name all of them.
TEST(SceneShapes, DeformationStaysInItsRanges) {
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

/// Posing by binary32 against binary64.
TEST(SceneShapes, PosesAreRigid) {
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

// ---- Plans ----

const Effect& effect(const Plan& p, const std::string& name) {
  for (const Effect& e : p.effects)
    if (e.name == name) return e;
  throw std::runtime_error("no effect " + name);
}

TEST(Plan, TakesWhatTheSceneNeeds) {
  const Scene s = parse_scene(kGood, "s.toml");
  const Plan p = plan(s);
  EXPECT_EQ(p.board.pairs, std::vector<Pair>{Pair::kRaySphere});
  EXPECT_EQ(p.board.lanes, 16u) << "one primary: the smallest of the sizes that scenes share";
  EXPECT_FALSE(p.board.swap || p.board.normals || p.board.trace || p.board.parallel);
  EXPECT_FALSE(effect(p, "transformer").used);
  EXPECT_EQ(effect(p, "transformer").why, "no secondary moves as a rigid body");
  EXPECT_FALSE(effect(p, "normals").used);
  EXPECT_FALSE(effect(p, "trace").used);
}

TEST(Plan, WhatSimulationsCostIsMeasured) {
  const Plan p = plan(parse_scene(kGood, "s.toml"));
  for (const char* name : {"pipes", "gates", "transformer", "normals", "exchange of roles",
                           "two pairs at a time", "bus timing", "memory timing", "ecc", "trace"}) {
    const std::optional<double> times = simulation_cost(name);
    ASSERT_TRUE(times) << name;
    EXPECT_GT(*times, 0.8) << name << ": nothing makes a simulation much faster";
    EXPECT_LT(*times, 100) << name;
    EXPECT_NE(effect(p, name).cost.find(fmt::format("takes {:.1f} times as long", *times)),
              std::string::npos)
        << effect(p, name).cost;
  }
  EXPECT_FALSE(simulation_cost("lanes")) << "counted from the scene";
}

TEST(Plan, LanesGrowWithThePrimaries) {
  const auto lanes = [](unsigned count, const char* card = "") {
    return plan(parse_scene(
                    fmt::format("{}[[object]]\nname=\"many\"\nrandom={{shape=\"ray\",count={}"
                                ",min=[0,0,0],max=[1,1,1]}}\n{}[[query]]\nname=\"q\"\n"
                                "pair=\"ray-sphere\"\nprimaries=\"many\"\nsecondaries=\"ball\"\n",
                                card, count, kBall),
                    "s.toml"))
        .board.lanes;
  };
  for (const unsigned few : {1u, 3u, 16u}) EXPECT_EQ(lanes(few), 16u);
  for (const unsigned more : {17u, 64u}) EXPECT_EQ(lanes(more), 64u);
  for (const unsigned many : {65u, 100u, 256u}) EXPECT_EQ(lanes(many), 128u);
  EXPECT_EQ(lanes(5000), 128u);
  EXPECT_EQ(lanes(5000, "[card]\nlanes = 2\n"), 2u);
  EXPECT_EQ(lanes(5000, "[card]\narithmetic = \"rtl\"\n"), 16u);
  EXPECT_EQ(lanes(3, "[card]\narithmetic = \"rtl\"\n"), 4u) << "gates take minutes to build";
}

/// What one query needs the card has, whichever query it is.
TEST(Plan, TakesWhatAnyQueryNeeds) {
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

TEST(Plan, CountsWork) {
  const Plan p = plan(load_scene(std::filesystem::path(CDE_MESHES) / "scenes/spheres.toml"));
  ASSERT_EQ(p.queries.size(), 1u);
  const QueryWork& w = p.queries[0];
  EXPECT_EQ(w.primaries, 1000u);
  EXPECT_EQ(w.packets, 4u);
  EXPECT_EQ(w.passes, 4u);
  EXPECT_TRUE(w.self_pairs);
  EXPECT_EQ(w.tests, 256u * (999 + 743 + 487) + 232 * 231) << "each packet sweeps what is behind";
  EXPECT_EQ(w.most_records, 499'500u);
  EXPECT_EQ(p.board.lanes, 128u);
  EXPECT_EQ(w.rows, 2u * (999 + 743 + 487 + 231)) << "232 in the last packet";
  EXPECT_EQ(w.secondary_words, 4000u);
  EXPECT_EQ(w.moved_words, 4000u);
  EXPECT_NE(effect(p, "transformer").cost.find("12000"), std::string::npos);
  const Plan objects =
      plan(load_scene(std::filesystem::path(CDE_MESHES) / "scenes/flight_objects.toml"));
  EXPECT_EQ(effect(objects, "transformer").cost, "24 words a frame; the host would upload 20736");
  EXPECT_EQ(objects.queries[0].moved_words, 24u);
}

TEST(Plan, RefusesAPairThatTheBitstreamHasNot) {
  const Scene s =
      parse_scene("[card]\npairs = [\"obb-obb\", \"ray-triangle\"]\n" + kGood, "s.toml");
  expect_error(ErrorCode::kUsage,
               "query 'q' needs a pipe for ray-sphere, but the bitstream asked for has pairs = "
               "ray-triangle, obb-obb",
               [&] { (void)plan(s); });
}

TEST(Plan, MovesObjectsWhereThatTakesFewerWords) {
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
  const Plan host = of("frames=2\n[card]\nmover=\"host\"\n" + all);
  EXPECT_EQ(host.board.transform, Transformer::kNone);
  EXPECT_EQ(host.card_moves, none);
  const std::uint64_t vertices = card.queries[0].moved_words - 24;  // of b and c
  EXPECT_EQ(vertices % (2 * 9), 0u);
  EXPECT_GT(vertices, 0u);
  EXPECT_EQ(host.queries[0].moved_words, 2 * 216 * 9 + vertices / 2);
  EXPECT_EQ(effect(card, "transformer").cost,
            fmt::format("{} words a frame; the host would upload 3888", 24 + vertices / 2));
  EXPECT_EQ(effect(host, "transformer").cost,
            fmt::format("uploads 3888 words a frame; a transformer would take {} for 2 objects",
                        24 + vertices / 2));

  EXPECT_EQ(of(all).board.transform, Transformer::kNone) << "one frame";
  const std::string two = objects + query("q", "\"a\"") + query("r", "\"b\"");
  EXPECT_EQ(of("frames=2\n" + two).board.transform, Transformer::kNone) << "always uploaded";
  EXPECT_EQ(of("frames=2\n[card]\nmover=\"card\"\n" + two).card_moves, moved);
}

TEST(Plan, MovesPrimariesThatStayLoaded) {
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
  loaded(of(drawn(256, "true") + moving), 256 * 8, "they are other ones in every frame");
  loaded(of(drawn(257, "false") + moving), 257 * 8, "they are loaded packet by packet");
  loaded(of(drawn(256, "false") + moving, "[card]\nmover=\"host\"\n"), 256 * 8, "mover = \"host\"");
  loaded(of(drawn(1, "false") + moving), 8, "loading them again takes no more words");
}

TEST(Plan, TablesOfObjectsHaveAnEnd) {
  const auto of = [](int boxes, const char* mover) {
    return plan(parse_scene(
        fmt::format("frames=2\n[card]\nmover=\"{}\"\n[[object]]\nname=\"boxes\"\n"
                    "random={{shape=\"obb\",count={},min=[-1,-1,-1],max=[1,1,1],size=[0.1,0.2]}}\n"
                    "motion={{kind=\"random\",each=true,min=[-1,-1,-1],max=[1,1,1],speed=1}}\n"
                    "{}[[query]]\nname=\"q\"\npair=\"sphere-obb\"\nprimaries=\"ball\"\n"
                    "secondaries=\"boxes\"\n",
                    mover, boxes, kBall),
        "s.toml"));
  };
  EXPECT_EQ(of(1024, "auto").board.objects, 1024u);
  EXPECT_EQ(of(1025, "auto").board.objects, 2048u);
  EXPECT_EQ(of(2048, "card").queries[0].moved_words, 2048u * 12);
  const Plan host = of(2049, "auto");
  EXPECT_EQ(host.board.transform, Transformer::kNone);
  EXPECT_EQ(effect(host, "transformer").why, "more objects than the 2048 of a card's table");
  expect_error(ErrorCode::kUsage,
               "s.toml: card, mover = \"card\": query 'q' has 2049 objects of secondaries, every "
               "shape that moves on its own being one, but a card's table holds 2048; use mover = "
               "\"host\"",
               [&] { (void)of(2049, "card"); });
}

/// A range that the host writes again is one entry, however many shapes in it move.
TEST(Plan, WhatTheHostMovesIsOneEntry) {
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
TEST(Plan, SecondariesStayIfAllQueriesHaveTheSame) {
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

TEST(Plan, TakesTheBusAndTheCheckBitsThatAreAskedFor) {
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

TEST(Plan, TakesTheVerdictsThatAreAskedFor) {
  const auto spheres = [](const char* card, const char* mode) {
    return fmt::format(
        "[card]\n{}\n{}[[query]]\nname=\"q\"\npair=\"sphere-sphere\"\nprimaries=\"ball\"\n"
        "secondaries=\"ball\"\nmode=\"{}\"\n",
        card, kBall, mode);
  };
  const Plan none = plan(parse_scene(spheres("", "hits"), "s.toml"));
  EXPECT_FALSE(none.board.verdicts);
  EXPECT_FALSE(effect(none, "verdicts").used);
  const Plan hits = plan(parse_scene(spheres("verdicts = \"bf16\"", "hits"), "s.toml"));
  EXPECT_EQ(hits.board.verdicts, FpFormat::parse("bf16"));
  EXPECT_TRUE(effect(hits, "verdicts").used);
  EXPECT_EQ(effect(hits, "verdicts").choice, "bf16 lanes before one of fp32");
  EXPECT_EQ(effect(hits, "verdicts").why, "asked for; misses are left out by q");
  const Plan nearest = plan(parse_scene(spheres("verdicts = \"bf16\"", "nearest"), "s.toml"));
  EXPECT_NE(effect(nearest, "verdicts").why.find("every pair goes through the wide lane"),
            std::string::npos);
  const auto refused = [&](const char* card, const char* why) {
    try {
      (void)plan(parse_scene(spheres(card, "hits"), "s.toml"));
      ADD_FAILURE() << "not refused: " << card;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refused("verdicts = \"fp33\"", "card, verdicts: ");
  refused("verdicts = 16", "card, verdicts: must be a text");
  refused("verdicts = \"fp32\"",
          "s.toml:2:12: card, verdicts: verdicts in fp32 cannot stand before fp32");
  refused("verdicts = \"fp24\"\nformat = \"fp16\"", "verdicts in fp24 cannot stand before fp16");
  refused("verdicts = \"fp16\"\nlanes = 64", "with verdicts it must be 1 to 32");
  try {
    (void)plan(parse_scene("[card]\nverdicts = \"fp16\"\n" + kGood, "s.toml"));
    ADD_FAILURE() << "rays have no verdicts";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("of which the card has none"), std::string::npos);
  }
}

TEST(Plan, SaysWhoseTimesAreModelled) {
  const Plan bare = plan(parse_scene(kGood, "s.toml"));
  EXPECT_NE(effect(bare, "bus timing").why.find("host ideal, 64 bits, bursts of 4096 bytes"),
            std::string::npos);
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
  EXPECT_NE(effect(old, "bus timing").why.find("host p64-2001, 32 bits, bursts of 256 bytes"),
            std::string::npos);
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

TEST(Plan, RefusesMoreThanTheMemoryHolds) {
  Scene s = parse_scene(kGood, "s.toml");
  // 2^24 spheres a group, more groups than DDR holds; built by hand, as a file would take minutes.
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
