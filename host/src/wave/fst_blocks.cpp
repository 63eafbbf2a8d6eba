// SPDX-License-Identifier: Apache-2.0
#include "wave/fst_blocks.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "cde/wave/fst_api.hpp"
#include "gtkwave/lz4.h"

namespace cde::wave {
namespace {

/// zlib expands at most 1032 times; LZ4 and FastLZ expand less.
constexpr std::uint64_t kMostExpansion = 1100;

/// Most bytes of unpacked names. Their full names have the same limit (trace.cpp).
std::uint64_t most_names(std::uint64_t file_bytes) {
  return (std::uint64_t{256} << 20) + 64 * file_bytes;
}

/// A read-only memory-mapped file.
class Mapped {
 public:
  explicit Mapped(const WaveBytes& file) : file_(file), size_(file.size()) {
    if (size_ != 0) data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
    if (data_ == MAP_FAILED) fail("cannot be mapped into memory");
  }
  ~Mapped() {
    if (data_ != nullptr) ::munmap(data_, size_);
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
  [[noreturn]] void fail(const std::string& what) const { file_.fail(what); }
  [[noreturn]] void corrupt(std::uint64_t block, const std::string& what) const {
    fail(fmt::format("is corrupt: the block at byte {} {}", block, what));
  }

 private:
  const WaveBytes& file_;
  void* data_ = nullptr;
  std::uint64_t size_ = 0;
};

/// Reads a number of seven bits per byte, which ends before `stop`.
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

bool is_changes(int type) {
  return type == FST_BL_VCDATA || type == FST_BL_VCDATA_DYN_ALIAS ||
         type == FST_BL_VCDATA_DYN_ALIAS2;
}

/// Whether the header is not written yet. libfstwriter (Verilator since 5.050) leaves a hole there
/// and fills it when the file is closed.
bool is_headless(const Mapped& file) {
  return file.size() > kFstHeaderBytes && is_changes(file.bytes()[kFstHeaderBytes]) &&
         std::all_of(file.bytes(), file.bytes() + kFstHeaderBytes,
                     [](unsigned char c) { return c == 0; });
}

/// Error kFile if the first block is not a complete header.
void check_header(const Mapped& file) {
  if (file.size() < kFstHeaderBytes)
    file.fail(fmt::format("is cut off: {} bytes are not a complete FST header", file.size()));
  if (file.word(1) != kFstHeaderBytes - 1)
    file.fail("is not an FST file: it does not begin with an FST header");
  double value = 0;
  std::memcpy(&value, file.bytes() + 25, sizeof value);
  if (value != kFstByteOrder)
    file.fail("is not an FST file for this kind of machine: its header has an unexpected value");
}

/// Checks the places and lengths of the signals' changes in a block.
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
                      const std::vector<std::uint32_t>& widths) {
  const std::uint64_t handles = widths.size();
  const std::uint64_t end = block + 1 + length;
  if (length < 8 + 24 + 8 + 24 + 4) file.corrupt(block, "is too short");
  const Section section{file.word(block + 9), file.word(block + 17)};
  if (section.begin > section.end) file.corrupt(block, "ends before it begins");
  // Signals with equal changes share bytes in the file, but not in the memory of the reader.
  const std::uint64_t share = std::max<std::uint64_t>(handles, 1);
  if (file.word(block + 25) / share > kMostExpansion * length + 65536)
    file.corrupt(block, "claims an impossible size");
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
  std::uint64_t values = 0;
  for (std::uint64_t i = 0; i < frame_signals; ++i) values += widths[i];
  if (frame_large != values) file.corrupt(block, "has values that do not fit the signals");
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
      file.word(block + 9) > most_names(file.size()))
    file.corrupt(block, "has names that do not fit");
}

std::vector<Blackout> read_blackouts(const Mapped& file, std::uint64_t block, std::uint64_t length,
                                     std::uint64_t last) {
  const std::uint64_t end = block + 1 + length;
  std::uint64_t at = block + 9, time = 0;
  const std::uint64_t count = varint(file, block, at, end);
  if (count > length / 2) file.corrupt(block, "has more $dumpoff times than bytes");
  std::vector<Blackout> all;
  bool off = false;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (at >= end) file.corrupt(block, "is too short");
    const bool active = file.bytes()[at++] != 0;
    time += varint(file, block, at, end);
    if (!active && !off) all.push_back({time, std::max(time, last)});
    if (active && off) all.back().to = time;
    off = !active;
  }
  return all;
}

/// Memory that is only touched where it is written.
std::unique_ptr<char[]> names_buffer(const WaveBytes& file, std::uint64_t size) {
  if (size > most_names(file.size()))
    file.fail(fmt::format("has names of {} bytes; at most {} may be in a file of {} bytes", size,
                          most_names(file.size()), file.size()));
  return std::unique_ptr<char[]>(new char[size]);
}

/// One step of LZ4, which must produce exactly `size` bytes.
std::unique_ptr<char[]> unpack_names(const WaveBytes& file, std::uint64_t block, const char* from,
                                     std::uint64_t count, std::uint64_t size) {
  if (size > 256 * count + 64 || size > INT32_MAX || count > INT32_MAX)
    file.fail(fmt::format("is corrupt: the block at byte {} has names that do not fit", block));
  auto to = names_buffer(file, size);
  if (LZ4_decompress_safe(from, to.get(), static_cast<int>(count), static_cast<int>(size)) !=
      static_cast<int>(size))
    file.fail(fmt::format("is corrupt: names in the block at byte {} cannot be unpacked", block));
  return to;
}

}  // namespace

std::uint64_t FstBlocks::word(std::size_t at) const {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value = value << 8 | static_cast<unsigned char>(header[at + i]);
  return value;
}

std::vector<FstBlock> FstBlocks::changes() const {
  std::vector<FstBlock> found;
  for (const FstBlock& b : blocks)
    if (is_changes(b.type)) found.push_back(b);
  return found;
}

const FstBlock* FstBlocks::find(int type, int other, int third) const {
  for (const FstBlock& b : blocks)
    if (b.type == type || b.type == other || b.type == third) return &b;
  return nullptr;
}

bool has_fst_header(const WaveBytes& bytes) {
  std::string head(9, '\0');
  return bytes.read(0, head.data(), head.size()) == head.size() &&
         head == std::string("\0\0\0\0\0\0\0\x01\x49", 9);
}

FstBlocks find_fst_blocks(const WaveBytes& bytes) {
  const Mapped file(bytes);
  FstBlocks found;
  found.headless = is_headless(file);
  if (!found.headless) check_header(file);
  found.header.assign(kFstHeaderBytes, '\0');
  if (!found.headless)
    found.header.assign(reinterpret_cast<const char*>(file.bytes()), kFstHeaderBytes);
  found.structure.bytes = file.size();
  found.closed = found.word(9) != 0 || found.word(17) != 0 || found.handles() != 0;
  std::uint64_t at = kFstHeaderBytes;
  while (at < file.size()) {
    if (file.size() - at < 9) {
      if (!found.closed) break;
      file.fail(fmt::format("is cut off after byte {}", at));
    }
    const FstBlock b{file.bytes()[at], at, file.word(at + 1)};
    if (b.type == FST_BL_SKIP) {
      found.closed = false;  // an unfinished block
      break;
    }
    if (b.length < 8 || b.length > file.size() - at - 1) {
      if (!found.closed) break;
      file.fail(fmt::format("is cut off or corrupt: the block at byte {} has {} bytes, the file {}",
                            at, b.length, file.size()));
    }
    if (b.type == FST_BL_HDR) file.corrupt(at, "is a second header");
    if (b.type > FST_BL_VCDATA_DYN_ALIAS2)
      file.corrupt(at, fmt::format("has the unknown kind {}", b.type));
    found.blocks.push_back(b);
    at += 1 + b.length;
  }
  found.whole = at;
  found.structure.closed = found.closed;
  return found;
}

void check_fst_blocks(const WaveBytes& bytes, FstBlocks& found,
                      const std::vector<std::uint32_t>& widths) {
  const Mapped file(bytes);
  std::uint64_t bits = 0;
  for (const std::uint32_t width : widths) bits += width;
  // A complete file has a packed value of each signal.
  const std::uint64_t most = kBitsOfSmallFiles + kMostExpansion * file.size();
  if (bits > most)
    file.fail(
        fmt::format("has signals of {} bits together; expected at most {} in a file of {} "
                    "bytes",
                    bits, most, file.size()));
  for (const FstBlock& b : found.changes())
    found.structure.sections.push_back(check_changes(file, b.at, b.length, widths));
  std::uint64_t last = found.word(17);
  for (const Section& s : found.structure.sections) last = std::max(last, s.end);
  for (const FstBlock& b : found.blocks)
    if (b.type == FST_BL_BLACKOUT)
      for (const Blackout& off : read_blackouts(file, b.at, b.length, last))
        found.blackouts.push_back(off);
}

std::uint64_t first_fst_time(const WaveBytes& bytes, const FstBlock& block) {
  const Mapped file(bytes);
  const std::uint64_t end = block.at + 1 + block.length;
  const std::uint64_t large = file.word(end - 24), packed = file.word(end - 16);
  const unsigned char* const data = file.bytes() + end - 24 - packed;
  constexpr std::size_t kMostBytes = 10;  // per number
  std::array<unsigned char, kMostBytes> first{};
  if (packed == large) {
    std::copy_n(data, std::min<std::uint64_t>(packed, kMostBytes), first.data());
  } else {
    z_stream z{};
    if (::inflateInit(&z) != Z_OK) file.corrupt(block.at, "has times that cannot be unpacked");
    z.next_in = const_cast<unsigned char*>(data);
    z.avail_in = static_cast<uInt>(std::min<std::uint64_t>(packed, UINT32_MAX));
    z.next_out = first.data();
    z.avail_out = kMostBytes;
    const int status = ::inflate(&z, Z_SYNC_FLUSH);
    ::inflateEnd(&z);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      file.corrupt(block.at, "has times that cannot be unpacked");
  }
  std::uint64_t time = 0;
  for (std::size_t i = 0; i < kMostBytes; ++i) {
    time |= std::uint64_t{first[i] & 0x7fu} << 7 * i;
    if ((first[i] & 0x80u) == 0) break;
  }
  return time;
}

FstWidths read_fst_widths(const WaveBytes& bytes, const FstBlocks& found) {
  const Mapped file(bytes);
  const FstBlock* const b = found.find(FST_BL_GEOM);
  if (b == nullptr) file.fail("is cut off or corrupt: it has no widths");
  check_geometry(file, b->at, b->length, found.handles());
  const std::uint64_t packed = b->length - 24, large = file.word(b->at + 9);
  const auto* data = file.bytes() + b->at + 25;
  std::vector<unsigned char> unpacked;
  if (packed != large) {
    unpacked.resize(large);
    uLongf size = large;
    if (::uncompress(unpacked.data(), &size, data, packed) != Z_OK || size != large)
      file.corrupt(b->at, "has widths that cannot be unpacked");
    data = unpacked.data();
  }
  FstWidths all;
  const unsigned char* const stop = data + large;
  for (std::uint64_t i = 0; i < found.handles(); ++i) {
    std::uint64_t value = 0;
    bool more = true;
    for (unsigned shift = 0; more && shift < 35; shift += 7) {
      if (data == stop) file.corrupt(b->at, "has too few widths");
      value |= std::uint64_t{*data & 0x7fu} << shift;
      more = (*data++ & 0x80u) != 0;
    }
    if (more || value > UINT32_MAX) file.corrupt(b->at, "has an invalid width");
    all.real.push_back(value == 0);
    all.bytes.push_back(value == 0            ? 8
                        : value == UINT32_MAX ? 0
                                              : static_cast<std::uint32_t>(value));
  }
  return all;
}

std::string fst_widths_block(const FstWidths& widths) {
  std::string data;
  for (std::size_t i = 0; i < widths.bytes.size(); ++i) {
    std::uint32_t value = widths.real[i] ? 0 : widths.bytes[i] == 0 ? UINT32_MAX : widths.bytes[i];
    for (; value >= 0x80; value >>= 7) data.push_back(static_cast<char>((value & 0x7f) | 0x80));
    data.push_back(static_cast<char>(value));
  }
  std::string block(1, static_cast<char>(FST_BL_GEOM));
  const auto put = [&](std::uint64_t word) {
    for (unsigned i = 8; i-- > 0;) block.push_back(static_cast<char>(word >> (8 * i)));
  };
  put(data.size() + 24);
  put(data.size());
  put(widths.bytes.size());
  return block + data;
}

std::string read_fst_names(const WaveBytes& bytes, const FstBlock& b) {
  const Mapped file(bytes);
  check_hierarchy(file, b.at, b.length);
  const std::uint64_t size = file.word(b.at + 9);
  const std::uint64_t end = b.at + 1 + b.length;
  std::uint64_t at = b.at + 17;
  const auto data = [&] { return reinterpret_cast<const char*>(file.bytes() + at); };
  if (b.type == FST_BL_HIER) {
    const WaveBytes all = bytes.inflated(at, size);
    std::string text(size, '\0');
    text.resize(all.read(0, text.data(), size));
    return text;
  }
  if (b.type == FST_BL_HIER_LZ4)
    return {unpack_names(bytes, b.at, data(), end - at, size).get(), size};
  const std::uint64_t first = varint(file, b.at, at, end);
  const auto once = unpack_names(bytes, b.at, data(), end - at, first);
  return {unpack_names(bytes, b.at, once.get(), first, size).get(), size};
}

}  // namespace cde::wave
