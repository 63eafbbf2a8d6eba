// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"

/// Arrays of NumPy, format 1.0, little endian as every host of this project.
namespace cde {

/// All before the data; `type` is a type string ("<f4") or a list of fields in brackets.
[[nodiscard]] std::string npy_header(std::string_view type,
                                     const std::vector<std::uint64_t>& shape);

/// What such a file begins with, and no text does.
inline constexpr int kNpyFirstByte = 0x93;

/// Rays from a file, of which `name` is what messages say, an array of N x 6, 7 or 8 numbers in
/// binary32 or binary64: ox, oy, oz, dx, dy, dz, tmin, tmax. Errors: kFile for another array,
/// kBadInput naming the first bad ray.
[[nodiscard]] std::vector<Ray> read_rays_npy(std::istream& in, const std::string& name);

}  // namespace cde
