// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace cde::wave {

/// The changes of a signal in a window, packed: first all times, as differences to the one before
/// with seven bits a byte, the lowest first; then all values with the same number of bytes.
///
/// A value of bits is one plane, or two if a bit is x or z anywhere, each of whole bytes with the
/// most significant first: bits 00 are 0, 10 are 1, 01 are z and 11 are x. A value of text is its
/// number among the texts, four bytes, the lowest first.
class Packed {
 public:
  Packed(unsigned width, bool text) : width_(width), text_(text) {}

  /// `time` is counted from the begin of the window. A value that is the one before is no change.
  void add(std::uint64_t time, std::string_view value);
  /// A time alone, of a clock's edges.
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
  std::string last_, before_;  ///< before_: the value at the end of the instant before
  std::uint64_t before_time_ = 0;
  std::size_t last_length_ = 0;  ///< of the times, without the last
  std::string times_, values_;
  std::vector<std::string> texts_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

/// By zlib, with its frame.
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace cde::wave
