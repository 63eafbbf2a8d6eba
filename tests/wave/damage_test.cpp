// SPDX-License-Identifier: Apache-2.0
// Files that are no waves, or no longer: a message and status 2, never a crash, and never a hang.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "run_cde.hpp"
#include "sample.hpp"

namespace cde::testing {
namespace {

class Damage : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
    whole_ = read("a.fst");
  }
  std::string whole_;
};

TEST_F(Damage, WhatIsNoFstIsToldApart) {
  write("empty.fst", "");
  write("text.vcd", "$date today $end\n");
  write("other.fst", std::string(1000, 'q'));
  write("short.fst", whole_.substr(0, 100));
  write("cut.fst", whole_.substr(0, whole_.size() - 1));
  std::filesystem::create_directory(folder_ / "folder");
  const std::vector<std::pair<std::string, std::string>> all = {
      {"empty.fst", "is empty"},   {"text.vcd", "vcd2fst"}, {"other.fst", "no FST"},
      {"short.fst", "cut off"},    {"cut.fst", "cut off"},  {"folder", "no regular"},
      {"none.fst", "No such file"}};
  for (const auto& [name, message] : all) {
    const Ran ran = cde({"wave", "info", name});
    EXPECT_EQ(ran.status, 2) << name;
    EXPECT_NE(ran.err.find(message), std::string::npos) << ran.err;
    EXPECT_NE(ran.err.find(name), std::string::npos) << ran.err;
  }
}

TEST_F(Damage, EveryLengthIsAMessage) {
  for (std::size_t n = 0; n < whole_.size(); n += 37) {
    write("cut.fst", whole_.substr(0, n));
    const Ran ran = cde({"wave", "at", "cut.fst", "75ns", "*"});
    EXPECT_EQ(ran.status, 2) << n << ran.err;
    EXPECT_NE(ran.err.find("cut.fst: "), std::string::npos) << n;
  }
}

TEST_F(Damage, FlippedBytesNeverCrashIt) {
  std::mt19937 random(20);
  unsigned refused = 0, read = 0;
  for (unsigned i = 0; i < 120; ++i) {
    std::string bytes = whole_;
    for (unsigned k = 1 + random() % 3; k > 0; --k) {
      // Half of them behind the header, which is long and mostly text.
      const std::size_t at =
          random() % 2 == 0 ? random() % bytes.size() : 330 + random() % (bytes.size() - 330);
      bytes[at] = static_cast<char>(random());
    }
    write("bad.fst", bytes);
    const Ran ran = i % 2 == 0 ? cde({"wave", "find", "bad.fst", "changed(count)"})
                               : cde({"wave", "diff", "a.fst", "bad.fst", "--max", "3"});
    ASSERT_TRUE(ran.status <= 2) << i << " " << ran.status << ran.err;
    if (ran.status == 2) {
      EXPECT_TRUE(ran.err.starts_with("cde: ") && ran.out.empty()) << ran.err;
    }
    ++(ran.status == 2 ? refused : read);
  }
  EXPECT_GT(refused, 20u);
  EXPECT_GT(read, 20u);
}

}  // namespace
}  // namespace cde::testing
