// SPDX-License-Identifier: Apache-2.0
// The pages of cde run --report and cde reproduce.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "../has.hpp"
#include "pages.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

const std::string kReportScene = R"(title = "A </script> & <b>title</b>\u0001"
frames = 5
[card]
lanes = 16
[[object]]
name = "terrain"
mesh = "terrain:12,9,3"
deform = { kind = "wave", vertices = [20, 45], amplitude = [0, 0, 5], period = 1, wavelength = 40 }
[[object]]
name = "rays"
random_rays = { count = 30, seed = 7 }
motion = { kind = "still", position = [60, 45, 300] }
)" + hit_query("terrain");

TEST_F(Pages, Report_EqualsRunJson) {
  write("scene.toml", kReportScene);
  const Ran ran = cde({"run", "scene.toml", "--report", "page.html", "--frames", "1..4"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.err, "report           page.html"));
  const std::string html = read("page.html");
  expect_sound(html, 3);
  EXPECT_LT(html.size(), 8u << 20);
  EXPECT_TRUE(has(html, "<h1>A &lt;/script&gt; &amp; &lt;b&gt;title&lt;/b&gt;"));
  EXPECT_TRUE(has(html, "src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_TRUE(has(html, "id=\"show-rays\"") && has(html, "Orange: rays that hit"));
  EXPECT_FALSE(has(html, "contacts of solids"));
  EXPECT_TRUE(has(html, "The above copyright notice")) << "licence of three.js";
  const auto sections = between(html, "<section id=\"split\">", "</section>");
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_EQ(count(sections[0], "<g class=\"bar\">"), 4u) << "one bar per frame";

  const auto texts = between(html, "id=\"data\">", "</script>");
  ASSERT_EQ(texts.size(), 1u);
  const json data = json::parse(texts[0]), run = json::parse(read("scene.run/run.json"));
  ASSERT_EQ(data["frame_results"].size(), 4u);
  ASSERT_EQ(data["views"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const json& shown = data["frame_results"][i];
    const json& row = run["frame_results"][i];
    const json& query = row["queries"][0];
    EXPECT_EQ(shown["frame"], row["frame"]);
    EXPECT_EQ(shown["records"], query["records"]);
    EXPECT_EQ(shown["hits"], query["hits"]);
    EXPECT_EQ(shown["card_wall_seconds"], query["simulation_seconds"]);
    double sum = 0;
    for (const json& part : shown["modelled_seconds"]) sum += part.get<double>();
    EXPECT_NEAR(sum, query["modelled_seconds"]["total"].get<double>(), 1e-12);
    EXPECT_DOUBLE_EQ(shown["modelled_seconds"][0], query["modelled_seconds"]["upload"]);
    EXPECT_EQ(data["views"][i]["frame"], row["frame"]);
    // Two words per hit, four bytes per word, four characters per three bytes.
    const auto hits = query["hits"].get<std::size_t>();
    EXPECT_EQ(data["views"][i]["queries"][0]["numbers"].get<std::string>().size(),
              (8 * hits + 2) / 3 * 4);
  }
  EXPECT_GT(run["totals"]["hits"], 20);
  EXPECT_NE(data["views"][0]["objects"][0], data["views"][1]["objects"][0]) << "the mesh deforms";
  EXPECT_EQ(data["objects"][0]["count"], 216);
}

/// The page holds the CSV data of a chart, with or without scripts.
TEST_F(Pages, Charts_CarryTheirFigures) {
  write("scene.toml", kReportScene);
  const Ran ran = cde({"run", "scene.toml", "--report", "page.html", "--frames", "1..4"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("page.html");
  const json run = json::parse(read("scene.run/run.json"));
  const auto figures = between(html, "<pre class=\"figures\" hidden>\n", "</pre>");
  ASSERT_EQ(figures.size(), count(html, "<figure class=\"plot\">"));
  ASSERT_EQ(figures.size(), 3u) << "signed distance of the query, modelled time, wall time";
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  };
  const auto distances = lines_of(plain(figures[0])), modelled = lines_of(plain(figures[1]));
  ASSERT_EQ(distances.size(), 5u);
  EXPECT_EQ(distances[0], "seconds,most,least");
  ASSERT_EQ(modelled.size(), 5u);
  EXPECT_EQ(modelled[0].substr(0, 6), "frame,");
  EXPECT_TRUE(has(modelled[0], ",\"memory (DDR waits, SRAM write-back) (s)\","));
  for (std::size_t i = 0; i < 4; ++i) {
    double frame = 0, sum = 0, least = 0, most = 0, at = 0;
    char comma = 0;
    std::istringstream fields(modelled[i + 1]);
    fields >> frame;
    EXPECT_EQ(frame, run["frame_results"][i]["frame"]);
    for (double part = 0; fields >> comma >> part;) sum += part;
    EXPECT_NEAR(sum, run["frame_results"][i]["queries"][0]["modelled_seconds"]["total"], 1e-12);
    std::istringstream(distances[i + 1]) >> at >> comma >> most >> comma >> least;
    EXPECT_EQ(at, run["frame_results"][i]["scene_seconds"]);
    EXPECT_GT(least, 0);
    EXPECT_GE(most, least);
  }
}

TEST_F(Pages, Charts_AreSaved) {
  if (browser().empty()) GTEST_SKIP() << "needs Chromium, to run the scripts of the pages";
  write("scene.toml", kReportScene);
  ASSERT_EQ(cde({"run", "scene.toml", "--report", "page.html", "--frames", "0..3"}).status, 0);
  const std::string html = read("page.html");
  const json told = clicked(html);
  expect_saved(told, 3);
  expect_fits_a_phone(html);
  const auto figures = between(html, "<pre class=\"figures\" hidden>\n", "</pre>");
  std::size_t tables = 0;
  for (const json& file : told["files"]) {
    if (file["name"].get<std::string>().ends_with(".csv"))
      EXPECT_EQ(file["text"], plain(figures.at(tables++)));
    else
      EXPECT_TRUE(has(file["text"].get<std::string>(), "A &lt;/script&gt; &amp; &lt;b&gt;title"));
  }
  EXPECT_EQ(told["files"][0]["label"], "hit, signed distance or T over time");
}

TEST_F(Pages, SceneWithoutRays_HasNoLegendOfRays) {
  write("scene.toml",
        "[[object]]\nname = \"a\"\nrandom = { shape = \"sphere\", count = 8, seed = 3, "
        "min = [-1, -1, -1], max = [1, 1, 1], size = [0.5, 0.6] }\n"
        "[[query]]\nname = \"q\"\npair = \"sphere-sphere\"\nprimaries = \"a\"\n"
        "secondaries = \"a\"\n");
  const Ran ran = cde({"run", "scene.toml", "--report", "page.html", "--frames", "0..0"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("page.html");
  EXPECT_FALSE(has(html, "id=\"show-rays\"") || has(html, "Orange: rays that hit"));
  EXPECT_TRUE(has(html, "contacts of solids"));
  if (!browser().empty()) expect_fits_a_phone(html);
}

/// Bodies, contacts with normals, masks and parents.
TEST_F(Pages, MixedScene_IsReportedCompletely) {
  const std::string scene = std::string(CDE_SOURCE_DIR) + "/meshes/scenes/mixed.toml";
  const Ran ran = cde({"run", scene, "--out", "out", "--report", "page.html", "--frames", "0..2"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("page.html");
  expect_sound(html, 3);
  const json data = json::parse(between(html, "id=\"data\">", "</script>").at(0));
  std::vector<std::string> kinds;
  for (const json& object : data["objects"]) kinds.push_back(object["kind"]);
  EXPECT_EQ(kinds, (std::vector<std::string>{"surface", "rays", "box", "sphere", "rays"}));
  EXPECT_EQ(data["queries"][1]["normals"], true);
  // For each of the three balls that the box does not touch: seven words to the closest points.
  const auto apart = data["views"][0]["queries"][1]["apart"].get<std::string>().size();
  const json run = json::parse(read("out/run.json"));
  const std::size_t hits = run["frame_results"][0]["queries"][1]["hits"];
  ASSERT_LT(hits, 3u);
  EXPECT_EQ(apart, ((3 - hits) * 7 * 4 + 2) / 3 * 4);
  EXPECT_EQ(data["views"][0]["queries"][0]["apart"], "") << "rays have no closest points";
  const auto distances = between(html, "<section id=\"distances\">", "</section>");
  ASSERT_EQ(distances.size(), 1u);
  for (std::size_t q = 0; q < 3; ++q) {
    std::uint64_t any = data["queries"][q]["rays"] == false ? 1 : 0;
    for (const json& frame : run["frame_results"])
      any += frame["queries"][q]["hits"].get<std::uint64_t>();
    const std::string query = data["queries"][q]["name"];
    EXPECT_EQ(count(distances[0],
                    fmt::format("aria-label=\"{}, signed distance or T over time\"", query)),
              any > 0 ? 1u : 0u)
        << query;
  }
  EXPECT_EQ(count(distances[0], "NaN") + count(distances[0], "nan"), 0u);
  for (const char* part : {"ground, 38,400 × triangle", "balls, 3 × sphere", "id=\"scale\"",
                           "id=\"axes\"", "<select id=\"up\">"})
    EXPECT_EQ(count(html, part), 1u) << part;
  EXPECT_FALSE(has(html, "/meshes/")) << "the page must contain no path of this machine";
}

TEST_F(Pages, UnwritableReport_IsRefusedBeforeTheRun) {
  write("scene.toml", kReportScene);
  const Ran ran = cde({"run", "scene.toml", "--frames", "0", "--report", "none/page.html"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "none/page.html: cannot create"));
  EXPECT_FALSE(exists("scene.run")) << "no frame may run";
}

/// The chapter on BVHs: a smaller terrain, and the terrain of Figure 5.
void expect_bvh(const json& j, const std::string& html) {
  ASSERT_EQ(j["bvh"].size(), 2u);
  for (const json& mesh : j["bvh"]) {
    SCOPED_TRACE(mesh["triangles"].dump());
    const json& brute_force = mesh["brute_force"];
    EXPECT_LT(brute_force["packet_seconds"], brute_force["packet_seconds_with_bus"]);
    EXPECT_GE(brute_force["packet_seconds"],
              mesh["triangles"].get<double>() * 16 / j["clock_hz"].get<double>());
    ASSERT_EQ(mesh["card"].size(), 2u);
    for (const json& card : mesh["card"]) {
      EXPECT_LT(card["packet_seconds"], card["packet_seconds_with_bus"]);
      EXPECT_LT(card["packet_seconds_with_bus"], brute_force["packet_seconds"]);
      EXPECT_LT(card["rays_per_second_with_bus"], card["rays_per_second_device"]);
      EXPECT_LT(card["refit_seconds"], card["refit_seconds_with_bus"]);
      EXPECT_GT(card["nodes_per_ray"], 1);
    }
    const json& embree = mesh["embree"];
    ASSERT_EQ(embree.is_null(), j["embree"] == false);
    if (embree.is_null()) continue;
    EXPECT_EQ(embree["packet_seconds_fresh"], embree["spread_fresh"]["median"]);
    EXPECT_EQ(embree["packet_seconds_warm"], embree["spread_warm"]["median"]);
    EXPECT_EQ(embree["refit_seconds"], embree["spread_refit"]["median"]);
    EXPECT_GT(embree["build_seconds"], 0);
  }
  const json& last = j["bvh"][1];
  EXPECT_EQ(last["triangles"], j["triangles"]);
  for (const json& entry : j["figure_5"][1]["entries"]) {
    if (entry["name"] == last["brute_force"]["name"]) {
      EXPECT_EQ(entry["seconds"], last["brute_force"]["packet_seconds_with_bus"]);
    }
  }
  const auto chapters = between(html, "<h2>With a BVH</h2>", "</section>");
  ASSERT_EQ(chapters.size(), 1u);
  EXPECT_EQ(count(chapters[0], "<div class=\"chart lines\">"), 1u) << chapters[0].substr(0, 4000);
  EXPECT_EQ(count(chapters[0], "<table>"), 5u);
  EXPECT_EQ(count(chapters[0], "Embree, fresh rays (measured)") > 0, j["embree"] == true);
  EXPECT_EQ(count(chapters[0], "Embree is not in this build of cde") > 0, j["embree"] == false);
}

TEST_F(Pages, QuickReproduction_WritesEveryEntry) {
  const Ran ran = cde({"reproduce", "--quick", "--json", "--out", "r.html"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("r.html");
  expect_sound(html, 1);
  EXPECT_TRUE(has(html, "A quick run"));
  const json j = json::parse(ran.out);
  EXPECT_EQ(j["quick"], true);
  for (const char* key : {"version", "commit"}) EXPECT_TRUE(j[key].is_string()) << key;
  EXPECT_GT(j["records_compared"], 10'000);
  const int compared = j["records_compared"];
  EXPECT_EQ(
      count(html, fmt::format("{},{:03} records of the card", compared / 1000, compared % 1000)),
      1u);
  const auto find = [](const json& experiment, const std::string& part) -> json {
    for (const json& entry : experiment["entries"])
      if (entry["name"].get<std::string>().find(part) != std::string::npos) return entry;
    ADD_FAILURE() << "no entry " << part;
    return {{"seconds", 0}};
  };
  const json& one = j["figure_5"][0];
  EXPECT_EQ(one["tests"], 4000);
  if (!browser().empty()) {
    expect_saved(clicked(html), 5);
    expect_fits_a_phone(html);
  }
  expect_bvh(j, html);
  // The times in the paper are for the full terrain, not for the terrain of a quick run.
  EXPECT_EQ(j["paper"]["card_seconds"], 0.031);
  EXPECT_EQ(j["paper"]["software_seconds"], 2.1);
  for (const auto* figure : {"figure_5", "figure_6", "figure_7"}) {
    for (const json& experiment : j[figure]) {
      for (const json& entry : experiment["entries"]) {
        EXPECT_NE(entry["source"], "paper") << entry;
        ASSERT_EQ(entry.contains("spread"), entry["source"] != "card") << entry;
        if (!entry.contains("spread")) continue;
        const json& spread = entry["spread"];
        EXPECT_GE(spread["measurements"], 9);
        EXPECT_EQ(spread["median"], entry["seconds"]);
        EXPECT_LE(spread["least"], spread["tenth"]);
        EXPECT_LE(spread["tenth"], spread["median"]);
        EXPECT_LE(spread["median"], spread["ninetieth"]);
        EXPECT_LE(spread["ninetieth"], spread["most"]);
      }
    }
  }
  if (j["embree"] == true) {
    for (const json& experiment : j["figure_5"]) {
      EXPECT_FALSE(find(experiment, "Embree, fresh rays").contains("same_rays_again"));
      EXPECT_EQ(find(experiment, "Embree, the same 256 rays again")["same_rays_again"], true);
    }
  }
  const json all = find(one, "as in the paper"), reduced = find(one, "1 lane, reduction");
  // 4,000 records of 28 bytes at no more than 533 MB/s, and one record.
  EXPECT_GT(all["seconds"].get<double>(), 4000 * 28 / 533e6);
  EXPECT_GE(reduced["seconds"], 4000 / 100e6) << "at most one triangle per cycle";
  double sum = 0;
  for (const char* part : {"upload", "compute", "write_back", "download", "registers"})
    sum += all["modelled_seconds"][part].get<double>();
  EXPECT_NEAR(sum, all["seconds"].get<double>(), 1e-12);
  EXPECT_NEAR(sum, all["modelled_seconds"]["total"].get<double>(), 1e-12);
  // 16 lanes take 256 rays in a sixteenth of the cycles.
  const json &narrow = find(j["figure_5"][1], "1 lane"), &wide = find(j["figure_5"][1], "best");
  EXPECT_GT(narrow["seconds"], 10 * wide["seconds"].get<double>());
  EXPECT_EQ(j["figure_7"].size(), 2u);
  for (const auto* figure : {"figure_5", "figure_6", "figure_7"})
    for (const json& experiment : j[figure]) EXPECT_GT(find(experiment, "scalar")["seconds"], 0);
}

}  // namespace
}  // namespace cde::testing
