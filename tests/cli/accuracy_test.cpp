// SPDX-License-Identifier: Apache-2.0
// cde accuracy: repeatable figures per seed, runs that continue, and refusals.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using Words = std::vector<std::string>;
using Json = nlohmann::ordered_json;

class Accuracy : public Cli {
 protected:
  /// Without the count of operators, which only sweeps need.
  static Words command(const Words& words) {
    Words all = {"accuracy", "-q"};
    bool sweeps = true;
    for (const char* other : {"--mesh", "--scene", "--filters", "--from"})
      sweeps = sweeps && std::find(words.begin(), words.end(), other) == words.end();
    if (sweeps) all.emplace_back("--no-operators");
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  Ran accuracy(const Words& words) { return cde(command(words)); }
  /// The pipes in the JSON output.
  Json pipes(Words words) {
    words.emplace_back("--json");
    const Ran ran = accuracy(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.status == 0 ? Json::parse(ran.out).at("configurations") : Json::array();
  }
  void refused(const Words& words, const std::string& text) { Cli::refused(command(words), text); }
};

TEST_F(Accuracy, SameSeed_GivesTheSameFigures) {
  const Words some = {"--pair",       "sphere-sphere,ray-triangle",
                      "--formats",    "fp16,fp32",
                      "--cases",      "60",
                      "--algorithms", "moller",
                      "--by-family"};
  Words other = some;
  other.insert(other.end(), {"--seed", "2"});
  const Ran first = accuracy(some), again = accuracy(some), seeded = accuracy(other);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(first.out, again.out);
  EXPECT_NE(first.out, seeded.out);
  std::istringstream lines(first.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120u) << line;
  for (const char* text :
       {"sphere-sphere fp16", "ray-triangle moller box fp32", "  near-contact", "  mesh-edges"})
    EXPECT_TRUE(has(first.out, text));
}

TEST_F(Accuracy, MoreBits_HaveSmallerErrors) {
  const Json all = pipes({"--pair", "obb-plane", "--formats", "fp16,fp32,fp64", "--cases", "200"});
  ASSERT_EQ(all.size(), 3u);
  const auto differ = [&](std::size_t i) {
    const Json& t = all[i].at("all_families");
    return t.at("undecided").get<int>() + t.at("refused").get<int>();
  };
  EXPECT_EQ(all[0].at("format"), "fp16");
  EXPECT_GT(differ(0), differ(1));
  EXPECT_GT(differ(1), differ(2));
  for (const Json& pipe : all) {
    EXPECT_EQ(pipe.at("all_families").at("cases"), 200);
    EXPECT_EQ(pipe.at("all_families").at("false_hits").at("count"), 0);
    int cases = 0;
    for (const Json& family : pipe.at("families")) cases += family.at("cases").get<int>();
    EXPECT_EQ(cases, 200);
    EXPECT_TRUE(pipe.at("cost").at("luts").is_null() || pipe.at("cost").at("luts") > 0);
    EXPECT_TRUE(pipe.at("cost").at("latency_levels").is_null()) << "no cost table was given";
  }
}

/// Variants that no card has, for comparison: worse quadratic formulas, and separating axes that
/// give F only.
TEST_F(Accuracy, Variants_AreComparedWithTheCard) {
  const Json rays = pipes({"--pair", "ray-sphere", "--formats", "fp32", "--cases", "2800",
                           "--variants", "card,fused,textbook"});
  ASSERT_EQ(rays.size(), 3u);
  const auto error = [](const Json& pipe, const char* what) {
    return pipe.at("all_families").at("t_error_u").at(what).get<double>();
  };
  EXPECT_EQ(rays[0].at("variant"), "card");
  EXPECT_EQ(rays[1].at("variant"), "fused");
  EXPECT_EQ(rays[2].at("variant"), "textbook");
  EXPECT_LT(error(rays[0], "largest"), 13);
  EXPECT_LT(error(rays[1], "median"), error(rays[0], "median"));
  EXPECT_GT(error(rays[2], "p99"), 30 * error(rays[0], "p99"));
  EXPECT_TRUE(rays[2].at("all_families").at("worst_t").at("repeat_command").is_null());
  EXPECT_FALSE(rays[0].at("all_families").at("worst_t").at("repeat_command").is_null());

  const Json boxes = pipes({"--pair", "triangle-aabb,sphere-plane", "--formats", "fp32", "--cases",
                            "28000", "--variants", "textbook"});
  ASSERT_EQ(boxes.size(), 1u);  // no textbook has the other one
  const Json& all = boxes[0].at("all_families");
  EXPECT_EQ(all.at("t_error_u").at("count"), 0);
  EXPECT_EQ(all.at("not_numbers"), 0);
  EXPECT_GT(
      all.at("false_hits").at("count").get<int>() + all.at("false_misses").at("count").get<int>(),
      0);

  const Ran none = accuracy({"--pair", "sphere-plane", "--variants", "textbook"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.err, "cde: none of the pairs has the variant of --variants textbook\n");
}

/// Triangles that are single points: coarse formats round small triangles far away to them.
TEST_F(Accuracy, PointTriangles_HaveFiniteErrors) {
  const Json all = pipes({"--pair", "triangle-triangle", "--formats", "bf16", "--cases", "2400"})
                       .at(0)
                       .at("all_families");
  EXPECT_TRUE(all.at("t_error_u").at("largest").is_number()) << all.at("t_error_u");
  EXPECT_TRUE(all.at("oracle_u").at("largest").is_number()) << all.at("oracle_u");
}

TEST_F(Accuracy, Promises_EqualTheDocs) {
  std::ifstream in(std::filesystem::path(CDE_SOURCE_DIR) / "docs/tables/stability.md");
  const std::string docs{std::istreambuf_iterator<char>(in), {}};
  const Ran ran = accuracy({"--promises", "--cases", "10000", "--formats", "fp16,fp32,fp64",
                            "--pair", "sphere-sphere,triangle-aabb,ray-cylinder"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  std::istringstream lines(ran.out);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_TRUE(has(docs, line + '\n'));
  EXPECT_EQ(count, 2u + 9u);
}

TEST_F(Accuracy, CertainDecisions_AreTrue) {
  const Ran ran = accuracy({"--filters", "--pair", "obb-obb,triangle-cylinder", "--formats", "bf16",
                            "--cases", "2901", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Json j = Json::parse(ran.out);
  EXPECT_EQ(j["schema"], "cde.accuracy.filters.1");
  ASSERT_EQ(j["filters"].size(), 2U);
  EXPECT_TRUE(j["filters"][0]["iterations"].is_null());
  EXPECT_EQ(j["filters"][1]["iterations"], "4,2,2");
  for (const Json& row : j["filters"]) {
    Json sum = row["all_families"];
    EXPECT_EQ(sum["cases"], 2901);
    EXPECT_EQ(sum["wrong"], 0);
    EXPECT_GT(sum["certain_misses"], 300);
    EXPECT_GT(sum["certain_hits"], 300);
    EXPECT_GT(sum["uncertain_in_band"],
              100);  // exact contact: no certified filter of binary32 decides there
    for (const Json& family : row["families"])
      for (auto& [key, value] : sum.items()) value = value.get<long>() - family.at(key).get<long>();
    for (const auto& [key, value] : sum.items()) EXPECT_EQ(value, 0) << key;
  }
  const Ran table = accuracy({"--filters", "--pair", "sphere-sphere", "--families", "random",
                              "--cases", "500", "--by-family"});
  EXPECT_TRUE(has(table.out, "sphere-sphere fp16 random"));
}

TEST_F(Accuracy, UnsupportedFilters_AreRefused) {
  refused({"--filters", "--pair", "ray-sphere"},
          "--filters: ray-sphere is not possible; expected pairs of solids without a plane");
  refused({"--filters", "--mesh", "terrain"}, "--filters");
  for (const char* wide : {"fp32", "fp64"})
    refused({"--filters", "--pair", "sphere-sphere", "--formats", wide},
            "expected a format with no more exponent bits and fewer fraction bits than fp32");
  refused({"--filters", "--pair", "obb-obb", "--families", "nothing"}, "no family 'nothing'");
  refused({"--filters", "--pair", "obb-obb", "--iterations", "4,2,2"},
          "--iterations cannot be combined with these pairs");
}

/// A run that ended anywhere, even within a line, continues to the same file and table.
TEST_F(Accuracy, InterruptedRun_ContinuesWhereItEnded) {
  const Words some = {"--pair", "sphere-plane,ray-sphere", "--formats", "bf16,fp32", "--cases",
                      "90"};
  const auto with = [&](const std::string& file) {
    Words words = some;
    words.insert(words.end(), {"--resume", file});
    return accuracy(words);
  };
  const Ran whole = with("journal");
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_EQ(whole.out, accuracy(some).out);
  const std::string lines = read("journal");
  for (const double share : {0.0, 0.001, 0.3, 0.77, 1.0}) {
    write("journal", lines.substr(0, static_cast<std::size_t>(share * lines.size())));
    const Ran rest = with("journal");
    EXPECT_EQ(rest.status, 0) << rest.err;
    EXPECT_EQ(read("journal"), lines) << share;
    EXPECT_EQ(rest.out, whole.out);
  }
  Words other = some;
  other.insert(other.end(), {"--seed", "7", "--resume", "journal"});
  const Ran refused = accuracy(other);
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(has(refused.err, "belongs to a run with seed 1; this run has 7"));
  EXPECT_EQ(read("journal"), lines);
  std::string old = lines;
  old.replace(old.find("journal.3"), 9, "journal.1");
  write("journal", old);
  const Ran stale = with("journal");
  EXPECT_EQ(stale.status, 2);
  EXPECT_TRUE(has(stale.err, "journal of another version of cde, \"cde.journal.1\""));
  EXPECT_EQ(read("journal"), old);
}

TEST_F(Accuracy, Shards_AddUpToTheWhole) {
  const Words some = {"--pair", "sphere-sphere", "--formats", "fp16,bf16,fp32", "--cases", "60"};
  for (const char* shard : {"1/2", "2/2"}) {
    Words words = some;
    words.insert(words.end(), {"--shard", shard, "--resume", std::string("shard") + shard[0]});
    const Ran part = accuracy(words);
    ASSERT_EQ(part.status, 0) << part.err;
    EXPECT_EQ(part.out, "");
  }
  const Ran both = cde({"merge", "shard2", "shard1"});
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.out, accuracy(some).out);
}

TEST_F(Accuracy, UnknownNames_GetSuggestions) {
  refused({"--pair", "sphere-shpere"}, "no pair 'sphere-shpere'; did you mean sphere-sphere?");
  refused({"--formats", "fp32,fp8"}, "no format 'fp8'; ");
  refused({"--algorithms", "mollar"}, "no algorithm 'mollar'; did you mean moller?");
  refused({"--pair", "obb-obb", "--families", "grazing"}, "no family 'grazing'; there are: near-");
  refused({"--pair", "obb-obb", "--iterations", "8,8,8"},
          "--iterations cannot be combined with these pairs");
  refused({"--iterations", "4,0"}, "--iterations is '4,0'; it must be M,K1,K2");
  refused({"--iterations", "4,99,0"}, "--iterations: K1 is 99");
  refused({"--cases", "0"}, "--cases is '0'; it must be a whole number, 1 to 100000000");
  refused({"--shard", "3/2"}, "--shard is '3/2'; it must be I/N");
  refused({"--mesh", "none.obj"}, "none.obj");
  write("other", "{\"schema\":\"something else\"}\n");
  refused({"--pair", "sphere-sphere", "--resume", "other"}, "other");
  for (const char* device : {"/dev/zero", "/dev/null"})
    refused({"--pair", "sphere-sphere", "--resume", device}, "is not a regular file");
}

/// Repeated iterations are measured once.
TEST_F(Accuracy, RepeatedIterations_AreMeasuredOnce) {
  const Json all = pipes({"--pair", "obb-cylinder", "--formats", "fp16", "--cases", "20",
                          "--iterations", "4,0,0:4,2,2:4,0,0"});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].at("iterations"), "4,0,0");
  EXPECT_EQ(all[1].at("iterations"), "4,2,2");
}

TEST_F(Accuracy, RepeatedFamily_IsMeasuredOnce) {
  const Ran ran = accuracy({"--pair", "sphere-sphere", "--formats", "fp16", "--cases", "20",
                            "--families", "random,deep,random", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Json all = Json::parse(ran.out);
  EXPECT_EQ(all.at("only_families"), (Json{"random", "deep"}));
}

/// An option without effect is refused, and nothing is measured or written.
TEST_F(Accuracy, OptionsWithoutEffect_AreRefused) {
  const Words mesh = {"--mesh", "terrain:8,8,1", "--grid", "4x4"};
  for (const Words& more : std::initializer_list<Words>{{"--check", "10"},
                                                        {"--cases", "5"},
                                                        {"--families", "anywhere"},
                                                        {"--profiles", "3"},
                                                        {"--resume", "m.jsonl"},
                                                        {"--promises"},
                                                        {"--by-family"}}) {
    Words words = mesh;
    words.insert(words.end(), more.begin(), more.end());
    refused(words, more[0] + " cannot be combined with --mesh");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.jsonl"));
  refused({"--mesh", "terrain:8,8,1", "--pair", "obb-obb"},
          "--mesh cannot be combined with --pair obb-obb; expected ray-triangle");
  refused({"--scene", "none.toml", "--page", "q.html"}, "--page cannot be combined with --scene");
  refused({"--scene", "none.toml", "--check", "3"}, "--check cannot be combined with --scene");
  refused({"--filters", "--pair", "sphere-sphere", "--algorithms", "moller"},
          "--algorithms cannot be combined with --filters");
  refused({"--from", "x.json", "--page", "p.html", "--cases", "5"},
          "--cases cannot be combined with --from");
  refused({"--by-family", "--json"}, "--by-family cannot be combined with --json");
  refused({"--by-family", "--promises"}, "--by-family cannot be combined with --promises");
  refused({"--target", "hx8k", "--promises"}, "--target cannot be combined with --promises");
  refused({"--resume", "-"},
          "--resume is -; it must be a file, because the journal is read and written");
  refused({"--page", "-", "--json"}, "--json and --page");
  refused({"--grid", "3x3"}, "--grid needs --mesh");
  refused({"--camera", "auto"}, "--camera needs --mesh");
  refused({"--pair", "sphere-plane", "--box", "on"},
          "--box cannot be combined with --pair sphere-plane");
  refused({"--pair", "sphere-plane", "--profiles", "10"},
          "--profiles cannot be combined with --pair sphere-plane");
  refused({"--pair", "sphere-plane", "--page", "-", "--json"}, "--page");
}

/// The share of cases that the reference cannot decide grows with the quantile, and so do its
/// bounds.
TEST_F(Accuracy, OracleBounds_GrowWithTheQuantile) {
  const Json all = pipes({"--pair", "obb-obb", "--formats", "fp64", "--cases", "1400", "--short"});
  const Json& oracle = all.at(0).at("all_families").at("oracle_u");
  EXPECT_GT(oracle.at("largest"), oracle.at("p999"));
  const Ran table =
      accuracy({"--pair", "obb-obb", "--formats", "fp64", "--cases", "1400", "--markdown"});
  std::istringstream line(table.out.substr(table.out.find("| obb-obb fp64 ")));
  std::vector<double> bounds;
  for (std::string cell; std::getline(line, cell, '|') && cell.find('\n') == std::string::npos;)
    if (const auto at = cell.find('<'); at != std::string::npos)
      bounds.push_back(std::stod(cell.substr(at + 1)));
  ASSERT_GE(bounds.size(), 3u) << table.out;  // at least p99, p99.9 and the largest
  EXPECT_TRUE(std::ranges::is_sorted(bounds)) << table.out;
  EXPECT_GT(bounds.back(), bounds[bounds.size() - 2]);
}

/// A mesh with a known picture: formats with few bits give other pixels.
TEST_F(Accuracy, FewBits_ChangePixelsOfAPicture) {
  const Ran ran = accuracy({"--mesh", "terrain:12,12,1", "--grid", "16x16", "--box", "on",
                            "--algorithms", "badouel", "--formats", "bf16,fp64", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Json pictures = Json::parse(ran.out).at("pictures");
  ASSERT_EQ(pictures.size(), 2u);
  const auto wrong = [&](std::size_t i) {
    return pictures[i].at("of_scene").at("wrong_pixels").get<int>();
  };
  EXPECT_GT(wrong(0), 0);
  EXPECT_EQ(wrong(1), 0);
  EXPECT_EQ(pictures[1].at("hits"), 256);
  EXPECT_LT(pictures[1].at("of_scene").at("depth_error").at("largest").get<double>(), 1e-13);
}

}  // namespace
}  // namespace cde::testing
