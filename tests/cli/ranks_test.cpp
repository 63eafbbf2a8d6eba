// SPDX-License-Identifier: Apache-2.0
// Runs in chunks: journals, shards, and ranks under mpirun if it is installed. Outputs are
// byte-identical to the plain run.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "../has.hpp"
#include "cde/jobs/journal.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

class Ranks : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write("square.obj", "v 0 0 0\nv 4 0 1\nv 4 3 0\nv 0 3 1\nf 1 2 3\nf 1 3 4\n");
    const Ran plain = cde(cast("plain.csv"));
    ASSERT_EQ(plain.status, 0) << plain.err;
  }
  /// A cast of three chunks.
  static Words cast(const std::string& records, const Words& more = {}) {
    Words words = {"cast", "square.obj", "--grid", "420x420", "-o", records, "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Whether two files have the same bytes; a failure does not print them.
  [[nodiscard]] bool same(const std::string& a, const std::string& b) const {
    return exists(a) && exists(b) && read(a) == read(b);
  }
  /// Positions in a journal before each chunk's line, and the end.
  static std::vector<std::size_t> ends(const std::string& journal) {
    std::vector<std::size_t> at;
    for (std::size_t i = 0; (i = journal.find("{\"part\":", i)) != std::string::npos; ++i)
      at.push_back(i);
    at.push_back(journal.size());
    return at;
  }
  /// The journal with the fingerprint of its first line as it is now.
  static std::string with_first_line(std::string journal) {
    const std::string key = ",\"fingerprint\":\"";
    const std::size_t at = journal.rfind(key, journal.find('\n'));
    return journal.replace(at + key.size(), 16, fingerprint(journal.substr(0, at)));
  }
  /// A cast of `side` x `side` rays at a mesh that is large enough for a BVH.
  static Words through(const std::string& records, unsigned side, const Words& more = {}) {
    Words words = {"cast", "terrain:40,40,3", "--grid", fmt::format("{}x{}", side, side),
                   "-o",   records,           "--json", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The traversal counters of a summary, which do not depend on chunks.
  static std::string counted(const Ran& ran) {
    const auto json = nlohmann::json::parse(ran.out);
    std::string text;
    for (const char* key : {"through", "brute_force_rays", "nodes", "leaves", "deepest", "tests",
                            "hits", "records", "records_compared", "records_matching"})
      text += fmt::format("{} {}\n", key, json.at(key).dump());
    return text;
  }
};

TEST_F(Ranks, CastFromAnyByteOfItsJournal_Continues) {
  ASSERT_EQ(cde(cast("whole.csv", {"--resume", "journal"})).status, 0);
  EXPECT_TRUE(same("whole.csv", "plain.csv"));
  const std::string journal = read("journal");
  const std::vector<std::size_t> at = ends(journal);
  ASSERT_EQ(at.size(), 5u) << "three chunks, and the line with their number";
  for (const std::size_t end :
       {std::size_t{7}, at[0], at[1] - 1, at[1] + 40, at[2] + 5000, at[3], at[3] + 3, at[4]}) {
    write("journal", journal.substr(0, end));
    const Ran rest = cde(cast("rest.csv", {"--resume", "journal"}));
    EXPECT_EQ(rest.status, 0) << end << rest.err;
    EXPECT_TRUE(same("rest.csv", "plain.csv")) << end;
    EXPECT_EQ(ends(read("journal")).size(), at.size()) << end;
  }
}

TEST_F(Ranks, ForeignJournal_IsRefused) {
  ASSERT_EQ(cde(cast("whole.csv", {"--resume", "journal"})).status, 0);
  const std::string journal = read("journal");
  refused(cast("x.csv", {"--resume", "journal", "--mode", "any"}),
          "--resume: journal belongs to a run with mode \"nearest\"; this run has \"any\"");
  refused(cast("x.csv", {"--resume", "journal", "--no-check"}),
          "belongs to a run with checked true");
  Words other = cast("x.csv", {"--resume", "journal"});
  other[3] = "421x420";
  refused(other, "journal belongs to a run with another input: its chunk 0 differs");
  write("square.obj", "v 0 0 0\nv 4 0 1\nv 4 3 0\nv 0 3 2\nf 1 2 3\nf 1 3 4\n");
  refused(cast("x.csv", {"--resume", "journal"}),
          "journal belongs to a run with mesh \"square.obj ");
  EXPECT_EQ(read("journal"), journal) << "a refused journal must stay unchanged";
  EXPECT_FALSE(exists("x.csv"));
}

TEST_F(Ranks, DamagedJournal_IsNamed) {
  ASSERT_EQ(cde(cast("whole.csv", {"--resume", "journal"})).status, 0);
  const std::string journal = read("journal");
  const std::vector<std::size_t> at = ends(journal);
  std::string bad = journal;
  bad[at[1] + 3000] ^= 1;  // in the records of the second chunk
  write("bad", bad);
  refused(cast("x.csv", {"--resume", "bad"}), "the chunk is damaged");
  refused({"merge", "bad"}, "the chunk is damaged");
  bad = journal;
  bad.replace(at[2], 8, "{\"prat\":");
  write("bad", bad);
  refused(cast("x.csv", {"--resume", "bad"}), fmt::format("bad, byte {}: not a chunk", at[2]));
  bad = journal.substr(0, at[2]) + journal.substr(at[1]);
  write("bad", bad);
  refused(cast("x.csv", {"--resume", "bad"}), "the chunk appears twice");
  bad = journal;
  bad.replace(bad.find("\"bytes\":") + 8, 1, "99");
  write("bad", bad);
  refused(cast("x.csv", {"--resume", "bad"}),
          fmt::format("but another entry begins at byte {}", at[1] + 1));
  EXPECT_EQ(read("bad"), bad) << "the journal must not be truncated";
  for (const char* key : {"\"bytes\":", "\"chunk\":", "\"part\":", "\"chunks\":"}) {
    for (const char* number : {"-", "0.5e1", "99999999999999", "\"1\","}) {
      bad = journal;
      bad.insert(bad.find(key) + std::string(key).size(), number);
      write("bad", bad);
      refused(cast("x.csv", {"--resume", "bad"}), "not a chunk of a journal");
    }
  }
  const std::string words = "\"words\":";
  for (const char* other :
       {"5,\"o\":", "[],\"o\":", "[\"merge\",\"bad\"],\"o\":", "[\"plan\"],\"o\":",
        "[\"cast\",5],\"o\":", "[\"cast\",\"-oa\\u0000b\"],\"o\":"}) {
    bad = journal;
    bad.insert(bad.find(words) + words.size(), other);
    write("bad", with_first_line(bad));
    refused({"merge", "bad"}, "bad: \"words\" is not the command of a run");
  }
  refused(cast("x.csv", {"--resume", "x.csv"}), "-o and --resume both write to x.csv");
  for (const char* text : {"something else\n", "\n", "{}\n", "{\"schema\":\"other\"}\n", "[1]\n"}) {
    write("bad", text);
    refused(cast("x.csv", {"--resume", "bad"}), "bad, byte 0: not a journal");
    refused({"merge", "bad"}, "bad, byte 0: not a journal");
  }
  for (const char* file : {"/dev/null", "."}) {
    refused(cast("x.csv", {"--resume", file}), file);
    refused({"merge", file}, file);
  }
  refused({"merge", "nowhere"}, "nowhere");
  refused(cast("x.csv", {"--resume", "-"}), "--resume is -; it must be a file");
  EXPECT_FALSE(exists("x.csv"));
}

/// `merge` runs the command of a journal, and the command names outputs.
TEST_F(Ranks, JournalWritableByOthers_IsNotRun) {
  ASSERT_EQ(cde(cast("x.csv", {"--resume", "journal"})).status, 0);
  fs::remove(folder_ / "x.csv");
  fs::permissions(folder_ / "journal", fs::perms::others_write, fs::perm_options::add);
  refused({"merge", "journal"}, "journal is refused, because its command would be run: all users");
  refused(cast("x.csv", {"--resume", "journal"}),
          "journal is refused, because its results would not be checked again: all users");
  fs::permissions(folder_ / "journal", fs::perms::others_write, fs::perm_options::remove);
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown((folder_ / "journal").c_str(), 65534, 65534), 0);
    for (const Words& words : {Words{"merge", "journal"}, cast("x.csv", {"--resume", "journal"})})
      refused(words, "it belongs to user 65534; make a copy of your own");
    fs::copy_file(folder_ / "journal", folder_ / "copy");
    ASSERT_EQ(cde({"merge", "copy"}).status, 0);
  }
}

TEST_F(Ranks, Merge_OverwritesNoJournal) {
  ASSERT_EQ(cde(cast("j.csv", {"--resume", "journal"})).status, 0);
  fs::copy_file(folder_ / "journal", folder_ / "j.csv", fs::copy_options::overwrite_existing);
  refused({"merge", "j.csv"}, "-o would write to j.csv, which merge reads");
  EXPECT_TRUE(same("j.csv", "journal"));
}

TEST_F(Ranks, NonUtf8Arguments_AreRefused) {
  refused(cast("\xff.csv", {"--resume", "journal"}), "--resume stores the command line");
}

TEST_F(Ranks, JournalOfAnotherProcess_IsRefused) {
  write("journal", "");
  const int file = ::open((folder_ / "journal").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(file, LOCK_EX), 0);
  refused(cast("x.csv", {"--resume", "journal"}), "another process works on journal");
  ::close(file);
}

TEST_F(Ranks, ShardsOfACast_AddUpToTheWhole) {
  for (const int i : {3, 1, 2}) {
    const Ran ran = cde(
        cast("merged.csv", {"--resume", fmt::format("s{}", i), fmt::format("--shard={}/3", i)}));
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_FALSE(exists("merged.csv")) << "a part must not be written as a result";
  }
  const Ran merged = cde({"merge", "s2", "s3", "s1"});
  EXPECT_EQ(merged.status, 0) << merged.err;
  EXPECT_TRUE(same("merged.csv", "plain.csv"));

  refused({"merge", "s1", "s3"}, "chunk 1 of 3 is in no journal; the journal of shard 2/3 is");
  refused({"merge", "s1", "s2", "s3", "s1"}, "cde merge: chunk 0 is in s1 and in s1");
  const std::string half = read("s2");
  write("s2", half.substr(0, half.size() - 30));
  refused({"merge", "s1", "s2", "s3"}, "s2 (shard 2/3) is not finished");
  ASSERT_EQ(cde(cast("o.csv", {"--mode", "any", "--resume", "any", "--shard", "2/3"})).status, 0);
  refused({"merge", "s1", "any", "s3"}, "any belongs to a run with mode \"any\"; this run has");
  Words others = cast("o.csv", {"--resume", "other", "--shard", "2/3"});
  others[3] = "420x419";
  ASSERT_EQ(cde(others).status, 0);
  write("s2", half);
  refused({"merge", "s1", "other", "s3"}, "s1 and other belong to runs with different inputs");
  write("empty", "");
  refused({"merge", "s1", "empty", "s3"}, "empty is not finished; its command has not begun");
  write("torn", half.substr(0, 100));
  refused({"merge", "torn"}, "torn is not finished; its command has not begun");
  std::string rays;
  for (int i = 0; i < 10; ++i) rays += fmt::format("{},1,9,0,0,-1\n", i);
  write("rays", rays);
  const Words of_file = {"cast", "square.obj", "--rays", "rays",    "-o", "rays.csv",
                         "-q",   "--resume",   "whole",  "--shard", "1/1"};
  ASSERT_EQ(cde(of_file).status, 0);
  EXPECT_EQ(cde({"merge", "whole"}).status, 0);
  Words to_stdout = of_file;
  to_stdout[5] = "-", to_stdout[8] = "printed";
  ASSERT_EQ(cde(to_stdout).status, 0);
  const Ran printed = cde({"merge", "printed"});
  EXPECT_EQ(printed.out, read("rays.csv")) << printed.err;
  write("rays", rays + "7,7,7,0,0,-1\n");
  EXPECT_EQ(cde({"merge", "printed"}).out, "") << "no part may be printed";
  refused({"merge", "whole"}, "whole belongs to a run with another input: its chunk 0 differs");
  refused(cast("x.csv", {"--shard", "1/2"}), "--shard needs --resume");
  refused(cast("x.csv", {"--shard", "0/2", "--resume", "x"}), "--shard is '0/2'; it must be I/N");
  refused(cast("x.csv", {"--shard", "1/2", "--resume", "x", "--boards", "2"}),
          "--boards works only in one process");
}

TEST_F(Ranks, ChunksWithABvh_AddUpToTheWhole) {
  constexpr unsigned kSide = 260;  // three chunks
  const Ran one = cde(through("one.csv", kSide));
  ASSERT_EQ(one.status, 0) << one.err;
  ASSERT_TRUE(counted(one).starts_with("through \"bvh\"\nbrute_force_rays 64\n")) << one.out;
  ASSERT_EQ(cde(through("brute_force.csv", kSide, {"--no-bvh", "--no-check"})).status, 0);
  EXPECT_TRUE(same("brute_force.csv", "one.csv"));

  const Ran whole = cde(through("whole.csv", kSide, {"--resume", "journal"}));
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_TRUE(same("whole.csv", "one.csv"));
  EXPECT_EQ(counted(whole), counted(one));
  const std::string journal = read("journal");
  const std::vector<std::size_t> at = ends(journal);
  ASSERT_EQ(at.size(), 5u) << "three chunks, and the line with their number";
  for (const std::size_t end : {at[0], at[1] + 5000, at[3]}) {
    write("journal", journal.substr(0, end));
    const Ran rest = cde(through("rest.csv", kSide, {"--resume", "journal"}));
    EXPECT_EQ(rest.status, 0) << end << rest.err;
    EXPECT_TRUE(same("rest.csv", "one.csv")) << end;
    EXPECT_EQ(counted(rest), counted(one)) << end;
  }
  refused(through("x.csv", kSide, {"--resume", "journal", "--no-bvh"}),
          "journal belongs to a run with through \"bvh\"; this run has \"brute_force\"");
  refused(through("x.csv", kSide, {"--resume", "journal", "--check=rays:9"}),
          "journal belongs to a run with brute_force_rays 64; this run has 9");

  for (const char* i : {"1", "2"}) {
    const Ran ran = cde(through("merged.csv", kSide,
                                {"--resume", i, "--shard", std::string(i) + "/2", "--no-check"}));
    EXPECT_EQ(ran.status, 0) << ran.err;
  }
  const Ran merged = cde({"merge", "2", "1"});
  EXPECT_EQ(merged.status, 0) << merged.err;
  EXPECT_TRUE(same("merged.csv", "one.csv"));
  const Ran unchecked = cde(through("one.csv", kSide, {"--no-check"}));
  EXPECT_EQ(counted(merged), counted(unchecked));
}

/// The run is killed as soon as one of eight chunks is in the journal.
TEST_F(Ranks, KilledRunWithABvh_Continues) {
  const auto words = [](const char* records) {
    return through(records, 512, {"--no-check", "--resume", "journal"});
  };
  std::size_t kept = 0;
  for (int tries = 0; tries < 5 && (kept < 1 || kept > 7); ++tries) {
    std::filesystem::remove(folder_ / "journal");
    const pid_t run = start(words("r.csv"));
    for (int i = 0; i < 60'000 && (!exists("journal") || ends(read("journal")).size() < 2); ++i)
      ::usleep(1000);
    ::kill(run, SIGKILL);
    (void)finish(run);
    kept = ends(read("journal")).size() - 1;
  }
  ASSERT_GE(kept, 1u);
  ASSERT_LE(kept, 7u) << "the run was not killed before its end";
  EXPECT_FALSE(exists("r.csv")) << "a partial output";
  const Ran rest = cde(words("r.csv"));
  EXPECT_EQ(rest.status, 0) << rest.err;
  const Ran one = cde(through("one.csv", 512, {"--no-check"}));
  EXPECT_TRUE(same("r.csv", "one.csv"));
  EXPECT_EQ(counted(rest), counted(one));
}

TEST_F(Ranks, ShardsOfAQuery_AddUpToTheWhole) {
  std::ofstream lines(folder_ / "pairs");
  std::mt19937 random(7);
  std::uniform_real_distribution<float> some(-2, 2);
  const auto number = [&] { return some(random); };
  for (int i = 0; i < 150'000; ++i) {
    if (i % 50'000 == 17) {
      lines << "# a comment\n\nnot a pair\n";
      continue;
    }
    lines << fmt::format("{} {} {} {} | {} {} {} {}\n", number(), number(), number(),
                         std::abs(number()) * (i % 7'777 == 5 ? -1 : 1), number(), number(),
                         number(), std::abs(number()));
  }
  lines.close();
  const std::string query = "\"$CDE\" query sphere-sphere -q ";
  const Ran plain = shell(query + "< pairs");
  EXPECT_EQ(plain.status, 2) << "status for malformed lines";
  const Ran slow = shell(
      "for p in 1 2 3; do head -c $((p * 1000000)) pairs | tail -c +$(((p - 1) * "
      "1000000 + 1)); sleep 0.05; done | cat - <(tail -c +3000001 pairs) | " +
      query + "--resume journal");
  EXPECT_EQ(slow.status, 2);
  EXPECT_EQ(slow.out, plain.out);
  EXPECT_EQ(slow.err, plain.err) << "messages come in the same order";
  for (int i = 1; i <= 2; ++i)
    EXPECT_EQ(shell(query + fmt::format("--shard {}/2 --resume q{} < pairs", i, i)).status, 0);
  const Ran merged = shell("\"$CDE\" merge q1 q2");
  EXPECT_EQ(merged.status, 2);
  EXPECT_EQ(merged.out, plain.out);
  EXPECT_EQ(merged.err, plain.err);
  ASSERT_EQ(shell("tac pairs | " + query + "--shard 2/2 --resume q3").status, 0);
  const Ran mixed = shell("\"$CDE\" merge q1 q3");
  EXPECT_EQ(mixed.status, 2);
  EXPECT_EQ(mixed.out, "");
  EXPECT_TRUE(has(mixed.err, "q1 and q3 belong to runs with different inputs"));
  EXPECT_EQ(shell(query + "--resume journal -o answers < pairs").status, 2);
  EXPECT_EQ(read("answers"), plain.out);
  const Ran other = shell("head -n 100000 pairs | " + query + "--resume journal");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "journal belongs to a run with another input"));
}

TEST_F(Ranks, ShardsOfARun_AddUpToTheWhole) {
  const Words run = {"run",          std::string(CDE_SOURCE_DIR) + "/meshes/scenes/spheres.toml",
                     "--frames",     "3..7",
                     "--exact-card", "-q"};
  const auto with = [&](const Words& more) {
    Words words = run;
    words.insert(words.end(), more.begin(), more.end());
    return cde(words);
  };
  const Ran plain = with({"--out", "plain.run"});
  ASSERT_EQ(plain.status, 0) << plain.err;
  for (const char* i : {"1", "2"})
    EXPECT_EQ(with({"--out", "merged.run", "--resume", i, "--shard", std::string(i) + "/2"}).status,
              0);
  EXPECT_FALSE(exists("merged.run"));
  const Ran merged = cde({"merge", "1", "2"});
  EXPECT_EQ(merged.status, 0) << merged.err;
  std::size_t records = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "plain.run")) {
    const std::string name = entry.path().filename();
    if (name == "run.json") continue;
    ++records;
    EXPECT_TRUE(same("merged.run/" + name, "plain.run/" + name)) << name;
  }
  EXPECT_EQ(records, 1u);
  const auto counted = [&](const std::string& folder) {
    const auto json = nlohmann::ordered_json::parse(read(folder + "/run.json"));
    return fmt::format("{} {} {} {}", json.at("totals").at("tests").get<int>(),
                       json.at("totals").at("hits").get<int>(), json.at("frame_results").size(),
                       json.at("config_hash").get<std::string>());
  };
  EXPECT_EQ(counted("merged.run"), counted("plain.run"));
  const Ran other = cde({"run", run[1], "--frames", "3..8", "--exact-card", "--resume", "1"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "1 belongs to a run with frames [3,7]; this run has [3,8]"));
  for (const Words& more : std::initializer_list<Words>{
           {"--trace", "w.fst"}, {"--report", "r.html"}, {"--fault", "parity@3"}})
    EXPECT_TRUE(has(with({"--resume", "x", more[0], more[1]}).err, "work only in one process"));
}

/// In every mode the lower index wins ties between parts of a mesh.
TEST_F(Ranks, PartsOfAMesh_GiveTheRecordsOfOneCard) {
  // Two squares in one plane, each triangle four times: every hit is a tie.
  std::string twice = "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\n";
  for (int i = 0; i < 4; ++i) twice += "f 1 2 3\nf 1 3 4\n";
  write("tied.obj", twice);
  for (const char* mesh : {"tied.obj", "terrain:9,9,3"}) {
    for (const char* mode : {"nearest", "farthest", "any", "all", "hits"}) {
      const auto cast_in = [&](const char* parts, const char* records) {
        return cde({"cast", mesh, "--grid", "20x30", "--mode", mode, "-o", records, "--partition",
                    parts, "-q"});
      };
      ASSERT_EQ(cast_in("1", "one.csv").status, 0);
      for (const char* parts : {"3", "8"}) {
        const Ran ran = cast_in(parts, "parts.csv");
        EXPECT_EQ(ran.status, 0) << ran.err;
        EXPECT_TRUE(same("parts.csv", "one.csv")) << mesh << mode << parts;
      }
    }
  }
  // Without an output option the command writes a picture, which needs the mesh.
  ASSERT_EQ(cde({"render", "tied.obj", "--size", "32x24", "-q"}).status, 0);
  const std::string picture = read("tied.render.png");
  std::filesystem::remove(folder_ / "tied.render.png");
  EXPECT_EQ(cde({"render", "tied.obj", "--size", "32x24", "-q", "--partition", "2"}).status, 0);
  EXPECT_EQ(read("tied.render.png"), picture);
  refused({"cast", "tied.obj", "--partition", "9", "--grid", "4x4"},
          "--partition 9: tied.obj has 8 triangles");
}

/// Starts as many ranks as the test requests, on this machine.
class MpiRanks : public Ranks {
 protected:
  void SetUp() override {
    Ranks::SetUp();
    if (shell("command -v mpirun").status != 0) GTEST_SKIP() << "mpirun is not installed";
    const Ran built = shell(run(2) + " plan");
    if (built.err.find("without MPI") != std::string::npos) GTEST_SKIP() << "built without MPI";
  }
  static std::string run(unsigned ranks) {
    return fmt::format(
        "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; mpirun --oversubscribe "
        "-n {} \"$CDE\"",
        ranks);
  }
  static std::string words(const Words& all) {
    std::string text;
    for (const std::string& word : all) text += " " + word;
    return text;
  }
};

TEST_F(MpiRanks, SeveralRanks_GiveTheOutputOfOne) {
  for (const unsigned ranks : {1u, 2u, 3u}) {
    const Ran ran = shell(run(ranks) + words(cast("ranks.csv")));
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.err, "") << "no rank may print a message";
    EXPECT_TRUE(same("ranks.csv", "plain.csv")) << ranks;
    const Ran parts = shell(run(ranks) + words(cast("parts.csv", {"--partition", "2"})));
    EXPECT_EQ(parts.status, 0) << parts.err;
    EXPECT_TRUE(same("parts.csv", "plain.csv")) << ranks;
  }
  const std::string picture = " render terrain:40,40,2 --size 64x48 --shadows -q --shaded ";
  ASSERT_EQ(shell("\"$CDE\"" + picture + "one.png").status, 0);
  EXPECT_EQ(shell(run(2) + picture + "two.png").status, 0);
  EXPECT_TRUE(same("one.png", "two.png"));
  const std::string some =
      " accuracy --pair sphere-plane --formats fp16,fp32 --cases 90 -q "
      "--no-operators";
  EXPECT_EQ(shell(run(2) + some).out, shell("\"$CDE\"" + some).out);
}

TEST_F(MpiRanks, SeveralRanksWithABvh_GiveTheOutputOfOne) {
  for (const char* mode : {"nearest", "hits", "occluded"}) {
    const auto of = [&](const char* records) {
      return through(records, 260, {"--mode", mode, "--check=rays:50"});
    };
    const Ran one = cde(of("one.csv"));
    ASSERT_EQ(one.status, 0) << one.err;
    ASSERT_TRUE(counted(one).starts_with("through \"bvh\"\nbrute_force_rays 50\n")) << one.out;
    const Ran two = shell(run(2) + words(of("two.csv")));
    ASSERT_EQ(two.status, 0) << two.err;
    EXPECT_TRUE(same("two.csv", "one.csv")) << mode;
    EXPECT_EQ(counted(two), counted(one)) << mode;
  }
}

TEST_F(MpiRanks, Errors_ArePrintedOnce) {
  const auto count = [](const std::string& text, const std::string& what) {
    int n = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
    return n;
  };
  for (const char* all_well : {" --version", " cast --help", " help cast"}) {
    const Ran ran = shell(run(2) + all_well);
    EXPECT_EQ(ran.status, 0) << all_well << ran.err;
    EXPECT_EQ(ran.out, shell(std::string("\"$CDE\"") + all_well).out);
  }
  const Ran from = shell(run(2) + " accuracy --filters --pair sphere-sphere --cases 10");
  EXPECT_EQ(from.status, 2) << from.err;
  EXPECT_EQ(count(from.err, "--filters works only in one process, but 2 ranks were started"), 1)
      << from.err;
  const Ran missing = shell(run(3) + " cast nowhere.obj");
  EXPECT_EQ(missing.status, 2) << missing.err;
  EXPECT_EQ(count(missing.err, "cde: "), 1) << missing.err;
  const Ran unknown = shell(run(3) + " cast square.obj --mode nereast");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(count(unknown.err, "--mode is 'nereast'"), 1) << unknown.err;
  const Ran verb = shell(run(2) + " plan x.toml");
  EXPECT_EQ(verb.status, 2);
  EXPECT_EQ(count(verb.err, "2 ranks were started, and each would do the same"), 1) << verb.err;
  const Ran shard = shell(run(2) + words(cast("x.csv", {"--shard", "1/2", "--resume", "j"})));
  EXPECT_EQ(shard.status, 2);
  EXPECT_TRUE(has(shard.err, "--shard cannot be combined with the ranks"));
  // Ranks that disagree: the second one starts with another option.
  const Ran differ = shell(run(1) + words(cast("x.csv")) + " : -n 1 \"$CDE\"" +
                           words(cast("x.csv", {"--no-check"})));
  EXPECT_EQ(differ.status, 2) << differ.err;
  EXPECT_TRUE(has(differ.err, "rank 1 on "));
  EXPECT_TRUE(has(differ.err, " '--no-check', rank 0 on "));
  const Ran waves = shell("export CDE_WAVES=.; " + run(2) + words(cast("x.csv")));
  EXPECT_EQ(waves.status, 2);
  EXPECT_EQ(count(waves.err, "CDE_WAVES needs a single process"), 1) << waves.err;
  EXPECT_FALSE(exists("x.csv"));
}

/// A rank or mpirun is killed at any time: no rank survives, and the next run continues.
TEST_F(MpiRanks, KilledRun_Continues) {
  const unsigned kills = std::getenv("CDE_FULL") != nullptr ? 100 : 6;
  const std::string cast = " cast square.obj --grid 1300x1300 -q -o ";
  ASSERT_EQ(shell("\"$CDE\"" + cast + "whole.csv").status, 0);
  const std::string command = run(2) + cast + "$PWD/r.csv --resume journal";
  std::mt19937 random(11);
  unsigned killed = 0;
  for (unsigned i = 0; i < 20 * kills && killed < kills; ++i) {
    const unsigned after = std::uniform_int_distribution<unsigned>(300, 2500)(random);
    const std::string victim =
        i % 3 == 2 ? "$run" : fmt::format("$(pgrep -P $run | sed -n {}p)", i % 3 + 1);
    const Ran ran = shell(fmt::format(
        "{} >/dev/null 2>&1 & run=$!; sleep {}.{:03}; kill -9 {} 2>/dev/null; wait $run; "
        "status=$?; "
        "for i in {{1..50}}; do pgrep -f $PWD/r.csv >/dev/null || break; sleep 0.1; done; "
        "exit $status",
        command, after / 1000, after % 1000, victim));
    if (ran.status != 0) ++killed;
    // The command had finished, but mpirun had not.
    if (ran.status == 0 || exists("r.csv")) {
      EXPECT_TRUE(same("r.csv", "whole.csv"));
      std::filesystem::remove(folder_ / "r.csv");
      std::filesystem::remove(folder_ / "journal");
    }
  }
  EXPECT_EQ(killed, kills);
  EXPECT_EQ(shell(command).status, 0);
  EXPECT_TRUE(same("r.csv", "whole.csv"));
  EXPECT_EQ(files(), (Words{"journal", "plain.csv", "r.csv", "square.obj", "whole.csv"}))
      << "files of killed runs are removed";
}

}  // namespace
}  // namespace cde::testing
