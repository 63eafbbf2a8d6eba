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
    log(fmt::format("cde: {}\n", e.what()));
  }
}

std::optional<std::uint64_t> TraceFile::close() {
  if (!file_) return std::nullopt;
  try {
    close_();
  } catch (const Error& e) {
    file_.reset();
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path_), e.what()));
  }
  // Read the written file itself: once committed, its name may lead elsewhere.
  const auto times = trace_times(file_->by_name());
  try {
    file_->commit();
  } catch (...) {
    file_.reset();
    throw;
  }
  file_.reset();
  // If the run does not reach the window, the file's start time equals its end time.
  if (times && times->first == times->second)
    log(fmt::format("cde: {} has no cycle of the run: the run had ended before the waves began\n",
                    printable_name(path_)));
  return times ? std::optional(times->second) : std::nullopt;
}

/// The header block of an FST holds its type (1 byte), its length, and its first and last time (8
/// bytes each, highest byte first).
std::optional<std::pair<std::uint64_t, std::uint64_t>> trace_times(
    const std::filesystem::path& file) {
  constexpr std::size_t kStart = 9, kEnd = 17, kTime = 8;
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  std::array<char, kEnd + kTime> header{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(header.data(), header.size())) return std::nullopt;
  const auto time = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + kTime; ++i)
      value = value << 8 | static_cast<unsigned char>(header[i]);
    return value;
  };
  return std::pair(time(kStart), time(kEnd));
}

}  // namespace cde
