// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The header of a NumPy array (.npy). Private to the library.
namespace cde::io {

inline constexpr std::string_view kArrayMark("\x93NUMPY", 6);

/// What a number is: 'f' of 2, 4 or 8 bytes, 'i' or 'u' of 1, 2, 4 or 8.
struct NumberType {
  char kind = 'f';
  unsigned bytes = 4;
  bool big_endian = false;
};

/// Numbers side by side in an element.
struct ArrayField {
  std::string name;  ///< empty for an array that is no structure
  NumberType type;
  std::uint64_t count = 1;   ///< of the numbers
  std::uint64_t offset = 0;  ///< in the element, bytes
};

struct ArrayHeader {
  std::vector<ArrayField> fields;
  bool structured = false, fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t element_bytes = 0;
  std::uint64_t elements = 0;  ///< product of the shape
  std::uint64_t data = 0;      ///< where the elements begin in the file
};

/// The header of `bytes`, all of a file. `name` is the file's for messages, `expected` what would
/// be read. Error kFile for another file, another type and data of another size.
[[nodiscard]] ArrayHeader read_array_header(std::string_view bytes, const std::string& name,
                                            const std::string& expected);

/// "(3, 6)".
[[nodiscard]] std::string shape_text(const std::vector<std::uint64_t>& shape);

}  // namespace cde::io
