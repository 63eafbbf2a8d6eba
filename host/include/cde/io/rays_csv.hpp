// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <istream>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// Rays from text, one per line: ox,oy,oz,dx,dy,dz[,tmin[,tmax]]. Blanks around a field are
/// allowed. Numbers are decimal (1, -2.5e3), hexfloat (0x1.8p3) or, for tmin and tmax, inf. Each
/// becomes the nearest float. Empty lines and lines that begin with # are skipped. CRLF line ends
/// and a missing last line end are accepted.
///
/// One header line may precede the first ray. Its first field begins with a letter and is not a
/// number. It names the columns in any order: each of the six once, tmin and tmax optionally. Any
/// other name is an error. Lines may omit tmin and tmax if these are the last columns.
///
/// Errors name file, line and column as compilers do: "rays.csv:12:7: ...".
/// Error kFile means that the text cannot be read: unknown, doubled or missing columns, a wrong
/// number of fields, an invalid number, an overflow. Error kBadInput: a ray breaks its contract
/// (primitives.hpp). tmin > tmax is legal. A file without rays gives an empty vector.
[[nodiscard]] std::vector<Ray> read_rays_csv(const std::filesystem::path& path);

/// The same from a stream; `name` stands for the file in messages.
[[nodiscard]] std::vector<Ray> read_rays_csv(std::istream& in, std::string_view name);

/// One ray from a command line option, in the format of a line. `name` begins error messages.
[[nodiscard]] Ray parse_ray(std::string_view text, std::string_view name = "--ray");

}  // namespace cde
