// SPDX-License-Identifier: Apache-2.0
// Folders that cde makes inside another user's folder, and the package of a failure in them.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "cde/explain/bundle.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/scratch.hpp"
#include "testing.hpp"

namespace {
/// What the other user does once the library has made a folder.
std::function<void()> after_mkdir;
}  // namespace

/// The library calls this one instead of the system's.
extern "C" int mkdirat(int folder, const char* name, mode_t mode) noexcept {
  const long made = ::syscall(SYS_mkdirat, folder, name, mode);
  if (made == 0 && after_mkdir) after_mkdir();
  return static_cast<int>(made);
}

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr uid_t kStranger = 65534;

class MadeFolder : public ::testing::Test {
 protected:
  ~MadeFolder() override { after_mkdir = nullptr; }
  void give(const std::string& name) const {
    ASSERT_EQ(::lchown((theirs_ / name).c_str(), kStranger, kStranger), 0);
  }
  const Folder mine_, theirs_;
  const fs::path new_ = theirs_ / "new";
};

TEST_F(MadeFolder, ExchangedAtOnce_IsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  give("");
  fs::create_directory(theirs_ / "evil");
  give("evil");
  for (const bool link : {false, true}) {
    after_mkdir = [&] {
      fs::remove(new_);
      if (link)
        fs::create_directory_symlink("evil", new_);
      else
        fs::rename(theirs_ / "evil", new_);
    };
    expect_error(ErrorCode::kFile, "new: cannot write: another user of its folder has replaced it",
                 [&] { OutputFolder made(new_); });
    EXPECT_TRUE(fs::is_empty(new_));
    if (!link) fs::rename(new_, theirs_ / "evil");
  }
}

TEST_F(MadeFolder, FolderWithFiles_IsNotTakenAsNew) {
  after_mkdir = [&] { theirs_.write("new/of another run", ""); };
  OutputFolder made(new_);
  EXPECT_FALSE(made.made());
  after_mkdir = nullptr;
  OutputFolder other(theirs_ / "a/b");
  EXPECT_TRUE(other.made());
}

TEST_F(MadeFolder, DefaultAclAboveIt_IsNotInherited) {
  std::string acl("\2\0\0\0", 4);
  const auto add = [&acl](std::uint16_t tag, std::uint32_t id) {
    const std::uint16_t all = 7;
    acl.append(reinterpret_cast<const char*>(&tag), sizeof tag);
    acl.append(reinterpret_cast<const char*>(&all), sizeof all);
    acl.append(reinterpret_cast<const char*>(&id), sizeof id);
  };
  add(0x01, ~0u), add(0x02, kStranger), add(0x04, ~0u), add(0x10, ~0u), add(0x20, ~0u);
  if (::setxattr((theirs_ / "").c_str(), "system.posix_acl_default", acl.data(), acl.size(), 0) !=
      0)
    GTEST_SKIP() << "no ACLs: " << std::strerror(errno);
  mode_t first = 07777;
  after_mkdir = [&] {
    struct stat info {};
    if (::stat(new_.c_str(), &info) == 0) first = info.st_mode & 07777;
  };
  const mode_t mask = ::umask(022);
  OutputFolder made(new_);
  ::umask(mask);
  EXPECT_EQ(first, 0700u) << "another user could put files into it before its ACL is removed";
  for (const char* kind : {"system.posix_acl_access", "system.posix_acl_default"})
    EXPECT_LE(::getxattr(new_.c_str(), kind, nullptr, 0), 0) << kind;
  EXPECT_EQ(static_cast<unsigned>(fs::status(new_).permissions()), 0755u);
}

/// The other user owns the folder of temporary files and exchanges ours.
TEST_F(MadeFolder, ExchangedScratch_GetsNoFiles) {
  mine_.write("secret", "secret");
  fs::create_directory(theirs_ / "evil");
  fs::create_symlink(mine_ / "secret", theirs_ / "evil/waves.fst");
  const char* const before = std::getenv("TMPDIR");
  ::setenv("TMPDIR", (theirs_ / "").c_str(), 1);
  std::optional<Scratch> scratch(std::in_place, "cde-test");
  if (before != nullptr)
    ::setenv("TMPDIR", before, 1);
  else
    ::unsetenv("TMPDIR");
  fs::path name;
  for (const auto& entry : fs::directory_iterator(theirs_ / ""))
    if (entry.path().filename() != "evil") name = entry.path();
  fs::rename(name, theirs_ / "away");
  fs::rename(theirs_ / "evil", name);
  std::ofstream(*scratch / "waves.fst") << "waves";
  EXPECT_EQ(bytes_of(mine_ / "secret"), "secret");
  EXPECT_EQ(bytes_of(theirs_ / "away/waves.fst"), "waves");
  scratch.reset();
  EXPECT_TRUE(fs::is_symlink(name / "waves.fst")) << "a file of the other folder was removed";
  EXPECT_TRUE(fs::is_empty(theirs_ / "away"));
}

/// The other user may write in the package's folder, and puts a link at each name that is free.
TEST_F(MadeFolder, WavesOfAFailure_FollowNoLink) {
  mine_.write("secret", "secret");
  Failure failure{.kind = HangFailure{}, .message = "it stopped"};
  failure.rerun = [&](const std::string& file, const TraceOptions&) {
    EXPECT_TRUE(fs::is_empty(new_)) << "the waves have a name there";
    ::unlink(file.c_str());  // as Verilator's writer does
    fs::create_symlink(mine_ / "secret", new_ / fs::path(file).filename());
    std::error_code none;
    fs::create_symlink(mine_ / "secret", new_ / "whole.fst", none);
    std::FILE* const waves = std::fopen(file.c_str(), "w+b");
    EXPECT_NE(waves, nullptr);
    if (waves == nullptr) return true;
    std::fputs("no waves", waves);
    std::fclose(waves);
    return true;
  };
  EXPECT_NE(pack(new_, failure).missing, "");
  EXPECT_EQ(bytes_of(mine_ / "secret"), "secret");
  EXPECT_TRUE(fs::exists(new_ / "fail.json"));
}

/// The command that asks for the package may be ended by a signal meanwhile, as may this process.
TEST_F(MadeFolder, InterruptedPackage_LeavesNothing) {
  struct Ended {};
  Failure failure{.kind = HangFailure{}, .message = "it stopped"};
  failure.files = {{"pairs.txt", "1 | 2\n"}};
  for (const bool signal : {false, true}) {
    failure.rerun = [&](const std::string&, const TraceOptions&) -> bool {
      EXPECT_TRUE(fs::exists(new_ / "pairs.txt"));
      if (signal) OutputFile::remove_unfinished();
      EXPECT_EQ(fs::exists(new_), !signal);
      throw Ended();
    };
    EXPECT_THROW((void)pack(new_, failure), Ended);
    EXPECT_FALSE(fs::exists(new_));
  }
}

}  // namespace
}  // namespace cde::testing
