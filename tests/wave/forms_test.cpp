// SPDX-License-Identifier: Apache-2.0
// The default format of values: the one that the file states.
#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

class ValueFormats : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    Writer w(folder_ / "f.fst");
    w.comment("forms *count=dec *t[*]=e8m23|mask*1 *wide=fp32*2 *bad=none *=auto");
    w.scope("top");
    const fstHandle count = w.signal("count", 8), t0 = w.signal("t[0]", 32),
                    t1 = w.signal("t[1]", 32), small = w.signal("t[2]", 16),
                    wide = w.signal("wide", 64), wider = w.signal("inner_wide", 96);
    w.names({{"IDLE", "0"}, {"DRAIN", "011"}, {"DONE", "100"}});
    const fstHandle state = w.signal("state", 3), other = w.signal("other", 3);
    w.up();
    w.time(0);
    w.set(count, 200);
    w.set(t0, std::bit_cast<std::uint32_t>(1.5f));
    w.set(t1, 0xffffffff);
    w.set(small, 0xffff);
    w.set(wide, std::uint64_t{std::bit_cast<std::uint32_t>(-2.0f)} << 32 | 0x3f800000);
    w.set(wider, std::string(96, '0'));
    w.set(state, 3);
    w.set(other, 3);
    w.time(10);
    w.set(state, 5);
    w.time(20);
    w.set(state, 4);
    w.time(30);
  }
  /// The values that `cde wave at` prints.
  nlohmann::json at(const std::string& time, std::vector<std::string> more) {
    more.insert(more.begin(), {"wave", "at", "f.fst", time});
    more.emplace_back("--json");
    const Ran ran = cde(more);
    EXPECT_EQ(ran.status, 0) << ran.err;
    const nlohmann::json answer = nlohmann::json::parse(ran.out);
    nlohmann::json all;
    for (const auto& v : answer["values"]) all.push_back(v["value"]);
    return all;
  }
};

TEST_F(ValueFormats, FormatsInTheFile_AreUsed) {
  EXPECT_EQ(at("0", {"*"}), nlohmann::json({"200", "1.5", "true", "ffff", "{1 -2}",
                                            "000000000000000000000000", "DRAIN", "3"}));
}

TEST_F(ValueFormats, ValueWithoutAName_IsHexadecimal) {
  EXPECT_EQ(at("10", {"state"})[0], "5");
  EXPECT_EQ(at("20", {"state"})[0], "DONE");
}

TEST_F(ValueFormats, RequestedFormat_TakesPrecedence) {
  EXPECT_EQ(at("0", {"state:bin", "count:hex", "t[0]:hex", "state:auto"}),
            nlohmann::json({"011", "c8", "3fc00000", "DRAIN"}));
  EXPECT_EQ(at("0", {"count", "t[1]", "state", "--as", "hex"}),
            nlohmann::json({"c8", "ffffffff", "3"}));
  EXPECT_EQ(at("0", {"t[1]:fp32"})[0], "nan");
  EXPECT_EQ(at("0", {"t[1]:fp32|mask", "wide[1]"}), nlohmann::json({"true", "-2"}));
}

TEST_F(ValueFormats, Expressions_CompareBits) {
  const Ran ran = cde({"wave", "find", "f.fst", "state == 3 && t[1] == 32'hffffffff", "--first"});
  EXPECT_EQ(ran.status, 0) << ran.err;
}

TEST_F(ValueFormats, PicturesAndPages_UseTheFilesFormats) {
  const Ran show = cde({"wave", "show", "f.fst", "state", "t[0]", "--columns", "90"});
  EXPECT_TRUE(has(show.out, "DRAIN")) << show.err;
  EXPECT_TRUE(has(show.out, "1.5"));
  EXPECT_EQ(cde({"wave", "serve", "f.fst", "--output", "f.html"}).status, 0);
  EXPECT_TRUE(has(read("f.html"), R"("names":{"0":"IDLE","100":"DONE","11":"DRAIN"})"));
  const Ran diff = cde({"wave", "diff", "f.fst", "f.fst", "--ulp", "1"});
  EXPECT_EQ(diff.status, 0) << diff.err;
}

/// Constructs of other simulators: events, signed kinds, names with a backslash.
class ForeignWaves : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    Writer w(folder_ / "k.fst");
    w.scope("top");
    const fstHandle i = w.signal("i", 32, FST_VT_VCD_INTEGER), b = w.signal("b", 8, FST_VT_SV_BYTE),
                    ev = w.signal("ev", 1, FST_VT_VCD_EVENT), odd = w.signal("\\odd+name!", 4),
                    wire = w.signal("wire", 8), twin = w.signal("twin", 4),
                    other_twin = w.signal("twin", 4), colon = w.signal("\\we:ird", 4),
                    dotted = w.signal("\\a.b[2]", 4), element = w.signal("\\mem[1]", 4),
                    vector = w.signal("word", 4), other = w.signal("\\word[1]", 4);
    w.scope("u[1]");
    const fstHandle inner = w.signal("q [3:0]", 4);
    w.up();
    w.up();
    for (std::uint64_t t = 0; t < 8; ++t) {
      w.time(10 * t);
      w.set(i, (t - 4) & 0xffffffff);
      w.set(b, (t % 2 == 0 ? 0x80 : 0x7f));
      w.set(wire, 0xf0 + t);
      w.set(odd, t);
      w.set(inner, t);
      w.set(twin, t);
      w.set(other_twin, 7 - t);
      for (const fstHandle escaped : {colon, dotted, element, vector}) w.set(escaped, t);
      w.set(other, 15 - t);
      if (t == 2 || t == 3 || t == 6) w.set(ev, 1);
    }
  }
  std::string count(const std::string& expression, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"wave", "find", "k.fst", expression, "--count"});
    return cde(more).out;
  }
};

TEST_F(ForeignWaves, Integers_HaveTheSignOfTheirKind) {
  EXPECT_EQ(count("i < 0 && changed(i)"), "3\n");  // -4 to 3; at 0 nothing has changed yet
  EXPECT_EQ(count("i == -4"), "1\n");
  EXPECT_EQ(count("b < 0"), "4\n");
  EXPECT_EQ(count("unsigned(b) > 127"), "4\n");
  EXPECT_EQ(count("wire < 0"), "0\n");
  EXPECT_EQ(count("i[31:0] < 0"), "0\n") << "the range of all bits has no sign";
  EXPECT_EQ(count("b[7:4] < 0"), "0\n") << "a part has no sign";
}

/// IEEE 1800, 11.6 and 11.8, checked against Icarus Verilog.
TEST_F(ForeignWaves, WidthsAndSigns_ReachTheOperands) {
  for (const char* yes :
       {"(4'd1 - 4'd3) >> 1 == 4'd7",  // a 32-bit amount gives the left side no width
        "(4'd9 + 4'd9) << 2 == 4'd8", "-4'd1 >> 1 == 4'd7", "~4'd0 >> 1 == 4'd7",
        "(4'd9 + 4'd9) + 8'd0 == 8'd18", "(4'd1 - 4'd3) >> 1 == 8'd127",
        "(1'b1 ? -1'b1 : 12'd0) == 12'hfff", "(1'b1 ? 8'd200 + 8'd100 : 8'd0) + 16'd0 == 16'd300",
        "!((1 ? i : 8'd0) < 0)", "(1 ? i : 0) < 0", "(0 ? 8'd1 : 12) <= -1",
        "i + 8'd0 > 1000",  // one unsigned operand makes all unsigned before they are widened
        "i * 1.0 < 0", "i < 0.0", "-5 < 0.0", "i + 0.5 == -3.5", "signed(4'b1000) >>> 1 < 0",
        "(signed(4'sb1000) >>> 1) == -4", "!((signed(4'sb1000) >>> 1) + 4'd0 < 0)"})
    EXPECT_EQ(count(std::string("i == -4 && (") + yes + ")"), "1\n") << yes;
}

TEST_F(ForeignWaves, UnknownBits_ShiftAndMerge) {
  for (const char* yes :
       {"(4'b101x >> 1) == 4'b0101", "(4'b101x << 3) === 4'bx000",
        "(4'b101x << 3 | 4'b1000) == 4'b1000", "(4'bx010 >>> 1) === 4'b0x01",
        "(signed(4'bx010) >>> 1) === 4'sbxx01", "(signed(4'bx010) >>> 1) === 4'b0x01",
        "(4'b1010 >> 1'bx) === 4'bxxxx", "(1'bx ? 4'd3 : 4'd1) === 4'b00x1", "(1'bx ? 4'd3 : 4'd1)",
        "(1'bx ? 4'b1100 : 4'b1010) === 4'b1xx0", "(1'bz ? i : i) == -4"})
    EXPECT_EQ(count(std::string("i == -4 && (") + yes + ")"), "1\n") << yes;
}

TEST_F(ForeignWaves, Events_AreInstants) {
  EXPECT_EQ(count("ev"), "3\n");
  EXPECT_EQ(count("changed(ev)"), "3\n");
  EXPECT_EQ(count("ev && i >= 0"), "1\n");
  EXPECT_EQ(count("ev", {"--from", "21"}), "2\n");
  EXPECT_EQ(count("ev", {"--from", "20"}), "3\n");
  const Ran ran = cde({"wave", "stat", "k.fst", "ev", "--json"});
  const nlohmann::json answer = nlohmann::json::parse(ran.out);
  EXPECT_EQ(answer["signals"][0]["change_count"], 3) << ran.out;
}

TEST_F(ForeignWaves, Name_MayKeepItsBackslash) {
  EXPECT_EQ(count("\\odd+name! == 3"), "1\n");
  EXPECT_EQ(count("\\top.\\odd+name! == 3"), "1\n");
}

TEST_F(ForeignWaves, EscapedName_MayHaveColonsDotsAndBrackets) {
  EXPECT_EQ(count("\\we:ird  == 3"), "1\n");
  EXPECT_EQ(count("\\a.b[2]  == 3"), "1\n");
  EXPECT_EQ(cde({"wave", "find", "k.fst", "\\a.b[2]  == 3"}).out, "30ns  \\a.b[2]=3\n");
  for (const char* name : {"top.\\we:ird", "\\we:ird", "\\we:ird:dec"})
    EXPECT_TRUE(cde({"wave", "at", "k.fst", "30ns", name}).out.ends_with("top.\\we:ird  3\n"))
        << name;
  EXPECT_TRUE(cde({"wave", "at", "k.fst", "30ns", "mem[1]"}).out.ends_with("top.\\mem[1]  3\n"));
  EXPECT_EQ(count("top.mem[1] == 3"), "1\n");
  // A bit of a vector takes precedence over a name of the same form.
  EXPECT_TRUE(cde({"wave", "at", "k.fst", "30ns", "word[1]"}).out.ends_with("top.word[1]  1\n"));
}

TEST_F(ForeignWaves, Instances_MayHaveIndices) {
  EXPECT_EQ(count("u[1].q == 3"), "1\n");
  EXPECT_EQ(count("top.u[1].q[3:1] == 3"), "1\n");
  EXPECT_EQ(count("\\u[1].q [3:1] == 3"), "1\n");
}

TEST_F(ForeignWaves, SignalsOfOneName_AreComparedInOrder) {
  const Ran ran = cde({"wave", "diff", "k.fst", "k.fst"});
  EXPECT_EQ(ran.status, 0) << ran.out;
}

TEST_F(ForeignWaves, CloseReals_CompareWithATolerance) {
  for (const bool other : {false, true}) {
    Writer w(folder_ / (other ? "y.fst" : "x.fst"));
    w.scope("top");
    const fstHandle r = w.signal("r", 8, FST_VT_VCD_REAL), t = w.signal("t", 32);
    w.up();
    w.time(0);
    w.real(r, other ? 1.0000001 : 1);
    w.set(t, 0x3f800000);
    w.time(10);
    w.set(t, 0);
  }
  const auto status = [&](const char* eps) {
    return cde({"wave", "diff", "x.fst", "y.fst", "--as", "fp32", "--eps", eps}).status;
  };
  EXPECT_EQ(status("1e-6"), 0);
  EXPECT_EQ(status("1e-8"), 1);
}

TEST_F(ForeignWaves, InvalidWords_AreRefused) {
  EXPECT_EQ(cde({"wave", "info", "k.fst", "more"}).status, 2);
  EXPECT_EQ(cde({"wave", "find", "k.fst", "b && && wire"}).status, 2);
}

}  // namespace
}  // namespace cde::testing
