// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Arrays of NumPy as they are written: format 1.0, little endian as every host of this project.
namespace cde {

/// All before the data; `type` is a type string ("<f4") or a list of fields in brackets.
[[nodiscard]] std::string npy_header(std::string_view type,
                                     const std::vector<std::uint64_t>& shape);

}  // namespace cde
