// SPDX-License-Identifier: Apache-2.0
// The viewer of `cde wave tui` without a terminal: keys as input, rows of text as output.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <random>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"
#include "tui/tui_viewer.hpp"

namespace cde::testing {
namespace {

using wave::Trace;
using wave::tui::Canvas;
using wave::tui::Key;
using wave::tui::Stretch;
using wave::tui::Viewer;
namespace key = wave::tui::key;

/// A viewer and its screen.
class Fake {
 public:
  Fake(const std::string& file, const std::vector<std::string>& words, Stretch window,
       std::uint64_t cursor, const std::string& other = "", bool ascii = true)
      : trace_(file) {
    if (!other.empty()) other_.emplace(other);
    wave::tui::Begin begin{"", {}, ascii, window, cursor, {}};
    if (window.end == 0) begin.window = {trace_.start(), trace_.end()};
    for (const std::string& word : words)
      for (const wave::View& v : wave::views(trace_, word, {})) begin.views.push_back(v);
    viewer_.emplace(trace_, other_ ? &*other_ : nullptr, std::move(begin));
    size(80, 24);
  }
  void size(std::size_t columns, std::size_t rows) {
    viewer_->resize(columns, rows);
    settle();
  }
  /// Completes reading, searching and drawing.
  void settle() {
    while (viewer_->work()) {
    }
    canvas_.emplace(viewer_->draw());
  }
  bool press(Key k) {
    const bool goes_on = viewer_->press(k);
    settle();
    return goes_on;
  }
  /// Types ASCII characters;
  ///  is Enter.
  void type(const std::string& text) {
    for (const char c : text) ASSERT_TRUE(press(static_cast<Key>(c))) << text;
  }
  [[nodiscard]] std::uint64_t cursor_after(const std::string& keys) {
    type(keys);
    return viewer_->cursor();
  }
  [[nodiscard]] std::string message_after(const std::string& keys) {
    type(keys);
    return message();
  }
  [[nodiscard]] std::string status_after(const std::string& keys) {
    type(keys);
    return status();
  }
  [[nodiscard]] std::string row(std::size_t i) const { return canvas_->text(i); }
  [[nodiscard]] std::string all() const {
    std::string text;
    for (std::size_t i = 0; i < canvas_->rows(); ++i) text += row(i) + "\n";
    return text;
  }
  /// The text after the name of a signal.
  [[nodiscard]] std::string line(const std::string& name) const {
    for (std::size_t i = 2; i + 2 < canvas_->rows(); ++i)
      if (row(i).starts_with(name + " ")) return row(i);
    return "";
  }
  [[nodiscard]] std::string status() const { return row(canvas_->rows() - 2); }
  [[nodiscard]] std::string message() const { return row(canvas_->rows() - 1); }
  [[nodiscard]] const Canvas& canvas() const { return *canvas_; }
  /// The columns of a row whose characters have a style.
  template <class Has>
  [[nodiscard]] std::vector<std::size_t> columns(std::size_t row, Has has) const {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < canvas_->columns(); ++c)
      if (has(canvas_->at(row, c).style)) found.push_back(c);
    return found;
  }
  Viewer& operator*() { return *viewer_; }
  Viewer* operator->() { return &*viewer_; }
  [[nodiscard]] Trace& trace() { return trace_; }

 private:
  Trace trace_;
  std::optional<Trace> other_;
  std::optional<Viewer> viewer_;
  std::optional<Canvas> canvas_;
};

class Tui : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  Fake sample(const std::vector<std::string>& words, Stretch window = {45, 115},
              std::uint64_t cursor = 75) {
    return {path("a.fst"), words, window, cursor};
  }
  /// Signals of several widths over blocks of a hundred units. The clock, count and late also
  /// change in the first unit of a block. late changes only in the last block.
  void write_blocks() {
    Writer w(folder_ / "blocks.fst");
    w.scope("top");
    const fstHandle clk = w.signal("clk", 1), count = w.signal("count [15:0]", 16),
                    odd = w.signal("odd [63:0]", 64), late = w.signal("late", 1);
    std::mt19937_64 random(7);
    for (unsigned t = 0; t < 1000; ++t) {
      w.time(t);
      w.set(clk, t / 5 % 2);
      if (t % 10 == 0) w.set(count, t / 10);
      if (random() % 3 == 0) w.set(odd, random() % 4);
      w.set(late, t >= 900 ? 1 : 0);
      if (t % 100 == 99) w.block();
    }
  }
  std::vector<std::uint64_t> found_by_find(const std::vector<std::string>& words) {
    std::vector<std::string> all = {"wave", "find"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--max", "0"});
    const std::string text = cde(all).out;
    std::vector<std::uint64_t> times;
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
      times.push_back(std::stoull(text.substr(at)));
    return times;
  }
};

TEST_F(Tui, Signals_ShowValuesAndWaves) {
  Fake f = sample({"clk", "count:dec", "valid", "data:fp32", "data[1]:fp32", "state:bin"});
  EXPECT_EQ(f.row(0).substr(0, 13), " a.fst  top  ") << f.all();
  EXPECT_TRUE(f.row(0).ends_with("45ns to 115ns")) << f.all();
  EXPECT_TRUE(f.line("count").starts_with("count    7 ")) << f.all();
  EXPECT_TRUE(has(f.line("data"), "{3.5 nan}")) << f.all();
  EXPECT_TRUE(f.line("data[1]").starts_with("data[1]  nan ")) << f.all();
  EXPECT_TRUE(f.line("state").starts_with("state    001 ")) << f.all();
  EXPECT_TRUE(has(f.line("valid"), "/----")) << f.all();
  EXPECT_TRUE(has(f.line("valid"), "\\____")) << f.all();
  EXPECT_TRUE(has(f.line("count"), "|10")) << f.all();
  EXPECT_EQ(f.status().substr(0, 14), " A 75ns cyc:7 ") << f.all();
  EXPECT_TRUE(has(f.row(1), "|60ns")) << f.all();
  EXPECT_TRUE(f.message().starts_with(" ? keys")) << f.all();
}

/// A rising edge is drawn in the column of its time, as are the ruler's tick and the cursor.
TEST_F(Tui, RulerCursorAndEdges_Agree) {
  Fake f = sample({"clk"}, {0, 195}, 0);
  for (const unsigned time : {35u, 75u, 115u}) {
    f.type(fmt::format("g{}\n", time));
    const auto columns = f.columns(2, [](auto s) { return s.cursor; });
    ASSERT_EQ(columns.size(), 1u);
    EXPECT_EQ(f.canvas().at(2, columns[0]).c, U'/') << f.all();
  }
  f.type("g100\n");
  const auto columns = f.columns(1, [](auto s) { return s.cursor; });
  EXPECT_EQ(f.row(1).substr(columns.at(0), 6), "|100ns") << f.all();
}

TEST_F(Tui, Ruler_MarksUndumpedTimes) {
  write("d.vcd",
        "$timescale 1ns $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#0\n0!\n#20\n$dumpoff\n"
        "x!\n$end\n#80\n$dumpon\n1!\n$end\n#100\n0!\n");
  Fake f(path("d.vcd"), {"a"}, {0, 100}, 0);
  const std::string ruler = f.row(1);
  EXPECT_GT(std::count(ruler.begin(), ruler.end(), '/'), 5) << f.all();
  Fake all = sample({"clk"}, {0, 195}, 0);
  EXPECT_EQ(all.row(1).find('/'), std::string::npos) << all.all();
}

TEST_F(Tui, UnicodeAndAscii_HaveTheSameColumns) {
  Fake ascii = sample({"clk", "count", "valid", "state"}, {0, 195}, 35);
  Fake unicode(path("a.fst"), {"clk", "count", "valid", "state"}, {0, 195}, 35, "", false);
  EXPECT_TRUE(has(unicode.row(2), "╱▔")) << unicode.all();
  EXPECT_TRUE(has(unicode.row(4), "░")) << unicode.all();
  for (std::size_t row = 2; row < 6; ++row) {
    const auto chars = wave::tui::characters(unicode.row(row));
    EXPECT_EQ(chars.size(), ascii.row(row).size()) << ascii.row(row);
    for (const char c : ascii.all()) ASSERT_TRUE(static_cast<unsigned char>(c) < 0x80);
  }
}

TEST_F(Tui, EdgeKeys_FollowTheChosenSignal) {
  Fake f = sample({"count", "valid", "data[1]:fp32"});
  EXPECT_EQ(f.cursor_after("w"), 85u);
  EXPECT_EQ(f.cursor_after("bb"), 65u);
  f.type("jw");  // valid falls in cycle 8
  EXPECT_EQ(f->cursor(), 85u);
  EXPECT_EQ(f.cursor_after("w"), 95u);
  f.type("jb");  // the upper lane differs in cycle 7 only, the lower lane always
  EXPECT_EQ(f->cursor(), 85u);
  EXPECT_EQ(f.cursor_after("b"), 75u);
  EXPECT_EQ(f.cursor_after("b"), 5u);
  EXPECT_EQ(f.cursor_after("0b"), 0u);
  EXPECT_TRUE(has(f.message(), "no change of top.data[1] before the cursor")) << f.all();
  EXPECT_EQ(f.cursor_after("$w"), 195u);
  EXPECT_TRUE(has(f.message(), "after the cursor")) << f.all();
}

TEST_F(Tui, Times_EqualThoseOfAllCommands) {
  Fake f = sample({"count:dec"});
  EXPECT_EQ(f.cursor_after("gcyc:12\n"), 125u);
  EXPECT_EQ(f.cursor_after("gfail-4cyc\n"), 35u);
  EXPECT_EQ(f.cursor_after("g0.05us\n"), 50u);
  for (const char* wrong : {"cyc:99", "1ms", "what", "fail-", "cyc:", "-3", "100 50"}) {
    EXPECT_EQ(f.cursor_after(fmt::format("g{}\n", wrong)), 50u);
    EXPECT_NE(f->message(), "") << wrong;
  }
  EXPECT_EQ(f.cursor_after("g100 150\n"), 100u);
  EXPECT_EQ(f->window().begin, 100u);
  EXPECT_EQ(f->window().end, 150u);
  f.type("g77");
  EXPECT_EQ(f.message(), " go to: 77") << f.all();
  f.press(key::kEscape);
  EXPECT_EQ(f->cursor(), 100u);
}

TEST_F(Tui, SecondCursor_ShowsTheDifference) {
  Fake f = sample({"count:dec"});
  f.type("mgcyc:10\n");
  EXPECT_EQ(f.status().substr(0, 57), " A 105ns cyc:10   B 75ns cyc:7   A-B 30ns 3 cycles       ")
      << f.all();
  EXPECT_EQ(f.cursor_after("'"), 75u);
  EXPECT_TRUE(has(f.status(), "A-B -30ns -3 cycles")) << f.all();
  f.type("z");
  EXPECT_EQ(f->window().begin, 75u);
  EXPECT_EQ(f->window().end, 105u);
  f.type("u");
  EXPECT_EQ(f->window().begin, 45u);
  EXPECT_EQ(f->window().end, 115u);
  f.type("gcyc:9\nm");
  EXPECT_EQ(f->second_cursor(), 95u);
  f.type("m");
  EXPECT_EQ(f->second_cursor(), std::nullopt);
  EXPECT_TRUE(has(f.message_after("z"), "no second cursor")) << f.all();
}

TEST_F(Tui, Zoom_KeepsTheCursorInItsColumn) {
  Fake f = sample({"count"}, {0, 195}, 75);
  const auto column = [&] { return f.columns(2, [](auto s) { return s.cursor; }).at(0); };
  const std::size_t before = column();
  const Stretch all = f->window();
  for (int i = 0; i < 3; ++i) {
    f.type("+");
    EXPECT_LE(std::max(column(), before) - std::min(column(), before), 3u) << f.all();
  }
  EXPECT_LT(f->window().end - f->window().begin, 30u);
  for (int i = 0; i < 20; ++i) f.type("+");
  const Stretch least = f->window();
  EXPECT_LE(least.begin, 75u);
  EXPECT_GE(least.end, 75u);
  f.type("=");
  EXPECT_EQ(f->window().begin, all.begin);
  EXPECT_EQ(f->window().end, all.end);
  f.type("-");
  EXPECT_EQ(f->window().end, all.end);
}

TEST_F(Tui, Keys_MoveCursorAndWindow) {
  Fake f = sample({"count"}, {45, 115}, 75);
  f.type("h");
  EXPECT_LT(f->cursor(), 75u);
  f.type("ll");
  EXPECT_GT(f->cursor(), 75u);
  f.type("L");
  EXPECT_GT(f->window().begin, 70u);
  f.type("HH");
  EXPECT_LT(f->window().begin, 45u);
  for (int i = 0; i < 300; ++i) f.press(key::kRight);
  EXPECT_EQ(f->cursor(), 195u);
  EXPECT_EQ(f->window().end, 195u);
  for (int i = 0; i < 300; ++i) f.press(key::kLeft);
  EXPECT_EQ(f->cursor(), 0u);
  EXPECT_EQ(f->window().begin, 0u);
}

/// In both directions the cursor stops where `cde wave find` finds the expression, across blocks.
TEST_F(Tui, Expressions_AreFoundWhereFindFindsThem) {
  write_blocks();
  const std::array<std::array<std::string, 2>, 6> asked = {{
      {"odd == 2 && clk", ""},
      {"rose(clk) && odd[1:0] != 1", ""},
      {"changed(count)", ""},
      {"late", ""},
      {"odd[0] == 1", "posedge clk"},
      {"changed(odd[0])", "negedge clk"},
  }};
  for (const auto& [what, on] : asked) {
    SCOPED_TRACE(what);
    Fake f(path("blocks.fst"), {"clk"}, {}, 0);
    ASSERT_GE(f->blocks(), 10u);
    std::vector<std::string> words = {"blocks.fst", what};
    if (!on.empty()) words.insert(words.end(), {"--on", on});
    const auto expected = found_by_find(words);
    ASSERT_FALSE(expected.empty());
    std::vector<std::uint64_t> forward, back;
    f.type(fmt::format("f{}{}\n", what, on.empty() ? "" : " @" + on));
    for (std::uint64_t last = 0; f->cursor() != last && forward.size() < 2000; f.type("n")) {
      last = f->cursor();
      forward.push_back(last);
    }
    if (expected.front() == 0) forward.insert(forward.begin(), 0);  // the cursor was there
    EXPECT_EQ(forward, expected);
    EXPECT_TRUE(has(f.message(), "not true after the cursor")) << f.all();
    f.type("$");
    if (expected.back() == f->cursor()) back.push_back(f->cursor());
    for (f.type("N"); back.empty() || f->cursor() != back.back(); f.type("N"))
      back.push_back(f->cursor());
    std::reverse(back.begin(), back.end());
    EXPECT_EQ(back, expected);
  }
}

TEST_F(Tui, WrongExpressions_AreReported) {
  Fake f = sample({"count"});
  EXPECT_TRUE(has(f.message_after("n"), "no expression yet")) << f.all();
  for (const char* wrong :
       {"cuont == 7", "1 == 1", "(", "count @never clk", "count @posedge data"}) {
    f.type(fmt::format("f{}\n", wrong));
    EXPECT_NE(f->message(), "") << wrong;
    EXPECT_EQ(f->cursor(), 75u) << wrong;
  }
}

TEST_F(Tui, Signals_AreFoundByName) {
  Fake f = sample({"*"});
  EXPECT_TRUE(has(f.status_after("/dat\n"), "signal 5 of 7"));
  EXPECT_TRUE(has(f.status_after("/*count\n"), "signal 7 of 7"));
  EXPECT_TRUE(has(f.status_after("n"), "signal 2 of 7"));
  EXPECT_TRUE(has(f.status_after("N"), "signal 7 of 7"));
  EXPECT_TRUE(has(f.message_after("/nothing\n"), "no signal nothing")) << f.all();
}

TEST_F(Tui, Signals_AreAddedAndRemoved) {
  Fake f = sample({"clk"});
  f.type("acount");
  EXPECT_TRUE(has(f.row(1), "2 of 7 signals")) << f.all();
  f.type("\n");
  f.press(key::kEscape);
  EXPECT_TRUE(f.line("count").starts_with("count    07 ")) << f.all();
  // The form and lane belong to the added name.
  f.type("adata[1]:fp32\t");
  f.press(key::kEscape);
  EXPECT_TRUE(f.line("data[1]").starts_with("data[1]  nan ")) << f.all();
  f.type("a*a*\t");
  EXPECT_TRUE(has(f.all(), "4 added"));
  f.press(key::kEscape);
  EXPECT_TRUE(has(f.status(), "of 7")) << f.all();
  f.type("adata");
  f.press(key::kDelete);
  EXPECT_TRUE(has(f.all(), "2 removed"));
  f.press(key::kEscape);
  EXPECT_EQ(f.line("data[1]"), "");
  f.type("^");
  for (int i = 0; i < 9; ++i) f.type("x");
  EXPECT_TRUE(has(f.all(), "No signals. Press a to add some"));
  f.type("wvVnJKG");  // keys on an empty list
  f.type("astate\n");
  f.press(key::kEscape);
  EXPECT_TRUE(f.line("state").starts_with("state    1 ")) << f.all();
  f.type("awrong[\t");
  EXPECT_NE(f->message(), "");
}

TEST_F(Tui, Keys_ChangeTheFormatOfValues) {
  Fake f = sample({"data", "count", "data[0]:fp32"});
  for (const char* value : {"9205357", "9205357", "01111111", "{3.5 nan}", "2.2471", "7fc0000"}) {
    f.type("v");
    EXPECT_EQ(f.line("data").substr(9, std::string(value).size()), value) << f.all();
  }
  f.type("Vbf16\n");
  EXPECT_TRUE(has(f.line("data"), "{0 3.5 0 nan}")) << f.all();
  EXPECT_TRUE(has(f.message_after("Vfp99\n"), "no form")) << f.all();
  f.type("jVfp32\n");
  EXPECT_NE(f->message(), "");
  f.type("jVdec\n");
  EXPECT_TRUE(has(f.line("data[0]"), "1080033280")) << f.all();
}

TEST_F(Tui, Transactions_AreFoundByKind) {
  write_pci(folder_ / "pci.fst");
  Fake f(path("pci.fst"), {"*"}, {}, 0);
  EXPECT_EQ(f.cursor_after("t"), 45u);
  EXPECT_TRUE(has(f->message(),
                  "pci host memory-write 0xf0001000, 3 words of 32 bits, done, 45ns to "
                  "195ns (1 of 8)"));
  EXPECT_EQ(f.cursor_after("tt"), 405u);
  EXPECT_EQ(f.cursor_after("T"), 255u);
  EXPECT_EQ(f.cursor_after("$T"), 1335u);
  EXPECT_TRUE(has(f.message_after("t"), "no transaction after the cursor"));
  EXPECT_TRUE(has(f.message_after("ypci\n"), "no transaction of kind pci after"));
  EXPECT_TRUE(has(f.message_after("ydma\n"), "has no transaction of kind dma"));
  EXPECT_TRUE(has(f.message_after("ypcie\n"), "there are: pci, bus"));
}

TEST_F(Tui, Differences_AreMarkedAndFound) {
  write_sample(folder_ / "b.fst", {.late = 0, .wrong_at = 9, .cycles = 15});
  Fake f(path("a.fst"), {"count", "data[0]:fp32", "data[1]:fp32"}, {45, 115}, 50, path("b.fst"));
  EXPECT_TRUE(f.row(0).starts_with(" a.fst | b.fst  top"));
  const auto differs = [](auto s) { return s.differs; };
  EXPECT_TRUE(f.columns(2, differs).empty()) << f.all();
  const auto here = f.columns(4, differs), there = f.columns(5, differs);
  ASSERT_FALSE(here.empty()) << f.all();
  EXPECT_EQ(here, there);
  EXPECT_TRUE(f.columns(6, differs).empty()) << f.all();
  EXPECT_EQ(f.cursor_after("d"), 95u);
  EXPECT_TRUE(has(f.message(), "top.data[0] differs")) << f.all();
  // The marked range lasts from 95 to 105.
  const auto at_cursor = f.columns(4, [](auto s) { return s.cursor; });
  EXPECT_EQ(f.columns(1, [](auto s) { return s.cursor; }), at_cursor);
  const auto waves = f.columns(4, differs);
  ASSERT_TRUE(std::find(waves.begin(), waves.end(), at_cursor.at(0)) != waves.end());
  EXPECT_EQ(waves.back() - at_cursor.at(0), 10u * here.size() / 10u - 1) << f.all();
  EXPECT_TRUE(has(f.row(4), "4.5"));
  EXPECT_TRUE(has(f.row(5), "4.5000005")) << f.all();
  EXPECT_EQ(f.cursor_after("d"), 95u);
  EXPECT_TRUE(has(f.message(), "no difference after the cursor")) << f.all();
  EXPECT_EQ(f.cursor_after("$D"), 95u);
  f.type("B");
  EXPECT_TRUE(f.row(3).starts_with("data[0]")) << f.all();
}

/// Differences that begin or end at block boundaries, or span several blocks, count once each.
TEST_F(Tui, DifferencesAcrossBlocks_CountOnce) {
  const std::vector<Stretch> wrong = {{40, 49}, {300, 319}, {350, 649}, {690, 699}, {990, 999}};
  for (const bool differs : {false, true}) {
    Writer w(folder_ / (differs ? "y.fst" : "x.fst"));
    w.scope("top");
    const fstHandle s = w.signal("s [7:0]", 8);
    for (unsigned t = 0; t < 1000; ++t) {
      w.time(t);
      const bool here = std::any_of(wrong.begin(), wrong.end(),
                                    [&](const Stretch& d) { return t >= d.begin && t <= d.end; });
      w.set(s, differs && here ? 200 : t / 10);
      // The two files have different blocks.
      if (t % (differs ? 70 : 100) == (differs ? 69 : 99)) w.block();
    }
  }
  Fake f(path("x.fst"), {"s:dec"}, {}, 0, path("y.fst"));
  ASSERT_GE(f->blocks(), 10u);
  for (const Stretch& d : wrong) {
    EXPECT_EQ(f.cursor_after("d"), d.begin);
  }
  f.type("$D");
  for (std::size_t i = wrong.size(); i-- > 0; f.type("D")) EXPECT_EQ(f->cursor(), wrong[i].begin);
  // Differences are marked at any scale.
  for (const char* window : {"0 999", "340 360", "640 700", "298 303", "980 999"}) {
    f.type(fmt::format("g{}\n", window));
    const wave::tui::Scale scale(f->window().begin, f->window().end - f->window().begin + 1,
                                 f.canvas().columns() - 8 - 6 - 3);
    for (std::size_t c = 0; c < scale.columns(); ++c) {
      const std::uint64_t first = scale.time(c), last = std::max(first, scale.first(c + 1) - 1);
      const bool expected = std::any_of(wrong.begin(), wrong.end(), [&](const Stretch& d) {
        return first <= d.end && last >= d.begin;
      });
      EXPECT_EQ(f.canvas().at(2, 16 + c).style.differs, expected) << window << " " << c;
    }
  }
}

TEST_F(Tui, WithoutASecondFile_DifferencesAreRefused) {
  Fake f = sample({"count"});
  EXPECT_TRUE(has(f.message_after("d"), "--diff OTHER.fst")) << f.all();
}

TEST_F(Tui, Blocks_AreReadOnlyWhenSeen) {
  write_blocks();
  Fake f(path("blocks.fst"), {"odd", "late"}, {250, 260}, 255);
  EXPECT_EQ(f->loads(), 2u);
  f.type("+-lhHL");
  EXPECT_EQ(f->loads(), 2u);
  f.type("w");
  EXPECT_EQ(f->loads(), 2u);
  f.type("g850\n");
  EXPECT_EQ(f->loads(), 4u);
  f.type("=");
  EXPECT_EQ(f->loads(), 2 * f->blocks());
}

/// Any keys on any screen: the window stays in the file, the cursor in the window, and the values
/// are the file's.
TEST_F(Tui, AnyKeysOnAnyScreen_KeepTheViewValid) {
  write_blocks();
  std::mt19937 random(3);
  const std::string keys = "hjkl0$HLwb+-=uczm'nNtT/fgayJKB^G?dDio\n\t ckotd:1*";
  const std::array<Key, 12> others = {key::kUp,   key::kDown,      key::kLeft,   key::kRight,
                                      key::kHome, key::kEnd,       key::kPageUp, key::kPageDown,
                                      key::kF1,   key::kBackspace, key::kEscape, key::kDelete};
  unsigned compared = 0;
  for (unsigned round = 0; round < 60; ++round) {
    Fake f(path("blocks.fst"), {"count:dec", "odd", "late"}, {}, 0);
    f.size(1 + random() % 120, 1 + random() % 40);
    for (unsigned i = 0; i < 100; ++i) {
      const Key k = random() % 4 == 0 ? others[random() % others.size()]
                                      : static_cast<Key>(keys[random() % keys.size()]);
      ASSERT_TRUE(f.press(k));
      ASSERT_LE(f->window().begin, f->window().end);
      ASSERT_LE(f->window().end, 999u);
      ASSERT_LE(f->cursor(), 999u);
      const std::string line = f.line("count");
      if (line.empty()) continue;
      const std::size_t value = line.find_first_not_of(' ', 5);
      const std::string shown = line.substr(value, line.find(' ', value) - value);
      // A signal that was added again is hexadecimal.
      ASSERT_TRUE(shown == fmt::to_string(f->cursor() / 10) ||
                  shown == fmt::format("{:04x}", f->cursor() / 10))
          << shown << "\n"
          << f.all();
      ++compared;
    }
  }
  EXPECT_GT(compared, 500u);
}

TEST_F(Tui, SmallAndLargeScreens_AreDrawn) {
  Fake f = sample({"*"});
  f.size(30, 5);
  EXPECT_EQ(f.row(0), "too small");
  EXPECT_TRUE(f.press(U'w'));
  EXPECT_FALSE((*f).press(U'q'));
  f.size(40, 7);
  EXPECT_TRUE(has(f.all(), "clk"));
  f.type("jjjjjj");
  EXPECT_TRUE(has(f.all(), "core.count"));
  f.size(200, 50);
  EXPECT_EQ(f.canvas().columns(), 200u);
  EXPECT_TRUE(has(f.line("data"), "7fc0000040600000")) << f.all();
}

TEST_F(Tui, Help_ListsAllKeys) {
  Fake f = sample({"clk"});
  f.size(80, 60);
  f.press(U'?');
  for (const char* words : {"previous change", "go to a time", "pci, bus", "--diff", "zoom in"})
    EXPECT_TRUE(has(f.all(), words));
  f.type("w");  // closes the help
  EXPECT_EQ(f->cursor(), 75u);
  EXPECT_NE(f.line("clk"), "");
  f.size(80, 24);
  f.press(key::kF1);
  EXPECT_FALSE(has(f.all(), "quit"));
  for (int i = 0; i < 40; ++i) f.type("j");
  EXPECT_TRUE(has(f.all(), "quit"));
}

/// Names may contain anything: they are shown and send no control codes to the terminal.
TEST_F(Tui, Names_SendNoControlCodes) {
  {
    Writer w(folder_ / "names.fst");
    w.scope("t\x1b[31mp");
    const fstHandle s = w.signal("a\x07\xff\x1b[2J", 8);
    w.time(0);
    w.set(s, 3);
    w.time(9);
    w.set(s, 4);
  }
  Fake f(path("names.fst"), {"*"}, {}, 0);
  f.type("a");
  for (const std::string& text : {f.all()})
    for (const char c : text) ASSERT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ');
  f.press(key::kEscape);
  EXPECT_TRUE(has(f.all(), "a\\x07\xc3\xbf\\x1b[2J"));
}

TEST_F(Tui, Keys_AreAnsweredAtOnce) {
  Fake f = sample({"*"}, {0, 195}, 0);
  std::vector<double> times;
  for (const char k : std::string("wlb+-=jkLHtn$0wwwwww")) {
    const auto begin = std::chrono::steady_clock::now();
    f.press(static_cast<Key>(k));
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
            .count());
  }
  std::sort(times.begin(), times.end());
  EXPECT_LT(times[times.size() / 2], 50);
}

}  // namespace
}  // namespace cde::testing
