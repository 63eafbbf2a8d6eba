// SPDX-License-Identifier: Apache-2.0
#include "cde/io/npy.hpp"

#include <fmt/format.h>

#include <limits>

#include "io/array_header.hpp"

namespace cde {

std::string npy_header(std::string_view type, const std::vector<std::uint64_t>& shape,
                       bool may_grow) {
  const bool named = type.starts_with('[');
  std::string header = fmt::format("{{'descr': {0}{1}{0}, 'fortran_order': False, 'shape': {2}, }}",
                                   named ? "" : "'", type, io::shape_text(shape));
  constexpr std::size_t kMostDigits = std::numeric_limits<std::uint64_t>::digits10 + 1;
  if (may_grow) header.append(kMostDigits - fmt::formatted_size("{}", shape.at(0)), ' ');
  // Data begin at a multiple of 64 bytes, after a line feed.
  header.append(63 - (io::kArrayMark.size() + 4 + header.size()) % 64, ' ').push_back('\n');
  std::string all(io::kArrayMark);
  all += {'\x01', '\x00', static_cast<char>(header.size() & 0xff),
          static_cast<char>(header.size() >> 8)};
  return all + header;
}

}  // namespace cde
