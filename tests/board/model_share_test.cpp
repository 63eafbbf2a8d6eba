// SPDX-License-Identifier: Apache-2.0
// Attacks on the folder of the builder of simulation models: another user changes what it compiles.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "../expect_error.hpp"
#include "../rtl_copy.hpp"
#include "cde/model/model.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// A copy of the builder's sources, in folder above/.
class ModelShare : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cde-share-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = fs::canonical(name);
    above_ = folder_ / "above";
    share_ = above_ / "share";
    copy_rtl(CDE_SOURCE_DIR, share_);
    fs::permissions(above_, fs::perms::owner_all);
    if (const char* set = std::getenv("CDE_SHARE")) before_ = set;
    use(share_);
  }
  void TearDown() override {
    fs::remove_all(folder_);
    before_ ? ::setenv("CDE_SHARE", before_->c_str(), 1) : ::unsetenv("CDE_SHARE");
  }
  static void use(const fs::path& share) { ::setenv("CDE_SHARE", share.c_str(), 1); }
  void expect_trusted() const { EXPECT_EQ(model_builder(), share_ / "verilator/model_builder"); }
  static void expect_refused(const fs::path& part, const std::string& why) {
    expect_error(ErrorCode::kFile,
                 "the builder of simulation models is refused: " + part.string() + " " + why,
                 [] { (void)model_builder(); });
  }

  fs::path folder_, above_, share_;
  std::optional<std::string> before_;
};

/// The attacker could replace the share after its check.
TEST_F(ModelShare, FolderAboveThatOthersWrite_IsRefused) {
  expect_trusted();
  fs::permissions(above_, fs::perms::all);
  expect_refused(above_, "can be written by others");
  fs::permissions(above_, fs::perms::all | fs::perms::sticky_bit);
  expect_trusted();
}

TEST_F(ModelShare, FolderOrLinkAboveOfAnotherUser_IsRefused) {
  fs::create_directory_symlink("above", folder_ / "link");
  use(folder_ / "link/share");
  expect_trusted();
  use(folder_ / "link/../above/share");
  expect_trusted();
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to change the owner of a folder";
  ASSERT_EQ(::lchown((folder_ / "link").c_str(), 4242, 4242), 0);
  expect_refused(folder_ / "link", "belongs to user 4242");
  use(folder_ / "link/share");
  expect_refused(folder_ / "link", "belongs to user 4242");
  use(share_);
  expect_trusted();
  ASSERT_EQ(::chown(above_.c_str(), 4242, 4242), 0);
  expect_refused(above_, "belongs to user 4242");
}

/// The compiler searches host/include before the system's headers.
TEST_F(ModelShare, HeaderInPlaceOfASystemHeader_IsRefused) {
  const fs::path header = share_ / "host/include/cstdint";
  std::ofstream(header) << "#error compiled\n";
  fs::permissions(header, fs::perms::owner_all | fs::perms::others_write);
  expect_refused(header, "can be written by others");
}

TEST_F(ModelShare, LinkedFolder_IsChecked) {
  const fs::path moved = folder_ / "models", file = moved / "board_model.cpp";
  fs::rename(share_ / "verilator/models", moved);
  fs::create_directory_symlink(moved, share_ / "verilator/models");
  fs::create_directory_symlink("..", share_ / "verilator/loop");
  expect_trusted();
  fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
  expect_refused(file, "can be written by others");
}

/// Another user could create the missing target after the check.
TEST_F(ModelShare, LinkToMissingFile_IsRefusedInASharedFolder) {
  const fs::path shared = folder_ / "shared";
  fs::create_symlink("user@host.1234", share_ / "rtl/.#board.sv");  // as an editor's lock
  expect_trusted();
  fs::create_directory(shared);
  fs::permissions(shared, fs::perms::all | fs::perms::sticky_bit);
  fs::create_symlink(shared / "later.sv", share_ / "rtl/later.sv");
  expect_refused(shared / "later.sv", "does not exist, and other users can create it");
}

}  // namespace
}  // namespace cde::testing
