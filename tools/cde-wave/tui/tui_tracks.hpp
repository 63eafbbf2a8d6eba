// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/wave/trace.hpp"

/// Waves read piece by piece: what a viewer shows, and no more.
namespace cde::wave::tui {

/// What a signal does in a block of a file: the value that it has where the block begins, which is
/// change 0, and its changes. A value that is the one before is none.
class Track {
 public:
  /// `text`: values are text of any length; else bits, of which each takes a quarter of a byte.
  Track(unsigned width, bool text) : width_(width), text_(text) {}

  void add(std::uint64_t time, std::string_view value);

  /// At least 1.
  [[nodiscard]] std::size_t changes() const { return times_.size(); }
  [[nodiscard]] std::uint64_t time(std::size_t change) const { return times_[change]; }
  [[nodiscard]] std::string value(std::size_t change) const;
  /// The last change at or before a time; 0 for a time before the block.
  [[nodiscard]] std::size_t at(std::uint64_t time) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  unsigned width_;
  bool text_;
  std::vector<std::uint64_t> times_;
  std::string values_;
  std::vector<std::size_t> ends_;  ///< of texts
  std::string last_, before_;      ///< before_: the value at the end of the instant before
};

/// Times from and to, both within.
struct Stretch {
  std::uint64_t begin, end;
};

/// The tracks of a file that were read last, as far as there is memory for them.
class Tracks {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{400} << 20;
  static constexpr std::size_t kMostBlocks = 64;

  explicit Tracks(Trace& trace, std::size_t most_bytes = kMostBytes);

  [[nodiscard]] Trace& trace() const { return trace_; }
  /// One behind the other from the begin to the end of the file. One may be several of the file.
  [[nodiscard]] const std::vector<Stretch>& blocks() const { return blocks_; }
  /// The block that a time is in; the nearest, if it is outside of the file.
  [[nodiscard]] std::size_t block_of(std::uint64_t time) const;

  using Shared = std::shared_ptr<const Track>;
  /// Null if it is not there.
  [[nodiscard]] Shared find(std::uint32_t handle, std::size_t block);
  /// Reads a block for these signals.
  void load(std::size_t block, const std::vector<std::uint32_t>& handles);
  /// Reads it if it is not there.
  [[nodiscard]] Shared get(std::uint32_t handle, std::size_t block);
  /// How many tracks were read, for tests.
  [[nodiscard]] std::size_t loads() const { return loads_; }

 private:
  using Key = std::pair<std::uint32_t, std::size_t>;
  struct Kept {
    Shared track;
    std::list<Key>::iterator place;
  };
  void keep(const Key& key, Shared track);

  Trace& trace_;
  std::size_t most_bytes_, bytes_ = 0, loads_ = 0;
  std::vector<Stretch> blocks_;
  std::vector<unsigned> widths_;  ///< of handles; 0: text
  std::vector<bool> events_;      ///< handles of events
  std::map<Key, Kept> kept_;
  std::list<Key> order_;  ///< the one that was used last first
};

}  // namespace cde::wave::tui
