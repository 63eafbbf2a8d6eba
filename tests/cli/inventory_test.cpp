// SPDX-License-Identifier: Apache-2.0
// cde inventory: what it keeps of earlier times, and when it does not trust that.
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// With a cache of its own and a Verilator that counts how often it elaborates.
class InventoryCache : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    fs::create_directory(folder_ / "bin");
    write("bin/verilator",
          "#!/bin/bash\n"
          "[[ \" $* \" != *--xml-only* ]] || echo once >>\"$COUNTS\"\n"
          "export PATH=${PATH#*:}\nexec verilator \"$@\"\n");
    ::chmod((folder_ / "bin/verilator").c_str(), 0755);
  }

  Ran inventory(std::vector<std::string> words) {
    words.insert(words.begin(), "inventory");
    words.emplace_back("--json");
    return cde(words, {"CDE_CACHE=" + (folder_ / "cache").string(),
                       "PATH=" + (folder_ / "bin").string() + ":" + std::getenv("PATH"),
                       "COUNTS=" + (folder_ / "counts").string()});
  }
  std::size_t elaborated() {
    const std::string lines = exists("counts") ? read("counts") : "";
    fs::remove(folder_ / "counts");
    return static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
  }
  fs::path entry() {
    fs::path found;
    for (const auto& file : fs::directory_iterator(folder_ / "cache"))
      if (file.path().string().ends_with(".inventory.json")) found = file.path();
    return found;
  }
};

/// Elaborations take seconds each.
TEST_F(InventoryCache, TheSameRtlIsElaboratedOnce) {
  const Ran first = inventory({"sphere-sphere"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(elaborated(), 2u) << "at one clock an operator, and at the profile's";
  const Ran again = inventory({"sphere-sphere"});
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(again.err, "");
  EXPECT_EQ(elaborated(), 0u);

  const fs::path file = entry();
  ASSERT_FALSE(file.empty());
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string other = text.str();
  other[other.find_last_of("123456789")] ^= 1;  // another figure, still JSON
  std::ofstream(file) << other;
  const Ran damaged = inventory({"sphere-sphere"});
  EXPECT_EQ(damaged.status, 0) << damaged.err;
  EXPECT_EQ(damaged.out, first.out);
  EXPECT_NE(damaged.err.find(file.string() + " is not used: it is damaged"), std::string::npos)
      << damaged.err;
  EXPECT_EQ(elaborated(), 2u);
}

}  // namespace
}  // namespace cde::testing
