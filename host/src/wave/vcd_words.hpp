// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "wave/wave_bytes.hpp"

namespace cde::wave {

/// Words of a text, with their places. Of the file only a part is in memory.
class WordReader {
 public:
  /// `part` is how much is read at once.
  explicit WordReader(const WaveBytes& file, std::size_t part = 1u << 20);

  /// Goes on at a byte, which is in this line.
  void seek(std::uint64_t offset, std::uint64_t line);
  /// The next word, valid until the next call; false at the end.
  bool next(std::string_view& word);
  /// The word that next() gave last is given again.
  void again() { at_ = begin_; }
  /// What is between the word and the end of its line; the line's end is not taken.
  [[nodiscard]] std::string_view rest_of_line();

  /// Of the last word: its first byte and its line, from 1.
  [[nodiscard]] std::uint64_t offset() const { return base_ + begin_; }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  /// Whether the file ends with the last word, without a blank or line feed behind it.
  [[nodiscard]] bool cut() const { return ended_ && at_ == size_; }
  /// Error kFile "FILE:LINE: what", of the last word.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool refill();

  const WaveBytes& file_;
  std::vector<char> text_;
  std::uint64_t base_ = 0;  ///< of text_ in the file
  std::size_t size_ = 0;    ///< of text_ that is filled
  std::size_t at_ = 0;      ///< behind the last word
  std::size_t begin_ = 0;   ///< of the last word
  std::uint64_t line_ = 1;
  bool ended_ = false;
};

}  // namespace cde::wave
