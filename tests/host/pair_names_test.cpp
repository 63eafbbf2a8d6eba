// SPDX-License-Identifier: Apache-2.0
// Names of pairs in either order, and lines of operands in that order.
#include <string>
#include <vector>

#include "cde/geometry/operand_line.hpp"
#include "cde/geometry/pair.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;

TEST(PairNames, EveryPair_HasItsNameAndItsReverse) {
  for (const std::string& text : pair_names()) {
    SCOPED_TRACE(text);
    const Pair pair = *pair_named(text);
    EXPECT_EQ(pair_in_any_order(text).pair, pair);
    EXPECT_FALSE(pair_in_any_order(text).exchanged);
    const std::size_t dash = text.find('-');
    const std::string other = text.substr(dash + 1) + "-" + text.substr(0, dash);
    EXPECT_EQ(pair_in_any_order(other).pair, pair);
    EXPECT_EQ(pair_in_any_order(other).exchanged, other != text);
  }
  EXPECT_EQ(pair_in_any_order("box-sphere").pair, Pair::kSphereObb);
  EXPECT_TRUE(pair_in_any_order("box-sphere").exchanged);
  EXPECT_EQ(pair_in_any_order("box-box").pair, Pair::kObbObb);
}

TEST(PairNames, ShapesWithoutAPair_ListTheOthers) {
  const auto refused = [](const char* text, const char* why) {
    expect_error(ErrorCode::kUsage, why, [&] { (void)pair_in_any_order(text); });
  };
  refused("sphere-cylinder",
          "no pair 'sphere-cylinder'; with sphere there are: sphere-sphere, "
          "triangle-sphere, ray-sphere, sphere-obb, sphere-plane; with cylinder: ray-cylinder, "
          "triangle-cylinder, cylinder-cylinder, obb-cylinder");
  refused("plane-plane", "no pair 'plane-plane'; with plane there are: obb-plane, sphere-plane");
  refused("ray-box", "no pair 'ray-box'; with ray there are: ray-triangle");
  refused("ray-trangle", "no pair 'ray-trangle'; did you mean ray-triangle?");
  for (const char* text : {"", "-", "ray", "ray-", "-ray", "ray-triangle-", "sphere"})
    refused(text, "no pair '");
}

TEST(PairNames, Operands_StandInTheOrderOfTheName) {
  const WordText text(FpFormat{});
  const auto read = [&](const char* name, const char* line) {
    std::vector<std::uint64_t> a, b;
    std::string why;
    EXPECT_EQ(read_operands(pair_in_any_order(name), text, "line 1", line, a, b, why),
              OperandLine::kPair)
        << why;
    return std::pair(a, b);
  };
  EXPECT_EQ(read("sphere-triangle", "1 2 3 4 | 0 0 0 1 0 0 0 1 0"),
            read("triangle-sphere", "0 0 0 1 0 0 0 1 0 | 1 2 3 4"));
  EXPECT_EQ(read("triangle-ray", "0 0 0 1 0 0 0 1 0 | 5 6 7 0 0 1"),
            read("ray-triangle", "5 6 7 0 0 1 | 0 0 0 1 0 0 0 1 0"));
  EXPECT_EQ(read("triangle-ray", "0 0 0 1 0 0 0 1 0 5 6 7 0 0 1 2 3"),
            read("ray-triangle", "5 6 7 0 0 1 2 3 0 0 0 1 0 0 0 1 0"));
  std::vector<std::uint64_t> a, b;
  std::string why;
  EXPECT_EQ(
      read_operands(pair_in_any_order("sphere-triangle"), text, "line 1", "1 2 | 3", a, b, why),
      OperandLine::kMalformed);
  EXPECT_EQ(why, "line 1: 3 words, must be 13 (4 of A, 9 of B)");
  EXPECT_EQ(read_operands(pair_in_any_order("triangle-ray"), text, "line 1",
                          "0 0 0 1 0 0 | 0 1 0 5 6 7 0 0 1", a, b, why),
            OperandLine::kMalformed);
  EXPECT_EQ(why, "line 1: 6 words before the |, of 15 in all; A has 9");
  EXPECT_TRUE(a.empty() && b.empty());
}

}  // namespace
}  // namespace cde
