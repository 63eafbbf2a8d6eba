// SPDX-License-Identifier: Apache-2.0
// Output files: complete or absent, without harm to other files.
#include "cde/support/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <thread>

#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, CompleteFile_ReplacesTheOldOne) {
  const Folder folder;
  folder.write("a", "old");
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  {
    OutputFile left(folder / "a");
    left.write("half");
    EXPECT_EQ(folder.files(), 2u);
  }
  EXPECT_EQ(bytes_of(folder / "a"), "old");
  EXPECT_EQ(folder.files(), 1u) << "no unfinished file may be left";
  const std::string mode_before =
      fmt::format("{:o}", static_cast<unsigned>(fs::status(folder / "a").permissions()));
  OutputFile file(folder / "a");
  file.write("new");
  EXPECT_EQ(bytes_of(folder / "a"), "old");
  file.commit();
  EXPECT_EQ(bytes_of(folder / "a"), "new");
  EXPECT_EQ(folder.files(), 1u);
  EXPECT_EQ(fmt::format("{:o}", static_cast<unsigned>(fs::status(folder / "a").permissions())),
            mode_before);
  const mode_t mask = ::umask(027);
  write_file(folder / "b", "b");
  ::umask(mask);
  EXPECT_EQ(static_cast<unsigned>(fs::status(folder / "b").permissions()), 0640u);
}

TEST(OutputFile, UnfinishedFile_OfAnOldOneIsPrivate) {
  const Folder folder;
  const auto mode_of = [](const fs::path& file) {
    return static_cast<unsigned>(fs::status(file).permissions());
  };
  const mode_t mask = ::umask(022);
  for (const unsigned mode : {0600u, 0640u, 0664u}) {
    for (const bool removed : {false, true}) {  // the old file, before the new one is complete
      folder.write("a", "old");
      fs::permissions(folder / "a", fs::perms{mode});
      OutputFile file(folder / "a");
      for (const auto& entry : fs::directory_iterator(folder / "")) {
        if (is_unfinished_name(entry.path().filename().native())) {
          EXPECT_EQ(mode_of(entry.path()), 0600u) << fmt::format("{:o}", mode);
        }
      }
      if (removed) fs::remove(folder / "a");
      file.commit();
      EXPECT_EQ(mode_of(folder / "a"), mode);
    }
  }
  ::umask(mask);
}

TEST(OutputFile, Links_StayLinks) {
  const Folder folder;
  fs::create_directory(folder / "there");
  folder.write("there/target", "old");
  fs::create_symlink("there/target", folder / "link");
  fs::create_symlink(folder / "link", folder / "to_link");
  fs::create_symlink("there/new", folder / "dangling");
  write_file(folder / "to_link", "one");
  write_file(folder / "dangling", "two");
  for (const char* link : {"link", "to_link", "dangling"})
    EXPECT_TRUE(fs::is_symlink(folder / link)) << link;
  EXPECT_EQ(bytes_of(folder / "there/target"), "one");
  EXPECT_EQ(bytes_of(folder / "there/new"), "two");
  fs::create_symlink("circle", folder / "circle");
  expect_error(ErrorCode::kFile, "circle: cannot write: Too many levels",
               [&] { write_file(folder / "circle", ""); });
}

TEST(OutputFile, LinkIntoAMissingFolder_NamesTheTarget) {
  const Folder folder;
  folder.write("file", "a file");
  fs::create_symlink("none/new", folder / "nowhere");
  fs::create_symlink("file/new", folder / "below");
  fs::create_symlink("nowhere", folder / "twice");
  for (const char* link : {"nowhere", "twice"})
    expect_error(ErrorCode::kFile,
                 fmt::format("{}: cannot create: it is a link to none/new, whose folder does not "
                             "exist",
                             link),
                 [&] { write_file(folder / link, "x"); });
  expect_error(ErrorCode::kFile, "below: cannot create: it is a link to file/new, whose folder is",
               [&] { write_file(folder / "below", "x"); });
  EXPECT_EQ(folder.files(), 4u);
}

TEST(OutputFolder, DanglingLink_CreatesItsTarget) {
  const Folder folder;
  fs::create_directory(folder / "there");
  folder.write("file", "a file");
  fs::create_symlink("there/new/", folder / "link");
  fs::create_symlink(folder / "link", folder / "to_link");
  {
    const OutputFolder made(folder / "to_link/inner");
    EXPECT_TRUE(made.made());
    write_file(folder / "to_link/inner/a", "a");
    EXPECT_EQ(bytes_of(folder / "there/new/inner/a"), "a");
    made.check();
    fs::remove(folder / "there/new/inner/a");
  }
  EXPECT_TRUE(fs::is_empty(folder / "there")) << "made folders must be removed where they are";
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  fs::create_symlink("none/new", folder / "nowhere");
  fs::create_symlink("file/new", folder / "below");
  expect_error(ErrorCode::kFile,
               "nowhere: cannot create: it is a link to none/new, whose folder does not exist",
               [&] { (void)OutputFolder(folder / "nowhere"); });
  expect_error(ErrorCode::kFile,
               "below: cannot create: ", [&] { (void)OutputFolder(folder / "below"); });
}

/// A stranger's link could choose where our folder is created.
TEST(OutputFolder, DanglingLinkOfAnotherUser_IsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  const Folder folder;
  fs::create_symlink("new", folder / "link");
  ASSERT_EQ(::lchown((folder / "link").c_str(), 65534, 65534), 0);
  expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to new, which does not exist",
               [&] { (void)OutputFolder(folder / "link"); });
  EXPECT_EQ(folder.files(), 1u);
}

TEST(OutputFile, SpecialFiles_AreWrittenDirectly) {
  const Folder folder;
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = bytes_of(folder / "fifo"); });
  {
    // By name, as for waves: some writers need a seekable file.
    OutputFile file(folder / "fifo", OutputFile::Use::kByName);
    std::ofstream(file.by_name()) << "by name";
    file.commit();
  }
  reader.join();
  EXPECT_EQ(got, "by name");
  EXPECT_TRUE(fs::is_fifo(folder / "fifo"));
  EXPECT_EQ(folder.files(), 1u);
  write_file("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (::mknod((folder / "null").c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0) {
    write_file(folder / "null", "x");
    EXPECT_TRUE(fs::is_character_file(folder / "null"));
  }
  expect_error(ErrorCode::kFile, "/dev/full: cannot write: No space left on device",
               [&] { write_file("/dev/full", "x"); });
}

/// A descriptor from the shell continues at its position, even in a file.
TEST(OutputFile, Descriptors_ContinueAtTheirPosition) {
  const Folder folder;
  const int fd = ::open((folder / "log").c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(::write(fd, "head\n", 5), 5);
  write_file(fmt::format("/dev/fd/{}", fd), "one\n");
  write_file(fmt::format("/proc/self/fd/{}", fd), "two\n");
  ::close(fd);
  EXPECT_EQ(bytes_of(folder / "log"), "head\none\ntwo\n");
  EXPECT_EQ(folder.files(), 1u);
  expect_error(ErrorCode::kFile, fmt::format("/dev/fd/{}: cannot write: Bad file descriptor", fd),
               [&] { write_file(fmt::format("/dev/fd/{}", fd), "x"); });
}

TEST(OutputFile, UnwritableOutputs_AreNamed) {
  const Folder folder;
  fs::create_directory(folder / "folder");
  expect_error(ErrorCode::kFile, "none/a: cannot create: No such file or directory",
               [&] { OutputFile(folder / "none/a"); });
  expect_error(ErrorCode::kFile, "folder: cannot write: Is a directory",
               [&] { OutputFile(folder / "folder"); });
  expect_error(ErrorCode::kFile, "folder/: cannot write: Is a directory",
               [&] { OutputFile(folder / "folder/"); });
  EXPECT_EQ(folder.files(), 1u);
  const std::string longest(255, 'n');  // the longest name that a file can have
  write_file(folder / longest, "fits");
  EXPECT_EQ(bytes_of(folder / longest), "fits");
}

/// The next writer of a name removes the unfinished file of a killed process. Files of other users
/// and files in use stay.
TEST(OutputFile, AbandonedFiles_AreRemoved) {
  const Folder folder;
  const auto die_writing = [&](const std::string& name) {
    const pid_t child = ::fork();
    if (child == 0) {
      OutputFile file(folder / name);
      file.write("half");
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  };
  ASSERT_TRUE(die_writing("a"));
  ASSERT_TRUE(die_writing("a"));
  ASSERT_TRUE(die_writing("b"));
  ASSERT_EQ(folder.files(), 2u) << "the second writer must remove the first one's unfinished file";
  folder.write("a.cde-1-abcdef", "in use: process 1 lives");
  folder.write("a.cde-x-abcdef", "no number");
  folder.write("a.cde-999999999-abcdefg", "too long");
  folder.write("a.abcdef", "of somebody");
  std::optional<OutputFile> used(folder / "a");  // in use by this process, and locked
  write_file(folder / "a", "whole");
  EXPECT_EQ(folder.files(), 4u + 1 + 1 + 1)
      << "expected: those files, one of b, the one in use, and a";
  used->write("later");
  used->commit();
  EXPECT_EQ(bytes_of(folder / "a"), "later");
  sweep_unfinished(folder / "");
  EXPECT_EQ(folder.files(), 5u) << "the unfinished file of b must also be gone";
}

TEST(OutputFile, FilesOfAZombie_AreRemoved) {
  const Folder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    OutputFile file(folder / "a");
    ::kill(::getpid(), SIGKILL);
  }
  siginfo_t died{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &died, WEXITED | WNOWAIT), 0);
  ASSERT_EQ(folder.files(), 1u);
  sweep_unfinished(folder / "");
  EXPECT_EQ(folder.files(), 0u);
  ::waitpid(child, nullptr, 0);
}

TEST(OutputFile, Signals_RemoveUnfinishedFiles) {
  const Folder folder;
  OutputFile one(folder / "one");
  std::vector<std::unique_ptr<OutputFile>> many;
  for (int i = 0; i < 20; ++i)
    many.push_back(std::make_unique<OutputFile>(folder / fmt::format("{}", i)));
  many[3]->commit();
  ASSERT_EQ(folder.files(), 21u);
  OutputFile::remove_unfinished();
  EXPECT_EQ(folder.files(), 1u);
}

/// Another user owns the folder and replaces the unfinished file by a link to one of our files.
class ForeignFolder : public ::testing::Test {
 protected:
  static constexpr uid_t kOther = 65534;

  void SetUp() override {
    mine_.write("secret", "secret");
    ASSERT_EQ(::chmod((mine_ / "secret").c_str(), 0600), 0);
    theirs_.write("out", "old");
    ASSERT_EQ(::chmod((theirs_ / "out").c_str(), 0666), 0);
    if (::geteuid() != 0) return;  // one user plays both roles
    ASSERT_EQ(::chown((theirs_ / "").c_str(), kOther, kOther), 0);
    ASSERT_EQ(::chown((theirs_ / "out").c_str(), kOther, kOther), 0);
  }
  void replace_unfinished() const {
    for (const auto& entry : fs::directory_iterator(theirs_ / "")) {
      if (!is_unfinished_name(entry.path().filename().native())) continue;
      fs::remove(entry.path());
      fs::create_symlink(mine_ / "secret", entry.path());
    }
  }
  void expect_secret() const {
    struct stat info {};
    ASSERT_EQ(::lstat((mine_ / "secret").c_str(), &info), 0);
    EXPECT_EQ(info.st_uid, ::geteuid());
    EXPECT_EQ(info.st_mode & 07777u, 0600u);
    EXPECT_EQ(bytes_of(mine_ / "secret"), "secret");
  }

  const Folder mine_, theirs_;
};

TEST_F(ForeignFolder, LinkTarget_GivesNeitherOwnerNorMode) {
  OutputFile file(theirs_ / "out");
  file.write("new");
  replace_unfinished();
  expect_error(ErrorCode::kFile, "another user of its folder has replaced", [&] { file.commit(); });
  expect_secret();
  EXPECT_EQ(bytes_of(theirs_ / "out"), "old");
}

TEST_F(ForeignFolder, SwappedLink_GetsNoDataByName) {
  OutputFile file(theirs_ / "out", OutputFile::Use::kByName);
  replace_unfinished();
  std::ofstream(file.by_name()) << "waves";
  expect_secret();
  EXPECT_EQ(bytes_of(file.by_name()), "waves");
}

TEST_F(ForeignFolder, Links_LeadOnlyToFilesOfTheirOwner) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  fs::create_symlink(mine_ / "secret", theirs_ / "to_secret");
  fs::create_symlink(mine_ / "new", theirs_ / "to_new");
  fs::create_symlink("out", theirs_ / "to_out");
  for (const char* link : {"to_secret", "to_new", "to_out"})
    ASSERT_EQ(::lchown((theirs_ / link).c_str(), kOther, kOther), 0);
  for (const char* link : {"to_secret", "to_new"})
    expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to",
                 [&] { write_file(theirs_ / link, "overwritten"); });
  expect_secret();
  EXPECT_EQ(mine_.files(), 1u);
  write_file(theirs_ / "to_out", "new");
  EXPECT_EQ(bytes_of(theirs_ / "out"), "new");
}

/// The descriptor of a file of ours, which their links could name without knowing the file.
TEST_F(ForeignFolder, LinksToDescriptors_AreRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  const int fd = ::open((mine_ / "secret").c_str(), O_WRONLY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  const fs::path link = theirs_ / "link", indirect = mine_ / "indirect";
  fs::create_symlink(link, indirect);
  for (const std::string& to :
       {fmt::format("/proc/self/fd/{}", fd), fmt::format("/dev/fd/{}", fd),
        fmt::format("/proc/{}/fd/{}", ::getpid(), fd), std::string("/dev/stdout")}) {
    fs::create_symlink(to, link);
    ASSERT_EQ(::lchown(link.c_str(), kOther, kOther), 0);
    for (const fs::path& name : {link, indirect}) {
      expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to",
                   [&] { write_file(name, "overwritten"); });
      expect_error(ErrorCode::kFile, "it is a link owned by user 65534 to", [&] {
        check_outputs(std::vector<FileUse>{{"-o", name}}, {});
      });
    }
    fs::remove(link);
  }
  fs::create_symlink("/proc/self/fd", link);  // a link in the path
  expect_error(ErrorCode::kFile, "its folder is a link to /proc/self/fd",
               [&] { write_file(link / std::to_string(fd), "overwritten"); });
  expect_secret();
  fs::create_symlink(fmt::format("/dev/fd/{}", fd), mine_ / "own");
  write_file(mine_ / "own", "new");
  ::close(fd);
  EXPECT_EQ(bytes_of(mine_ / "secret"), "newret") << "our own link";
}

/// Their link leads to another user's link, which leads to that user's file.
TEST_F(ForeignFolder, LinksOfTwoUsers_AreRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  constexpr uid_t kThird = 65533;
  const fs::path out = theirs_ / "out", current = theirs_ / "current", first = theirs_ / "first";
  fs::create_symlink("out", current);
  fs::create_symlink("current", first);
  ASSERT_EQ(::lchown(first.c_str(), kOther, kOther), 0);
  ASSERT_EQ(::lchown(current.c_str(), kThird, kThird), 0);
  for (const uid_t owner : {kThird, kOther}) {
    ASSERT_EQ(::chown(out.c_str(), owner, owner), 0);
    expect_error(ErrorCode::kFile,
                 fmt::format("it is a link owned by user {} to", owner == kThird ? kOther : kThird),
                 [&] { write_file(first, "overwritten"); });
    EXPECT_EQ(bytes_of(out), "old");
  }
  ASSERT_EQ(::lchown(current.c_str(), kOther, kOther), 0);
  write_file(first, "new");
  EXPECT_EQ(bytes_of(out), "new") << "both links and the file are one user's";
}

TEST(CheckOutputs, TwoOutputsInOneFile_AreRefused) {
  const Folder folder;
  folder.write("a", "");
  fs::create_hard_link(folder / "a", folder / "hard");
  fs::create_symlink("a", folder / "soft");
  fs::create_symlink("not_there", folder / "dangling");
  fs::create_directory_symlink(".", folder / "here");
  const auto both = [&](const fs::path& a, const fs::path& b) {
    check_outputs(std::vector<FileUse>{{"-o", a}, {"--none", ""}, {"--image", b}}, {});
  };
  const std::vector<std::pair<const char*, const char*>> same = {
      {"a", "a"},          {"a", "here/a"},          {"a", "hard"},    {"a", "soft"},
      {"new", "here/new"}, {"new", "here/here/new"}, {"soft", "hard"}, {"dangling", "not_there"}};
  for (const auto& [a, b] : same)
    expect_error(ErrorCode::kUsage, "-o and --image both write to",
                 [&, x = a, y = b] { both(folder / x, folder / y); });
  expect_error(ErrorCode::kUsage, "-o and --image both write to stdout", [&] { both("-", "-"); });
  expect_error(ErrorCode::kUsage, "-o and --image both write to", [&] { both("-", "/dev/fd/1"); });
  both(folder / "a", folder / "new");
  both(folder / "new", folder / "other");
  both("/dev/null", "/dev/null");
  expect_error(ErrorCode::kFile, "none/x: cannot create", [&] { both("-", folder / "none/x"); });
}

TEST(CheckOutputs, OutputOverAnInput_IsRefused) {
  const Folder folder;
  folder.write("in", "");
  fs::create_hard_link(folder / "in", folder / "hard");
  fs::create_symlink("in", folder / "soft");
  const auto check = [&](const fs::path& in, const fs::path& out) {
    check_outputs(std::vector<FileUse>{{"-o", out}}, std::vector<FileUse>{{"MESH", in}});
  };
  for (const char* in : {"in", "hard", "soft"})
    for (const char* out : {"in", "hard", "soft"})
      expect_error(ErrorCode::kUsage, ", which MESH reads",
                   [&] { check(folder / in, folder / out); });
  check(folder / "in", folder / "out");
  check("terrain", folder / "out");
  check("/dev/null", "/dev/null");
}

}  // namespace
}  // namespace cde::testing
