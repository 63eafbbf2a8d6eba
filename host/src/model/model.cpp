// SPDX-License-Identifier: Apache-2.0
#include "cde/model/model.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "model/build_progress.hpp"
#include "model/folders.hpp"
#include "support/descriptor.hpp"
#include "support/file_io.hpp"
#include "support/sanitizer.hpp"
#include "support/sha256.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

void say_once(const std::string& message) {
  static std::mutex mutex;
  static std::set<std::string> said;
  const std::scoped_lock lock(mutex);
  if (said.insert(message).second) log(message);
}

/// Whether the file is a complete ELF library. Loading a truncated library would end the process
/// with SIGBUS.
bool intact(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  Elf64_Ehdr header;
  std::ifstream in(file, std::ios::binary);
  if (error || !in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  return std::memcmp(header.e_ident, ELFMAG, SELFMAG) == 0 && header.e_type == ET_DYN &&
         header.e_shoff + std::uint64_t{header.e_shnum} * header.e_shentsize <= size;
}

std::string last_lines(std::string_view text, int lines) {
  while (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  std::size_t begin = text.size();
  while (lines-- > 0 && begin != 0 && begin != std::string_view::npos) {
    begin = text.rfind('\n', begin - 1);
  }
  if (begin == std::string_view::npos || begin == 0) return std::string(text);
  return std::string(text.substr(begin + 1));
}

/// The reason for a failed build, from the builder's output. These are its first errors, as
/// Verilator and compilers mark them, each with the following line. Without such errors they are
/// its last lines.
std::string causes(const std::string& text) {
  constexpr int kMost = 4;
  const auto names_error = [](const std::string& line) {
    for (const char* start : {"%Error", "error: ", "fatal error: "})
      if (line.starts_with(start)) return true;
    return line.find(": error: ") != std::string::npos ||
           line.find(": fatal error: ") != std::string::npos;
  };
  std::string found;
  int errors = 0;
  std::istringstream lines(text);
  for (std::string line, after; errors < kMost && std::getline(lines, line);) {
    if (!names_error(line)) continue;
    ++errors;
    found += line + '\n';
    if (std::getline(lines, after)) found += after + '\n';
  }
  return errors != 0 ? last_lines(found, 2 * kMost) : last_lines(text, 12);
}

/// A simulation model's file: by the requested name, and by a name that keeps leading to it if the
/// folders above change.
struct Place {
  fs::path named, inside;

  /// A file beside it: its log or its lock.
  [[nodiscard]] Place beside(const char* extension) const {
    return {fs::path(named).replace_extension(extension),
            fs::path(inside).replace_extension(extension)};
  }
};

/// Keeps the output of a failed build beside the model's file, and returns the note for the
/// message.
std::string keep_log(const Place& log, const std::string& output) {
  // Create a new file, since the old name may be another user's link.
  ::unlink(log.inside.c_str());
  const Descriptor written(
      ::open(log.inside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (written.get() < 0 || !process::write_all(written.get(), output)) return "";
  return fmt::format("\nfull output of the builder: {}", printable_name(log.named.string()));
}

/// Why a simulation model cannot be loaded; nothing if it is complete and trusted.
std::optional<std::string> defect(const Place& place) {
  const fs::path& file = place.inside;
  if (auto why = folders::distrust(file, place.named)) return why;
  if (auto why =
          folders::distrust(folders::checksum_file(file), folders::checksum_file(place.named)))
    return "has a checksum file that " + *why;
  std::error_code none;
  if (fs::is_directory(file, none)) return "is a folder";
  for (const fs::path& one : {file, folders::checksum_file(file)})
    if (fs::exists(one, none) && !fs::is_regular_file(one, none))
      return fmt::format("{} no regular file", one == file ? "is" : "has a checksum that is");
  std::ifstream in(folders::checksum_file(file));
  if (!in) return "has no checksum beside it";
  std::string line;
  while (std::getline(in, line) && line.starts_with('#')) {
  }
  const auto sum = sha256_of_file(file);
  if (!sum) return fmt::format("cannot be read: {}", std::strerror(errno));
  if (*sum != line.substr(0, line.find(' '))) return "is damaged: its checksum differs";
  if (!intact(file)) return "is not a simulation model (truncated, or not a shared library)";
  return std::nullopt;
}

/// The first line of a checksum file; empty if the file cannot be read.
std::string first_line(const fs::path& checksum) {
  try {
    const std::string text = file_io::read_regular(checksum);
    return text.substr(0, text.find('\n'));
  } catch (const Error&) {
    return {};
  }
}

std::string joined(const std::string& kind, const std::vector<std::string>& parameters) {
  return fmt::format("{} {}", kind, fmt::join(parameters, " "));
}

struct Key {
  std::uint64_t config_hash;
  std::string file;  ///< file name without folder
};

Key key_of(const std::string& kind, const std::vector<std::string>& parameters) {
  std::vector<std::string> command = {model_builder().string(), "hash", kind};
  command.insert(command.end(), parameters.begin(), parameters.end());
  const process::Result result = process::run(command);
  unsigned long long hash = 0;
  char key[65] = {};
  if (result.status != 0 ||
      std::sscanf(result.output.c_str(), "%16llx %64[0-9a-f]", &hash, key) != 2) {
    throw Error(ErrorCode::kBuild, fmt::format("simulation model {}: {}", joined(kind, parameters),
                                               printable(last_lines(result.output, 8))));
  }
  return {hash, fmt::format("{}.so", key)};
}

[[noreturn]] void fail_folder(const fs::path& file, std::string_view use) {
  throw Error(ErrorCode::kFile, fmt::format("{}: is a folder; expected a file{}; remove the folder",
                                            printable_name(file.string()), use));
}

/// Holds an exclusive lock on a file during its lifetime, and reports what it waits for.
class FileLock {
 public:
  FileLock(const Place& place, const std::string& what) : fd_(opened(place)) {
    if (fd_ < 0 && (errno == EISDIR || errno == ELOOP)) {  // an empty folder or a link
      std::error_code none;
      fs::remove(place.inside, none);
      fd_ = opened(place);
    }
    if (fd_ < 0) {
      if (errno == EISDIR) fail_folder(place.named, ", which is locked during a build");
      throw Error(ErrorCode::kFile, fmt::format("{}: {}", printable_name(place.named.string()),
                                                std::strerror(errno)));
    }
    // Any user who can read the file could hold its lock for ever.
    struct stat info {};
    if (::fstat(fd_, &info) == 0 && (info.st_mode & 077) != 0) (void)::fchmod(fd_, 0600);
    if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
    if (!BuildProgress::quiet())
      log(fmt::format("cde: waiting for another process that builds simulation model {}\n", what));
    while (::flock(fd_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FileLock() { ::close(fd_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  static int opened(const Place& place) {
    return ::open(place.inside.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
  }

  int fd_;
};

/// Builds the model under its name. The builder puts it there with a rename. The caller holds the
/// lock.
void build(const Place& place, const std::string& kind,
           const std::vector<std::string>& parameters) {
  std::vector<std::string> command = {model_builder().string(), "attended", kind,
                                      place.named.string()};
  command.insert(command.end(), parameters.begin(), parameters.end());
  const std::string what = joined(kind, parameters);
  BuildProgress progress(what, expected_build_seconds(parameters));
  const process::Result result = process::run_watched(
      command,
      [&](process::Seconds elapsed, std::string_view so_far) { progress(elapsed, so_far); });
  progress.end(result.status == 0);
  if (result.status == 0) {
    std::error_code none;
    fs::remove(place.beside(".log").inside, none);  // the log of an earlier failed build
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (result.status == 128 + signal)
      throw Error(signal, fmt::format("building simulation model {} was stopped: {}", what,
                                      ::strsignal(signal)));  // NOLINT(concurrency-mt-unsafe)
  }
  if (result.status != 0) {
    const std::string said = BuildProgress::without_phases(result.output);
    throw Error(ErrorCode::kBuild,
                fmt::format("building simulation model {} failed:\n{}{}", what,
                            printable(causes(said)), keep_log(place.beside(".log"), said)));
  }
}

/// The searched folders; the cache comes last.
std::vector<fs::path> places() {
  std::vector<fs::path> folders = folders::ready_made();
  folders.push_back(folders::cache());
  return folders;
}

/// The file of a key in the searched folders. Reports files that are there but not loaded.
std::optional<Place> find_whole(const Key& key) {
  for (const fs::path& path : places()) {
    const auto folder = folders::open(path);
    if (!folder) continue;
    Place place{path / key.file, folder->inside / key.file};
    std::error_code none;
    if (folder->distrust) {
      say_once(fmt::format("cde: folder of simulation models {} is refused: it {}\n",
                           printable_name(path.string()), *folder->distrust));
    } else if (!fs::exists(place.inside, none)) {
      continue;
    } else if (const auto what = defect(place)) {
      say_once(fmt::format("cde: simulation model {} is not loaded: it {}\n",
                           printable_name(place.named.string()), *what));
    } else {
      return place;
    }
  }
  return std::nullopt;
}

/// The model's place in the cache, which is created and opened.
Place place_to_build(const Key& key) {
  const folders::Opened cache = folders::make_model_cache();
  return {cache.named / key.file, cache.inside / key.file};
}

/// Builds the model in the cache. The caller holds the lock.
void build_kept(const Place& place, const std::string& kind,
                const std::vector<std::string>& parameters) {
  std::error_code none;
  for (const Place& file : {place, place.beside(".so.sha256")}) {
    if (!fs::is_directory(fs::symlink_status(file.inside, none))) continue;
    if (!fs::remove(file.inside, none)) fail_folder(file.named, "");  // not empty
  }
  build(place, kind, parameters);
  if (!fs::exists(place.inside, none))
    throw Error(ErrorCode::kFile,
                fmt::format("cache of simulation models {} was replaced during the build",
                            printable_name(place.named.parent_path().string())));
}

FileLock lock_of(const Place& place, const std::string& kind,
                 const std::vector<std::string>& parameters) {
  return {place.beside(".lock"), joined(kind, parameters)};
}

Place find_or_build(const Key& key, const std::string& kind,
                    const std::vector<std::string>& parameters) {
  if (auto found = find_whole(key)) return *found;
  const Place place = place_to_build(key);
  const FileLock lock = lock_of(place, kind, parameters);
  if (auto found = find_whole(key)) return *found;  // another process was first
  build_kept(place, kind, parameters);
  return place;
}

/// Whether the library was built for this key. Another key's library may have this file name.
bool is_of(const SimulationModel& model, const Key& key) {
  const auto* hash = static_cast<const std::uint64_t*>(model.symbol("cde_built_config_hash"));
  return *hash == key.config_hash;
}

}  // namespace

bool report_builds(bool tell) {
  const bool before = !BuildProgress::quiet();
  BuildProgress::set_quiet(!tell);
  return before;
}

fs::path model_cache() {
  return folders::make_model_cache().named;
}

fs::path model_builder() {
  return folders::share() / "verilator/model_builder";
}

fs::path model_path(const std::string& kind, const std::vector<std::string>& parameters) {
  return find_or_build(key_of(kind, parameters), kind, parameters).named;
}

ModelFile model_file(const std::string& kind, const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  if (auto found = find_whole(key)) return {found->named, true};
  return {folders::cache() / key.file, false};
}

std::vector<std::vector<std::string>> built_models(const std::string& kind) {
  std::set<std::vector<std::string>> found;
  for (const fs::path& path : places()) {
    std::error_code none;
    const auto folder = folders::open(path);
    if (!folder || folder->distrust) continue;
    for (fs::directory_iterator entry(folder->inside, none), end; entry != end;
         entry.increment(none)) {
      const fs::path& file = entry->path();
      if (!file.string().ends_with(".so.sha256") || folders::distrust(file, file)) continue;
      std::string word;
      std::istringstream words(first_line(file));
      if (!(words >> word) || word != "#" || !(words >> word) || word != kind) continue;
      found.emplace(std::istream_iterator<std::string>(words),
                    std::istream_iterator<std::string>());
    }
  }
  return {found.begin(), found.end()};
}

std::uint64_t model_hash(const std::string& kind, const std::vector<std::string>& parameters) {
  return key_of(kind, parameters).config_hash;
}

SimulationModel SimulationModel::open(const std::string& kind,
                                      const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  const Place place = find_or_build(key, kind, parameters);
  try {
    SimulationModel found = link(place.named, place.inside, key.config_hash);
    if (is_of(found, key)) return found;
    say_once(fmt::format(
        "cde: simulation model {} is not used: it was built for another configuration\n",
        printable_name(place.named.string())));
  } catch (const Error&) {
    // damage that only the loader sees
  }
  // Replace files in the cache only. A file there may already replace a ready-made one.
  const Place kept = place_to_build(key);
  const FileLock lock = lock_of(kept, kind, parameters);
  std::error_code none;
  if (kept.inside != place.inside && fs::exists(kept.inside, none) && !defect(kept)) {
    SimulationModel found = link(kept.named, kept.inside, key.config_hash);
    if (is_of(found, key)) return found;
  }
  build_kept(kept, kind, parameters);
  // The loader still holds the old library under its name, so use another name.
  return link(kept.named, kept.inside.parent_path() / "." / key.file, key.config_hash);
}

SimulationModel SimulationModel::load(const fs::path& file, std::uint64_t config_hash) {
  if (!intact(file)) {
    throw Error(
        ErrorCode::kConfiguration,
        fmt::format("{} is not a simulation model (missing, truncated, or not a shared library)",
                    printable_name(file.string())));
  }
  const fs::path whole = fs::absolute(file);
  const auto refuse = [&](const fs::path& part, const std::string& why) {
    throw Error(ErrorCode::kFile, fmt::format("{} is refused: {} {}", printable_name(file.string()),
                                              printable_name(part.string()), why));
  };
  const auto folder = folders::open(whole.parent_path());
  if (!folder) refuse(whole.parent_path(), "has disappeared");
  if (folder->distrust) refuse(whole.parent_path(), *folder->distrust);
  const fs::path inside = folder->inside / whole.filename();
  if (const auto why = folders::distrust(inside, whole)) refuse(whole, *why);
  if (fs::exists(folders::checksum_file(inside))) {
    if (const auto why = defect({whole, inside}))
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("{} {}", printable_name(file.string()), *why));
  }
  return link(whole, inside, config_hash);
}

SimulationModel SimulationModel::link(const fs::path& named, const fs::path& inside,
                                      std::uint64_t config_hash) {
  SimulationModel result;
  result.path_ = fs::absolute(named);
  result.config_hash_ = config_hash;
  void* library = ::dlopen(inside.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw Error(ErrorCode::kConfiguration,
                printable_name(::dlerror()));  // NOLINT(concurrency-mt-unsafe)
  // LeakSanitizer does not see thread-local variables of a closed library, where Verilator's
  // runtime keeps a small buffer.
  result.library_ = {library, [](void* handle) {
                       if (!kSanitizer) ::dlclose(handle);
                     }};
  return result;
}

void* SimulationModel::symbol(const char* name) const {
  void* address = ::dlsym(library_.get(), name);
  if (address == nullptr) {
    throw Error(ErrorCode::kConfiguration,
                fmt::format("{} exports no {}", printable_name(path_.string()), name));
  }
  return address;
}

}  // namespace cde
