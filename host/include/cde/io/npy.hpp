// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Arrays of NumPy as they are written: format 1.0, little endian as every host of this project.
namespace cde {

/// All before the data; `type` is a type string ("<f4") or a list of fields in brackets. If the
/// array may grow, the header has room for a first axis of any length: it has as many bytes for
/// every length.
[[nodiscard]] std::string npy_header(std::string_view type, const std::vector<std::uint64_t>& shape,
                                     bool may_grow = false);

}  // namespace cde
