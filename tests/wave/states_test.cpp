// SPDX-License-Identifier: Apache-2.0
// cde wave: nine-state values, events, changes within an instant, names and text of values, and
// omissions of exports.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "cde/wave/four_state.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using Json = nlohmann::json;

class States : public Cli {
 protected:
  /// Signal bus is UUUU, ZZZZ at 10, and H1L0 at 20. Signal glitch changes back within 15. Events
  /// ev are at 10 and 30. The state is IDLE, then RUN at 20. Signal t_o is 1.0, and 0.25 at 20, in
  /// fp32 according to the file.
  void SetUp() override {
    Cli::SetUp();
    Writer w(folder_ / "s.fst");
    w.comment("forms *.t_o=fp32");
    w.scope("top");
    const fstHandle bus = w.signal("bus [3:0]", 4), glitch = w.signal("glitch", 1),
                    ev = w.signal("ev", 1, FST_VT_VCD_EVENT);
    w.names({{"IDLE", "00"}, {"RUN", "01"}});
    const fstHandle state = w.signal("state [1:0]", 2), number = w.signal("t_o [31:0]", 32);
    w.time(0);
    w.set(bus, "UUUU"), w.set(glitch, 0), w.set(state, 0), w.set(number, 0x3f800000);
    w.time(10);
    w.set(bus, "ZZZZ"), w.set(ev, 1);
    w.time(15);
    w.set(glitch, 1), w.set(glitch, 0);
    w.time(20);
    w.set(bus, "H1L0"), w.set(state, 1), w.set(number, 0x3e800000);
    w.time(30);
    w.set(ev, 1);
    w.time(40);
    w.set(glitch, 1);
  }
  std::string times(const std::string& expression) {
    const Ran ran = cde({"wave", "find", "s.fst", expression, "--json"});
    EXPECT_LE(ran.status, 1) << ran.err;
    std::string all;
    const Json found = Json::parse(ran.out);
    for (const Json& m : found["matches"]) all += m["time"].dump() + " ";
    return all;
  }
};

TEST_F(States, NineStates_AreOfTwoCasesAndHAndLAreNumbers) {
  EXPECT_EQ(times("changed(bus)"), "10 20 ");
  EXPECT_EQ(times("bus === 4'bzzzz"), "10 ");
  EXPECT_EQ(times("bus == 12"), "20 ");
  EXPECT_EQ(times("bus === 4'b1100"), "") << "H counts as 1 in a number, but is not equal to 1";
  EXPECT_EQ(times("bus[3] && !bus[1]"), "20 ");
  EXPECT_TRUE(has(cde({"wave", "at", "s.fst", "20", "bus", "bus:bin"}).out, "H1L0"));
  EXPECT_TRUE(has(cde({"wave", "at", "s.fst", "20", "bus:dec"}).out, "12"));
}

TEST_F(States, AValueThatIsGoneWithinItsInstant_IsNoChange) {
  EXPECT_EQ(times("changed(glitch)"), "40 ");
  const Json j = Json::parse(cde({"wave", "stat", "s.fst", "glitch", "bus", "--json"}).out);
  EXPECT_EQ(j["signals"][0]["change_count"], 1);
  EXPECT_EQ(j["signals"][1]["change_count"], 2);
  const Json shown = Json::parse(cde({"wave", "show", "s.fst", "glitch", "--json"}).out);
  EXPECT_EQ(shown["signals"][0]["changes"].size(), 2u);
  EXPECT_TRUE(has(cde({"wave", "serve", "s.fst", "glitch", "-o", "p.html"}).err, "1 change,"));
}

TEST_F(States, Events_AreMarks) {
  const Json shown = Json::parse(cde({"wave", "show", "s.fst", "ev", "--json"}).out);
  ASSERT_EQ(shown["signals"][0]["changes"].size(), 2u);
  EXPECT_EQ(shown["signals"][0]["changes"][1]["time"], 30);
  EXPECT_EQ(
      cde({"wave", "show", "s.fst", "ev", "--columns", "45", "--ascii"}).out,
      "top  0 to 40ns\n     |0                  |20ns\nev            ^                   ^\n");
  EXPECT_EQ(cde({"wave", "export", "s.fst", "ev", "--format", "csv"}).out,
            "time,top.ev\n0,0\n10,1\n30,1\n");
  EXPECT_TRUE(has(cde({"wave", "export", "s.fst", "ev", "bus", "--format", "wavedrom"}).out,
                  R"("name":"ev","wave":"0P0P")"));
  EXPECT_TRUE(has(cde({"wave", "export", "s.fst", "ev", "--format", "svg"}).out, "wave event"));
}

TEST_F(States, Find_ReadsASignalAsTheFileHasIt) {
  EXPECT_EQ(times("t_o > 0.5"), "0 ");
  EXPECT_EQ(times("t_o < 1"), "20 ");
  EXPECT_EQ(times("t_o == 32'h3e800000"), "20 ") << "compared with bits, the value is bits";
  EXPECT_EQ(times("state == \"RUN\""), "20 ");
  EXPECT_EQ(times("state != \"RUN\""), "0 ");
  EXPECT_EQ(times("changed(state)"), "20 ");
  EXPECT_TRUE(has(cde({"wave", "find", "s.fst", "state == \"RUM\""}).err, "did you mean RUN?"));
  EXPECT_TRUE(has(cde({"wave", "find", "s.fst", "bus == \"RUN\""}).err, "whose values have names"));
  EXPECT_TRUE(has(cde({"wave", "find", "s.fst", "state + \"RUN\""}).err, "only be compared"));
}

TEST_F(States, Exports_ShortenOnlyWhatReadersFillUp) {
  const std::string vcd = cde({"wave", "export", "s.fst", "--format", "vcd"}).out;
  EXPECT_TRUE(has(vcd, "bUUUU "));
  EXPECT_TRUE(has(vcd, "bz "));
  EXPECT_TRUE(has(vcd, "bH1L0 "));
  EXPECT_TRUE(has(cde({"wave", "export", "s.fst", "--format", "csv", "--as", "bin"}).out,
                  "00111111100000000000000000000000"));
  EXPECT_TRUE(has(cde({"wave", "export", "s.fst", "--format", "vcd", "--as", "bin"}).err,
                  "--as cannot be combined with --format vcd"));
}

TEST_F(States, AFileBelowDev_IsAFile) {
  const std::string file = "/dev/shm/cde_states_test.vcd";
  EXPECT_EQ(cde({"wave", "export", "s.fst", "-o", file}).status, 0);
  EXPECT_TRUE(std::filesystem::remove(file));
}

TEST(FourState, WideArithmetic_IsThatOfWords) {
  const auto wide = [](std::uint64_t v) {
    wave::Value r;
    r.width = 64;
    r.v = v;
    return wave::extended(r, 200);
  };
  const wave::Shape n{200, false, false};
  const wave::Value a =
      wave::arithmetic('*', wide(0xfedcba9876543210), wide(0xf00000000000000d), n);
  const wave::Value b = wide(0x123456789abcdef1);
  const wave::Value q = wave::arithmetic('/', a, b, n), r = wave::arithmetic('%', a, b, n);
  const wave::Value back = wave::arithmetic('+', wave::arithmetic('*', q, b, n), r, n);
  EXPECT_EQ(characters(back), characters(a));
  EXPECT_EQ(truth(wave::order("<", r, b)), wave::Truth::kYes);
  const wave::Shape s{200, true, false};
  wave::Value minus = wave::negative(b);
  minus.is_signed = true;
  wave::Value seven = wide(7);
  seven.is_signed = true;
  EXPECT_EQ(truth(wave::order("<", minus, seven)), wave::Truth::kYes);
  const wave::Value rest = wave::arithmetic('%', minus, seven, s);
  EXPECT_EQ(characters(wave::negative(rest)), characters(wide(0x123456789abcdef1 % 7)));
}

}  // namespace
}  // namespace cde::testing
