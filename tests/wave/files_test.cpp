// SPDX-License-Identifier: Apache-2.0
// Files as other programs write them: VCD, packed and unclosed FST, and refused formats.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <nlohmann/json.hpp>
#include <random>

#include "../has.hpp"
#include "cde/support/error.hpp"
#include "cde/wave/trace.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

std::string big_endian(std::uint64_t word) {
  std::string bytes;
  for (unsigned i = 8; i-- > 0;) bytes.push_back(static_cast<char>(word >> (8 * i)));
  return bytes;
}

/// The text as a gzip stream.
std::string packed(const std::string& text) {
  z_stream z{};
  EXPECT_EQ(::deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string bytes(::deflateBound(&z, text.size()) + 64, '\0');
  std::string copy = text;
  z.next_in = reinterpret_cast<Bytef*>(copy.data());
  z.avail_in = static_cast<uInt>(copy.size());
  z.next_out = reinterpret_cast<Bytef*>(bytes.data());
  z.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(::deflate(&z, Z_FINISH), Z_STREAM_END);
  bytes.resize(bytes.size() - z.avail_out);
  ::deflateEnd(&z);
  return bytes;
}

class WaveFiles : public Cli {
 protected:
  /// Changes of a signal, as "TIME=VALUE TIME=VALUE".
  std::string changes(const std::string& file, const std::string& signal,
                      std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"wave", "show", file, signal, "--json", "--max", "0"});
    const Ran ran = cde(more);
    EXPECT_EQ(ran.status, 0) << ran.err;
    if (ran.status != 0) return ran.err;
    std::string text;
    const nlohmann::json all = nlohmann::json::parse(ran.out);
    for (const auto& c : all["signals"][0]["changes"])
      text += fmt::format("{}{}={}", text.empty() ? "" : " ", c["time"].dump(),
                          c["value"].get<std::string>());
    return text;
  }
  nlohmann::json info(const std::string& file) {
    const Ran ran = cde({"wave", "info", file, "--json"});
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.status == 0 ? nlohmann::json::parse(ran.out) : nlohmann::json();
  }
};

/// Blanks, sections and values as tools write them.
constexpr const char* kVcd = R"($date today $end
$version a tool$end
$timescale 10 ps $end
$comment fail 3 $end
$scope module top $end
$var wire 1 ! clk $end
$var wire 8 " count [7:0] $end
$var reg 4 # \odd+name! [3:0] $end
$var real 0 $ r $end
$var real 1 % state $end
$var event 1 & ev $end
$var wire 1 ' q [1] $end
$var wire 1 ( q [0] $end
$var wire 1 ) twin $end
$var wire 1 * twin $end
$var string 1 + s $end
$scope begin inner $end
$var wire 8 " count [7:0] $end
$upscope$end
$upscope $end
$enddefinitions $end
#0
$dumpvars
0! b0 " bx # r0 $ sIDLE % x& 0' 1( 0) 1* s %
$end
$comment anywhere $end
#1
1!
b101 "
bz1 #
r-1.5e3 $
sRUN %
1&
1'
#2
0!
$dumpoff
x!
bx "
$end
#4
$dumpon
0! b110 "
$end
stwo\x20words and more +
#5
1!
1&
)";

TEST_F(WaveFiles, Vcd_HasSignalsAndValues) {
  write("a.vcd", kVcd);
  EXPECT_EQ(changes("a.vcd", "top.clk"), "0=0 1=1 2=x 4=0 5=1");
  EXPECT_EQ(changes("a.vcd", "top.count"), "0=00 1=05 2=xx 4=06");
  EXPECT_EQ(changes("a.vcd", "inner.count"), "0=00 1=05 2=xx 4=06");
  EXPECT_EQ(changes("a.vcd", "top.\\odd+name! ", {"--as", "bin"}), "0=xxxx 1=zzz1");
  EXPECT_EQ(changes("a.vcd", "top.r"), "0=0 1=-1500");
  EXPECT_EQ(changes("a.vcd", "top.state"), "0= 1=RUN");
  EXPECT_EQ(changes("a.vcd", "top.s"), "0= 4=two words and more");
  EXPECT_EQ(changes("a.vcd", "q", {"--as", "bin"}), "0=01 1=11");
  EXPECT_EQ(changes("a.vcd", "q[0]"), "0=1");
  EXPECT_EQ(cde({"wave", "find", "a.vcd", "ev", "--count"}).out, "2\n");
  const nlohmann::json i = info("a.vcd");
  EXPECT_EQ(i["file_format"], "VCD");
  EXPECT_EQ(i["writer"], "a tool");
  EXPECT_EQ(i["closed"], true);
  EXPECT_EQ(i["comments"], nlohmann::json({"fail 3", "anywhere"}));
  EXPECT_EQ(i["blackouts"][0]["from"], 2);
  EXPECT_EQ(i["blackouts"][0]["to"], 4);
  EXPECT_NEAR(i["seconds_per_unit"].get<double>(), 1e-11, 1e-20);
}

TEST_F(WaveFiles, UndumpedTimes_AreMarkedInPicturesAndPages) {
  write("a.vcd", kVcd);
  ASSERT_EQ(cde({"wave", "export", "a.vcd", "-o", "a.svg"}).status, 0);
  EXPECT_TRUE(has(read("a.svg"), "<title>not dumped, 20ps to 40ps</title>"));
  ASSERT_EQ(cde({"wave", "serve", "a.vcd", "-o", "a.html"}).status, 0);
  EXPECT_TRUE(has(read("a.html"), "\"dark\":[[2,4]]"));
}

TEST_F(WaveFiles, VcdThroughAPipe_IsRead) {
  write("a.vcd", kVcd);
  const Ran ran = shell("cat a.vcd | \"$CDE\" wave at - 1 count");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "top.count  05"));
  EXPECT_EQ(shell("\"$CDE\" wave at <(cat a.vcd) 1 count").out, ran.out);
}

TEST_F(WaveFiles, BitsWrittenSeparately_AreOneVector) {
  write("a.vcd", kVcd);
  EXPECT_TRUE(has(cde({"wave", "ls", "a.vcd", "q"}).out, "2  wire  [1:0]"));
  EXPECT_TRUE(has(cde({"wave", "at", "a.vcd", "1", "q", "q[0]", "q[1]"}).out, "top.q     3"));
  EXPECT_EQ(cde({"wave", "export", "a.vcd", "q", "-o", "b.fst"}).status, 0);
  EXPECT_EQ(changes("b.fst", "q", {"--as", "bin"}), "0=01 1=11");
  EXPECT_EQ(cde({"wave", "export", "a.vcd", "q", "-o", "b.vcd"}).status, 0);
  EXPECT_EQ(changes("b.vcd", "q", {"--as", "bin"}), "0=01 1=11");
}

TEST_F(WaveFiles, SignalsOfOneName_AreBothReached) {
  write("a.vcd", kVcd);
  refused({"wave", "at", "a.vcd", "0", "top.twin"}, "ask for top.twin#1, top.twin#2");
  EXPECT_EQ(changes("a.vcd", "top.twin#1"), "0=0");
  EXPECT_EQ(changes("a.vcd", "twin#2"), "0=1");
  EXPECT_EQ(cde({"wave", "find", "a.vcd", "twin#2 == 1 && twin#1 == 0", "--count"}).out, "1\n");
}

TEST_F(WaveFiles, UndumpedTimes_AreNotCounted) {
  write("a.vcd", kVcd);
  const Ran ran = cde({"wave", "stat", "a.vcd", "clk", "top.count", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const nlohmann::json j = nlohmann::json::parse(ran.out);
  EXPECT_EQ(j["signals"][0]["change_count"], 2);  // at 1 and 5
  EXPECT_EQ(j["signals"][1]["change_count"], 1);
  EXPECT_NEAR(j["signals"][0]["share_at_one"].get<double>(), 1. / 3, 1e-9);
  EXPECT_TRUE(has(cde({"wave", "show", "a.vcd", "clk"}).out, "no dump from 20ps to 40ps"));
}

TEST_F(WaveFiles, UndumpedTimes_SurviveExports) {
  write("a.vcd", kVcd);
  for (const std::string other : {"b.fst", "b.vcd"}) {
    ASSERT_EQ(cde({"wave", "export", "a.vcd", "-o", other}).status, 0);
    EXPECT_EQ(info(other)["blackouts"], info("a.vcd")["blackouts"]) << other;
    EXPECT_EQ(changes(other, "top.clk"), "0=0 1=1 2=x 4=0 5=1") << other;
    EXPECT_EQ(cde({"wave", "diff", "a.vcd", other}).status, 0) << other;
  }
}

TEST_F(WaveFiles, Times_CountFromTimeZero) {
  std::string text = kVcd;
  text.insert(text.find("$scope"), "$timezero -2 $end\n");
  write("a.vcd", text);
  EXPECT_EQ(info("a.vcd")["time_zero"], -2);
  EXPECT_EQ(info("a.vcd")["from"], -2);
  EXPECT_TRUE(has(cde({"wave", "info", "a.vcd"}).out, "-20ps to 30ps"));
  EXPECT_EQ(changes("a.vcd", "top.count", {"--to", "-1"}), "-2=00 -1=05");
  EXPECT_TRUE(has(cde({"wave", "at", "a.vcd", "start+1", "clk"}).out, "at -10ps"));
  refused({"wave", "at", "a.vcd", "4", "clk"}, "outside of the file");
  for (const std::string other : {"b.fst", "b.vcd"}) {
    ASSERT_EQ(cde({"wave", "export", "a.vcd", "-o", other}).status, 0);
    EXPECT_EQ(changes(other, "top.count"), "-2=00 -1=05 0=xx 2=06") << other;
  }
  EXPECT_TRUE(has(cde({"wave", "export", "a.vcd", "clk", "--format", "csv"}).out, "\n-1,"));
}

TEST_F(WaveFiles, WrongVcd_IsRefusedWithItsLine) {
  const std::string head = "$timescale 1ns $end\n$var wire 2 ! a $end\n$enddefinitions $end\n";
  const std::vector<std::pair<std::string, std::string>> all = {
      {head + "#5\n0!\n#4\n1!\n", "v.vcd:6: time goes back from 5 to 4"},
      {head + "#0\n0?\n#1\n", "v.vcd:5: no signal has the identifier"},
      {head + "#0\nb0q1 !\n#1\n", "v.vcd:5: value"},
      {head + "#0\nb0111 !\n#1\n", "v.vcd:5: a value of 4 bits for a signal of 2"},
      {head + "#0\nrabc !\n#1\n", "v.vcd:5: 'abc' is not a number"},
      {head + "#x\n", "v.vcd:4: time 'x'"},
      {head + "#0\n$foo\n0!\n", "v.vcd:5: '$foo' among the changes"},
      {head + "#0\n?!\n0!\n", "v.vcd:5: '?!'; expected"},
      {"$timescale 1 ly $end\n", "v.vcd:1: $timescale '1ly'; expected 1, 10 or 100"},
      {"$scope module a $end\n$var wire 1 ! $end\n", "v.vcd:2: $var"},
      {"$var wire 99999999999 ! a $end\n", "v.vcd:1: $var of width"},
      {"$upscope $end\n", "v.vcd:1: $upscope ends a scope"},
      {"$date today $end\n", "v.vcd:2: the file ends in its header"},
      {"$date today\n", "expected $end"},
      {"$enddefinitions $end\n", "has no signals"}};
  for (const auto& [text, message] : all) {
    write("v.vcd", text);
    refused({"wave", "info", "v.vcd"}, message);
  }
}

/// Readers hold values of all signals, so a small file must not announce gigabytes.
TEST_F(WaveFiles, WidthsBeyondTheFilesSize_AreRefused) {
  const auto vcd = [&](unsigned signals, unsigned width) {
    std::string text;
    for (unsigned i = 0; i < signals; ++i)
      text += fmt::format("$var wire {} n{} s{} $end\n", width, i, i);
    write("v.vcd", text + "$enddefinitions $end\n#0\n#1\n");
  };
  vcd(10, 1u << 24);
  const auto size = std::filesystem::file_size(folder_ / "v.vcd");
  refused({"wave", "show", "v.vcd", "s0"},
          fmt::format("v.vcd:2: $var of width 16777216: all signals so far have {} bits together; "
                      "expected at most {} in a file of {} bytes",
                      1u << 25, (1u << 24) + 64 * size, size));
  for (const auto& [signals, width] : {std::pair(1u, 1u << 24), std::pair(1000u, 4096u)}) {
    vcd(signals, width);
    const Ran ran = cde({"wave", "info", "v.vcd"});
    EXPECT_EQ(ran.status, 0) << ran.err;
  }
  {
    Writer w(folder_ / "w.fst");
    std::vector<fstHandle> all;
    for (unsigned i = 0; i < 20; ++i) all.push_back(w.signal(fmt::format("s{}", i), 1u << 20));
    w.time(0);
    w.set(all[0], std::string(1u << 20, '1'));
    w.time(1);
  }
  const Ran honest = cde({"wave", "info", "w.fst"});
  EXPECT_EQ(honest.status, 0) << "its packed values are in the file: " << honest.err;
}

/// Each value is extended to the width of its signal, so a small file must not say it a million
/// times.
TEST_F(WaveFiles, ManyShortValuesOfAWideSignal_AreRefused) {
  const auto vcd = [&](unsigned changes) {
    std::string text = fmt::format("$var wire {} ! wide $end\n$enddefinitions $end\n", 1u << 24);
    for (unsigned i = 0; i < changes; ++i) text += fmt::format("#{}\nb1{} !\n", i, i % 2);
    write("v.vcd", text);
  };
  vcd(1000);
  refused({"wave", "show", "v.vcd", "wide"},
          "v.vcd:132: short values of signals of 8192 bits or more: extended to their signals' "
          "widths they gain ");
  vcd(60);
  const Ran ran = cde({"wave", "info", "v.vcd"});
  EXPECT_EQ(ran.status, 0) << ran.err;
}

/// A full name repeats the names of all enclosing scopes.
TEST_F(WaveFiles, LongNamesInDeepScopes_AreRefused) {
  const auto vcd = [&](unsigned deep) {
    std::string text;
    for (unsigned i = 0; i < deep; ++i)
      text +=
          fmt::format("$scope module {} $end\n$var wire 1 ! s{} $end\n", std::string(1000, 'a'), i);
    write("v.vcd", text + "$enddefinitions $end\n#0\n1!\n");
  };
  vcd(3000);
  refused({"wave", "info", "v.vcd"},
          "v.vcd: the full names of the first 968 signals have 469468758 bytes together; expected "
          "at most ");
  vcd(500);
  const Ran ran = cde({"wave", "info", "v.vcd"});
  EXPECT_EQ(ran.status, 0) << ran.err;
}

TEST_F(WaveFiles, PipeWithoutAWriterYet_IsWaitedFor) {
  write("v.vcd", kVcd);
  const Ran ran = shell("mkfifo p; \"$CDE\" wave info p & sleep 0.3; cat v.vcd >p; wait $!");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "VCD")) << ran.out;
}

TEST_F(WaveFiles, TruncatedVcd_IsReadToItsLastWholeLine) {
  const std::string text = kVcd;
  for (std::size_t n = text.find("$enddefinitions") + 20; n < text.size(); ++n) {
    write("a.vcd", text.substr(0, n));
    const Ran ran = cde({"wave", "at", "a.vcd", "start", "clk"});
    EXPECT_LE(ran.status, 2) << n;
    if (ran.status == 2) {
      EXPECT_TRUE(has(ran.err, "a.vcd")) << n;
    }
  }
  write("a.vcd", text + "b01");
  const nlohmann::json i = info("a.vcd");
  EXPECT_EQ(i["closed"], false);
  EXPECT_TRUE(has(i["ending"].get<std::string>(), "ends within line"));
}

/// Large enough that reading a window does not start at the beginning.
TEST_F(WaveFiles, WindowOfALongVcd_EqualsTheWhole) {
  std::string text =
      "$timescale 1ns $end\n$var wire 1 ! clk $end\n$var wire 32 # n $end\n"
      "$var wire 8 % rare $end\n$var event 1 & ev $end\n$enddefinitions $end\n";
  for (unsigned t = 0; t < 200000; ++t) {
    text += fmt::format("#{}\n{}!\nb{:b} #\n", t, t % 2, t);
    if (t % 50000 == 7) text += fmt::format("b{:b} %\n1&\n", t / 50000 + 1);
  }
  write("a.vcd", text);
  EXPECT_GT(info("a.vcd")["blocks"].get<int>(), 3);
  EXPECT_EQ(changes("a.vcd", "n", {"--from", "150000", "--to", "150001"}),
            "150000=000249f0 150001=000249f1");
  EXPECT_EQ(changes("a.vcd", "rare", {"--from", "149999", "--to", "150010"}),
            "149999=03 150007=04");
  EXPECT_EQ(changes("a.vcd", "ev", {"--from", "149999", "--to", "150010"}), "150007=1");
  EXPECT_EQ(cde({"wave", "find", "a.vcd", "n == 199999 && rare == 4", "--count"}).out, "1\n");
}

TEST_F(WaveFiles, PackedFst_EqualsThePlainOne) {
  write_sample(folder_ / "a.fst");
  const std::string plain = read("a.fst"), gz = packed(plain);
  const std::string head = '\xfe' + big_endian(gz.size() + 16);
  write("p.fst", head + big_endian(plain.size()) + gz);
  EXPECT_EQ(cde({"wave", "diff", "a.fst", "p.fst"}).status, 0);
  EXPECT_EQ(info("p.fst")["file_format"], "FST, packed in gzip");
  // The announced length limits the unpacked size.
  write("p.fst", head + big_endian(plain.size() - 1) + gz);
  refused({"wave", "info", "p.fst"}, "unpacks to more than");
  write("p.fst", head + big_endian(plain.size() + 1) + gz);
  refused({"wave", "info", "p.fst"}, "and announces");
  write("p.fst", head + big_endian(std::uint64_t{1} << 60) + gz);
  refused({"wave", "info", "p.fst"}, "more bytes than it can hold");
  for (std::size_t n = 1; n < gz.size(); n += 13) {
    write("p.fst", head + big_endian(plain.size()) + gz.substr(0, n));
    refused({"wave", "info", "p.fst"}, "p.fst: is cut off");
  }
}

/// A file of two blocks of changes as GTKWave's writer closes it, and the blocks in it.
class UnclosedFst : public WaveFiles {
 protected:
  void SetUp() override {
    WaveFiles::SetUp();
    write_model("w.fst", 8);
    whole_ = read("w.fst");
    while (whole_[changes_end_] == '\x08' || whole_[changes_end_] == '\x05')
      changes_end_ += 1 + word(changes_end_ + 1);
  }
  void write_model(const std::string& name, unsigned width) {
    Writer w(folder_ / name);
    w.scope("top");
    const fstHandle a = w.signal("a", width);
    w.signal("name", 1);
    w.up();
    for (unsigned t = 0; t < 30; ++t) {
      if (t % 10 == 0 && t != 0) w.block();
      w.time(t);
      w.set(a, t);
    }
  }
  [[nodiscard]] std::size_t word(std::size_t at) const {
    std::size_t n = 0;
    for (unsigned i = 0; i < 8; ++i) n = n << 8 | static_cast<unsigned char>(whole_[at + i]);
    return n;
  }
  /// As libfstwriter leaves a file when the simulation is killed.
  [[nodiscard]] std::string headless() const {
    return std::string(330, '\0') + whole_.substr(330, changes_end_ - 330);
  }
  std::string whole_;
  std::size_t changes_end_ = 330;
};

TEST_F(UnclosedFst, WithoutNames_SaysWhatIsMissing) {
  write("u.fst", headless());
  refused({"wave", "info", "u.fst"}, "blocks of changes can be read, but the names of the signals");
  refused({"wave", "info", "u.fst"}, "close that, and copy it to u.fst.hier");
  write("e.fst", "");
  refused({"wave", "info", "e.fst"}, "is empty: the simulation still runs, or was killed");
  write("z.fst", std::string(2000, '\0'));
  refused({"wave", "info", "z.fst"}, "is not an FST file");
}

TEST_F(UnclosedFst, WithoutHeader_TakesNamesOfAClosedFileOfTheModel) {
  write("u.fst", headless() + "\x08" + std::string(8, '\0') + "being written");
  write("u.fst.hier", whole_);
  const nlohmann::json i = info("u.fst");
  EXPECT_EQ(i["closed"], false);
  EXPECT_EQ(i["seconds_per_unit"], 1e-9);
  EXPECT_TRUE(has(i["ending"].get<std::string>(), "names are of u.fst.hier")) << i["ending"];
  EXPECT_TRUE(changes("u.fst", "top.a").starts_with("0=00 1=01 2=02"));
  EXPECT_EQ(cde({"wave", "at", "u.fst", "12", "top.a"}).out, "at 12ns\ntop.a  0c\n");
  write_model("other.fst", 9);
  write("u.fst.hier", read("other.fst"));
  refused({"wave", "info", "u.fst"}, "u.fst.hier must have the names of the same model");
  std::string open = whole_.substr(0, changes_end_);
  for (const std::size_t word : {9u, 17u, 57u}) open.replace(word, 8, 8, '\0');
  write("u.fst.hier", open);
  refused({"wave", "info", "u.fst"}, "has no names either");
}

TEST_F(UnclosedFst, WithNamesButWithoutHeader_IsRead) {
  write("u.fst", std::string(330, '\0') + whole_.substr(330));
  const nlohmann::json i = info("u.fst");
  EXPECT_EQ(i["closed"], false);
  EXPECT_TRUE(has(i["ending"].get<std::string>(), "the unit of time is not known")) << i["ending"];
  EXPECT_EQ(changes("u.fst", "top.a"), changes("w.fst", "top.a"));
}

/// An FST file of a running simulation: no counts, names in FILE.hier, and an unfinished block.
TEST_F(WaveFiles, UnclosedFst_IsReadToItsLastWholeBlock) {
  {
    Writer w(folder_ / "w.fst");
    w.scope("top");
    const fstHandle a = w.signal("a", 8);
    w.signal("name", 1);
    w.up();
    for (unsigned t = 0; t < 30; ++t) {
      if (t % 10 == 0 && t != 0) w.block();
      w.time(t);
      w.set(a, t);
    }
  }
  std::string whole = read("w.fst");
  // Complete blocks of changes, then one without a length.
  std::size_t at = 330;
  const auto length = [&](std::size_t from) {
    std::size_t n = 0;
    for (unsigned i = 0; i < 8; ++i) n = n << 8 | static_cast<unsigned char>(whole[from + 1 + i]);
    return n;
  };
  while (whole[at] == '\x08' || whole[at] == '\x05') at += 1 + length(at);
  whole.resize(at);
  for (const std::size_t word : {9u, 17u, 41u, 49u, 57u, 65u}) whole.replace(word, 8, 8, '\0');
  write("u.fst", whole + '\xff' + std::string(8, '\0') + "rest");
  refused({"wave", "info", "u.fst"}, "Most writers keep them in u.fst.hier until the end");
  using namespace std::string_literals;
  const std::string names = "\xfe\0top\0\0\x10\0a\0\x08\0\x10\0name\0\x01\0"s;
  write("u.fst.hier", names + "\x10\0cut"s);
  const nlohmann::json i = info("u.fst");
  EXPECT_EQ(i["closed"], false);
  EXPECT_TRUE(has(i["ending"].get<std::string>(), "u.fst.hier"));
  EXPECT_EQ(i["from"], 0);
  EXPECT_TRUE(changes("u.fst", "top.a").starts_with("0=00 1=01 2=02")) << changes("u.fst", "a");
  EXPECT_GE(i["to"].get<int>(), 9);
  // The names of another file do not fit.
  write("u.fst.hier", "\xfe\0top\0\0\x10\0a\0\x20\0"s);
  EXPECT_EQ(cde({"wave", "info", "u.fst"}).status, 2);
}

/// Signals with the same changes share bytes in a block, which becomes much larger than it is.
TEST_F(WaveFiles, ManySignalsWithTheSameChanges_AreRead) {
  {
    Writer w(folder_ / "same.fst");
    std::vector<fstHandle> all;
    for (unsigned i = 0; i < 100; ++i) all.push_back(w.signal(fmt::format("s{} [63:0]", i), 64));
    for (unsigned t = 0; t < 4000; ++t) {
      w.time(t);
      for (const fstHandle s : all) w.set(s, t % 2 == 0 ? ~std::uint64_t{0} : 0);
    }
  }
  EXPECT_EQ(cde({"wave", "find", "same.fst", "s0 == s99 && s1 == 0", "--count"}).out, "2000\n");
}

/// A block's table has one number for a run of signals without changes.
TEST_F(WaveFiles, RunsOfQuietSignals_AreCounted) {
  {
    Writer w(folder_ / "quiet.fst");
    const fstHandle busy = w.signal("busy", 1);
    for (unsigned i = 0; i < 199; ++i) (void)w.signal(fmt::format("quiet{}", i), 1);
    for (unsigned t = 0; t < 10; ++t) w.time(t), w.set(busy, t % 2);
  }
  EXPECT_EQ(wave::Trace(folder_ / "quiet.fst").signals().size(), 200u);
  // One quiet signal more than there are: the run is twice its length, in seven bits a byte.
  std::string bytes = read("quiet.fst");
  const std::size_t run = bytes.find("\x8e\x03");
  ASSERT_NE(run, std::string::npos);
  ASSERT_EQ(bytes.find("\x8e\x03", run + 1), std::string::npos);
  bytes[run] = '\x90';
  write("quiet.fst", bytes);
  try {
    const wave::Trace trace(folder_ / "quiet.fst");
    ADD_FAILURE() << "a run that is too long is read";
  } catch (const Error& e) {
    EXPECT_TRUE(has(e.what(), "has more signals than the file"));
  }
}

TEST_F(WaveFiles, FstNames_HaveAnyLength) {
  const std::string name(2000, 'n');
  {
    Writer w(folder_ / "n.fst");
    w.scope(std::string(700, 's'));
    const fstHandle a = w.signal(name + "a", 4), b = w.signal(name + "b", 4);
    w.up();
    w.time(0);
    w.set(a, 1);
    w.set(b, 2);
    w.time(1);
  }
  EXPECT_EQ(changes("n.fst", name + "a"), "0=1");
  EXPECT_EQ(changes("n.fst", name + "b"), "0=2");
}

TEST_F(WaveFiles, Latin1_IsShownAsUtf8) {
  std::string text = kVcd;
  text.replace(text.find("a tool"), 6,
               "Gr\xfc\xdf"
               "e");
  text.replace(text.find("RUN"), 3, "L\xc4UFT");
  write("a.vcd", text);
  EXPECT_EQ(info("a.vcd")["writer"], "Grüße");
  EXPECT_EQ(changes("a.vcd", "top.state"), "0= 1=LÄUFT");
}

TEST_F(WaveFiles, OtherFormats_AreRefusedByName) {
  write("a.bin", "GHDLwave\n........");
  refused({"wave", "info", "a.bin"},
          "is GHW of GHDL, which cde cannot read; let GHDL write `--fst=FILE`");
  write("a.fsdb", "binary");
  refused({"wave", "info", "a.fsdb"}, "is FSDB of Verdi, which cde cannot read; `fsdb2vcd");
  write("a.wlf", "binary");
  refused({"wave", "info", "a.wlf"}, "`wlf2vcd");
  write("a.vcd.gz", packed(kVcd));
  refused({"wave", "info", "a.vcd.gz"}, "`gzip -dc FILE | cde wave COMMAND -` reads it");
}

TEST_F(WaveFiles, DamagedVcd_IsReadOrRefused) {
  std::mt19937 random(20);
  const std::string whole = kVcd;
  unsigned refused = 0, read_anyway = 0;
  for (unsigned i = 0; i < 4000; ++i) {
    std::string text = whole;
    for (unsigned k = 0; k < 1 + i % 4; ++k) {
      const std::size_t at = random() % text.size();
      if (i % 5 == 4)
        text.erase(at, random() % 20);
      else
        text[at] = static_cast<char>(i % 3 == 0 ? random() : ' ' + random() % 95);
    }
    write("d.vcd", text);
    try {
      wave::Trace trace(folder_ / "d.vcd");
      std::vector<std::uint32_t> handles;
      for (const wave::Signal& s : trace.signals()) handles.push_back(s.handle);
      std::uint64_t last = 0;
      trace.stream(handles, trace.start(), trace.end(),
                   [&](std::uint64_t time, std::uint32_t, std::string_view) {
                     EXPECT_GE(time, last);
                     last = time;
                     return true;
                   });
      ++read_anyway;
    } catch (const Error& e) {
      EXPECT_TRUE(has(e.what(), "d.vcd")) << text;
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(read_anyway, 500u);
}

}  // namespace
}  // namespace cde::testing
