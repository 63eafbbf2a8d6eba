// SPDX-License-Identifier: Apache-2.0
// Small wave and structure files that ask for much memory or time, or that would steer other
// programs.
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

class HostileWaves : public Cli {
 protected:
  /// Runs `cde wave WORDS` with 2 GB of address space.
  [[nodiscard]] Ran in_two_gigabytes(const std::string& words) {
    return shell("ulimit -v 2000000 && \"$CDE\" wave " + words);
  }
  /// The design of t.vcd: t has x, an inverter and y. `inside` follows in t, `modules` behind it.
  void write_design(const std::string& inside, const std::string& modules) {
    write("t.vcd",
          "$timescale 1ns $end\n$scope module t $end\n$var wire 1 ! x $end\n$var wire 1 # y $end\n"
          "$upscope $end\n$enddefinitions $end\n#0\n0!\n1#\n#5\n1!\n0#\n");
    write("t.xml",
          "<verilator_xml><files><file id=\"c\" filename=\"t.sv\"/></files><cells></cells>"
          "<netlist><module loc=\"c,1,1,1,2\" name=\"t\" topModule=\"1\" origName=\"t\">"
          "<var loc=\"c,1,1,1,2\" name=\"x\" dtype_id=\"1\" dir=\"input\" pinIndex=\"1\"/>"
          "<var loc=\"c,1,1,1,2\" name=\"y\" dtype_id=\"1\" dir=\"output\" pinIndex=\"2\"/>"
          "<contassign loc=\"c,1,1,1,2\"><not dtype_id=\"1\"><varref name=\"x\" dtype_id=\"1\"/>"
          "</not><varref name=\"y\" dtype_id=\"1\"/></contassign>" +
              inside + "</module>" + modules +
              "<typetable><basicdtype id=\"1\" name=\"logic\"/></typetable></netlist>"
              "</verilator_xml>");
  }
};

/// GTKWave reads `^>1 PROGRAM` as an order to start a program.
TEST_F(HostileWaves, NamesThatAreDirectivesOfGtkwave_AreLeftOut) {
  const std::vector<std::string> bad = {"^>1 /tmp/a", "{^>1}/tmp/a", "@800200", "[timestart] 5",
                                        "-comment",   "*1",          "#a",      "?a",
                                        "!a",         ":a",          "%a",      "&a",
                                        "+a",         "=a",          "~a",      ";a",
                                        ">5",         "(0)a",        "a b",     "a*"};
  std::string text = "$scope module top $end\n$var wire 1 ! good $end\n$upscope $end\n";
  for (const std::string& name : bad) text += "$var wire 1 ! " + name + " $end\n";
  text +=
      "$var wire 1 ! \\esc+aped $end\n$scope module ^>1 $end\n$var wire 1 ! x $end\n"
      "$upscope $end\n$enddefinitions $end\n#0\n0!\n#5\n1!\n";
  write("d.vcd", text);
  const Ran ran = cde({"wave", "export", "d.vcd", "-o", "d.gtkw"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_TRUE(has(ran.err,
                  "cde: warning: d.gtkw lacks 21 signals whose names GTKWave would not read as "
                  "names; the first is '^>1 /tmp/a'\n"))
      << ran.err;
  std::istringstream lines(read("d.gtkw"));
  std::vector<std::string> names;
  bool begun = false;
  for (std::string line; std::getline(lines, line);) {
    if (begun && !line.starts_with('@') && !line.starts_with("[pattern_trace]"))
      names.push_back(line);
    begun = begun || line.starts_with("[sst_expanded]");
  }
  EXPECT_EQ(names, (std::vector<std::string>{"-top", "top.good", "-top", "\\esc+aped"}));
}

/// The last instant of a cut file may lack changes.
TEST_F(HostileWaves, CutVcd_IsToldByEachCommand) {
  const std::string whole =
      "$timescale 1ns $end\n$var wire 1 ! clk $end\n$var wire 8 # n $end\n$enddefinitions $end\n"
      "#0\n0!\nb0 #\n#5\n1!\nb1 #\n#10\n0!\nb10 #\n";
  const std::string cut = whole.substr(0, whole.size() - 3);
  write("whole.vcd", whole);
  write("cut.vcd", cut);
  const std::string warning = fmt::format(
      "cde: warning: cut.vcd: the file ends within line 13, at byte {}, which is ignored: the "
      "simulation still runs, or was killed; changes at 10ns may be missing\n",
      cut.size());
  using Words = std::vector<std::string>;
  for (const Words& words :
       {Words{"ls"}, Words{"at", "5", "n"}, Words{"show", "n"}, Words{"find", "n == 1"},
        Words{"diff", "whole.vcd"}, Words{"stat", "n"}, Words{"export", "-o", "o.csv"},
        Words{"export", "-o", "o.vcd"}, Words{"serve", "-o", "o.html"}}) {
    Words all = {"wave", words[0], "cut.vcd"};
    all.insert(all.end(), words.begin() + 1, words.end());
    const Ran ran = cde(all);
    EXPECT_EQ(ran.status, words[0] == "diff" ? 1 : 0) << words[0] << ran.err;
    EXPECT_TRUE(ran.err.starts_with(warning)) << words[0] << ran.err;
    EXPECT_FALSE(has(ran.err.substr(warning.size()), "warning")) << ran.err;
    all[2] = "whole.vcd";
    EXPECT_FALSE(has(cde(all).err, "warning")) << words[0];
  }
  EXPECT_EQ(cde({"wave", "diff", "whole.vcd", "cut.vcd"}).err, warning);
  const Ran info = cde({"wave", "info", "cut.vcd"});
  EXPECT_EQ(info.err, "");
  EXPECT_TRUE(has(info.out, fmt::format("the file ends within line 13, at byte {}", cut.size())));
}

TEST_F(HostileWaves, ManyWidthsOfAnIdentifier_AreRefused) {
  std::string text = "$timescale 1ns $end\n";
  for (unsigned i = 1; i <= 8; ++i) text += fmt::format("$var wire {} ! a{} $end\n", i, i);
  const std::string rest = "$enddefinitions $end\n#0\nb1 !\n#5\nb0 !\n";
  write("a.vcd", text + rest);
  EXPECT_EQ(cde({"wave", "find", "a.vcd", "a8 == 1 && a1 == 1", "--count"}).out, "1\n");
  write("a.vcd", text + "$var wire 9 ! a9 $end\n" + rest);
  refused({"wave", "info", "a.vcd"},
          "a.vcd:10: $var: identifier '!' has more than 8 different widths and types");
}

/// The comment `forms` has each pattern compared with each name.
TEST_F(HostileWaves, ManyOrSlowPatternsOfForms_AreRefused) {
  const auto with = [&](const std::string& patterns, const std::string& name) {
    write("f.vcd", "$timescale 1ns $end\n$comment forms" + patterns + " $end\n$var wire 8 ! " +
                       name + " $end\n$enddefinitions $end\n#0\nb1000001 !\n#5\nb0 !\n");
  };
  std::string many;
  for (unsigned i = 0; i < 999; ++i) many += fmt::format(" *n{}=hex", i);
  with(many + " *=dec", "a");
  EXPECT_TRUE(has(cde({"wave", "at", "f.vcd", "0", "a"}).out, "65"));
  with(many + " *m=hex *=dec", "a");
  refused({"wave", "at", "f.vcd", "0", "a"},
          "f.vcd: its comments `forms` have more than 1000 patterns");
  // Each star is tried at each of a million places.
  with(" *" + std::string(500'000, 'a') + "b=dec", std::string(1'000'000, 'a'));
  refused({"wave", "at", "f.vcd", "0", "*"},
          "f.vcd: comparing the patterns of its comments `forms` with its signals takes too long");
}

/// Decimal digits take a time that grows with the square of the width.
TEST_F(HostileWaves, VeryWideDecimals_AreShownInHexadecimal) {
  const auto shown = [&](unsigned width) {
    write("d.vcd", fmt::format("$comment forms *=dec $end\n$var wire {} ! a $end\n"
                               "$enddefinitions $end\n#0\nb{} !\n#1\n",
                               width, std::string(width, '1')));
    return cde({"wave", "at", "d.vcd", "0", "a"}).out;
  };
  EXPECT_TRUE(has(shown(100), "1267650600228229401496703205375"));
  EXPECT_TRUE(has(shown(4096), "10443888814131525066917527107166"));
  EXPECT_TRUE(has(shown(1'000'000), "ffffffff"));
}

/// A number whose bytes may stand in a name of a VCD.
bool is_printable(std::uint64_t number) {
  for (; number != 0; number >>= 8)
    if ((number & 0xff) <= ' ' || (number & 0xff) > '~') return false;
  return true;
}

/// Words of 16 letters that collide under std::hash of libstdc++ (MurmurHash64A).
std::vector<std::string> colliding_words(std::size_t count) {
  constexpr std::uint64_t kMul = 0xc6a4a7935bd1e995u, kSeed = 0xc70f6907u;
  std::uint64_t inverse = kMul;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kMul * inverse;
  const auto mixed = [](std::uint64_t k) { return k ^ k >> 47; };
  std::vector<std::string> words;
  std::uint64_t number = 0;
  for (; words.size() < count; ++number) {
    std::uint64_t first = 0;
    for (std::uint64_t rest = number, i = 0; i < 8; ++i, rest /= 64)
      first = first << 8 | ('0' + rest % 64);
    const std::uint64_t h = ((kSeed ^ 16 * kMul) ^ mixed(first * kMul) * kMul) * kMul;
    const std::uint64_t second = mixed((h ^ 0x1234567) * inverse) * inverse;
    if (!is_printable(second) || second >> 56 == 0) continue;
    std::string word(16, ' ');
    std::memcpy(word.data(), &first, 8);
    std::memcpy(word.data() + 8, &second, 8);
    words.push_back(word);
  }
  return words;
}

TEST_F(HostileWaves, CollidingNames_AreReadInLinearTime) {
  const std::vector<std::string> words = colliding_words(60'000);
#ifdef __GLIBCXX__
  EXPECT_EQ(std::hash<std::string>()(words[0]), std::hash<std::string>()(words[1]));
#endif
  std::string text;
  for (const std::string& word : words) text += fmt::format("$var wire 1 {0} {0} $end\n", word);
  text += "$enddefinitions $end\n#0\n";
  for (const std::string& word : words) text += "1" + word + "\n";
  write("h.vcd", text);
  const Ran ran =
      shell("ulimit -t 5 && \"$CDE\" wave info h.vcd && \"$CDE\" wave ls h.vcd > /dev/null");
  EXPECT_EQ(ran.status, 0) << ran.err;
}

/// All signals take their forms from one comment.
TEST_F(HostileWaves, CommentsWithForms_AreReadOncePerFile) {
  std::string text = "$comment forms";
  for (unsigned i = 0; i < 300'000; ++i) text += " x";
  text += " $end\n";
  for (unsigned i = 0; i < 3000; ++i) text += fmt::format("$var wire 1 s{0} s{0} $end\n", i);
  write("f.vcd", text + "$enddefinitions $end\n#0\n0s0\n#9\n1s0\n");
  for (const char* words : {"diff f.vcd f.vcd", "show f.vcd", "find f.vcd s0"}) {
    const Ran ran = shell(std::string("ulimit -t 10 && \"$CDE\" wave ") + words);
    EXPECT_EQ(ran.status, 0) << words << ran.err;
  }
}

/// Each row of CSV repeats the values of all signals.
TEST_F(HostileWaves, TablesOfWholeFiles_FollowTheFilesSize) {
  std::string text;
  for (unsigned i = 0; i < 2000; ++i) text += fmt::format("$var wire 8000 s{0} s{0} $end\n", i);
  text += "$var wire 1 c c $end\n$enddefinitions $end\n";
  for (unsigned i = 0; i < 200; ++i) text += fmt::format("#{}\n{}c\n", i, i % 2);
  write("a.vcd", text);
  const Ran ran = cde({"wave", "export", "a.vcd", "-o", "a.csv"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err,
                  "a.vcd: a CSV table of the whole file takes more than 259 MB; name "
                  "signals ('*' for all of them), or select a window with --from"))
      << ran.err;
  for (const std::string& name : files()) EXPECT_FALSE(has(name, ".csv"));
  EXPECT_EQ(cde({"wave", "export", "a.vcd", "c", "-o", "c.csv"}).status, 0);
  EXPECT_EQ(cde({"wave", "export", "a.vcd", "--to", "9", "-o", "w.csv"}).status, 0);
  EXPECT_EQ(cde({"wave", "export", "a.vcd", "*", "--format", "csv", "-o", "/dev/null"}).status, 0);
}

TEST_F(HostileWaves, LargePicturesOfWaveDrom_AreRefused) {
  std::string text;
  for (unsigned i = 0; i < 30'000; ++i) text += fmt::format("$var wire 1 s{0} s{0} $end\n", i);
  text += "$enddefinitions $end\n";
  for (unsigned i = 0; i < 4000; ++i) text += fmt::format("#{}\n{}s0\n", i, i % 2);
  write("w.vcd", text);
  const Ran ran = cde({"wave", "export", "w.vcd", "-o", "w.json"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "would have 4000 columns of 30000 signals; name fewer")) << ran.err;
}

/// A comment names the simulation model of the waves.
TEST_F(HostileWaves, LongWordsOfAModel_AreRead) {
  const auto refused = [&](const std::string& model, const std::string& why) {
    write("m.vcd", "$comment model " + model +
                       " configuration=0123456789abcdef $end\n$var wire 1 ! x $end\n"
                       "$enddefinitions $end\n#0\n0!\n#9\n1!\n");
    EXPECT_EQ(cde({"wave", "serve", "m.vcd", "-o", "m.html"}).status, 0);
    const Ran ran = cde({"wave", "why", "m.vcd", "x@9"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, why)) << ran.err;
  };
  const std::string none = "m.vcd does not name its design";
  for (const std::size_t length : {100'000, 1'000'000}) {
    refused(std::string(length, 'a') + " LANES=4", none);
    refused("board LANES=" + std::string(length, '4'), none);
    refused("board " + std::string(length, 'L'), none);
  }
  const std::string lanes = "LANES=" + std::string(2000, '4');
  refused("board " + lanes, "m.vcd comes from simulation model board LANES=444");
  refused("board LANES=4", "m.vcd comes from simulation model board LANES=4 with other RTL");
  for (const char* model : {"board LANES=", "board =4", "Board LANES=4", "board lanes=4"})
    refused(model, none);
}

TEST_F(HostileWaves, NamesOfManyInstances_TakeLittleMemory) {
  const std::string name(3000, 'n');
  std::string modules;
  for (unsigned depth = 0; depth < 16; ++depth) {
    modules += fmt::format("<module name=\"m{}\">", depth);
    for (unsigned i = 0; i < 2; ++i)
      modules += fmt::format("<instance name=\"{}{}\" defName=\"m{}\"/>", name, i, depth + 1);
    modules += "</module>";
  }
  write_design("<instance name=\"z\" defName=\"m0\"/>", modules);
  const Ran ran = in_two_gigabytes("why t.vcd y@5 --structure t.xml");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "t.y is 0 at 5ns")) << ran.out;
}

TEST_F(HostileWaves, InstancesOfMissingModules_AreLimited) {
  std::string modules, missing;
  for (unsigned i = 0; i < 1000; ++i) missing += fmt::format("<instance name=\"i{}\"/>", i);
  for (unsigned depth = 0; depth < 16; ++depth)
    modules += fmt::format(
        "<module name=\"m{0}\"><instance name=\"a\" defName=\"m{1}\"/><instance name=\"b\" "
        "defName=\"m{1}\"/></module>",
        depth, depth + 1);
  write_design("<instance name=\"z\" defName=\"m0\"/>",
               modules + "<module name=\"m16\">" + missing + "</module>");
  const Ran ran = in_two_gigabytes("why t.vcd y@5 --structure t.xml");
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "instances are too many")) << ran.err;
}

TEST_F(HostileWaves, LongNamesInNestedBlocks_AreRefused) {
  std::string inside;
  for (unsigned i = 0; i < 60; ++i)
    inside += fmt::format("<begin name=\"{}\">", std::string(100'000, 'b'));
  for (unsigned i = 0; i < 1000; ++i) inside += fmt::format("<var name=\"v{}\"/>", i);
  for (unsigned i = 0; i < 60; ++i) inside += "</begin>";
  write_design(inside, "");
  const Ran ran = in_two_gigabytes("why t.vcd y@5 --structure t.xml");
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "t.xml: not a structure file: the full names")) << ran.err;
}

}  // namespace
}  // namespace cde::testing
