// SPDX-License-Identifier: Apache-2.0
// The package of a failing test of cards (tests/failing_test.cpp), and $CDE_WAVES.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "board_configs.hpp"
#include "pair_failure.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// Fails, after work on a card, in the process that FailingTest.Failure_LeavesWavesOfItsBoards
/// starts.
TEST(FailingTest, CardThatWorks_FailsOnRequest) {
  Board board = Board::open(small_config());
  const std::vector<Triangle> triangles = {{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  board.upload_shapes<Triangle>(triangles);
  board.load(std::vector<Ray>{{.o = {0.2f, 0.2f, 0}, .d = {0, 0, 1}}});
  const std::vector<Record> records = board.run({});
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].f, std::getenv("CDE_TEST_FAILS") == nullptr);
}

std::string contents(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Command line of this program that runs CardThatWorks alone.
std::string card_that_works() {
  return quoted(fs::read_symlink("/proc/self/exe").string()) +
         " --gtest_filter=FailingTest.CardThatWorks_FailsOnRequest 2>&1";
}

TEST(FailingTest, Failure_LeavesWavesOfItsBoards) {
  const fs::path folder = fs::path(::testing::TempDir()) / "cde failing test",
                 test = folder / "FailingTest.CardThatWorks_FailsOnRequest";
  fs::remove_all(folder);
  const Ran ran = run_shell("CDE_TEST_FAILS=1 CDE_FAILURES=" + quoted(folder.string()) + " " +
                            card_that_works());
  EXPECT_EQ(ran.status, 1) << ran.said;
  EXPECT_NE(ran.said.find("packed in: " + test.string() + ", waves of 1 board\n"),
            std::string::npos)
      << ran.said;
  EXPECT_NE(contents(test / "fail.txt").find("records[0].f"), std::string::npos);
  if (fs::exists(CDE_COMMAND)) {
    const Ran waves = run_shell("'" CDE_COMMAND "' wave tx " +
                                quoted((test / "board-0.fst").string()) + " test 2>&1");
    EXPECT_NE(waves.said.find("hit"), std::string::npos) << waves.said;
    EXPECT_TRUE(fs::exists(test / "board-0.gtkw"));
  }
  fs::remove_all(folder);
}

TEST(FailingTest, WavesIntoMissingFolder_AreAnError) {
  const Ran ran = run_shell("CDE_WAVES=/nowhere/at/all " + card_that_works());
  EXPECT_EQ(ran.status, 1);
  EXPECT_NE(ran.said.find("/nowhere/at/all/board-0.fst"), std::string::npos) << ran.said;
}

TEST(FailingTest, WavesBehindForeignLink_AreAnError) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  std::string folder = (fs::temp_directory_path() / "cde-waves-XXXXXX").string();
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  fs::create_directory(fs::path(folder) / "mine");
  const fs::path link = fs::path(folder) / "link";
  fs::create_directory_symlink("mine", link);
  ASSERT_EQ(::lchown(link.c_str(), 65534, 65534), 0);
  const Ran ran = run_shell("CDE_WAVES=" + link.string() + " " + card_that_works());
  EXPECT_EQ(ran.status, 1);
  EXPECT_NE(ran.said.find("it is a link owned by user 65534 to"), std::string::npos) << ran.said;
  EXPECT_TRUE(fs::is_empty(fs::path(folder) / "mine"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace cde::testing
