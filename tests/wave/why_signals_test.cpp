// SPDX-License-Identifier: Apache-2.0
// cde wave why: signals of arrays, structures, and the kinds integer and int.
#include <cstdint>

#include "why.hpp"

namespace cde::testing {
namespace {

using Json = nlohmann::json;

/// Verilator 5.048 writes elements of arrays into a scope with the array's name.
TEST_F(Why, ElementsInTheirArraysScope_HaveTheirOwnDrivers) {
  structure("cells",
            "module cells(input clk, input [1:0] at, input [7:0] d);\n"
            "logic [7:0] mm [0:3];\n"
            "logic [7:0] pp [0:1][0:1];\n"
            "always_ff @(posedge clk) begin\n"
            "  mm[at] <= d;\n"
            "  pp[1][0] <= mm[2];\n"
            "end\n"
            "endmodule\n");
  {
    Writer w(folder_ / "cells.fst");
    w.scope("TOP");
    w.scope("cells");
    const fstHandle clk = w.signal("clk", 1), at = w.signal("at [1:0]", 2),
                    d = w.signal("d [7:0]", 8);
    w.scope("mm");
    const fstHandle m1 = w.signal("mm[1] [7:0]", 8), m2 = w.signal("mm[2] [7:0]", 8);
    w.up();
    w.scope("pp");
    w.scope("[1]");
    const fstHandle p10 = w.signal("pp[1][0] [7:0]", 8);
    for (unsigned t = 0; t <= 30; t += 5) {
      w.time(t);
      w.set(clk, t / 5 % 2);
      if (t == 0) w.set(at, 2), w.set(d, 7), w.set(m1, 0), w.set(m2, 0), w.set(p10, 0);
      if (t == 5) w.set(m2, 7);
      if (t == 15) w.set(p10, 7);
    }
  }
  EXPECT_EQ(
      cde({"wave", "at", "cells.fst", "12", "cells.mm[2]", "cells.mm[2][2:0]", "pp[1][0]"}).out,
      "at 12ns\nTOP.cells.mm.mm[2]         07\nTOP.cells.mm.mm[2][2:0]    7\n"
      "TOP.cells.pp.[1].pp[1][0]  00\n");
  const Json element = why("cells.fst", "TOP.cells.mm.mm[2]@12", "cells.xml", {"--depth", "1"});
  ASSERT_EQ(element["cone"]["statements"].size(), 1u);
  EXPECT_EQ(element["cone"]["statements"][0]["line"], 5);
  EXPECT_EQ(element["cone"]["bits"], "00000111");
  const Json deep = why("cells.fst", "TOP.cells.pp.[1].pp[1][0]@17", "cells.xml")["cone"];
  ASSERT_EQ(deep["statements"].size(), 1u);
  EXPECT_EQ(deep["statements"][0]["line"], 6);
  EXPECT_EQ(causes(deep["statements"][0]), Texts{"TOP.cells.mm[2]=00000111@14:5"});
}

/// Variables of the kind integer and int: registers, indices, loops, and comparisons with a sign.
class Integers : public WhyStructure {
 protected:
  void SetUp() override {
    WhyStructure::SetUp();
    structure("numbers");
    Writer w(folder_ / "n.fst");
    w.scope("numbers");
    const auto number = [&](const char* name, fstVarType kind = FST_VT_VCD_INTEGER) {
      return w.signal(name + std::string(" [31:0]"), 32, kind);
    };
    const fstHandle clk = w.signal("clk", 1), v = w.signal("v [7:0]", 8), total = number("total"),
                    at = number("at"), first = number("first"), acc = number("acc"),
                    j = number("j"), k = number("k", FST_VT_SV_INT),
                    count = number("count", FST_VT_SV_INT), m0 = w.signal("mem[0] [7:0]", 8),
                    m1 = w.signal("mem[1] [7:0]", 8), turned = w.signal("turned [7:0]", 8),
                    low = w.signal("low", 1);
    std::uint32_t cells[2] = {3, 5}, sum = 0;
    for (unsigned t = 0; t <= 60; t += 5) {
      const unsigned edges = (t + 5) / 10;
      const std::uint32_t counted = edges - 2;
      w.time(t);
      w.set(clk, t / 5 % 2);
      if (t % 10 == 5) {
        sum += cells[(edges - 1) % 2];
        cells[(edges - 1) % 2] = 0x16;
        w.set(low, 0);
      }
      w.set(m0, cells[0]), w.set(m1, cells[1]);
      w.set(v, 0x16), w.set(turned, 0x68), w.set(first, 4), w.set(j, 0xffffffff), w.set(k, 4);
      w.set(count, counted), w.set(acc, counted + 2), w.set(at, edges % 2), w.set(total, sum);
    }
  }
  Json statements(const std::string& what) {
    return why("n.fst", what, "numbers.xml", {"--depth", "1"})["cone"]["statements"];
  }
};

INSTANTIATE_TEST_SUITE_P(Structure, Integers, ::testing::Values(".xml", ".tree.json"),
                         [](const auto& form) { return form.index == 0 ? "Xml" : "Json"; });

TEST_P(Integers, Registers_AreFollowed) {
  const Json total = statements("total@25");
  ASSERT_EQ(total.size(), 1u) << total;
  EXPECT_EQ(total[0]["line"], 12);
  const Texts from = causes(total[0]);
  ASSERT_EQ(from.size(), 3u) << total;
  EXPECT_TRUE(from[0].starts_with("numbers.total=0")) << from[0];
  EXPECT_EQ(from[1], "numbers.mem[0]=00010110@24:11");
  EXPECT_EQ(from[2], "numbers.at[0]=0@24:10");
}

TEST_P(Integers, ComparisonsWithThem_HaveASign) {
  const Json before = statements("low@15"), behind = statements("low@35");
  ASSERT_EQ(before.size(), 1u) << before;
  EXPECT_EQ(before[0]["line"], 13);
  ASSERT_EQ(behind.size(), 1u) << behind;
  EXPECT_EQ(behind[0]["line"], 14);
}

/// first is -1 within the instant, and the waves have what it is at the end.
TEST_P(Integers, ValuesWithinAnInstant_AreNotThoseOfTheWaves) {
  const Json first = statements("first@12");
  ASSERT_EQ(first.size(), 1u) << first;
  EXPECT_EQ(first[0]["line"], 19);
  EXPECT_EQ(first[0]["certain"], false);
  const Json acc = statements("acc@12");
  ASSERT_FALSE(acc.empty());
  EXPECT_EQ(acc.back()["line"], 22);
  EXPECT_TRUE(causes(acc.back()).empty()) << "itself, from within the instant";
  EXPECT_FALSE(statements("j@12").empty()) << "the step of a loop assigns it";
}

/// k is 4 in the waves; bit 1 is assigned in the turn of -3.
TEST_P(Integers, TurnsOfAWhileLoop_MayBeNegative) {
  const Json turned = statements("turned[1]@12");
  ASSERT_EQ(turned.size(), 1u) << turned;
  EXPECT_EQ(turned[0]["line"], 27);
  EXPECT_EQ(causes(turned[0]), Texts{"numbers.v[6]=0@12"});
}

/// As --trace-structs has Verilator write them; the first member has the highest bits.
TEST_F(Why, MembersInAScopeOfTheirStructure_AreItsBits) {
  structure("pair",
            "module pair(input [7:0] d, output [7:0] y);\n"
            "  typedef struct packed { logic [3:0] high, low; } two_t;\n"
            "  two_t p;\n"
            "  assign p = d + 8'd1;\n"
            "  assign y = p ^ 8'd3;\n"
            "endmodule\n");
  {
    Writer w(folder_ / "pair.fst");
    w.scope("pair");
    const fstHandle d = w.signal("d [7:0]", 8), y = w.signal("y [7:0]", 8);
    w.scope("p");
    const fstHandle high = w.signal("high [3:0]", 4), low = w.signal("low [3:0]", 4);
    w.time(0);
    w.set(d, 0x5f), w.set(high, 6), w.set(low, 0), w.set(y, 0x63);
    w.time(10);
  }
  const Json statements = why("pair.fst", "pair.y@5", "pair.xml")["cone"]["statements"];
  ASSERT_EQ(statements.size(), 1u);
  EXPECT_EQ(causes(statements[0]), Texts{"pair.p=01100000@5:4"});
}

}  // namespace
}  // namespace cde::testing
