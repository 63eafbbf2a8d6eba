// Finding, building and refusing bitstreams.
#include "cde/bitstream.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cases.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// A folder and changes of the environment, for one test.
class Bitstreams : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cde-bitstreams-XXXXXX").string();
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
  static void expect(ErrorCode code, const std::string& text,
                     const std::function<void()>& statement) {
    try {
      statement();
      ADD_FAILURE() << "no error with '" << text << "'";
    } catch (const Error& e) {
      EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  }

  fs::path folder_;
  std::vector<std::pair<const char*, std::optional<std::string>>> before_;
};

TEST_F(Bitstreams, ReadyMadeOneIsFoundWithoutBuilding) {
  const Board board = Board::open(host_config());
  EXPECT_FALSE(fs::exists(folder_ / "cache"));
  EXPECT_EQ(board.config_hash(), bitstream_hash("board", host_config().parameters()));
  EXPECT_EQ(board.lanes(), 16u);
  EXPECT_EQ(board.primaries(), 256u);
  EXPECT_EQ(board.capacity(), 55'555'555u);
  EXPECT_EQ(board.pipe_latency(), 10u) << "the paper's Table 1: 10 clocks at one clock an operator";
}

TEST_F(Bitstreams, WrongConfigurationIsRefused) {
  const fs::path host = bitstream_path("board", host_config().parameters());
  expect(ErrorCode::kConfiguration, "configuration hash is",
         [&] { (void)Board::open(rtl_config(), {.file = host}); });
  expect(ErrorCode::kConfiguration, "configuration hash is",
         [&] { (void)Board::open(host_config(), {.config_hash = 1}); });
  const std::uint64_t hash = bitstream_hash("board", host_config().parameters());
  expect(ErrorCode::kConfiguration, "number of lanes is 16, but 32",
         [&] { (void)Board::open({.lanes = 32}, {.file = host, .config_hash = hash}); });
  EXPECT_NO_THROW((void)Board::open(host_config(), {.file = host, .config_hash = hash}));
}

TEST_F(Bitstreams, FilesThatAreNone) {
  const fs::path host = bitstream_path("board", host_config().parameters());
  expect(ErrorCode::kConfiguration, "not a bitstream",
         [&] { (void)Bitstream::load(folder_ / "none.so", 0); });
  expect(ErrorCode::kConfiguration, "not a bitstream", [&] { (void)Bitstream::load(folder_, 0); });
  std::ofstream(folder_ / "text.so") << "int main() {}\n";
  expect(ErrorCode::kConfiguration, "not a bitstream",
         [&] { (void)Bitstream::load(folder_ / "text.so", 0); });
  for (const int percent : {0, 1, 50, 99}) {
    fs::copy_file(host, folder_ / "cut.so", fs::copy_options::overwrite_existing);
    fs::resize_file(folder_ / "cut.so",
                    fs::file_size(host) * static_cast<std::uintmax_t>(percent) / 100);
    expect(ErrorCode::kConfiguration, "not a bitstream",
           [&] { (void)Bitstream::load(folder_ / "cut.so", 0); });
  }
  const Bitstream board = Bitstream::load(host, 0);
  expect(ErrorCode::kConfiguration, "exports no cde_nothing",
         [&] { (void)board.symbol("cde_nothing"); });
}

TEST_F(Bitstreams, DamagedReadyMadeOneIsPassedOver) {
  const fs::path host = bitstream_path("board", host_config().parameters());
  fs::create_directories(folder_ / "cache");
  fs::copy_file(host, folder_ / "cache" / host.filename());
  fs::create_directories(folder_ / "ready");
  fs::copy_file(host, folder_ / "ready" / host.filename());
  fs::resize_file(folder_ / "ready" / host.filename(), 10'000);
  set("CDE_BITSTREAMS", folder_ / "ready");
  EXPECT_NE(bitstream_path("board", host_config().parameters()).parent_path(), folder_ / "ready");
}

/// The first use of a configuration by two processes at once: one build, both get it; then its file
/// is cut short, and built again.
TEST_F(Bitstreams, BuiltOnFirstUseAndWhenDamaged) {
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

  const fs::path file = bitstream_path("board", parameters);
  ASSERT_EQ(file.parent_path(), folder_ / "cache");
  const auto size = fs::file_size(file);
  fs::resize_file(file, size / 2);
  EXPECT_TRUE(works());
  EXPECT_EQ(fs::file_size(file), size);
  for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".build")) << entry.path();
  }
}

TEST_F(Bitstreams, BuilderThatCannotWork) {
  const auto unbuilt = BoardConfig{.lanes = 2}.parameters();
  expect(ErrorCode::kBuild, "unknown kind 'nothing'", [] { (void)Bitstream::open("nothing", {}); });
  expect(ErrorCode::kBuild, "NO_SUCH_PARAMETER",
         [] { (void)Bitstream::open("board", {"NO_SUCH_PARAMETER=1"}); });
  expect(ErrorCode::kBuild, "parameter 'a b; echo' is not NAME=VALUE",
         [] { (void)Bitstream::open("board", {"a b; echo"}); });
  set("CDE_CLANG", "no-such-compiler");
  expect(ErrorCode::kBuild, "no-such-compiler not found",
         [&] { (void)Bitstream::open("board", unbuilt); });
  set("CDE_CLANG", "clang++");
  set("CDE_SHARE", folder_ / "nowhere");
  expect(ErrorCode::kBuild, "cannot run", [&] { (void)Bitstream::open("board", unbuilt); });
}

TEST_F(Bitstreams, UnwritableCacheIsNamed) {
  set("CDE_CACHE", "/proc/no-folder");
  expect(ErrorCode::kFile, "/proc/no-folder",
         [] { (void)Bitstream::open("board", BoardConfig{.lanes = 2}.parameters()); });
}

}  // namespace
}  // namespace cde::testing
