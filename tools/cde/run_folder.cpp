#include "run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <regex>
#include <utility>

#include "cde/error.hpp"
#include "cde/output_file.hpp"
#include "streams.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kMarker = "run.json";
constexpr const char* kBeside = "files_beside";

bool is_record_name(const std::string& name) {
  static const std::regex form(R"([A-Za-z0-9_-]{1,64}\.[0-9]{6,7}\.(csv|bin))");
  return std::regex_match(name, form);
}

/// What run.json says, or null if there is none of a run.
Json marker_in(const fs::path& folder) {
  std::ifstream in(folder / kMarker);
  if (!in) return nullptr;
  Json json = Json::parse(in, nullptr, false);
  const bool ours = json.is_object() && json.contains("scene") && json.contains("played");
  return ours ? json : Json();
}

/// Whether a file is directly in the folder; false if its own folder is not there.
bool is_in(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  return fs::equivalent(file.has_parent_path() ? file.parent_path() : fs::path("."), folder,
                        error) &&
         !error;
}

}  // namespace

RunFolder::RunFolder(fs::path path, const Scene& scene, const std::vector<std::string>& beside)
    : path_(std::move(path)) {
  if (path_ == "-") throw Error(ErrorCode::kUsage, "--out is a folder; it cannot be stdout");
  make_and_lock();
  try {
    check_names(scene, beside);
    if (!made_) look();
  } catch (...) {
    take_back();
    unlock();
    throw;
  }
}

void RunFolder::make_and_lock() {
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(path_.string()), why));
  };
  for (;;) {
    std::error_code error;
    made_ = fs::create_directories(path_, error);
    if (error) fail(error.message());
    // Not inherited, or a compiler that outlives the command would hold it.
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 && errno == ENOENT) continue;  // another run has just taken it back
    if (lock_ < 0) fail(std::strerror(errno));   // NOLINT(concurrency-mt-unsafe)
    // File systems that lock no folders have no other lock to offer either.
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      unlock();
      throw Error(ErrorCode::kUsage, fmt::format("{} is the folder of a run that goes on: wait for "
                                                 "its end, or let --out name another folder",
                                                 printable_name(path_.string())));
    }
    struct stat locked {
    }, named{};
    if (::fstat(lock_, &locked) == 0 && ::stat(path_.c_str(), &named) == 0 &&
        locked.st_dev == named.st_dev && locked.st_ino == named.st_ino)
      return;
    unlock();  // it was taken back and perhaps made again
  }
}

void RunFolder::unlock() {
  if (lock_ >= 0) ::close(std::exchange(lock_, -1));
}

void RunFolder::check_names(const Scene& scene, const std::vector<std::string>& beside) {
  const auto inside = [&](const fs::path& file, const char* what) {
    if (!file.empty() && is_in(file, path_))
      throw Error(ErrorCode::kUsage, fmt::format("--out is {}, where {} {} is", path_.string(),
                                                 what, file.filename().string()));
  };
  inside(scene.file, "the scene");
  for (const SceneObject& object : scene.objects) inside(object.file, "its input");
  for (const std::string& file : beside) {
    if (file.empty() || !is_in(file, path_)) continue;
    const std::string name = fs::path(file).filename();
    if (name == kMarker || is_record_name(name))
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} has the name of a file that --out is for", file));
    beside_.push_back(name);
  }
}

void RunFolder::look() {
  const Json marker = marker_in(path_);
  std::vector<std::string> beside = beside_;
  if (marker.is_object() && marker.contains(kBeside))
    for (const Json& name : marker[kBeside])
      if (name.is_string()) beside.push_back(name);
  for (const auto& entry : fs::directory_iterator(path_)) {
    const std::string name = entry.path().filename();
    if (is_unfinished_name(name)) continue;
    if (marker.is_null())
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is not empty and not the folder of a run, which has a {}: it is "
                              "left as it is; --out names another",
                              path_.string(), kMarker));
    const bool ours = name == kMarker || is_record_name(name) ||
                      std::find(beside.begin(), beside.end(), name) != beside.end();
    if (!ours || entry.is_directory())
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is not of the run that {} holds: take it away, or let --out name "
                              "another folder",
                              entry.path().string(), path_.string()));
    old_.push_back(entry.path());
  }
}

RunFolder::~RunFolder() {
  if (!begun_) take_back();
  unlock();
}

void RunFolder::take_back() const {
  std::error_code error;
  if (made_) fs::remove(path_, error);  // not if there is something in it
}

void RunFolder::begin(Json json) {
  // run.json stays until it is replaced: a folder without it is nobody's.
  for (const fs::path& file : old_) {
    std::error_code error;
    if (file.filename() != kMarker && !fs::remove(file, error) && error)
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: cannot remove: {}", file.string(), error.message()));
  }
  sweep_unfinished(path_);
  begun_ = true;
  json["finished"] = false;
  write(json);
}

void RunFolder::write(const Json& json) const {
  write_file(path_ / kMarker, json_text(json) + "\n");
}

std::string RunFolder::record_name(std::string_view query, std::uint32_t frame, Results results) {
  return fmt::format("{}.{:06}.{}", query, frame, results == Results::kCsv ? "csv" : "bin");
}

}  // namespace cde::cli
