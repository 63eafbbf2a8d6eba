// SPDX-License-Identifier: Apache-2.0
// Transactions in a card's waves, compared with the counters of the card and the driver, on both
// buses.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cde/card/board.hpp"
#include "cde/model/device.hpp"
#include "cde/wave/candidates.hpp"
#include "cde/wave/card_signals.hpp"
#include "cde/wave/filter.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/transaction.hpp"
#include "cde/wave/value.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using wave::Trace;
using wave::Transaction;
using Words = std::vector<std::string>;

/// Ten rays at a dozen triangles, twice: the nearest hits, then all hits in stream order.
std::string scene(const std::string& card) {
  return "[card]\nlanes = 4\n" + card + R"(
[[object]]
name = "ground"
mesh = "terrain:3,2,1"
[[object]]
name = "rays"
random_rays = { count = 10, axis = [0, 0, -1], half_angle = 0.3 }
[object.motion]
kind = "still"
position = [15, 10, 2000]
[[query]]
name = "nearest"
pair = "ray-triangle"
primaries = "rays"
secondaries = "ground"
[[query]]
name = "hits"
pair = "ray-triangle"
primaries = "rays"
secondaries = "ground"
mode = "hits"
)";
}

class TxCard : public Cli {
 protected:
  /// Runs the scene; returns the sums of its counters over both queries.
  std::map<std::string, std::uint64_t> play(const std::string& card, const Words& more = {}) {
    write("s.toml", scene(card));
    Words words = {"run", "s.toml", "--trace", "w.fst", "--json", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    std::map<std::string, std::uint64_t> sums;
    if (ran.status != 0) return sums;
    const auto j = nlohmann::json::parse(ran.out);
    for (const auto& q : j["frame_results"][0]["queries"]) {
      sums["hits"] += q["hits"].get<std::uint64_t>();
      for (const auto& [key, value] : q["counters"].items())
        sums[key] += value.get<std::uint64_t>();
    }
    return sums;
  }
  std::vector<Transaction> all(const std::string& kind) {
    Trace trace(folder_ / "w.fst");
    return wave::transactions(trace, {kind}, trace.start(), trace.end());
  }
  /// The last value of a signal minus its first.
  std::uint64_t counted(const std::string& signal) {
    Trace trace(folder_ / "w.fst");
    const std::array handles{wave::find_signal(trace, signal).handle};
    std::optional<std::uint64_t> first, last;
    trace.stream(handles, trace.start(), trace.end(), [&](auto, auto, std::string_view bits) {
      last = wave::word(bits);
      if (!first) first = last;
      return true;
    });
    return *last - *first;
  }
};

std::uint64_t number(const Transaction& t, const std::string& field) {
  const auto text = wave::field_of(t, field);
  return text ? static_cast<std::uint64_t>(wave::as_number(*text).value_or(0)) : 0;
}
std::uint64_t sum(const std::vector<Transaction>& all, const std::string& field) {
  std::uint64_t total = 0;
  for (const Transaction& t : all) total += number(t, field);
  return total;
}
std::uint64_t with(const std::vector<Transaction>& all, const std::string& field,
                   const std::string& value) {
  return static_cast<std::uint64_t>(std::count_if(
      all.begin(), all.end(), [&](const auto& t) { return wave::field_of(t, field) == value; }));
}

/// Fails if a signal was renamed, which would otherwise give an empty table.
void expect_signals(const std::filesystem::path& file, const std::set<std::string_view>& without) {
  Trace trace(file);
  const wave::SignalPlaces places(trace);
  for (const wave::KindSignals& kind : wave::card_signals()) {
    if (without.contains(kind.kind)) continue;
    EXPECT_EQ(places.missing(kind), Words()) << kind.kind;
    EXPECT_EQ(places.of(kind).size(), 1u) << kind.kind;
  }
  EXPECT_EQ(places.missing(wave::tested_signals()), Words());
  EXPECT_EQ(places.of(wave::tested_signals()).size(), 1u);
}

/// Arrivals at the update engine, primary by primary, match the rows of tests.
void expect_tested(const std::filesystem::path& file, const std::vector<Transaction>& tests) {
  std::size_t arrived = 0, kept = 0, hits = 0, wanted = 0;
  for (const Transaction& t : tests)
    if (wave::field_of(t, "pass") == "0") wanted += number(t, "tests");
  for (std::uint64_t primary = 0; primary < 10; ++primary) {
    Trace trace(file);
    std::uint64_t last = 0;
    wave::each_tested(trace, primary, [&](const wave::Tested& t) {
      EXPECT_EQ(t.pass, 0u) << "only the first pass reduces records per ray";
      EXPECT_GT(t.cycle, last);
      EXPECT_EQ(t.candidate, t.f) << "rays have no other candidates";
      EXPECT_LE(t.kept, t.candidate);
      last = t.cycle;
      ++arrived;
      kept += t.kept ? 1 : 0;
      hits += t.f ? 1 : 0;
    });
  }
  EXPECT_EQ(arrived, wanted);
  EXPECT_EQ(kept, sum(tests, "kept"));
  EXPECT_EQ(2 * hits, sum(tests, "hits"));
}

/// The engine's work, which does not depend on the bus.
void expect_engine(const std::map<std::string, std::uint64_t>& counters,
                   const std::vector<Transaction>& passes,
                   const std::vector<Transaction>& primaries,
                   const std::vector<Transaction>& secondaries,
                   const std::vector<Transaction>& tests, const std::vector<Transaction>& records) {
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(wave::field_of(passes[0], "mode"), "nearest");
  EXPECT_EQ(wave::field_of(passes[1], "mode"), "hits");
  EXPECT_EQ(wave::field_of(passes[1], "pair"), "ray-triangle");
  EXPECT_EQ(with(passes, "outcome", "done"), 2u);
  EXPECT_EQ(sum(passes, "cycles"), counters.at("device_cycles") + counters.at("writeback_cycles"));
  EXPECT_EQ(sum(passes, "writeback"), counters.at("writeback_cycles"));
  EXPECT_EQ(sum(passes, "rows"), counters.at("rows"));
  EXPECT_EQ(sum(passes, "stalls"), counters.at("stall_cycles"));
  EXPECT_EQ(sum(passes, "bubbles"), counters.at("bubble_cycles"));
  EXPECT_EQ(sum(passes, "records"), counters.at("card_records"));

  // The rays stay in the register file for the second query.
  EXPECT_EQ(primaries.size(), counters.at("primary_words") / 8);
  EXPECT_EQ(with(primaries, "outcome", "good"), primaries.size());
  for (std::size_t i = 0; i < primaries.size(); ++i) {
    EXPECT_EQ(number(primaries[i], "primary"), i % 10);
    EXPECT_EQ(number(primaries[i], "row"), i % 10 / 4);
    EXPECT_TRUE(wave::field_of(primaries[i], "operand")->starts_with("{15 10 2000 "));
  }

  EXPECT_EQ(secondaries.size(), counters.at("secondaries"));
  EXPECT_EQ(with(secondaries, "outcome", "good"), secondaries.size());
  EXPECT_EQ(sum(secondaries, "rows"), counters.at("rows"));
  EXPECT_EQ(sum(secondaries, "stalls"), counters.at("stall_cycles"));
  for (std::size_t i = 0; i < secondaries.size(); ++i)
    EXPECT_EQ(number(secondaries[i], "index"), i % 12);

  EXPECT_EQ(tests.size(), counters.at("rows"));
  EXPECT_EQ(sum(tests, "tests"), counters.at("tests"));
  EXPECT_EQ(sum(tests, "stalls"), counters.at("stall_cycles"));
  // One pipe has one latency. Hits of the first pass hit in the second pass.
  std::set<std::uint64_t> latencies;
  for (const Transaction& t : tests) latencies.insert(number(t, "cycles"));
  const Board card = Board::open(
      on(default_device(), {.lanes = 4, .algorithm = kLeakFree, .box = true, .trace = true}));
  EXPECT_EQ(latencies, std::set<std::uint64_t>({card.pipe_latency()}));
  EXPECT_EQ(sum(tests, "hits"), 2 * with(records, "pass", "1"));
  EXPECT_GE(sum(tests, "kept"), 8u);

  EXPECT_EQ(records.size(), counters.at("card_records"));
  EXPECT_EQ(with(records, "outcome", "hit"), counters.at("hits"));
  EXPECT_GE(with(records, "outcome", "hit"), 16u) << "ten rays in two passes";
  EXPECT_EQ(with(records, "pass", "0"), 10u);
  for (const Transaction& r : records) {
    if (r.outcome != "hit") continue;
    // Straight down from 2,000, onto hills of up to 400.
    const double t = *wave::as_number(*wave::field_of(r, "T"));
    EXPECT_GT(t, 1600);
    EXPECT_LT(t, 2001);
  }
}

TEST_F(TxCard, FunctionalBus_MatchesTheDriversCounters) {
  const auto counters = play("");
  ASSERT_FALSE(counters.empty());
  expect_signals(folder_ / "w.fst", {"pci", "dma"});
  expect_engine(counters, all("pass"), all("primary"), all("secondary"), all("test"),
                all("record"));
  expect_tested(folder_ / "w.fst", all("test"));
  EXPECT_TRUE(all("pci").empty());
  EXPECT_TRUE(all("dma").empty());
  const auto bus = all("bus");
  std::uint64_t primaries = 0, ddr = 0, sram = 0;
  for (const Transaction& t : bus) {
    const std::string space = *wave::field_of(t, "space");
    (space == "primaries" ? primaries
     : space == "ddr"     ? ddr
                          : sram) += space == "registers" ? 0 : number(t, "words");
    EXPECT_NE(t.outcome, "refused");
  }
  EXPECT_EQ(primaries, counters.at("primary_words") / 2) << "64 bits per beat";
  EXPECT_EQ(ddr, counters.at("secondary_words") / 2);
  EXPECT_EQ(sram, [&] {  // per pass, in whole beats
    std::uint64_t beats = 0;
    for (const Transaction& t : all("pass")) beats += (number(t, "records") * 7 + 1) / 2;
    return beats;
  }());
}

TEST_F(TxCard, CardBehindPci_MatchesTheCardsCounters) {
  const auto counters = play("bus = \"cycle\"");
  ASSERT_FALSE(counters.empty());
  expect_signals(folder_ / "w.fst", {});
  expect_engine(counters, all("pass"), all("primary"), all("secondary"), all("test"),
                all("record"));
  // The waves have every edge of the core clock, also between edges of the PCI clock.
  {
    Trace trace(folder_ / "w.fst");
    wave::Times times(trace, "card.clk_i");
    const auto& edges = times.edges();
    ASSERT_GT(edges.size(), 1000u);
    for (std::size_t i = 1; i < edges.size(); ++i) ASSERT_EQ((edges[i] - edges[i - 1]), 10'000u);
  }
  const auto descriptors = all("dma");
  EXPECT_GE(descriptors.size(), 4u) << "one each for triangles, rays and the records of two passes";
  EXPECT_EQ(with(descriptors, "outcome", "done"), descriptors.size());
  EXPECT_EQ(sum(descriptors, "bytes"), sum(descriptors, "moved"));
  std::uint64_t to_card = 0;
  for (const Transaction& t : descriptors)
    if (wave::field_of(t, "direction") == "to-card") to_card += number(t, "bytes");
  EXPECT_EQ(to_card, 4 * (counters.at("primary_words") + counters.at("secondary_words")));
  std::uint64_t words = 0;
  for (const Transaction& t : all("pci"))
    if (wave::field_of(t, "master") == "card") words += number(t, "words");
  // A descriptor takes 4 words to read, and its completion takes 2 words to write.
  EXPECT_EQ(words, sum(descriptors, "moved") / 8 + 6 * descriptors.size());
}

/// Counters of the card, in the order of its registers.
TEST_F(TxCard, BusFaults_MatchTheCardsCounters) {
  for (const Words& faults : {Words{},
                              {"--fault", "disconnect:9:2@0"},
                              {"--fault", "retry:5@0"},
                              {"--fault", "target-abort:2:0@0"},
                              {"--fault", "parity:2@0"}}) {
    SCOPED_TRACE(faults.empty() ? "no fault" : faults.back());
    const auto narrow = faults.empty() ? "narrow = true\n" : "";
    ASSERT_FALSE(play(std::string("bus = \"cycle\"\n") + narrow, faults).empty());
    const auto pci = all("pci");
    std::vector<Transaction> own;
    for (const Transaction& t : pci)
      if (wave::field_of(t, "master") == "card") own.push_back(t);
    const std::string count = "bridge.registers.count_q";
    EXPECT_GT(own.size(), 8u);
    EXPECT_EQ(own.size(), counted(count + "[0]")) << "bursts";
    EXPECT_EQ(sum(own, "words"), counted(count + "[1]")) << "beats";
    EXPECT_EQ(sum(own, "stalls"), counted(count + "[2]")) << "waits";
    EXPECT_EQ(with(own, "outcome", "retry"), counted(count + "[3]"));
    // The card also counts a STOP# that comes with the last word of a transfer.
    const auto stopped = std::count_if(own.begin(), own.end(), [](const Transaction& t) {
      return number(t, "stop") != 0 && number(t, "words") != 0;
    });
    EXPECT_EQ(static_cast<std::uint64_t>(stopped), counted(count + "[4]")) << "disconnects";
    EXPECT_LE(with(own, "outcome", "disconnect"), counted(count + "[4]"));
    EXPECT_EQ(with(own, "outcome", "target-abort") + with(own, "outcome", "master-abort"),
              counted(count + "[6]"));
    // All cycles with FRAME# or IRDY#, including the host's cycles.
    EXPECT_EQ(sum(pci, "cycles") + pci.size(), counted(count + "[7]"));
    EXPECT_EQ(with(pci, "width", "64") == 0, faults.empty());
  }
}

}  // namespace
}  // namespace cde::testing
