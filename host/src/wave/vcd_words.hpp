// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "wave/wave_bytes.hpp"

namespace cde::wave {

/// Reads words of a text with their places. Only a part of the file is in memory.
class WordReader {
 public:
  /// `part`: bytes to read at a time.
  explicit WordReader(const WaveBytes& file, std::size_t part = 1u << 20);

  /// Continues at a byte, which is in this line.
  void seek(std::uint64_t offset, std::uint64_t line);
  /// The next word, valid until the next call; false at the end.
  bool next(std::string_view& word);
  /// Makes next() return its last word again.
  void again() { at_ = begin_; }
  /// The rest of the line after the word, without the line end.
  [[nodiscard]] std::string_view rest_of_line();

  /// The first byte of the last word.
  [[nodiscard]] std::uint64_t offset() const { return base_ + begin_; }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  /// Whether the file ends with the last word, without a following blank or line feed.
  [[nodiscard]] bool cut() const { return ended_ && at_ == size_; }
  [[nodiscard]] std::uint64_t file_bytes() const { return file_.size(); }
  /// Error kFile "FILE:LINE: what", for the last word.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool refill();

  const WaveBytes& file_;
  std::vector<char> text_;
  std::uint64_t base_ = 0;  ///< place of text_ in the file
  std::size_t size_ = 0;    ///< filled bytes of text_
  std::size_t at_ = 0;      ///< behind the last word
  std::size_t begin_ = 0;   ///< begin of the last word
  std::uint64_t line_ = 1;
  bool ended_ = false;
};

}  // namespace cde::wave
