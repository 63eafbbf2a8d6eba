#include "cde/bitstream.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>

#include "cde/error.hpp"
#include "cde/message.hpp"
#include "process.hpp"
#include "sanitizer.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> from_environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  if (value == nullptr || *value == '\0') return std::nullopt;
  return fs::path(value);
}

/// The folder that holds rtl/ and verilator/: beside the program when it is installed, else the
/// source tree the library was built from, else where it was configured to be installed.
fs::path share_folder() {
  if (auto path = from_environment("CDE_SHARE")) return *path;
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  const fs::path places[] = {program.parent_path().parent_path() / CDE_INSTALL_DATADIR / "cde",
                             CDE_SOURCE_FOLDER,
                             fs::path(CDE_INSTALL_PREFIX) / CDE_INSTALL_DATADIR / "cde"};
  for (const fs::path& place : places) {
    if (fs::exists(place / "verilator/bitstream", none)) return place;
  }
  throw Error(
      ErrorCode::kBuild,
      fmt::format("no verilator/bitstream in {}, {} or {}; set CDE_SHARE to the folder that "
                  "holds verilator/ and rtl/",
                  places[0].string(), places[1].string(), places[2].string()));
}

fs::path cache_folder() {
  if (auto path = from_environment("CDE_CACHE")) return *path;
  if (auto xdg = from_environment("XDG_CACHE_HOME")) return *xdg / "cde";
  if (auto home = from_environment("HOME")) return *home / ".cache/cde";
  return fs::temp_directory_path() / fmt::format("cde-{}", ::getuid());
}

/// Folders that may hold ready-made bitstreams: an installation's before those of the build the
/// library comes from, the cache last.
std::vector<fs::path> bitstream_folders() {
  std::vector<fs::path> folders;
  if (auto path = from_environment("CDE_BITSTREAMS")) folders.push_back(*path);
  // share_folder() is PREFIX/share/cde in an installation.
  folders.push_back(share_folder().parent_path().parent_path() / CDE_INSTALL_LIBDIR /
                    "cde/bitstreams");
  folders.emplace_back(CDE_BITSTREAM_FOLDER);
  folders.push_back(cache_folder());
  return folders;
}

/// Whether the file is an ELF library that reaches to its end: loading one that is cut short would
/// end the process with SIGBUS.
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

std::string joined(const std::string& kind, const std::vector<std::string>& parameters) {
  return fmt::format("{} {}", kind, fmt::join(parameters, " "));
}

struct Key {
  std::uint64_t config_hash;
  std::string file;  ///< name without folder
};

Key key_of(const std::string& kind, const std::vector<std::string>& parameters) {
  std::vector<std::string> command = {bitstream_builder().string(), "hash", kind};
  command.insert(command.end(), parameters.begin(), parameters.end());
  const process::Result result = process::run(command, true);
  unsigned long long hash = 0;
  char key[65] = {};
  if (result.status != 0 ||
      std::sscanf(result.output.c_str(), "%16llx %64[0-9a-f]", &hash, key) != 2) {
    throw Error(ErrorCode::kBuild, fmt::format("bitstream {}: {}", joined(kind, parameters),
                                               last_lines(result.output, 8)));
  }
  return {hash, fmt::format("{}.so", key)};
}

/// Holds an exclusive lock on a file while it lives.
class FileLock {
 public:
  explicit FileLock(const fs::path& path)
      : fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (fd_ < 0) {
      throw Error(ErrorCode::kFile, fmt::format("{}: {}", path.string(), std::strerror(errno)));
    }
    while (::flock(fd_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FileLock() { ::close(fd_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int fd_;
};

/// Builds `file`, which the builder puts in place with a rename. The caller holds the lock.
void build(const fs::path& file, const std::string& kind,
           const std::vector<std::string>& parameters) {
  std::vector<std::string> command = {bitstream_builder().string(), "build", kind, file.string()};
  command.insert(command.end(), parameters.begin(), parameters.end());
  const std::string what = joined(kind, parameters);
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  const char* const advice = "first use of this configuration, kept for the next time";
  if (!terminal) say(fmt::format("cde: building bitstream {} ({})\n", what, advice));
  const process::Result result =
      process::run(command, true, [&](std::chrono::duration<double> elapsed) {
        if (terminal) {
          std::fputs(fmt::format("\rcde: building bitstream {} ({}) {:.0f} s ", what, advice,
                                 elapsed.count())
                         .c_str(),
                     stderr);
        }
      });
  if (terminal) say("\n");
  if (result.status != 0) {
    throw Error(ErrorCode::kBuild, fmt::format("building bitstream {} failed:\n{}", what,
                                               last_lines(result.output, 12)));
  }
}

std::optional<fs::path> find_intact(const Key& key) {
  for (const fs::path& folder : bitstream_folders()) {
    if (intact(folder / key.file)) return folder / key.file;
  }
  return std::nullopt;
}

fs::path find_or_build(const Key& key, const std::string& kind,
                       const std::vector<std::string>& parameters) {
  if (auto found = find_intact(key)) return *found;
  fs::path file = bitstream_cache() / key.file;
  const FileLock lock(fs::path(file).replace_extension(".lock"));
  if (auto found = find_intact(key)) return *found;  // another process was first
  build(file, kind, parameters);
  return file;
}

}  // namespace

void check(Arithmetic arithmetic) {
  if (arithmetic != Arithmetic::kHost && arithmetic != Arithmetic::kRtl)
    throw Error(ErrorCode::kUsage, fmt::format("there is no arithmetic {}; they are 0 and 1",
                                               static_cast<int>(arithmetic)));
}

std::vector<std::string> BoardConfig::parameters() const {
  const auto require = [](bool ok, const char* name, unsigned value, const char* range) {
    if (!ok)
      throw Error(ErrorCode::kUsage, fmt::format("{} is {}; it must be {}", name, value, range));
  };
  require(std::has_single_bit(lanes) && lanes <= 256, "lanes", lanes,
          "a power of two from 1 to 256");
  const auto latency = [&](unsigned value, const char* name) {
    require(value >= 1 && value <= 16, name, value, "1 to 16 clocks");
  };
  check(arithmetic);
  require(transform <= Transformer::kBoth, "transform", static_cast<unsigned>(transform), "0 to 2");
  require(bus == Bus::kFunctional || bus == Bus::kCycle, "bus", static_cast<unsigned>(bus),
          "0 or 1");
  (void)name(algorithm);
  for (const Pair pair : pairs) (void)name(pair);
  latency(latency_add, "latency_add");
  latency(latency_mul, "latency_mul");
  latency(latency_div, "latency_div");
  latency(latency_sqrt, "latency_sqrt");
  latency(latency_compare, "latency_compare");
  if (parallel && pairs.size() < 2)
    throw Error(ErrorCode::kUsage, "two pipes at a time need a card with several pairs");
  if (pairs.empty()) throw Error(ErrorCode::kUsage, "a card has at least one pair");
  check_facet_interval(facet_interval, pairs);
  if (box && std::find(pairs.begin(), pairs.end(), Pair::kRayTriangle) == pairs.end())
    throw Error(ErrorCode::kUsage, "the box rule is of ray-triangle, which the card has not");
  unsigned set = 0;
  for (const Pair pair : pairs) set |= 1u << static_cast<unsigned>(pair);
  const BoardConfig standard;
  const bool moves = transform != Transformer::kNone, poses = transform == Transformer::kBoth;
  const auto table = [&](unsigned value, const char* name) {
    require(value >= 2 && value <= 2048, name, value, "2 to 2048");
  };
  if (moves) table(objects, "objects");
  if (poses) table(primary_objects, "primary_objects");
  require(ddr_slots >= 1 && ddr_slots <= standard.ddr_slots, "ddr_slots", ddr_slots,
          "1 to 55555555");
  require(std::has_single_bit(sram_records) && sram_records >= 2 &&
              sram_records <= standard.sram_records,
          "sram_records", sram_records, "a power of two from 2 to 524288");

  std::vector<std::string> list = {
      fmt::format("ARITH={}", arithmetic == Arithmetic::kHost ? "host" : "rtl")};
  const auto add = [&](const char* name, unsigned value, unsigned standard_value) {
    if (value != standard_value) list.push_back(fmt::format("{}={}", name, value));
  };
  add("LANES", lanes, standard.lanes);
  add("PAIRS", set, 1);
  add("ALGORITHM", static_cast<unsigned>(algorithm), 0);
  add("BOX", box ? 1 : 0, 0);
  add("SWAP", swap ? 1 : 0, 0);
  add("NORMALS", normals ? 1 : 0, 0);
  add("PARALLEL", parallel ? 1 : 0, 0);
  add("FACET_II", facet_interval, standard.facet_interval);
  add("ECC", ecc ? 1 : 0, 0);
  add("TRANSFORM", static_cast<unsigned>(transform), 0);
  if (moves) add("OBJECTS", objects, standard.objects);
  if (poses) add("PRIM_OBJECTS", primary_objects, standard.primary_objects);
  add("LAT_ADD", latency_add, standard.latency_add);
  add("LAT_MUL", latency_mul, standard.latency_mul);
  add("LAT_DIV", latency_div, standard.latency_div);
  add("LAT_SQRT", latency_sqrt, standard.latency_sqrt);
  add("LAT_CMP", latency_compare, standard.latency_compare);
  add("DDR_SLOTS", ddr_slots, standard.ddr_slots);
  add("SRAM_RECORDS", sram_records, standard.sram_records);
  if (trace) list.emplace_back("TRACE=1");
  return list;
}

fs::path bitstream_cache() {
  fs::path folder = cache_folder();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw Error(ErrorCode::kFile, fmt::format("bitstream cache {}: {} (CDE_CACHE names another)",
                                              folder.string(), error.message()));
  }
  return folder;
}

fs::path bitstream_builder() {
  return share_folder() / "verilator/bitstream";
}

fs::path bitstream_path(const std::string& kind, const std::vector<std::string>& parameters) {
  return find_or_build(key_of(kind, parameters), kind, parameters);
}

BitstreamFile bitstream_file(const std::string& kind, const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  if (auto found = find_intact(key)) return {*found, true};
  return {cache_folder() / key.file, false};
}

std::uint64_t bitstream_hash(const std::string& kind, const std::vector<std::string>& parameters) {
  return key_of(kind, parameters).config_hash;
}

Bitstream Bitstream::open(const std::string& kind, const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  const fs::path file = find_or_build(key, kind, parameters);
  try {
    return load(file, key.config_hash);
  } catch (const Error&) {
    // Damaged in a way that only the loader sees. A file in the cache is ours to replace.
    const fs::path cached = bitstream_cache() / key.file;
    const FileLock lock(fs::path(cached).replace_extension(".lock"));
    build(cached, kind, parameters);
    return load(cached, key.config_hash);
  }
}

Bitstream Bitstream::load(const fs::path& file, std::uint64_t config_hash) {
  if (!intact(file)) {
    throw Error(ErrorCode::kConfiguration,
                fmt::format("{} is not a bitstream (missing, cut short, or no shared library)",
                            file.string()));
  }
  Bitstream result;
  result.path_ = fs::absolute(file);
  result.config_hash_ = config_hash;
  void* library = ::dlopen(result.path_.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw Error(ErrorCode::kConfiguration, ::dlerror());  // NOLINT(concurrency-mt-unsafe)
  // LeakSanitizer does not see what thread-local variables of a closed library hold; Verilator's
  // runtime keeps one small buffer there.
  result.library_ = {library, [](void* handle) {
                       if (!kSanitizer) ::dlclose(handle);
                     }};
  return result;
}

void* Bitstream::symbol(const char* name) const {
  void* address = ::dlsym(library_.get(), name);
  if (address == nullptr) {
    throw Error(ErrorCode::kConfiguration, fmt::format("{} exports no {}", path_.string(), name));
  }
  return address;
}

}  // namespace cde
