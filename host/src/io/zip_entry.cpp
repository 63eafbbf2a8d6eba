// SPDX-License-Identifier: Apache-2.0
#include "io/zip_entry.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::io {
namespace {

constexpr std::uint64_t kShort = 0xffff, kLong = 0xffffffff;  // "see the 64-bit fields"

struct Entry {
  std::string name;
  std::uint64_t flags = 0, method = 0, crc = 0, packed = 0, size = 0, offset = 0;
};

/// Little-endian fields of the archive, checked to be within its bytes.
class Archive {
 public:
  Archive(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kFile, fmt::format("{}: {}", name_, why));
  }
  [[nodiscard]] std::string_view part(std::uint64_t at, std::uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
      fail("the archive is damaged or truncated");
    return bytes_.substr(at, size);
  }
  [[nodiscard]] std::uint64_t number(std::uint64_t at, unsigned size) const {
    const std::string_view field = part(at, size);
    std::uint64_t value = 0;
    for (unsigned i = 0; i < size; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(field[i])} << 8 * i;
    return value;
  }

  /// The archive's central directory.
  [[nodiscard]] std::vector<Entry> entries() const {
    const std::size_t end = bytes_.rfind("PK\x05\x06");
    if (end == std::string_view::npos) fail("the archive is damaged or truncated: it has no end");
    std::uint64_t count = number(end + 10, 2), at = number(end + 16, 4);
    if (count == kShort || at == kLong) {
      if (end < 20 || part(end - 20, 4) != "PK\x06\x07") fail("the archive's end is damaged");
      const std::uint64_t long_end = number(end - 12, 8);
      if (part(long_end, 4) != "PK\x06\x06") fail("the archive's end is damaged");
      count = number(long_end + 32, 8);
      at = number(long_end + 48, 8);
    }
    std::vector<Entry> all;
    for (std::uint64_t i = 0; i < count; ++i) all.push_back(entry(at));
    return all;
  }

  [[nodiscard]] std::string_view packed(const Entry& e) const {
    if (part(e.offset, 4) != kZipMark) fail("the archive's list of files is damaged");
    return part(e.offset + 30 + number(e.offset + 26, 2) + number(e.offset + 28, 2), e.packed);
  }

 private:
  /// The entry at `at`, which then points behind the entry.
  [[nodiscard]] Entry entry(std::uint64_t& at) const {
    if (part(at, 4) != "PK\x01\x02") fail("the archive's list of files is damaged");
    const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2);
    Entry e{.name = std::string(part(at + 46, name)),
            .flags = number(at + 8, 2),
            .method = number(at + 10, 2),
            .crc = number(at + 16, 4),
            .packed = number(at + 20, 4),
            .size = number(at + 24, 4),
            .offset = number(at + 42, 4)};
    const std::uint64_t first = at + 46 + name;
    (void)part(first, extra);
    for (std::uint64_t field = first; field + 4 <= first + extra;
         field += 4 + number(field + 2, 2)) {
      if (number(field, 2) != 1) continue;  // not the 64-bit field
      std::uint64_t value = field + 4;
      for (std::uint64_t* const small : {&e.size, &e.packed, &e.offset})
        if (*small == kLong) *small = number(value, 8), value += 8;
    }
    at = first + extra + number(at + 32, 2);
    return e;
  }

  std::string_view bytes_;
  const std::string& name_;
};

std::string inflated(const Archive& archive, std::string_view packed, std::uint64_t size) {
  // zlib expands at most 1032 times. So a larger claim is refused before memory is taken.
  if (size / 1032 > packed.size() + 1)
    archive.fail("an array in it claims to be larger than it is");
  constexpr std::uint64_t kLeast = 512u << 20, kPerByte = 64;  // as for meshes
  if (size > kLeast + kPerByte * packed.size())
    archive.fail(
        fmt::format("an array in it has {} bytes, over {} times its packed size; expected "
                    "at most {} MB and {} times the packed size: unpack the file first",
                    size, kPerByte, kLeast >> 20, kPerByte));
  std::string bytes(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) archive.fail("zlib does not start");
  constexpr std::size_t kMost = std::size_t{1} << 30;
  std::size_t in = 0, out = 0;
  int status = Z_OK;
  char none = 0;
  while (status == Z_OK) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + in));
    stream.avail_in = static_cast<uInt>(std::min(kMost, packed.size() - in));
    stream.next_out = reinterpret_cast<Bytef*>(out < size ? bytes.data() + out : &none);
    stream.avail_out = static_cast<uInt>(std::min<std::size_t>(kMost, size - out));
    const uInt had_in = stream.avail_in, had_out = stream.avail_out;
    status = inflate(&stream, Z_NO_FLUSH);
    in += had_in - stream.avail_in;
    out += had_out - stream.avail_out;
    if (status == Z_OK && had_in == stream.avail_in && had_out == stream.avail_out) break;
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END || out != size) archive.fail("an array in it is damaged or truncated");
  return bytes;
}

}  // namespace

std::string only_array(std::string_view bytes, const std::string& name,
                       const std::string& expected) {
  const Archive archive(bytes, name);
  std::vector<Entry> entries = archive.entries();
  std::erase_if(entries, [](const Entry& e) { return e.name.ends_with('/'); });
  if (entries.size() != 1) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(entries.size(), 8); ++i)
      names.push_back(in_quotes(entries[i].name));
    archive.fail(fmt::format(
        "{}; expected an .npz file with one array: {}",
        names.empty() ? "has no array"
                      : fmt::format("has {} files, {}{}", entries.size(), fmt::join(names, ", "),
                                    names.size() < entries.size() ? ", ..." : ""),
        expected));
  }
  const Entry& e = entries.front();
  if (!e.name.ends_with(".npy"))
    archive.fail(fmt::format("{} in it is not an array (.npy)", in_quotes(e.name)));
  if ((e.flags & 1) != 0) archive.fail("the array in it is encrypted");
  if (e.method != 0 && e.method != 8)
    archive.fail(
        fmt::format("the array in it is compressed by method {}; expected stored (numpy.savez) or "
                    "deflated (numpy.savez_compressed)",
                    e.method));
  const std::string_view packed = archive.packed(e);
  if (e.method == 0 && e.size != e.packed) archive.fail("the array in it has two sizes");
  std::string array = e.method == 0 ? std::string(packed) : inflated(archive, packed, e.size);
  if (crc32_z(0, reinterpret_cast<const Bytef*>(array.data()), array.size()) != e.crc)
    archive.fail("the array in it is damaged: its checksum differs");
  return array;
}

}  // namespace cde::io
