// SPDX-License-Identifier: Apache-2.0
// cde wave why: causes in waves with known values, for designs whose structure Verilator writes
// during the test.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "why.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

INSTANTIATE_TEST_SUITE_P(Structure, WhyStructure, ::testing::Values(".xml", ".tree.json"),
                         [](const auto& form) { return form.index == 0 ? "Xml" : "Json"; });

TEST_P(WhyStructure, Causes_FollowLogicNowAndRegistersBeforeTheirEdge) {
  structure("top");
  const Json j = why("a.fst", "state@cyc:9", "top.xml", {"--depth", "1"});
  EXPECT_EQ(j["schema"], "cde.wave.why.1");
  EXPECT_EQ(j["top_scope"], "top");
  const Json& root = j["cone"];
  EXPECT_EQ(root["value"], "0");
  ASSERT_EQ(root["statements"].size(), 1u);
  const Json& taken = root["statements"][0];
  EXPECT_EQ(taken["taken_time"], 95);
  EXPECT_EQ(taken["line"], 25);
  EXPECT_EQ(taken["register"], true);
  EXPECT_EQ(taken["source_text"], "if (count >= 8'd2) state <= 3'((count + 8'd1) % 8'd3);");
  EXPECT_EQ(causes(taken), Texts{"top.count=00001000@94:21"});
  EXPECT_TRUE(taken["causes"][0]["statements"][0]["causes"].empty())
      << "a second register ends the cone";
  const Json through = why("a.fst", "state@cyc:9", "top.xml", {"--depth", "2"});
  EXPECT_EQ(causes(through["cone"]["statements"][0]["causes"][0]["statements"][0]),
            Texts{"top.count=00000111@84:21"});
}

TEST_P(WhyStructure, SignalsOutsideTheWaves_AreTraversed) {
  structure("top");
  const Json high = why("a.fst", "data[63:32]:fp32@cyc:7", "top.xml")["cone"];
  EXPECT_EQ(high["value"], "nan");
  EXPECT_EQ(high["driven_name"], "top.core.data_o[63:32]");
  ASSERT_EQ(high["statements"].size(), 1u);
  EXPECT_EQ(high["statements"][0]["line"], 9);
  const Json& late = high["statements"][0]["causes"][0];
  EXPECT_EQ(late["name"], "top.core.late");
  EXPECT_EQ(late["in_waves"], false);
  EXPECT_TRUE(late["value"].is_null());
  EXPECT_EQ(causes(late["statements"][0]), Texts{"top.core.count=00000111@75:21"});
  // The whole word has both lines, and its lower half the other line.
  const Json all = why("a.fst", "data@cyc:7", "top.xml")["cone"]["statements"];
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["line"], 9);
  EXPECT_EQ(all[1]["line"], 10);
  EXPECT_EQ(why("a.fst", "data[3]@cyc:7", "top.xml")["cone"]["statements"][0]["line"], 10);
  // The signal can also be named itself.
  EXPECT_EQ(why("a.fst", "top.core.late@cyc:7", "top.xml")["cone"]["statements"][0]["line"], 8);
}

TEST_P(WhyStructure, Text_HasALineEachUpToTheLimit) {
  structure("top");
  const Ran ran = cde({"wave", "why", "a.fst", "count@cyc:7", "--structure", file("top.xml"),
                       "--max", "2", "--depth", "9"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out,
            "top.count is 07 at 75ns, cyc:7\n"
            "names below are in top\n"
            "signal   value  taken  line       source\n"
            "count    07     75ns   top.sv:21  always_ff @(posedge clk) count <= count + 8'd1;\n"
            "  count  06     65ns   top.sv:21  always_ff @(posedge clk) count <= count + 8'd1;\n"
            "... 1 more (--max 0 prints all)\n");
  EXPECT_EQ(why("a.fst", "count@cyc:7", "top.xml", {"--depth", "9", "--max", "0"})["more"], 0);
}

/// Conditions, cases, structures, memories, functions and generate loops (rich.sv). The clock rises
/// at 10, 20, ..., and reset is at 12. From 15 to 25 en is 1, and x = 1010 goes into s and mem[2].
/// The state is RUN from 30 on, and STOP from 40 on.
class WhyRichDesign : public WhyStructure {
 protected:
  void SetUp() override {
    WhyStructure::SetUp();
    structure("rich");
    Writer w(folder_ / "rich.fst");
    w.scope("bench");
    w.scope("dut");
    const fstHandle clk = w.signal("clk", 1), rst = w.signal("rst", 1), en = w.signal("en", 1),
                    x = w.signal("x [3:0]", 4), y = w.signal("y [3:0]", 4),
                    state = w.signal("state [1:0]", 2), mem2 = w.signal("mem[2] [3:0]", 4),
                    pick = w.signal("pick [3:0]", 4);
    w.scope("s");
    const fstHandle v = w.signal("v", 1), d = w.signal("d [2:0]", 3);
    w.up();
    w.scope("half[0]");
    w.scope("part");
    w.signal("q [1:0]", 2);
    w.up();
    w.up();
    w.up();
    w.up();
    for (unsigned t = 0; t <= 60; ++t) {
      w.time(t);
      if (t % 10 == 5 || t == 0) w.set(clk, 0);
      if (t == 0 || t == 14) w.set(rst, 0);
      if (t == 12) w.set(rst, 1);
      if (t == 0 || t == 25) w.set(en, 0);
      if (t == 15) w.set(en, 1);
      if (t == 0) w.set(x, 3), w.set(state, 0), w.set(mem2, 0), w.set(y, 0), w.set(pick, 0);
      if (t == 15) w.set(x, 10);
      if (t == 25) w.set(x, 4), w.set(pick, 4);
      if (t != 0 && t % 10 == 0) w.set(clk, 1);
      if (t == 12) w.set(v, 0), w.set(d, 0);
      if (t == 20) w.set(v, 1), w.set(d, 2), w.set(mem2, 10), w.set(pick, 10);
      if (t == 30) w.set(state, 1), w.set(y, 4);
      if (t == 40) w.set(state, 2);
    }
  }
};

TEST_P(WhyRichDesign, BranchesNotTaken_AreOmitted) {
  const Json run = why("rich.fst", "state@30", "rich.xml", {"--depth", "1"})["cone"];
  ASSERT_EQ(run["statements"].size(), 1u);
  EXPECT_EQ(run["statements"][0]["line"], 19);
  EXPECT_EQ(causes(run["statements"][0]),
            (Texts{"if bench.dut.state=00@29", "if bench.dut.s.v=1@29:16"}));
  EXPECT_EQ(why("rich.fst", "state@40", "rich.xml")["cone"]["statements"][0]["line"], 20);
  // pick is a copy of mem[2] while en is 1, and otherwise of the sum.
  const Json with = why("rich.fst", "pick@20", "rich.xml")["cone"]["statements"];
  ASSERT_EQ(with.size(), 1u);
  EXPECT_EQ(with[0]["line"], 27);
  EXPECT_EQ(causes(with[0])[0], "bench.dut.mem[2]=1010@20:23");
  const Json without = why("rich.fst", "pick@26", "rich.xml")["cone"]["statements"];
  ASSERT_EQ(without.size(), 1u);
  EXPECT_EQ(without[0]["line"], 26);
  EXPECT_EQ(causes(without[0]), Texts{"bench.dut.sum=?@26:24"});
  EXPECT_EQ(causes(without[0]["causes"][0]["statements"][0]), Texts{"bench.dut.s.d=010@26:16"});
}

TEST_P(WhyRichDesign, UnchangedRegister_NamesSinceWhenAndWhy) {
  const Json kept = why("rich.fst", "s.d@45", "rich.xml")["cone"]["statements"];
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0]["kept"], true);
  EXPECT_EQ(kept[0]["taken_time"], 40);
  EXPECT_EQ(causes(kept[0]), (Texts{"if bench.dut.rst=0@39", "if bench.dut.en=0@39"}));
  EXPECT_EQ(kept[1]["taken_time"], 20);
  EXPECT_EQ(causes(kept[1]),
            (Texts{"bench.dut.x[2:0]=010@19", "if bench.dut.rst=0@19", "if bench.dut.en=1@19"}));
  // An asynchronous reset acts at its own edge.
  const Json reset = why("rich.fst", "s.v@13", "rich.xml")["cone"]["statements"];
  ASSERT_EQ(reset.size(), 1u);
  EXPECT_EQ(reset[0]["line"], 15);
  EXPECT_EQ(reset[0]["taken_time"], 12);
}

TEST_P(WhyRichDesign, MemoryWrites_AreFoundByTheirIndex) {
  const Json written = why("rich.fst", "mem[2]@50", "rich.xml", {"--depth", "1"})["cone"];
  const Json& last = written["statements"].back();
  EXPECT_EQ(last["taken_time"], 20);
  EXPECT_EQ(causes(last)[0], "bench.dut.x=1010@19");
  // mem[3] is not in the waves. The search goes edge by edge; at 10, with x = 3, en was 0.
  const Json other = why("rich.fst", "bench.dut.mem[3]@50", "rich.xml")["cone"];
  EXPECT_EQ(other["in_waves"], false);
  EXPECT_EQ(other["remark"], "assigned earlier, at an unknown time");
}

TEST_P(WhyRichDesign, GenerateBlocksAndPorts_AreWires) {
  const Json y = why("rich.fst", "y[3:2]@30", "rich.xml", {"--depth", "1"})["cone"];
  EXPECT_EQ(y["driven_name"], "bench.dut.half[1].part.q");
  EXPECT_EQ(y["statements"][0]["line"], 4);
  EXPECT_EQ(causes(y["statements"][0]), Texts{"bench.dut.half[1].part.a=01@29:26"});
  EXPECT_EQ(y["statements"][0]["causes"][0]["driven_name"], "bench.dut.pick[3:2]");
  EXPECT_EQ(why("rich.fst", "y@30", "rich.xml")["cone"]["statements"][0]["causes"].size(), 2u);
}

TEST_F(Why, InvalidUsage_IsRefused) {
  write_structure(folder_);
  structure("other",
            "module other(input logic nothing, output logic of_it); assign of_it = nothing;"
            " endmodule\n");
  EXPECT_TRUE(has(error("a.fst", "count@75ns", ""), "--structure"));
  EXPECT_TRUE(has(error("a.fst", "cuont@75ns", "top.xml"), "did you mean"));
  EXPECT_TRUE(has(error("a.fst", "count@9us", "top.xml"), "outside"));
  for (const std::string what : {"count", "@75ns", "count@", "count@@", "count@foo", ""})
    (void)error("a.fst", what, "top.xml");
  EXPECT_TRUE(has(error("a.fst", "count@75ns", "other.xml"), "no scope"));
  EXPECT_TRUE(has(error("a.fst", "count@75ns", "top.sv"), "not a structure file"));
  EXPECT_TRUE(has(error("a.fst", "count@75ns", "none.xml"), "none.xml"));
  EXPECT_TRUE(has(error("a.fst", "count@75ns", "."), "is a folder, not a file"));
  EXPECT_EQ(cde({"wave", "why", "a.fst"}).status, 2);
  EXPECT_EQ(cde({"wave", "find", "a.fst", "clk", "--depth", "2"}).status, 2);
}

TEST_F(Why, WavesOfAnotherModel_AreRefused) {
  write_structure(folder_);
  const auto waves = [&](const std::string& comment) {
    Writer w(folder_ / "card.fst");
    w.comment(comment);
    w.scope("top");
    const fstHandle clk = w.signal("clk", 1), count = w.signal("count [7:0]", 8);
    w.time(0);
    w.set(clk, 0);
    w.set(count, 0);
    w.time(10);
    w.set(clk, 1);
  };
  waves("model board LANES=4 TRACE=1 TAP=0 configuration=0123456789abcdef");
  EXPECT_TRUE(has(error("card.fst", "count@5", "top.xml"), "another design: board"));
  EXPECT_TRUE(has(error("card.fst", "count@5", ""), "configuration 0123456789abcdef"));
  waves("model top TRACE=1 configuration=0123456789abcdef");
  EXPECT_EQ(why("card.fst", "count@5", "top.xml")["cone"]["value"], "00");
  // Comments that our writers do not produce name nothing.
  for (const std::string comment : {"model", "model ../../x configuration=0123456789abcdef",
                                    "model board LANES=4;reboot configuration=0123456789abcdef",
                                    "model board configuration=zz"}) {
    waves(comment);
    EXPECT_TRUE(has(error("card.fst", "count@5", ""), "does not name")) << comment;
  }
}

TEST_F(Why, DamagedXml_NeverCrashes) {
  write_structure(folder_);
  const std::string whole = read("top.xml");
  for (std::size_t n = 0; n < whole.size() - 20; n += 611) {
    write("cut.xml", whole.substr(0, n));
    EXPECT_TRUE(has(error("a.fst", "data@75", "cut.xml"), "not a structure file")) << n;
  }
  std::mt19937 random(14);
  unsigned good = 0;
  for (unsigned i = 0; i < 90; ++i) {
    std::string bytes = whole;
    for (unsigned k = 1 + random() % 4; k > 0; --k) {
      const std::size_t at = random() % bytes.size();
      // Structures consist of numbers and letters: widths, types, names.
      bytes[at] = "0123456789abcdefghijklmno<>/\" "[random() % 30];
    }
    write("bad.xml", bytes);
    const Ran ran = cde({"wave", "why", "a.fst", "data@75", "--structure", "bad.xml"});
    ASSERT_TRUE(ran.status == 0 || ran.status == 2) << i << ran.err;
    ASSERT_FALSE(has(ran.err, "crashed")) << i;
    good += ran.status == 0 ? 1 : 0;
  }
  EXPECT_GT(good, 20u);
  write(
      "deep.xml", "<verilator_xml>" + [] {
        std::string all;
        for (int i = 0; i < 100000; ++i) all += "<a>";
        return all;
      }());
  EXPECT_TRUE(has(error("a.fst", "data@75", "deep.xml"), "too deep"));
}

/// A structure names its sources, so a stranger's structure must not print or wait for other files.
TEST_F(Why, SourceThatIsNoSource_IsNotRead) {
  write_structure(folder_);
  const std::string xml = read("top.xml"), source = read("top.sv");
  const auto output = [&](const std::string& name, const std::string& structure = "a.xml") {
    std::string text = xml;
    for (std::size_t at = 0; (at = text.find("top.sv", at)) != std::string::npos; at += name.size())
      text.replace(at, 6, name);
    write(structure, text);
    const Ran ran = cde({"wave", "why", "a.fst", "data@75", "--structure", structure});
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  };
  std::string secret = source;
  for (char& c : secret)
    if (c != '\n') c = 'S';
  write("secret", secret);
  EXPECT_FALSE(has(output("secret"), "SSSS"));
  write("secret.sv", secret);
  EXPECT_TRUE(has(output("secret.sv"), "SSSS"));
  ASSERT_EQ(::mkfifo((folder_ / "fifo.sv").c_str(), 0600), 0);
  (void)output("fifo.sv");
  fs::create_symlink("/dev/zero", folder_ / "zero.sv");
  (void)output("zero.sv");
  if (::geteuid() != 0) return;
  write("b.xml", "");
  ASSERT_EQ(::chown((folder_ / "b.xml").c_str(), 65534, 65534), 0);
  EXPECT_FALSE(has(output("secret.sv", "b.xml"), "SSSS")) << "the source belongs to root";
  ASSERT_EQ(::chown((folder_ / "secret.sv").c_str(), 65534, 65534), 0);
  EXPECT_TRUE(has(output("secret.sv", "b.xml"), "SSSS"));
}

TEST_F(Why, FifoBesideAJsonStructure_IsRefusedAtOnce) {
  write("x.tree.json", "{}");
  ASSERT_EQ(::mkfifo((folder_ / "x.tree.meta.json").c_str(), 0600), 0);
  EXPECT_TRUE(has(error("a.fst", "data@75", "x.tree.json"), "is not a regular file"));
}

TEST_P(WhyStructure, DamagedJson_NeverCrashes) {
  structure("top");
  const std::string tree = read("top.tree.json"), meta = read("top.tree.meta.json");
  if (std::string(GetParam()) == ".xml") {
    fs::remove(folder_ / "top.tree.meta.json");
    EXPECT_TRUE(has(error("a.fst", "data@75", "top.tree.json"), "top.tree.meta.json"));
    return;
  }
  write("bad.tree.meta.json", meta);
  for (std::size_t n = 0; n < tree.size() - 20; n += 611) {
    write("bad.tree.json", tree.substr(0, n));
    EXPECT_TRUE(has(error("a.fst", "data@75", "bad.tree.json"), "not a structure file")) << n;
  }
  std::mt19937 random(15);
  unsigned good = 0;
  for (unsigned i = 0; i < 90; ++i) {
    std::string bytes = tree;
    for (unsigned k = 1 + random() % 4; k > 0; --k)
      bytes[random() % bytes.size()] = "0123456789ABCDEFGHIJ(){}[]:,\" "[random() % 30];
    write("bad.tree.json", bytes);
    const Ran ran = cde({"wave", "why", "a.fst", "data@75", "--structure", "bad.tree.json"});
    ASSERT_TRUE(ran.status == 0 || ran.status == 2) << i << ran.err;
    ASSERT_FALSE(has(ran.err, "crashed")) << i;
    good += ran.status == 0 ? 1 : 0;
  }
  EXPECT_GT(good, 20u);
  write("bad.tree.json", std::string(100000, '['));
  EXPECT_TRUE(has(error("a.fst", "data@75", "bad.tree.json"), "too deep"));
  write("bad.tree.json", "{}");
  EXPECT_TRUE(has(error("a.fst", "data@75", "bad.tree.json"), "--json-only"));
}

/// For a Verilator without --xml-only its other output is read, here the output of another design.
TEST_F(Why, VerilatorWithoutXml_IsAskedForJson) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n");
  ASSERT_EQ(shell("\"$CDE\" query sphere-sphere --lanes 8 --trace c.fst -q < pairs").status, 0);
  const std::string stored = std::string(CDE_SOURCE_DIR) + "/tests/wave/structures/top.tree";
  const Ran real = shell("command -v verilator");
  fs::create_directory(folder_ / "bin");
  write("bin/verilator",
        "#!/bin/bash\nfor word; do\n"
        "  [[ $word != --xml-only ]] || { echo '%Error: Invalid option: --xml-only'; exit 1; }\n"
        "  [[ ${before-} != --json-only-output ]] || cp '" +
            stored +
            ".json' \"$word\"\n"
            "  [[ ${before-} != --json-only-meta-output ]] || cp '" +
            stored +
            ".meta.json' \"$word\"\n"
            "  before=$word\ndone\n[[ \" $* \" == *' --json-only '* ]] || exec " +
            real.out.substr(0, real.out.find('\n')) + " \"$@\"\n");
  fs::permissions(folder_ / "bin/verilator", fs::perms::owner_all);
  const Ran ran = cde({"wave", "why", "c.fst", "pair_unit.pair_unit.t_o[0]@end"},
                      {"PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"),
                       "CDE_CACHE=" + (folder_ / "cache").string()});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "is not the structure of c.fst: no scope"));
}

/// An entry with a fitting checksum that holds no structure, and an entry of another design.
TEST_F(Why, WrongCacheEntry_IsMadeAgainOnce) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n");
  ASSERT_EQ(shell("\"$CDE\" query sphere-sphere --lanes 8 --trace c.fst -q < pairs").status, 0);
  const std::string why =
      "export CDE_CACHE=$PWD/cache; \"$CDE\" wave why c.fst pair_unit.pair_unit.t_o[0]@end\n";
  const Ran right = shell(why);
  ASSERT_EQ(right.status, 0) << right.err;
  const std::string sum = "\nsum() { { echo $e; cat $e; } | sha256sum | cut -d' ' -f1; }\n";
  for (const std::string damage :
       {"printf 'cde structure 2\n\nnot xml' > $e; echo \"$(sum)  $e\" > $e.sha256",
        "printf 'cde structure 2\n\n' > other; sed s/$e/other/ $e.sha256 > other.sha256; mv other "
        "$e; "
        "mv other.sha256 $e.sha256"}) {
    const Ran ran = shell("cd cache; e=$(ls *.structure)" + sum + damage + "\ncd ..\n" + why);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, right.out);
    EXPECT_TRUE(has(ran.err, "reading the structure of"));
    EXPECT_EQ(shell(why).err, "");
  }
}

/// The parameters of the waves' comment may be a stranger's.
TEST_F(Why, Elaboration_HasLimits) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n");
  ASSERT_EQ(shell("\"$CDE\" query sphere-sphere --lanes 8 --trace c.fst -q < pairs").status, 0);
  const Ran real = shell("command -v verilator");
  fs::create_directory(folder_ / "bin");
  write("bin/verilator", "#!/bin/bash\n[[ \" $* \" == *' --xml-only '* ]] || exec " +
                             real.out.substr(0, real.out.find('\n')) +
                             " \"$@\"\nulimit -v >limit\nulimit -t >>limit\nexit 1\n");
  fs::permissions(folder_ / "bin/verilator", fs::perms::owner_all);
  const Ran ran = cde({"wave", "why", "c.fst", "pair_unit.pair_unit.t_o[0]@end"},
                      {"PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"),
                       "CDE_CACHE=" + (folder_ / "cache").string()});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "verilator cannot elaborate pair_unit in 4096 MB of memory and 120 s"))
      << ran.err;
  EXPECT_EQ(read("limit"), "4194304\n120\n");
}

/// Verilator takes seconds to read a card's RTL.
TEST_F(Why, SignalDuringElaboration_EndsVerilatorAndLeavesNoFolder) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n");
  ASSERT_EQ(shell("\"$CDE\" query sphere-sphere --lanes 8 --trace c.fst -q < pairs").status, 0);
  const Ran real = shell("command -v verilator");
  for (const char* name : {"bin", "tmp"}) fs::create_directory(folder_ / name);
  write("bin/verilator", "#!/bin/bash\n[[ \" $* \" == *' --xml-only '* ]] || exec " +
                             real.out.substr(0, real.out.find('\n')) +
                             " \"$@\"\nsleep 1000 & echo $! > sleeper\nwait\n");
  fs::permissions(folder_ / "bin/verilator", fs::perms::owner_all);
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = start(
        {"wave", "why", "c.fst", "pair_unit.pair_unit.t_o[0]@end"},
        {"PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"),
         "CDE_CACHE=" + (folder_ / "cache").string(), "TMPDIR=" + (folder_ / "tmp").string()});
    for (int i = 0; i < 1000 && read("sleeper").find('\n') == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const pid_t sleeper = std::atoi(read("sleeper").c_str());
    EXPECT_FALSE(fs::is_empty(folder_ / "tmp"));
    ::kill(child, signal);
    const Ran ran = finish(child);
    EXPECT_EQ(ran.status, 128 + signal) << ran.err;
    ASSERT_GT(sleeper, 0) << ran.err;
    const auto runs = [&] { return read("/proc/" + std::to_string(sleeper) + "/cmdline"); };
    for (int i = 0; i < 500 && !runs().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(runs(), "") << "a child of verilator was left behind";
    for (int i = 0; i < 500 && !fs::is_empty(folder_ / "tmp"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(fs::is_empty(folder_ / "tmp")) << "a temporary folder was left behind";
    fs::remove(folder_ / "sleeper");
  }
}

/// A card's waves name their model, so no further argument is needed.
TEST_F(Why, CardWaves_NameTheirStructure) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n");
  const Ran query = shell("\"$CDE\" query sphere-sphere --lanes 8 --trace c.fst -q < pairs");
  ASSERT_EQ(query.status, 0) << query.err;
  const Ran when =
      cde({"wave", "find", "c.fst", "pair_unit.pair_unit.t_o[0]:fp32 == 0.5", "--first"});
  const std::string at = when.out.substr(0, when.out.find(' '));
  const Json j = why("c.fst", "pair_unit.pair_unit.t_o[0]:fp32@" + at, "", {"--max", "400"});
  EXPECT_EQ(j["cone"]["value"], "0.5");
  std::set<std::string> files;
  const std::function<void(const Json&)> walk = [&](const Json& node) {
    for (const Json& s : node["statements"]) {
      const std::string file = s["source_file"];
      files.insert(file.substr(file.rfind('/') + 1));
      EXPECT_NE(s["source_text"], "") << s["source_file"] << s["line"];
      for (const Json& c : s["causes"]) walk(c);
    }
  };
  walk(j["cone"]);
  for (const char* file : {"lane_select.sv", "scaled_pipe.sv", "sphere_sphere.sv", "pair_unit.sv"})
    EXPECT_TRUE(files.contains(file)) << file;
  // The second run does not call Verilator.
  const Ran again =
      cde({"wave", "why", "c.fst", "pair_unit.pair_unit.t_o[0]@end"}, {"PATH=/nowhere"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "");
}

INSTANTIATE_TEST_SUITE_P(Structure, WhyRichDesign, ::testing::Values(".xml", ".tree.json"),
                         [](const auto& form) { return form.index == 0 ? "Xml" : "Json"; });

/// Verilator merges an if and its else into one assignment. In a loop, only one iteration assigns
/// each element.
TEST_P(WhyStructure, LoopsAndBranches_NameTheExecutedOne) {
  structure("turns");
  {
    Writer w(folder_ / "turns.fst");
    w.scope("turns");
    const fstHandle pick = w.signal("pick [1:0]", 2), x = w.signal("x [7:0]", 8),
                    y = w.signal("y [15:0]", 16);
    w.up();
    w.time(0);
    w.set(pick, 1), w.set(x, 5), w.set(y, 9 << 8 | 5);
    w.time(10);
    w.set(x, 3), w.set(y, 7 << 8 | 3);
    w.time(20);
  }
  const auto taken = [this](const std::string& what, int line) {
    SCOPED_TRACE(what);
    const Json statements = why("turns.fst", what, "turns.xml")["cone"]["statements"];
    EXPECT_EQ(statements.size(), 1u) << statements;
    EXPECT_EQ(statements.at(0)["line"], line);
    return statements.at(0);
  };
  EXPECT_TRUE(taken("y[15:8]@5", 9)["forwarded_cause"].is_null());
  (void)taken("y[15:8]@15", 8);
  const Json as_it_is = taken("y[7:0]@5", 7);
  ASSERT_TRUE(as_it_is["forwarded_cause"].is_number()) << as_it_is;
  EXPECT_EQ(as_it_is["causes"][as_it_is["forwarded_cause"].get<std::size_t>()]["name"], "turns.x");
}

/// The condition of ? : is not a part of the word, even if it is equally wide.
TEST_F(Why, ConditionalOperator_FollowsTheSelectedSide) {
  structure("sides",
            "module sides(input [7:0] at, input [7:0] a, input [7:0] b, output [7:0] y);\n"
            "assign y = at % 8'd2 == 8'd1 ? a : b;\n"
            "endmodule\n");
  {
    Writer w(folder_ / "sides.fst");
    w.scope("sides");
    const fstHandle at = w.signal("at [7:0]", 8), a = w.signal("a [7:0]", 8),
                    b = w.signal("b [7:0]", 8), y = w.signal("y [7:0]", 8);
    w.up();
    w.time(0);
    w.set(at, 6), w.set(a, 0x2e), w.set(b, 0x35), w.set(y, 0x35);
    w.time(10);
  }
  const Json statement = why("sides.fst", "y@5", "sides.xml")["cone"]["statements"].at(0);
  const Json& causes = statement["causes"];
  ASSERT_EQ(causes.size(), 2u) << causes;
  EXPECT_EQ(causes[0]["name"], "sides.b");
  EXPECT_EQ(causes[0]["condition"], false);
  EXPECT_EQ(causes[1]["name"], "sides.at");
  EXPECT_EQ(causes[1]["condition"], true);
  EXPECT_EQ(statement["forwarded_cause"], 0);
}

}  // namespace
}  // namespace cde::testing
