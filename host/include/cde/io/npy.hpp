// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// @file
/// NumPy array files: format 1.0, little endian as every host of this project.
namespace cde {

/// Everything before the data. `type` is a type string ("<f4") or a list of fields in brackets.
/// With `may_grow` the header has the same size for every length of the first axis.
[[nodiscard]] std::string npy_header(std::string_view type, const std::vector<std::uint64_t>& shape,
                                     bool may_grow = false);

}  // namespace cde
