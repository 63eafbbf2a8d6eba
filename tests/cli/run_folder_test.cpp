// SPDX-License-Identifier: Apache-2.0
// The folder of `cde run` holds one run and belongs to its user.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const std::string kFolderScene = R"(frames = 4
[card]
lanes = 4
[[object]]
name = "terrain"
mesh = "terrain:3,3,1"
[[object]]
name = "rays"
random_rays = { count = 3, seed = 7 }
motion = { kind = "still", position = [15, 15, 300] }
)" + hit_query("terrain");

class RunFolders : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("scene.toml", kFolderScene);
  }
  [[nodiscard]] Words in(const std::string& folder) const {
    Words names;
    for (const auto& entry : fs::directory_iterator(folder_ / folder))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  /// Size of the unfinished file of a name in a folder.
  [[nodiscard]] std::uintmax_t written(const std::string& folder, const std::string& name) const {
    for (const auto& entry : fs::directory_iterator(folder_ / folder)) {
      std::error_code gone;
      if (entry.path().filename().string().starts_with(name + ".cde-"))
        return fs::file_size(entry.path(), gone);
    }
    return 0;
  }
  Ran run(const Words& more) {
    Words words = {"run", "scene.toml", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return cde(words);
  }
};

/// The owner of the parent folder replaces the run folder by a link, again and again. Files are
/// removed and written only in the locked folder.
TEST_F(RunFolders, FolderSwappedForALink_KeepsVictimUntouched) {
  fs::create_directory(folder_ / "victim");
  write("victim/shadow", "secret");
  fs::create_directory_symlink("victim", folder_ / "alt");
  for (int i = 0; i < 12; ++i) {
    fs::remove_all(folder_ / "d");
    fs::create_directory(folder_ / "d");
    write("d/run.json", R"({"scene":"s","frame_results":1,"files_beside":["shadow"]})");
    write("d/shadow", "");
    std::atomic<bool> ended = false;
    std::thread swapping([&] {
      while (!ended) {
        ::renameat2(AT_FDCWD, (folder_ / "d").c_str(), AT_FDCWD, (folder_ / "alt").c_str(),
                    RENAME_EXCHANGE);
        std::this_thread::sleep_for(std::chrono::microseconds(50 * (i + 1)));
      }
    });
    (void)run({"--out", "d", "--frames", "0"});
    ended = true;
    swapping.join();
    if (fs::is_symlink(folder_ / "d")) {
      fs::rename(folder_ / "d", folder_ / "link");
      fs::rename(folder_ / "alt", folder_ / "d");
      fs::rename(folder_ / "link", folder_ / "alt");
    }
    EXPECT_EQ(in("victim"), Words{"shadow"});
    EXPECT_EQ(read("victim/shadow"), "secret");
  }
}

/// A link of another user leads to one of our runs.
TEST_F(RunFolders, ForeignLink_ReachesNoRunOfOurs) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  ASSERT_EQ(run({"-o", "d"}).status, 0);
  const std::string before = read("d/run.json");
  fs::create_directory_symlink("d", folder_ / "link");
  ASSERT_EQ(::lchown((folder_ / "link").c_str(), 65534, 65534), 0);
  for (const std::string name : {"link", "link/", "link/."}) {
    const Ran ran = run({"-o", name, "--frames", "0"});
    EXPECT_EQ(ran.status, 2) << name;
    EXPECT_TRUE(has(ran.err, "it is a link owned by user 65534 to")) << ran.err;
  }
  EXPECT_EQ(read("d/run.json"), before);
}

/// Another user's run.json in a shared folder would name the files that root removes.
TEST_F(RunFolders, MarkerOfAnotherUser_RemovesNothing) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to run as two users";
  fs::create_directory(folder_ / "d");
  write("d/thesis.txt", "years of work");
  write("d/run.json", R"({"scene":"s","frame_results":[],"files":["thesis.txt"]})");
  const auto give = [&](const char* name) {
    ASSERT_EQ(::lchown((folder_ / name).c_str(), 65534, 65534), 0);
  };
  give("d/run.json");
  const std::string refusal =
      " belongs to user 65534; a run removes only files of its own user; move it elsewhere, or "
      "name "
      "another folder with --output\n";
  Ran ran = run({"-o", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err, "cde: d/run.json" + refusal);
  // Their link to a run.json of ours, and ours to one of theirs.
  fs::rename(folder_ / "d/run.json", folder_ / "theirs.json");
  write("ours.json", read("theirs.json"));
  for (const char* to : {"../ours.json", "../theirs.json"}) {
    fs::create_symlink(to, folder_ / "d/run.json");
    if (std::string(to) == "../ours.json") give("d/run.json");
    ran = run({"-o", "d"});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err, "cde: d/run.json" + refusal);
    fs::remove(folder_ / "d/run.json");
  }
  // Our own run.json, with a file of theirs.
  fs::rename(folder_ / "ours.json", folder_ / "d/run.json");
  give("d/thesis.txt");
  ran = run({"-o", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err, "cde: d/thesis.txt" + refusal);
  EXPECT_EQ(in("d"), (Words{"run.json", "thesis.txt"}));
}

/// Who may read a folder can lock it.
TEST_F(RunFolders, LockOfTheFolderByOthers_StopsNoRun) {
  fs::create_directory(folder_ / "d");
  const int held = ::open((folder_ / "d").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(held, LOCK_EX), 0);
  const Ran ran = run({"-o", "d", "--frames", "0"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  ::close(held);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "run.json"}));
}

TEST_F(RunFolders, LockFile_IsOnlyItsUsers) {
  fs::create_directory(folder_ / "d");
  ASSERT_EQ(::mkfifo((folder_ / "d/run.lock").c_str(), 0600), 0);
  Ran ran = run({"-o", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "d/run.lock: cannot lock: it is no file of a run of yours")) << ran.err;
  fs::remove(folder_ / "d/run.lock");
  ran = run({"-o", "d", "--report", "d/run.lock"});
  EXPECT_EQ(ran.err, "cde: d/run.lock has the name of a file that --output writes\n");
  write("long.toml", std::string(kFolderScene).replace(0, 10, "frames = 1000000"));
  const pid_t child = start({"run", "long.toml", "--out", "d"});
  for (int i = 0; i < 600 && !exists("d/run.json"); ++i) ::usleep(50'000);
  struct stat info {};
  EXPECT_EQ(::stat((folder_ / "d/run.lock").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777u, 0600u);
  ::kill(child, SIGTERM);
  (void)finish(child);
  EXPECT_FALSE(exists("d/run.lock"));
}

/// Folders are created exactly where the system resolves their names.
TEST_F(RunFolders, TooLongOrParentNames_ResolveOrFail) {
  std::string deep;
  for (int i = 0; i < 2060; ++i) deep += "d/";
  Ran ran = run({"-o", deep, "--frames", "0"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "File name too long")) << ran.err;
  EXPECT_FALSE(exists("d"));
  fs::create_directories(folder_ / "deep/in");
  fs::create_directory_symlink("deep/in", folder_ / "link");
  ran = run({"-o", "link/../d", "--frames", "0"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(exists("deep/d/run.json"));
  ran = run({"-o", "nowhere/../d", "--frames", "0"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "No such file or directory")) << ran.err;
  EXPECT_FALSE(exists("d"));
}

TEST_F(RunFolders, DanglingLink_CreatesItsTarget) {
  fs::create_directory_symlink("new", folder_ / "link");
  Ran ran = run({"-o", "link", "--frames", "0"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(exists("new/run.json"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  fs::create_directory_symlink("none/new", folder_ / "nowhere");
  ran = run({"-o", "nowhere", "--frames", "0"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err,
            "cde: nowhere: cannot create: it is a link to none/new, whose folder does not "
            "exist\n");
}

TEST_F(RunFolders, SecondRun_RemovesTheFirst) {
  ASSERT_EQ(run({"-o", "d", "--file-per-frame"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.000000.csv", "hit.000001.csv", "hit.000002.csv", "hit.000003.csv",
                            "run.json"}));
  ASSERT_EQ(run({"--out", "d", "--frames", "1", "--report", "d/page.html"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "page.html", "run.json"}));
  std::string renamed = kFolderScene;
  renamed.replace(renamed.find("\"hit\""), 5, "\"seen\"");
  write("renamed.toml", renamed);
  ASSERT_EQ(cde({"run", "renamed.toml", "-q", "--out", "d"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"run.json", "seen.csv"})) << "the page belongs to the run";
  std::string binary = kFolderScene;
  binary += "[report]\nresults = \"binary\"\n";
  write("scene.toml", binary);
  ASSERT_EQ(run({"--out", "d", "--frames", "2"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.bin", "run.json"}));
  ASSERT_EQ(run({"--out", "d", "--frames", "2", "--file-per-frame"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.000002.bin", "run.json"}));
  ASSERT_EQ(run({"--out", "d"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.bin", "run.json"}));
}

TEST_F(RunFolders, FolderWithoutARun_IsRefused) {
  fs::create_directory(folder_ / "d");
  write("d/thesis.tex", "years of work");
  Ran ran = run({"--out", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err,
            "cde: d is not empty and has no run.json of a run; it stays unchanged; name another "
            "folder with --output\n");
  write("d/run.json", "{\"scripts\": {\"test\": \"jest\"}}");
  EXPECT_EQ(run({"--out", "d"}).status, 2) << "run.json of another program";
  EXPECT_EQ(in("d"), (Words{"run.json", "thesis.tex"}));
  EXPECT_EQ(read("d/run.json"), "{\"scripts\": {\"test\": \"jest\"}}");
  fs::remove_all(folder_ / "d");
  // Another file beside a run.
  ASSERT_EQ(run({"--out", "d"}).status, 0);
  write("d/notes.txt", "mine");
  ran = run({"--out", "d", "--frames", "0"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err,
            "cde: d/notes.txt does not belong to the run in d; move it elsewhere, or name another "
            "folder with --output\n");
  EXPECT_EQ(in("d"), (Words{"hit.csv", "notes.txt", "run.json"}));
  fs::rename(folder_ / "d/notes.txt", folder_ / "d/notes.csv");
  EXPECT_EQ(run({"--out", "d", "--frames", "0"}).status, 2) << "not a table of that run";
  EXPECT_EQ(in("d"), (Words{"hit.csv", "notes.csv", "run.json"}));
  // A file with the name of the folder.
  write("f", "x");
  EXPECT_EQ(run({"--out", "f"}).status, 2);
  EXPECT_EQ(read("f"), "x");
  fs::create_directory(folder_ / "empty");
  EXPECT_EQ(run({"--out", "empty"}).status, 0);
}

TEST_F(RunFolders, SceneInputs_AreNotRemoved) {
  Ran ran = cde({"run", "scene.toml", "--out", "."});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err, "cde: --output is ., which contains the scene scene.toml\n");
  for (const std::string name : {"d/hit.000000.csv", "d/hit.csv", "d/run.json"}) {
    ran = run({"--out", "d", "--report", name});
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.err, "cde: " + name + " has the name of a file that --output writes\n");
  }
  EXPECT_EQ(files(), Words{"scene.toml"});
}

/// A failure before the first frame keeps the previous run.
TEST_F(RunFolders, RunThatDoesNotStart_ChangesNothing) {
  ASSERT_EQ(run({"--out", "d"}).status, 0);
  const std::string before = read("d/run.json");
  EXPECT_EQ(run({"--out", "d", "--frames", "9"}).status, 2);
  EXPECT_EQ(run({"--out", "d", "--report", "none/page.html"}).status, 2);
  EXPECT_EQ(run({"--out", "new", "--report", "none/page.html"}).status, 2);
  EXPECT_FALSE(exists("new"));
  const Ran ran = cde({"run", "scene.toml", "--out", "d"},
                      {"CDE_MODELS=/nowhere", "CDE_CACHE=" + (folder_ / "cache").string(),
                       "CDE_CLANG=no-such-compiler"});
  EXPECT_EQ(ran.status, 2) << ran.err;
  EXPECT_EQ(read("d/run.json"), before);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "run.json"}));
}

/// Another user may have made the folder; a run must not wait for a writer of the FIFO.
TEST_F(RunFolders, FifoAsRunJson_IsRefusedAtOnce) {
  fs::create_directory(folder_ / "d");
  ASSERT_EQ(::mkfifo((folder_ / "d/run.json").c_str(), 0600), 0);
  const Ran ran = run({"--out", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "d is not empty")) << ran.err;
}

TEST_F(RunFolders, FileOfTheKernelAsRunJson_IsRefusedAtOnce) {
  fs::create_directory(folder_ / "d");
  fs::create_symlink("/proc/self/status", folder_ / "d/run.json");
  const Ran ran = run({"--out", "d"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "d is not empty")) << ran.err;
}

/// A killed run leaves no table, only an unfinished file, which the next run removes.
TEST_F(RunFolders, KillMidRun_LeavesNoTable) {
  write("long.toml", std::string(kFolderScene).replace(0, 10, "frames = 1000000"));
  const pid_t child = start({"run", "long.toml", "--out", "d"});
  for (int i = 0; i < 600 && (!exists("d/run.json") || written("d", "hit.csv") == 0); ++i)
    ::usleep(50'000);
  EXPECT_GT(written("d", "hit.csv"), 0u);
  ::kill(child, SIGKILL);
  EXPECT_EQ(finish(child).status, 128 + SIGKILL);
  const auto json = nlohmann::json::parse(read("d/run.json"));
  EXPECT_EQ(json["finished"], false);
  EXPECT_EQ(json["files"], nlohmann::json::array({"hit.csv"}));
  EXPECT_FALSE(exists("d/hit.csv"));
  EXPECT_EQ(in("d").size(), 3u) << "run.json, run.lock and the unfinished table";
  ASSERT_EQ(run({"--out", "d", "--frames", "1", "--file-per-frame"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.000001.csv", "run.json"}));
}

/// After a kill the folder is recognised as a run's, and the next run removes its content.
TEST_F(RunFolders, RunAfterAKill_RemovesTheOldContent) {
  std::string scene = kFolderScene;
  write("long.toml", scene.replace(0, 10, "frames = 100000"));
  const pid_t child = start({"run", "long.toml", "--out", "d", "--file-per-frame"});
  for (int i = 0; i < 600 && !exists("d/hit.000002.csv"); ++i) ::usleep(50'000);
  ::kill(child, SIGKILL);
  EXPECT_EQ(finish(child).status, 128 + SIGKILL);
  write("d/hit.000003.csv.cde-999999999-abcdef", "what it was writing");
  EXPECT_EQ(nlohmann::json::parse(read("d/run.json"))["finished"], false);
  ASSERT_EQ(run({"--out", "d", "--frames", "1"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "run.json"}));
}

/// Two runs at the same time do not mix their files: the second is refused, and the first
/// continues. The lock ends with its process, also after a kill.
TEST_F(RunFolders, FolderInUse_IsRefused) {
  std::string scene = kFolderScene;
  write("long.toml", scene.replace(0, 10, "frames = 100000"));
  const pid_t child = start({"run", "long.toml", "--out", "d", "-q", "--file-per-frame"});
  for (int i = 0; i < 600 && !exists("d/hit.000002.csv"); ++i) ::usleep(50'000);
  ASSERT_TRUE(exists("d/hit.000002.csv"));
  fs::create_directory_symlink("d", folder_ / "link");
  for (const std::string folder : {"d", "./d", "link"}) {
    const Ran second = run({"--out", folder});
    EXPECT_EQ(second.status, 2);
    EXPECT_EQ(second.err,
              "cde: " + folder +
                  " is the folder of a run that is still going on; wait for its end, or "
                  "name another folder with --output\n");
  }
  EXPECT_EQ(run({"--out", "other"}).status, 0);
  ::kill(child, SIGKILL);
  EXPECT_EQ(finish(child).status, 128 + SIGKILL);
  EXPECT_EQ(nlohmann::json::parse(read("d/run.json"))["scene"], "long.toml");
  EXPECT_TRUE(exists("d/hit.000000.csv")) << "the files of the first run must stay";
  EXPECT_EQ(run({"--out", "d", "--frames", "1"}).status, 0);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "run.json"}));
}

/// Runs that start simultaneously into a new folder: at least one runs, and each of the others
/// gives a reason.
TEST_F(RunFolders, SimultaneousRuns_DoNotMix) {
  const Ran ran = shell(
      "for i in 1 2 3 4; do (\"$CDE\" run scene.toml --out d -q --frames 0..1 2>err.$i; echo $? "
      ">status.$i) & done; wait");
  ASSERT_EQ(ran.status, 0) << ran.err;
  int played = 0;
  for (int i = 1; i <= 4; ++i) {
    const std::string status = read(fmt::format("status.{}", i));
    const bool refused = status == "2\n";
    EXPECT_EQ(status, refused ? "2\n" : "0\n");
    EXPECT_EQ(
        read(fmt::format("err.{}", i)),
        refused ? "cde: d is the folder of a run that is still going on; wait for its end, or name "
                  "another folder with --output\n"
                : "");
    played += refused ? 0 : 1;
  }
  EXPECT_GE(played, 1);
  EXPECT_EQ(in("d"), (Words{"hit.csv", "run.json"}));
}

}  // namespace
}  // namespace cde::testing
