// SPDX-License-Identifier: Apache-2.0
// Arguments of the command line: values, their ranges, names, and the order of refusals.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <sstream>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

class CommandLine : public Cli {};

/// The first invalid argument is reported.
TEST_F(CommandLine, SeveralMistakes_ReportTheFirst) {
  struct Case {
    Words words;
    std::string text;
  };
  const Case cases[] = {
      {{"cast", "m.obj", "-o", ""}, "-o is empty; it needs a value: FILE"},
      {{"cast", "m.obj", "--output=", "x.csv"}, "--output is empty; it needs a value: FILE"},
      {{"cast", ""}, "MESH is empty; it needs a value: MESH"},
      {{"cast", "m.obj", "-o"}, "-o needs a value: FILE"},
      {{"cast", "m.obj", "-o", "--json"}, "-o needs a value: FILE; '--json' is an option"},
      {{"cast", "m.obj", "-qo"}, "-o needs a value: FILE"},
      {{"cast", "m.obj", "--json=yes"}, "--json takes no value; it is 'yes'"},
      {{"cast"}, "cde cast needs MESH: Mesh file, or terrain[:QX,QY,SEED]"},
      {{"--json", "cast"}, "'--json' is an option of `cde cast`; put it after the verb"},
      {{"--bogus", "cast"}, "cde has no option '--bogus'; `cde --help` lists them"},
      {{"--"}, "a verb is missing; `cde --help` lists them"},
      {{"cast", "m.obj", "--shaded"}, "cde cast has no option '--shaded'; `cde render` has it"},
      {{"help", "cast", "info"}, "cde cast has no inner verbs; remove 'info'"},
      {{"cast", "m.obj", "--lanes", "4", "--lanes", "8"}, "--lanes is given twice"},
      {{"cast", "m.obj", "--output=a.csv", "-o", "b.csv"}, "-o is given twice"},
      {{"bench", "--quick", "--full"}, "--full cannot be combined with --quick"},
      {{"fp", "add", "-l", "0"}, "--lanes is '0'; it must be a whole number, 1 to 256"},
      {{"fp", "add", "-a", "x"}, "--arith is 'x'; it must be rtl or host"},
      {{"cast", "m.obj", "--boards", "010"},
       "--boards is '010'; it must be a whole number, 1 to 64"},
      {{"cast", "m.obj", "--size", "0x4", "--clock", "x", "--bogus"},
       "a picture of 0 x 4 pixels: each side must be 1 to 32768"},
      {{"cast", "m.obj", "--clock", "x", "--bogus", "--size", "0x4"},
       "--clock is 'x'; it must be 1 to 10000 MHz"},
      {{"cast", "m.obj", "--bogus", "--clock", "x"},
       "cde cast has no option '--bogus'; `cde cast --help` lists them"},
      {{"plan", "a.toml", "b.toml", "--bogus"},
       "cde plan takes no argument 'b.toml'; `cde plan --help` lists its arguments"},
      {{"run", "-"},
       "scene is '-'; it must be a file; standard input is /dev/stdin (cde run: with --output, "
       "because no scene file names the folder)"},
      {{"plan", "-"},
       "scene is '-'; it must be a file; standard input is /dev/stdin (cde run: with --output, "
       "because no scene file names the folder)"},
      {{"query", "sphere-shpere"}, "no pair 'sphere-shpere'; did you mean sphere-sphere?"},
      {{"inventory", "obb-ob"}, "no pair 'obb-ob'; did you mean obb-obb?"},
      {{"bench", "ray"}, "no section 'ray'; did you mean rays?"},
      {{"help", "qurey"}, "no verb 'qurey'; did you mean query?"},
      {{"query", "cylinder-cylinder", "--iterations", "8,8,99"},
       "--iterations: K2 is 99, expected 0 to 64"},
      {{"query", "sphere-sphere", "--format", "e4m3"},
       "--format is 'e4m3'; it must be fp16, bf16, tf32, fp24, fp32 or fp64"},
      {{"cast", "m.obj", "--fields", "u,x"},
       "no field 'x'; there are: u, v, normal, side, node, inside"},
      {{"cast", "terrain:3,3,1", "--ray", "0,0,9,0,0,-1", "-o", "-", "--fields", "u,u"},
       "--fields has 'u' twice"},
      {{"reproduce", "--out", "x.png"}, "--output is 'x.png'; its name must end in .html"},
      {{"cast", "terrain:3,3,1", "--ray", "0,0,9,0,0,-1", "--trace", "x.vcd"},
       "--trace is 'x.vcd'; its name must end in .fst"},
      {{"cast", "m\n\x1b[31m.obj", "--size"}, "--size needs a value: WxH"},
      {{"cast", "--\n\x1b[31m"},
       "cde cast has no option '--\\x0a\\x1b[31m'; `cde cast --help` lists them"},
      {{"cast", "m\n\x1b.obj", "--grid", "4x4"},
       "m\\x0a\\x1b.obj: cannot be opened: No such file or directory"},
      {{"cast", "terrain:3,3,1", "--rays", "m\n\x1b.npy"},
       "m\\x0a\\x1b.npy: cannot be opened: No such file or directory"},
      {{"plan", "m\n\x1b.toml"}, "m\\x0a\\x1b.toml: cannot be opened: No such file or directory"},
  };
  for (const Case& c : cases) refused_saying(c.words, c.text);
}

/// Options and flags without effect are refused before any file is read.
TEST_F(CommandLine, OptionsWithoutEffect_AreRefused) {
  struct Case {
    std::string words, text;
  };
  const std::string ray = "cast none.obj --ray 0,0,0,0,0,1 ", rays = "cast none.obj --grid 4x4 ",
                    picture = "render none.obj ", spheres = "query sphere-sphere ";
  const Case cases[] = {
      {ray + "--up y", "--up cannot be combined with --ray"},
      {"cast none.obj --up y --rays r.csv", "--rays cannot be combined with --up"},
      {ray + "--size 4x4", "--size cannot be combined with --ray"},
      {rays + "--size 4x4", "--size cannot be combined with --grid"},
      {rays + "--bits", "--bits needs --output"},
      {rays + "--fields u", "--fields needs --output"},
      {picture + "--bits", "--bits needs --output"},
      {picture + "--inside", "--inside needs --output"},
      {ray + "--bundle f --no-check", "--bundle cannot be combined with --no-check"},
      {ray + "--bundle f --no-bundle", "--no-bundle cannot be combined with --bundle"},
      {rays + "--check=rays:4 --no-bvh", "--check=rays:4 cannot be combined with --no-bvh"},
      {rays + "--trace t.fst --boards 2",
       "--trace cannot be combined with --boards; waves can show only one card"},
      {rays + "--trace-scope a", "--trace-scope needs --trace"},
      {rays + "--box --no-box", "--no-box cannot be combined with --box"},
      {rays + "--json --json", "--json is given twice"},
      {rays + "-q --quiet", "--quiet is given twice"},
      {rays + "--json --json --bogus", "--json is given twice"},
      {spheres + "--algorithm moller",
       "--algorithm cannot be combined with sphere-sphere; expected ray-triangle"},
      {spheres + "--sat-interval 1",
       "--sat-interval cannot be combined with sphere-sphere; expected obb-obb, triangle-aabb or "
       "triangle-obb"},
      {"query obb-obb --box --no-box", "--no-box cannot be combined with --box"},
      {spheres + "--bundle f --no-check", "--bundle cannot be combined with --no-check"},
      {spheres + "--no-check -k", "--keep-going cannot be combined with --no-check"},
      {"explain sphere-sphere 0 --algorithm moller",
       "--algorithm cannot be combined with sphere-sphere; expected ray-triangle"},
      {"explain sphere-sphere 0 --max 3 --json", "--max cannot be combined with --json"},
      {"explain sphere-sphere 0 --exact-card", "--exact-card needs --from-record"},
      {"explain --from-record a:b:0:0 --from-test x",
       "--from-test cannot be combined with --from-record"},
      {"explain sphere-sphere --from-test x",
       "PAIR cannot be combined with --from-test; it already names the pair"},
      {"run none.toml --check none --bundle f", "--bundle cannot be combined with --check none"},
      {"fp f32_add --format fp16", "--format fp16 cannot be combined with f32_add"},
      {"inventory sphere-sphere --sat-interval 1",
       "--sat-interval cannot be combined with sphere-sphere; expected obb-obb, triangle-aabb or "
       "triangle-obb"},
      {"bench effects --markdown --json", "--json cannot be combined with --markdown"},
      {"accuracy --mesh none.obj --no-operators", "--operators cannot be combined with --mesh"},
      {"wave find none.fst x --count --max 3", "--max cannot be combined with --count"},
      {"wave find none.fst x --first --last", "--last cannot be combined with --first"},
      {"wave show none.fst --ascii --json", "--json cannot be combined with --ascii"},
      {"wave show none.fst --from 1ns --around 2ns", "--around cannot be combined with --from"},
      {"wave show none.fst --window 3", "--window needs --around"},
      {"wave tx none.fst --columns 80", "--columns needs --histogram"},
      {"wave tx none.fst --csv --json", "--json cannot be combined with --csv"}};
  for (const Case& c : cases) {
    std::istringstream text(c.words);
    refused_saying({std::istream_iterator<std::string>(text), {}}, c.text);
  }
}

/// A request for help always succeeds, whatever other mistakes the line has.
TEST_F(CommandLine, BundleWithoutAName_IsRefused) {
  for (const std::string verb :
       {"query sphere-sphere", "cast terrain:3,3,1 --ray 0,0,9,0,0,-1", "run none.toml"})
    for (const auto& [folder, why] : {std::pair<std::string, std::string>{".", "ends with ."},
                                      {"..", "ends with .."},
                                      {"x/..", "ends with .."},
                                      {"x/./", "ends with ."},
                                      {"/", "is the root of the file system"}}) {
      std::istringstream text(verb + " --bundle " + folder);
      refused_saying(
          {std::istream_iterator<std::string>(text), {}},
          fmt::format("--bundle {}: it {}; expected the name of a new folder", folder, why));
    }
}

TEST_F(CommandLine, HelpBesideMistakes_IsPrinted) {
  const std::string text = cde({"help", "cast"}).out;
  for (const Words& words :
       {Words{"cast", "--bogus", "--help"}, Words{"cast", "--clock", "x", "-h"},
        Words{"cast", "-h", "--bogus"}, Words{"cast", "--help"}}) {
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, text);
  }
}

/// The help states the ranges that are checked. Both ends of a range are accepted, and values
/// beyond it are refused with the same range. A mistake after the value tells whether the value was
/// accepted.
TEST_F(CommandLine, Numbers_AreCheckedAsTheHelpStates) {
  static const std::regex option(
      R"(\n  (?:-[a-z], )?(--[a-z-]+) (?:NUMBER|CLOCK)((?:\n? {3,}[^\n]*)+))");
  static const std::regex range(R"(\(([0-9.e+]+) to ([0-9.e+]+)( [A-Za-z]+)?\))");
  unsigned checked = 0;
  for (const Words& verb :
       {Words{"cast", "m.obj"}, Words{"query", "sphere-sphere"}, Words{"run", "s.toml"},
        Words{"bench"}, Words{"reproduce"}, Words{"inventory"}, Words{"fp", "add"}}) {
    const std::string text = cde({"help", verb[0]}, {"COLUMNS=120"}).out;
    for (std::sregex_iterator at(text.begin(), text.end(), option), end; at != end; ++at) {
      const std::string name = (*at)[1];
      SCOPED_TRACE(verb[0] + " " + name);
      const std::string what = std::regex_replace((*at)[2].str(), std::regex(R"(\s+)"), " ");
      std::smatch found;
      ASSERT_TRUE(std::regex_search(what, found, range)) << what;
      ++checked;
      const double least = std::stod(found[1]), most = std::stod(found[2]);
      const auto says = [&](const std::string& value) {
        Words words = verb;
        words.insert(words.end(), {name, value, "--bogus"});
        const Ran ran = cde(words);
        EXPECT_EQ(ran.status, 2);
        return ran.err;
      };
      for (const std::string& taken : {found[1].str(), found[2].str()})
        EXPECT_TRUE(has(says(taken), "'--bogus'")) << taken;
      for (const std::string& beyond :
           {fmt::format("{}", least == 0 ? -1 : least / 2), fmt::format("{:.0f}", most * 2),
            std::string("1e-300"), std::string("nan"), std::string("inf"), std::string("1e"),
            std::string("0x8"), std::string("-1")})
        EXPECT_TRUE(has(says(beyond), fmt::format("{} is '{}'; it must be ", name, beyond)));
      EXPECT_TRUE(has(says("x"),
                      fmt::format("{} to {}{}", found[1].str(), found[2].str(), found[3].str())));
    }
  }
  EXPECT_GE(checked, 10u);
}

/// The same for words: each word in the help is accepted, and another one is refused.
TEST_F(CommandLine, Words_AreCheckedAsTheHelpStates) {
  static const std::regex option(R"(\n  (?:-[a-z], )?(--[a-z-]+) ((?:[a-z0-9-]+\|)+[a-z0-9-]+))");
  unsigned checked = 0;
  for (const Words& verb : {Words{"cast", "m.obj"}, Words{"query", "sphere-sphere"},
                            Words{"run", "s.toml"}, Words{"inventory"}, Words{"fp", "add"}}) {
    const std::string text = cde({"help", verb[0]}, {"COLUMNS=120"}).out;
    for (std::sregex_iterator at(text.begin(), text.end(), option), end; at != end; ++at) {
      ++checked;
      const std::string name = (*at)[1];
      std::istringstream all((*at)[2].str() + "|zzz");
      for (std::string word; std::getline(all, word, '|');) {
        Words words = verb;
        words.insert(words.end(), {name, word, "--bogus"});
        const std::string wrong = word == "zzz" ? name + " is 'zzz'; it must be " : "'--bogus'";
        EXPECT_TRUE(has(cde(words).err, wrong)) << verb[0] << name << word;
      }
    }
  }
  EXPECT_GE(checked, 9u);
}

TEST_F(CommandLine, LongWords_AreShortenedInMessages) {
  const std::string name(100'000, 'n');
  const std::string cut =
      std::string(100, 'n') + "..." + std::string(50, 'n') + " (100000 characters)";
  Ran ran = cde({"cast", name, "--ray", "0,0,9,0,0,-1"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, cut));
  EXPECT_LT(ran.err.size(), 1000u);
  ran = cde({"cast", "terrain:3,3,1", "--ray", "0,0,9,0,0,-1", "-o", name});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, cut));
  std::string words = "mesh = \"";
  while (words.size() < 1'000'000) words += "part of a name ";
  write("s.toml", "[[object]]\nname = \"t\"\n" + words + ".stl\"\n" + hit_query("t"));
  ran = cde({"plan", "s.toml"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_LT(ran.err.size(), 6000u);
}

/// A header without records would look like a result.
TEST_F(CommandLine, FailingCard_LeavesStdoutEmpty) {
  const Ran ran = cde({"cast", "terrain:3,3,1", "--ray", "0,0,9,0,0,-1", "--lanes", "4", "-q", "-o",
                       "-", "--deadline", "10"});
  EXPECT_EQ(ran.status, 4) << ran.err;
  EXPECT_EQ(ran.out, "");
}

class MeshInputFiles : public Cli {};

/// Materials, buffers and textures of a mesh are inputs, even if the reader does not open them.
TEST_F(MeshInputFiles, FilesNamedByAMesh_AreNotOverwritten) {
  write("one.obj", "mtllib one.mtl\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  write("one.mtl", "newmtl a\nmap_Kd -bm 0.5 skin.png\n");
  write("skin.png", "pixels");
  write("wood.png", "pixels");
  // Three corners of 12 bytes and three numbers of 2 bytes.
  const std::string corners(
      "\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\0\0\0\0\x80\x3f"
      "\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\1\0\2\0",
      42);
  write("one.bin", corners);
  write("one.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,
"material":0}]}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"textures":[{"source":0}],"images":[{"uri":"wood.png"}],
"buffers":[{"uri":"one.bin","byteLength":42}],"bufferViews":[{"buffer":0,"byteLength":36},
{"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[{"bufferView":0,"componentType":5126,
"count":3,"type":"VEC3","min":[0,0,1],"max":[1,1,1]},{"bufferView":1,"componentType":5123,
"count":3,"type":"SCALAR"}]})");
  // The same with names that a URI encodes.
  write("two c.bin", corners);
  write("two w.png", "pixels");
  std::string encoded = read("one.gltf");
  encoded.replace(encoded.find("one.bin"), 7, "two%20c.bin");
  encoded.replace(encoded.find("wood.png"), 8, "two%20w%2Epng");
  write("two.gltf", encoded);
  write("three.obj", "mtllib three%20m.mtl\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  write("three m.mtl", "newmtl a\nmap_Kd two%20w.png\n");
  const std::string scene = R"([[object]]
name = "t"
mesh = "MESH"
[[object]]
name = "rays"
random_rays = { count = 3 }
[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = "t"
)";
  const auto before = files();
  for (const auto& [mesh, file] : {std::pair<std::string, std::string>{"one.obj", "one.mtl"},
                                   {"one.obj", "skin.png"},
                                   {"one.gltf", "one.bin"},
                                   {"two.gltf", "two c.bin"},
                                   {"two.gltf", "two w.png"},
                                   {"three.obj", "three m.mtl"},
                                   {"three.obj", "two w.png"},
                                   {"one.gltf", "wood.png"}}) {
    SCOPED_TRACE(mesh + " " + file);
    const std::string held = read(file);
    fs::create_directory(folder_ / "scenes");
    std::string text = scene;
    write("scenes/s.toml", text.replace(text.find("MESH"), 4, "../" + mesh));
    const Ran run = cde({"run", "scenes/s.toml", "--out", "r.run", "--report", file});
    EXPECT_EQ(run.err, fmt::format("cde: --report would write to {}, which the mesh of object 't' "
                                   "reads\n",
                                   file));
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(read(file), held);
    fs::remove_all(folder_ / "scenes");
  }
  EXPECT_EQ(files(), before);
  const Ran picture =
      cde({"render", "one.gltf", "--grid", "4x4", "--lanes", "4", "--shaded", "wood.png"});
  EXPECT_EQ(picture.err, "cde: --shaded would write to wood.png, which MESH reads\n");
  const Ran skin =
      cde({"render", "one.obj", "--grid", "4x4", "--lanes", "4", "--shaded", "skin.png"});
  EXPECT_EQ(skin.err, "cde: --shaded would write to skin.png, which MESH reads\n");
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace cde::testing
