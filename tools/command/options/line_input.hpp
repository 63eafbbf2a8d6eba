// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/support/error.hpp"

namespace cde::cli {

/// Lines of a descriptor, as many as a read returns. A process that writes a line and waits
/// therefore gets its answer. Lines end in LF, CRLF or CR.
class LineInput {
 public:
  /// `name` is the name of the input in messages.
  explicit LineInput(int descriptor = STDIN_FILENO, std::string name = "stdin")
      : descriptor_(descriptor), name_(std::move(name)) {}

  /// Whether a read would wait for the writer.
  [[nodiscard]] static bool waits(int descriptor = STDIN_FILENO) {
    pollfd in{descriptor, POLLIN, 0};
    return ::poll(&in, 1, 0) == 0;
  }

  /// The first bytes, at most `bytes`, or fewer if a line or the input ends first. They are not
  /// consumed.
  [[nodiscard]] std::string_view peek(std::size_t bytes) {
    while (!ended_ && held_ < bytes && held().find('\n') == std::string_view::npos) fill();
    peeked_ = true;
    return held().substr(0, bytes);
  }

  /// All remaining bytes.
  [[nodiscard]] std::string rest() {
    std::string all;
    for (;;) {
      all += held();
      held_ = 0;
      if (ended_) return all;
      fill();
    }
  }

  /// Calls line(number, text) for every whole line of the next read. Returns false at the end.
  /// Error kBadInput if a line does not fit the buffer.
  template <class Line>
  bool next(Line line) {
    if (!std::exchange(peeked_, false)) {
      if (held_ == buffer_.size())
        throw Error(ErrorCode::kBadInput,
                    fmt::format("line {}: longer than {} bytes", number_ + 1, buffer_.size()));
      fill();
    }
    std::string_view text = held();
    while (!text.empty()) {
      if (std::exchange(after_cr_, false) && text.front() == '\n') {
        text.remove_prefix(1);
        continue;
      }
      const auto* const stop =
          std::find_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; });
      if (stop == text.end() && !ended_) break;  // the rest of the line is not read yet
      const auto size = static_cast<std::size_t>(stop - text.begin());
      after_cr_ = stop != text.end() && *stop == '\r';
      line(++number_, text.substr(0, size));
      text.remove_prefix(std::min(size + 1, text.size()));
    }
    const std::size_t left = text.size();
    std::memmove(buffer_.data(), text.data(), left);
    held_ = left;
    return !ended_;
  }

  [[nodiscard]] std::uint64_t bytes() const { return read_; }  ///< bytes read so far

 private:
  [[nodiscard]] std::string_view held() const { return {buffer_.data(), held_}; }

  void fill() {
    const ssize_t got = ::read(descriptor_, buffer_.data() + held_, buffer_.size() - held_);
    if (got < 0) {
      if (errno == EINTR) return;
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: cannot read: {}", name_, std::strerror(errno)));
    }
    ended_ = got == 0;
    held_ += static_cast<std::size_t>(got);
    read_ += static_cast<std::uint64_t>(got);
  }

  int descriptor_;
  std::string name_;
  std::vector<char> buffer_ = std::vector<char>(std::size_t{4} << 20);
  std::size_t held_ = 0;
  std::uint64_t number_ = 0, read_ = 0;
  bool ended_ = false, peeked_ = false, after_cr_ = false;
};

}  // namespace cde::cli
