// SPDX-License-Identifier: Apache-2.0
// Text entries in the cache beside the simulation models: which are read back, and which are not.
#include "cde/model/cache_entry.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/xattr.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "../expect_error.hpp"
#include "../has.hpp"
#include "cde/model/model.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

class CacheEntry : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cde-entry-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    ::setenv("CDE_CACHE", (folder_ / "cache").c_str(), 1);
  }
  void TearDown() override {
    ::unsetenv("CDE_CACHE");
    fs::remove_all(folder_);
  }
  [[nodiscard]] fs::path file(const char* suffix = "") const {
    return folder_ / "cache" / (std::string("entry") + suffix);
  }
  /// The entry is not read, a reason is printed, and a new entry can be read.
  static void expect_refused(const std::string& why) {
    ::testing::internal::CaptureStderr();
    EXPECT_FALSE(read_cache_entry("entry"));
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_TRUE(has(said, why));
    write_cache_entry("entry", "text\n");
    EXPECT_EQ(read_cache_entry("entry"), "text\n") << why;
  }
  fs::path folder_;
};

TEST_F(CacheEntry, WrittenEntry_ReadsBackEqual) {
  EXPECT_FALSE(read_cache_entry("entry"));
  EXPECT_FALSE(fs::exists(folder_ / "cache")) << "reading must create no folder";
  const mode_t before = ::umask(0);
  const std::string text("a\0b\n", 4);
  write_cache_entry("entry", text);
  ::umask(before);
  EXPECT_EQ(read_cache_entry("entry"), text);
  for (const fs::path& path : {folder_ / "cache", file(), file(".sha256")}) {
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0) << path;
    EXPECT_EQ(status.st_mode & 022, 0u) << path;
  }
}

TEST_F(CacheEntry, DamagedOrForeignEntry_IsNotRead) {
  write_cache_entry("entry", "text\n");
  std::ofstream(file()) << "texd\n";
  expect_refused("is damaged: its checksum differs");
  fs::remove(file(".sha256"));
  expect_refused("has no checksum beside it");
  ::chmod(file().c_str(), 0664);
  expect_refused("can be written by others than its owner");
  ::chmod(file(".sha256").c_str(), 0666);
  expect_refused("can be written by others than its owner");
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown(file().c_str(), 65534, 65534), 0);
    expect_refused("belongs to");
  }
  ::chmod((folder_ / "cache").c_str(), 0777);
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(read_cache_entry("entry"));
  EXPECT_TRUE(
      has(::testing::internal::GetCapturedStderr(), "cache is not used: it can be written"));
  write_cache_entry("entry", "other\n");  // no error, and the entry is not stored
  ::chmod((folder_ / "cache").c_str(), 0700);
  EXPECT_EQ(read_cache_entry("entry"), "text\n");
}

/// An entry that was copied to another entry's name, as by hand.
TEST_F(CacheEntry, EntryOfAnotherName_IsNotRead) {
  write_cache_entry("other", "text of the other\n");
  std::string sum;
  std::getline(std::ifstream(folder_ / "cache/other.sha256"), sum);
  fs::copy_file(folder_ / "cache/other", file());
  std::ofstream(file(".sha256")) << sum.substr(0, sum.find(' ')) << "  entry\n";
  expect_refused("is damaged: its checksum differs");
}

TEST_F(CacheEntry, FifoOrFolderAsEntry_IsRefusedAtOnce) {
  for (const char* suffix : {"", ".sha256"}) {
    write_cache_entry("entry", "text\n");
    fs::remove(file(suffix));
    ASSERT_EQ(::mkfifo(file(suffix).c_str(), 0600), 0);
    expect_refused(*suffix == '\0' ? "is no readable file" : "has no checksum beside it");
  }
  fs::remove(file());
  fs::create_directory(file());
  ASSERT_EQ(::chmod(file().c_str(), 0700), 0);
  expect_refused("is no readable file");
  fs::remove(file());
  fs::create_directories(file() / "a");
  ::testing::internal::CaptureStderr();
  write_cache_entry("entry", "text\n");
  EXPECT_TRUE(has(::testing::internal::GetCapturedStderr(),
                  "cde: entry is not kept in the cache: " + file().string() + ": cannot write: "))
      << "a folder with files stays";
  EXPECT_TRUE(fs::exists(file() / "a"));
}

TEST_F(CacheEntry, FifoAsChecksumOfAModel_IsSkipped) {
  const fs::path fifo = model_cache() / "0.so.sha256";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  (void)built_models("card");  // does not wait for a writer
}

/// A default ACL: files that are created in the folder get these permissions, and the umask is
/// ignored. False if the file system has no ACLs.
bool set_default_acl(const fs::path& folder, std::uint16_t group, std::uint16_t other) {
  struct {
    std::uint32_t version = 2;
    struct {
      std::uint16_t tag, permissions;
      std::uint32_t id = ~0u;
    } entries[3];
  } acl{};
  acl.entries[0] = {0x01, 7};
  acl.entries[1] = {0x04, group};
  acl.entries[2] = {0x20, other};
  return ::setxattr(folder.c_str(), "system.posix_acl_default", &acl, sizeof acl, 0) == 0;
}

TEST_F(CacheEntry, DefaultAclAboveTheCache_IsNotInherited) {
  if (!set_default_acl(folder_, 7, 7)) GTEST_SKIP() << "no ACLs: " << std::strerror(errno);
  const mode_t before = ::umask(022);
  write_cache_entry("entry", "text\n");
  std::ofstream(file(".log")) << "as the builder writes";
  ::umask(before);
  EXPECT_EQ(read_cache_entry("entry"), "text\n");
  for (const fs::path& path : {folder_ / "cache", file(), file(".log")}) {
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0) << path;
    EXPECT_EQ(status.st_mode & 022, 0u) << path;
  }
}

TEST_F(CacheEntry, DefaultAclOfTheCache_IsRefused) {
  const fs::path cache = model_cache();
  if (!set_default_acl(cache, 7, 5)) GTEST_SKIP() << "no ACLs: " << std::strerror(errno);
  const std::string remedy = "remove the ACL with: setfacl -k " + cache.string();
  testing::expect_error(ErrorCode::kFile, remedy, [] { (void)model_cache(); });
  ASSERT_TRUE(set_default_acl(cache, 5, 7));
  testing::expect_error(ErrorCode::kFile, remedy, [] { (void)model_cache(); });
  ASSERT_TRUE(set_default_acl(cache, 5, 5));
  EXPECT_EQ(model_cache(), cache) << "others may only read";
}

TEST_F(CacheEntry, UncreatableFolder_IsNoError) {
  std::ofstream(folder_ / "cache") << "a file";
  write_cache_entry("entry", "text\n");
  EXPECT_FALSE(read_cache_entry("entry"));
}

TEST(CacheKey, DifferentParts_HaveDifferentKeys) {
  EXPECT_EQ(cache_key({"a", "b"}).size(), 24u);
  EXPECT_EQ(cache_key({"a", "b"}), cache_key({"a", "b"}));
  EXPECT_NE(cache_key({"a", "b"}), cache_key({"ab"}));
  EXPECT_NE(cache_key({"a\n1 b"}), cache_key({"a", "b"}));
}

}  // namespace
}  // namespace cde
