// SPDX-License-Identifier: Apache-2.0
#include "pages.hpp"
#include "../has.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <regex>
#include <set>

namespace cde::testing {

using nlohmann::json;

/// The first line of a command's output.
static std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::array<char, 4096> part{};
  std::string text;
  while (std::fgets(part.data(), part.size(), pipe.get()) != nullptr) text += part.data();
  return text.substr(0, text.find('\n'));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

std::vector<std::string> between(const std::string& text, const std::string& begin,
                                 const std::string& end) {
  std::vector<std::string> found;
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    found.push_back(text.substr(at, text.find(end, at) - at));
  }
  return found;
}

std::string plain(std::string text) {
  for (const auto& [from, to] :
       {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + 1))
      text.replace(at, std::strlen(from), to);
  return text;
}

std::string browser() {
  return output_of(
      "command -v chromium || command -v chromium-browser || command -v google-chrome");
}

namespace {

/// Clicks on every button that saves a file and reports the offered files: names, texts, and for
/// pictures how much is drawn when they are opened alone.
const char* const kClicks = R"(
const made = [], taken = new Map(), failed = [], texts = new Map(), Plain = Blob;
// Chromium's virtual time may end before a Blob is read, so its text is kept when it is made.
Blob = class extends Plain {
  constructor(parts, options) { super(parts, options); texts.set(this, parts.join("")); }
};
addEventListener("error", (e) => failed.push(String(e.message)));
addEventListener("securitypolicyviolation", (e) => failed.push(e.violatedDirective));
URL.createObjectURL = (blob) => { const url = "blob:" + taken.size; taken.set(url, blob); return url; };
HTMLAnchorElement.prototype.click = function() { made.push([this.download, taken.get(this.href)]); };
const drawn = async (text) => {
  const picture = new Image();
  picture.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(text);
  await picture.decode();
  const canvas = document.createElement("canvas");
  canvas.width = picture.naturalWidth; canvas.height = picture.naturalHeight;
  const pen = canvas.getContext("2d");
  pen.drawImage(picture, 0, 0);
  const seen = new Set(), p = pen.getImageData(0, 0, canvas.width, canvas.height).data;
  let ink = 0;
  for (let i = 0; i < p.length; i += 4) {
    if (p[i] !== p[0] || p[i + 1] !== p[1] || p[i + 2] !== p[2]) { ++ink; seen.add(p[i] << 16 | p[i + 1] << 8 | p[i + 2]); }
  }
  return { width: canvas.width, height: canvas.height, ink, colours: seen.size, ground: [p[0], p[1], p[2], p[3]] };
};
addEventListener("load", async () => {
  const buttons = [...document.querySelectorAll(".save button")];
  for (const button of buttons) button.click();
  const marks = [...document.querySelectorAll(".mark")], shown = () =>
    [...document.querySelectorAll("[data-choice]")].filter((section) => !section.hidden).map((section) => section.dataset.name);
  const chosen = marks.map((mark) => {
    mark.dispatchEvent(new MouseEvent("click", { bubbles: true }));
    return mark.closest("[data-choice]").querySelector(".chosen").textContent;
  });
  const choices = [...document.querySelectorAll(".choose select")].map((select) => {
    const before = shown();
    select.value = select.options[select.options.length - 1].value;
    select.dispatchEvent(new Event("change"));
    return { id: select.id, options: [...select.options].map((option) => option.value), before, after: shown() };
  });
  const files = [];
  for (const [name, blob] of made) {
    const text = texts.get(blob), file = { name, type: blob.type, text };
    if (name.endsWith(".svg")) {
      const xml = new DOMParser().parseFromString(text, "image/svg+xml");
      file.root = xml.documentElement.namespaceURI + " " + xml.documentElement.localName;
      file.label = xml.querySelector("title") ? xml.querySelector("title").textContent : "";
      file.classes = xml.querySelectorAll("[class], style").length;
      file.drawn = await drawn(text).catch((error) => failed.push(String(error)));
    }
    files.push(file);
  }
  document.body.replaceChildren(document.createElement("pre"));
  document.body.firstChild.id = "told";
  document.body.firstChild.textContent = JSON.stringify({ buttons: buttons.length, files, failed, chosen, choices });
});
)";

}  // namespace

json Pages::in_browser(std::string html, const std::string& script, const std::string& flags,
                       const std::function<json(const std::string&)>& answer) {
  const std::string policy = "script-src ";
  html.insert(html.find(policy) + policy.size(), policy_hash(script) + " ");
  html.insert(html.find("<title>"), fmt::format("<script>{}</script>", script));
  write("asked.html", html);
  Ran ran;
  for (int budget = 20000; budget <= 320000; budget *= 2) {
    ran = shell(
        fmt::format("HOME=$PWD timeout 120 {} --headless --no-sandbox --disable-gpu --no-first-run "
                    "--disable-background-networking --user-data-dir=$PWD/browser {} "
                    "--virtual-time-budget={} --dump-dom file://$PWD/asked.html",
                    browser(), flags, budget));
    for (const std::string& text : between(ran.out, "<pre id=\"told\">", "</pre>"))
      if (json j = answer(text); !j.is_null()) return j;
  }
  ADD_FAILURE() << "the page did not answer: " << ran.status << ran.err.substr(0, 3000)
                << ran.out.substr(0, 2000);
  return json::object();
}

json Pages::clicked(const std::string& html) {
  return in_browser(html, kClicks, "",
                    [](const std::string& text) { return json::parse(plain(text)); });
}

void Pages::expect_fits_a_phone(const std::string& html) {
  const char* const measure = R"page(
addEventListener("load", () => {
  for (const folded of document.querySelectorAll("details, [data-choice]")) { folded.open = true; folded.hidden = false; }
  const root = document.documentElement, cut = [], broken = [];
  root.style.width = "400px";  // a browser window is at least 500 wide
  for (const box of document.querySelectorAll(".scroll")) {
    const caption = box.querySelector("caption").firstElementChild || box.querySelector("caption");
    if (caption.getBoundingClientRect().right > box.getBoundingClientRect().right + 1) cut.push(caption.textContent);
    for (const head of box.querySelectorAll("thead th"))
      if (head.getClientRects()[0].height > 3 * parseFloat(getComputedStyle(head).lineHeight)) broken.push(head.textContent);
  }
  const told = { wide: document.body.scrollWidth, cut, broken, tables: document.querySelectorAll(".scroll").length };
  document.body.replaceChildren(document.createElement("pre"));
  document.body.firstChild.id = "told";
  document.body.firstChild.textContent = JSON.stringify(told);
});
)page";
  const json told = in_browser(html, measure, "--window-size=500,1600",
                               [](const std::string& text) { return json::parse(plain(text)); });
  EXPECT_LE(told["wide"], 400);
  EXPECT_GT(told["tables"], 0);
  EXPECT_EQ(told["cut"], json::array());
  EXPECT_EQ(told["broken"], json::array());
}

void Pages::expect_saved(const json& told, std::size_t charts) {
  EXPECT_EQ(told["failed"], json::array());
  EXPECT_EQ(told["buttons"], 2 * charts);
  ASSERT_EQ(told["files"].size(), 2 * charts);
  std::set<std::string> names;
  for (const json& file : told["files"]) {
    const std::string name = file["name"], text = file["text"];
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_of("/\\<>\"?*: "), std::string::npos) << name;
    if (name.ends_with(".csv")) {
      EXPECT_EQ(file["type"], "text/csv;charset=utf-8");
      EXPECT_GE(count(text, "\n"), 3u) << text;
      continue;
    }
    ASSERT_TRUE(name.ends_with(".svg")) << name;
    EXPECT_EQ(file["root"], "http://www.w3.org/2000/svg svg") << name;
    EXPECT_EQ(file["classes"], 0) << "styles from the page's style sheet";
    for (const char* needs : {"var(", "NaN", "undefined", "%\"", "href"})
      EXPECT_FALSE(has(text, needs)) << name << needs;
    EXPECT_EQ(file["drawn"]["width"], 760);
    EXPECT_EQ(file["drawn"]["ground"], json({255, 255, 255, 255})) << "white, as in print";
    EXPECT_GT(file["drawn"]["ink"], 1000) << name;
    EXPECT_GT(file["drawn"]["colours"], 20) << name;
  }
}

std::string Pages::policy_hash(const std::string& text) {
  write("hashed", text);
  return fmt::format(
      "'sha256-{}'",
      output_of(fmt::format(
          "sha256sum {} | cut -c1-64 | tr a-f A-F | basenc -d --base16 | basenc --base64",
          (folder_ / "hashed").string())));
}

void Pages::expect_sound(const std::string& html, std::size_t scripts) {
  const auto policies =
      between(html, "<meta http-equiv=\"Content-Security-Policy\" content=\"", "\">");
  ASSERT_EQ(policies.size(), 1u);
  const std::string& policy = policies[0];
  EXPECT_EQ(policy.find("default-src 'none'; "), 0u) << policy;
  EXPECT_FALSE(has(policy, "unsafe"));
  EXPECT_FALSE(has(policy, "http"));
  const auto styles = between(html, "<style>", "</style>");
  ASSERT_EQ(styles.size(), 1u);
  EXPECT_TRUE(has(policy, "style-src " + policy_hash(styles[0])));
  const auto code = between(html, "<script>", "</script>");
  ASSERT_EQ(code.size(), scripts);
  for (const std::string& script : code)
    EXPECT_TRUE(has(policy, policy_hash(script))) << script.substr(0, 60);
  std::string markup = html;
  for (const std::string& script : code) markup.replace(markup.find(script), script.size(), "");
  for (const char* loads : {" src=\"http", " href=", "url(", "@import", " style=", " onclick="})
    EXPECT_FALSE(has(markup, loads));
  for (const char* element : {"section", "table", "svg", "div", "figure", "main", "body", "html"}) {
    const std::regex opens(fmt::format("<{}[ >]", element));
    const auto opened = std::distance(std::sregex_iterator(markup.begin(), markup.end(), opens),
                                      std::sregex_iterator());
    EXPECT_EQ(static_cast<std::size_t>(opened), count(markup, fmt::format("</{}>", element)))
        << element;
  }
  EXPECT_TRUE(has(html, "<meta name=\"viewport\""));
}

}  // namespace cde::testing
