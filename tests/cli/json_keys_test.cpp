// SPDX-License-Identifier: Apache-2.0
// JSON of the verbs: one key per quantity in all of them, and each key explained.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

class JsonKeys : public Cli {};

/// Each key is in the first column of one table, once, and the sources still use it.
TEST_F(JsonKeys, EachKey_IsExplainedOnceAndUsed) {
  std::string sources;
  for (const char* folder : {"tools", "host/src"})
    for (const auto& file : fs::recursive_directory_iterator(fs::path(CDE_SOURCE_DIR) / folder))
      if (file.path().extension() == ".cpp") sources += bytes_of(file.path());
  std::set<std::string> first;
  std::istringstream lines(bytes_of(fs::path(CDE_SOURCE_DIR) / "docs/reference/json.md"));
  for (std::string line; std::getline(lines, line);) {
    static const std::regex key("`([A-Za-z_0-9]+)`");
    if (!line.starts_with('|')) continue;
    const std::string column = line.substr(0, line.find('|', 1));
    for (std::sregex_iterator at(column.begin(), column.end(), key), end; at != end; ++at) {
      const std::string name = (*at)[1];
      EXPECT_TRUE(first.insert(name).second) << name << " is explained twice";
      const bool numbered = name.starts_with("figure_");  // its name contains a number
      EXPECT_TRUE(numbered || sources.find('"' + name + '"') != std::string::npos)
          << "no verb has " << name;
    }
  }
  EXPECT_GT(first.size(), 100u);
}

/// Quantities of several verbs have one name. Each test that runs a verb with --json compares its
/// keys with the table.
TEST_F(JsonKeys, SameQuantity_HasTheSameKey) {
  write("pairs", "0,0,0,1,1.5,0,0,1\n0,0,0,1,9,0,0,1\n");
  write("s.toml",
        "[[object]]\nname = \"t\"\nmesh = \"terrain:3,3,1\"\n[[object]]\nname = \"rays\"\n"
        "random_rays = { count = 9 }\n[[query]]\nname = \"q\"\npair = \"ray-triangle\"\n"
        "primaries = \"rays\"\nsecondaries = \"t\"\n");
  const Ran cast = cde({"cast", "terrain:3,3,1", "--grid", "4x4", "--lanes", "16", "--json", "-q"});
  const Ran query = shell("\"$CDE\" query sphere-sphere --json -q < pairs");
  const Ran run = cde({"run", "s.toml", "--json", "-q"});
  const Ran plan = cde({"plan", "s.toml", "--json"});
  const std::set<std::string> keys[] = {keys_of(cast.out), keys_of(query.out), keys_of(run.out)};
  for (const auto& verb : keys) {
    for (const std::string& key : verb)
      EXPECT_TRUE(documented_keys().contains(key))
          << "docs/reference/json.md lacks the key " << key;
    for (const char* key :
         {"version", "commit", "lanes", "arithmetic", "format", "algorithm", "box", "tests",
          "device_cycles", "hits", "records_compared", "records_matching", "simulation_seconds"})
      EXPECT_TRUE(verb.contains(key)) << key << " is not in " << &verb - keys;
  }
  for (const char* key : {"parameters", "model", "stands_in_for", "clock_hz", "tests", "rows"})
    for (const std::string& text : {cast.out, run.out, plan.out})
      EXPECT_TRUE(keys_of(text).contains(key)) << key;
  EXPECT_EQ(nlohmann::json::parse(query.out.substr(query.out.find('{')))["tests"], 2);
  EXPECT_EQ(nlohmann::json::parse(cast.out)["tests"], 16 * 18);
  EXPECT_EQ(nlohmann::json::parse(run.out)["totals"]["tests"], 9 * 18);
  EXPECT_FALSE(documented_keys().contains("pairs_compared"));
}

TEST_F(JsonKeys, JsonLinesOfRecords_HaveDocumentedKeys) {
  const Ran ran = cde({"cast", "terrain:3,3,1", "--grid", "4x4", "--lanes", "16", "-q", "-o",
                       "r.jsonl", "--fields", "u,v,normal,side,node"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string lines = read("r.jsonl");
  const std::set<std::string> keys = keys_of(lines.substr(0, lines.find('\n')));
  EXPECT_EQ(keys.size(), 10u);
  for (const std::string& key : keys) EXPECT_TRUE(documented_keys().contains(key)) << key;
}

}  // namespace
}  // namespace cde::testing
