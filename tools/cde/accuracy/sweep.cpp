// SPDX-License-Identifier: Apache-2.0
#include "accuracy/sweep.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "output/input_file.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"
#include "output/version.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// A family of a pipe, by itself.
struct Part {
  std::string name;
  std::optional<oracle::Family> family;  ///< none: rays of a mesh
  std::uint64_t cases = 0;
};

std::vector<Part> parts_of(const AccuracyPipe& pipe, const SweepOptions& o) {
  std::vector<Part> parts;
  const auto wanted = [&](const std::string& name) {
    return o.families.empty() || std::ranges::find(o.families, name) != o.families.end();
  };
  for (const oracle::Family& family : oracle::families(pipe.pair))
    if (wanted(family.name)) parts.push_back({family.name, family});
  if (pipe.pair == Pair::kRayTriangle)
    for (const std::string& name : leak_families())
      if (wanted(name)) parts.push_back({name, std::nullopt});
  for (std::size_t k = 0; k < parts.size(); ++k)
    parts[k].cases = o.cases / parts.size() + (k < o.cases % parts.size() ? 1 : 0);
  return parts;
}

/// Lines of JSON: first what the sweep is of, then the parts that are finished.
class PartFile {
 public:
  explicit PartFile(const SweepOptions& o) : path_(o.resume) {
    if (path_.empty()) return;
    const Json head = {{"schema", "cde.accuracy.parts.2"},
                       {"version", kVersion},
                       {"commit", kCommit},
                       {"seed", o.seed},
                       {"cases", o.cases},
                       {"families", o.families}};
    std::error_code unknown;
    if (std::filesystem::exists(path_, unknown) &&
        !std::filesystem::is_regular_file(path_, unknown))
      throw Error(ErrorCode::kFile,
                  fmt::format("--resume: {} is not a regular file", printable_name(path_)));
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail("cannot open");
    const std::size_t whole = read(head);
    // What a run that was killed had not written to its end is written again.
    if (::ftruncate(file_, static_cast<off_t>(whole)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
      fail("cannot write");
    if (whole == 0) write(head);
  }
  ~PartFile() {
    if (file_ >= 0) ::close(file_);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  [[nodiscard]] const Tally* find(const AccuracyPipe& pipe, const std::string& family) const {
    const auto at = done_.find(pipe.name() + " " + family);
    return at == done_.end() ? nullptr : &at->second;
  }
  void add(const AccuracyPipe& pipe, const std::string& family, const Tally& tally) {
    if (file_ < 0) return;
    Json line = {{"pipe", pipe.name()}, {"family", family}};
    line["tally"] = tally.to_json();
    write(line);
  }

 private:
  [[noreturn]] void fail(const char* doing) const {
    throw Error(ErrorCode::kFile,
                fmt::format("{}: {}: {}", path_, doing, std::generic_category().message(errno)));
  }
  void write(const Json& line) {
    const std::string text = json_text(line, -1) + "\n";
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t n = ::write(file_, text.data() + at, text.size() - at);
      if (n < 0 && errno != EINTR) fail("cannot write");
      if (n > 0) at += static_cast<std::size_t>(n);
    }
  }
  /// Bytes of the lines that are whole.
  std::size_t read(const Json& head) {
    const std::string text = read_file(path_);
    std::size_t whole = 0, number = 0;
    for (std::size_t end = 0; (end = text.find('\n', whole)) != std::string::npos;
         whole = end + 1) {
      const Json line =
          Json::parse(text.begin() + static_cast<std::ptrdiff_t>(whole),
                      text.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
      ++number;
      try {
        if (number == 1 || (line.is_object() && line.contains("schema"))) {
          check_head(head, line);
        } else {
          done_.insert_or_assign(
              line.at("pipe").get<std::string>() + " " + line.at("family").get<std::string>(),
              Tally::from_json(line.at("tally")));
        }
      } catch (const Json::exception&) {
        throw Error(
            ErrorCode::kFile,
            fmt::format("{}, line {}: not a part of a sweep of cde accuracy", path_, number));
      }
    }
    // The first line may itself be what was not written to its end.
    if (number == 0 && !(json_text(head, -1) + "\n").starts_with(text))
      throw Error(ErrorCode::kFile, fmt::format("{}: not a file of cde accuracy --resume", path_));
    return whole;
  }
  void check_head(const Json& head, const Json& there) const {
    for (const auto& [key, value] : head.items())
      if (there.at(key) != value)
        throw Error(ErrorCode::kUsage,
                    fmt::format("--resume: {} is of a sweep with {} {}, this one has {}", path_,
                                key, there.at(key).dump(), value.dump()));
  }

  std::string path_;
  int file_ = -1;
  std::map<std::string, Tally> done_;
};

}  // namespace

std::vector<std::string> family_names(const std::vector<AccuracyPipe>& pipes) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const AccuracyPipe& pipe : pipes)
    for (const oracle::Family& family : oracle::families(pipe.pair)) add(family.name);
  for (const AccuracyPipe& pipe : pipes)
    if (pipe.pair == Pair::kRayTriangle) std::ranges::for_each(leak_families(), add);
  return names;
}

Tally Measured::all() const {
  Tally sum;
  for (const auto& [name, tally] : families) sum.add(tally);
  return sum;
}

std::vector<Measured> sweep(const SweepOptions& o) {
  PartFile file(o);
  Progress progress("accuracy", o.quiet);
  std::vector<Measured> all;
  for (std::size_t i = 0; i < o.pipes.size(); ++i) {
    if (i % o.shards + 1 != o.shard) continue;
    const AccuracyPipe& pipe = o.pipes[i];
    Measured measured_pipe{pipe, {}};
    const std::vector<Part> parts = parts_of(pipe, o);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto& [name, family, cases] = parts[k];
      progress(
          (static_cast<double>(i) + static_cast<double>(k) / static_cast<double>(parts.size())) /
          static_cast<double>(o.pipes.size()));
      if (const Tally* known = file.find(pipe, name)) {
        measured_pipe.families.emplace_back(name, *known);
        continue;
      }
      const Tally tally = family ? measured(pipe, *family, o.seed, cases)
                                 : measured_leaks(pipe, name, o.seed, cases);
      file.add(pipe, name, tally);
      measured_pipe.families.emplace_back(name, tally);
    }
    all.push_back(std::move(measured_pipe));
  }
  return all;
}

}  // namespace cde::cli
