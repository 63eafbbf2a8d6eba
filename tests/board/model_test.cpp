// SPDX-License-Identifier: Apache-2.0
// Simulation models: search, build and refusal.
#include "cde/model/model.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <tuple>

#include "../expect_error.hpp"
#include "../rtl_copy.hpp"
#include "cases.hpp"
#include "cde/card/fp_unit.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// A folder and changes of the environment, for one test.
class SimulationModels : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cde-models-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    set("CDE_CACHE", folder_ / "cache");
  }
  void TearDown() override {
    fs::remove_all(folder_);
    for (auto change = before_.rbegin(); change != before_.rend(); ++change) {
      const auto& [name, value] = *change;
      value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
    }
  }
  void set(const char* name, const std::string& value) {
    const char* old = std::getenv(name);
    before_.emplace_back(name, old != nullptr ? std::optional<std::string>(old) : std::nullopt);
    ::setenv(name, value.c_str(), 1);
  }
  void unset(const char* name) {
    set(name, "");
    ::unsetenv(name);
  }
  /// Copies a ready-made model and its checksum to a new folder of this name. Returns the copied
  /// file.
  fs::path copy_of_host_board(const std::string& name) {
    const fs::path from = model_path("board", host_config().parameters());
    fs::create_directories(folder_ / name);
    const fs::path to = folder_ / name / from.filename();
    fs::copy_file(from, to);
    fs::copy_file(fs::path(from) += ".sha256", fs::path(to) += ".sha256");
    return to;
  }
  /// The folder that the host board is loaded from, and the messages on stderr.
  std::pair<fs::path, std::string> loaded_from() {
    ::testing::internal::CaptureStderr();
    const fs::path file = model_path("board", host_config().parameters());
    return {file.parent_path(), ::testing::internal::GetCapturedStderr()};
  }
  static void flip_bit(const fs::path& file, std::uintmax_t at) {
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekg(static_cast<std::streamoff>(at));
    const int byte = bytes.get();
    bytes.seekp(static_cast<std::streamoff>(at));
    bytes.put(static_cast<char>(byte ^ 0x10));
  }

  fs::path folder_;
  std::vector<std::pair<const char*, std::optional<std::string>>> before_;
};

TEST_F(SimulationModels, ReadyMade_OpensWithoutBuild) {
  const Board board = Board::open(host_config());
  EXPECT_FALSE(fs::exists(folder_ / "cache"));
  EXPECT_EQ(board.config_hash(), model_hash("board", host_config().parameters()));
  EXPECT_EQ(board.lanes(), 16u);
  EXPECT_EQ(board.primaries(), 256u);
  EXPECT_EQ(board.capacity(), 55'555'555u);
  EXPECT_EQ(board.pipe_latency(), 10u)
      << "Table 1 of the paper: 10 cycles with operators of one cycle";
}

TEST_F(SimulationModels, WrongConfiguration_IsRefused) {
  const fs::path host = model_path("board", host_config().parameters());
  expect_error(ErrorCode::kConfiguration, "configuration hash is",
               [&] { (void)Board::open(rtl_config(), {.file = host}); });
  expect_error(ErrorCode::kConfiguration, "configuration hash is",
               [&] { (void)Board::open(host_config(), {.config_hash = 1}); });
  const std::uint64_t hash = model_hash("board", host_config().parameters());
  expect_error(ErrorCode::kConfiguration, "number of lanes is 16; expected 32",
               [&] { (void)Board::open({.lanes = 32}, {.file = host, .config_hash = hash}); });
  EXPECT_NO_THROW((void)Board::open(host_config(), {.file = host, .config_hash = hash}));
}

TEST_F(SimulationModels, NotAModelFile_IsRefused) {
  const fs::path host = model_path("board", host_config().parameters());
  expect_error(ErrorCode::kConfiguration, "not a simulation model",
               [&] { (void)SimulationModel::load(folder_ / "none.so", 0); });
  expect_error(ErrorCode::kConfiguration, "not a simulation model",
               [&] { (void)SimulationModel::load(folder_, 0); });
  std::ofstream(folder_ / "text.so") << "int main() {}\n";
  expect_error(ErrorCode::kConfiguration, "not a simulation model",
               [&] { (void)SimulationModel::load(folder_ / "text.so", 0); });
  for (const int percent : {0, 1, 50, 99}) {
    fs::copy_file(host, folder_ / "cut.so", fs::copy_options::overwrite_existing);
    fs::resize_file(folder_ / "cut.so",
                    fs::file_size(host) * static_cast<std::uintmax_t>(percent) / 100);
    expect_error(ErrorCode::kConfiguration, "not a simulation model",
                 [&] { (void)SimulationModel::load(folder_ / "cut.so", 0); });
  }
  const SimulationModel board = SimulationModel::load(host, 0);
  expect_error(ErrorCode::kConfiguration, "exports no cde_nothing",
               [&] { (void)board.symbol("cde_nothing"); });
}

/// Names within messages cannot move the cursor or start a line that looks like another message.
TEST_F(SimulationModels, ControlCharactersInNames_ArePrintedEscaped) {
  const std::string odd = "a\x1b[2Jb\ncde: built";
  const auto says = [&](const std::function<void()>& statement) {
    try {
      statement();
    } catch (const Error& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find('\x1b'), std::string::npos) << text;
      EXPECT_EQ(text.find("\ncde"), std::string::npos) << text;
      EXPECT_NE(text.find("a\\x1b[2Jb\\x0acde: built"), std::string::npos) << text;
      return;
    }
    ADD_FAILURE() << "no error";
  };
  const fs::path loaded = copy_of_host_board(odd);
  const SimulationModel board = SimulationModel::load(loaded, 0);
  says([&] { (void)board.symbol("cde_nothing"); });
  says([&] { (void)FpUnit(board); });
  says([&] { (void)PairUnit(board, {}); });
  says([&] { (void)Board::open(rtl_config(), {.file = loaded}); });
  const fs::path file = copy_of_host_board(odd + " again");  // differs from the mapped file
  set("CDE_MODELS", file.parent_path());
  flip_bit(file, 10'000);
  says([&] { (void)SimulationModel::load(file, 0); });
  const std::string damaged = loaded_from().second;
  EXPECT_NE(damaged.find("a\\x1b[2Jb\\x0acde: built"), std::string::npos) << damaged;
  EXPECT_EQ(damaged.find('\x1b'), std::string::npos) << damaged;
  fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
  says([&] { (void)SimulationModel::load(file, 0); });
  fs::resize_file(file, 100);
  says([&] { (void)SimulationModel::load(file, 0); });
  // The same names in the path of the cache.
  set("CDE_MODELS", "/nowhere");
  std::ofstream(folder_ / odd / "file");
  set("CDE_CACHE", folder_ / odd / "file");
  says([&] { (void)model_cache(); });
  set("CDE_SHARE", folder_ / odd);
  says([&] { (void)model_hash("board", {}); });
}

TEST_F(SimulationModels, DamagedReadyMade_IsSkipped) {
  copy_of_host_board("cache");
  const fs::path ready = copy_of_host_board("ready");
  set("CDE_MODELS", folder_ / "ready");
  ASSERT_EQ(loaded_from().first, folder_ / "ready");
  fs::resize_file(ready, 10'000);
  const auto [folder, said] = loaded_from();
  EXPECT_NE(folder, folder_ / "ready");
  EXPECT_NE(said.find(ready.string() + " is not loaded: it is damaged"), std::string::npos) << said;
}

/// One flipped bit anywhere in the file. Flipped code could crash, or give wrong records with exit
/// status 0.
TEST_F(SimulationModels, FlippedBit_IsNotLoaded) {
  const auto size = fs::file_size(model_path("board", host_config().parameters()));
  for (const std::uintmax_t at :
       {std::uintmax_t{0}, std::uintmax_t{0x18}, size / 4, size / 2, size - 1}) {
    const std::string name = "flipped" + std::to_string(at);
    const fs::path file = copy_of_host_board(name);
    flip_bit(file, at);
    set("CDE_MODELS", folder_ / name);
    const auto [folder, said] = loaded_from();
    EXPECT_NE(folder, folder_ / name);
    EXPECT_NE(said.find(file.string() + " is not loaded: it is damaged"), std::string::npos)
        << said;
    expect_error(ErrorCode::kConfiguration, at == 0 ? "is not a simulation model" : "is damaged",
                 [&] { (void)SimulationModel::load(file, 0); });
    flip_bit(file, at);
    EXPECT_EQ(loaded_from().first, folder_ / name) << "after the repair";
  }
}

/// Opening a FIFO without a writer blocks forever, so the search must not open it.
TEST_F(SimulationModels, Fifo_IsNotRead) {
  const fs::path file = copy_of_host_board("ready");
  set("CDE_MODELS", folder_ / "ready");
  for (const auto& [name, why] :
       {std::pair{file, "it is no regular file"},
        std::pair{fs::path(file) += ".sha256", "it has a checksum that is no regular file"}}) {
    fs::rename(name, folder_ / "kept");
    ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
    const auto [folder, said] = loaded_from();
    EXPECT_NE(folder, folder_ / "ready");
    EXPECT_NE(said.find(file.string() + " is not loaded: " + why), std::string::npos) << said;
    fs::rename(folder_ / "kept", name);
  }
}

TEST_F(SimulationModels, WithoutChecksum_IsNotLoaded) {
  const fs::path file = copy_of_host_board("ready");
  set("CDE_MODELS", folder_ / "ready");
  fs::remove(fs::path(file) += ".sha256");
  const auto [folder, said] = loaded_from();
  EXPECT_NE(folder, folder_ / "ready");
  EXPECT_NE(said.find(file.string() + " is not loaded: it has no checksum"), std::string::npos)
      << said;
}

TEST_F(SimulationModels, WritableByOthers_IsNotLoaded) {
  using fs::perms;
  for (const perms who : {perms::group_write, perms::others_write}) {
    SCOPED_TRACE(static_cast<unsigned>(who));
    const std::string name = "ready" + std::to_string(static_cast<unsigned>(who));
    const fs::path file = copy_of_host_board(name);
    set("CDE_MODELS", folder_ / name);
    ASSERT_EQ(loaded_from().first, folder_ / name);
    fs::permissions(file, who, fs::perm_options::add);
    auto [folder, said] = loaded_from();
    EXPECT_NE(folder, folder_ / name);
    EXPECT_NE(said.find(file.string() + " is not loaded: it can be written by others"),
              std::string::npos)
        << said;
    expect_error(ErrorCode::kFile, "can be written by others",
                 [&] { (void)SimulationModel::load(file, 0); });
    fs::permissions(file, who, fs::perm_options::remove);
    const fs::path sum = fs::path(file) += ".sha256";
    fs::permissions(sum, who, fs::perm_options::add);
    std::tie(folder, said) = loaded_from();
    EXPECT_NE(folder, folder_ / name);
    EXPECT_NE(said.find("it has a checksum file that can be written by others"), std::string::npos)
        << said;
    fs::permissions(sum, who, fs::perm_options::remove);
    fs::permissions(file.parent_path(), who, fs::perm_options::add);
    std::tie(folder, said) = loaded_from();
    EXPECT_NE(folder, folder_ / name);
    EXPECT_NE(said.find("folder of simulation models " + (folder_ / name).string() +
                        " is refused: it can be written by others"),
              std::string::npos)
        << said;
    expect_error(ErrorCode::kFile, "can be written by others",
                 [&] { (void)SimulationModel::load(file, 0); });
  }
}

TEST_F(SimulationModels, OwnedByOthers_IsNotLoaded) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to change the owner of a file";
  const fs::path file = copy_of_host_board("ready");
  set("CDE_MODELS", folder_ / "ready");
  ASSERT_EQ(::chown(file.c_str(), 4242, 4242), 0);
  auto [folder, said] = loaded_from();
  EXPECT_NE(folder, folder_ / "ready");
  EXPECT_NE(said.find(file.string() + " is not loaded: it belongs to user 4242"), std::string::npos)
      << said;
  ASSERT_EQ(::chown(file.c_str(), 0, 0), 0);
  ASSERT_EQ(::chown(file.parent_path().c_str(), 4242, 4242), 0);
  std::tie(folder, said) = loaded_from();
  EXPECT_NE(folder, folder_ / "ready");
  EXPECT_NE(said.find("ready is refused: it belongs to user 4242"), std::string::npos) << said;

  ASSERT_EQ(::chown(file.parent_path().c_str(), 0, 0), 0);
  fs::create_directory_symlink("ready", folder_ / "link");
  ASSERT_EQ(::lchown((folder_ / "link").c_str(), 4242, 4242), 0);
  for (const char* end : {"", "/", "/.", "//./"}) {
    set("CDE_MODELS", (folder_ / "link").string() + end);
    std::tie(folder, said) = loaded_from();
    EXPECT_NE(fs::weakly_canonical(folder), folder_ / "ready") << end;
    EXPECT_NE(said.find("is refused: it is a link owned by user 4242"), std::string::npos) << said;
  }

  fs::create_directories(folder_ / "foreign");
  ASSERT_EQ(::chown((folder_ / "foreign").c_str(), 4242, 4242), 0);
  set("CDE_CACHE", folder_ / "foreign");
  expect_error(ErrorCode::kFile, "foreign: belongs to user 4242", [] { (void)model_cache(); });
}

/// ../../lib/cde/models is the folder of an installation. Beside a clone, anyone may own it.
/// The build folder's models belong to programs of the build tree only.
TEST_F(SimulationModels, InstalledFolder_IsUsedOnlyInAnInstallation) {
  const fs::path source = model_builder().parent_path().parent_path(),
                 clone = folder_ / "share/clone";
  copy_rtl(source, clone);
  copy_of_host_board("lib/cde/models");
  unset("CDE_MODELS");
  set("CDE_SHARE", clone);
  EXPECT_FALSE(model_file("board", host_config().parameters()).built);
  std::ofstream(clone / "verilator/toolchain") << "what an installation has\n";
  EXPECT_EQ(model_path("board", host_config().parameters()).parent_path(),
            folder_ / "lib/cde/models");
  fs::permissions(folder_ / "lib/cde/models", fs::perms::others_write, fs::perm_options::add);
  EXPECT_FALSE(model_file("board", host_config().parameters()).built);

  fs::permissions(clone / "verilator/model_builder", fs::perms::others_write,
                  fs::perm_options::add);
  expect_error(ErrorCode::kFile,
               "the builder of simulation models is refused: " +
                   (clone / "verilator/model_builder").string(),
               [] { (void)model_builder(); });
}

/// The builder compiles RTL, scripts and headers: they must be as trusted as the builder itself.
TEST_F(SimulationModels, BuilderInputs_MustBeTrusted) {
  const fs::path source = model_builder().parent_path().parent_path(), clone = folder_ / "clone";
  copy_rtl(source, clone);
  set("CDE_SHARE", clone);
  ASSERT_EQ(model_builder(), clone / "verilator/model_builder");
  for (const char* part :
       {"rtl", "rtl/board.sv", "rtl/contract/packages.f", "verilator/accelerator/reroll",
        "verilator/models", "verilator/models/board_model.cpp", "host/include/cde/contract",
        "host/include/cde/abi/abi.h"}) {
    const fs::perms before = fs::status(clone / part).permissions();
    fs::permissions(clone / part, fs::perms::others_write, fs::perm_options::add);
    expect_error(ErrorCode::kFile,
                 "the builder of simulation models is refused: " + (clone / part).string() +
                     " can be written",
                 [] { (void)model_builder(); });
    fs::permissions(clone / part, before);
  }
  if (::geteuid() != 0) return;
  const fs::path link = clone / "rtl/pipes/foreign.sv";
  fs::create_symlink(clone / "rtl/board.sv", link);
  ASSERT_EQ(::lchown(link.c_str(), 4242, 4242), 0);
  expect_error(ErrorCode::kFile, link.string() + " belongs to user 4242",
               [] { (void)model_builder(); });
}

/// An attacker creates the last-resort cache folder before the victim: as a link to a folder that
/// the victim would trust, or to a folder of the attacker.
TEST_F(SimulationModels, LastResortCacheAsLink_IsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  constexpr uid_t kVictim = 64'123, kAttacker = 4242;
  // The build has no model with these parameters. The attacker's file has the right name and other
  // parameters.
  const std::vector<std::string> parameters = {"LANES=1", "SRAM_RECORDS=2"};
  const fs::path other = copy_of_host_board("ready"),
                 file = other.parent_path() / model_file("board", parameters).path.filename(),
                 last = "/tmp/cde-" + std::to_string(kVictim);
  fs::permissions(folder_, fs::perms::others_read | fs::perms::others_exec, fs::perm_options::add);
  fs::rename(other, file);
  fs::rename(fs::path(other) += ".sha256", fs::path(file) += ".sha256");
  const fs::path builder = model_builder();
  for (const uid_t owner : {uid_t{0}, kAttacker}) {
    ASSERT_EQ(::chown(file.parent_path().c_str(), owner, owner), 0);
    fs::remove(last);
    fs::create_directory_symlink(file.parent_path(), last);
    ASSERT_EQ(::lchown(last.c_str(), kAttacker, kAttacker), 0);
    const process::Result ran = process::run_isolated([&](int out) {
      ::dup2(out, STDERR_FILENO);
      if (::setgid(kVictim) != 0 || ::setuid(kVictim) != 0) ::_exit(3);
      if (::access(builder.c_str(), R_OK | X_OK) != 0) ::_exit(77);
      for (const char* name : {"CDE_CACHE", "CDE_MODELS", "XDG_CACHE_HOME", "HOME"})
        ::unsetenv(name);
      try {
        const ModelFile found = model_file("board", parameters);
        ::_exit(found.built && found.path.parent_path() == last ? 1 : 0);
      } catch (const Error& e) {
        log(e.what());
        ::_exit(2);
      }
    });
    fs::remove(last);
    if (ran.status == 77) GTEST_SKIP() << "other users cannot read " << builder;
    EXPECT_EQ(ran.status, 0) << ran.output;
    EXPECT_NE(ran.output.find(last.string() + " is refused: it is a link owned by user 4242"),
              std::string::npos)
        << ran.output;
  }
}

/// A file under the name of another key, with a correct checksum, is rebuilt once. An empty folder
/// under the name of the lock is no obstacle.
TEST_F(SimulationModels, FileOfAnotherKey_IsRebuiltOnce) {
  const auto parameters = [](const char* pair) {
    return std::vector<std::string>{std::string("PAIR=") + pair, "ARITH=host", "LANES=1"};
  };
  const fs::path other = model_path("pair_unit", parameters("4")),
                 file = model_file("pair_unit", parameters("13")).path;
  ASSERT_EQ(file.parent_path(), folder_ / "cache");
  const fs::path lock = fs::path(file).replace_extension(".lock");
  fs::create_directory(lock);
  fs::copy_file(other, file);
  std::ifstream sum(fs::path(other) += ".sha256");
  std::string text(std::istreambuf_iterator<char>(sum), {});
  const std::string name = other.filename();
  text.replace(text.find(name), name.size(), file.filename());
  std::ofstream(fs::path(file) += ".sha256") << text;
  const auto hash = [&] {
    const SimulationModel opened = SimulationModel::open("pair_unit", parameters("13"));
    return *static_cast<const std::uint64_t*>(opened.symbol("cde_built_config_hash"));
  };
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(hash(), model_hash("pair_unit", parameters("13")));
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find(file.string() + " is not used: it was built for another configuration"),
            std::string::npos)
      << said;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(hash(), model_hash("pair_unit", parameters("13")));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");

  // The same for a folder of ready-made files: it stays unchanged, and the rebuilt model is found.
  set("CDE_MODELS", folder_ / "ready");
  fs::create_directories(folder_ / "ready");
  const fs::path ready = folder_ / "ready" / file.filename();
  fs::copy_file(other, ready);
  std::ofstream(fs::path(ready) += ".sha256") << text;
  const auto built_at = fs::last_write_time(file);
  EXPECT_EQ(hash(), model_hash("pair_unit", parameters("13")));
  EXPECT_EQ(fs::last_write_time(file), built_at);
  unset("CDE_MODELS");

  fs::remove(file);
  fs::create_directory(file);
  EXPECT_EQ(hash(), model_hash("pair_unit", parameters("13"))) << "an empty folder is replaced";
  for (const fs::path& name : {file, fs::path(file) += ".sha256"}) {
    fs::remove(name);
    fs::create_directories(name / "more");
    expect_error(ErrorCode::kFile, name.string() + ": is a folder; expected a file; remove", hash);
    fs::remove_all(name);
  }
  fs::remove(lock);
  fs::create_directories(lock / "more");
  expect_error(ErrorCode::kFile, lock.string() + ": is a folder; expected a file", hash);
}

TEST_F(SimulationModels, Cache_IsAPrivateFolder) {
  const auto cache = [] {
    return model_file("board", {"LANES=1", "SRAM_RECORDS=2"}).path.parent_path();
  };
  unset("CDE_CACHE");
  set("XDG_CACHE_HOME", folder_ / "xdg");
  EXPECT_EQ(cache(), folder_ / "xdg/cde");
  set("HOME", folder_ / "home");
  set("XDG_CACHE_HOME", "relative/folder");
  EXPECT_EQ(cache(), folder_ / "home/.cache/cde") << "a relative XDG_CACHE_HOME is ignored";
  const mode_t mask = ::umask(0);
  EXPECT_EQ(model_cache(), folder_ / "home/.cache/cde");
  ::umask(mask);
  for (const char* made : {"home", "home/.cache", "home/.cache/cde"})
    EXPECT_EQ(fs::status(folder_ / made).permissions(), fs::perms::owner_all) << made;
  const passwd* user = ::getpwuid(::geteuid());
  const bool at_home = user != nullptr && fs::is_directory(user->pw_dir);
  const fs::path without = at_home ? fs::path(user->pw_dir) / ".cache/cde"
                                   : fs::path("/tmp") / ("cde-" + std::to_string(::geteuid()));
  unset("HOME");
  EXPECT_EQ(cache(), without);
  set("HOME", "relative");
  EXPECT_EQ(cache(), without);

  fs::permissions(folder_ / "home/.cache/cde", fs::perms::others_write, fs::perm_options::add);
  set("HOME", folder_ / "home");
  expect_error(ErrorCode::kFile, "home/.cache/cde: can be written by others",
               [] { (void)model_cache(); });
  std::ofstream(folder_ / "file") << "";
  set("CDE_CACHE", folder_ / "file");
  expect_error(ErrorCode::kFile, "is not a folder", [] { (void)model_cache(); });
}

/// Two processes use a configuration for the first time at once: one build serves both. Then the
/// file is truncated and rebuilt.
TEST_F(SimulationModels, FirstUseOrDamage_BuildsOnce) {
  const auto parameters = BoardConfig{.lanes = 1}.parameters();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  const auto works = [&]() -> bool {
    try {
      Board board = Board::open({.lanes = 1});
      Random random;
      return cast_and_compare(board, beam(random, 5, 9), {}).size() == 5;
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
      return false;
    }
  };
  const bool mine = works();
  if (child == 0) ::_exit(mine ? 0 : 1);
  int status = 1;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(mine);
  EXPECT_EQ(status, 0);

  const fs::path file = model_path("board", parameters);
  ASSERT_EQ(file.parent_path(), folder_ / "cache");
  const auto size = fs::file_size(file);
  fs::resize_file(file, size / 2);
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(works());
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(fs::file_size(file), size);
  for (const std::string& text : {file.string() + " is not loaded: it is damaged",
                                  std::string("building simulation model board ARITH=host LANES=1"),
                                  std::string(" s, compiling (clang)"), std::string("built in")})
    EXPECT_NE(said.find(text), std::string::npos) << said;
  for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".build")) << entry.path();
  }
}

TEST_F(SimulationModels, FailingBuilder_GivesBuildError) {
  const auto unbuilt = BoardConfig{.lanes = 2}.parameters();
  expect_error(ErrorCode::kBuild, "unknown kind 'nothing'",
               [] { (void)SimulationModel::open("nothing", {}); });
  expect_error(ErrorCode::kBuild, "NO_SUCH_PARAMETER",
               [] { (void)SimulationModel::open("board", {"NO_SUCH_PARAMETER=1"}); });
  expect_error(ErrorCode::kBuild, "parameter 'a b; echo' is not NAME=VALUE",
               [] { (void)SimulationModel::open("board", {"a b; echo"}); });
  set("CDE_CLANG", "no-such-compiler");
  expect_error(ErrorCode::kBuild, "no-such-compiler not found",
               [&] { (void)SimulationModel::open("board", unbuilt); });
  set("CDE_CLANG", "clang++");
  set("CDE_SHARE", folder_ / "nowhere");
  expect_error(ErrorCode::kBuild, "cannot run",
               [&] { (void)SimulationModel::open("board", unbuilt); });
}

/// Shells and Perl warn about a locale that is not installed. The warning must not become part of
/// an answer.
TEST_F(SimulationModels, MissingLocale_ChangesNoHash) {
  const auto parameters = host_config().parameters();
  const std::uint64_t hash = model_hash("board", parameters);
  set("LC_ALL", "xx_NOWHERE.UTF-8");
  EXPECT_EQ(model_hash("board", parameters), hash);
}

/// A folder above the cache is replaced by a link while a build fails. The log stays in the folder
/// of the lock.
TEST_F(SimulationModels, CacheSwappedForLink_KeepsVictimUntouched) {
  const std::string key(24, 'a');
  const fs::path clone = folder_ / "clone";
  copy_rtl(model_builder().parent_path().parent_path(), clone);
  set("CDE_SHARE", clone);
  std::ofstream(clone / "verilator/model_builder") << fmt::format(
      "#!/bin/sh\n[ \"$1\" != hash ] || {{ echo 0123456789abcdef {0}; exit; }}\ncd '{1}'\n"
      "mv cache moved; ln -s victim cache; echo 'error: no'; exit 1\n",
      key, folder_.string());
  fs::create_directory(folder_ / "victim");
  std::ofstream(folder_ / "victim" / (key + ".log")) << "mine";
  expect_error(ErrorCode::kBuild, "error: no", [] { (void)SimulationModel::open("board", {}); });
  const auto log_in = [&](const char* folder) {
    std::ifstream in(folder_ / folder / (key + ".log"));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(log_in("victim"), "mine");
  EXPECT_EQ(log_in("moved"), "error: no\n");
}

TEST_F(SimulationModels, NoexecCache_IsRefusedBeforeTheBuild) {
  const fs::path cache = folder_ / "cache";
  fs::create_directory(cache);
  if (::mount("tmpfs", cache.c_str(), "tmpfs", MS_NOEXEC, "size=64k,mode=700") != 0)
    GTEST_SKIP() << "cannot mount a folder";
  const std::string why = cache.string() + ": mounted noexec; set CDE_CACHE";
  expect_error(ErrorCode::kFile, why,
               [] { (void)SimulationModel::open("board", BoardConfig{.lanes = 2}.parameters()); });
  expect_error(ErrorCode::kFile, why, [] { (void)model_cache(); });
  EXPECT_TRUE(fs::is_empty(cache)) << "a build began";
  ::umount2(cache.c_str(), MNT_DETACH);
}

TEST_F(SimulationModels, UnwritableCache_IsNamed) {
  set("CDE_CACHE", "/proc/no-folder");
  expect_error(ErrorCode::kFile, "/proc/no-folder",
               [] { (void)SimulationModel::open("board", BoardConfig{.lanes = 2}.parameters()); });
}

}  // namespace
}  // namespace cde::testing
