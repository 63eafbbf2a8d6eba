// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

struct stat;

namespace cde {

/// A number that tells contents apart (FNV-1a, 64 bits), in hexadecimal.
[[nodiscard]] std::string fingerprint(std::string_view bytes);

/// Which piece of a run: runs have parts one after the other, and a part has chunks.
struct ChunkNumber {
  unsigned part = 0;
  std::uint64_t chunk = 0;
  auto operator<=>(const ChunkNumber&) const = default;
};

/// Where a chunk is in its file.
struct ChunkPlace {
  std::uint64_t at = 0, bytes = 0;
  std::string fingerprint, input;
};

/// What is done of a run, in a file that only grows: a line of JSON that says what run it is, and
/// a line and its bytes for each chunk. What a process that was killed had not written to its end
/// is dropped, everything before it stays. Locked while the object lives.
class Journal {
 public:
  enum class Use {
    kGoOn,  ///< made if it is not there; what is there must be of the same run
    kRead,
  };

  /// `what` names the option or verb in messages; `run` is compared key by key with what the file
  /// says, `beside` is only written into a new one (kGoOn). Errors: kUsage if the file is of
  /// another run, naming what differs, or in use; kFile if it is no journal, damaged, or cannot be
  /// written.
  Journal(std::string what, std::string path, Use use,
          const nlohmann::ordered_json& run = nlohmann::ordered_json::object(),
          const nlohmann::ordered_json& beside = nlohmann::ordered_json::object());
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// What run it is of.
  [[nodiscard]] const nlohmann::ordered_json& run() const { return run_; }
  /// Error kUsage, naming the first key of `run` whose value is another one here.
  void check_run(const nlohmann::ordered_json& run) const;

  [[nodiscard]] std::size_t size() const { return chunks_.size(); }
  [[nodiscard]] bool has(ChunkNumber number) const { return chunks_.contains(number); }
  [[nodiscard]] const std::map<ChunkNumber, ChunkPlace>& chunks() const { return chunks_; }
  /// The bytes of a chunk that is there. Error kFile if they are not those that were written.
  [[nodiscard]] std::string read(ChunkNumber number) const;
  /// What the chunk was made of; kUsage if it is not this.
  void check_input(ChunkNumber number, const std::string& input) const;
  /// Keeps a chunk, made of an input with this fingerprint.
  void add(ChunkNumber number, const std::string& input, std::string_view bytes);

  /// What is known of a part once its inputs have ended.
  struct PartEnd {
    std::uint64_t chunks = 0;
    std::string inputs;  ///< a fingerprint of all of them
    bool operator==(const PartEnd&) const = default;
  };
  /// Error kUsage if it was another one before.
  void end_part(unsigned part, const PartEnd& end);
  [[nodiscard]] std::optional<PartEnd> end_of(unsigned part) const;

 private:
  [[noreturn]] void fail(const char* doing) const;
  [[noreturn]] void damaged(std::uint64_t at, std::string_view why) const;
  void open(Use use);
  void check_owner(const struct stat& status);
  std::uint64_t scan();
  std::optional<std::string> line_at(std::uint64_t at) const;
  std::optional<std::uint64_t> entry_within(std::uint64_t from) const;
  bool scan_entry(const nlohmann::ordered_json& entry, std::uint64_t at, std::uint64_t& next);
  void append(std::string_view bytes);

  std::string what_, path_;
  int file_ = -1;
  std::uint64_t bytes_ = 0;  ///< of the file
  nlohmann::ordered_json run_;
  std::map<ChunkNumber, ChunkPlace> chunks_;
  std::map<unsigned, PartEnd> ends_;
};

}  // namespace cde
