// SPDX-License-Identifier: Apache-2.0
#include "cde/bitstream/bitstream.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>

#include "bitstream/build_progress.hpp"
#include "bitstream/folders.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/process.hpp"
#include "support/sanitizer.hpp"
#include "support/sha256.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;

void say_once(const std::string& message) {
  static std::mutex mutex;
  static std::set<std::string> said;
  const std::scoped_lock lock(mutex);
  if (said.insert(message).second) say(message);
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

/// What a builder's output says of a failure: its first errors, as Verilator and compilers name
/// them, each with the line that follows; its last lines if it names none.
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

/// The output of a build that failed, kept beside where its bitstream would lie; what to say of it.
std::string keep_log(const fs::path& file, const std::string& output) {
  const fs::path log = fs::path(file).replace_extension(".log");
  std::ofstream out(log, std::ios::binary | std::ios::trunc);
  out << output;
  out.close();
  if (!out) return "";
  return fmt::format("\nall of what the builder said: {}", printable_name(log.string()));
}

/// Beside a bitstream, written by its builder: comments, and a line as of sha256sum.
fs::path checksum_file(const fs::path& file) {
  return fs::path(file) += ".sha256";
}

/// What keeps a bitstream from being loaded; nothing if it is whole and nobody else's.
std::optional<std::string> defect(const fs::path& file) {
  if (auto why = folders::distrust(file)) return why;
  std::ifstream in(checksum_file(file));
  if (!in) return "has no checksum beside it";
  std::string line;
  while (std::getline(in, line) && line.starts_with('#')) {
  }
  const auto sum = sha256_of_file(file);
  if (!sum) return fmt::format("cannot be read: {}", std::strerror(errno));
  if (*sum != line.substr(0, line.find(' '))) return "is damaged: its checksum is another";
  if (!intact(file)) return "is not a bitstream (cut short, or no shared library)";
  return std::nullopt;
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
  const process::Result result = process::run(command);
  unsigned long long hash = 0;
  char key[65] = {};
  if (result.status != 0 ||
      std::sscanf(result.output.c_str(), "%16llx %64[0-9a-f]", &hash, key) != 2) {
    throw Error(ErrorCode::kBuild, fmt::format("bitstream {}: {}", joined(kind, parameters),
                                               printable(last_lines(result.output, 8))));
  }
  return {hash, fmt::format("{}.so", key)};
}

/// Holds an exclusive lock on a file while it lives; says what it waits for.
class FileLock {
 public:
  FileLock(const fs::path& path, const std::string& what)
      : fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (fd_ < 0) {
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: {}", printable_name(path.string()), std::strerror(errno)));
    }
    if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
    if (!BuildProgress::quiet())
      say(fmt::format("cde: waiting for another process that builds bitstream {}\n", what));
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
  std::vector<std::string> command = {bitstream_builder().string(), "attended", kind,
                                      file.string()};
  command.insert(command.end(), parameters.begin(), parameters.end());
  const std::string what = joined(kind, parameters);
  BuildProgress progress(what);
  const process::Result result = process::attend(
      command,
      [&](process::Seconds elapsed, std::string_view so_far) { progress(elapsed, so_far); });
  progress.end(result.status == 0);
  if (result.status == 0) {
    std::error_code none;
    fs::remove(fs::path(file).replace_extension(".log"), none);  // of a build that failed before
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (result.status == 128 + signal)
      throw Error(signal, fmt::format("building bitstream {} was ended: {}", what,
                                      ::strsignal(signal)));  // NOLINT(concurrency-mt-unsafe)
  }
  if (result.status != 0) {
    const std::string said = BuildProgress::without_phases(result.output);
    throw Error(ErrorCode::kBuild, fmt::format("building bitstream {} failed:\n{}{}", what,
                                               printable(causes(said)), keep_log(file, said)));
  }
}

/// The folders that are asked, the cache last.
std::vector<fs::path> places() {
  std::vector<fs::path> folders = folders::ready_made();
  folders.push_back(folders::cache());
  return folders;
}

/// The file of a key in the folders that are asked. What is there and not loaded is said.
std::optional<fs::path> find_whole(const Key& key) {
  for (const fs::path& folder : places()) {
    const fs::path file = folder / key.file;
    std::error_code none;
    if (!fs::exists(file, none)) continue;
    if (const auto why = folders::distrust(folder)) {
      say_once(fmt::format("cde: bitstream folder {} is refused: it {}\n",
                           printable_name(folder.string()), *why));
    } else if (const auto what = defect(file)) {
      say_once(fmt::format("cde: bitstream {} is not loaded: it {}\n",
                           printable_name(file.string()), *what));
    } else {
      return file;
    }
  }
  return std::nullopt;
}

fs::path find_or_build(const Key& key, const std::string& kind,
                       const std::vector<std::string>& parameters) {
  if (auto found = find_whole(key)) return *found;
  fs::path file = bitstream_cache() / key.file;
  const FileLock lock(fs::path(file).replace_extension(".lock"), joined(kind, parameters));
  if (auto found = find_whole(key)) return *found;  // another process was first
  build(file, kind, parameters);
  return file;
}

/// A number of a configuration, and the builder's name for it.
struct Field {
  const char* name;
  unsigned (*get)(const BoardConfig&);
  void (*set)(BoardConfig&, unsigned);
  Transformer since = Transformer::kNone;  ///< cards with less than that have none
};

template <auto Member>
constexpr Field field(const char* name, Transformer since = Transformer::kNone) {
  return {name, [](const BoardConfig& c) { return static_cast<unsigned>(c.*Member); },
          [](BoardConfig& c, unsigned value) {
            c.*Member = static_cast<std::decay_t<decltype(c.*Member)>>(value);
          },
          since};
}

unsigned pair_set(const BoardConfig& c) {
  unsigned set = 0;
  for (const Pair pair : c.pairs) set |= 1u << static_cast<unsigned>(pair);
  return set;
}
void set_pairs(BoardConfig& c, unsigned set) {
  c.pairs.clear();
  for (unsigned i = 0; i < kPairs; ++i)
    if ((set >> i & 1) != 0) c.pairs.push_back(static_cast<Pair>(i));
}

/// A number of the format of verdicts, 0 without them.
template <auto Member>
constexpr Field verdict_field(const char* name) {
  return {name,
          [](const BoardConfig& c) {
            return c.verdicts ? static_cast<unsigned>((*c.verdicts).*Member) : 0u;
          },
          [](BoardConfig& c, unsigned value) {
            if (!c.verdicts) c.verdicts = FpFormat{0, 0};
            (*c.verdicts).*Member = static_cast<int>(value);
          }};
}

constexpr Field kFields[] = {
    field<&BoardConfig::lanes>("LANES"),
    {"EXP", [](const BoardConfig& c) { return static_cast<unsigned>(c.format.exp_bits); },
     [](BoardConfig& c, unsigned value) { c.format.exp_bits = static_cast<int>(value); }},
    {"MAN", [](const BoardConfig& c) { return static_cast<unsigned>(c.format.man_bits); },
     [](BoardConfig& c, unsigned value) { c.format.man_bits = static_cast<int>(value); }},
    {"PAIRS", pair_set, set_pairs},
    field<&BoardConfig::algorithm>("ALGORITHM"),
    field<&BoardConfig::box>("BOX"),
    field<&BoardConfig::swap>("SWAP"),
    field<&BoardConfig::normals>("NORMALS"),
    field<&BoardConfig::parallel>("PARALLEL"),
    field<&BoardConfig::facet_interval>("FACET_II"),
    verdict_field<&FpFormat::exp_bits>("VERDICT_EXP"),
    verdict_field<&FpFormat::man_bits>("VERDICT_MAN"),
    field<&BoardConfig::node_units>("NODE_UNITS"),
    field<&BoardConfig::nodes>("NODES"),
    field<&BoardConfig::ecc>("ECC"),
    field<&BoardConfig::transform>("TRANSFORM"),
    field<&BoardConfig::objects>("OBJECTS", Transformer::kSecondaries),
    field<&BoardConfig::primary_objects>("PRIM_OBJECTS", Transformer::kBoth),
    field<&BoardConfig::latency_add>("LAT_ADD"),
    field<&BoardConfig::latency_mul>("LAT_MUL"),
    field<&BoardConfig::latency_div>("LAT_DIV"),
    field<&BoardConfig::latency_sqrt>("LAT_SQRT"),
    field<&BoardConfig::latency_compare>("LAT_CMP"),
    field<&BoardConfig::ddr_slots>("DDR_SLOTS"),
    field<&BoardConfig::sram_records>("SRAM_RECORDS"),
    field<&BoardConfig::trace>("TRACE"),
};

}  // namespace

void tell_builds(bool tell) {
  BuildProgress::set_quiet(!tell);
}

void check(Arithmetic arithmetic) {
  if (arithmetic != Arithmetic::kHost && arithmetic != Arithmetic::kRtl)
    throw Error(ErrorCode::kUsage, fmt::format("there is no arithmetic {}; they are 0 and 1",
                                               static_cast<int>(arithmetic)));
}

void check_card_format(FpFormat format) {
  if (is_card_format(format)) return;
  std::string known;
  for (const FpFormat f : kPairFormats)
    if (is_card_format(f)) known += (known.empty() ? "" : ", ") + f.name();
  throw Error(
      ErrorCode::kUsage,
      format.width() > static_cast<int>(kCardWord)
          ? fmt::format("a card has no {}: the words of its buses, memories and records are "
                        "{} bits wide; its formats are {}",
                        format.name(), kCardWord, known)
          : fmt::format("a card has no {}; its formats are {}", format.name(), known));
}

void check_narrow_format(FpFormat narrow, FpFormat wide) {
  check_card_format(narrow);
  if (narrow.exp_bits > wide.exp_bits || narrow.man_bits >= wide.man_bits)
    throw Error(ErrorCode::kUsage,
                fmt::format("verdicts in {} cannot stand before {}: they need no more exponent "
                            "bits and fewer fraction bits, as fp16, bf16, tf32 and fp24 before "
                            "fp32, bf16 before tf32, fp16 before fp24",
                            narrow.name(), wide.name()));
}

namespace {

void check_verdicts(const BoardConfig& c) {
  if (!c.verdicts) return;
  check_narrow_format(*c.verdicts, c.format);
  if (std::none_of(c.pairs.begin(), c.pairs.end(), has_verdicts))
    throw Error(ErrorCode::kUsage,
                "verdicts are of sphere-sphere, sphere-obb, triangle-sphere, triangle-aabb, "
                "triangle-obb and obb-obb, of which the card has none");
  constexpr unsigned kMostLanes = 32;  // all of them share the one wide lane
  if (c.lanes > kMostLanes)
    throw Error(ErrorCode::kUsage,
                fmt::format("lanes is {}; with verdicts it must be 1 to {}", c.lanes, kMostLanes));
  if (c.facet_interval != 1)
    throw Error(ErrorCode::kUsage,
                fmt::format("with verdicts the facet interval is 1, not {}", c.facet_interval));
}

}  // namespace

namespace {

void check_hierarchy(const BoardConfig& c) {
  const auto require = [](bool ok, const std::string& why) {
    if (!ok) throw Error(ErrorCode::kUsage, why);
  };
  if (c.node_units == 0) {
    require(c.nodes == BoardConfig().nodes, "a card without node units has no memory of nodes");
    return;
  }
  constexpr unsigned kMostUnits = 4, kLeastNodes = 16, kMostNodes = 1u << 22;
  require(std::has_single_bit(c.node_units) && c.node_units <= kMostUnits,
          fmt::format("node_units is {}; it must be 0, 1, 2 or 4", c.node_units));
  require(std::has_single_bit(c.nodes) && c.nodes >= kLeastNodes && c.nodes <= kMostNodes,
          fmt::format("nodes is {}; it must be a power of two from {} to {}", c.nodes, kLeastNodes,
                      kMostNodes));
  require(c.format == FpFormat(),
          fmt::format("a hierarchy is of fp32, not of {}: its boxes are widened by 2^-16 of the "
                      "scene, which in a coarser format were percents of it",
                      c.format.name()));
  const bool walked = std::any_of(c.pairs.begin(), c.pairs.end(), [&c](Pair pair) {
    return c.way_through(pair, false).has_value();
  });
  require(walked,
          "a hierarchy is of rays, spheres, AABBs, OBBs and triangles, with the box rule, without "
          "which no tree answers as all secondaries do, or of ray-sphere and sphere-sphere; narrow "
          "lanes that prove misses have none");
}

}  // namespace

bool BoardConfig::box_rule(Pair pair) const {
  return box && has_box_rule(pair) && !(verdicts && has_verdicts(pair));
}

std::optional<WayThrough> BoardConfig::way_through(Pair pair, bool swapped) const {
  const bool there =
      (swap || !swapped) && (box || !has_box_rule(pair)) && !(verdicts && has_verdicts(pair));
  return there ? cde::way_through(pair, swapped) : std::nullopt;
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
  check_card_format(format);
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
  check_verdicts(*this);
  if (box && std::none_of(pairs.begin(), pairs.end(), has_box_rule))
    throw Error(
        ErrorCode::kUsage,
        "the box rule is of triangles with rays, spheres, AABBs, OBBs and triangles, and of OBBs "
        "with spheres and OBBs, of which the card has none");
  const BoardConfig standard;
  check_hierarchy(*this);
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
  for (const Field& field : kFields)
    if (transform >= field.since && field.get(*this) != field.get(standard))
      list.push_back(fmt::format("{}={}", field.name, field.get(*this)));
  return list;
}

std::optional<BoardConfig> BoardConfig::of(const std::vector<std::string>& parameters) try {
  BoardConfig config;
  std::set<std::string> seen;
  for (const std::string& parameter : parameters) {
    const std::size_t equals = std::min(parameter.find('='), parameter.size());
    const std::string name = parameter.substr(0, equals);
    const std::string_view value = std::string_view(parameter).substr(equals).substr(
        std::min<std::size_t>(1, parameter.size() - equals));
    if (!seen.insert(name).second) return std::nullopt;
    if (name == "ARITH" && (value == "host" || value == "rtl")) {
      config.arithmetic = value == "host" ? Arithmetic::kHost : Arithmetic::kRtl;
      continue;
    }
    const auto* field = std::find_if(std::begin(kFields), std::end(kFields),
                                     [&](const Field& f) { return name == f.name; });
    unsigned number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (field == std::end(kFields) || error != std::errc() || stop != value.data() + value.size())
      return std::nullopt;
    field->set(config, number);
    if (field->get(config) != number) return std::nullopt;
  }
  (void)config.parameters();
  return config;
} catch (const Error&) {
  return std::nullopt;
}

fs::path bitstream_cache() {
  return folders::make_cache();
}

fs::path bitstream_builder() {
  return folders::share() / "verilator/bitstream";
}

fs::path bitstream_path(const std::string& kind, const std::vector<std::string>& parameters) {
  return find_or_build(key_of(kind, parameters), kind, parameters);
}

BitstreamFile bitstream_file(const std::string& kind, const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  if (auto found = find_whole(key)) return {*found, true};
  return {folders::cache() / key.file, false};
}

std::vector<std::vector<std::string>> kept_bitstreams(const std::string& kind) {
  std::set<std::vector<std::string>> found;
  for (const fs::path& folder : places()) {
    std::error_code none;
    if (folders::distrust(folder)) continue;
    for (fs::directory_iterator entry(folder, none), end; entry != end; entry.increment(none)) {
      const fs::path& file = entry->path();
      if (!file.string().ends_with(".so.sha256") || folders::distrust(file)) continue;
      std::ifstream in(file);
      std::string line, word;
      std::getline(in, line);
      std::istringstream words(line);
      if (!(words >> word) || word != "#" || !(words >> word) || word != kind) continue;
      found.emplace(std::istream_iterator<std::string>(words),
                    std::istream_iterator<std::string>());
    }
  }
  return {found.begin(), found.end()};
}

std::uint64_t bitstream_hash(const std::string& kind, const std::vector<std::string>& parameters) {
  return key_of(kind, parameters).config_hash;
}

Bitstream Bitstream::open(const std::string& kind, const std::vector<std::string>& parameters) {
  const Key key = key_of(kind, parameters);
  const fs::path file = find_or_build(key, kind, parameters);
  try {
    return link(file, key.config_hash);
  } catch (const Error&) {
    // Damaged in a way that only the loader sees. A file in the cache is ours to replace.
    const fs::path cached = bitstream_cache() / key.file;
    const FileLock lock(fs::path(cached).replace_extension(".lock"), joined(kind, parameters));
    build(cached, kind, parameters);
    return link(cached, key.config_hash);
  }
}

Bitstream Bitstream::load(const fs::path& file, std::uint64_t config_hash) {
  if (!intact(file)) {
    throw Error(ErrorCode::kConfiguration,
                fmt::format("{} is not a bitstream (missing, cut short, or no shared library)",
                            printable_name(file.string())));
  }
  const fs::path whole = fs::absolute(file);
  for (const fs::path& part : {whole.parent_path(), whole}) {
    if (const auto why = folders::distrust(part))
      throw Error(ErrorCode::kFile,
                  fmt::format("{} is refused: {} {}", printable_name(file.string()),
                              printable_name(part.string()), *why));
  }
  if (fs::exists(checksum_file(file))) {
    if (const auto why = defect(file))
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("{} {}", printable_name(file.string()), *why));
  }
  return link(file, config_hash);
}

Bitstream Bitstream::link(const fs::path& file, std::uint64_t config_hash) {
  Bitstream result;
  result.path_ = fs::absolute(file);
  result.config_hash_ = config_hash;
  void* library = ::dlopen(result.path_.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw Error(ErrorCode::kConfiguration,
                printable_name(::dlerror()));  // NOLINT(concurrency-mt-unsafe)
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
    throw Error(ErrorCode::kConfiguration,
                fmt::format("{} exports no {}", printable_name(path_.string()), name));
  }
  return address;
}

}  // namespace cde
