// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "cde/support/error.hpp"

namespace cde::cli {

/// Lines of stdin, as many as a read gives: whoever writes one and waits gets the answer.
class LineInput {
 public:
  /// Whether a read of stdin would wait for whoever writes it.
  [[nodiscard]] static bool waits() {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    return ::poll(&in, 1, 0) == 0;
  }

  /// Calls line(number, text) for every whole line of the next read. False at the end. Error
  /// kBadInput if a line does not fit the buffer.
  template <class Line>
  bool next(Line line) {
    if (held_ == buffer_.size())
      throw Error(ErrorCode::kBadInput,
                  fmt::format("line {}: longer than {} bytes", number_ + 1, buffer_.size()));
    const ssize_t got = ::read(STDIN_FILENO, buffer_.data() + held_, buffer_.size() - held_);
    if (got < 0) {
      if (errno == EINTR) return true;
      throw Error(ErrorCode::kFile, fmt::format("stdin: cannot read: {}", std::strerror(errno)));
    }
    std::string_view text(buffer_.data(), held_ + static_cast<std::size_t>(got));
    while (!text.empty()) {
      const std::size_t stop = text.find('\n');
      if (stop == std::string_view::npos && got != 0) break;  // the rest is still to come
      line(++number_, text.substr(0, stop));
      text.remove_prefix(stop == std::string_view::npos ? text.size() : stop + 1);
    }
    held_ = text.size();
    std::memmove(buffer_.data(), text.data(), held_);
    read_ += static_cast<std::uint64_t>(got);
    return got != 0;
  }

  [[nodiscard]] std::uint64_t bytes() const { return read_; }  ///< so far

 private:
  std::vector<char> buffer_ = std::vector<char>(std::size_t{4} << 20);
  std::size_t held_ = 0;
  std::uint64_t number_ = 0, read_ = 0;
};

}  // namespace cde::cli
