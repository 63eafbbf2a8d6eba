// SPDX-License-Identifier: Apache-2.0
// Small files that ask for gigabytes or minutes: limits of memory and of processor time.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

class WaveLimits : public Cli {
 protected:
  /// A wave file of `signals` signals that all change in each of `times` units of time. FST packs
  /// equal changes.
  void write_equal_changes(const std::string& name, unsigned signals, unsigned times) {
    Writer w(folder_ / name);
    std::vector<fstHandle> all;
    for (unsigned i = 0; i < signals; ++i) all.push_back(w.signal(fmt::format("s{}", i), 1));
    for (unsigned t = 0; t < times; ++t) {
      w.time(t);
      for (const fstHandle s : all) w.set(s, t & 1);
    }
  }
};

/// Offset of the first block of an FST file that is none of `skipped`.
std::size_t block_after(const std::string& fst, const std::string& skipped) {
  std::size_t at = 0;
  while (at + 9 < fst.size() && skipped.find(fst[at]) != std::string::npos) {
    std::size_t length = 0;
    for (unsigned i = 0; i < 8; ++i)
      length = length << 8 | static_cast<unsigned char>(fst[at + 1 + i]);
    at += 1 + length;
  }
  return at;
}

const std::string kHeader(1, '\0'), kChanges = "\x01\x05\x08", kNames = "\x04\x06\x07";

/// A sequence of LZ4: bytes of which the last one repeats `times` more times.
std::string repeated(const std::string& bytes, std::size_t times) {
  const std::size_t count = bytes.size(), more = times - 4;
  const auto token = static_cast<char>(std::min<std::size_t>(count, 15) << 4 | 15);
  std::string text(1, token);
  if (count >= 15) text += std::string((count - 15) / 255, '\xff') + char((count - 15) % 255);
  text += bytes + std::string("\1\0", 2);
  return text + std::string((more - 15) / 255, '\xff') + static_cast<char>((more - 15) % 255);
}

std::string last_bytes(const std::string& bytes) {
  return static_cast<char>(bytes.size() << 4) + bytes;
}

std::string big_endian(std::uint64_t word) {
  std::string bytes;
  for (unsigned i = 8; i-- > 0;) bytes.push_back(static_cast<char>(word >> (8 * i)));
  return bytes;
}

/// A block of names with one scope whose name has 1 GB, packed twice.
std::string names_of_a_gigabyte() {
  constexpr std::size_t kBytes = 1'000'000'000;
  const std::string before("\xfe\0a", 3), after("aaaaaa\0\0\xff", 9);
  const std::string once =
      repeated(before, kBytes - before.size() - after.size()) + last_bytes(after);
  const std::size_t run = once.find('\xff', 1), rest = once.size() - 12;
  std::string size;  // in LEB128
  for (std::size_t left = once.size(); left != 0; left >>= 7)
    size.push_back(static_cast<char>((left & 127) | (left >= 128 ? 128 : 0)));
  const std::string twice =
      repeated(once.substr(0, run + 1), rest - run - 1) + last_bytes(once.substr(rest));
  const std::string body = big_endian(kBytes) + size + twice;
  return '\x07' + big_endian(8 + body.size()) + body;
}

TEST_F(WaveLimits, NamesOfFst_FollowTheFilesSize) {
  write_sample(folder_ / "a.fst");
  const std::string whole = read("a.fst");
  const std::size_t at = block_after(whole, kHeader + kChanges + "\x02\x03");
  ASSERT_NE(kNames.find(whole.at(at)), std::string::npos);
  write("b.fst", whole.substr(0, at) + names_of_a_gigabyte());
  const Ran ran = shell("ulimit -v 1000000 && \"$CDE\" wave ls b.fst");
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "has names that do not fit")) << ran.err;
}

/// Names beside an unclosed file that are a hole of 3 GB.
TEST_F(WaveLimits, NamesBesideAWaveFile_FollowItsSize) {
  write_sample(folder_ / "a.fst");
  const std::string whole = read("a.fst");
  std::string open = whole.substr(0, block_after(whole, kHeader + kChanges));
  for (const std::size_t word : {9u, 17u, 49u, 57u}) open.replace(word, 8, 8, '\0');
  write("u.fst", open);
  write("u.fst.hier", std::string("\xfe\x00", 2));
  fs::resize_file(folder_ / "u.fst.hier", std::uintmax_t{3} << 30);
  const Ran ran = shell("ulimit -v 2000000 -t 5 && \"$CDE\" wave info u.fst");
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "u.fst.hier: has 3221225472 bytes; at most ")) << ran.err;
}

/// A structure with arrays of 2^30 elements, none of which is in the waves.
TEST_F(WaveLimits, HugePackedTypes_AreWalkedInPart) {
  write("t.vcd",
        "$timescale 1ns $end\n$scope module t $end\n$var wire 1 ! x $end\n$var wire 1 # y $end\n"
        "$upscope $end\n$enddefinitions $end\n#0\n0!\n1#\n#5\n1!\n0#\n");
  std::string text =
      "<verilator_xml><files><file id=\"c\" filename=\"t.sv\"/></files><cells></cells><netlist>"
      "<module loc=\"c,1,1,1,2\" name=\"t\" topModule=\"1\" origName=\"t\">"
      "<var loc=\"c,1,1,1,2\" name=\"x\" dtype_id=\"1\" dir=\"input\" pinIndex=\"1\"/>"
      "<var loc=\"c,1,1,1,2\" name=\"y\" dtype_id=\"1\" dir=\"output\" pinIndex=\"2\"/>";
  for (unsigned i = 0; i < 10; ++i)
    text += fmt::format("<var loc=\"c,1,1,1,2\" name=\"h{}\" dtype_id=\"2\"/>", i);
  text +=
      "<contassign loc=\"c,1,1,1,2\"><redxor dtype_id=\"1\"><concat "
      "dtype_id=\"1\"><varref name=\"x\" dtype_id=\"1\"/>";
  for (unsigned i = 0; i < 10; ++i) text += fmt::format("<varref name=\"h{}\" dtype_id=\"2\"/>", i);
  text +=
      "</concat></redxor><varref name=\"y\" dtype_id=\"1\"/></contassign></module><typetable>"
      "<basicdtype id=\"1\" name=\"logic\"/><packarraydtype id=\"2\" sub_dtype_id=\"1\"><range>"
      "<const name=\"32&apos;sh3fffffff\" dtype_id=\"3\"/><const name=\"32&apos;sh0\" "
      "dtype_id=\"3\"/></range></packarraydtype><basicdtype id=\"3\" name=\"logic\" "
      "left=\"31\" right=\"0\"/></typetable></netlist></verilator_xml>";
  write("t.xml", text);
  const Ran ran = shell("ulimit -t 10 && \"$CDE\" wave why t.vcd y@5 --structure t.xml");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "t.y is 0 at 5ns")) << ran.out;
}

TEST_F(WaveLimits, MemoryBeyondTheLimit_IsRefused) {
  std::string text;
  for (unsigned i = 0; i < 100'000; ++i) text += fmt::format("$var wire 1 s{0} s{0} $end\n", i);
  write("a.vcd", text + "$enddefinitions $end\n#0\n0s0\n");
  const std::vector<std::string> ls = {"wave", "ls", "a.vcd"};
  EXPECT_EQ(cde(ls).status, 0);
  const Ran ran = cde(ls, {"CDE_READ_MEMORY=10"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err,
            "cde: a.vcd: takes more than 10 MB to read; the file is probably damaged "
            "(CDE_READ_MEMORY sets another limit)\n");
  const Ran bad = cde(ls, {"CDE_READ_MEMORY=1.5"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(has(bad.err, "CDE_READ_MEMORY is '1.5'; it must be a whole number")) << bad.err;
}

/// The unfinished output is removed.
TEST_F(WaveLimits, TimeBeyondTheLimit_IsRefused) {
  write_equal_changes("a.fst", 500, 100'000);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"wave", "export", "a.fst", "-o", "a.vcd"},
        {"wave", "diff", "a.fst", "a.fst"}}) {
    const Ran ran = cde(words, {"CDE_READ_SECONDS=1"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err,
              "cde: a.fst: not read within 1 s; the file is probably damaged (CDE_READ_SECONDS "
              "sets another limit)\n");
  }
  EXPECT_EQ(files(), std::vector<std::string>{"a.fst"});
}

}  // namespace
}  // namespace cde::testing
