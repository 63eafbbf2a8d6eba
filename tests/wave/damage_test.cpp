// SPDX-License-Identifier: Apache-2.0
// Damaged wave files, and other files: a message and status 2, never a crash or a hang.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

class DamagedWaves : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
    whole_ = read("a.fst");
  }
  std::string whole_;
};

TEST_F(DamagedWaves, NonFstFiles_AreToldApart) {
  write("empty.fst", "");
  write("text.vcd", "$date today $end\n");
  write("other.fst", std::string(1000, 'q'));
  write("short.fst", whole_.substr(0, 100));
  write("cut.fst", whole_.substr(0, whole_.size() - 1));
  std::filesystem::create_directory(folder_ / "folder");
  const std::vector<std::pair<std::string, std::string>> all = {
      {"empty.fst", "is empty"},
      {"text.vcd", "in its header"},
      {"other.fst", "is neither an FST file"},
      {"short.fst", "cut off"},
      {"cut.fst", "cut off"},
      {"folder", "not a regular"},
      {"none.fst", "No such file"}};
  for (const auto& [name, message] : all) {
    const Ran ran = cde({"wave", "info", name});
    EXPECT_EQ(ran.status, 2) << name;
    EXPECT_TRUE(has(ran.err, message));
    EXPECT_TRUE(has(ran.err, name));
  }
}

TEST_F(DamagedWaves, TruncationAtAnyLength_IsAnError) {
  for (std::size_t n = 0; n < whole_.size(); n += 37) {
    write("cut.fst", whole_.substr(0, n));
    const Ran ran = cde({"wave", "at", "cut.fst", "75ns", "*"});
    EXPECT_EQ(ran.status, 2) << n << ran.err;
    EXPECT_TRUE(has(ran.err, "cut.fst: ")) << n;
  }
}

/// Seconds that tools/fuzz requests; 0 in other runs.
double fuzz_seconds() {
  const char* asked = std::getenv("CDE_FUZZ");
  return asked != nullptr ? std::atof(asked) : 0;
}

using Words = std::vector<std::string>;

/// A verb with the options that it needs to work.
const std::vector<Words> kAsked = {
    {"find", "bad.fst", "changed(count)"},
    {"diff", "a.fst", "bad.fst", "--max", "3"},
    {"info", "bad.fst"},
    {"ls", "bad.fst"},
    {"at", "bad.fst", "75ns", "*"},
    {"show", "bad.fst", "clk", "data[1]:fp32", "state", "--around", "75ns"},
    {"stat", "bad.fst"},
    {"tx", "bad.fst"},
    {"export", "bad.fst", "-o", "x.vcd"},
    {"export", "bad.fst", "-o", "x.csv"},
    {"export", "bad.fst", "count", "clk", "-o", "x.svg"},
    {"export", "bad.fst", "-o", "x.fst"},
    {"export", "bad.fst", "-o", "x.gtkw"},
    {"serve", "bad.fst", "-o", "x.html"},
};

TEST_F(DamagedWaves, FlippedBytes_NeverCrash) {
  const double seconds = fuzz_seconds();
  const std::random_device::result_type seed = seconds > 0 ? std::random_device()() : 20;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(static_cast<std::mt19937::result_type>(seed));
  // If the command was built with sanitizers, only reports about the command itself count. The
  // reader of the Verilator runtime has reports of its own. It therefore runs in a child process
  // and may stop in the middle.
  const Words sanitizers = {
      "ASAN_OPTIONS=detect_leaks=0:log_path=" + (folder_ / "report").string(),
      "UBSAN_OPTIONS=print_stacktrace=1:log_path=" + (folder_ / "report").string()};
  write_pci(folder_ / "pci.fst");
  const std::string card = read("pci.fst");
  unsigned refused = 0, read_anyway = 0, reader = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto more = [&](unsigned i) {
    return seconds > 0
               ? std::chrono::steady_clock::now() - start < std::chrono::duration<double>(seconds)
               : i < 120;
  };
  for (unsigned i = 0; more(i); ++i) {
    std::string bytes = i % 5 == 4 ? card : whole_;
    for (unsigned k = 1 + random() % 3; k > 0; --k) {
      // Half of the damage comes after the header, which is long and mostly text.
      const std::size_t at =
          random() % 2 == 0 ? random() % bytes.size() : 330 + random() % (bytes.size() - 330);
      bytes[at] = static_cast<char>(random());
    }
    write("bad.fst", bytes);
    const Words& asked = kAsked[i % kAsked.size()];
    Words words = {"wave"};
    words.insert(words.end(), asked.begin(), asked.end());
    const Ran ran = cde(words, sanitizers);
    ASSERT_TRUE(ran.status <= 2) << i << " " << asked[0] << " " << ran.status << ran.err;
    if (ran.status == 2) {
      EXPECT_TRUE(ran.err.starts_with("cde: ") && ran.out.empty()) << asked[0] << ran.err;
    }
    ++(ran.status == 2 ? refused : read_anyway);
    for (const std::string& name : files()) {
      if (!name.starts_with("report")) continue;
      const std::string report = read(name);
      std::filesystem::remove(folder_ / name);
      ++reader;
      if (report.find("fstapi.c") >
          std::min(report.find("/src/wave/"),
                   report.find("/tools/cde-wave/"))) {  // the inner frame first
        std::ofstream(std::filesystem::temp_directory_path() / "cde-fuzz.fst") << bytes;
        FAIL() << asked[0] << " of " << std::filesystem::temp_directory_path() / "cde-fuzz.fst"
               << "\n"
               << report;
      }
    }
    for (const char* name : {"x.vcd", "x.csv", "x.svg", "x.fst", "x.gtkw", "x.html"})
      std::filesystem::remove(folder_ / name);
  }
  EXPECT_GT(refused, 20u);
  EXPECT_GT(read_anyway, 20u);
  if (seconds > 0)
    std::cout << refused << " files refused, " << read_anyway
              << " read; reports about the runtime's reader: " << reader << "\n";
}

}  // namespace
}  // namespace cde::testing
