// SPDX-License-Identifier: Apache-2.0
// Inputs of cde query: texts and arrays, from stdin and from files.
#include <filesystem>

#include "query.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// Texts of the same pairs with different headers, quotes and line ends.
TEST_F(Query, ForeignTexts_AreRead) {
  const std::string answers = kHeader + "1,0.5,0.75,0,0,1,0,0,\n0,2.5,2.25,0,0,1,0,0,\n";
  const std::string a = "A.center.x,A.center.y,A.center.z,A.radius",
                    b = "B.center.x,B.center.y,B.center.z,B.radius";
  for (const std::string& text :
       {"\xef\xbb\xbf" + a + "," + b + "\n0,0,0,1,1.5,0,0,1\n0,0,0,1,5,0,0,1.5\n",
        "," + a + "," + b + "\r\n0,0,0,0,1,1.5,0,0,1\r\n1,0,0,0,1,5,0,0,1.5\r\n",
        b + "," + a + "\r\"1.5\",0,0,1,0,0,0,1\r5,0,0,1.5,0,0,0,1\r",
        std::string("0;0;0;1;1,5;0;0;1\n0;0;0;1;5;0;0;1,5")}) {
    SCOPED_TRACE(text);
    const Ran ran = query({"sphere-sphere", "-q"}, text);
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, answers);
    // From a file, and with --cards.
    write("pairs.txt", text);
    EXPECT_EQ(cde({"query", "sphere-sphere", "pairs.txt", "-q"}).out, answers);
    EXPECT_EQ(query({"sphere-sphere", "-q", "--resume", "j"}, text).out, answers);
    fs::remove_all(folder_ / "j");
  }
  refused({"sphere-sphere", "none.txt"}, "none.txt: cannot be opened: No such file");
  refused({"sphere-sphere", "0 0 0 1 | 1 0 0 1"},
          "0 0 0 1 | 1 0 0 1: cannot be opened: No such file or directory; expected a file, or the "
          "words of pairs on stdin");
  refused({"sphere-sphere", "pairs.txt", "-o", "pairs.txt"}, "pairs.txt");
  const Ran header = query({"sphere-sphere", "-q"}, "x,y,z,r,x2,y2,z2,r2\n0,0,0,1,1.5,0,0,1\n");
  EXPECT_EQ(header.status, 2);
  EXPECT_EQ(header.out, "");
  EXPECT_TRUE(has(header.err, "cde: line 1, column 1: unknown column 'x'; expected A.center.x, "));
  const Ran wide = query({"sphere-sphere", "-q"}, std::string("\xff\xfe\x30\0", 4));
  EXPECT_EQ(wide.status, 2);
  EXPECT_TRUE(has(wide.err, "stdin: text in UTF-16"));
}

TEST_F(Query, Arrays_HaveAPairPerRow) {
  const std::vector<float> numbers = {0, 0, 0, 1, 1.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -2};
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 8), }";
  header.append(63 - (10 + header.size()) % 64, ' ').push_back('\n');
  std::string array("\x93NUMPY\x01\0", 8);
  array += {static_cast<char>(header.size()), '\0'};
  array += header + std::string(reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size());
  write("p.npy", array);
  const std::string answers =
      kHeader + "1,0.5,0.75,0,0,1,0,0,\n0,nan,nan,nan,nan,nan,nan,nan,bad\n";
  const Ran file = cde({"query", "sphere-sphere", "p.npy", "-q"});
  EXPECT_EQ(file.out, answers);
  EXPECT_EQ(file.status, 2);
  EXPECT_EQ(file.err, "cde: p.npy: pair 1: sphere B: radius is -2, must be > 0\n");
  const Ran distributed = cde({"query", "sphere-sphere", "p.npy", "-q", "--resume", "j"});
  EXPECT_EQ(distributed.out, answers);
  EXPECT_EQ(distributed.err, file.err);
  const Ran stdin_ran = query({"sphere-sphere", "-q"}, array);
  EXPECT_EQ(stdin_ran.out, answers);
  EXPECT_EQ(stdin_ran.err, "cde: pair 1: sphere B: radius is -2, must be > 0\n");
  const Ran other = cde({"query", "obb-obb", "p.npy", "-q"});
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(other.out, "");
  EXPECT_TRUE(has(other.err, "p.npy: its shape is (2, 1, 8); pairs are (..., 30) numbers"));
}

}  // namespace
}  // namespace cde::testing
