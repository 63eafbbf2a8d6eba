// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "cde/support/output_file.hpp"

namespace cde {

/// First and last time of a card's wave file (FST), in ps; nothing if it has no header.
[[nodiscard]] std::optional<std::pair<std::uint64_t, std::uint64_t>> trace_times(
    const std::filesystem::path& file);

/// The wave file (FST) of a run. A complete file is kept even if the run fails.
class TraceFile {
 public:
  /// An empty `path` means no file. `open` and `close` belong to the model, which must outlive this
  /// object.
  TraceFile(std::string path, const std::function<void(const std::string&)>& open,
            std::function<void()> close);
  ~TraceFile();
  TraceFile(const TraceFile&) = delete;
  TraceFile& operator=(const TraceFile&) = delete;

  /// Returns the last time of the file, in ps. Error kFile if the file is incomplete; it is then
  /// removed.
  std::optional<std::uint64_t> close();

 private:
  std::string path_;
  std::function<void()> close_;
  std::optional<OutputFile> file_;
};

}  // namespace cde
