// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The header of a NumPy array (.npy). Private to the library.
namespace cde::io {

inline constexpr std::string_view kArrayMark("\x93NUMPY", 6);

/// A number's kind and size: 'f' of 2, 4 or 8 bytes, or 'i' or 'u' of 1, 2, 4 or 8 bytes.
struct NumberType {
  char kind = 'f';
  unsigned bytes = 4;
  bool big_endian = false;
};

/// A group of numbers in an element.
struct ArrayField {
  std::string name;  ///< empty if the array has no structure
  NumberType type;
  std::uint64_t count = 1;   ///< how many numbers
  std::uint64_t offset = 0;  ///< in the element, in bytes
};

struct ArrayHeader {
  std::vector<ArrayField> fields;
  bool structured = false, fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t element_bytes = 0;
  std::uint64_t elements = 0;  ///< product of the shape
  std::uint64_t data = 0;      ///< offset of the elements in the file
};

/// Reads the header; `bytes` is the whole file. `name` is the file's name and `expected` the
/// accepted content, both for messages. Error kFile for another kind of file, an unsupported type,
/// or data of the wrong size.
[[nodiscard]] ArrayHeader read_array_header(std::string_view bytes, const std::string& name,
                                            const std::string& expected);

/// "(3, 6)".
[[nodiscard]] std::string shape_text(const std::vector<std::uint64_t>& shape);

}  // namespace cde::io
