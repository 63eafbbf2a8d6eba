// SPDX-License-Identifier: Apache-2.0
// Uses of stdout and stderr, and errors while writing to one of them.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

const std::string kStreamScene = R"(frames = 2
[card]
lanes = 4
[[object]]
name = "triangles"
mesh = "one.obj"
[[object]]
name = "rays"
random_rays = { count = 3, seed = 7 }
)" + hit_query("triangles");

/// A script, and its status when every stream works.
struct Command {
  const char* words;
  int status = 0;
};
/// --exact-card: otherwise another model stands in, with a message.
const Command kPrinting[] = {{"cast one.obj --ray 0,0,0,0,0,1 --lanes 4 --exact-card --json"},
                             {"cast one.obj --ray 0,0,0,0,0,1 --lanes 4 --exact-card -o -"},
                             {"render one.obj --grid 4x4 --lanes 4 --exact-card --image -"},
                             {"run scene.toml --exact-card --json"},
                             {"run scene.toml --exact-card --report -"},
                             {"plan scene.toml"},
                             {"plan scene.toml --json"},
                             {"query sphere-sphere < pairs"},
                             {"query sphere-sphere --json < pairs"},
                             {"query sphere-sphere < bad_pairs", 2},
                             {"fp add --arith host < operands"},
                             {"fp add --arith host < bad_operands", 2},
                             {"bench fp --quick"},
                             {"doctor"},
                             {"--help"},
                             {"--help-all"},
                             {"cast --help"}};

class Streams : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("one.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
    write("scene.toml", kStreamScene);
    write("pairs", "0,0,0,1, 1.5,0,0,1\n");
    write("bad_pairs", "0,0,0,1, 1.5,0,0,1\nx\n");
    write("operands", "3F800000 40000000\n");
    write("bad_operands", "3F800000 40000000\nx\n");
  }
};

TEST_F(Streams, UnwritableStdout_IsStatus2AndOneLine) {
  for (const Command& command : kPrinting) {
    // Building models now keeps their messages out of the test.
    (void)shell(fmt::format("\"$CDE\" {} > /dev/null 2>&1", command.words));
    for (const auto& [to, why] : {std::pair{"> /dev/full", "No space left on device"},
                                  std::pair{">&-", "Bad file descriptor"}}) {
      SCOPED_TRACE(fmt::format("cde {} {}", command.words, to));
      const Ran ran = shell(fmt::format("\"$CDE\" {} {}", command.words, to));
      EXPECT_EQ(ran.status, 2);
      EXPECT_EQ(ran.err, fmt::format("cde: stdout: cannot write: {}\n", why));
    }
  }
}

/// The command writes nothing to stdout, so any stdout will do.
TEST_F(Streams, UnneededStdout_IsIgnored) {
  const Ran ran =
      shell("\"$CDE\" cast one.obj --ray 0.25,0.25,0,0,0,2 --lanes 4 -q -o hits.csv >&- 2>&- <&-");
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(read("hits.csv"), "ray,F,T,CPx,CPy,CPz,index\n0,1,0.5,0.25,0.25,1,0\n")
      << "no file may get the number of stdout";
}

/// With SIGCHLD ignored the system keeps no exit status of the child process that reads the file.
TEST_F(Streams, IgnoredChildSignal_KeepsTheExitStatus) {
  write("bad.vcd", "$var wire\n");
  for (const char* file : {"none.fst", "bad.vcd"})
    EXPECT_EQ(
        shell(fmt::format("perl -e '$SIG{{CHLD}} = \"IGNORE\"; exec @ARGV' \"$CDE\" wave info {}",
                          file))
            .status,
        2)
        << file;
}

TEST_F(Streams, WithoutStderr_CommandContinues) {
  const auto run_all = [this](std::span<const Command> commands, bool print) {
    for (const Command& command : commands) {
      for (const char* to : {"2> /dev/full", "2>&-"}) {
        SCOPED_TRACE(fmt::format("cde {} {}", command.words, to));
        const Ran ran = shell(fmt::format("\"$CDE\" {} {}", command.words, to));
        EXPECT_EQ(ran.status, command.status);
        EXPECT_EQ(ran.out.empty(), !print);
      }
    }
  };
  run_all(kPrinting, true);
  const Command failing[] = {{"cast one.obj --ray 0,0,0,0,0,1 --lanes 4 --deadline 10", 4},
                             {"cast none.obj --ray 0,0,0,0,0,1", 2},
                             {"cats", 2},
                             {"run scene.toml --deadline 10", 4}};
  run_all(failing, false);
  // A pipe whose reader has gone.
  const Ran ran = shell(
      "exec 3> >(exec 3>&-); sleep 0.2; "
      "\"$CDE\" cast one.obj --ray 0.25,0.25,0,0,0,2 --lanes 4 -o - 2>&3");
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out, "ray,F,T,CPx,CPy,CPz,index\n0,1,0.5,0.25,0.25,1,0\n");
}

/// On a closed pipe (`| head`) the command exits quietly with SIGPIPE, and leaves no file.
TEST_F(Streams, ClosedPipe_EndsQuietly) {
  const Ran ran = shell(
      "\"$CDE\" render terrain:60,60,1 --grid 300x300 --lanes 16 -o - --shaded x.png | head -1;"
      "echo ${PIPESTATUS[0]}");
  EXPECT_EQ(ran.out, fmt::format("ray,F,T,CPx,CPy,CPz,index\n{}\n", 128 + SIGPIPE));
  EXPECT_EQ(ran.err, "");
  EXPECT_FALSE(exists("x.png"));
  const Ran heard = shell(
      "trap '' PIPE; \"$CDE\" cast terrain:60,60,1 --grid 300x300 --lanes 16 -o - | head -1;"
      "echo ${PIPESTATUS[0]}");
  EXPECT_EQ(heard.out, "ray,F,T,CPx,CPy,CPz,index\n2\n");
  EXPECT_EQ(heard.err, "cde: stdout: cannot write: Broken pipe\n")
      << "the signal is ignored, so the error is reported";
}

TEST_F(Streams, Results_AreOnStdout) {
  const Ran query = shell("\"$CDE\" query sphere-sphere --json < pairs");
  EXPECT_EQ(query.err, "");
  EXPECT_EQ(std::count(query.out.begin(), query.out.end(), '\n'), 3) << query.out;
  EXPECT_EQ(nlohmann::json::parse(query.out.substr(query.out.find('{')))["tests"], 1);
  const Ran bench = cde({"bench", "fp", "--quick"});
  EXPECT_TRUE(has(bench.out, "gate-level units"));
  EXPECT_EQ(bench.err, "");
  const Ran json = cde({"bench", "fp", "--quick", "--json"});
  EXPECT_TRUE(nlohmann::json::parse(json.out).contains("fp"));
  EXPECT_TRUE(has(json.err, "gate-level units"));
}

TEST_F(Streams, NonUtf8Names_AreAccepted) {
  const std::string odd = "a\xff\xc3";
  fs::rename(folder_ / "one.obj", folder_ / (odd + ".obj"));
  fs::create_directory(folder_ / odd);
  const Ran cast = cde({"cast", odd + ".obj", "--ray", "0,0,0,0,0,1", "--lanes", "4", "--json"});
  ASSERT_EQ(cast.status, 0) << cast.err;
  EXPECT_EQ(nlohmann::json::parse(cast.out)["mesh"], "a\xef\xbf\xbd\xef\xbf\xbd.obj");
  EXPECT_TRUE(has(cast.err, "a\\xff\\xc3.obj, 1 triangle\n"));
  std::string scene = kStreamScene;
  write(odd + "/" + odd + ".toml", scene.replace(scene.find("one.obj"), 7, "terrain:3,3,1"));
  const std::string file = odd + "/" + odd + ".toml";
  const Ran run = cde({"run", file, "--json", "--report", "page.html", "--out", odd + ".run"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["finished"], true);
  EXPECT_EQ(nlohmann::json::parse(read(odd + ".run/run.json"))["scene"],
            "a\xef\xbf\xbd\xef\xbf\xbd/a\xef\xbf\xbd\xef\xbf\xbd.toml");
  const std::string page = read("page.html");
  EXPECT_TRUE(has(page, "<h1>a\xef\xbf\xbd\xef\xbf\xbd.toml</h1>"));
  EXPECT_EQ(page.find('\xff'), std::string::npos);
  const Ran plan = cde({"plan", file, "--json"});
  EXPECT_EQ(plan.status, 0) << plan.err;
}

/// Names and texts in files that would clear a terminal, change its title or fake a line.
TEST_F(Streams, ControlCharactersInFiles_ArePrintedEscaped) {
  const auto quiet = [](const std::string& text) {
    return std::none_of(text.begin(), text.end(),
                        [](char c) { return c != '\n' && static_cast<unsigned char>(c) < 0x20; }) &&
           text.find("\xc2\x9b") == std::string::npos && text.find('\x7f') == std::string::npos;
  };
  std::string scene = kStreamScene;
  const std::string evil = R"(\u001b]0;owned\u0007\n\u009b31mcde: all is well)";
  scene.replace(scene.find("one.obj"), 7, evil + ".obj");
  write("mesh.toml", scene);
  scene = kStreamScene;
  scene.replace(scene.find("\"triangles\"\nmesh"), 11, "\"" + evil + "\"");
  write("object.toml", scene);
  scene = kStreamScene;
  scene.replace(scene.find("\"hit\""), 5, "\"" + evil + "\"");
  write("query.toml", scene);
  write("key.toml", "\"" + evil + "\" = 1\n" + kStreamScene);
  write("raw.toml", "title = \"\x1b[31m\"\n" + kStreamScene);
  write("title.toml", "title = \"" + evil + "\"\n" + kStreamScene);
  for (const char* file :
       {"mesh.toml", "object.toml", "query.toml", "key.toml", "raw.toml", "title.toml"}) {
    for (const char* verb : {"plan", "run"}) {
      const Ran ran = cde({verb, file});
      const bool fine = std::string(file) == "title.toml";
      EXPECT_EQ(ran.status, fine ? 0 : 2) << file << ran.err;
      EXPECT_TRUE(quiet(ran.err)) << file << ": " << ran.err;
      EXPECT_TRUE(quiet(ran.out)) << file << ": " << ran.out;
      if (!fine) {
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
      }
    }
  }
  const Ran json = cde({"run", "title.toml", "--json"});
  EXPECT_TRUE(quiet(json.out));
  EXPECT_EQ(nlohmann::json::parse(json.out)["title"],
            "\x1b]0;owned\a\n\xc2\x9b"
            "31mcde: all is well");
  write("evil.obj", "v 0 0 0\nf \x1b[31m 2 3\n");
  write("evil.ply", "ply\nformat \x1b[31m\n");
  write("evil.csv", "\x1b[31m,1,2\n");
  for (const char* words : {"cast evil.obj --ray 0,0,0,0,0,1", "cast evil.ply --ray 0,0,0,0,0,1",
                            "cast one.obj --rays evil.csv", "query sphere-sphere < evil.csv",
                            "fp add --arith host < evil.csv"}) {
    const Ran ran = shell(fmt::format("\"$CDE\" {}", words));
    EXPECT_EQ(ran.status, 2) << words;
    EXPECT_TRUE(quiet(ran.err)) << words << ": " << ran.err;
  }
}

}  // namespace
}  // namespace cde::testing
