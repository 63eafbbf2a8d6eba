// SPDX-License-Identifier: Apache-2.0
// cde wave as a user runs it, on a file with known values.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "cde/wave/trace.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

class Wave : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
    write_sample(folder_ / "b.fst", {.late = 0, .wrong_at = 9});
    write_sample(folder_ / "late.fst", {.late = 3, .wrong_at = 9});
    write_pci(folder_ / "pci.fst");
  }
  /// stdout of a command that must succeed.
  std::string out(const std::vector<std::string>& words) {
    std::vector<std::string> all = {"wave"};
    all.insert(all.end(), words.begin(), words.end());
    const Ran ran = cde(all);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  }
  nlohmann::json json(std::vector<std::string> words, int status = 0) {
    words.insert(words.begin(), "wave");
    words.emplace_back("--json");
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, status) << ran.err;
    return nlohmann::json::parse(ran.out);
  }
  /// The error message of a command that must end with status 2.
  std::string error(const std::vector<std::string>& words) {
    std::vector<std::string> all = {"wave"};
    all.insert(all.end(), words.begin(), words.end());
    const Ran ran = cde(all);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran.err;
  }
};

TEST_F(Wave, Info_DescribesTheFile) {
  const auto j = json({"info", "a.fst"});
  EXPECT_EQ(j["schema"], "cde.wave.info.1");
  EXPECT_EQ(j["writer"], "sample");
  EXPECT_EQ(j["seconds_per_unit"], 1e-9);
  EXPECT_EQ(j["to"], 195);
  EXPECT_EQ(j["scopes"], 2);
  EXPECT_EQ(j["signals"], 7);
  EXPECT_EQ(j["aliases"], 1);
  EXPECT_EQ(j["clock"], "top.clk");
  EXPECT_EQ(j["cycles"], 20);
}

TEST_F(Wave, Ls_ListsNamesWidthsAndKinds) {
  EXPECT_EQ(out({"ls", "a.fst", "count"}),
            "top.count           8  wire  [7:0]\n"
            "top.core.count      8  wire input [7:0]\n");
  EXPECT_EQ(
      out({"ls", "a.fst", "--max", "2"}),
      "top.clk        1  wire\ntop.count      8  wire  [7:0]\n... 5 more (--max 0 prints all)\n");
  EXPECT_TRUE(has(error({"ls", "a.fst", "cuont"}), "did you mean"));
}

TEST_F(Wave, At_GivesValuesInEveryFormat) {
  EXPECT_EQ(out({"at", "a.fst", "75ns", "count", "count:dec", "count:bin", "data", "data:fp32",
                 "data[0]:fp32", "data[1]:fp32", "data[31:16]:bf16", "data[0]:hex/32", "state"}),
            "at 75ns\n"
            "top.count        07\n"
            "top.count        7\n"
            "top.count        00000111\n"
            "top.data         7fc0000040600000\n"
            "top.data         {3.5 nan}\n"
            "top.data[0]      3.5\n"
            "top.data[1]      nan\n"
            "top.data[31:16]  3.5\n"
            "top.data[0]      40600000\n"
            "top.state        1\n");
  EXPECT_TRUE(has(out({"at", "a.fst", "0", "state", "count:dec"}), "state  x\ntop.count  x"));
  write_sample(folder_ / "long.fst", {.cycles = 250});
  EXPECT_TRUE(has(out({"at", "long.fst", "cyc:249", "count:signed"}), "-7\n"));
}

TEST_F(Wave, Times_HaveManyForms) {
  for (const std::string time : {"75ns", "75", "75000ps", "0.075us", "cyc:7", "fail", "fail+2ns",
                                 "cyc:9-2cyc", "end-120", "end-12cyc", "start+75"})
    EXPECT_TRUE(has(out({"at", "a.fst", time, "count:dec"}), "top.count  7\n")) << time;
  for (const std::string time : {"196", "5us", "cyc:20", "end+1", "start-1", "cyc:0-1cyc"})
    EXPECT_TRUE(has(error({"at", "a.fst", time, "count"}),
                    time == "cyc:0-1cyc" ? "before the first" : "outside of the file"))
        << time;
  for (const std::string time : {"7x", "ns", "cyc:", "cyc:x", "75-", "nan", "1e400"})
    EXPECT_TRUE(has(error({"at", "a.fst", time, "count"}), "no time")) << time;
}

TEST_F(Wave, ValueAtAnyTime_EqualsASequentialRead) {
  // Several blocks: a file whose writer is flushed now and then.
  const auto file = folder_ / "blocks.fst";
  std::vector<std::uint64_t> expected;
  {
    void* const fst = fstWriterCreate(file.c_str(), 1);
    const fstHandle s = fstWriterCreateVar(fst, FST_VT_VCD_WIRE, FST_VD_IMPLICIT, 32, "s", 0);
    for (std::uint64_t t = 0; t < 100; ++t) {
      if (t % 3 == 0) {
        fstWriterEmitTimeChange(fst, t * 10);
        fstWriterEmitValueChange32(fst, s, 32, static_cast<std::uint32_t>(t));
      }
      if (t % 20 == 10) fstWriterFlushContext(fst);
      expected.push_back(t - t % 3);
    }
    fstWriterClose(fst);
  }
  wave::Trace trace(file);
  ASSERT_GT(trace.structure().sections.size(), 3u);
  for (std::uint64_t t = 0; t < 1000 && t <= trace.end(); t += 5) {
    std::uint64_t value = 0;
    const std::array handles{trace.signals().front().handle};
    trace.stream(handles, t, t, [&](auto, auto, std::string_view bits) {
      value = std::stoull(std::string(bits), nullptr, 2);
      return true;
    });
    EXPECT_EQ(value, expected[t / 10]) << t;
  }
}

TEST_F(Wave, Show_DrawsWaves) {
  const std::vector<std::string> words = {"show",  "a.fst", "clk",       "count:dec",
                                          "valid", "state", "--from",    "cyc:3",
                                          "--to",  "cyc:6", "--columns", "49"};
  EXPECT_EQ(out(words),
            "top  35ns to 65ns\n"
            "      ╷35ns               ╷49ns\n"
            "      ──────┐      ┌──────┐      ┌──────┐      ┌─\n"
            "clk         └──────┘      └──────┘      └──────┘\n"
            "count  3           ╳4            ╳5            ╳6\n"
            "      ─────────────┐             ┌───────────────\n"
            "valid              └─────────────┘\n"
            "state  0           ╳1            ╳2            ╳0\n");
  std::vector<std::string> ascii = words;
  ascii.emplace_back("--ascii");
  const std::string text = out(ascii);
  EXPECT_TRUE(std::all_of(text.begin(), text.end(),
                          [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }));
  EXPECT_TRUE(has(text, "clk         \\______/      \\______/"));
  // More changes than columns, and times before the first value.
  EXPECT_TRUE(has(out({"show", "a.fst", "clk", "--columns", "40"}), "▒"));
  EXPECT_TRUE(has(out({"show", "a.fst", "valid", "--to", "20ns"}), "░░░"));
  const auto j = json({"show", "a.fst", "count:dec", "--around", "fail", "--window", "1"});
  EXPECT_EQ(j["signals"][0]["changes"].size(), 4u);
  EXPECT_EQ(j["from"], 65);
  EXPECT_EQ(j["to"], 95);
  (void)error({"show", "a.fst", "clk", "--around", "fail", "--from", "0"});
  (void)error({"show", "a.fst", "clk", "--from", "20ns", "--to", "10ns"});
  (void)error({"show", "a.fst", "clk", "--window", "3"});
}

TEST_F(Wave, Find_FollowsSystemVerilog) {
  EXPECT_EQ(out({"find", "a.fst", "isnan(data[1]:fp32)"}), "75ns  cyc:7  data[1]=nan\n");
  EXPECT_EQ(out({"find", "a.fst", "count == 8'h0a", "--first"}), "105ns  cyc:10  count=0a\n");
  EXPECT_EQ(out({"find", "a.fst", "count == 1_0", "--first"}), "105ns  cyc:10  count=0a\n");
  // Edge k sees the values that edge k - 1 wrote.
  EXPECT_EQ(out({"find", "a.fst", "count == 10", "--on", "posedge clk"}),
            "115ns  cyc:11  count=0a\n");
  const std::vector<std::pair<std::string, std::string>> counts = {
      {"count >= 8'd4 && count < 6", "1"},  // becomes true once
      {"changed(count)", "20"},             // the first change is from x, at 5 ns
      {"rose(clk)", "20"},
      {"fell(valid)", "5"},  // the first fall is from x
      {"valid && !ready", "5"},
      {"state === 3'bxxx", "1"},
      {"state == 2", "5"},
      {"data[0]:fp32 > 4.0 && data[0]:fp32 <= 5", "1"},
      {"count[3:2] == 2'b01", "1"},
      {"{valid, ready} == 2'b11", "10"},
      {"(count + 8'd250) == 0", "0"},
      {"count + 8'd250 == 8'd0", "1"},  // 8 bits, as all operands
      {"^count", "7"},
      {"-3 < 2 && count == 5", "1"},
      {"count % 4 == 3", "5"},
      {"count == (ready ? 8'd7 : 8'd8)", "1"},
      {"prev(count) == 4 && count == 5", "1"},
      {"data[63:32] == 32'h7fc0_0000", "1"},
      {"data == 64'h3f800000_3f000000", "1"},
      {"countones(count) == 4", "1"}};
  for (const auto& [expression, count] : counts) {
    const Ran ran = cde({"wave", "find", "a.fst", expression, "--count"});
    EXPECT_EQ(ran.out, count + "\n") << expression << ran.err;
    EXPECT_EQ(ran.status, count == "0" ? 1 : 0) << expression;
  }
  EXPECT_EQ(out({"find", "a.fst", "valid && ready", "--on", "posedge clk", "--when", "count > 9",
                 "--count"}),
            "4\n");
  EXPECT_EQ(json({"find", "a.fst", "rose(clk)", "--max", "3"})["more"], 17);
  EXPECT_EQ(json({"find", "a.fst", "rose(clk)", "--last"})["matches"][0]["cycle"], 19);
}

TEST_F(Wave, WrongExpression_IsMarkedAtItsPlace) {
  const std::vector<std::pair<std::string, std::size_t>> wrong = {
      {"count == ", 9},     {"count == 8'hfg", 13},    {"(count", 6},
      {"cuont == 1", 0},    {"count ** 2", 7},         {"isnan(count)", 6},
      {"foo(count)", 0},    {"count == 8'd3 clk", 14}, {"count[9]", 0},
      {"data:fp32 > 1", 0}, {"4'hff == count", 0},     {"~data[0]:fp32", 1},
      {"count == 0x1f", 9}, {"count ? 1", 9}};
  for (const auto& [expression, column] : wrong) {
    const std::string text = error({"find", "a.fst", expression});
    const std::string mark = "\n  " + expression + "\n  " + std::string(column, ' ') + "^\n";
    EXPECT_TRUE(text.ends_with(mark)) << text;
  }
  (void)error({"find", "a.fst", std::string(5000, '(')});
  (void)error({"find", "a.fst", std::string(5000, '!') + "clk"});
  (void)error({"find", "a.fst", "1 == 1"});
  (void)error({"find", "a.fst", "clk", "--on", "posedge count"});
  (void)error({"find", "a.fst", "clk", "--on", "clk"});
  (void)error({"find", "a.fst", "clk", "--ulp", "1"});
}

TEST_F(Wave, Diff_NamesTheFirstDifferenceOfEachSignal) {
  EXPECT_EQ(out({"diff", "a.fst", "a.fst"}), "0 of 6 signals differ\n");
  const Ran ran = cde({"wave", "diff", "a.fst", "b.fst", "--as", "fp32"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_EQ(ran.out, "95ns  top.data  {4.5 1} / {4.5000005 1}\n1 of 6 signals differs\n");
  EXPECT_EQ(json({"diff", "a.fst", "b.fst", "--as", "fp32", "--ulp", "1"})["differing"], 0);
  EXPECT_EQ(json({"diff", "a.fst", "b.fst", "--as", "fp32", "--eps", "1e-6"})["differing"], 0);
  EXPECT_EQ(json({"diff", "a.fst", "b.fst", "--as", "fp32", "--eps", "1e-7"}, 1)["differing"], 1);
  EXPECT_EQ(json({"diff", "a.fst", "b.fst", "--ignore", "da*"})["ignored"], 1);
  // Later by 3 ns: all signals differ at equal times. By cycles and by events only data differs.
  EXPECT_GT(json({"diff", "a.fst", "late.fst"}, 1)["differing"], 3);
  for (const std::string align : {"cycle", "event"}) {
    const auto j = json({"diff", "a.fst", "late.fst", "--align", align}, 1);
    ASSERT_EQ(j["differences"].size(), 1u) << align << j;
    EXPECT_EQ(j["differences"][0]["name"], "top.data");
    EXPECT_EQ(j["differences"][0]["time"], align == "cycle" ? 105 : 95);
    EXPECT_EQ(j["differences"][0]["other_time"], align == "cycle" ? 108 : 98);
  }
  EXPECT_TRUE(has(error({"diff", "a.fst", "b.fst", "--ulp", "1"}), "--as fp32"));
  EXPECT_TRUE(has(error({"diff", "a.fst", "nothing.fst"}), "nothing.fst"));
}

TEST_F(Wave, ArrayElements_KeepTheirBrackets) {
  {
    Writer w(folder_ / "array.fst");
    w.scope("top");
    const fstHandle zero = w.signal("row[0] [31:0]", 32), one = w.signal("row[1] [31:0]", 32);
    w.time(0);
    w.set(zero, 0x3f800000);
    w.set(one, 0x40000000);
    w.time(10);
  }
  EXPECT_EQ(
      out({"at", "array.fst", "0", "row[1]:fp32", "row[*]:fp32", "row[0][31:24]", "row[0][30]"}),
      "at 0\n"
      "top.row[1]         2\n"
      "top.row[0]         1\n"
      "top.row[1]         2\n"
      "top.row[0][31:24]  3f\n"
      "top.row[0][30]     0\n");
  EXPECT_EQ(out({"find", "array.fst", "row[1]:fp32 == 2 * row[0]:fp32", "--count"}), "1\n");
  EXPECT_TRUE(has(error({"at", "array.fst", "0", "row[]"}), "the index must be"));
}

TEST_F(Wave, NameWithoutScopes_IsTheOutermost) {
  {
    Writer w(folder_ / "scopes.fst");
    w.scope("top");
    for (const char* scope : {"p", "q"}) {
      w.scope(scope);
      (void)w.signal("x", 1);
      (void)w.signal("y", 1);
      w.up();
    }
    const fstHandle x = w.signal("x", 1);
    w.time(0);
    w.set(x, 1);
    w.time(1);
  }
  EXPECT_EQ(out({"at", "scopes.fst", "0", "x", "q.y"}), "at 0\ntop.x    1\ntop.q.y  x\n");
  EXPECT_TRUE(has(error({"at", "scopes.fst", "0", "y"}), "top.p.y or top.q.y"));
}

TEST_F(Wave, ManySignals_AreListedInOrderAndFoundByPattern) {
  write_large(folder_ / "large.fst", 1000, 300, 50);
  const auto j = json({"ls", "large.fst", "--max", "0"});
  ASSERT_EQ(j["signals"].size(), 1001u);
  EXPECT_EQ(j["signals"][1000]["name"], "top.unit9.s999");
  EXPECT_EQ(json({"ls", "large.fst", "unit3"})["signals"].size(), 100u);
  EXPECT_EQ(json({"at", "large.fst", "end", "s99?"})["values"].size(), 10u);
  EXPECT_EQ(json({"diff", "large.fst", "large.fst"})["compared"], 1001);
}

TEST_F(Wave, Manual_ShowsThePrintedOutput) {
  write_structure(folder_);
  std::ifstream manual(std::string(CDE_SOURCE_DIR) + "/docs/guides/waves.md");
  std::string command, expected;
  unsigned checked = 0;
  const auto check = [&] {
    if (command.empty()) return;
    const Ran ran = shell("cde() { \"$CDE\" \"$@\"; }; " + command);
    EXPECT_EQ(ran.out + ran.err, expected) << command;
    ++checked;
    command.clear();
    expected.clear();
  };
  for (std::string line; std::getline(manual, line);) {
    if (line.starts_with("    $ ")) {
      check();
      command = line.substr(6);
    } else if (line.starts_with("    ") && !command.empty()) {
      expected += line.substr(4) + "\n";
    } else {
      check();
    }
  }
  check();
  EXPECT_GE(checked, 7u);
}

}  // namespace
}  // namespace cde::testing
