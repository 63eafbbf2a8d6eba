// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

struct stat;

namespace cde {

/// Fingerprint of contents (FNV-1a, 64 bits), in hexadecimal.
[[nodiscard]] std::string fingerprint(std::string_view bytes);

/// A piece of a run. A run has consecutive parts, and a part has chunks.
struct ChunkNumber {
  unsigned part = 0;
  std::uint64_t chunk = 0;
  auto operator<=>(const ChunkNumber&) const = default;
};

/// Position of a chunk in its file.
struct ChunkPlace {
  std::uint64_t at = 0, bytes = 0;
  std::string fingerprint, input;
};

/// Finished chunks of a run, in an append-only file. Its first line is JSON that identifies the
/// run, and ends with the fingerprint of what is before. Each chunk is a line followed by its
/// bytes; its fingerprint covers the run and both. Only this user can open a new file. An
/// incomplete last entry of a killed process is dropped with a warning; everything before it stays.
/// The file is locked while the object lives. A warning says if the file was removed or replaced
/// meanwhile.
class Journal {
 public:
  enum class Use {
    kGoOn,  ///< created if missing; an existing file must belong to the same run
    kRead,
  };

  /// `what` names the option or verb in messages. `run` is compared key by key with the file;
  /// `beside` is only written to a new one (kGoOn). Error kUsage if the file belongs to another
  /// run, naming the difference, or is in use. Error kFile if it is not a journal of this version,
  /// is damaged, cannot be written, belongs to another user (not root), or all users can write it.
  Journal(std::string what, std::string path, Use use,
          const nlohmann::ordered_json& run = nlohmann::ordered_json::object(),
          const nlohmann::ordered_json& beside = nlohmann::ordered_json::object());
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Whether the file was removed or replaced, which a warning then says.
  [[nodiscard]] bool lost();
  /// Identification of the run.
  [[nodiscard]] const nlohmann::ordered_json& run() const { return run_; }
  /// Error kUsage, naming the first key of `run` whose value differs here.
  void check_run(const nlohmann::ordered_json& run) const;

  [[nodiscard]] std::size_t size() const { return chunks_.size(); }
  [[nodiscard]] bool has(ChunkNumber number) const { return chunks_.contains(number); }
  [[nodiscard]] const std::map<ChunkNumber, ChunkPlace>& chunks() const { return chunks_; }
  /// Error if a chunk's bytes are not a result of this run: Error, or an exception of Json.
  using Check = std::function<void(const std::string& bytes)>;
  /// The bytes of a stored chunk. Error kFile, which names the place, if they differ from those
  /// that were written, or if `check` refuses them.
  [[nodiscard]] std::string read(ChunkNumber number, const Check& check = {}) const;
  /// Error kUsage if the chunk was made from another input.
  void check_input(ChunkNumber number, const std::string& input) const;
  /// Stores a chunk and the fingerprint of its input.
  void add(ChunkNumber number, const std::string& input, std::string_view bytes);

  /// What is known about a part once its inputs have ended.
  struct PartEnd {
    std::uint64_t chunks = 0;
    std::string inputs;  ///< fingerprint of all of them
    bool operator==(const PartEnd&) const = default;
  };
  /// Error kUsage if the part ended differently before.
  void end_part(unsigned part, const PartEnd& end);
  [[nodiscard]] std::optional<PartEnd> end_of(unsigned part) const;

 private:
  [[noreturn]] void fail(const char* doing) const;
  [[noreturn]] void damaged(std::uint64_t at, std::string_view why) const;
  void warn_dropped(std::uint64_t whole, const char* result) const;
  void open(Use use);
  void check_owner(const struct stat& status, Use use);
  void read_first(const std::string& line, const nlohmann::ordered_json& entry);
  std::uint64_t scan();
  std::optional<std::string> line_at(std::uint64_t at) const;
  std::optional<std::uint64_t> entry_within(std::uint64_t from) const;
  std::optional<std::uint64_t> last_chunk(unsigned part) const;
  bool scan_entry(const nlohmann::ordered_json& entry, std::uint64_t at, std::uint64_t& next);
  void append(std::string_view bytes);
  void warn_if_lost();

  std::string what_, path_;
  int file_ = -1;
  std::uint64_t bytes_ = 0;  ///< size of the file
  bool lost_ = false;        ///< warn_if_lost() has warned
  nlohmann::ordered_json run_;
  std::string run_print_;  ///< fingerprint of the first line
  std::map<ChunkNumber, ChunkPlace> chunks_;
  std::map<unsigned, PartEnd> ends_;
};

}  // namespace cde
