// SPDX-License-Identifier: Apache-2.0
// Files of records: the frame column, and arrays of initially unknown length.
#include "cde/io/record_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <thread>

#include "cde/io/npy.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

using Kind = RecordFormat::Kind;

std::vector<Record> records(std::uint32_t count) {
  std::vector<Record> all(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    all[i].primary = i;
    all[i].index = 7 + i;
    all[i].f = i % 2 == 0;
    all[i].t = static_cast<float>(i) / 2;
    all[i].cp = {1, 2, 3};
  }
  return all;
}

std::string text_of(RecordFormat format) {
  const RecordText text(format);
  std::string all = text.head(4);
  text.append(records(2), all, 5);
  text.append(records(2), all, 6);
  return all;
}

TEST(RecordText, Frame_IsTheFirstColumn) {
  EXPECT_EQ(text_of({.frame = true, .scene = true}),
            "frame,primary,F,bad,T,CPx,CPy,CPz,index\n5,0,1,0,0,1,2,3,7\n5,1,0,0,0.5,1,2,3,8\n"
            "6,0,1,0,0,1,2,3,7\n6,1,0,0,0.5,1,2,3,8\n");
  EXPECT_EQ(text_of({.frame = true, .scene = true, .only_hits = true}),
            "frame,primary,F,bad,T,CPx,CPy,CPz,index\n5,0,1,0,0,1,2,3,7\n6,0,1,0,0,1,2,3,7\n");
  EXPECT_EQ(text_of({.kind = Kind::kJsonLines, .frame = true, .only_hits = true}),
            R"({"frame":5,"ray":0,"F":1,"T":0,"CP":[1,2,3],"index":7})"
            "\n"
            R"({"frame":6,"ray":0,"F":1,"T":0,"CP":[1,2,3],"index":7})"
            "\n");
  const std::string words = text_of({.kind = Kind::kWords, .frame = true});
  ASSERT_EQ(words.size(), 4u * 8 * 4);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(words.substr(32 * i, 4), std::string({i < 2 ? '\5' : '\6', '\0', '\0', '\0'}));
  const std::string array = text_of({.kind = Kind::kNpy, .frame = true, .scene = true});
  EXPECT_NE(array.find("[('frame', '<u4'), ('primary', '<u4'), "), std::string::npos);
  EXPECT_EQ(array.size() % 64, 4u * 30 % 64);
}

TEST(RecordText, WithoutFrame_HasNoSuchColumn) {
  EXPECT_EQ(RecordText({.scene = true}).head(), "primary,F,bad,T,CPx,CPy,CPz,index\n");
}

/// A mesh names its nodes, and the lines may be printed to a terminal.
TEST(RecordText, ControlCharactersOfANode_AreEscaped) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  mesh.parts = {{"\x1b[2J\xc2\x9b\xe2\x80\xae\"", 0}};
  const std::vector<Ray> rays(1);
  Record hit;
  hit.primary = 0;
  hit.index = 0;
  hit.f = true;
  std::string line;
  RecordText({.kind = Kind::kJsonLines, .fields = {RecordField::kNode}}, &mesh, rays)
      .append(std::vector<Record>{hit}, line);
  EXPECT_NE(line.find(R"("node":"\u001b[2J\u009b\u202e\"")"), std::string::npos) << line;
}

TEST(Npy, HeaderOfAGrowingArray_HasOneLength) {
  const std::size_t length = npy_header("<f4", {0}, true).size();
  for (const std::uint64_t count : {1ull, 9ull, 10ull, 123456789ull, ~0ull}) {
    const std::string header = npy_header("<f4", {count}, true);
    EXPECT_EQ(header.size(), length);
    EXPECT_NE(header.find(fmt::format("'shape': ({},), ", count)), std::string::npos);
    EXPECT_EQ(header.back(), '\n');
  }
}

/// A regular file, a FIFO and a known count give the same data.
TEST(RecordFile, ArrayOfUnknownLength_HasItsCount) {
  const Folder folder;
  const RecordFormat format{.kind = Kind::kNpy, .frame = true, .only_hits = true};
  const auto write = [&](const std::string& name, std::optional<std::uint64_t> count,
                         std::uint32_t frames) {
    RecordFile file(folder / name, RecordText(format), count);
    for (std::uint32_t frame = 0; frame < frames; ++frame) file.add(records(3), frame);
    file.commit();
  };
  write("file.npy", {}, 50);
  write("told.npy", 100, 50);
  ASSERT_EQ(::mkfifo((folder / "fifo.npy").c_str(), 0600), 0);
  std::string piped;
  std::thread reader([&] { piped = bytes_of(folder / "fifo.npy"); });
  write("fifo.npy", {}, 50);
  reader.join();
  const std::string file = bytes_of(folder / "file.npy"), told = bytes_of(folder / "told.npy");
  EXPECT_EQ(file, piped);
  constexpr std::size_t kData = 100u * 29;
  ASSERT_GT(file.size(), kData);
  EXPECT_EQ(file.substr(file.size() - kData), told.substr(told.size() - kData));
  for (const std::string& all : {file, told})
    EXPECT_NE(all.substr(0, all.size() - kData).find("'shape': (100,), "), std::string::npos);
  write("none.npy", {}, 0);
  EXPECT_NE(bytes_of(folder / "none.npy").find("'shape': (0,), "), std::string::npos);
  expect_error(ErrorCode::kDevice, "100 records came; expected 99",
               [&] { write("bad.npy", 99, 50); });
  EXPECT_FALSE(std::filesystem::exists(folder / "bad.npy"));
}

TEST(RecordFile, NoRecords_LeavesTheHead) {
  const Folder folder;
  RecordFile file(folder / "a.csv", RecordText({.frame = true, .scene = true}));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
  file.commit();
  EXPECT_EQ(bytes_of(folder / "a.csv"), "frame,primary,F,bad,T,CPx,CPy,CPz,index\n");
}

}  // namespace
}  // namespace cde::testing
