// SPDX-License-Identifier: Apache-2.0
// Owner, mode and ACL of output files, in folders that another user owns or watches.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <thread>
#include <vector>

#include "cde/support/output_file.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr uid_t kOther = 65534;

struct stat status_of(const fs::path& file) {
  struct stat info {};
  EXPECT_EQ(::lstat(file.c_str(), &info), 0) << file;
  return info;
}
unsigned mode_of(const fs::path& file) {
  return status_of(file).st_mode & 07777u;
}

struct AclEntry {
  std::uint16_t tag, permissions;
  std::uint32_t id = ~0u;
};
/// An ACL that lets another user do the same as the group.
bool set_acl(const fs::path& file, const char* kind, std::uint16_t group, std::uint16_t mask,
             std::uint16_t other) {
  const std::vector<AclEntry> entries{
      {0x01, 6}, {0x02, 6, kOther}, {0x04, group}, {0x10, mask}, {0x20, other}};
  std::string acl("\2\0\0\0", 4);
  acl.append(reinterpret_cast<const char*>(entries.data()), entries.size() * sizeof entries[0]);
  return ::setxattr(file.c_str(), kind, acl.data(), acl.size(), 0) == 0;
}
constexpr const char* kAccess = "system.posix_acl_access";
constexpr const char* kDefault = "system.posix_acl_default";

std::string acl_of(const fs::path& file) {
  std::string acl(4096, '\0');
  const ssize_t size = ::getxattr(file.c_str(), kAccess, acl.data(), acl.size());
  return acl.substr(0, size > 0 ? static_cast<std::size_t>(size) : 0);
}

fs::path unfinished_in(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_unfinished_name(entry.path().filename().native())) return entry.path();
  return {};
}

/// A user who could open the unfinished file could hold its lock, for which cde would wait.
TEST(OutputAccess, UnfinishedNewFile_IsPrivate) {
  const Folder folder;
  const mode_t mask = ::umask(022);
  OutputFile file(folder / "new");
  EXPECT_EQ(mode_of(unfinished_in(folder / "")), 0600u);
  file.write("new");
  file.commit();
  OutputFile ready(folder / "ready");
  ready.set_mode(0755);
  EXPECT_EQ(mode_of(unfinished_in(folder / "")), 0600u);
  ready.commit();
  ::umask(mask);
  EXPECT_EQ(mode_of(folder / "new"), 0644u);
  EXPECT_EQ(mode_of(folder / "ready"), 0755u);
}

TEST(OutputAccess, DefaultAcl_HoldsOnlyForNewFiles) {
  const Folder folder;
  const fs::path old = folder / "old";
  for (const std::uint16_t mask : {6, 4}) {
    for (const std::uint16_t other : {4, 0}) {
      folder.write("old", "secret");
      (void)::removexattr(old.c_str(), kAccess);
      ASSERT_EQ(::chmod(old.c_str(), 0640), 0);
      if (!set_acl(folder / "", kDefault, 4, mask, other))
        GTEST_SKIP() << "no ACLs: " << std::strerror(errno);
      write_file(old, "new secret");
      EXPECT_EQ(acl_of(old), "") << "another user could read the new file, but not the old one";
      EXPECT_EQ(mode_of(old), 0640u);
      for (const mode_t umask : {022, 077}) {
        const mode_t before = ::umask(umask);
        write_file(folder / "new", "new");
        folder.write("plain", "new");
        ::umask(before);
        EXPECT_EQ(mode_of(folder / "new"), mode_of(folder / "plain"));
        EXPECT_EQ(acl_of(folder / "new"), acl_of(folder / "plain"));
        fs::remove(folder / "new");
        fs::remove(folder / "plain");
      }
    }
  }
}

/// The bits of the group in the mode are the ACL's mask: the group itself may have none.
TEST(OutputAccess, AclOfTheOldFile_Stays) {
  const Folder folder;
  const fs::path old = folder / "old";
  for (const bool removed : {false, true}) {
    folder.write("old", "secret");
    if (!set_acl(old, kAccess, 0, 6, 0)) GTEST_SKIP() << "no ACLs: " << std::strerror(errno);
    const std::string acl = acl_of(old);
    ASSERT_EQ(mode_of(old), 0660u);
    OutputFile file(old);
    if (removed) fs::remove(old);
    file.commit();
    EXPECT_EQ(acl_of(old), removed ? "" : acl);
    EXPECT_EQ(mode_of(old), removed ? 0600u : 0660u);
  }
}

/// A folder of another user, who exchanges files in it. Root plays both.
class ExchangedFile : public ::testing::Test {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
    give("");
  }
  void give(const std::string& name) const {
    ASSERT_EQ(::lchown((theirs_ / name).c_str(), kOther, kOther), 0);
  }
  /// Puts a file of the other user, which all can read and write, at the output's name.
  void put_theirs() const {
    std::error_code none;
    fs::rename(out_, theirs_ / "away", none);
    theirs_.write("out", "theirs");
    give("out");
    ASSERT_EQ(::chmod(out_.c_str(), 0666), 0);
  }
  void check() const { check_outputs(std::vector<FileUse>{{"-o", out_}}, {}); }
  void expect_refused(OutputFile& file) const {
    expect_error(ErrorCode::kFile, "out: cannot write: another user of its folder has replaced it",
                 [&] { file.commit(); });
    EXPECT_EQ(bytes_of(out_), "theirs");
  }

  const Folder theirs_;
  const fs::path out_ = theirs_ / "out";
};

TEST_F(ExchangedFile, OurFile_IsNotGivenAway) {
  theirs_.write("out", "secret");
  ASSERT_EQ(::chmod(out_.c_str(), 0600), 0);
  for (const bool checked : {true, false}) {
    if (checked) check();
    if (checked) put_theirs();
    OutputFile file(out_);
    if (!checked) put_theirs();
    expect_refused(file);
    fs::rename(theirs_ / "away", out_);
  }
}

TEST_F(ExchangedFile, NameThatWasFree_IsNotWritten) {
  for (const bool checked : {true, false}) {
    fs::remove(out_);
    if (checked) check();
    if (checked) put_theirs();
    OutputFile file(out_);
    if (!checked) put_theirs();
    expect_refused(file);
  }
}

/// A FIFO or a link at a name that was free would get the data.
TEST_F(ExchangedFile, FifoOrLink_GetsNoData) {
  check();
  ASSERT_EQ(::mkfifo(out_.c_str(), 0600), 0);
  give("out");
  const int reader = ::open(out_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  expect_error(ErrorCode::kFile, "another user of its folder has replaced it",
               [&] { write_file(out_, "data"); });
  ::close(reader);
  fs::remove(out_);
  theirs_.write("else", "theirs");
  give("else");
  fs::create_symlink("else", out_);
  give("out");
  expect_error(ErrorCode::kFile, "another user of its folder has replaced it",
               [&] { write_file(out_, "data"); });
  EXPECT_EQ(bytes_of(theirs_ / "else"), "theirs");
}

TEST_F(ExchangedFile, TheirFileAtTheStart_StaysTheirs) {
  put_theirs();
  check();
  for (const char* text : {"one", "two"}) {  // a command may write an output twice
    write_file(out_, text);
    EXPECT_EQ(bytes_of(out_), text);
    EXPECT_EQ(status_of(out_).st_uid, kOther);
    EXPECT_EQ(mode_of(out_), 0666u);
  }
}

/// Another file of the same user, as an editor or a second run leaves it, is replaced. It gives the
/// output no rights that the first file did not give.
TEST_F(ExchangedFile, AnotherFileOfOurs_IsReplaced) {
  theirs_.write("out", "ours");
  ASSERT_EQ(::chmod(out_.c_str(), 0640), 0);
  check();
  fs::rename(out_, theirs_ / "away");
  theirs_.write("out", "ours again");
  ASSERT_EQ(::chmod(out_.c_str(), 0666), 0);
  write_file(out_, "new");
  EXPECT_EQ(bytes_of(out_), "new");
  EXPECT_EQ(status_of(out_).st_uid, 0u);
  EXPECT_EQ(mode_of(out_), 0640u);
}

TEST_F(ExchangedFile, TheirFifo_NeedsAReader) {
  ASSERT_EQ(::mkfifo(out_.c_str(), 0666), 0);
  give("out");
  for (const auto use : {OutputFile::Use::kBytes, OutputFile::Use::kByName})
    expect_error(ErrorCode::kFile, "out: cannot write: it is a FIFO of user 65534 that no process",
                 [&] { OutputFile(out_, use); });
  const int reader = ::open(out_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  std::thread writer([&] { write_file(out_, std::string(200'000, 'x')); });  // waits for room
  ASSERT_EQ(::fcntl(reader, F_SETFL, 0), 0);
  std::size_t got = 0;
  std::string block(4096, '\0');
  while (got < 200'000) {
    const ssize_t some = ::read(reader, block.data(), block.size());
    if (some > 0) got += static_cast<std::size_t>(some);
    if (some == 0) std::this_thread::yield();  // the writer has not begun
  }
  writer.join();
  ::close(reader);
  EXPECT_EQ(got, 200'000u);
}

}  // namespace
}  // namespace cde::testing
