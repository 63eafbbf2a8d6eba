// SPDX-License-Identifier: Apache-2.0
// cde wave stat on files of twelve cycles whose figures are counted by hand.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using Json = nlohmann::json;

/// A one-bit signal and its value in each cycle: 0, 1, x.
struct Pattern {
  std::string scope, name, levels;
};

/// Writes the signals of a scope together. They change at the falling clock edges, 0, 10, 20, ...,
/// and the clock rises 5 later. A scope is "top" or below it. Signals with the same pattern in one
/// `alias` are one signal.
void write_patterns(const std::filesystem::path& file, const std::vector<Pattern>& patterns,
                    const std::vector<std::pair<std::string, std::string>>& aliases = {}) {
  Writer w(file);
  w.scope("top");
  const fstHandle clk = w.signal("clk", 1);
  std::vector<fstHandle> handles(patterns.size());
  std::string open = "top";
  std::map<std::string, fstHandle> by_name;
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const Pattern& p = patterns[i];
    if (p.scope != open) {
      if (open != "top") w.up();
      if (p.scope != "top") w.scope(p.scope);
      open = p.scope;
    }
    const std::string full = p.scope + "." + p.name;
    for (const auto& [own, of] : aliases)
      if (own == full) handles[i] = w.alias(p.name, 1, by_name.at(of));
    if (handles[i] == 0) by_name[full] = handles[i] = w.signal(p.name, 1);
  }
  if (open != "top") w.up();
  w.up();
  const std::size_t cycles = patterns.front().levels.size();
  for (std::size_t k = 0; k < cycles; ++k) {
    w.time(10 * k);
    w.set(clk, 0);
    for (std::size_t i = 0; i < patterns.size(); ++i)
      if (!patterns[i].levels.empty()) w.set(handles[i], std::string(1, patterns[i].levels[k]));
    w.time(10 * k + 5);
    w.set(clk, 1);
  }
  w.time(10 * cycles);
}

class Stat : public Cli {
 protected:
  /// Three handshakes in a row: a enters front, b goes from front to back, c leaves back.
  void write_chain() {
    write_patterns(folder_ / "chain.fst",
                   {{"front", "valid_i", "111111011111"},
                    {"front", "ready_o", "111100011110"},
                    {"front", "valid_o", "111111000111"},
                    {"front", "ready_i", "111000111111"},
                    {"back", "valid_i", ""},
                    {"back", "ready_o", ""},
                    {"back", "valid_o", "011111100110"},
                    {"back", "ready_i", "110001110101"},
                    {"flow", "valid_o", "011001010000"}},
                   {{"back.valid_i", "front.valid_o"}, {"back.ready_o", "front.ready_i"}});
  }
  Json json(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "stat"});
    words.emplace_back("--json");
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return Json::parse(ran.out);
  }
  std::string error(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "stat"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran.err;
  }
  static const Json& named(const Json& list, const std::string& name) {
    for (const Json& one : list)
      if (one["name"] == name) return one;
    static const Json none;
    ADD_FAILURE() << "no " << name << " in " << list;
    return none;
  }
  /// Expected: transfers, stalled, idle, unknown, longest stall, its time.
  static void expect_use(const Json& h, const std::array<int, 6>& expected) {
    EXPECT_EQ(h["transferred_cycles"], expected[0]) << h;
    EXPECT_EQ(h["stalled_cycles"], expected[1]) << h;
    EXPECT_EQ(h["idle_cycles"], expected[2]) << h;
    EXPECT_EQ(h["unknown_cycles"], expected[3]) << h;
    EXPECT_EQ(h["longest_stall"], expected[4]) << h;
    EXPECT_EQ(h["time"], expected[4] == 0 ? Json() : Json(expected[5])) << h;
  }
};

TEST_F(Stat, Handshakes_AreCountedPerCycle) {
  write_chain();
  const Json j = json({"chain.fst"});
  EXPECT_EQ(j["schema"], "cde.wave.stat.1");
  EXPECT_EQ(j["cycles"], 12);
  ASSERT_EQ(j["handshakes"].size(), 3u);  // the middle one once, though it has two names
  expect_use(named(j["handshakes"], "top.front.valid_i/ready_o"), {8, 3, 1, 0, 2, 45});
  expect_use(named(j["handshakes"], "top.front.valid_o/ready_i"), {6, 3, 3, 0, 3, 35});
  expect_use(named(j["handshakes"], "top.back.valid_o/ready_i"), {4, 4, 4, 0, 3, 25});
  EXPECT_EQ(named(j["handshakes"], "top.back.valid_o/ready_i")["utilisation"], 4.0 / 12);
  // `find` gives the same count.
  EXPECT_EQ(cde({"wave", "find", "chain.fst", "back.valid_o && back.ready_i", "--on", "posedge clk",
                 "--count"})
                .out,
            "4\n");
}

TEST_F(Stat, ChainOfStalls_NamesItsOrigin) {
  write_chain();
  const Json j = json({"chain.fst"});
  ASSERT_EQ(j["chains"].size(), 1u) << j["chains"];
  const Json& chain = j["chains"][0];
  EXPECT_EQ(chain["members"], Json::array({"top.front.valid_i/ready_o", "top.front.valid_o/ready_i",
                                           "top.back.valid_o/ready_i"}));
  EXPECT_EQ(chain["origin"], "top.back.valid_o/ready_i");
  EXPECT_EQ(chain["occurrences"], 1);
  EXPECT_EQ(chain["stalled_cycles"], 4);  // cycles 2 to 5
  EXPECT_EQ(chain["time"], 25);
  EXPECT_TRUE(has(cde({"wave", "stat", "chain.fst"}).out,
                  "4 cycles, at 25ns cyc:2, origin top.back.valid_o/ready_i\n"
                  "  top.front.valid_i/ready_o\n  top.front.valid_o/ready_i\n"
                  "  top.back.valid_o/ready_i\n"));
}

TEST_F(Stat, SeparateFlows_AreNoChain) {
  // Two parallel flows, both stalled in cycle 1, and a third within the first.
  write_patterns(folder_ / "two.fst", {{"p", "valid_i", "1111"},
                                       {"p", "ready_o", "1011"},
                                       {"p", "valid_o", "1111"},
                                       {"p", "ready_i", "1011"},
                                       {"q", "valid_i", "1111"},
                                       {"q", "ready_o", "1011"},
                                       {"q", "valid_o", "0000"},
                                       {"q", "ready_i", "0000"}});
  const Json j = json({"two.fst"});
  ASSERT_EQ(j["chains"].size(), 1u) << j["chains"];
  EXPECT_EQ(j["chains"][0]["members"],
            Json::array({"top.p.valid_i/ready_o", "top.p.valid_o/ready_i"}));
  // Both stall in the same cycle: the downstream one is the cause.
  EXPECT_EQ(j["chains"][0]["origin"], "top.p.valid_o/ready_i");
}

TEST_F(Stat, IdleCycles_LieBetweenFirstAndLastValid) {
  write_chain();
  const Json j = json({"chain.fst"});
  ASSERT_EQ(j["bubbles"].size(), 1u);  // the valid of a handshake belongs to no pipe
  const Json& b = j["bubbles"][0];
  EXPECT_EQ(b["name"], "top.flow.valid_o");
  EXPECT_EQ(b["cycles"], 12);
  EXPECT_EQ(b["valid_cycles"], 4);
  EXPECT_EQ(b["empty_cycles"], 3);
  EXPECT_EQ(b["longest_bubble"], 2);
  EXPECT_EQ(b["time"], 35);
  EXPECT_EQ(b["first_valid"], 15);
  EXPECT_EQ(b["last_valid"], 75);
}

TEST_F(Stat, Window_CountsOnlyItsCycles) {
  write_chain();
  const Json j = json({"chain.fst", "--from", "20", "--to", "60"});
  EXPECT_EQ(j["cycles"], 4);
  expect_use(named(j["handshakes"], "top.back.valid_o/ready_i"), {1, 3, 0, 0, 3, 25});
  // Whole cycles around cycle 4: the edges at 35, 45, 55 and the values after them.
  const Json around = json({"chain.fst", "--around", "cyc:4", "--window", "1"});
  EXPECT_EQ(around["cycles"], 3);
  expect_use(named(around["handshakes"], "top.back.valid_o/ready_i"), {2, 1, 0, 0, 1, 45});
}

TEST_F(Stat, RequestsUnknownLevelsAndAxiNames_AreRecognised) {
  write_patterns(folder_ / "more.fst", {{"top", "mem_req", "xx0110"},
                                        {"top", "mem_ack", "000101"},
                                        {"axi", "m_wvalid", "110011"},
                                        {"axi", "m_wready", "010101"},
                                        {"axi", "m_rvalid", "000001"},
                                        {"axi", "m_rready", "111111"},
                                        {"low", "valid_n", "001100"},
                                        {"low", "ready_n", "000011"}});
  const Json all = json({"more.fst"});
  const Json& h = all["handshakes"];
  ASSERT_EQ(h.size(), 4u) << h;
  expect_use(named(h, "top.mem_req/mem_ack"), {1, 1, 2, 2, 1, 45});
  EXPECT_EQ(named(h, "top.mem_req/mem_ack")["protocol"], "req/ack");
  expect_use(named(h, "top.axi.m_wvalid/m_wready"), {2, 2, 2, 0, 1, 5});
  expect_use(named(h, "top.axi.m_rvalid/m_rready"), {1, 0, 5, 0, 0, 0});
  expect_use(named(h, "top.low.valid_n/ready_n"), {2, 2, 2, 0, 2, 45});
}

TEST_F(Stat, Pci_HasDataPhasesWaitsAndAddressPhases) {
  write_patterns(folder_ / "pci.fst", {{"bus", "frame_n", "100001101011"},
                                       {"bus", "irdy_n", "110000110100"},
                                       {"bus", "trdy_n", "111010110110"},
                                       {"bus", "req_n", "111111111111"}});
  const Json j = json({"pci.fst"});
  ASSERT_EQ(j["handshakes"].size(), 1u);
  const Json& h = j["handshakes"][0];
  EXPECT_EQ(h["name"], "top.bus.frame_n/irdy_n/trdy_n");
  EXPECT_EQ(h["protocol"], "pci");
  // Address in 1, 7, 9; data in 3, 5, 8, 11; idle in 0, 6; waits in 2, 4, 10.
  EXPECT_EQ(h["address_cycles"], 3);
  expect_use(h, {4, 3, 2, 0, 1, 25});
}

TEST_F(Stat, Signals_HaveTheirActivity) {
  {
    Writer w(folder_ / "s.fst");
    w.scope("top");
    const fstHandle level = w.signal("level", 1), bus = w.signal("bus [3:0]", 4),
                    still = w.signal("still", 1);
    w.time(0);
    w.set(level, 0);
    w.set(bus, 0);
    w.set(still, 1);
    w.time(20);
    w.set(level, 1);
    w.time(30);
    w.set(bus, 5);
    w.time(40);
    w.set(bus, 10);
    w.time(50);
    w.set(level, 0);
    w.time(70);
    w.set(bus, std::string("xx10"));
    w.time(110);
    w.set(level, 1);
    w.time(120);
  }
  const Json j = json({"s.fst"});
  EXPECT_EQ(j["cycles"], Json());  // no clock
  const auto expect = [&](const Json& signals, const std::string& name,
                          const std::array<int, 4>& figures, const Json& share) {
    const Json& s = named(signals, name);
    EXPECT_EQ(s["change_count"], figures[0]) << s;
    EXPECT_EQ(s["toggles"], figures[1]) << s;
    EXPECT_EQ(s["longest_quiet"], figures[2]) << s;
    EXPECT_EQ(s["time"], figures[3]) << s;
    EXPECT_EQ(s["share_at_one"], share) << s;
    EXPECT_EQ(s["changes_per_cycle"], Json());
  };
  expect(j["signals"], "top.level", {3, 3, 60, 50}, 40.0 / 120);
  expect(j["signals"], "top.bus", {3, 6, 50, 70}, Json());
  expect(j["signals"], "top.still", {0, 0, 120, 0}, 1.0);
  const Json part = json({"s.fst", "level", "bus[1]", "--from", "25", "--to", "60"});
  expect(part["signals"], "top.level", {1, 1, 25, 25}, 25.0 / 35);
  expect(part["signals"], "top.bus[1]", {1, 1, 20, 40}, 20.0 / 35);
  // Cycles of a signal that is named as the clock.
  const Json clocked = json({"s.fst", "bus", "--clock", "level"});
  EXPECT_EQ(clocked["cycles"], 2);
  EXPECT_EQ(clocked["signals"][0]["changes_per_cycle"], 1.5);
}

TEST_F(Stat, ScopesAndPatterns_SelectSignals) {
  write_chain();
  const Json j = json({"chain.fst", "back"});
  EXPECT_EQ(j["handshakes"].size(), 2u);
  EXPECT_EQ(j["signals"].size(), 4u);
  EXPECT_EQ(j["bubbles"].size(), 0u);
  EXPECT_EQ(json({"chain.fst", "*ready*"})["signals"].size(), 3u);
  const Json less = json({"chain.fst", "--max", "2"});
  EXPECT_EQ(less["handshakes"].size(), 2u);
  EXPECT_EQ(less["more"], 1 + 1 + 6);  // a handshake, one of a chain; two of 8 signals are shown
  const Ran text = cde({"wave", "stat", "chain.fst", "--max", "2"});
  EXPECT_TRUE(has(text.out, "... 1 more"));
}

TEST_F(Stat, InvalidUsage_IsRefused) {
  write_chain();
  EXPECT_TRUE(has(error({"chain.fst", "frnt"}), "no signal"));
  EXPECT_TRUE(has(error({"chain.fst", "--from", "5us"}), "outside"));
  EXPECT_TRUE(has(error({"chain.fst", "--from", "60", "--to", "20"}), "after"));
  EXPECT_TRUE(has(error({"chain.fst", "--clock", "nothing"}), "no signal"));
  EXPECT_TRUE(has(error({"chain.fst", "--on", "posedge clk"}), "has no option '--on'"));
  EXPECT_TRUE(has(error({"nothing.fst"}), "nothing.fst"));
  write("text.fst", "no waves");
  (void)error({"text.fst"});
  // An empty window has no cycles and no shares, and causes no division by zero.
  const Json j = json({"chain.fst", "--from", "20", "--to", "20"});
  EXPECT_EQ(j["cycles"], 0);
  EXPECT_EQ(j["handshakes"][0]["utilisation"], Json());
  EXPECT_EQ(j["signals"][0]["share_at_one"], Json());
}

}  // namespace
}  // namespace cde::testing
