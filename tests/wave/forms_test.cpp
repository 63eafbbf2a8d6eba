// SPDX-License-Identifier: Apache-2.0
// How values are written when nobody says: as the file does.
#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

class Forms : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    Writer w(folder_ / "f.fst");
    w.comment("forms *count=dec *t[*]=e8m23|mask*1 *wide=fp32*2 *bad=none *=auto");
    w.scope("top");
    const fstHandle count = w.signal("count", 8), t0 = w.signal("t[0]", 32),
                    t1 = w.signal("t[1]", 32), small = w.signal("t[2]", 16),
                    wide = w.signal("wide", 64), wider = w.signal("inner_wide", 96);
    w.names({{"IDLE", "0"}, {"SWEEP", "011"}, {"DONE", "100"}});
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

TEST_F(Forms, TheFileSaysHowSignalsAreWritten) {
  EXPECT_EQ(at("0", {"*"}), nlohmann::json({"200", "1.5", "true", "ffff", "{1 -2}",
                                            "000000000000000000000000", "SWEEP", "3"}));
}

TEST_F(Forms, AValueWithoutANameIsHexadecimal) {
  EXPECT_EQ(at("10", {"state"})[0], "5");
  EXPECT_EQ(at("20", {"state"})[0], "DONE");
}

TEST_F(Forms, WhatSomebodySaysComesFirst) {
  EXPECT_EQ(at("0", {"state:bin", "count:hex", "t[0]:hex", "state:auto"}),
            nlohmann::json({"011", "c8", "3fc00000", "SWEEP"}));
  EXPECT_EQ(at("0", {"count", "t[1]", "state", "--as", "hex"}),
            nlohmann::json({"c8", "ffffffff", "3"}));
  EXPECT_EQ(at("0", {"t[1]:fp32"})[0], "nan");
  EXPECT_EQ(at("0", {"t[1]:fp32|mask", "wide[1]"}), nlohmann::json({"true", "-2"}));
}

TEST_F(Forms, ExpressionsAreOfBits) {
  const Ran ran = cde({"wave", "find", "f.fst", "state == 3 && t[1] == 32'hffffffff", "--first"});
  EXPECT_EQ(ran.status, 0) << ran.err;
}

TEST_F(Forms, PicturesAndPagesWriteThemToo) {
  const Ran show = cde({"wave", "show", "f.fst", "state", "t[0]", "--columns", "90"});
  EXPECT_NE(show.out.find("SWEEP"), std::string::npos) << show.out << show.err;
  EXPECT_NE(show.out.find("1.5"), std::string::npos) << show.out;
  EXPECT_EQ(cde({"wave", "serve", "f.fst", "--output", "f.html"}).status, 0);
  EXPECT_NE(read("f.html").find(R"("names":{"0":"IDLE","100":"DONE","11":"SWEEP"})"),
            std::string::npos);
  const Ran diff = cde({"wave", "diff", "f.fst", "f.fst", "--ulp", "1"});
  EXPECT_EQ(diff.status, 0) << diff.err;
}

}  // namespace
}  // namespace cde::testing
