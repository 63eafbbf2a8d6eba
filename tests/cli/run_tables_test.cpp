// SPDX-License-Identifier: Apache-2.0
// Records of cde run: a table per query, or files per frame.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <iterator>
#include <sstream>
#include <utility>

#include "../has.hpp"
#include "run_scene.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Concatenates files per frame, with the frame number before each line.
std::string joined(const Words& files) {
  std::string all = "frame,";
  for (std::size_t frame = 0; frame < files.size(); ++frame) {
    std::istringstream lines(files[frame]);
    std::string line;
    std::getline(lines, line);
    if (frame == 0) all += line + "\n";
    while (std::getline(lines, line)) all += fmt::format("{},{}\n", frame, line);
  }
  return all;
}

/// Two queries: one has hits in every frame, the other none.
TEST_F(RunScene, Tables_HaveTheRecordsOfFilesPerFrame) {
  write("two.toml", flight("lanes = 16", R"([[object]]
name = "up"
random_rays = { count = 5, axis = [0, 0, 1], half_angle = 10 }
motion = { kind = "still", position = [20, 20, 5000] }
[[query]]
name = "sky"
pair = "ray-triangle"
primaries = "up"
secondaries = "terrain"
[report]
only_hits = true
)"));
  ASSERT_EQ(cde({"run", "two.toml", "-q", "--file-per-frame", "-o", "files"}).status, 0);
  ASSERT_EQ(cde({"run", "two.toml", "-q", "-o", "tables"}).status, 0);
  ASSERT_EQ(cde({"run", "two.toml", "-q", "-o", "one", "--frames", "0"}).status, 0);
  ASSERT_EQ(cde({"run", "two.toml", "-q", "-o", "distributed", "--resume", "journal"}).status, 0);
  for (const std::string query : {"hit", "sky"}) {
    Words files;
    for (int frame = 0; frame < 4; ++frame)
      files.push_back(read(fmt::format("files/{}.{:06}.csv", query, frame)));
    EXPECT_EQ(read("tables/" + query + ".csv"), joined(files));
    EXPECT_EQ(read("distributed/" + query + ".csv"), joined(files));
    EXPECT_EQ(read("one/" + query + ".csv"), joined({files[0]}));
  }
  EXPECT_TRUE(has(read("tables/hit.csv"), "\n3,"));
  EXPECT_EQ(read("tables/sky.csv"), "frame,primary,F,bad,T,CPx,CPy,CPz,index\n");
  EXPECT_EQ(run_json("files")["files"], nlohmann::json::array());
  EXPECT_EQ(run_json("files")["frame_results"][2]["files"],
            nlohmann::json::array({"hit.000002.csv", "sky.000002.csv"}));
  const Ran other = cde({"run", "two.toml", "-q", "--resume", "journal", "--file-per-frame"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "with file_per_frame false; this run has true")) << other.err;
}

/// The same records as words and as an array. One table has hits only, so its length is unknown at
/// first.
TEST_F(RunScene, TablesAsWordsAndArrays_HaveTheRecordsOfCsv) {
  const auto scene = [](const std::string& results) {
    return flight("lanes = 16", "[report]\nonly_hits = true\nresults = \"" + results + "\"\n");
  };
  for (const std::string results : {"csv", "binary", "npy"}) {
    write(results + ".toml", scene(results));
    ASSERT_EQ(cde({"run", results + ".toml", "-q"}).status, 0);
  }
  ASSERT_EQ(cde({"run", "npy.toml", "-q", "-o", "distributed", "--resume", "journal"}).status, 0);
  ASSERT_EQ(cde({"run", "npy.toml", "-q", "-o", "files", "--file-per-frame"}).status, 0);
  const std::string words = read("binary.run/hit.bin"), npy = read("npy.run/hit.npy");
  EXPECT_EQ(read("distributed/hit.npy"), npy);
  std::istringstream csv(read("csv.run/hit.csv"));
  const auto word = [](const std::string& bytes, std::size_t at) {
    std::uint32_t w = 0;
    for (std::size_t i = 4; i-- > 0;) w = w << 8 | static_cast<unsigned char>(bytes.at(at + i));
    return w;
  };
  constexpr std::size_t kWords = 8 * 4, kElement = 7 * 4 + 2;
  std::string line;
  std::getline(csv, line);
  std::size_t records = 0;
  for (; std::getline(csv, line); ++records) {
    const std::size_t at = kWords * records;
    EXPECT_EQ(line.rfind(fmt::format("{},{},1,0,", word(words, at), word(words, at + 28)), 0), 0u);
    EXPECT_TRUE(line.ends_with(fmt::format(",{}", word(words, at + 20)))) << line;
  }
  EXPECT_EQ(words.size(), kWords * records);
  const std::size_t data = npy.size() - kElement * records;
  EXPECT_EQ(data % 64, 0u);
  EXPECT_TRUE(has(npy.substr(0, data), fmt::format("[('frame', '<u4'), ('primary', '<u4'), ('F', "
                                                   "'|b1'), ('bad', '|b1'), ('T', '<f4'), ('CP', "
                                                   "'<f4', (3,)), ('index', '<u4')], "
                                                   "'fortran_order': False, 'shape': ({},), }}",
                                                   records)));
  std::string files;
  for (std::size_t i = 0; i < records; ++i) {
    const std::size_t at = data + kElement * i;
    for (const auto& [element, of_words] : {std::pair{0, 0}, {4, 28}, {10, 24}, {14, 4}, {26, 20}})
      EXPECT_EQ(word(npy, at + element), word(words, kWords * i + of_words)) << i;
    files += npy.substr(at + 4, kElement - 4);
  }
  for (int frame = 0; frame < 4; ++frame) {
    const std::string file = read(fmt::format("files/hit.{:06}.npy", frame));
    const std::size_t head =
        10 + static_cast<unsigned char>(file.at(8)) + 256 * static_cast<unsigned char>(file.at(9));
    EXPECT_EQ(files.substr(0, file.size() - head), file.substr(head)) << frame;
    files.erase(0, file.size() - head);
  }
  EXPECT_EQ(files, "");
}

/// A ball flies through a mesh, which is a surface: records alone do not tell where it is inside.
TEST_F(RunScene, Inside_IsAColumnInEveryForm) {
  write("tetrahedron.obj",
        "v 0 0 0\nv 6 0 0\nv 0 6 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto scene = [](const std::string& results) {
    return "frames = 3\nrate = 1\n[report]\nresults = \"" + results + R"("
[[object]]
name = "balls"
sphere = [{ center = [-3, 1, 1], radius = 0.125 }, { center = [9, 1, 1], radius = 0.125 }]
motion = { kind = "velocity", linear = [4, 0, 0] }
[[object]]
name = "mesh"
mesh = "tetrahedron.obj"
[[query]]
name = "q"
pair = "sphere-triangle"
primaries = "balls"
secondaries = "mesh"
inside = true
)";
  };
  for (const std::string results : {"csv", "binary", "npy"}) {
    write(results + ".toml", scene(results));
    ASSERT_EQ(cde({"run", results + ".toml", "-q"}).status, 0);
  }
  std::istringstream csv(read("csv.run/q.csv"));
  std::string line, inside;
  std::getline(csv, line);
  EXPECT_EQ(line, "frame,primary,F,bad,T,CPx,CPy,CPz,index,inside");
  while (std::getline(csv, line)) inside += line.back();
  EXPECT_EQ(inside, "001000");
  const std::string words = read("binary.run/q.bin"), npy = read("npy.run/q.npy");
  ASSERT_EQ(words.size(), 6u * 9 * 4);
  EXPECT_TRUE(has(npy, "('index', '<u4'), ('inside', '|b1')]"));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(words[(9 * i + 8) * 4], inside[i] - '0');
    EXPECT_EQ(npy[npy.size() - 31 * (6 - i) + 30], inside[i] - '0');
  }
  ASSERT_EQ(cde({"run", "csv.toml", "-q", "-o", "distributed", "--resume", "journal"}).status, 0);
  EXPECT_EQ(read("distributed/q.csv"), read("csv.run/q.csv"));
}

TEST_F(RunScene, NoResults_WritesRunJsonAlone) {
  write("flight.toml", kFlight + "[report]\nresults = \"none\"\n");
  for (const Words& more : {Words{}, Words{"--file-per-frame"}}) {
    Words words = {"run", "flight.toml", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(cde(words).status, 0);
    EXPECT_EQ(run_json("flight.run")["finished"], true);
    EXPECT_EQ(run_json("flight.run")["files"], nlohmann::json::array());
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "flight.run"), {}), 1);
  }
}

/// An early end of a run leaves no tables.
TEST_F(RunScene, StoppedEarly_LeavesNoTable) {
  write("ecc.toml", flight("lanes = 4\necc = true"));
  EXPECT_EQ(cde({"run", "ecc.toml", "--fault", "ddr:1:2@2", "-q"}).status, 4);
  EXPECT_EQ(run_json("ecc.run")["finished"], false);
  EXPECT_EQ(run_json("ecc.run")["frame_results"].size(), 2u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "ecc.run"), {}), 1);
  // A table that does not fit.
  write("flight.toml", kFlight);
  ASSERT_EQ(cde({"run", "flight.toml", "-q"}).status, 0);
  const std::uint64_t whole = fs::file_size(folder_ / "flight.run/hit.csv");
  ASSERT_GT(whole - 1, fs::file_size(folder_ / "flight.run/run.json"));
  const FileLimit limit(whole - 1);
  const Ran ran = cde({"run", "flight.toml", "-q"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_TRUE(has(ran.err, "hit.csv: cannot write: File too large")) << ran.err;
  EXPECT_EQ(run_json("flight.run")["finished"], false);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "flight.run"), {}), 1);
}

TEST_F(RunScene, Interrupt_LeavesRunJsonAndNoTable) {
  write("long.toml", std::string(kFlight).replace(0, 10, "frames = 100000"));
  const pid_t child = start({"run", "long.toml"});
  for (int i = 0; i < 600 && !exists("long.run/run.json"); ++i) ::usleep(50'000);
  ::usleep(300'000);
  ::kill(child, SIGINT);
  EXPECT_EQ(finish(child).status, 128 + SIGINT);
  EXPECT_EQ(run_json("long.run")["finished"], false);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "long.run"), {}), 1);
}

}  // namespace
}  // namespace cde::testing
