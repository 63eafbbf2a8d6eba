#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cde/primitives.hpp"

/// Arrays of NumPy, format 1.0, little endian as every host of this project.
namespace cde::cli {

/// All before the data; `type` is a type string ("<f4") or a list of fields in brackets.
[[nodiscard]] std::string npy_header(std::string_view type,
                                     const std::vector<std::uint64_t>& shape);

/// Rays from a file, an array of N x 6, 7 or 8 numbers in binary32 or binary64: ox, oy, oz, dx, dy,
/// dz, tmin, tmax. Errors: kFile for another array, kBadInput naming the first bad ray.
[[nodiscard]] std::vector<Ray> read_rays_npy(const std::string& path);

}  // namespace cde::cli
