// SPDX-License-Identifier: Apache-2.0
// Checks that the package of a failure leads to the wrong line, for each fault of
// tools/mutants/explain.txt. Each fault takes minutes, so these tests belong to the full tier. The
// table itself is checked in both tiers.
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
constexpr std::size_t kPlaces = 3;  // places that a reader looks at
constexpr unsigned kDrivers = 3;    // statements between a place and the fault
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
  /// Index in kFinds of the table's entry.
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

/// Lines with the words of random pairs.
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

/// A line that a package names.
struct Named {
  std::string file;
  int line = 0;
  std::string how;
  unsigned drivers = 0;  ///< statements between the line and a named operator or signal

  [[nodiscard]] bool is(const std::string& other, int number) const {
    return file == other && line == number;
  }
};

/// All named lines, in the order of fail.txt.
std::vector<Named> named(const json& bundle) {
  std::vector<Named> all;
  const auto add = [&](const json& place, const char* how) {
    Named n{place["file"], place["line"], how, place.value("drivers", 0u)};
    if (std::none_of(all.begin(), all.end(), [&](const Named& m) { return m.is(n.file, n.line); }))
      all.push_back(std::move(n));
  };
  for (const json& place : bundle.value("places", json::array())) add(place, "place");
  // The inputs of the differing operators; the causes of an answer if no operator differs.
  const bool operators = !bundle.value("near_lines", json::array()).empty() ||
                         !bundle.value("first_differences", json::array()).empty();
  for (const json& line : bundle.value(operators ? "near_lines" : "cause_lines", json::array()))
    add(line, operators ? "near" : "cause");
  return all;
}

/// Index in kFinds of the best result for these lines.
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

TEST_P(PlantedBugs, PlantedFault_IsFoundFromTheBundle) {
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
  EXPECT_GE(how, bug.finds()) << "the table expects " << bug["finds"] << "\n"
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

/// Counts of faults by how well they are found.
struct Count {
  std::size_t bugs = 0;
  std::array<std::size_t, kFinds.size()> finds{};  ///< at least so well

  void add(const Bug& bug) {
    ++bugs;
    for (std::size_t i = 0; i <= bug.finds(); ++i) ++finds[i];
  }
  /// A row of the table in the manual.
  [[nodiscard]] std::string row(const char* kind) const {
    return fmt::format("| {} | {} | {} | {} | {} | {} |\n", kind, bugs, finds[4], finds[3],
                       finds[2], finds[1]);
  }
};

/// Each fault test checks the table's entry. This test checks the table against the promised
/// totals, and the manual against the table.
TEST(PlantedBugsTable, Table_MeetsItsPromises) {
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
    EXPECT_EQ(text.find(bug["from"], at + 1), std::string::npos) << "the text occurs twice";
    EXPECT_FALSE(bug["what"].empty());
    EXPECT_EQ(bug["why"].empty(), bug.finds() >= 2)
        << "a fault that is not found must give a reason";
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
