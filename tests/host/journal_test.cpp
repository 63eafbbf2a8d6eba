// SPDX-License-Identifier: Apache-2.0
// Journals of runs: an unfinished entry is cut, a damaged entry is named.
#include "cde/jobs/journal.hpp"

#include <fmt/format.h>

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

}  // namespace
}  // namespace cde::testing
