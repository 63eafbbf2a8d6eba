// SPDX-License-Identifier: Apache-2.0
#include "wave/vcd_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "cde/support/error.hpp"

namespace cde::wave {
namespace {

/// Longest word; the value of a vector is one word.
constexpr std::size_t kMostWord = std::size_t{64} << 20;

bool is_blank(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

}  // namespace

WordReader::WordReader(const WaveBytes& file, std::size_t part)
    : file_(file), text_(std::min<std::uint64_t>(part, file.size() + 1)) {}

void WordReader::seek(std::uint64_t offset, std::uint64_t line) {
  line_ = line;
  ended_ = false;
  if (offset >= base_ && offset - base_ <= size_) {
    begin_ = at_ = static_cast<std::size_t>(offset - base_);
    return;
  }
  base_ = offset;
  size_ = at_ = begin_ = 0;
}

/// Reads more bytes, and drops those before the last word.
bool WordReader::refill() {
  if (ended_) return false;
  if (begin_ != 0) {
    std::memmove(text_.data(), text_.data() + begin_, size_ - begin_);
    base_ += begin_;
    size_ -= begin_;
    at_ -= begin_;
    begin_ = 0;
  }
  if (size_ == text_.size()) {
    if (size_ > kMostWord) fail(fmt::format("a word of more than {} MiB", kMostWord >> 20));
    text_.resize(2 * size_);
  }
  const std::size_t n = file_.read(base_ + size_, text_.data() + size_, text_.size() - size_);
  size_ += n;
  ended_ = n == 0;
  return n != 0;
}

bool WordReader::next(std::string_view& word) {
  while (true) {
    while (at_ < size_ && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
    begin_ = at_;
    if (at_ < size_) break;
    if (!refill()) return false;
  }
  do {
    while (at_ < size_ && !is_blank(text_[at_])) ++at_;
  } while (at_ == size_ && refill());
  word = {text_.data() + begin_, at_ - begin_};
  return true;
}

std::string_view WordReader::rest_of_line() {
  std::size_t behind = at_ - begin_;
  do {
    while (at_ < size_ && text_[at_] != '\n') ++at_;
  } while (at_ == size_ && refill());
  return {text_.data() + begin_ + behind, at_ - begin_ - behind};
}

void WordReader::fail(const std::string& what) const {
  throw Error(ErrorCode::kFile, fmt::format("{}:{}: {}", file_.name(), line_, what));
}

}  // namespace cde::wave
