// SPDX-License-Identifier: Apache-2.0
// Journals of runs: an unfinished entry is cut, a damaged entry is named.
#include "cde/jobs/journal.hpp"

#include <fmt/format.h>

#include "cde/support/json_text.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

class Journals : public ::testing::Test {
 protected:
  Journals() {
    Journal journal("--resume", path(), Journal::Use::kGoOn, {{"command", "query"}});
    for (std::uint64_t i = 0; i < kChunks; ++i) {
      starts_.push_back(bytes().size());
      journal.add({0, i}, "input", fmt::format("{{\"part\":{}, no line of a journal\n", i));
    }
    whole_ = bytes();
  }
  [[nodiscard]] std::string path() const { return (folder_ / "journal").string(); }
  [[nodiscard]] std::string bytes() const { return bytes_of(folder_ / "journal"); }
  [[nodiscard]] std::size_t chunks_of(const std::string& bytes) const {
    folder_.write("journal", bytes);
    return Journal("--resume", path(), Journal::Use::kGoOn, {{"command", "query"}}).size();
  }
  /// The journal with another byte count in the line of a chunk.
  [[nodiscard]] std::string claiming(std::size_t chunk, const std::string& number) const {
    std::string damaged = whole_;
    const std::string key = "\"bytes\":";
    const std::size_t at = damaged.find(key, starts_[chunk]) + key.size();
    return damaged.replace(at, damaged.find(',', at) - at, number);
  }

  static constexpr std::size_t kChunks = 4;
  const Folder folder_;
  std::vector<std::size_t> starts_;
  std::string whole_;
};

TEST_F(Journals, UnfinishedLastEntry_IsCut) {
  for (std::size_t size = starts_.back() + 1; size < whole_.size(); ++size) {
    EXPECT_EQ(chunks_of(whole_.substr(0, size)), kChunks - 1) << size;
    EXPECT_EQ(bytes(), whole_.substr(0, starts_.back())) << size;
  }
  EXPECT_EQ(chunks_of(whole_), kChunks);
}

/// The search for an entry behind a damaged count reads the file in windows.
TEST_F(Journals, EntryFarBehindADamagedCount_IsNamed) {
  constexpr std::size_t kBetween = 40 << 20;  // more than two windows
  std::string damaged = claiming(0, "1000000000");
  const std::size_t second = starts_[1] + damaged.size() - whole_.size();
  damaged.insert(second, std::string(kBetween, '\0') + '\n');
  folder_.write("journal", damaged);
  expect_error(ErrorCode::kFile,
               fmt::format("another entry begins at byte {}", second + kBetween + 1),
               [&] { (void)chunks_of(damaged); });
}

TEST_F(Journals, DamagedCount_IsAnErrorAndKeepsTheJournal) {
  for (std::size_t chunk = 0; chunk + 1 < kChunks; ++chunk) {
    for (const char* number : {"1000000", "4294967295", "1099511627775"}) {
      const std::string damaged = claiming(chunk, number);
      folder_.write("journal", damaged);
      expect_error(
          ErrorCode::kFile,
          fmt::format("byte {}: the chunk claims {} bytes, but another entry begins at byte ",
                      starts_[chunk], number),
          [&] { (void)chunks_of(damaged); });
      EXPECT_EQ(bytes(), damaged) << "the journal must not be truncated";
    }
  }
}

/// A byte count that is too large cannot be told from a truncation, so the user is told.
TEST_F(Journals, DroppedEntry_IsReportedWithItsPlace) {
  const std::size_t last = starts_.back();
  for (const std::string& damaged :
       {claiming(kChunks - 1, "1000000"), whole_.substr(0, whole_.size() - 3),
        whole_.substr(0, last + 5)}) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(chunks_of(damaged), kChunks - 1);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(),
              fmt::format("cde: warning: journal {}: the last entry, from byte {} on, is "
                          "unfinished ({} bytes) and is computed again\n",
                          path(), last, damaged.size() - last));
    folder_.write("journal", damaged);
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(Journal("cde merge", path(), Journal::Use::kRead).size(), kChunks - 1);
    EXPECT_NE(::testing::internal::GetCapturedStderr().find("and is ignored\n"), std::string::npos);
  }
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(chunks_of(whole_), kChunks);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(Journals, ChunkNumberBeyondItsPart_IsAnError) {
  const std::string end = "{\"part\":0,\"chunks\":4,\"inputs\":\"all\"}\n";
  const auto numbered = [&](const std::string& number) {
    std::string damaged = whole_;
    const std::string key = "\"chunk\":3";
    return damaged.replace(damaged.find(key), key.size(), "\"chunk\":" + number);
  };
  EXPECT_EQ(chunks_of(whole_ + end), kChunks);
  const std::string why = "the journal has a chunk 7, but its part 0 has 4 chunks, from 0 on";
  expect_error(ErrorCode::kFile, why, [&] { (void)chunks_of(numbered("7") + end); });
  // The end of a part may come before chunks that other ranks still compute.
  std::string before = numbered("7");
  before.insert(starts_.back(), end);
  expect_error(ErrorCode::kFile, fmt::format("byte {}: {}", starts_.back() + end.size(), why),
               [&] { (void)chunks_of(before); });
  folder_.write("journal", numbered("7"));
  Journal journal("--resume", path(), Journal::Use::kGoOn, {{"command", "query"}});
  expect_error(ErrorCode::kUsage, "it has a chunk 7, this run has 4 chunks, from 0 on", [&] {
    journal.end_part(0, {4, "all"});
  });
}

TEST_F(Journals, PartNumberBeyond32Bits_IsAnError) {
  std::string damaged = whole_;
  damaged.replace(damaged.find("\"part\":0", starts_.back()), 8, "\"part\":4294967296");
  expect_error(ErrorCode::kFile, fmt::format("byte {}: not a chunk of a journal", starts_.back()),
               [&] { (void)chunks_of(damaged); });
}

TEST_F(Journals, DeepJson_IsAnErrorWithItsByte) {
  const std::string deep = std::string(400'000, '[') + std::string(400'000, ']') + "\n";
  expect_error(ErrorCode::kFile, "byte 0: not a journal of a run", [&] { (void)chunks_of(deep); });
  for (const std::string& line : {deep, "{\"part\":0,\"chunk\":" + deep})
    expect_error(ErrorCode::kFile, fmt::format("byte {}: not a chunk of a journal", whole_.size()),
                 [&] { (void)chunks_of(whole_ + line); });
}

TEST_F(Journals, LostFile_IsReportedOnce) {
  namespace fs = std::filesystem;
  for (const bool replaced : {false, true}) {
    fs::remove(path());
    Journal journal("--resume", path(), Journal::Use::kGoOn, {{"command", "query"}});
    fs::rename(path(), folder_ / "elsewhere");
    if (replaced) fs::create_symlink("/dev/null", path());
    ::testing::internal::CaptureStderr();
    journal.add({0, 0}, "input", "bytes");
    journal.add({0, 1}, "input", "bytes");
    EXPECT_TRUE(journal.lost());
    EXPECT_EQ(::testing::internal::GetCapturedStderr(),
              fmt::format("cde: warning: journal {}: the file was removed or replaced in the "
                          "meantime; this run cannot be resumed\n",
                          path()));
  }
}

TEST(JsonText, DeepJson_IsDiscarded) {
  const auto nested = [](std::size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
  };
  EXPECT_FALSE(parse_json(nested(kDeepestJson)).is_discarded());
  for (const std::size_t levels : {std::size_t{kDeepestJson} + 1, std::size_t{400'000}})
    EXPECT_TRUE(parse_json(nested(levels)).is_discarded()) << levels;
  const std::string text = R"("\\\"[)" + std::string(1000, '[') + '"';
  EXPECT_TRUE(parse_json(text).is_string());
  EXPECT_TRUE(parse_json("{").is_discarded());
}

}  // namespace
}  // namespace cde::testing
