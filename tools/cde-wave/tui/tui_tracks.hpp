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

/// Waves read piece by piece, as far as a viewer shows them.
namespace cde::wave::tui {

/// The activity of a signal in a block of a file. Change 0 is the value at the begin of the block;
/// the changes follow. A value equal to the previous one is no change.
class Track {
 public:
  /// `text`: values are text of any length. Otherwise they are bits, a quarter of a byte each.
  Track(unsigned width, bool text) : width_(width), text_(text) {}

  void add(std::uint64_t time, std::string_view value);

  /// The number of changes, at least 1.
  [[nodiscard]] std::size_t changes() const { return times_.size(); }
  [[nodiscard]] std::uint64_t time(std::size_t change) const { return times_[change]; }
  [[nodiscard]] std::string value(std::size_t change) const;
  /// The index of the last change at or before a time; 0 for a time before the block.
  [[nodiscard]] std::size_t at(std::uint64_t time) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  unsigned width_;
  bool text_;
  std::vector<std::uint64_t> times_;
  std::string values_;
  std::vector<std::size_t> ends_;  ///< ends of the texts
  std::string last_, before_;      ///< before_: the value at the end of the instant before
};

/// A stretch of time, both ends included.
struct Stretch {
  std::uint64_t begin, end;
};

/// A cache of the tracks of a file that were used last.
class Tracks {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{400} << 20;
  static constexpr std::size_t kMostBlocks = 64;

  explicit Tracks(Trace& trace, std::size_t most_bytes = kMostBytes);

  [[nodiscard]] Trace& trace() const { return trace_; }
  /// The blocks in order, from the begin to the end of the file. One may join several blocks of the
  /// file.
  [[nodiscard]] const std::vector<Stretch>& blocks() const { return blocks_; }
  /// The block of a time; the nearest block if the time is outside the file.
  [[nodiscard]] std::size_t block_of(std::uint64_t time) const;

  using Shared = std::shared_ptr<const Track>;
  /// A track, or null if it is not in the cache.
  [[nodiscard]] Shared find(std::uint32_t handle, std::size_t block);
  /// Reads the tracks of these signals in a block.
  void load(std::size_t block, const std::vector<std::uint32_t>& handles);
  /// A track, read if it is not in the cache.
  [[nodiscard]] Shared get(std::uint32_t handle, std::size_t block);
  /// The number of tracks read, for tests.
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
  std::vector<unsigned> widths_;  ///< by handle; 0: text
  std::vector<bool> events_;      ///< by handle: whether it is an event
  std::map<Key, Kept> kept_;
  std::list<Key> order_;  ///< the most recently used first
};

}  // namespace cde::wave::tui
