// SPDX-License-Identifier: Apache-2.0
#include "cde/card/trace_file.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

TraceFile::TraceFile(std::string path, const std::function<void(const std::string&)>& open,
                     std::function<void()> close)
    : path_(std::move(path)), close_(std::move(close)) {
  if (path_.empty()) return;
  file_.emplace(path_, OutputFile::Use::kByName);
  open(file_->by_name());
}

TraceFile::~TraceFile() {
  try {
    close();
  } catch (const Error& e) {
    say(fmt::format("cde: {}\n", e.what()));
  }
}

void TraceFile::close() {
  if (!file_) return;
  try {
    close_();
    file_->commit();
    file_.reset();
    warn_if_empty();
  } catch (const Error& e) {
    file_.reset();
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path_), e.what()));
  }
}

/// A window that the run did not reach leaves a file whose start time is its end time. The header
/// block of an FST has both: its type (1 byte), its length (8), start and end (8 each).
void TraceFile::warn_if_empty() const {
  constexpr std::size_t kStart = 9, kEnd = 17, kTime = 8;
  if (!std::filesystem::is_regular_file(path_)) return;
  std::array<char, kEnd + kTime> header{};
  std::ifstream in(path_, std::ios::binary);
  if (!in.read(header.data(), header.size())) return;
  if (std::equal(&header[kStart], &header[kEnd], &header[kEnd]))
    say(fmt::format("cde: {} has no clock of the run: nothing ran while waves were written\n",
                    printable_name(path_)));
}

}  // namespace cde
