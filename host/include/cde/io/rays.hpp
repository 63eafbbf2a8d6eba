// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// Rays from a file.
struct RayList {
  std::vector<Ray> rays;
  /// The axes of an array before its columns: (480, 640) for rays of shape (480, 640, 6), empty for
  /// one ray of shape (6,). For text: the number of rays.
  std::vector<std::uint64_t> shape;
};

/// Rays from a text (cde/io/rays_csv.hpp) or a NumPy array (.npy or .npz). The first bytes select
/// the format. An array has one of two forms.
/// - The last axis holds 6, 7 or 8 numbers: ox, oy, oz, dx, dy, dz, tmin, tmax. Any axes may
///   precede it.
/// - It is structured, with fields o and d of three numbers each, or ox to dz. tmin and tmax are
///   optional.
///
/// Numbers are floats of 2, 4 or 8 bytes or integers of 1 to 8 bytes. Both byte orders are read, in
/// C or Fortran order. Each becomes the nearest float. An .npz file must hold one array.
///
/// Errors name the file: kFile for a file that cannot be read, kBadInput for a ray that breaks its
/// contract (primitives.hpp). A file without rays gives an empty list.
[[nodiscard]] RayList read_rays(const std::filesystem::path& path);

/// The same from a stream; `name` stands for the file in messages.
[[nodiscard]] RayList read_rays(std::istream& in, const std::string& name);

}  // namespace cde
