// The pages: cde run --report and cde reproduce.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

std::string base64(const std::vector<unsigned>& bytes) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  unsigned word = 0, bits = 0;
  for (const unsigned b : bytes) {
    word = word << 8 | b;
    for (bits += 8; bits >= 6; bits -= 6) text += digits[word >> (bits - 6) & 63];
    word &= (1u << bits) - 1;
  }
  if (bits > 0) text += digits[word << (6 - bits) & 63];
  return text + std::string((4 - text.size() % 4) % 4, '=');
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// What stands between `begin` and `end`, every time.
std::vector<std::string> between(const std::string& text, const std::string& begin,
                                 const std::string& end) {
  std::vector<std::string> found;
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    found.push_back(text.substr(at, text.find(end, at) - at));
  }
  return found;
}

class Pages : public Cli {
 protected:
  /// As a content security policy has it, from coreutils' own implementation.
  std::string policy_hash(const std::string& text) {
    write("hashed", text);
    const std::string command = fmt::format("sha256sum {}", (folder_ / "hashed").string());
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
    std::vector<unsigned> bytes(32);
    for (unsigned& b : bytes) EXPECT_EQ(std::fscanf(pipe.get(), "%2x", &b), 1);
    return fmt::format("'sha256-{}'", base64(bytes));
  }

  /// Nothing is loaded, nothing runs but what the policy names, and elements are closed.
  void expect_sound(const std::string& html, std::size_t scripts) {
    const auto policies =
        between(html, "<meta http-equiv=\"Content-Security-Policy\" content=\"", "\">");
    ASSERT_EQ(policies.size(), 1u);
    const std::string& policy = policies[0];
    EXPECT_EQ(policy.find("default-src 'none'; "), 0u) << policy;
    EXPECT_EQ(policy.find("unsafe"), std::string::npos) << policy;
    EXPECT_EQ(policy.find("http"), std::string::npos) << policy;
    const auto styles = between(html, "<style>", "</style>");
    ASSERT_EQ(styles.size(), 1u);
    EXPECT_NE(policy.find("style-src " + policy_hash(styles[0])), std::string::npos);
    const auto code = between(html, "<script>", "</script>");
    ASSERT_EQ(code.size(), scripts);
    for (const std::string& script : code)
      EXPECT_NE(policy.find(policy_hash(script)), std::string::npos) << script.substr(0, 60);
    std::string markup = html;
    for (const std::string& script : code) markup.replace(markup.find(script), script.size(), "");
    for (const char* loads : {" src=\"http", " href=", "url(", "@import", " style=", " onclick="})
      EXPECT_EQ(markup.find(loads), std::string::npos) << loads;
    for (const char* element :
         {"section", "table", "svg", "div", "figure", "main", "body", "html"}) {
      const std::regex opens(fmt::format("<{}[ >]", element));
      const auto opened = std::distance(std::sregex_iterator(markup.begin(), markup.end(), opens),
                                        std::sregex_iterator());
      EXPECT_EQ(static_cast<std::size_t>(opened), count(markup, fmt::format("</{}>", element)))
          << element;
    }
    EXPECT_NE(html.find("<meta name=\"viewport\""), std::string::npos);
  }
};

const char* const kScene = R"(title = "A </script> & <b>title</b>"
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
[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = "terrain"
)";

TEST_F(Pages, ReportSaysWhatRunJsonSays) {
  write("scene.toml", kScene);
  const Ran ran = cde({"run", "scene.toml", "--report", "page.html", "--frames", "1..4"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_NE(ran.err.find("report           page.html"), std::string::npos) << ran.err;
  const std::string html = read("page.html");
  expect_sound(html, 2);
  EXPECT_LT(html.size(), 8u << 20);
  EXPECT_NE(html.find("<h1>A &lt;/script&gt; &amp; &lt;b&gt;title&lt;/b&gt;</h1>"),
            std::string::npos);
  EXPECT_NE(html.find("src=\"data:image/png;base64,iVBORw0KGgo"), std::string::npos);
  EXPECT_NE(html.find("The above copyright notice"), std::string::npos) << "three.js's licence";
  const auto sections = between(html, "<section id=\"split\">", "</section>");
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_EQ(count(sections[0], "<g class=\"bar\">"), 4u) << "one bar a frame";

  const auto texts = between(html, "id=\"data\">", "</script>");
  ASSERT_EQ(texts.size(), 1u);
  const json data = json::parse(texts[0]), run = json::parse(read("scene.run/run.json"));
  ASSERT_EQ(data["played"].size(), 4u);
  ASSERT_EQ(data["views"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const json& shown = data["played"][i];
    const json& played = run["played"][i];
    const json& query = played["queries"][0];
    EXPECT_EQ(shown["frame"], played["frame"]);
    EXPECT_EQ(shown["records"], query["records"]);
    EXPECT_EQ(shown["hits"], query["hits"]);
    EXPECT_EQ(shown["card_wall_seconds"], query["simulation_seconds"]);
    double sum = 0;
    for (const json& part : shown["modelled_seconds"]) sum += part.get<double>();
    EXPECT_NEAR(sum, query["modelled_seconds"]["total"].get<double>(), 1e-12);
    EXPECT_DOUBLE_EQ(shown["modelled_seconds"][0], query["modelled_seconds"]["upload"]);
    EXPECT_EQ(data["views"][i]["frame"], played["frame"]);
    // Two words a hit, four bytes a word, three bytes in four characters.
    const auto hits = query["hits"].get<std::size_t>();
    EXPECT_EQ(data["views"][i]["queries"][0]["numbers"].get<std::string>().size(),
              (8 * hits + 2) / 3 * 4);
  }
  EXPECT_GT(run["totals"]["hits"], 20);
  EXPECT_NE(data["views"][0]["objects"][0], data["views"][1]["objects"][0]) << "it deforms";
  EXPECT_EQ(data["objects"][0]["count"], 216);
}

/// Bodies, contacts with normals, masks and parents.
TEST_F(Pages, ReportOfTheMixedScene) {
  const std::string scene = std::string(CDE_SOURCE_DIR) + "/meshes/scenes/mixed.toml";
  const Ran ran = cde({"run", scene, "--out", "out", "--report", "page.html", "--frames", "0..2"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("page.html");
  expect_sound(html, 2);
  const json data = json::parse(between(html, "id=\"data\">", "</script>").at(0));
  std::vector<std::string> kinds;
  for (const json& object : data["objects"]) kinds.push_back(object["kind"]);
  EXPECT_EQ(kinds, (std::vector<std::string>{"surface", "rays", "box", "sphere", "rays"}));
  EXPECT_EQ(data["queries"][1]["normals"], true);
  // Of the three balls those that the box does not touch: seven words each to their closest points.
  const auto apart = data["views"][0]["queries"][1]["apart"].get<std::string>().size();
  const json run = json::parse(read("out/run.json"));
  const std::size_t hits = run["played"][0]["queries"][1]["hits"];
  ASSERT_LT(hits, 3u);
  EXPECT_EQ(apart, ((3 - hits) * 7 * 4 + 2) / 3 * 4);
  EXPECT_EQ(data["views"][0]["queries"][0]["apart"], "") << "rays have no closest points";
  const auto gaps = between(html, "<section id=\"gaps\">", "</section>");
  ASSERT_EQ(gaps.size(), 1u);
  for (std::size_t q = 0; q < 3; ++q) {
    std::uint64_t any = data["queries"][q]["rays"] == false ? 1 : 0;
    for (const json& frame : run["played"]) any += frame["queries"][q]["hits"].get<std::uint64_t>();
    const std::string query = data["queries"][q]["name"];
    EXPECT_EQ(count(gaps[0], fmt::format("aria-label=\"{}, gap against time\"", query)),
              any > 0 ? 1u : 0u)
        << query;
  }
  EXPECT_EQ(count(gaps[0], "NaN") + count(gaps[0], "nan"), 0u);
  for (const char* part : {"ground, 9,600 × triangle", "balls, 3 × sphere", "id=\"scale\"",
                           "id=\"axes\"", "<select id=\"up\">"})
    EXPECT_EQ(count(html, part), 1u) << part;
  EXPECT_EQ(html.find("/meshes/"), std::string::npos) << "no path of this machine";
}

TEST_F(Pages, ReportThatCannotBeWritten) {
  write("scene.toml", kScene);
  const Ran ran = cde({"run", "scene.toml", "--frames", "0", "--report", "none/page.html"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_NE(ran.err.find("none/page.html: cannot create"), std::string::npos) << ran.err;
  EXPECT_FALSE(exists("scene.run")) << "nothing was played";
}

TEST_F(Pages, QuickReproduction) {
  const Ran ran = cde({"reproduce", "--quick", "--json", "--out", "r.html"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("r.html");
  expect_sound(html, 0);
  EXPECT_NE(html.find("A quick run"), std::string::npos);
  const json j = json::parse(ran.out);
  EXPECT_EQ(j["quick"], true);
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
  // The paper's times are of another terrain than a quick run has.
  EXPECT_EQ(j["paper"]["card_seconds"], 0.031);
  EXPECT_EQ(j["paper"]["software_seconds"], 2.1);
  for (const auto* figure : {"figure_5", "figure_6", "figure_7"}) {
    for (const json& experiment : j[figure]) {
      for (const json& entry : experiment["entries"]) {
        EXPECT_NE(entry["source"], "paper") << entry;
        ASSERT_EQ(entry.contains("spread"), entry["source"] == "software") << entry;
        if (!entry.contains("spread")) continue;
        const json& spread = entry["spread"];
        EXPECT_GE(spread["samples"], 9);
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
  // 4,000 records of 28 bytes with at most 533 MB/s, and one record.
  EXPECT_GT(all["seconds"].get<double>(), 4000 * 28 / 533e6);
  EXPECT_GE(reduced["seconds"], 4000 / 100e6) << "a triangle a clock at most";
  double sum = 0;
  for (const json& part : all["modelled_seconds"]) sum += part.get<double>();
  EXPECT_NEAR(sum, all["seconds"].get<double>(), 1e-12);
  // 16 lanes take 256 rays in a sixteenth of the clocks.
  const json &narrow = find(j["figure_5"][1], "1 lane"), &wide = find(j["figure_5"][1], "best");
  EXPECT_GT(narrow["seconds"], 10 * wide["seconds"].get<double>());
  EXPECT_EQ(j["figure_7"].size(), 2u);
  for (const auto* figure : {"figure_5", "figure_6", "figure_7"})
    for (const json& experiment : j[figure]) EXPECT_GT(find(experiment, "scalar")["seconds"], 0);
}

}  // namespace
}  // namespace cde::testing
