// SPDX-License-Identifier: Apache-2.0
// Whether what a failure leaves leads to the line that is wrong: faults of
// tools/mutants/explain.txt, one at a time. Minutes each, so they are of the full tier; the table
// itself is checked in both.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "../has.hpp"
#include "cde/check/random_pairs.hpp"
#include "cde/geometry/pair.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr unsigned kPairs = 400;
constexpr std::uint64_t kSeed = 20261124;
constexpr std::size_t kPlaces = 3;  // that a reader looks at
constexpr unsigned kDrivers = 3;    // statements behind them
constexpr std::size_t kBugs = 24, kFiles = 22, kLines = 20;

const fs::path kFolder = fs::path(CDE_SOURCE_DIR) / "tests/cli";
const fs::path kTable = fs::path(CDE_SOURCE_DIR) / "tools/mutants/explain.txt";

/// How well a bundle leads to a line, from worst to best.
const std::array<std::string, 5> kFinds = {"nothing", "file", "cone", "three", "first"};

/// An entry of the table.
struct Bug {
  std::map<std::string, std::string> fields;

  [[nodiscard]] const std::string& operator[](const std::string& key) const {
    static const std::string kNone;
    const auto found = fields.find(key);
    return found == fields.end() ? kNone : found->second;
  }
  [[nodiscard]] std::string file() const { return (*this)["file"]; }
  /// Place in kFinds of what the table says.
  [[nodiscard]] std::size_t finds() const {
    return static_cast<std::size_t>(std::find(kFinds.begin(), kFinds.end(), (*this)["finds"]) -
                                    kFinds.begin());
  }
};

const std::vector<Bug>& bugs() {
  static const std::vector<Bug> kAll = [] {
    std::vector<Bug> all;
    std::istringstream lines(bytes_of(kTable));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t end = line.find(' '), value = line.find_first_not_of(' ', end);
      if (line.empty() || line[0] == '#' || value == std::string::npos) continue;
      const std::string key = line.substr(0, end);
      if (key == "mutant") all.emplace_back();
      if (!all.empty()) all.back().fields[key] = line.substr(value);
    }
    return all;
  }();
  return kAll;
}

/// Lines of the words of random pairs.
std::string random_pairs(const std::string& pair) {
  RandomPairs random(kSeed);
  std::string text;
  for (unsigned i = 0; i < kPairs; ++i) {
    std::vector<float> a, b;
    random.pair(*pair_named(pair), a, b);
    text += fmt::format("{:a} | {:a}\n", fmt::join(a, " "), fmt::join(b, " "));
  }
  return text;
}

/// A line that a bundle names.
struct Named {
  std::string file;
  int line = 0;
  std::string how;
  unsigned drivers = 0;  ///< statements between it and an operator or a signal that is named

  [[nodiscard]] bool is(const std::string& other, int number) const {
    return file == other && line == number;
  }
};

/// All of them in the order of fail.txt.
std::vector<Named> named(const json& bundle) {
  std::vector<Named> all;
  const auto add = [&](const json& place, const char* how) {
    Named n{place["file"], place["line"], how, place.value("drivers", 0u)};
    if (std::none_of(all.begin(), all.end(), [&](const Named& m) { return m.is(n.file, n.line); }))
      all.push_back(std::move(n));
  };
  for (const json& place : bundle.value("places", json::array())) add(place, "place");
  // What feeds the operators that part; the causes of an answer where none does.
  const bool operators = !bundle.value("near_lines", json::array()).empty() ||
                         !bundle.value("first_differences", json::array()).empty();
  for (const json& line : bundle.value(operators ? "near_lines" : "cause_lines", json::array()))
    add(line, operators ? "near" : "cause");
  return all;
}

/// Place in kFinds of what they lead to.
std::size_t found(const std::vector<Named>& all, const std::string& file, int line) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].file != file || (i >= kPlaces && all[i].drivers > kDrivers)) continue;
    std::size_t how = 1;
    if (all[i].line == line) how = i == 0 ? 4 : i < kPlaces ? 3 : 2;
    best = std::max(best, how);
  }
  return best;
}

class PlantedBugs : public Cli, public ::testing::WithParamInterface<std::size_t> {};

TEST_P(PlantedBugs, AreFoundFromTheBundle) {
  const Bug& bug = bugs()[GetParam()];
  const Planted fault(folder_, bug.file(), bug["from"], bug["to"]);
  for (const auto& entry : fs::directory_iterator(kFolder / "planted"))
    fs::copy(entry.path(), folder_ / entry.path().filename());
  std::string script;
  for (const std::string& variable : fault.environment()) script += "export " + variable + "\n";
  script += "\"$CDE\" " + bug["run"] + " -q";
  if (!bug["pairs"].empty()) {
    write("pairs", random_pairs(bug["pairs"]));
    script += " < pairs";
  }
  const Ran ran = shell(script);
  EXPECT_EQ(ran.status, 3) << ran.err;
  ASSERT_TRUE(exists("cde-failure/fail.json")) << ran.err;
  const json bundle = json::parse(read("cde-failure/fail.json"));
  EXPECT_EQ(bundle.value("happened_again", false), true);
  const std::string file = fs::path(bug.file()).filename().string();
  const std::vector<Named> all = named(bundle);
  std::string places;
  for (std::size_t i = 0; i < std::min(all.size(), kPlaces); ++i)
    places += fmt::format(" {}:{} ({})", all[i].file, all[i].line, all[i].how);
  const std::size_t how = found(all, file, fault.line());
  fmt::print("{}: planted in {}:{}, named{}: {}\n", bug["mutant"], file, fault.line(), places,
             kFinds[how]);
  RecordProperty("finds", kFinds[how]);
  EXPECT_GE(how, bug.finds()) << "the table says " << bug["finds"] << "\n"
                              << read("cde-failure/fail.txt");
  if (const char* keep = std::getenv("CDE_KEEP_BUNDLES"))
    fs::copy(folder_ / "cde-failure", fs::path(keep) / bug["mutant"], fs::copy_options::recursive);
}

INSTANTIATE_TEST_SUITE_P(Table, PlantedBugs, ::testing::Range(std::size_t{0}, bugs().size()),
                         [](const auto& info) {
                           std::string name = bugs()[info.param]["mutant"];
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// How many faults of a kind are found how well.
struct Count {
  std::size_t bugs = 0;
  std::array<std::size_t, kFinds.size()> finds{};  ///< at least so well

  void add(const Bug& bug) {
    ++bugs;
    for (std::size_t i = 0; i <= bug.finds(); ++i) ++finds[i];
  }
  /// A row of the manual's table.
  [[nodiscard]] std::string row(const char* kind) const {
    return fmt::format("| {} | {} | {} | {} | {} | {} |\n", kind, bugs, finds[4], finds[3],
                       finds[2], finds[1]);
  }
};

/// Each fault is held to what the table says of it; here the table is held to what is promised, and
/// the manual to the table.
TEST(PlantedBugsTable, FindsEnough) {
  Count pipes, around, all;
  for (const Bug& bug : bugs()) {
    SCOPED_TRACE(bug["mutant"]);
    ASSERT_LT(bug.finds(), kFinds.size()) << bug["finds"];
    const std::string file = bug["file"];
    (file.starts_with("rtl/pipes/") || file.starts_with("rtl/fp/") ? pipes : around).add(bug);
    all.add(bug);
    const std::string text = bytes_of(fs::path(CDE_SOURCE_DIR) / bug.file());
    const std::size_t at = text.find(bug["from"]);
    EXPECT_NE(at, std::string::npos) << bug["from"];
    EXPECT_EQ(text.find(bug["from"], at + 1), std::string::npos) << "there twice";
    EXPECT_FALSE(bug["what"].empty());
    EXPECT_EQ(bug["why"].empty(), bug.finds() >= 2) << "what is not found says why";
  }
  EXPECT_EQ(all.bugs, kBugs);
  EXPECT_GE(all.finds[1], kFiles);
  EXPECT_GE(all.finds[2], kLines);
  const std::string manual = bytes_of(fs::path(CDE_SOURCE_DIR) / "docs/tables/explain.md");
  for (const std::string& row :
       {pipes.row("pipes and their gates"), around.row("engine, transformer, records, memory, bus"),
        all.row("all")})
    EXPECT_TRUE(has(manual, row));
}

}  // namespace
}  // namespace cde::testing
