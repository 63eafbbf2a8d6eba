// SPDX-License-Identifier: Apache-2.0
// cde wave export: the output has the same values as its FST file.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "../has.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/trace.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

using Json = nlohmann::json;
/// Values of signals by name and time, without repetitions of a value.
using Story = std::map<std::string, std::map<std::uint64_t, std::string>>;

void tell(Story& story, const std::string& name, std::uint64_t time, const std::string& value) {
  auto& own = story[name];
  if (!own.empty() && own.rbegin()->first != time && own.rbegin()->second == value) return;
  own[time] = value;
}

/// Reads a window with the project's own reader.
Story story_of(const std::filesystem::path& file, std::uint64_t from, std::uint64_t to) {
  wave::Trace trace(file);
  std::map<std::uint32_t, std::vector<std::string>> names;
  std::vector<std::uint32_t> handles;
  for (const wave::Signal& s : trace.signals()) {
    names[s.handle].push_back(s.name);
    handles.push_back(s.handle);
  }
  Story story;
  trace.stream(handles, from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view v) {
                 for (const std::string& name : names[handle])
                   tell(story, name, time, std::string(v));
                 return true;
               });
  return story;
}

/// Reads VCD with a reader that only this test uses.
Story story_of_vcd(const std::string& text) {
  std::istringstream in(text);
  std::map<std::string, std::vector<std::string>> names;  // by code
  std::map<std::string, std::size_t> widths;
  std::vector<std::string> scopes;
  Story story;
  std::uint64_t time = 0;
  const auto change = [&](const std::string& code, std::string value, bool bits) {
    ASSERT_TRUE(names.contains(code)) << code;
    if (bits && value.size() < widths[code])
      value.insert(0, widths[code] - value.size(), value[0] == '1' ? '0' : value[0]);
    for (const std::string& name : names[code]) tell(story, name, time, value);
  };
  std::string word;
  const auto skip = [&] {
    while (in >> word && word != "$end") {
    }
  };
  while (in >> word) {
    if (word == "$scope") {
      std::string kind, name;
      in >> kind >> name;
      scopes.push_back(name);
      skip();
    } else if (word == "$upscope") {
      scopes.pop_back();
      skip();
    } else if (word == "$var") {
      std::string kind, width, code, name, full;
      in >> kind >> width >> code >> name;
      for (const std::string& s : scopes) full += s + ".";
      names[code].push_back(full + name);
      widths[code] = std::stoul(width);
      skip();
    } else if (word == "$dumpvars" || word == "$end") {
      continue;
    } else if (word[0] == '$') {
      skip();
    } else if (word[0] == '#') {
      const auto next = std::stoull(word.substr(1));
      EXPECT_TRUE(story.empty() || next > time) << word;
      time = next;
    } else if (word[0] == 'b' || word[0] == 'r' || word[0] == 's') {
      std::string code;
      in >> code;
      change(code, word.substr(1), word[0] == 'b');
    } else {
      change(word.substr(1), word.substr(0, 1), true);
    }
  }
  EXPECT_TRUE(scopes.empty());
  return story;
}

class Export : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
  }
  std::string out(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "export"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  }
  std::string error(std::vector<std::string> words) {
    words.insert(words.begin(), {"wave", "export"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran.err;
  }
  /// Every kind of signal and value, in two blocks, in units of 10 ps.
  void write_kinds() {
    const auto file = folder_ / "kinds.fst";
    void* const fst = fstWriterCreate(file.c_str(), 1);
    fstWriterSetTimescale(fst, -11);
    fstWriterSetComment(fst, "fail 40");
    fstWriterSetComment(fst, "a comment with $end in it");
    fstWriterSetScope(fst, FST_ST_VCD_MODULE, "top", "card");
    const char* names[] = {"IDLE", "BUSY"};
    const char* values[] = {"0", "1"};
    const auto table = fstWriterCreateEnumTable(fst, "state_t", 2, 1, names, values);
    const auto wide =
        fstWriterCreateVar(fst, FST_VT_SV_LOGIC, FST_VD_OUTPUT, 200, "wide [199:0]", 0);
    fstWriterSetScope(fst, FST_ST_VCD_GENERATE, "row[1]", nullptr);
    fstWriterEmitEnumTableRef(fst, table);
    const auto state = fstWriterCreateVar(fst, FST_VT_SV_ENUM, FST_VD_IMPLICIT, 1, "state", 0);
    (void)fstWriterCreateVar(fst, FST_VT_VCD_WIRE, FST_VD_INPUT, 200, "same [199:0]", wide);
    fstWriterSetUpscope(fst);
    fstWriterSetScope(fst, FST_ST_VCD_STRUCT, "empty", nullptr);
    fstWriterSetUpscope(fst);
    const auto real = fstWriterCreateVar(fst, FST_VT_VCD_REAL, FST_VD_IMPLICIT, 8, "real", 0);
    const auto bits = fstWriterCreateVar(fst, FST_VT_VCD_REG, FST_VD_IMPLICIT, 5, "bits [0:4]", 0);
    const auto late = fstWriterCreateVar(fst, FST_VT_VCD_REG, FST_VD_IMPLICIT, 9, "late [8:0]", 0);
    fstWriterSetUpscope(fst);
    const std::array<std::string, 8> five = {"00000", "0x001", "x0000", "zzzzz",
                                             "0000z", "10000", "00x00", "00001"};
    for (unsigned t = 0; t < 80; ++t) {
      fstWriterEmitTimeChange(fst, t);
      std::string value(200, '0');
      for (unsigned i = 0; i < 200; ++i)
        if ((t * 7 + i * i) % 11 < t % 5) value[i] = '1';
      if (t % 3 == 0) fstWriterEmitValueChange(fst, wide, value.c_str());
      if (t % 4 == 1) fstWriterEmitValueChange(fst, state, t % 8 == 1 ? "1" : "0");
      fstWriterEmitValueChange(fst, bits, five[t % 8].c_str());
      const double number = t / 3.0 - 1e-9 * t;
      if (t % 2 == 0) fstWriterEmitValueChange(fst, real, &number);
      if (t == 60) fstWriterEmitValueChange(fst, late, "000000101");
      if (t == 30) fstWriterFlushContext(fst);
    }
    fstWriterClose(fst);
  }
};

TEST_F(Export, Vcd_HasTheSameValues) {
  write_kinds();
  for (const std::string file : {"a.fst", "kinds.fst"}) {
    const std::uint64_t end = wave::Trace(folder_ / file).end();
    (void)out({file, "--output", "o.vcd"});
    Story expected = story_of(folder_ / file, 0, end);
    // VCD has no notation for a real without a value.
    std::erase_if(expected["top.real"], [](const auto& e) { return e.second[0] == 'x'; });
    if (expected["top.real"].empty()) expected.erase("top.real");
    EXPECT_EQ(story_of_vcd(read("o.vcd")), expected) << file;
  }
  EXPECT_TRUE(has(read("o.vcd"), "$timescale 10 ps $end"));
  // A window of some signals, to stdout.
  const std::string text =
      out({"kinds.fst", "bits", "wide", "--from", "25", "--to", "55", "--format", "vcd"});
  Story window = story_of(folder_ / "kinds.fst", 25, 55);
  std::erase_if(window,
                [](const auto& e) { return e.first != "top.bits" && e.first != "top.wide"; });
  EXPECT_EQ(story_of_vcd(text), window);
}

TEST_F(Export, CutFst_HasTheSameValuesInItsWindow) {
  write_kinds();
  (void)out({"kinds.fst", "-o", "cut.fst", "--from", "20", "--to", "67"});
  EXPECT_EQ(story_of(folder_ / "cut.fst", 20, 67), story_of(folder_ / "kinds.fst", 20, 67));
  wave::Trace cut(folder_ / "cut.fst"), whole(folder_ / "kinds.fst");
  EXPECT_EQ(cut.start(), 20u);
  EXPECT_EQ(cut.end(), 67u);
  EXPECT_EQ(cut.scale(), -11);
  EXPECT_EQ(cut.comments(), whole.comments());
  ASSERT_EQ(cut.signals().size(), whole.signals().size());
  EXPECT_EQ(cut.handles(), whole.handles());
  for (std::size_t i = 0; i < cut.signals().size(); ++i) {
    const wave::Signal &a = cut.signals()[i], &b = whole.signals()[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.width, b.width) << a.name;
    EXPECT_EQ(a.left, b.left) << a.name;
    EXPECT_STREQ(a.kind, b.kind) << a.name;
    EXPECT_STREQ(a.direction, b.direction) << a.name;
  }
  const Ran same = cde({"wave", "diff", "kinds.fst", "cut.fst"});
  EXPECT_EQ(same.status, 0) << same.out;
  // The whole file: `diff` would find any other value.
  (void)out({"a.fst", "-o", "all.fst"});
  EXPECT_EQ(cde({"wave", "diff", "a.fst", "all.fst"}).out, "0 of 6 signals differ\n");
  write_sample(folder_ / "b.fst", {.late = 0, .wrong_at = 9});
  EXPECT_EQ(cde({"wave", "diff", "b.fst", "all.fst"}).status, 1);
  // The fail time of the source file stays.
  (void)out({"a.fst", "top.core", "data", "-o", "fail.fst", "--around", "fail", "--window", "2"});
  EXPECT_EQ(cde({"wave", "at", "fail.fst", "fail", "count:dec"}).out,
            "at 75ns\ntop.core.count  7\n");
}

TEST_F(Export, Csv_HasARowPerChangeOrCycle) {
  EXPECT_EQ(out({"a.fst", "count:dec", "data[0]:fp32", "state", "--to", "30", "--format", "csv"}),
            "time,cycle,top.count,top.data[0],top.state\n"
            "0,,x,x,x\n"
            "5,0,0,0,x\n"
            "15,1,1,0.5,x\n"
            "25,2,2,1,x\n");
  // The values that flip-flops see at the edges, as with `find --on`.
  EXPECT_EQ(out({"a.fst", "count:dec", "valid", "--on", "posedge clk", "--from", "40", "--to", "70",
                 "--format", "csv"}),
            "time,cycle,top.count,top.valid\n"
            "45,4,3,1\n"
            "55,5,4,0\n"
            "65,6,5,1\n");
  {
    Writer w(folder_ / "odd.fst");
    w.scope("top");
    const fstHandle odd = w.signal("a,\"b\"", 4);
    w.time(0);
    w.set(odd, 5);
    w.time(1);
  }
  EXPECT_EQ(out({"odd.fst", "--format", "csv"}), "time,\"top.a,\"\"b\"\"\"\n0,5\n");
}

TEST_F(Export, WaveDrom_HasAColumnPerCycle) {
  (void)out({"a.fst", "clk", "count:dec", "valid", "state", "top.core", "-o", "o.json"});
  const Json j = Json::parse(read("o.json"));
  ASSERT_EQ(j["signal"].size(), 2u);  // one group per scope
  EXPECT_EQ(j["signal"][0][0], "top");
  EXPECT_EQ(j["signal"][1][0], "top.core");
  EXPECT_EQ(j["signal"][0][1], Json({{"name", "clk"}, {"wave", "0p..................."}}));
  const Json count = j["signal"][0][2];
  EXPECT_EQ(count["wave"], "x====================");
  ASSERT_EQ(count["data"].size(), 20u);
  EXPECT_EQ(count["data"][19], "19");
  EXPECT_EQ(j["signal"][0][3]["wave"], "x01..01..01..01..01..");
  EXPECT_EQ(j["signal"][0][4]["wave"], "x...=================");
  const Json window = Json::parse(
      out({"a.fst", "count:dec", "--around", "cyc:7", "--window", "1", "--format", "wavedrom"}));
  EXPECT_EQ(window["signal"][0]["wave"], "===");
  EXPECT_EQ(window["signal"][0]["data"], Json::array({"6", "7", "8"}));
  EXPECT_EQ(window["head"]["tick"], 6);
  write_large(folder_ / "long.fst", 10, 6000, 1);
  EXPECT_TRUE(has(error({"long.fst", "s0", "-o", "long.json"}), "columns"));
  EXPECT_FALSE(exists("long.json"));
}

/// Whether every XML element is closed, in the right order.
bool balanced(const std::string& text) {
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    const std::size_t stop = text.find('>', at);
    if (stop == std::string::npos) return false;
    const std::string tag = text.substr(at + 1, stop - at - 1);
    at = stop;
    if (tag.ends_with('/')) continue;
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty();
}

TEST_F(Export, Svg_DrawsValuesAndTheFailure) {
  (void)out({"a.fst", "clk", "data[1]:fp32", "state", "count:dec", "-o", "o.svg"});
  const std::string svg = read("o.svg");
  EXPECT_TRUE(balanced(svg));
  EXPECT_EQ(svg.find("http"),
            svg.find("http://www.w3.org/2000/svg"));  // nothing is loaded from elsewhere
  EXPECT_EQ(svg.find("http", svg.find("http") + 4), std::string::npos);
  for (const char* part : {">fail<", ">nan<", ">18<", "class=\"unknown\"", ">data[1]<", "bus odd"})
    EXPECT_TRUE(has(svg, part));
  // Two edges per cycle are drawn as a line of a bit; too many for the space are drawn as a block.
  EXPECT_FALSE(has(svg, "class=\"busy\""));
  write_large(folder_ / "long.fst", 10, 6000, 1);
  const std::string busy = out({"long.fst", "clk", "s1", "--format", "svg", "--columns", "60"});
  EXPECT_TRUE(has(busy, "class=\"busy\""));
  EXPECT_TRUE(has(busy, "width=\"480\""));
  EXPECT_LT(busy.size(), 60000u);  // for any number of changes
  {
    Writer w(folder_ / "odd.fst");
    w.scope("a<b>&\"c\"");
    const fstHandle odd = w.signal("x</svg>", 4);
    w.time(0);
    w.set(odd, 5);
    w.time(10);
  }
  EXPECT_TRUE(balanced(out({"odd.fst", "--format", "svg"})));
}

TEST_F(Export, Gtkw_HasGroupsFormatsAndTheMarker) {
  (void)out(
      {"a.fst", "clk", "count:signed", "data:fp32", "data[1]:fp32", "top.core", "-o", "o.gtkw"});
  const std::string text = read("o.gtkw");
  EXPECT_TRUE(has(text, "[dumpfile] \"" + (folder_ / "a.fst").string() + "\"\n"));
  EXPECT_TRUE(has(text, " 75 75 -1"));
  EXPECT_TRUE(has(text, "[markername] Afail\n"));
  EXPECT_TRUE(has(text, "@800200\n-top\n@28\ntop.clk\n@424\ntop.count[7:0]\n"));
  EXPECT_TRUE(has(
      text, "@22\ntop.data[63:0]\n@40020\n#{top.data[0]} (32)top.data[63:0] (33)top.data[63:0]"));
  EXPECT_TRUE(has(text, "@40020\n#{top.data[1]} (0)top.data[63:0]"));
  EXPECT_TRUE(has(
      text, "@1000200\n-top\n@800200\n-top.core\n@22\ntop.core.count[7:0]\n@1000200\n-top.core\n"));
  // As a failure package calls it: another wave file, and no fail time in this one.
  wave::Trace trace(folder_ / "a.fst");
  const std::vector<wave::View> views = {wave::view(trace, "count", {})};
  wave::write_gtkw(trace, views, {.fail = 33, .waves = folder_ / "cut.fst"}, folder_ / "p.gtkw");
  EXPECT_TRUE(has(read("p.gtkw"), "/cut.fst\"\n"));
  EXPECT_TRUE(has(read("p.gtkw"), " 33 33 -1"));
}

/// GTKWave counts times of 10 ps in ps, and adds $timezero itself where it shows a time.
TEST_F(Export, TimesOfGtkw_AreThoseOfGtkwave) {
  write("t.vcd",
        "$timescale 10 ps $end\n$timezero -2 $end\n$comment fail 3 $end\n"
        "$var wire 1 ! a $end\n$enddefinitions $end\n#1\n0!\n#3\n1!\n#9\n0!\n");
  ASSERT_EQ(cde({"wave", "export", "t.vcd", "-o", "t.gtkw"}).status, 0);
  EXPECT_TRUE(has(read("t.gtkw"), "[timestart] 10\n")) << read("t.gtkw");
  EXPECT_TRUE(has(read("t.gtkw"), " 30 30 -1")) << read("t.gtkw");
}

/// Names and texts of a file send no control codes to a terminal that shows the output, and start
/// no line.
TEST_F(Export, Names_SendNoControlCodes) {
  {
    Writer w(folder_ / "names.fst");
    w.comment("\x1b[2J\xc2\x9b");
    w.scope("t\x1b[31mp");
    (void)w.signal("b\x7f\xc2\x9b\xe2\x80\xae", 1);
    const fstHandle s = w.signal("a\x07\n@28\x1b[2J", 8);
    w.time(0);
    w.set(s, 3);
    w.time(9);
    w.set(s, 4);
  }
  for (const std::string name : {"names.csv", "names.gtkw", "names.vcd", "names.svg"}) {
    SCOPED_TRACE(name);
    const Ran ran = cde({"wave", "export", "names.fst", "-o", name});
    ASSERT_EQ(ran.status, 0) << ran.err;
    const std::string text = read(name);
    for (const char c : text)
      ASSERT_TRUE(c == '\n' || c == '\t' || static_cast<unsigned char>(c) >= ' ')
          << static_cast<int>(c);
    for (const char* control : {"\x7f", "\xc2\x9b", "\xe2\x80\xae"})
      EXPECT_FALSE(has(text, control)) << text;
  }
  EXPECT_TRUE(has(read("names.csv"), "\\x1b[2J"));
  ASSERT_EQ(cde({"wave", "export", "names.fst", "-o", "copy.fst"}).status, 0);
  wave::Trace copy(folder_ / "copy.fst");
  ASSERT_EQ(copy.signals().size(), 2u);
  EXPECT_EQ(copy.signals()[0].name, "t\\x1b[31mp.b\\x7f\\x9b\\u202e");
  EXPECT_EQ(copy.signals()[1].name, "t\\x1b[31mp.a\\x07\\x0a@28\\x1b[2J");
  EXPECT_EQ(copy.comments(), std::vector<std::string>{"\\x1b[2J\\x9b"});
  EXPECT_TRUE(has(read("names.vcd"), "b\\x7f\\x9b\\u202e"));
  EXPECT_TRUE(has(read("names.vcd"), "$comment \\x1b[2J\\x9b $end"));
  EXPECT_FALSE(has(read("names.gtkw"), "\n@28\x1b"));
}

TEST_F(Export, Files_AreCompleteOrAbsent) {
  write_large(folder_ / "large.fst", 200, 2000, 50);
  const std::set<std::string> before = {"a.fst", "large.fst", "old.vcd"};
  write("old.vcd", "as it was");
  for (const std::string name : {"o.vcd", "o.csv", "o.fst", "old.vcd"}) {
    const FileLimit limit(20000);
    (void)error({"large.fst", "-o", name});
  }
  const auto names = files();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), before);
  EXPECT_EQ(read("old.vcd"), "as it was");
  (void)error({"a.fst", "-o", "no/such/folder.vcd"});
  // A corrupt file leaves no output either.
  std::string bytes = read("large.fst");
  for (std::size_t at = bytes.size() / 2; at < bytes.size() / 2 + 400; ++at) bytes[at] ^= 0x5a;
  write("bad.fst", bytes);
  const Ran ran = cde({"wave", "export", "bad.fst", "-o", "bad.vcd"});
  if (ran.status != 0) {
    for (const std::string& name : files()) EXPECT_FALSE(name.starts_with("bad.vcd")) << name;
  }
}

TEST_F(Export, InvalidUsage_IsRefused) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"a.fst", "-o", "a.fst"}, "would write to a.fst"},
      {{"a.fst", "-o", "o.txt"}, "must end in .vcd"},
      {{"a.fst"}, "needs --output"},
      {{"a.fst", "-o", "o.vcd", "--on", "posedge clk"},
       "--on cannot be combined with --format vcd; expected csv"},
      {{"a.fst", "-o", "o.csv", "--columns", "80"},
       "--columns cannot be combined with --format csv; expected svg"},
      {{"a.fst", "-o", "o.csv", "--on", "posedge count"}, "8 bits"},
      {{"a.fst", "-o", "o.csv", "--on", "posedge "}, "posedge SIGNAL"},
      {{"a.fst", "cuont", "-o", "o.vcd"}, "did you mean"},
      {{"a.fst", "data[3:0]", "-o", "o.vcd"}, "whole signals"},
      {{"a.fst", "data[3:0]", "-o", "o.fst"}, "whole signals"},
      {{"a.fst", "-o", "o.svg", "--from", "5us"}, "outside"},
      {{"a.fst", "--format", "vcd", "--json"}, "both go to stdout"},
      {{"a.fst", "-o", "o.vcd", "--format", "pdf"}, "pdf"},
      {{"nothing.fst", "-o", "o.vcd"}, "nothing.fst"}};
  for (const auto& [words, part] : wrong) EXPECT_TRUE(has(error(words), part));
  EXPECT_EQ(files(), std::vector<std::string>{"a.fst"});
  const Ran ran = cde({"wave", "export", "a.fst", "count", "-o", "o.vcd", "--json"});
  const Json j = Json::parse(ran.out);
  EXPECT_EQ(j["schema"], "cde.wave.export.1");
  EXPECT_EQ(j["written"], "o.vcd");
  EXPECT_EQ(j["written_as"], "vcd");
  EXPECT_EQ(j["signals"], 1);
}

}  // namespace
}  // namespace cde::testing
