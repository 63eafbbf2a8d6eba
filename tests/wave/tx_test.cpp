// SPDX-License-Identifier: Apache-2.0
// cde wave tx on a bus with known cycles, and on files without a bus.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "../has.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/transaction.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using Words = std::vector<std::string>;

class Tx : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_pci(folder_ / "pci.fst");
    write_sample(folder_ / "a.fst");
  }
  Ran tx(Words words) {
    words.insert(words.begin(), {"wave", "tx"});
    return cde(words);
  }
  nlohmann::json json(Words words) {
    words.emplace_back("--json");
    const Ran ran = tx(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return nlohmann::json::parse(ran.out);
  }
  /// The number of transactions that meet a condition.
  std::size_t where(const std::string& condition) {
    const Ran ran = tx({"pci.fst", "--where", condition, "--json"});
    EXPECT_LE(ran.status, 1) << condition << ran.err;
    return ran.status > 1 ? 999 : nlohmann::json::parse(ran.out)["transactions"].size();
  }
  std::string error(const Words& words) {
    const Ran ran = tx(words);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran.err;
  }
  static std::string value(const nlohmann::json& t, const std::string& name) {
    for (const auto& v : t["values"])
      if (v["name"] == name)
        return v["value"].is_string() ? v["value"].get<std::string>() : v["value"].dump();
    return "";
  }
};

TEST_F(Tx, EveryEndOfAPciTransaction_IsReported) {
  const auto j = json({"pci.fst"});
  EXPECT_EQ(j["schema"], "cde.wave.tx.1");
  EXPECT_EQ(j["kinds"], nlohmann::json({"pci"}));
  struct Expected {
    std::string master, command, address, words, width, outcome;
    std::uint64_t begin, cycles, stalls;
  };
  const std::vector<Expected> all = {
      {"host", "memory-write", "0xf0001000", "3", "32", "done", 45, 5, 2},
      {"host", "memory-read", "0xf0000030", "0", "32", "retry", 255, 3, 3},
      {"card", "memory-read-line", "0x00002000", "2", "64", "disconnect", 405, 4, 2},
      {"host", "memory-write", "0xf0004000", "0", "32", "target-abort", 585, 4, 4},
      {"card", "memory-write", "0x00003000", "0", "32", "master-abort", 765, 5, 5},
      {"card", "memory-write", "0x00004000", "2", "64", "parity", 975, 3, 1},
      {"host", "config-read", "0x00000010", "1", "32", "done", 1185, 3, 2},
      {"host", "memory-read", "0xf0000058", "0", "32", "open", 1335, 1, 1}};
  ASSERT_EQ(j["transactions"].size(), all.size()) << j;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& t = j["transactions"][i];
    SCOPED_TRACE(t.dump());
    EXPECT_EQ(value(t, "master"), all[i].master);
    EXPECT_EQ(value(t, "command"), all[i].command);
    EXPECT_EQ(value(t, "address"), all[i].address);
    EXPECT_EQ(value(t, "words"), all[i].words);
    EXPECT_EQ(value(t, "width"), all[i].width);
    EXPECT_EQ(t["outcome"], all[i].outcome);
    EXPECT_EQ(t["begin"], all[i].begin);
    EXPECT_EQ(t["stalls"], all[i].stalls);
    EXPECT_EQ(t["scope"], "card.bridge");
    if (all[i].outcome != "open") {
      EXPECT_EQ(t["end"], all[i].begin + 30 * all[i].cycles);
      EXPECT_EQ(value(t, "cycles"), std::to_string(all[i].cycles));
    }
  }
  EXPECT_EQ(value(j["transactions"][0], "first_word"), "2");
  EXPECT_EQ(value(j["transactions"][0], "access"), "write");
  EXPECT_EQ(value(j["transactions"][1], "access"), "read");
}

TEST_F(Tx, Window_IncludesOverlappingTransactions) {
  // 300 ns lies in the retried read (255 to 345).
  const auto one = json({"pci.fst", "--from", "300", "--to", "320"});
  ASSERT_EQ(one["transactions"].size(), 1u);
  EXPECT_EQ(one["transactions"][0]["outcome"], "retry") << "the transaction ends after the window";
  EXPECT_EQ(json({"pci.fst", "--from", "345", "--to", "405"})["transactions"].size(), 2u);
  EXPECT_EQ(tx({"pci.fst", "--from", "200", "--to", "250"}).status, 1);
  EXPECT_EQ(json({"pci.fst", "--around", "cyc:10", "--window", "1"})["transactions"].size(), 1u);
}

TEST_F(Tx, Conditions_CompareNumbersTimesAndText) {
  const std::vector<std::pair<std::string, std::size_t>> all = {
      {"kind == pci", 8},
      {"kind=pci", 8},
      {"kind != pci", 0},
      {"words > 1", 3},
      {"words>1&&master==card", 2},
      {"master == card || outcome == retry", 4},
      {"!(master == card)", 5},
      {"!!(master == card)", 3},
      {"address == 0x2000", 1},
      {"address >= 0xf0000000", 4},
      {"address ~ '0xf*'", 4},
      {"label ~ '*memory-read*'", 3},
      {"command ~ memory-write", 4},
      {"latency == 150ns", 2},
      {"latency <= 0.09us", 4},
      {"begin >= cyc:32", 3},
      {"begin > 1us && outcome != open", 1},
      {"outcome == 'target-abort'", 1},
      {"outcome == \"target-abort\"", 1},
      {"first_word > 0", 4},   // the others have no first word
      {"first_word != 2", 5},  // they differ from it
      {"outcome < 3", 0},
      {"words = 3.0", 1},
  };
  for (const auto& [condition, count] : all) EXPECT_EQ(where(condition), count) << condition;
}

TEST_F(Tx, WrongCondition_IsMarkedAtItsPlace) {
  const std::vector<std::pair<std::string, std::size_t>> wrong = {{"wrods > 1", 0},
                                                                  {"words >", 7},
                                                                  {"words", 5},
                                                                  {"words > 1 master", 10},
                                                                  {"(words > 1", 10},
                                                                  {"words > 'x", 8},
                                                                  {"== 1", 0},
                                                                  {"words > 1 &&", 12},
                                                                  {"latency > x", 10},
                                                                  {"begin > 3h", 8},
                                                                  {"begin > cyc:99999", 8},
                                                                  {"words & 1", 6}};
  for (const auto& [condition, column] : wrong) {
    const std::string text = error({"pci.fst", "--where", condition});
    const std::string mark = "\n  " + condition + "\n  " + std::string(column, ' ') + "^\n";
    EXPECT_TRUE(text.ends_with(mark)) << text;
  }
  EXPECT_TRUE(has(error({"pci.fst", "--where", "wrods > 1"}), "did you mean words?"));
  (void)error({"pci.fst", "--where", std::string(5000, '(')});
  (void)error({"pci.fst", "--where", std::string(5000, '!') + "words > 1"});
  // A field of another kind than the requested one.
  (void)error({"pci.fst", "pci", "--where", "hits > 1"});
  EXPECT_EQ(where("hits > 1"), 0u);
}

TEST_F(Tx, WrongUsage_IsRefused) {
  EXPECT_TRUE(has(error({"pci.fst", "pcj"}), "did you mean pci?"));
  EXPECT_TRUE(has(error({"pci.fst", "--histogram", "lantency"}), "did you mean latency?"));
  (void)error({"pci.fst", "--csv", "--json"});
  (void)error({"pci.fst", "--csv", "--histogram", "words"});
  (void)error({"pci.fst", "--ulp", "3"});
  (void)error({"none.fst"});
}

TEST_F(Tx, FileWithoutACard_IsReported) {
  Ran ran = tx({"a.fst"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_EQ(ran.out, "");
  EXPECT_TRUE(has(ran.err, "none of the card's signals"));
  ran = tx({"pci.fst", "dma"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_TRUE(has(ran.err, "the file has the kinds pci"));
  EXPECT_TRUE(has(ran.err, "fetched_q"));
  // A missing signal is named.
  {
    Writer w(folder_ / "half.fst");
    std::vector<fstHandle> signals;
    w.scope("bridge");
    for (const char* name : {"devsel_n", "frame_n", "irdy_n"}) signals.push_back(w.signal(name, 1));
    w.up();
    for (const unsigned t : {0, 10}) {
      w.time(t);
      for (const fstHandle s : signals) w.set(s, t == 0);
    }
  }
  ran = tx({"half.fst", "pci"});
  EXPECT_TRUE(has(ran.err, "clk, trdy_n, stop_n, ..."));
}

TEST_F(Tx, Output_IsBoundedAndCountsTheRest) {
  const Ran ran = tx({"pci.fst", "--max", "2"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_TRUE(has(ran.out, "\n... 6 more (--max 0 prints all)\n8 pci\n"));
  EXPECT_EQ(json({"pci.fst", "--max", "2"})["more"], 6);
  EXPECT_EQ(json({"pci.fst", "--max", "2"})["counts"][0]["count"], 8);
  const Ran csv = tx({"pci.fst", "pci", "--csv", "--max", "1"});
  EXPECT_EQ(csv.out,
            "kind,begin,end,latency,stalls,outcome,cycles,master,access,command,address,words,"
            "width,bytes,first_word,stop,label,scope\n"
            "pci,45,195,150,2,done,5,host,write,memory-write,0xf0001000,3,32,12,2,0,"
            "\"host memory-write 0xf0001000, 3 words of 32 bits\",card.bridge\n");
  EXPECT_EQ(tx({"pci.fst", "--csv", "--max", "1"}).out, csv.out) << "kinds without transactions";
  EXPECT_EQ(csv.err, "cde: ... 7 more (--max 0 prints all)\n");
}

TEST_F(Tx, Histograms_CountValuesAndSteps) {
  const auto j = json({"pci.fst", "--histogram", "words"});
  EXPECT_EQ(j["count"], 8);
  ASSERT_EQ(j["bars"].size(), 4u);
  EXPECT_EQ(j["bars"][0], nlohmann::json({{"least", 0.0}, {"most", 0.0}, {"count", 4}}));
  EXPECT_EQ(j["summary"]["most"], 3);
  EXPECT_EQ(j["summary"]["median"], 0);
  EXPECT_EQ(j["summary"]["sum"], 8);
  EXPECT_EQ(json({"pci.fst", "--histogram", "outcome"})["bars"].size(), 7u);
  EXPECT_EQ(tx({"pci.fst", "--histogram", "master", "--ascii", "--columns", "40"}).out,
            "card  3  ###################\nhost  5  ###############################\n");
  EXPECT_EQ(tx({"pci.fst", "--histogram", "hits"}).status, 1);
}

/// Transactions are reported as they end and need not be kept; the reader may stop early.
TEST_F(Tx, Reader_MayStopEarly) {
  wave::Trace trace(folder_ / "pci.fst");
  unsigned seen = 0;
  wave::each_transaction(trace, {}, trace.start(), trace.end(), [&](const wave::Transaction& t) {
    EXPECT_EQ(t.kind, "pci");
    return ++seen < 3;
  });
  EXPECT_EQ(seen, 3u);
  EXPECT_EQ(wave::transactions(trace, {"pci"}, 0, 100).size(), 1u);
  EXPECT_TRUE(wave::transactions(trace, {"record"}, 0, trace.end()).empty());
}

/// Undriven values and damaged files do not crash the command.
TEST_F(Tx, UnknownValuesAndDamagedFiles_NeverCrash) {
  {
    Writer w(folder_ / "x.fst");
    w.scope("b");
    const fstHandle clk = w.signal("clk", 1);
    std::vector<std::pair<fstHandle, unsigned>> all;
    for (const auto& [name, width] : std::vector<std::pair<std::string, unsigned>>{{"devsel_n", 1},
                                                                                   {"frame_n", 1},
                                                                                   {"irdy_n", 1},
                                                                                   {"trdy_n", 1},
                                                                                   {"stop_n", 1},
                                                                                   {"req64_n", 1},
                                                                                   {"ack64_n", 1},
                                                                                   {"perr_n", 1},
                                                                                   {"cbe_n", 8},
                                                                                   {"ad", 64},
                                                                                   {"own", 1}})
      all.emplace_back(w.signal(name, width), width);
    w.up();
    std::mt19937 random(5);
    for (unsigned t = 0; t < 2000; ++t) {
      w.time(t);
      w.set(clk, t % 2);
      for (const auto& [handle, width] : all) {
        std::string bits;
        for (unsigned i = 0; i < width; ++i) bits += "01xz"[random() % (width == 1 ? 3 : 4)];
        w.set(handle, bits);
      }
    }
  }
  const Ran ran = tx({"x.fst", "--max", "0"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, " x, "));
  const std::string whole = read("pci.fst");
  std::mt19937 random(6);
  for (unsigned i = 0; i < 40; ++i) {
    std::string bytes = whole;
    if (i % 2 == 0)
      bytes.resize(random() % bytes.size());
    else
      for (unsigned k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    write("d.fst", bytes);
    EXPECT_LE(tx({"d.fst"}).status, 2) << i;
  }
}

}  // namespace
}  // namespace cde::testing
