// SPDX-License-Identifier: Apache-2.0
// Another user of a folder swaps what lies there between the look at an output and its opening.
#include "support/output_target.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

class Swapped : public ::testing::Test {
 protected:
  Swapped() {
    mine_.write("out", "secret");
    fs::create_directory(theirs_ / "sub");
  }
  const Folder mine_, theirs_;
};

TEST_F(Swapped, AFolderThatHasBecomeALink) {
  std::ofstream(theirs_ / "sub/out") << "old";
  fs::create_symlink("sub/out", theirs_ / "link");
  for (const char* name : {"sub/out", "sub/new", "link"}) {
    const OutputTarget target = follow_output(theirs_ / name);
    EXPECT_GE(folder_of(target).get(), 0) << name;
    fs::rename(theirs_ / "sub", theirs_ / "away");
    fs::create_directory_symlink(mine_ / "", theirs_ / "sub");
    expect_error(ErrorCode::kFile, "cannot create: ", [&] { (void)folder_of(target); });
    expect_error(ErrorCode::kFile,
                 "cannot create: ", [&] { (void)open_output(target, O_RDWR | O_CREAT); });
    fs::remove(theirs_ / "sub");
    fs::rename(theirs_ / "away", theirs_ / "sub");
  }
  EXPECT_EQ(mine_.files(), 1u);
}

TEST_F(Swapped, AFifoThatHasBecomeALinkOrAFile) {
  const fs::path fifo = theirs_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const OutputTarget target = follow_output(fifo);
  fs::remove(fifo);
  fs::create_symlink(mine_ / "out", fifo);
  expect_error(ErrorCode::kFile, "cannot write: ", [&] { (void)open_output(target, O_WRONLY); });
  fs::remove(fifo);
  std::ofstream(fifo) << "a file";
  expect_error(ErrorCode::kFile, "cannot write: another user of its folder has replaced it",
               [&] { (void)open_output(target, O_WRONLY); });
  EXPECT_EQ(bytes_of(mine_ / "out"), "secret");
}

/// The owner of a link must still own what it leads to.
TEST_F(Swapped, ATargetThatIsNoLongerTheLinksOwners) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs two users, which root alone can be";
  constexpr uid_t kOther = 65534;
  std::ofstream(theirs_ / "sub/out") << "old";
  fs::create_symlink("sub/out", theirs_ / "link");
  for (const char* name : {"", "sub", "sub/out"})
    ASSERT_EQ(::chown((theirs_ / name).c_str(), kOther, kOther), 0);
  ASSERT_EQ(::lchown((theirs_ / "link").c_str(), kOther, kOther), 0);
  const OutputTarget target = follow_output(theirs_ / "link");
  EXPECT_EQ(target.stranger, kOther);
  EXPECT_GE(folder_of(target).get(), 0);
  ASSERT_EQ(::chown((theirs_ / "sub/out").c_str(), 0, 0), 0);
  expect_error(ErrorCode::kFile, "it is a link of user 65534 to", [&] { (void)folder_of(target); });
}

}  // namespace
}  // namespace cde::testing
