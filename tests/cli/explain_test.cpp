// SPDX-License-Identifier: Apache-2.0
// cde explain: from a pair to the line of RTL where a pipe differs from its reference.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "../has.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Explain : public Cli {
 protected:
  /// Plants a fault in moller's pipe and expects its line as the first named place.
  void expect_found(const std::string& from, const std::string& to) {
    const Planted fault(folder_, "rtl/pipes/ray_triangle_moller.sv", from, to);
    const Ran ran = cde({"explain", "ray-triangle", "0.6 0.3 5 0 0 -1 | 0.5 0.1 0 1.5 0 0 0.5 1 0",
                         "--arith", "host", "--no-box", "--json"},
                        fault.environment());
    ASSERT_EQ(ran.status, 3) << ran.err;
    const json found = json::parse(ran.out)["first_differences"];
    ASSERT_FALSE(found.empty()) << ran.out;
    const json& place = found[0]["sources"][0][0];
    EXPECT_EQ(place["file"], "ray_triangle_moller.sv");
    EXPECT_EQ(place["line"], fault.line());
  }
};

TEST_F(Explain, CorrectPipe_IsExplainedCompletely) {
  const Ran ran = cde({"explain", "sphere-sphere", "0 0 0 1 | 1.5 0 0 1"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "The card's answer equals the reference's."));
  EXPECT_TRUE(has(ran.out, "sphere_sphere.sv:"));
  const Ran short_form = cde({"explain", "sphere-sphere", "0,0,0,1,1.5,0,0,1", "--json"});
  const json j = json::parse(short_form.out);
  EXPECT_TRUE(j["same"].get<bool>());
  EXPECT_GT(j["operations"].get<int>(), 20);
  EXPECT_EQ(j["operations"], j["operations_found"]);
  EXPECT_TRUE(j["first_differences"].empty());
}

/// With host arithmetic the box rule has no operators, and some of its operands equal
/// operands of moller.
TEST_F(Explain, HostArithmeticWithTheBoxRule_HasNoDifference) {
  const Ran ran = cde({"explain", "ray-triangle", "0.6 0.3 5 0 0 -1 | 0.5 0.1 0 1.5 0 0 0.5 1 0",
                       "--arith", "host", "--json"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  const json j = json::parse(ran.out);
  EXPECT_GT(j["operations_found"].get<int>(), 60);
  EXPECT_TRUE(j["first_differences"].empty()) << ran.out;
}

TEST_F(Explain, Manual_ShowsThePrintedOutput) {
  std::ifstream in(fs::path(CDE_SOURCE_DIR) / "docs/guides/explain.md");
  const std::string manual{std::istreambuf_iterator<char>(in), {}};
  const Ran ran = cde({"explain", "sphere-sphere", "0 0 0 1 | 1.5 0 0 1", "--max", "3"});
  std::string indented;
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);)
    indented += (line.empty() ? "" : "    ") + line + '\n';
  EXPECT_TRUE(has(manual, indented));
}

TEST_F(Explain, WrongOperation_IsFoundAtItsLine) {
  expect_found("`DF_VSUB(s, o, v0)", "`DF_VADD(s, o, v0)");
}

TEST_F(Explain, WrongOperand_IsFoundAtItsLine) {
  expect_found("`DF_DOT(u, p, s)", "`DF_DOT(u, p, e1)");
}

TEST_F(Explain, InvalidUsage_IsRefused) {
  const auto refused = [this](const std::vector<std::string>& words, const char* text) {
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2) << ran.out;
    EXPECT_TRUE(has(ran.err, text));
    EXPECT_EQ(ran.out, "");
  };
  refused({"explain", "sphere-sphere", "0 0 0 1"}, "4 words, must be 8");
  refused({"explain", "sphere-sphere", "0 0 0 one 0 0 0 1"}, "word 4");
  refused({"explain", "sphere-sphere", " "}, "missing");
  refused({"explain", "sphere-sphere", "0 0 0 1 0 0 3 1", "--iterations", "4,4,4"},
          "--iterations cannot be combined with sphere-sphere");
  refused({"explain", "spheer-sphere", "0"}, "sphere-sphere");
}

TEST_F(Explain, OperandOutOfContract_IsRefusedBeforeTheBuild) {
  const Ran ran = cde({"explain", "sphere-sphere", "0 0 0 -1 | 1.5 0 0 1"},
                      {"CDE_CACHE=" + (folder_ / "cache").string()});
  EXPECT_EQ(ran.status, 2) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(ran.err.find("cde: the pair: sphere A: "), 0u) << ran.err;
  EXPECT_TRUE(has(ran.err, "radius"));
  EXPECT_FALSE(exists("cache"));
}

}  // namespace
}  // namespace cde::testing
