// SPDX-License-Identifier: Apache-2.0
// Another user of a folder replaces an entry between the check of an output and its opening.
#include "support/output_target.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include "cde/explain/bundle.hpp"
#include "cde/support/output_file.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

class SwappedFolder : public ::testing::Test {
 protected:
  SwappedFolder() {
    mine_.write("out", "secret");
    fs::create_directory(theirs_ / "sub");
  }
  const Folder mine_, theirs_;
};

TEST_F(SwappedFolder, FolderReplacedByALink_IsRefused) {
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

TEST_F(SwappedFolder, FifoReplacedByALinkOrFile_IsRefused) {
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

/// A folder of ours with the same name as one that was created in a folder of theirs.
class SwappedOutputs : public SwappedFolder {
 protected:
  SwappedOutputs() { fs::create_directory(mine_ / "made"); }
  void swap() const {
    fs::rename(theirs_ / "sub", theirs_ / "away");
    fs::create_directory_symlink(mine_ / "", theirs_ / "sub");
  }
};

TEST_F(SwappedOutputs, Folders_AreRemovedWhereTheyWereMade) {
  fs::remove(mine_ / "made");
  for (const bool by_signal : {false, true}) {
    auto folder = std::make_unique<OutputFolder>(theirs_ / "sub/made/inner");
    fs::create_directories(mine_ / "made/inner");
    swap();
    if (by_signal)
      OutputFile::remove_unfinished();
    else
      folder.reset();
    EXPECT_TRUE(fs::exists(mine_ / "made/inner"));
    EXPECT_FALSE(fs::exists(theirs_ / "away/made"));
    fs::remove(theirs_ / "sub");
    fs::rename(theirs_ / "away", theirs_ / "sub");
  }
}

TEST_F(SwappedOutputs, UnfinishedFiles_AreRemovedWhereTheyWereMade) {
  OutputFile file(theirs_ / "sub/out");
  const std::string name = fs::directory_iterator(theirs_ / "sub")->path().filename();
  std::ofstream(mine_ / name) << "secret";
  swap();
  OutputFile::remove_unfinished();
  EXPECT_EQ(bytes_of(mine_ / name), "secret");
  EXPECT_TRUE(fs::is_empty(theirs_ / "away"));
}

TEST_F(SwappedOutputs, Bundle_IsWrittenToItsOwnFolder) {
  std::ofstream(mine_ / "made/fail.json") << "secret";
  Bundle bundle((theirs_ / "sub/made").string());
  swap();
  bundle.write("why.txt", "why");
  bundle.finish();
  EXPECT_EQ(bytes_of(mine_ / "made/fail.json"), "secret");
  EXPECT_FALSE(fs::exists(mine_ / "made/why.txt"));
  EXPECT_EQ(bytes_of(theirs_ / "away/made/why.txt"), "why");
  EXPECT_TRUE(fs::exists(theirs_ / "away/made/fail.json"));
  EXPECT_EQ(bytes_of(bundle.file("why.txt")), "why");
}

TEST(BundleFolder, PathWithoutAName_IsRefused) {
  const Folder folder;
  for (const char* name : {".", "..", "there/..", "there/.", "there/.//"})
    expect_error(ErrorCode::kUsage, "it ends with .", [&] { Bundle((folder / name).string()); });
  expect_error(ErrorCode::kUsage, "/: it is the root", [] { Bundle("//"); });
  expect_error(ErrorCode::kUsage, "it is empty", [] { Bundle(""); });
  EXPECT_EQ(folder.files(), 0u);
  EXPECT_EQ(Bundle((folder / "new//").string()).folder(), folder / "new");
}

TEST_F(SwappedOutputs, OutputsAreWrittenToTheFolderThatWasChecked) {
  std::ofstream(mine_ / "out.csv") << "secret";
  std::ofstream(theirs_ / "sub/old.csv") << "old";
  const fs::path out = theirs_ / "sub/out.csv", old = theirs_ / "sub/./old.csv";
  check_outputs(std::vector<FileUse>{{"-o", out}, {"--report", old}}, {});
  swap();
  write_file(out, "answer");
  write_file(old, "new");
  EXPECT_EQ(bytes_of(mine_ / "out.csv"), "secret");
  EXPECT_FALSE(fs::exists(mine_ / "old.csv"));
  EXPECT_EQ(bytes_of(theirs_ / "away/out.csv"), "answer");
  EXPECT_EQ(bytes_of(theirs_ / "away/old.csv"), "new");
  expect_error(ErrorCode::kUsage, "-o and --report both write to", [&] {
    check_outputs(std::vector<FileUse>{{"-o", theirs_ / "sub/x"}, {"--report", theirs_ / "away/x"}},
                  {});
  });
}

TEST_F(SwappedOutputs, AFileInAFolderThatWasMade_StaysThere) {
  const OutputFolder made(theirs_ / "sub/made");
  swap();
  write_file(theirs_ / "sub/made/page.html", "page");
  EXPECT_FALSE(fs::exists(mine_ / "made/page.html"));
  EXPECT_EQ(bytes_of(theirs_ / "away/made/page.html"), "page");
}

/// Without the folder that was checked, its name counts.
TEST_F(SwappedOutputs, AFolderThatWasRemoved_IsTakenAnew) {
  const fs::path out = theirs_ / "sub/out.csv";
  check_outputs(std::vector<FileUse>{{"-o", out}}, {});
  fs::remove(theirs_ / "sub");
  fs::create_directory(theirs_ / "sub");
  write_file(out, "answer");
  EXPECT_EQ(bytes_of(out), "answer");
}

TEST_F(SwappedOutputs, MovedFolder_IsNoticed) {
  OutputFolder made(theirs_ / "made");
  made.check();
  fs::rename(theirs_ / "made", theirs_ / "away");
  expect_error(ErrorCode::kFile, "made: the folder was moved or replaced", [&] { made.check(); });
}

/// Our folder behind a link of theirs, with all endings of its name, and behind our link to that
/// link.
TEST_F(SwappedFolder, FolderBehindTheirLink_IsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  constexpr uid_t kOther = 65534;
  fs::create_directory_symlink(mine_ / "", theirs_ / "link");
  fs::create_directory_symlink(theirs_ / "link", mine_ / "indirect");
  EXPECT_FALSE(OutputFolder(theirs_ / "link").made()) << "a link of our own";
  ASSERT_EQ(::lchown((theirs_ / "link").c_str(), kOther, kOther), 0);
  for (const fs::path& name : {theirs_ / "link", theirs_ / "link/", theirs_ / "link/.",
                               theirs_ / "link//./", mine_ / "indirect"})
    expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to",
                 [&] { (void)OutputFolder(name); });
  ASSERT_EQ(::chown((theirs_ / "sub").c_str(), kOther, kOther), 0);
  fs::remove(theirs_ / "link");
  fs::create_directory_symlink("sub", theirs_ / "link");
  ASSERT_EQ(::lchown((theirs_ / "link").c_str(), kOther, kOther), 0);
  EXPECT_FALSE(OutputFolder(theirs_ / "link/.").made()) << "a link to a folder of their own";
}

/// The owner of a link must still own its target.
TEST_F(SwappedFolder, TargetOfAnotherOwner_IsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  constexpr uid_t kOther = 65534;
  std::ofstream(theirs_ / "sub/out") << "old";
  fs::create_symlink("sub/out", theirs_ / "link");
  for (const char* name : {"", "sub", "sub/out"})
    ASSERT_EQ(::chown((theirs_ / name).c_str(), kOther, kOther), 0);
  ASSERT_EQ(::lchown((theirs_ / "link").c_str(), kOther, kOther), 0);
  const OutputTarget target = follow_output(theirs_ / "link");
  EXPECT_EQ(target.strangers, std::vector{kOther});
  EXPECT_GE(folder_of(target).get(), 0);
  ASSERT_EQ(::chown((theirs_ / "sub/out").c_str(), 0, 0), 0);
  expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to",
               [&] { (void)folder_of(target); });
}

}  // namespace
}  // namespace cde::testing
