// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

/// Files of numpy.save, numpy.savez and numpy.savez_compressed, byte by byte.
namespace cde::testing {

/// `type` in the form of descr, with its quotes.
inline std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                       const std::string& fortran = "False", int version = 1) {
  std::string header =
      fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}", type, fortran, shape);
  header.append(63 - (10 + header.size()) % 64, ' ').push_back('\n');
  std::string file("\x93NUMPY", 6);
  file += {static_cast<char>(version), '\0', static_cast<char>(header.size() & 0xff),
           static_cast<char>(header.size() >> 8)};
  if (version > 1) file.append(2, '\0');
  return file + header + data;
}

template <class T>
std::string bytes(std::vector<T> values, bool big_endian = false) {
  std::string all;
  for (const T& value : values) {
    char one[sizeof(T)];
    std::memcpy(one, &value, sizeof(T));
    if (big_endian) std::reverse(one, one + sizeof(T));
    all.append(one, sizeof(T));
  }
  return all;
}

inline std::string word(std::uint64_t value, unsigned size) {
  std::string bytes;
  for (unsigned i = 0; i < size; ++i) bytes.push_back(static_cast<char>(value >> 8 * i));
  return bytes;
}

struct ZipFile {
  std::string name, contents;
};

/// Each file's sizes are in its 64-bit field before the content, as numpy requires.
inline std::string npz(const std::vector<ZipFile>& files, bool deflated = false) {
  std::string archive, list;
  for (const ZipFile& file : files) {
    std::string packed = file.contents;
    if (deflated) {
      z_stream stream{};
      deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
      packed.resize(deflateBound(&stream, static_cast<uLong>(file.contents.size())));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.contents.data()));
      stream.avail_in = static_cast<uInt>(file.contents.size());
      stream.next_out = reinterpret_cast<Bytef*>(packed.data());
      stream.avail_out = static_cast<uInt>(packed.size());
      deflate(&stream, Z_FINISH);
      packed.resize(stream.total_out);
      deflateEnd(&stream);
    }
    const auto crc =
        crc32_z(0, reinterpret_cast<const Bytef*>(file.contents.data()), file.contents.size());
    const std::string common =
        word(45, 2) + word(0, 2) + word(deflated ? 8 : 0, 2) + word(0, 4) + word(crc, 4);
    list += "PK\x01\x02" + word(45, 2) + common + word(packed.size(), 4) +
            word(file.contents.size(), 4) + word(file.name.size(), 2) + word(0, 12) +
            word(archive.size(), 4) + file.name;
    archive += "PK\x03\x04" + common + word(0xffffffff, 4) + word(0xffffffff, 4) +
               word(file.name.size(), 2) + word(20, 2) + file.name + word(1, 2) + word(16, 2) +
               word(file.contents.size(), 8) + word(packed.size(), 8) + packed;
  }
  return archive + list + "PK\x05\x06" + word(0, 4) + word(files.size(), 2) +
         word(files.size(), 2) + word(list.size(), 4) + word(archive.size(), 4) + word(0, 2);
}

}  // namespace cde::testing
