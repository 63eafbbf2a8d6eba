// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/support/text_map.hpp"

namespace cde::wave {

/// The changes of a signal in a window, packed. First come all times, as differences with seven
/// bits per byte, lowest first. Then come all values, each with the same number of bytes.
///
/// A bit value is one plane, or two planes if any bit is x or z. Each plane has whole bytes, most
/// significant first. Bit pairs: 00 is 0, 10 is 1, 01 is z, 11 is x. A text value is its number
/// among the texts, four bytes, lowest first.
class Packed {
 public:
  Packed(unsigned width, bool text) : width_(width), text_(text) {}

  /// `time` counts from the begin of the window. A value equal to the one before is not a change.
  void add(std::uint64_t time, std::string_view value);
  /// Adds a time alone, for the edges of a clock.
  void add_time(std::uint64_t time);

  [[nodiscard]] std::size_t bytes() const { return times_.size() + values_.size(); }
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  [[nodiscard]] unsigned planes() const { return planes_; }
  [[nodiscard]] const std::string& times() const { return times_; }
  [[nodiscard]] const std::string& values() const { return values_; }
  [[nodiscard]] const std::vector<std::string>& texts() const { return texts_; }

 private:
  void add_bits(std::string_view bits);
  void add_text(std::string_view text);
  void second_plane();

  unsigned width_;
  bool text_;
  unsigned planes_ = 1;
  std::uint64_t changes_ = 0, last_time_ = 0;
  std::string last_, before_;  ///< before_: the value at the end of the previous instant
  std::uint64_t before_time_ = 0;
  std::size_t last_length_ = 0;  ///< of the times, without the last one
  std::string times_, values_;
  std::vector<std::string> texts_;
  TextMap<std::uint32_t> numbers_;
};

/// Compressed by zlib, with its frame.
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace cde::wave
