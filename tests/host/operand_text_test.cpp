// SPDX-License-Identifier: Apache-2.0
// Pairs from lines of text and from arrays.
#include <bit>
#include <random>

#include "arrays.hpp"
#include "cde/geometry/operand_line.hpp"
#include "cde/io/pair_array.hpp"
#include "cde/support/error.hpp"
#include "testing.hpp"

namespace cde::operand_texts {
namespace {

using testing::bytes;
using testing::expect_error;
using testing::npy;
using testing::npz;

using Words = std::vector<std::uint64_t>;

std::vector<float> floats(const Words& words) {
  std::vector<float> all;
  for (const std::uint64_t w : words) all.push_back(std::bit_cast<float>(static_cast<unsigned>(w)));
  return all;
}

/// Lines through one reader.
struct Lines {
  explicit Lines(const std::string& pair) : text(pair_in_any_order(pair), WordText(FpFormat{})) {}
  OperandLine operator()(const std::string& line) {
    a.clear(), b.clear();
    return text.read(line, "line 7", a, b, why);
  }
  /// Expects these words of A and B.
  void expect(const std::string& line, std::vector<float> want_a, std::vector<float> want_b) {
    SCOPED_TRACE(line);
    EXPECT_EQ((*this)(line), OperandLine::kPair) << why;
    EXPECT_EQ(floats(a), want_a);
    EXPECT_EQ(floats(b), want_b);
  }
  void expect_malformed(const std::string& line, const std::string& message) {
    SCOPED_TRACE(line);
    EXPECT_EQ((*this)(line), OperandLine::kMalformed);
    EXPECT_EQ(why.substr(0, message.size()), message);
    EXPECT_TRUE(a.empty() && b.empty());
  }
  OperandText text;
  Words a, b;
  std::string why;
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(OperandText, AnySeparator_ReadsTheSame) {
  Lines lines("sphere-sphere");
  const std::vector<float> a = {0, 0, 0, 1}, b = {1.5f, 0, 0, 1};
  for (const char* line :
       {"0,0,0,1,1.5,0,0,1", "0 0 0 1 1.5 0 0 1", "0\t0\t0\t1\t1.5\t0\t0\t1", "0;0;0;1;1,5;0;0;1",
        " 0,0,0,1, 1.5,0,0,1 ", "0,0,0,1|1.5,0,0,1", "0 0 0 1 | 1.5 0 0 1", "0;0;0;1 | 1.5;0;0;1",
        "0,0,0,1 1.5,0,0,1", "\"0\",0,0,\"1\",\"1.5\",0,0,1",
        "0x0 0 0 0x3f800000 0x3fc00000 0 0 0x1p0"})
    lines.expect(line, a, b);
  EXPECT_EQ(lines(""), OperandLine::kNothing);
  EXPECT_EQ(lines("  # 0,0,0,1"), OperandLine::kNothing);
}

TEST(OperandText, WrongLines_AreMalformed) {
  Lines lines("sphere-sphere");
  lines.expect_malformed("0,0,0,1,1,0,0", "line 7: 7 words, must be 8 (4 of A, 4 of B)");
  lines.expect_malformed("0,,0,1,1,0,0,1", "line 7, word 2: '' is not a number");
  lines.expect_malformed("0\t\t0\t1\t1\t0\t0\t1", "line 7, word 2: '' is not a number");
  lines.expect_malformed("0,0,0 1,1.5,0,0,1",
                         "line 7: 3 words before the blank, of 8 in all; A has 4");
  lines.expect_malformed("0,0,0|1,1.5,0,0,1", "line 7: 3 words before the |, of 8 in all; A has 4");
  lines.expect_malformed("0,0|0,1|1.5,0,0,1", "line 7, column 8: a second |");
  lines.expect_malformed("|", "line 7: 0 words, must be 8");
  // Decimal commas between blanks would give 8 words more.
  lines.expect_malformed("0,5 0,5 0,5 1,5 2,5 0,5 0,5 1,5",
                         "line 7, word 2: '5 0' is not a number; commas separate the fields");
  lines.expect_malformed("0;1.5;0;1;1,5;0;0;1", "line 7, column 12: '1,5' has a decimal comma");
  lines.expect_malformed("\"0;0;0;1;1;0;0;1", "line 7, column 1: a quote is not closed");
}

TEST(OperandText, RaysWithoutInterval_AreAccepted) {
  const std::vector<float> triangle = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  Lines lines("ray-triangle");
  lines.expect("0 0 2 0 0 -1 1 2 3 4 5 6 7 8 9", {0, 0, 2, 0, 0, -1, 0, kInfinity}, triangle);
  lines.expect("0 0 2 0 0 -1 3 4 | 1 2 3 4 5 6 7 8 9", {0, 0, 2, 0, 0, -1, 3, 4}, triangle);
  lines.expect("0 0 2 0 0 -1 | 1 2 3 4 5 6 7 8 9", {0, 0, 2, 0, 0, -1, 0, kInfinity}, triangle);
  lines.expect_malformed("0 0 2 0 0 -1 1 | 2 3 4 5 6 7 8 9", "line 7: 7 words before the |");
  lines.expect_malformed("1 2 3", "line 7: 3 words, must be 15 or 17 (6 or 8 of A, 9 of B)");
  Lines exchanged("triangle-ray");
  exchanged.expect("1 2 3 4 5 6 7 8 9 | 0 0 2 0 0 -1", {0, 0, 2, 0, 0, -1, 0, kInfinity}, triangle);
  exchanged.expect("1 2 3 4 5 6 7 8 9 0 0 2 0 0 -1 3 4", {0, 0, 2, 0, 0, -1, 3, 4}, triangle);
}

TEST(OperandText, Header_NamesTheColumns) {
  const std::string a = "A.center.x,A.center.y,A.center.z,A.radius",
                    b = "B.center.x,B.center.y,B.center.z,B.radius";
  Lines lines("sphere-sphere");
  EXPECT_EQ(lines("# spheres"), OperandLine::kNothing);
  EXPECT_EQ(lines(b + "," + a), OperandLine::kNothing);
  lines.expect("1.5,0,0,2,0,0,0,1", {0, 0, 0, 1}, {1.5f, 0, 0, 2});
  lines.expect_malformed("1.5,0,0,2,0,0,0", "line 7: 7 words; the header names 8");
  Lines numbered("sphere-sphere");
  EXPECT_EQ(numbered("," + a + "," + b), OperandLine::kNothing);
  numbered.expect("0,1,2,3,4,5,6,7,8", {1, 2, 3, 4}, {5, 6, 7, 8});
  numbered.expect_malformed("7,1,2,3,4,5,6,7,8", "line 7, column 1: row number 7, expected 1");
  numbered.expect("2,1,2,3,4,5,6,7,8", {1, 2, 3, 4}, {5, 6, 7, 8});
  Lines ray("ray-sphere");
  EXPECT_EQ(
      ray("# B.center.x B.center.y B.center.z B.radius A.tmax A.origin.x A.origin.y A.origin.z "
          "A.direction.x A.direction.y A.direction.z"),
      OperandLine::kNothing);
  ray.expect("1 2 3 4 9 5 6 7 0 0 1", {5, 6, 7, 0, 0, 1, 0, 9}, {1, 2, 3, 4});
  Lines exchanged("sphere-triangle");  // names A first
  EXPECT_EQ(exchanged("B.v0.x B.v0.y B.v0.z B.v1.x B.v1.y B.v1.z B.v2.x B.v2.y B.v2.z A.center.x "
                      "A.center.y A.center.z A.radius"),
            OperandLine::kNothing);
  exchanged.expect("1 2 3 4 5 6 7 8 9 0 0 0 1", {1, 2, 3, 4, 5, 6, 7, 8, 9}, {0, 0, 0, 1});
  const auto bad = [](const std::string& header, const std::string& message) {
    SCOPED_TRACE(header);
    expect_error(ErrorCode::kFile, message, [&] { (void)Lines("sphere-sphere")(header); });
  };
  bad("ax,ay,az,ar,bx,by,bz,br",
      "line 7, column 1: unknown column 'ax'; expected A.center.x, A.center.y, A.center.z, "
      "A.radius, "
      "B.center.x");
  bad(a, "line 7, column 42: column 'B.center.x' is missing");
  bad(a + "," + b + ",A.radius", "column 'A.radius' appears twice");
}

TEST(OperandText, ASingleLine_IsNoHeader) {
  Words a, b;
  std::string why;
  EXPECT_EQ(read_operands(pair_in_any_order("sphere-sphere"), WordText(FpFormat{}), "the pair",
                          "abc 0 0 1 1 0 0 1", a, b, why),
            OperandLine::kMalformed);
  EXPECT_EQ(why, "the pair, word 1: 'abc' is not a number");
}

TEST(OperandText, Pieces_GoOnWhereOthersEnded) {
  Lines lines("sphere-sphere");
  EXPECT_TRUE(lines.text.take_header(
      ",A.center.x,A.center.y,A.center.z,A.radius,B.center.x,B.center.y,B.center.z,B.radius", "h"));
  lines.text.skip(65536);
  lines.expect("65537,1,2,3,4,5,6,7,8", {1, 2, 3, 4}, {5, 6, 7, 8});
  lines.expect_malformed("65537,1,2,3,4,5,6,7,8",
                         "line 7, column 1: row number 65537, expected 65538");
  EXPECT_EQ(OperandText::first_line("\xef\xbb\xbf"
                                    "1,2",
                                    "stdin"),
            "1,2");
  expect_error(ErrorCode::kFile, "stdin: text in UTF-16", [] {
    (void)OperandText::first_line(
        "\xff\xfe"
        "1",
        "stdin");
  });
}

TEST(OperandText, Damage_NeverCrashes) {
  std::mt19937 random(28);
  const std::string header =
      " A.center.x A.center.y A.center.z A.radius B.center.x B.center.y "
      "B.center.z B.radius";
  int pairs = 0;
  for (int round = 0; round < 20000; ++round) {
    Lines lines("sphere-sphere");
    std::string text = round % 2 == 0 ? "0,0,0,1 | 1.5,0,\"0\",1" : "0;0;0;1;1,5;0;0;1";
    for (std::size_t i = 0; i < random() % 4; ++i)
      text[random() % text.size()] = "\",; \t|#0xp\0\xff"[random() % 12];
    try {
      if (round % 3 == 0) (void)lines(header);
      const OperandLine found = lines(text);
      pairs += found == OperandLine::kPair ? 1 : 0;
      EXPECT_EQ(lines.a.size(), found == OperandLine::kPair ? 4u : 0u);
      EXPECT_EQ(lines.b.size(), lines.a.size());
    } catch (const Error& e) {
      EXPECT_TRUE(std::string(e.what()).starts_with("line 7")) << e.what();
    }
  }
  EXPECT_GT(pairs, 1000);
}

Words words_of(const std::string& pair, FpFormat format, const std::string& file) {
  PairArray array(file, "p.npy", pair_in_any_order(pair), WordText(format));
  Words a, b;
  std::string why;
  for (std::uint64_t i = 0; i < array.size(); ++i) {
    EXPECT_EQ(array.read(i, "pair", a, b, why), OperandLine::kPair) << why;
    // The same words in a line give the same result.
    Words line_a, line_b;
    EXPECT_EQ(OperandText(pair_in_any_order(pair), WordText(format))
                  .read(array.line(i), "line", line_a, line_b, why),
              OperandLine::kPair)
        << why;
    const std::size_t each = a.size() / (i + 1);
    EXPECT_TRUE(std::equal(line_a.begin(), line_a.end(), a.end() - static_cast<long>(each)));
    EXPECT_TRUE(std::equal(line_b.rbegin(), line_b.rend(), b.rbegin()));
  }
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(PairArrays, LastAxisOrFields_HaveTheWords) {
  const std::vector<float> want = {0, 0, 0, 1, 1.5f, 0, 0, 2};
  const auto same = [&](const std::string& file) {
    EXPECT_EQ(floats(words_of("sphere-sphere", FpFormat{}, file)), want);
  };
  same(npy("'<f4'", "(1, 8)", bytes(want)));
  same(npy("'>f4'", "(8,)", bytes(want, true)));
  same(npz({{"p.npy", npy("'<f4'", "(1, 1, 8)", bytes(want))}}, true));
  same(npy("[('A', '<f4', (4,)), ('B', '<f4', (4,))]", "(1,)", bytes(want)));
  same(npy("[('B', '<f4', (4,)), ('A', '<f4', (4,))]", "(1,)",
           bytes<float>({1.5f, 0, 0, 2, 0, 0, 0, 1})));
  const Words exchanged = words_of(
      "triangle-ray", FpFormat{},
      npy("'<f4'", "(1, 15)", bytes<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 2, 0, 0, -1})));
  EXPECT_EQ(floats(exchanged),
            (std::vector<float>{0, 0, 2, 0, 0, -1, 0, kInfinity, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(PairArrays, Numbers_AreRoundedOnce) {
  // Halfway between two words of fp32, and just above.
  const double tie = 1 + 0x1p-24, above = tie + 0x1p-52;
  const Words words =
      words_of("sphere-sphere", FpFormat{},
               npy("'<f8'", "(1, 8)", bytes<double>({tie, above, 0, 1, 0, 0, 0, 1})));
  EXPECT_EQ(words[0], 0x3f800000u);
  EXPECT_EQ(words[1], 0x3f800001u);
  const Words wide =
      words_of("sphere-sphere", FpFormat{11, 52},
               npy("'<f8'", "(1, 8)", bytes<double>({tie, above, 0, 1, 0, 0, 0, 1})));
  EXPECT_EQ(std::bit_cast<double>(wide[1]), above);
  PairArray large(npy("'<f8'", "(1, 8)", bytes<double>({0, 0, 1e60, 1, 0, 0, 0, 1})), "p.npy",
                  pair_in_any_order("sphere-sphere"), WordText(FpFormat{}));
  Words a, b;
  std::string why;
  EXPECT_EQ(large.read(0, "p.npy: pair 0", a, b, why), OperandLine::kMalformed);
  EXPECT_EQ(why,
            "p.npy: pair 0, A.center.z: 1e+60 is beyond the largest fp32 number, 3.4028235e+38");
  EXPECT_TRUE(a.empty() && b.empty());
}

TEST(PairArrays, OtherArrays_AreRefused) {
  expect_error(
      ErrorCode::kFile,
      "p.npy: its shape is (2, 6); pairs are (..., 8) numbers, 4 words of A, a sphere, and 4 "
      "of B, a sphere, or structures of A and B",
      [] {
        (void)words_of("sphere-sphere", FpFormat{},
                       npy("'<f4'", "(2, 6)", bytes(std::vector<float>(12))));
      });
  expect_error(ErrorCode::kFile, "its field 'A' of 5 numbers is not expected", [] {
    (void)words_of("sphere-sphere", FpFormat{},
                   npy("[('A', '<f4', (5,))]", "(1,)", std::string(20, '\0')));
  });
}

}  // namespace
}  // namespace cde::operand_texts
