// SPDX-License-Identifier: Apache-2.0
// cde wave: nine-state values, events, changes within an instant, names and text of values, and
// omissions of exports.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "cde/wave/four_state.hpp"
#include "run_cde.hpp"
#include "sample.hpp"
#include "tui/tui_tracks.hpp"

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

TEST_F(States, NineStates_IgnoreCaseAndReadHAndLAsNumbers) {
  EXPECT_EQ(times("changed(bus)"), "10 20 ");
  EXPECT_EQ(times("bus === 4'bzzzz"), "10 ");
  EXPECT_EQ(times("bus == 12"), "20 ");
  EXPECT_EQ(times("bus === 4'b1100"), "") << "H counts as 1 in a number, but is not equal to 1";
  EXPECT_EQ(times("bus[3] && !bus[1]"), "20 ");
  EXPECT_TRUE(has(cde({"wave", "at", "s.fst", "20", "bus", "bus:bin"}).out, "H1L0"));
  EXPECT_TRUE(has(cde({"wave", "at", "s.fst", "20", "bus:dec"}).out, "12"));
}

TEST_F(States, ValueGoneWithinItsInstant_IsNoChange) {
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

/// first is triggered where the file begins, and at 20; never is not. The file has two blocks.
class Events : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    Writer w(folder_ / "e.fst");
    w.scope("top");
    const fstHandle first = w.signal("first", 1, FST_VT_VCD_EVENT);
    (void)w.signal("never", 1, FST_VT_VCD_EVENT);
    const fstHandle a = w.signal("a", 1);
    w.time(0);
    w.set(first, 1), w.set(a, 0);
    w.time(20);
    w.set(first, 1);
    w.time(30);
    w.block();
    w.time(40);
    w.set(a, 1);
    w.time(50);
  }
  /// Times at which an event is triggered, by several commands, which must agree.
  std::string times(const std::string& file, const std::string& event,
                    const std::vector<std::string>& window = {}) {
    const auto ask = [&](std::vector<std::string> words) {
      words.insert(words.end(), window.begin(), window.end());
      const Ran ran = cde(words);
      EXPECT_LE(ran.status, 1) << ran.err;
      return ran.out;
    };
    std::string all;
    const Json shown = Json::parse(ask({"wave", "show", file, event, "--json"}));
    for (const Json& c : shown["signals"][0]["changes"]) all += c["time"].dump() + " ";
    for (const std::string& condition : {event, "changed(" + event + ")", "rose(" + event + ")"}) {
      std::string found;
      const Json j = Json::parse(ask({"wave", "find", file, condition, "--json"}));
      for (const Json& m : j["matches"]) found += m["time"].dump() + " ";
      EXPECT_EQ(found, all) << file << ' ' << condition;
    }
    std::string rows;
    for (std::istringstream csv(ask({"wave", "export", file, event, "--format", "csv"})); csv;) {
      std::string row;
      std::getline(csv, row);
      if (row.ends_with(",1")) rows += row.substr(0, row.find(',')) + " ";
    }
    EXPECT_EQ(rows, all) << file;
    const Json stat = Json::parse(ask({"wave", "stat", file, event, "--json"}));
    EXPECT_EQ(stat["signals"][0]["change_count"], std::count(all.begin(), all.end(), ' ')) << file;
    const std::string svg = ask({"wave", "export", file, event, "--format", "svg"});
    EXPECT_EQ(has(svg, "wave event\""), !all.empty()) << file;
    return all;
  }
};

TEST_F(Events, AtTheBegin_IsOneForAllCommands) {
  EXPECT_EQ(times("e.fst", "first"), "0 20 ");
  EXPECT_EQ(times("e.fst", "never"), "");
  for (const std::string other : {"o.fst", "o.vcd"}) {
    ASSERT_EQ(cde({"wave", "export", "e.fst", "-o", other}).status, 0);
    EXPECT_EQ(times(other, "first"), "0 20 ");
    EXPECT_EQ(times(other, "never"), "");
  }
  EXPECT_TRUE(has(cde({"wave", "export", "e.fst", "--format", "wavedrom"}).out,
                  R"("name":"first","wave":"P)"));
  EXPECT_TRUE(has(cde({"wave", "show", "e.fst", "first", "--ascii"}).out, "\nfirst ^ "));
  ASSERT_EQ(cde({"wave", "serve", "e.fst", "never", "-o", "p.html"}).status, 0);
  EXPECT_TRUE(has(cde({"wave", "serve", "e.fst", "never", "-o", "p.html"}).err, "0 changes,"));
  wave::Trace trace(folder_ / "e.fst");
  wave::tui::Tracks tracks(trace);
  EXPECT_EQ(tracks.get(1, 0)->value(0), "1");
  EXPECT_EQ(tracks.get(2, 0)->value(0), "0");
}

/// The second block begins with the value that the event had last, which is no event there.
TEST_F(Events, InitialValueOfABlock_TriggersNothing) {
  for (const char* from : {"20", "21", "30", "35", "40"})
    EXPECT_EQ(times("e.fst", "first", {"--from", from}), from == std::string("20") ? "20 " : "")
        << from;
  {
    Writer w(folder_ / "i.fst");
    w.scope("top");
    const fstHandle e = w.signal("e", 1, FST_VT_VCD_EVENT), a = w.signal("a", 1);
    w.set(e, 1), w.set(a, 1);  // before any time
    w.time(10);
    w.set(a, 0);
    w.time(20);
    w.set(e, 1);
  }
  EXPECT_EQ(times("i.fst", "e"), "20 ");
}

/// Icarus marks every event when it begins to dump and at $dumpon. A second mark there is a
/// trigger.
TEST_F(Events, DumpOfAllValues_TriggersNothing) {
  {
    Writer w(folder_ / "d.fst");
    w.scope("top");
    const fstHandle once = w.signal("once", 1, FST_VT_VCD_EVENT);
    const fstHandle both = w.signal("both", 1, FST_VT_VCD_EVENT);
    const fstHandle a = w.signal("a", 1);
    w.time(5);
    w.set(a, 0), w.set(once, 1), w.set(both, 1);
    w.set(both, 1);
    w.time(10);
    w.set(once, 1);
    w.time(20);
    w.dump(false);
    w.time(30);
    w.dump(true);
    w.set(a, 1), w.set(once, 1), w.set(both, 1);
    w.time(40);
    w.set(both, 1);
    w.time(50);
  }
  EXPECT_EQ(times("d.fst", "once"), "10 ");
  EXPECT_EQ(times("d.fst", "both"), "5 40 ");
  EXPECT_EQ(times("d.fst", "once", {"--from", "30"}), "");
  EXPECT_EQ(times("d.fst", "both", {"--from", "5", "--to", "5"}), "5 ");
  for (const std::string other : {"o.fst", "o.vcd"}) {
    ASSERT_EQ(cde({"wave", "export", "d.fst", "-o", other}).status, 0);
    EXPECT_EQ(times(other, "once"), "10 ");
    EXPECT_EQ(times(other, "both"), "5 40 ");
  }
}

TEST_F(States, Find_ReadsSignalsAsTheFileStates) {
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

TEST_F(States, Exports_ShortenOnlyWhatReadersExtend) {
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

TEST(FourState, WideArithmetic_EqualsThatOfWords) {
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
