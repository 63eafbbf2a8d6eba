// SPDX-License-Identifier: Apache-2.0
// Outputs of the command: devices, pipes, links, stdout. Inputs are not overwritten. A killed
// command leaves nothing that stays.
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const char* const kCsv = "ray,F,T,CPx,CPy,CPz,index\n0,1,0.5,0.25,0.25,1,0\n";
const std::string kOutputScene = R"(frames = 2
[card]
lanes = 4
[[object]]
name = "triangles"
mesh = "one.obj"
[[object]]
name = "rays"
rays_csv = "rays.csv"
)" + hit_query("triangles");

class Outputs : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("one.obj", kOneTriangle);
    write("rays.csv", "0.25,0.25,0,0,0,2\n");
    write("scene.toml", kOutputScene);
  }
  static Words cast(const Words& more) {
    Words words = {"cast", "one.obj", "--rays", "rays.csv", "--lanes", "4", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The input files are unchanged.
  void expect_inputs() {
    EXPECT_EQ(read("one.obj"), kOneTriangle);
    EXPECT_EQ(read("rays.csv"), "0.25,0.25,0,0,0,2\n");
    EXPECT_EQ(read("scene.toml"), kOutputScene);
  }
};

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n') + 1;
  const std::size_t begin = text.substr(0, end).rfind('\n') + 1;
  return text.substr(begin, end - begin);
}

/// Root must not replace a device by a file.
TEST_F(Outputs, Devices_StayDevices) {
  const fs::path device = folder_ / "null";
  if (::mknod(device.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0)
    GTEST_SKIP() << "cannot create a device: " << std::strerror(errno);
  const Words picture = {"render", "one.obj", "--grid", "4x4", "--lanes", "4", "-q"};
  std::vector<Words> all = {cast({"-o", "null"}),
                            cast({"--trace", "null"}),
                            {"run", "scene.toml", "-q", "--report", "null", "--trace", "null"}};
  for (const char* option : {"--image", "--shaded"}) {
    all.push_back(picture);
    all.back().insert(all.back().end(), {option, "null"});
  }
  for (const Words& words : all) {
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << fmt::format("{}", fmt::join(words, " ")) << "\n" << ran.err;
    EXPECT_TRUE(fs::is_character_file(device)) << fmt::format("{}", fmt::join(words, " "));
  }
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

/// Waves for a pipe first go to a file in $TMPDIR, whose disk may be full.
TEST_F(Outputs, FullDisk_IsAnError) {
  fs::create_directory(folder_ / "small");
  const auto on_small = [&](const std::string& command) {
    return shell(
        "unshare -m bash -c 'mount -t tmpfs -o size=16k none small && export TMPDIR=$PWD/small"
        " && " +
        command + "; status=$?; ls small; exit $status'");
  };
  if (on_small("true").status != 0) GTEST_SKIP() << "cannot mount a file system";
  const std::string cast = "\"$CDE\" cast terrain:20,20,1 --grid 40x40 --lanes 4 -q ";
  Ran ran = on_small(cast + "--trace - > piped");
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(last_line(ran.err), "cde: -: the waves are incomplete: No space left on device");
  EXPECT_EQ(read("piped"), "");
  ran = on_small(cast + "-o small/hits.csv");
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(last_line(ran.err), "cde: small/hits.csv: cannot write: No space left on device");
  EXPECT_EQ(ran.out, "") << "the folder must be empty";
}

/// The checked file is loaded through /proc/self/fd; programs are found through /proc/self/exe.
TEST_F(Outputs, WithoutProc_NothingIsDone) {
  const Ran ran =
      shell("unshare -m bash -c 'mount -t tmpfs none /proc && \"$CDE\" cast one.obj -o x'");
  if (ran.err.find("cde: ") == std::string::npos) GTEST_SKIP() << "cannot mount a file system";
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.err.substr(0, 25), "cde: /proc is not mounted");
  EXPECT_FALSE(exists("x"));
}

TEST_F(Outputs, PipesAndDescriptors_AreWritten) {
  const std::string cast = "\"$CDE\" cast one.obj --rays rays.csv --lanes 4 -q ";
  EXPECT_EQ(shell(cast + "-o /dev/stdout").out, kCsv);
  EXPECT_EQ(shell("echo head; " + cast + "-o /dev/stdout").out, "head\n" + std::string(kCsv))
      << "earlier content of the file stays";
  EXPECT_EQ(shell(cast + "-o >(cat >&2); wait $!").err, kCsv);
  const Ran ran = shell("mkfifo f; cat f & " + cast + "-o f; wait; test -p f");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, kCsv);
}

TEST_F(Outputs, FifoWithASuffix_GetsThatFormat) {
  const std::string into = "\"$CDE\" cast one.obj --rays rays.csv --lanes 4 -q -o ";
  Ran ran = shell("mkfifo f.jsonl; cat f.jsonl & " + into + "f.jsonl; wait");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(ran.out.starts_with("{")) << ran.out;
  write("one.vcd", "$timescale 1ns $end\n$var wire 1 a x $end\n$enddefinitions $end\n#0\n0a\n");
  ran = shell("mkfifo f.vcd; cat f.vcd & \"$CDE\" wave export one.vcd -o f.vcd 2>/dev/null; wait");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, "$enddefinitions")) << ran.out;
}

TEST_F(Outputs, Link_WritesItsTarget) {
  fs::create_directory(folder_ / "there");
  fs::create_symlink("there/hits.csv", folder_ / "link");
  ASSERT_EQ(cde(cast({"-o", "link"})).status, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(read("there/hits.csv"), kCsv);
  EXPECT_EQ(files(), (Words{"link", "one.obj", "rays.csv", "scene.toml", "there"}));
}

TEST_F(Outputs, Dash_IsStdoutAndStdin) {
  const std::string picture = "\"$CDE\" render one.obj --grid 4x4 --lanes 4 -q ";
  for (const char* option : {"--image", "--shaded"}) {
    ASSERT_EQ(shell(picture + option + " file.png").status, 0);
    EXPECT_EQ(shell(picture + option + " -").out, read("file.png")) << option;
    EXPECT_GT(read("file.png").size(), 50u);
    fs::remove(folder_ / "file.png");
  }
  const Ran waves = cde(cast({"--trace", "-"}));
  EXPECT_EQ(waves.status, 0) << waves.err;
  EXPECT_GT(waves.out.size(), 10'000u);
  const Ran page = cde({"run", "scene.toml", "-q", "--report", "-"});
  EXPECT_EQ(page.status, 0) << page.err;
  EXPECT_TRUE(page.out.starts_with("<!DOCTYPE html>")) << page.out.substr(0, 100);
  EXPECT_TRUE(page.out.ends_with("</html>\n"));
  refused_saying({"run", "scene.toml", "--out", "-"}, "--output is -; it must be a folder");
  const Ran rays = shell("\"$CDE\" cast one.obj --rays - --lanes 4 -q -o - < rays.csv");
  EXPECT_EQ(rays.out, kCsv) << rays.err;
  EXPECT_EQ(shell("echo 0,0,x | \"$CDE\" cast one.obj --rays - -q -o -").err.find("cde: stdin:1:5"),
            0u);
  EXPECT_FALSE(exists("-"));
}

TEST_F(Outputs, Input_IsNotOverwritten) {
  fs::create_symlink("one.obj", folder_ / "soft");
  fs::create_hard_link(folder_ / "rays.csv", folder_ / "hard");
  refused_saying(cast({"-o", "one.obj"}), "-o would write to one.obj, which MESH reads");
  refused_saying(cast({"-o", "./one.obj"}), "-o would write to ./one.obj, which MESH reads");
  refused_saying(cast({"--trace", "soft"}), "--trace would write to soft, which MESH reads");
  refused_saying(cast({"-o", "hard"}), "-o would write to hard, which --rays reads");
  refused_saying({"render", "one.obj", "--grid", "4x4", "--image", "one.obj"},
                 "--image would write to one.obj, which MESH reads");
  refused_saying({"run", "scene.toml", "--report", "scene.toml"},
                 "--report would write to scene.toml, which SCENE reads");
  refused_saying({"run", "scene.toml", "--trace", "soft"},
                 "--trace would write to soft, which object 'triangles' reads");
  refused_saying({"run", "scene.toml", "--report", "rays.csv"},
                 "--report would write to rays.csv, which object 'rays' reads");
  const Ran same = shell("\"$CDE\" cast one.obj --rays - -q -o rays.csv < rays.csv");
  EXPECT_EQ(same.status, 2);
  EXPECT_EQ(same.err, "cde: -o would write to rays.csv, which --rays reads\n");
  const Ran appended = shell("\"$CDE\" cast one.obj --rays rays.csv -q -o - >> rays.csv");
  EXPECT_EQ(appended.status, 2);
  EXPECT_EQ(appended.err, "cde: -o would write to stdout, which --rays reads\n");
  expect_inputs();
}

TEST_F(Outputs, TwoOutputsInOneFile_AreRefused) {
  refused_saying(cast({"-o", "x", "--trace", "./x"}), "-o and --trace both write to ./x");
  refused_saying({"render", "one.obj", "--grid", "4x4", "--image", "x", "--shaded", "x"},
                 "--image and --shaded both write to x");
  refused_saying(cast({"-o", "-", "--json"}), "-o and --json both write to stdout");
  refused_saying(cast({"-o", "/dev/stdout", "--json"}), "-o and --json both write to stdout");
  refused_saying({"run", "scene.toml", "--report", "x", "--trace", "x"},
                 "--report and --trace both write to x");
  refused_saying({"run", "scene.toml", "--report", "-", "--json"},
                 "--report and --json both write to stdout");
  refused_saying({"reproduce", "--quick", "--json", "--out", "-"},
                 "--output and --json both write to stdout");
  EXPECT_EQ(cde(cast({"-o", "/dev/null", "--trace", "/dev/null"})).status, 0);
}

/// Errors that can be found before the work starts.
TEST_F(Outputs, UnwritableOutput_IsFoundBeforeTheWork) {
  fs::create_directory(folder_ / "folder");
  const Words big = {"render", "terrain", "--grid", "512x512", "-q"};
  for (const char* option : {"--image", "--shaded", "-o"}) {
    Words words = big;
    words.insert(words.end(), {option, "none/x.png"});
    refused_saying(words, "none/x.png: cannot create: No such file or directory");
    words.back() = "folder";
    refused_saying(words, "folder: cannot write: Is a directory");
  }
}

TEST_F(Outputs, FilesOfAKilledCommand_AreRemoved) {
  for (const std::string option : {"-o", "--trace"}) {
    const std::string out = option == "-o" ? "out.csv" : "out.fst";
    const pid_t child = start({"cast", "terrain:60,60,1", "--grid", "300x300", "--lanes",
                               option == "--trace" ? "4" : "16", "-q", option, out});
    bool began = false;
    for (int i = 0; i < 1200 && !began; ++i, ::usleep(10'000)) began = files().size() > 3;
    // A second command that writes the same name does not disturb the first one, and vice versa.
    EXPECT_EQ(cde(cast({option, out})).status, 0);
    ASSERT_TRUE(began);
    EXPECT_EQ(files().size(), 5u) << fmt::format("{}", fmt::join(files(), " "));
    ::kill(child, SIGKILL);
    (void)finish(child);
    EXPECT_EQ(files().size(), 5u) << "the killed command could not remove its file";
    EXPECT_EQ(cde(cast({option, out})).status, 0);
    EXPECT_EQ(files(), (Words{"one.obj", out, "rays.csv", "scene.toml"}));
    fs::remove(folder_ / out);
  }
}

}  // namespace
}  // namespace cde::testing
