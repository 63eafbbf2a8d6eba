// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/output_file.hpp"
#include "output/streams.hpp"
#include "wave/trace.hpp"

namespace cde::cli {

/// The waves of a verb (--trace). They are kept whatever comes of it, if they are whole: they are
/// wanted most when it fails.
class Waves {
 public:
  /// No waves if `path` is empty. `open` and `close` are the model's, which must outlive them.
  Waves(std::string path, const std::function<void(const std::string&)>& open,
        std::function<void()> close)
      : path_(std::move(path)), close_(std::move(close)) {
    if (path_.empty()) return;
    file_.emplace(path_, OutputFile::Use::kByName);
    open(file_->temporary());
  }
  ~Waves() {
    try {
      close();
    } catch (const Error& e) {
      say("cde: {}\n", e.what());
    }
  }
  Waves(const Waves&) = delete;
  Waves& operator=(const Waves&) = delete;

  /// Error kFile if they are not whole; then nothing of them is left.
  void close() {
    if (!file_) return;
    try {
      close_();
      file_->commit();
      file_.reset();
      tell_if_empty();
    } catch (const Error& e) {
      file_.reset();
      throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path_), e.what()));
    }
  }

 private:
  /// A window that the run never came to, or a run of nothing, leaves a file without a clock.
  void tell_if_empty() const {
    if (!std::filesystem::is_regular_file(path_)) return;
    const wave::Trace trace(path_);
    if (trace.start() == trace.end())
      say("cde: {} has no clock of the run: nothing ran while waves were written\n",
          printable_name(path_));
  }

  std::string path_;
  std::function<void()> close_;
  std::optional<OutputFile> file_;
};

}  // namespace cde::cli
