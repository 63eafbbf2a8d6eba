// SPDX-License-Identifier: Apache-2.0
// The cost table of cde accuracy --target, and the costs on its page.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "../has.hpp"
#include "cost_rows.hpp"
#include "pages.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class AccuracyPage : public Pages {
 protected:
  void SetUp() override {
    Pages::SetUp();
    write("costs.json", some_costs().dump());
  }
  Ran with_costs(Words words) {
    words.insert(words.begin(), "accuracy");
    words.emplace_back("-q");
    return cde(words, {"CDE_COSTS=costs.json"});
  }
};

const Words kSome = {"--pair",       "ray-triangle,sphere-sphere",
                     "--algorithms", "moller,watertight",
                     "--formats",    "fp16,bf16,fp32",
                     "--cases",      "120"};

/// Measured and estimated costs come from the rows, and no sum mixes both.
TEST_F(AccuracyPage, Costs_ComeFromTheTable) {
  Words words = kSome;
  words.emplace_back("--json");
  const Ran ran = with_costs(words);
  ASSERT_EQ(ran.status, 0) << ran.err;
  std::set<std::string> kinds;
  const json all = json::parse(ran.out);
  for (const json& one : all.at("configurations")) {
    const json& cost = one.at("cost");
    const std::string format = one.at("format");
    const bool whole =
        one.at("algorithm") == "moller" && one.at("box") == false && format != "bf16";
    SCOPED_TRACE(one.at("pair").get<std::string>() + " " + format + cost.dump());
    if (format == "fp32" && !whole) {
      EXPECT_TRUE(cost.at("luts").is_null());
      EXPECT_TRUE(cost.at("modelled_seconds_per_million").is_null());
      EXPECT_TRUE(has(cost.at("clock_source").get<std::string>(), "no row of"));
      kinds.insert("none");
      continue;
    }
    EXPECT_EQ(cost.at("area_of"), "ecp5-85");
    ASSERT_EQ(cost.at("estimated"), !whole);
    if (whole) {
      const bool small = format == "fp16";
      EXPECT_EQ(cost.at("luts"), small ? 20000 : 90000);
      EXPECT_EQ(cost.at("fmax_mhz"), small ? 110 : 100) << "the median of three seeds";
      // 85 % of 83,640 logic cells; a carry takes two.
      EXPECT_EQ(cost.at("lanes_that_fit"), small ? 3 : 0);
      EXPECT_EQ(cost.at("lanes_limit"), "logic");
      kinds.insert(small ? "measured" : "too large");
      EXPECT_EQ(cost.at("modelled_seconds_per_million").is_null(), !small);
      continue;
    }
    const json& n = cost.at("operators_by_kind");
    const double luts = 300 * n.at("add").get<double>() + 200 * n.at("mul").get<double>() +
                        900 * n.at("div").get<double>() + 700 * n.at("sqrt").get<double>() +
                        60 * n.at("compare").get<double>();
    EXPECT_EQ(cost.at("luts"), luts) << "luts of the fastest rows";
    EXPECT_EQ(cost.at("dsps"), n.at("mul"));
    const double fit =
        std::floor(0.85 * 83640 /
                   (luts + 20 * n.at("add").get<double>() + 20 * n.at("mul").get<double>() +
                    20 * n.at("div").get<double>() + 20 * n.at("sqrt").get<double>() +
                    20 * n.at("compare").get<double>()));
    const double by_products = std::floor(156 / n.at("mul").get<double>());
    EXPECT_EQ(cost.at("lanes_that_fit"), std::min(fit, by_products));
    EXPECT_EQ(cost.at("fmax_mhz"), n.at("div") > 0 ? 120 : n.at("sqrt") > 0 ? 125 : 130);
    const double lanes = cost.at("lanes_that_fit"), mhz = cost.at("fmax_mhz");
    EXPECT_NEAR(cost.at("modelled_seconds_per_million").get<double>(), 1 / (lanes * mhz),
                0.01 / (lanes * mhz));
    kinds.insert("estimated");
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"none", "measured", "too large", "estimated"}));
}

TEST_F(AccuracyPage, InvalidCostTables_AreRefused) {
  const auto refused = [&](const std::string& text, const std::string& says) {
    write("costs.json", text);
    const Ran ran = with_costs({"--pair", "sphere-sphere", "--formats", "fp16", "--cases", "20"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, "costs.json: " + says));
  };
  refused("no JSON", "not a cost table");
  refused("[]", "not a cost table");
  refused(R"({"rows": [{"what": "add"}]})", "row 1: ");
  json bad = some_costs();
  bad["rows"][3]["lut"] = "many";
  refused(bad.dump(), "row 4: lut is \"many\"; it must be a whole number, 0 to 1e9");
  bad = some_costs();
  bad["rows"][2]["ff"] = -5;
  refused(bad.dump(), "row 3: ff is -5; it must be a whole number, 0 to 1e9");
  for (const char* lat : {"abc", "", "-5", "0", "8/x", "8/", "99999999999"}) {
    bad = some_costs();
    bad["rows"][2]["lat"] = lat;
    refused(bad.dump(), "row 3: lat is ");
  }
  bad = some_costs();
  bad["rows"][0]["lanes"] = 0;
  refused(bad.dump(), "row 1: lanes is 0; it must be 1 or more");
  for (const char* rates :
       {R"({"1": 0})", R"({"1": -5})", R"({"1": "fast"})", R"({"1": 1e308})", "[]"}) {
    bad = some_costs();
    bad["rows"][1]["fmax"] = json::parse(rates);
    refused(bad.dump(), "row 2: fmax is ");
  }
  bad["rows"][1].erase("fmax");
  refused(bad.dump(), "row 2: fmax is not there");
}

TEST_F(AccuracyPage, FreshAndKeptResults_GiveTheSamePage) {
  Words words = kSome;
  words.insert(words.end(), {"--profiles", "30", "--page", "p.html", "--json"});
  const Ran fresh = with_costs(words);
  ASSERT_EQ(fresh.status, 0) << fresh.err;
  write("kept.json", fresh.out);
  ASSERT_EQ(with_costs({"--from", "kept.json", "--page", "q.html"}).status, 0);
  const std::string html = read("p.html");
  EXPECT_EQ(html, read("q.html"));
  expect_sound(html, 3);
  EXPECT_LT(html.size(), 3u << 20);
  // Per pair: two charts of accuracy against time, for decisions and for families. Per format: four
  // profiles. Decisions that were never wrong have a folded chart of their own.
  const std::size_t folded = count(html, "without an observed wrong decision</summary>");
  EXPECT_GT(folded, 0u);
  const std::size_t decided = count(html, ": wrong decisions per million\"") + folded;
  EXPECT_EQ(count(html, "<figure class=\"plot\">"), 2u * 3 + decided + 3u * 4);
  EXPECT_EQ(count(html, "<section data-choice=\"pair\""), 2u);
  for (const char* text : {"measured", "estimated", "no cost", "modelled time of a million tests",
                           "echo '", "| cde query ray-triangle --algorithm"})
    EXPECT_TRUE(has(html, text));
  EXPECT_EQ(count(html, "nan%") + count(html, "inf%") + count(html, "\"nan\""), 0u);
  const json data = json::parse(between(html, "id=\"data\">", "</script>").at(0));
  EXPECT_EQ(data.at("entries").size(), json::parse(fresh.out).at("configurations").size());
}

TEST_F(AccuracyPage, Charts_AreSavedWithTheirFigures) {
  if (browser().empty()) GTEST_SKIP() << "needs Chromium, to run the scripts of the page";
  Words words = kSome;
  words.insert(words.end(), {"--profiles", "30", "--page", "p.html"});
  ASSERT_EQ(with_costs(words).status, 0);
  const std::string html = read("p.html");
  const json told = clicked(html);
  expect_saved(told, count(html, "<figure class=\"plot\">"));
  expect_fits_a_phone(html);
  ASSERT_GT(told["chosen"].size(), 20u);
  for (const json& text : told["chosen"]) {
    EXPECT_TRUE(has(text.get<std::string>(), "cde accuracy --pair")) << text;
    EXPECT_TRUE(has(text.get<std::string>(), "wrong decisions")) << text;
  }
  ASSERT_EQ(told["choices"].size(), 2u);
  EXPECT_EQ(told["choices"][0]["options"], json({"ray-triangle", "sphere-sphere"}));
  EXPECT_EQ(told["choices"][0]["before"], json({"ray-triangle", "fp32"})) << "one choice per table";
  EXPECT_EQ(told["choices"][0]["after"], json({"sphere-sphere", "fp32"}));
}

/// The line of best trade-offs follows the chosen formats, and a chart can be zoomed.
TEST_F(AccuracyPage, FilterAndZoom_ChangeChartsTablesAndBestLine) {
  if (browser().empty()) GTEST_SKIP() << "needs Chromium, to run the scripts of the page";
  Words words = kSome;
  words.insert(words.end(), {"--page", "p.html"});
  ASSERT_EQ(with_costs(words).status, 0);
  const char* const ask = R"page(
addEventListener("load", () => {
  const group = document.querySelector(".scatter"), section = group.closest("[data-choice]");
  const entries = JSON.parse(document.getElementById("data").textContent).entries;
  const texts = (query) => [...section.querySelectorAll(query)].map((element) => element.textContent);
  const pair = (element, x, y) => [x, y].map((name) => parseFloat(element.getAttribute(name)).toFixed(1)).join();
  const seen = () => ({
    formats: [...new Set([...section.querySelectorAll(".mark")].map((mark) => entries[mark.dataset.of].format))].sort(),
    at: [...group.querySelectorAll(".mark > circle:last-of-type")].map((dot) => pair(dot, "cx", "cy")),
    best: [...group.querySelectorAll(".pareto")].map((line) => pair(line, "x1", "y1")).sort(),
    ticks: [...group.querySelectorAll(".tick")].map((tick) => tick.textContent).join(" "),
    rows: texts("tbody tr:not([hidden]) th"), keys: texts(".legend li:not([hidden])") });
  const boxes = [...document.querySelectorAll(".formats input")];
  const told = { boxes: boxes.map((box) => box.value), before: seen() };
  const flip = (value) => {
    const box = boxes.find((one) => one.value === value);
    box.checked = !box.checked;
    box.dispatchEvent(new Event("change"));
  };
  flip("bf16");
  told.without = seen();
  flip("bf16");
  told.back = seen();
  const buttons = [...group.closest("figure").querySelectorAll(".zoom button")];
  for (let i = 0; i < 2; ++i) buttons[0].click();
  told.closer = seen();
  buttons[2].click();
  told.whole = seen();
  document.body.replaceChildren(document.createElement("pre"));
  document.body.firstChild.id = "told";
  document.body.firstChild.textContent = JSON.stringify(told);
});
)page";
  const json told = in_browser(read("p.html"), ask, "",
                               [](const std::string& text) { return json::parse(plain(text)); });
  EXPECT_EQ(told["boxes"], json({"fp16", "bf16", "fp32"}));
  const json &before = told["before"], &without = told["without"], &closer = told["closer"];
  EXPECT_TRUE(has(before["formats"].dump(), "bf16"));
  EXPECT_LT(without["at"].size(), before["at"].size());
  EXPECT_NE(without["best"], before["best"]) << "the line had a dot of bf16";
  const std::string dots = without["at"].dump();
  for (const json& corner : without["best"]) {  // at a dot, or above one
    const auto at = corner.get<std::string>();
    EXPECT_TRUE(has(dots, "\"" + at.substr(0, at.find(',') + 1))) << at << dots;
  }
  for (const char* part : {"formats", "rows", "keys"})
    EXPECT_FALSE(has(without[part].dump(), "bf16")) << part << without[part];
  EXPECT_EQ(told["back"], before);
  EXPECT_LT(closer["at"].size(), before["at"].size());
  EXPECT_NE(closer["ticks"], before["ticks"]);
  EXPECT_EQ(told["whole"], before);
}

TEST_F(AccuracyPage, WrongPixelsOfAMesh_AreShown) {
  const Ran ran =
      with_costs({"--mesh", "terrain:12,12,1", "--grid", "16x16", "--box", "on", "--algorithms",
                  "badouel,moller", "--formats", "bf16,fp64", "--page", "m.html", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string html = read("m.html");
  expect_sound(html, 3);
  EXPECT_EQ(count(html, "<img src=\"data:image/png;base64,iVBORw0KGgo"), 4u);
  const json all = json::parse(ran.out);
  int wrong = 0;
  for (const json& picture : all.at("pictures")) {
    const json& pixels = picture.at("of_scene").at("wrong_pixels");
    wrong += pixels.get<int>();
    EXPECT_GE(count(html, ": " + pixels.dump() + " of 256 pixels wrong"), 2u)
        << "in the text and as alt text";
  }
  EXPECT_GT(wrong, 0);
  // The 3-D view holds each wrong pixel once, and the mesh.
  const json space = json::parse(plain(between(html, "id=\"data\">", "</script>").at(0)));
  const auto size_of = [](const json& base64) {
    const std::string text = base64.get<std::string>();
    return 3 * text.size() / 4 - static_cast<std::size_t>(std::ranges::count(text, '='));
  };
  EXPECT_EQ(size_of(space.at("points")), 13u * 13 * 12);
  EXPECT_EQ(size_of(space.at("corners")), 12u * 12 * 2 * 12);
  std::size_t points = 0;
  for (const json& view : space.at("views")) {
    points += size_of(view.at("kinds"));
    EXPECT_EQ(size_of(view.at("at")), 12 * size_of(view.at("kinds")));
  }
  EXPECT_EQ(points, static_cast<std::size_t>(wrong));
  if (const std::string program = browser(); !program.empty()) {
    const Ran printed = shell(
        fmt::format("HOME=$PWD timeout 120 {} --headless --no-sandbox --disable-gpu --no-first-run "
                    "--user-data-dir=$PWD/browser --print-to-pdf=$PWD/m.pdf file://$PWD/m.html",
                    program));
    ASSERT_TRUE(exists("m.pdf")) << printed.err;
    EXPECT_TRUE(read("m.pdf").starts_with("%PDF-"));
    const json told = clicked(html);
    EXPECT_EQ(told["failed"], json::array());
    EXPECT_EQ(told["choices"][0]["before"], json({"bf16"}));
    EXPECT_EQ(told["choices"][0]["after"], json({"fp64"}));
  }
}

TEST_F(AccuracyPage, ImpossiblePage_IsRefused) {
  const auto refused = [&](const Words& words, const std::string& text) {
    const Ran ran = with_costs(words);
    EXPECT_EQ(ran.status, 2) << text;
    EXPECT_TRUE(has(ran.err, text));
    EXPECT_FALSE(exists("p.html"));
  };
  refused({"--page", "p.txt"}, "--page is 'p.txt'; its name must end in .html");
  refused({"--from", "none.json", "--page", "p.html"}, "none.json");
  write("other.json", R"({"schema": "cde.accuracy.1"})");
  refused({"--from", "other.json", "--page", "p.html"},
          "not an accuracy file of schema cde.accuracy.3");
  write("broken.json", R"({"schema": "cde.accuracy.3", "seed": 1, "cases": 2,
                           "configurations": [{"pair": "obb-obb", "format": "fp32"}]})");
  refused({"--from", "broken.json", "--page", "p.html"}, "broken.json: configuration 1: ");
  for (const char* profile : {R"({"a": 1})", R"({"format": null})", "5",
                              R"({"format": "fp32", "along": "x", "algorithm": "moller",
                                  "profile_points": [{"axis_value": "1"}]})"}) {
    write("broken.json", fmt::format(R"({{"schema": "cde.accuracy.3", "seed": 1, "cases": 2,
                                         "configurations": [], "profiles": [{}]}})",
                                     profile));
    refused({"--from", "broken.json", "--page", "p.html"}, "cde: broken.json: ");
  }
  write("none.txt", "{");
  refused({"--from", "none.txt", "--page", "p.html"}, "none.txt: not the JSON of one accuracy run");
  refused({"--target", "ecp5-85f"}, "--target is 'ecp5-85f'; it must be ecp5-85, hx8k or assumed");
  refused({"--target", "assumed:0MHz"}, "--target is 'assumed:0MHz'");
}

/// The worst case of a pipe is the worst of its families, and its command repeats it.
TEST_F(AccuracyPage, WorstCase_RepeatsWithItsCommand) {
  Words words = {"--pair", "ray-triangle", "--formats", "fp32", "--algorithms",   "badouel",
                 "--box",  "off",          "--cases",   "600",  "--no-operators", "--json"};
  const Ran ran = with_costs(words);
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json one = json::parse(ran.out).at("configurations").at(0), &all = one.at("all_families");
  for (const char* key : {"worst_t", "worst_decision", "worst_leak"}) {
    double most = -1;
    json of;
    for (const json& family : one.at("families")) {
      const json& worst = family.at(key);
      if (worst.is_null()) continue;
      EXPECT_EQ(worst.at("family"), family.at("family"));
      EXPECT_LT(worst.at("case_index"), family.at("cases"));
      if (worst.at("error_u") <= most) continue;
      most = worst.at("error_u"), of = worst;
    }
    EXPECT_EQ(all.at(key), of) << key;
  }
  const json& worst = all.at("worst_t");
  EXPECT_EQ(worst.at("error_u"), all.at("t_error_u").at("largest"));
  EXPECT_EQ(worst.at("a_words").size(), 8u);
  EXPECT_EQ(worst.at("b_words").size(), 9u);
  ASSERT_FALSE(all.at("worst_decision").is_null());
  // The command has the words of the list.
  const std::string command = worst.at("repeat_command");
  for (const json& word : worst.at("a_words")) EXPECT_TRUE(has(command, word.get<std::string>()));
  EXPECT_TRUE(
      has(command, "' | cde query ray-triangle --algorithm badouel --no-box --format fp32"));
}

}  // namespace
}  // namespace cde::testing
