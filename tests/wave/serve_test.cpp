// SPDX-License-Identifier: Apache-2.0
// cde wave serve: the page and its behaviour in a browser.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "../has.hpp"
#include "pages.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

/// Helpers of all scripts in these tests: keys, clicks, shown text and drawn pixels.
const char* const kHelpers = R"js(
const failed = [], $ = (id) => document.getElementById(id);
addEventListener("error", (e) => failed.push(String(e.message)));
addEventListener("unhandledrejection", (e) => failed.push(String(e.reason)));
addEventListener("securitypolicyviolation", (e) => failed.push(e.violatedDirective));
// Without a window there are no frames.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 0);
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const settled = async () => { for (let k = 0; k < 3; ++k) { await new Promise((done) => requestAnimationFrame(done)); await wait(1); } };
const key = async (name, target = $("waves")) => { target.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true, cancelable: true })); await settled(); };
const type = async (id, text) => { $(id).value = text; $(id).dispatchEvent(new Event("input", { bubbles: true })); await key("Enter", $(id)); };
const shown = () => [...$("list").children].filter((row) => !row.hidden);
const names = () => shown().map((row) => row.children[0].textContent);
const values = () => Object.fromEntries(shown().filter((row) => row.className.startsWith("signal")).map((row) => [row.children[0].textContent, row.children[1].title]));
// Drawn by the processor alone (--disable-accelerated-2d-canvas), so that two pictures of the same are the same: Chromium may leave an accelerated canvas when it is read.
const pixels = () => [...$("waves").getContext("2d").getImageData(0, 0, $("waves").width, $("waves").height).data];
const drawn = () => { let hash = 7; for (const p of pixels()) hash = (hash * 31 + p) >>> 0; return hash; };
const ink = () => { const p = pixels(), at = p.length - 4; let n = 0; for (let i = 0; i < p.length; i += 4) if (p[i] !== p[at] || p[i + 1] !== p[at + 1] || p[i + 2] !== p[at + 2]) ++n; return n; };
const told = {};
addEventListener("load", async () => {
  for (let k = 0; k < 4000 && !document.documentElement.dataset.ready; ++k) await wait(5);
  told.ready = document.documentElement.dataset.ready || "";
  await settled();
  try { await asked(); } catch (error) { failed.push(String(error.stack)); }
  told.failed = failed;
  const text = JSON.stringify(told);
  document.body.replaceChildren(document.createElement("pre"));
  document.body.firstChild.id = "told";
  document.body.firstChild.textContent = encodeURIComponent(text);
});
)js";

class Serve : public Pages {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
  }
  /// The page of a command that must succeed.
  std::string page(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "serve"});
    words.insert(words.end(), {"--output", "page.html"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    return read("page.html");
  }
  std::string error(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "serve"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran.err;
  }
  /// Runs `asked`, the body of an async JavaScript function, and returns the value that it leaves
  /// in `told`.
  json ask(const std::string& html, const std::string& asked, const std::string& flags = "") {
    json j = in_browser(html, fmt::format("{}const asked = async () => {{{}}};\n", kHelpers, asked),
                        "--disable-accelerated-2d-canvas --window-size=1200,800 " + flags,
                        [](const std::string& text) {
                          json all = json::parse(decoded(text), nullptr, false);
                          return all.value("ready", "") == "" ? json() : all;
                        });
    EXPECT_EQ(j["ready"], "yes");
    EXPECT_EQ(j["failed"], json::array());
    return j;
  }
  static std::string decoded(const std::string& text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '%') {
        plain += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
        i += 2;
      } else {
        plain += text[i];
      }
    return plain;
  }
};

#define NEEDS_BROWSER \
  if (browser().empty()) GTEST_SKIP() << "needs Chromium, to run the scripts of the page"

TEST_F(Serve, Page_IsOneFileThatLoadsNothing) {
  const std::string html = page({"a.fst"});
  const auto policies =
      between(html, "<meta http-equiv=\"Content-Security-Policy\" content=\"", "\">");
  ASSERT_EQ(policies.size(), 1u);
  EXPECT_EQ(policies[0].find("default-src 'none'; "), 0u);
  for (const char* unsound : {"unsafe", "http", "blob:"}) EXPECT_FALSE(has(policies[0], unsound));
  const auto scripts = between(html, "<script>", "</script>");
  ASSERT_EQ(scripts.size(), 5u);
  for (const std::string& script : scripts)
    EXPECT_TRUE(has(policies[0], policy_hash(script))) << script.substr(0, 80);
  for (const char* loads : {"http://", "https://", "src=", "href=", "@import", "url(", "onclick="})
    EXPECT_FALSE(has(html, loads));
  EXPECT_LT(html.size(), 100'000u);
}

TEST_F(Serve, Json_DescribesThePage) {
  const Ran ran = cde({"wave", "serve", "a.fst", "count", "data", "--around", "fail", "--window",
                       "2", "--output", "page.html", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json j = json::parse(ran.out);
  EXPECT_EQ(j["schema"], "cde.wave.serve.1");
  EXPECT_EQ(j["from"], 55);
  EXPECT_EQ(j["to"], 105);
  EXPECT_EQ(j["signals"], 2);
  EXPECT_EQ(j["changes"], 10);  // five edges, at which both change
  EXPECT_EQ(j["page"], "page.html");
  EXPECT_EQ(j["page_bytes"], read("page.html").size());
}

TEST_F(Serve, Names_CannotLeaveTheirPlace) {
  {
    Writer w(folder_ / "<title><img src=x>.fst");
    w.scope("</script><script>alert(1)</script>");
    const fstHandle x = w.signal("<b>&\"'\x1b[31m", 4);
    w.time(0);
    w.set(x, 3);
    w.time(10);
  }
  const std::string html = page({"<title><img src=x>.fst"});
  for (const char* raw : {"alert(1)</", "<img", "<b>&\"", "\x1b"}) EXPECT_FALSE(has(html, raw));
  NEEDS_BROWSER;
  const json told =
      ask(html,
          "told.names = names(); told.title = document.querySelector('h1').textContent; told.bold "
          "= document.querySelectorAll('#list b, img').length;");
  EXPECT_EQ(told["names"], json({"▾ </script><script>alert(1)</script>", "<b>&\"'\\x1b[31m"}));
  EXPECT_EQ(told["title"], "<title><img src=x>.fst");
  EXPECT_EQ(told["bold"], 0);
}

TEST_F(Serve, Page_FitsAPhone) {
  NEEDS_BROWSER;
  const json told = ask(page({"a.fst"}),
                        "document.documentElement.style.width = '400px'; await settled(); "
                        "told.wide = document.body.scrollWidth;",
                        "--window-size=500,900");
  EXPECT_LE(told["wide"], 400);
}

TEST_F(Serve, TooLargePage_IsRefusedWithAdvice) {
  {
    // Words that do not compress: 8 bytes per change.
    Writer w(folder_ / "large.fst");
    w.scope("top");
    std::vector<fstHandle> all;
    for (int i = 0; i < 10; ++i) all.push_back(w.signal(fmt::format("s{}", i), 64));
    std::mt19937_64 random(14);
    for (unsigned t = 0; t < 20'000; ++t) {
      w.time(t);
      for (const fstHandle s : all) w.set(s, random());
    }
  }
  const std::vector<std::string> words = {"large.fst", "--output", "page.html", "--max", "1"};
  const std::string text = error(words);
  for (const char* part : {"--max is 1 MB", "2.2 MB", "fewer signals", "smaller window", "--max 0"})
    EXPECT_TRUE(has(text, part));
  EXPECT_FALSE(exists("page.html"));
  EXPECT_LT(page({"large.fst", "--max", "1", "--to", "3us"}).size(), 1'000'000u);
  EXPECT_LT(page({"large.fst", "s1", "--max", "1"}).size(), 1'000'000u);
  EXPECT_GT(page({"large.fst", "--max", "0"}).size(), 2'000'000u);
}

TEST_F(Serve, InvalidUsage_IsRefused) {
  EXPECT_TRUE(has(error({"a.fst"}), "--output PAGE.html"));
  EXPECT_TRUE(has(error({"a.fst", "cuont", "-o", "p.html"}), "did you mean"));
  EXPECT_TRUE(has(error({"a.fst", "-o", "p.html", "--from", "1ms"}), "outside of the file"));
  EXPECT_TRUE(has(error({"a.fst", "-o", "a.fst"}), "a.fst"));
  EXPECT_TRUE(has(error({"a.fst", "-o", "-", "--json"}), "--json"));
  EXPECT_TRUE(has(error({"a.fst", "-o", "no/folder/p.html"}), "no/folder"));
  EXPECT_TRUE(has(error({"a.fst", "-o", "p.html", "--ulp", "1"}), "has no option '--ulp'"));
  EXPECT_FALSE(exists("p.html"));
  EXPECT_TRUE(has(page({"a.fst", "clk", "--from", "20ns", "--to", "20ns"}), "</html>"));
}

/// The page computes the values of `cde wave at`, in every form, from words of all kinds.
TEST_F(Serve, ValuesAtACursor_EqualThoseOfAt) {
  NEEDS_BROWSER;
  {
    Writer w(folder_ / "words.fst");
    w.scope("top");
    const fstHandle clk = w.signal("clk", 1), wide = w.signal("wide [191:0]", 192),
                    some = w.signal("some [0:63]", 64), odd = w.signal("odd [4:0]", 5);
    std::mt19937_64 random(14);
    for (unsigned t = 0; t < 60; ++t) {
      w.time(1000 + 5ull * t);
      w.set(clk, t % 2);
      std::string bits;
      for (int i = 0; i < 192; ++i) bits += random() % 2 != 0 ? '1' : '0';
      if (t % 5 == 1)
        for (int i = 0; i < 9; ++i) bits[random() % 192] = "xz"[random() % 2];
      w.set(wide, bits);
      // Special fp32 words: zeros, subnormals, infinities, NaN, powers of two and of ten.
      const std::array<std::uint32_t, 12> special = {
          0,          0x80000000, 1,          0x007fffff, 0x00800000, 0x7f7fffff,
          0x7f800000, 0xff800000, 0x7fc00000, 0x41200000, 0x4b800000, 0x3dcccccd};
      const std::uint64_t low = special[t % 12];
      w.set(some, low << 32 | special[random() % 12]);
      if (t > 7) w.set(odd, random() % 32);
    }
  }
  const std::vector<std::string> signals = {
      "wide",      "wide:dec",   "wide:signed", "wide:bin",     "wide:fp32",     "wide:fp16",
      "wide:bf16", "wide:fp64",  "wide:e4m3",   "wide:tf32",    "wide:e5m10/32", "wide:e8m40",
      "some",      "some:fp32",  "some:dec/16", "some[1]:fp32", "some:fp64",     "some[8:23]:bf16",
      "odd",       "odd:signed", "odd[3]",      "wide:hex/48",  "wide[5]:fp32",  "clk"};
  std::vector<std::string> words = signals;
  words.insert(words.begin(), "words.fst");
  const std::vector<unsigned> times = {1000, 1001, 1005, 1030, 1033, 1035, 1040, 1077, 1100,
                                       1125, 1150, 1175, 1200, 1225, 1250, 1280, 1295};
  std::string script = "told.at = {};";
  for (const unsigned t : times)
    script += fmt::format(
        "await type('goto', '{0}ns'); told.at['{0}'] = shown().slice(1).map((row) => "
        "row.children[1].title);",
        t);
  // A window that shows all rows.
  const json told = ask(page(words), script, "--window-size=1200,1600");
  std::set<std::string> seen;
  for (const unsigned t : times) {
    std::vector<std::string> at = {"wave", "at", "words.fst", fmt::format("{}ns", t)};
    at.insert(at.end(), signals.begin(), signals.end());
    at.emplace_back("--json");
    const Ran ran = cde(at);
    ASSERT_EQ(ran.status, 0) << ran.err;
    const json expected = json::parse(ran.out)["values"], got = told["at"][std::to_string(t)];
    ASSERT_EQ(got.size(), signals.size());
    for (std::size_t i = 0; i < signals.size(); ++i) {
      EXPECT_EQ(got[i], expected[i]["value"]) << signals[i] << " at " << t;
      seen.insert(got[i]);
    }
  }
  EXPECT_GT(seen.size(), 200u);
}

TEST_F(Serve, ZoomAndMoves_ChangeTheDrawing) {
  NEEDS_BROWSER;
  const json told = ask(page({"a.fst"}), R"js(
    const box = $("waves").getBoundingClientRect();
    const pointer = (what, x, ctrlKey) => $("waves").dispatchEvent(new PointerEvent(what, { clientX: box.left + x, clientY: box.top + 40, button: 0, ctrlKey, bubbles: true, cancelable: true }));
    $("waves").setPointerCapture = () => {};
    told.about = $("about").textContent;
    told.ends = [];
    for (const x of [0, box.width - 1]) { pointer("pointerdown", x, false); pointer("pointerup", x, false); await settled(); told.ends.push($("cursors").textContent); }
    await key("0");
    told.drawn = [drawn()];
    for (const name of ["+", "+", "ArrowRight", "-", "0"]) { await key(name); told.drawn.push(drawn()); }
    $("waves").dispatchEvent(new WheelEvent("wheel", { deltaY: -200, clientX: 900, clientY: 400, bubbles: true, cancelable: true }));
    await settled();
    told.drawn.push(drawn());
    $("zoom-all").click();
    await settled();
    told.drawn.push(drawn());
    told.ink = ink();
    pointer("pointerdown", 100, true); pointer("pointermove", 300, true); pointer("pointerup", 300, true);
    await settled();
    told.drawn.push(drawn());
  )js");
  const json& d = told["drawn"];
  ASSERT_EQ(d.size(), 9u);
  EXPECT_TRUE(told["about"].get<std::string>().starts_with("0 to 195ns ")) << told["about"];
  EXPECT_TRUE(told["ends"][0].get<std::string>().starts_with("A 0Shift"))
      << "the page must open with the whole window: " << told["ends"];
  EXPECT_TRUE(told["ends"][1].get<std::string>().starts_with("A 195ns ")) << told["ends"];
  EXPECT_NE(d[0], d[1]);
  EXPECT_NE(d[1], d[2]);
  EXPECT_NE(d[2], d[3]);
  EXPECT_NE(d[3], d[4]);
  EXPECT_EQ(d[5], d[0]) << "the whole window again";
  EXPECT_NE(d[6], d[0]) << "after turning the wheel";
  EXPECT_EQ(d[7], d[0]);
  EXPECT_NE(d[8], d[0]) << "after dragging a range";
  EXPECT_GT(told["ink"], 5'000);
}

TEST_F(Serve, Cursors_ShowTheirDifferenceInTimeAndCycles) {
  NEEDS_BROWSER;
  const json told = ask(page({"a.fst", "count:dec", "data:fp32", "--from", "20ns"}), R"js(
    told.start = $("cursors").textContent;
    await key("b");
    await type("goto", "cyc:10");
    told.apart = $("difference").textContent;
    await key("x");
    told.exchanged = $("difference").textContent;
    told.count = values().count;
    await key("n");
    told.next = values().count;
    await key("p"); await key("p");
    told.before = values().count;
    await key("l");
    $("list").children[2].click();
    await key("l");
    told.lanes = values();
    await type("goto", "7s");
    told.refused = $("goto").getAttribute("aria-invalid");
    told.said = $("told").textContent;
  )js");
  EXPECT_EQ(told["start"], "A 75ns  cyc:7Shift and click sets cursor B");  // the fail time
  EXPECT_EQ(told["apart"], "B − A −30ns  −3 cycles  33.33 MHz");
  EXPECT_EQ(told["exchanged"], "B − A 30ns  3 cycles  33.33 MHz");
  EXPECT_EQ(told["count"], "7");
  EXPECT_EQ(told["next"], "8");
  EXPECT_EQ(told["before"], "6");
  EXPECT_EQ(told["lanes"]["data"], "{3 1}");
  EXPECT_EQ(told["lanes"]["data[0]"], "3");
  EXPECT_EQ(told["lanes"]["data[1]"], "1");
  EXPECT_EQ(told["refused"], "true");
  EXPECT_TRUE(has(told["said"].get<std::string>(), "20ns to 195ns"));
}

TEST_F(Serve, Signals_AreSearchedFoldedAndReformatted) {
  NEEDS_BROWSER;
  const json told = ask(page({"a.fst"}), R"js(
    told.all = names();
    await type("search", "COUNT");
    told.found = names();
    await type("search", "c*k");
    told.pattern = names();
    await type("search", "nothing of this kind");
    told.none = [names().length, $("nothing").hidden];
    await key("Escape", $("search"));
    shown()[0].click();
    await settled();
    told.folded = names();
    shown()[0].click();
    await settled();
    shown().find((row) => row.children[0].textContent === "data").click();
    await settled();
    told.forms = [...$("form").options].map((option) => option.value);
    $("form").value = "fp32";
    $("form").dispatchEvent(new Event("change"));
    await settled();
    told.data = values().data;
    told.tree = [$("list").getAttribute("aria-activedescendant"), shown()[0].getAttribute("aria-expanded"), $("details").textContent.includes("top.data")];
    await key("s");
    told.pinned = names().slice(0, 3);
  )js");
  EXPECT_EQ(told["all"], json({"▾ top", "clk", "count", "valid", "ready", "data", "state",
                               "▾ top.core", "count"}));
  EXPECT_EQ(told["found"], json({"▾ top", "count", "▾ top.core", "count"}));
  EXPECT_EQ(told["pattern"], json({"▾ top", "clk"}));
  EXPECT_EQ(told["none"], json({0, false}));
  EXPECT_EQ(told["folded"], json({"▸ top", "▾ top.core", "count"}));
  const auto forms = told["forms"].get<std::set<std::string>>();
  for (const char* form : {"hex", "dec", "signed", "bin", "fp32", "fp64", "fp16", "bf16"})
    EXPECT_TRUE(forms.contains(form)) << form;
  EXPECT_EQ(told["data"], "{3.5 nan}");
  EXPECT_EQ(told["tree"], json({"row5", "true", true}));
  EXPECT_EQ(told["pinned"], json({"▾ Pinned", "data ★", "▾ top"}));
}

TEST_F(Serve, Colours_FollowTheReadersPreference) {
  NEEDS_BROWSER;
  const std::string html = page({"a.fst"});
  const char* const script = R"js(
    const ground = () => { const p = pixels(); return p.slice(p.length - 4, p.length - 1).reduce((a, b) => a + b); };
    told.asked = [document.documentElement.dataset.theme, ground()];
    $("theme").click();
    await settled();
    told.changed = [document.documentElement.dataset.theme, ground(), $("theme").getAttribute("aria-pressed")];
  )js";
  const json light = ask(html, script, "--blink-settings=preferredColorScheme=1");
  EXPECT_EQ(light["asked"][0], "light");
  EXPECT_GT(light["asked"][1], 700);
  EXPECT_EQ(light["changed"][0], "dark");
  EXPECT_LT(light["changed"][1], 150);
  EXPECT_EQ(light["changed"][2], "true");
  std::filesystem::remove_all(folder_ / "browser");  // which remembers the chosen colours
  const json dark = ask(html, script, "--blink-settings=preferredColorScheme=0");
  EXPECT_EQ(dark["asked"][0], "dark");
  EXPECT_LT(dark["asked"][1], 150);
  EXPECT_EQ(dark["changed"][0], "light");
}

TEST_F(Serve, Transactions_StandAboveTheSignals) {
  NEEDS_BROWSER;
  write_pci(folder_ / "pci.fst");
  const json expected = json::parse(cde({"wave", "tx", "pci.fst", "--json"}).out)["transactions"];
  ASSERT_GE(expected.size(), 5u);
  const json told = ask(page({"pci.fst"}), R"js(
    told.names = names().slice(0, 2);
    $("list").children[1].click();
    told.seen = [];
    await key("Home");
    for (let k = 0; k < 40; ++k) { told.seen.push($("list").children[1].children[1].title); await key("n"); }
    told.details = $("details").textContent;
  )js");
  EXPECT_EQ(told["names"], json({"▾ Transactions", "pci"}));
  const auto seen = told["seen"].get<std::set<std::string>>();
  for (const json& t : expected)
    EXPECT_TRUE(seen.contains(t["label"].get<std::string>())) << t["label"];
  EXPECT_TRUE(has(told["details"].get<std::string>(), expected.back()["label"].get<std::string>()));
}

}  // namespace
}  // namespace cde::testing
