// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/structure.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

/// zlib expands at most 1032 times, LZ4 and FastLZ less.
constexpr std::uint64_t kMostExpansion = 1100;
constexpr std::uint64_t kHeaderLength = 329;

/// A file in memory, read only.
class Mapped {
 public:
  explicit Mapped(const std::filesystem::path& file) : name_(printable_name(file.string())) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (fd < 0 || ::fstat(fd, &status) != 0) {
      const std::string why = std::strerror(errno);  // NOLINT(concurrency-mt-unsafe)
      if (fd >= 0) ::close(fd);
      throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read: {}", name_, why));
    }
    if (!S_ISREG(status.st_mode)) {
      ::close(fd);
      fail("is no regular file; waves are read from one");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
    if (size_ != 0) data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fd, 0);
    ::close(fd);
    if (data_ == MAP_FAILED) fail("cannot be mapped into memory");
  }
  ~Mapped() {
    if (data_ != nullptr && data_ != MAP_FAILED) ::munmap(data_, size_);
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const unsigned char* bytes() const {
    return static_cast<const unsigned char*>(data_);
  }
  [[nodiscard]] std::uint64_t word(std::uint64_t at) const {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < 8; ++i) value = value << 8 | bytes()[at + i];
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", name_, what));
  }
  [[noreturn]] void corrupt(std::uint64_t block, const std::string& what) const {
    fail(fmt::format("is corrupt: the block at byte {} {}", block, what));
  }

 private:
  std::string name_;
  void* data_ = nullptr;
  std::uint64_t size_ = 0;
};

/// A number of seven bits a byte, which ends before `stop`.
std::uint64_t varint(const Mapped& file, std::uint64_t block, std::uint64_t& at,
                     std::uint64_t stop) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    if (at >= stop) break;
    const unsigned char byte = file.bytes()[at++];
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if ((byte & 0x80u) == 0) return value;
  }
  file.corrupt(block, "has a number without an end");
}

/// What no FST begins with is told apart, so that the message says what it is.
void check_kind(const Mapped& file) {
  if (file.size() == 0) file.fail("is empty; it must be an FST file");
  const auto* const b = file.bytes();
  if (b[0] == FST_BL_ZWRAPPER && file.size() > 17 && file.word(1) <= file.size())
    file.fail(
        "is an FST that is packed in gzip as a whole, which is not read here; "
        "`fst2vcd FILE | vcd2fst - OTHER` unpacks it");
  if (b[0] == FST_BL_HDR && file.size() < kHeaderLength + 1)
    file.fail(fmt::format("is cut off: {} bytes are no whole header of an FST", file.size()));
  if (b[0] == FST_BL_HDR && file.word(1) == kHeaderLength) return;
  if (b[0] == '$' || (b[0] == '#' && file.size() > 1))
    file.fail("is text, perhaps VCD, and no FST; `vcd2fst FILE OTHER` makes one of a VCD file");
  file.fail("is no FST file: it does not begin with the header of one");
}

/// Number of signals with values.
std::uint64_t check_header(const Mapped& file) {
  constexpr double kEnd = 2.7182818284590452354;
  double value = 0;
  std::memcpy(&value, file.bytes() + 25, sizeof value);
  if (value != kEnd)
    file.fail("is no FST file of this kind of machine: its header is not as it must be");
  return file.word(57);
}

/// Places and lengths of the signals' changes in a block.
void check_chains(const Mapped& file, std::uint64_t block, std::uint64_t at, std::uint64_t stop,
                  std::uint64_t most, std::uint64_t room) {
  const bool second = file.bytes()[block] == FST_BL_VCDATA_DYN_ALIAS2;
  std::uint64_t signals = 0, place = 0;
  const auto advance = [&](std::uint64_t by) {
    if (by > room || place > room - by) file.corrupt(block, "has changes outside of it");
    place += by;
  };
  while (at < stop) {
    const bool odd = (file.bytes()[at] & 1u) != 0;
    if (second && odd) {
      std::uint64_t begin = at;
      const std::uint64_t raw = varint(file, block, at, stop);
      const auto bits = static_cast<unsigned>(7 * (at - begin));
      const bool negative = bits < 64 && ((raw >> (bits - 1)) & 1u) != 0;
      if (!negative) advance(raw >> 1);
      ++signals;
    } else {
      const std::uint64_t value = varint(file, block, at, stop);
      if (!second && value == 0) {
        (void)varint(file, block, at, stop);
        ++signals;
      } else if (odd) {
        advance(value >> 1);
        ++signals;
      } else {
        if (value >> 1 > most) file.corrupt(block, "has more signals than the file");
        signals += value >> 1;
      }
    }
    if (signals > most) file.corrupt(block, "has more signals than the file");
  }
}

Section check_changes(const Mapped& file, std::uint64_t block, std::uint64_t length,
                      std::uint64_t handles) {
  const std::uint64_t end = block + 1 + length;
  if (length < 8 + 24 + 8 + 24 + 4) file.corrupt(block, "is too short");
  const Section section{file.word(block + 9), file.word(block + 17)};
  if (section.begin > section.end) file.corrupt(block, "ends before it begins");
  if (file.word(block + 25) > kMostExpansion * length + 65536)
    file.corrupt(block, "says that it is larger than it can be");
  const std::uint64_t times_large = file.word(end - 24), times = file.word(end - 16),
                      count = file.word(end - 8);
  const std::uint64_t inner = length - 8 - 24 - 24 - 8;
  if (times > inner || times_large > kMostExpansion * times + 64 || count > times_large ||
      count == 0)
    file.corrupt(block, "has times that do not fit");
  const std::uint64_t table = file.word(end - 24 - times - 8);
  if (table == 0 || table > inner - times) file.corrupt(block, "has a table that does not fit");
  const std::uint64_t table_at = end - 24 - times - 8 - table;
  std::uint64_t at = block + 33;
  const std::uint64_t frame_large = varint(file, block, at, table_at),
                      frame = varint(file, block, at, table_at),
                      frame_signals = varint(file, block, at, table_at);
  if (frame > table_at - at || frame_large > kMostExpansion * frame + 64 || frame_signals > handles)
    file.corrupt(block, "has values that do not fit");
  at += frame;
  const std::uint64_t signals = varint(file, block, at, table_at);
  if (signals > handles || at >= table_at) file.corrupt(block, "has signals that do not fit");
  check_chains(file, block, table_at, table_at + table, signals, table_at - at);
  return section;
}

void check_geometry(const Mapped& file, std::uint64_t block, std::uint64_t length,
                    std::uint64_t handles) {
  if (length < 24) file.corrupt(block, "is too short");
  const std::uint64_t large = file.word(block + 9), signals = file.word(block + 17);
  if (large > kMostExpansion * (length - 24) + 64 || signals > large || signals != handles)
    file.corrupt(block, "has widths that do not fit");
}

void check_hierarchy(const Mapped& file, std::uint64_t block, std::uint64_t length) {
  if (length < 17 || file.word(block + 9) > kMostExpansion * kMostExpansion * (length - 16) ||
      file.word(block + 9) > std::uint64_t{1} << 32)
    file.corrupt(block, "has names that do not fit");
}

}  // namespace

Structure check_structure(const std::filesystem::path& path) {
  const Mapped file(path);
  check_kind(file);
  Structure found;
  found.bytes = file.size();
  std::uint64_t handles = check_header(file);
  found.closed = file.word(9) != 0 || file.word(17) != 0 || handles != 0;
  bool names = false, widths = false;
  for (std::uint64_t block = 0; block < file.size();) {
    if (file.size() - block < 9) file.fail(fmt::format("is cut off after byte {}", block));
    const int type = file.bytes()[block];
    const std::uint64_t length = file.word(block + 1);
    if (type == FST_BL_SKIP) {
      found.closed = false;  // a block that was being written
      break;
    }
    if (length < 8 || length > file.size() - block - 1) {
      if (!found.closed) break;
      file.fail(fmt::format("is cut off or corrupt: the block at byte {} has {} bytes, the file {}",
                            block, length, file.size()));
    }
    switch (type) {
      case FST_BL_VCDATA:
      case FST_BL_VCDATA_DYN_ALIAS:
      case FST_BL_VCDATA_DYN_ALIAS2:
        found.sections.push_back(check_changes(file, block, length, handles));
        break;
      case FST_BL_GEOM:
        check_geometry(file, block, length, handles);
        widths = true;
        break;
      case FST_BL_HIER:
      case FST_BL_HIER_LZ4:
      case FST_BL_HIER_LZ4DUO:
        check_hierarchy(file, block, length);
        names = true;
        break;
      case FST_BL_HDR:
        if (block != 0) file.corrupt(block, "is a second header");
        break;
      case FST_BL_BLACKOUT:
        break;
      default:
        file.corrupt(block, fmt::format("is of kind {}, which there is not", type));
    }
    block += 1 + length;
  }
  if (!found.closed)
    file.fail(
        "has no changes, or was not closed by its writer: the simulation still runs, or was "
        "killed");
  if (!names || !widths || found.sections.empty())
    file.fail(fmt::format("is cut off or corrupt: it has no {}", !names    ? "names"
                                                                 : !widths ? "widths"
                                                                           : "changes"));
  return found;
}

}  // namespace cde::wave
