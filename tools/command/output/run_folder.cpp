// SPDX-License-Identifier: Apache-2.0
#include "output/run_folder.hpp"
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/input_file.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char *kMarker = "run.json", *kLock = "run.lock";
/// Keys of run.json that list files in the folder: tables of records, and other files.
constexpr std::array kListed = {"files", "files_beside"};

std::string_view ending(Results results) {
  if (results == Results::kBinary) return ".bin";
  return results == Results::kNpy ? ".npy" : ".csv";
}

/// QUERY.FRAME.csv, .bin or .npy: a query's name of 1 to 64 characters, a frame of 6 or 7 digits.
bool is_record_name(std::string_view name) {
  constexpr std::string_view kDigits = "0123456789",
                             kNameCharacters =
                                 "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-0123456789";
  if (!name.ends_with(".csv") && !name.ends_with(".bin") && !name.ends_with(".npy")) return false;
  name.remove_suffix(4);
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return false;
  const std::string_view query = name.substr(0, dot), frame = name.substr(dot + 1);
  const auto only = [](std::string_view text, std::string_view of) {
    return text.find_first_not_of(of) == std::string_view::npos;
  };
  return dot >= 1 && dot <= 64 && only(query, kNameCharacters) &&
         (frame.size() == 6 || frame.size() == 7) && only(frame, kDigits);
}

/// Whether a file is directly in the folder; false if the file's own folder does not exist.
bool is_in(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  return fs::equivalent(file.has_parent_path() ? file.parent_path() : fs::path("."), folder,
                        error) &&
         !error;
}

}  // namespace

RunFolder::RunFolder(fs::path path, const Scene& scene, const std::vector<std::string>& beside)
    : path_(std::move(path)) {
  if (path_ == "-") throw Error(ErrorCode::kUsage, "--output is -; it must be a folder");
  make_and_lock();
  check_names(scene, beside);
  if (!made_->made()) look();
}

void RunFolder::make_and_lock() {
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path_.string()), why));
  };
  for (;;) {
    made_.emplace(path_);
    // Child processes do not inherit it: a compiler that outlives the command would keep the lock.
    lock_.folder = ::openat(made_->descriptor(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_.folder < 0 && errno == ENOENT) continue;  // another run has just removed it
    if (lock_.folder < 0) fail(std::strerror(errno));   // NOLINT(concurrency-mt-unsafe)
    const auto locking = lock_.file.lock(lock_.folder, kLock, path_ / kLock);
    if (locking == FolderLock::Result::kInUse) {
      made_->keep();  // it belongs to the other run
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is the folder of a run that is still going on; wait for its end, "
                              "or name another folder with --output",
                              printable_name(path_.string())));
    }
    struct stat locked {
    }, named{};
    if (::fstat(lock_.folder, &locked) != 0) fail(std::strerror(errno));
    const bool there = ::stat(path_.c_str(), &named) == 0;
    if (!there && errno != ENOENT) fail(std::strerror(errno));
    if (locking == FolderLock::Result::kLocked && there && locked.st_dev == named.st_dev &&
        locked.st_ino == named.st_ino)
      return;
    made_->keep();  // another run removed it, and may have made it again
    lock_.release();
  }
}

fs::path RunFolder::inside() const {
  return fmt::format("/proc/self/fd/{}", lock_.folder);
}

void RunFolder::Lock::release() {
  file.release();
  if (folder >= 0) ::close(std::exchange(folder, -1));
}

void RunFolder::check_names(const Scene& scene, const std::vector<std::string>& beside) {
  const auto inside = [&](const fs::path& file, const char* what) {
    if (!file.empty() && is_in(file, path_))
      throw Error(ErrorCode::kUsage, fmt::format("--output is {}, which contains {} {}",
                                                 printable_name(path_.string()), what,
                                                 printable_name(file.filename().string())));
  };
  inside(scene.file, "the scene");
  for (const SceneObject& object : scene.objects) {
    inside(object.file, "its input");
    for (const fs::path& file : object.more_files) inside(file, "its input");
  }
  for (const std::string& file : beside) {
    if (file.empty() || !is_in(file, path_)) continue;
    const std::string name = fs::path(file).filename();
    const bool is_table = std::ranges::any_of(scene.queries, [&](const SceneQuery& query) {
      return name == record_name(query.name, std::nullopt, scene.results);
    });
    if (name == kMarker || name == kLock || is_table || is_record_name(name))
      throw Error(ErrorCode::kUsage, fmt::format("{} has the name of a file that --output writes",
                                                 printable_name(file)));
    beside_.push_back(name);
  }
}

/// Another user could name files of this user in a run.json, or put files into the folder.
void RunFolder::check_owner(const std::string& name) const {
  for (const int flag : {0, AT_SYMLINK_NOFOLLOW}) {
    struct stat info {};
    if (::fstatat(lock_.folder, name.c_str(), &info, flag) != 0) continue;
    if (info.st_uid == lock_.file.owner()) continue;
    throw Error(
        ErrorCode::kUsage,
        fmt::format("{} belongs to user {}; a run removes only files of its own user; move it "
                    "elsewhere, or name another folder with --output",
                    printable_name((path_ / name).string()), info.st_uid));
  }
}

void RunFolder::look() {
  const Json marker = run_in(inside());
  if (!marker.is_null()) check_owner(kMarker);
  std::vector<std::string> listed = beside_;
  for (const char* key : kListed)
    if (marker.is_object() && marker.contains(key))
      for (const Json& name : marker[key])
        if (name.is_string()) listed.push_back(name);
  for (const auto& entry : fs::directory_iterator(inside())) {
    const std::string name = entry.path().filename();
    if (is_unfinished_name(name) || name == kLock) continue;
    if (marker.is_null())
      throw Error(ErrorCode::kUsage, fmt::format("{} is not empty and has no {} of a run; it stays "
                                                 "unchanged; name another folder with --output",
                                                 printable_name(path_.string()), kMarker));
    const bool ours = name == kMarker || is_record_name(name) ||
                      std::find(listed.begin(), listed.end(), name) != listed.end();
    if (!ours || entry.is_directory())
      throw Error(ErrorCode::kUsage, fmt::format("{} does not belong to the run in {}; move it "
                                                 "elsewhere, or name another folder with --output",
                                                 printable_name((path_ / name).string()),
                                                 printable_name(path_.string())));
    check_owner(name);
    old_.push_back(name);
  }
}

void RunFolder::begin(Json json) {
  // run.json stays until it is replaced. It marks the folder of a run.
  for (const std::string& name : old_) check_owner(name);
  for (const std::string& name : old_)
    if (name != kMarker && ::unlinkat(lock_.folder, name.c_str(), 0) != 0 && errno != ENOENT)
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: cannot remove: {}", printable_name((path_ / name).string()),
                              std::strerror(errno)));  // NOLINT(concurrency-mt-unsafe)
  sweep_unfinished(inside());
  begun_ = true;
  made_->keep();
  json["finished"] = false;
  write(json);
}

void RunFolder::write(const Json& json) const {
  write_file(inside() / kMarker, json_text(json) + "\n");
}

Json RunFolder::run_in(const fs::path& folder) {
  std::error_code none;
  if (!fs::is_regular_file(folder / kMarker, none)) return nullptr;
  Json json;
  try {
    json = parse_json(read_named_file((folder / kMarker).string()));
  } catch (const Error&) {
    return nullptr;
  }
  const bool ours = json.is_object() && json.contains("scene") && json.contains("frame_results");
  return ours ? json : Json();
}

std::string RunFolder::record_name(std::string_view query, std::optional<std::uint32_t> frame,
                                   Results results) {
  return fmt::format("{}{}{}", query, frame ? fmt::format(".{:06}", *frame) : "", ending(results));
}

}  // namespace cde::cli
