// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <istream>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// Rays from text, one a line: ox,oy,oz,dx,dy,dz[,tmin[,tmax]] with blanks allowed around each
/// field. Numbers are decimal (1, -2.5e3), hexfloat (0x1.8p3) or, for tmin and tmax, inf; each
/// becomes the nearest float. Empty lines and lines that begin with # are skipped. CRLF line ends
/// and a missing last one are fine.
///
/// One header line may stand before the first ray (a line whose first field begins with a letter
/// and is no number). It names the columns in any order, each of the six once, tmin and tmax if
/// they are there; any other name is refused. Lines may leave out tmin and tmax where those come
/// last.
///
/// Errors name file, line and column, as compilers do ("rays.csv:12:7: ..."): kFile for text that
/// cannot be read (unknown, doubled or missing columns, too few or many fields, not a number,
/// overflow), kBadInput for a ray that breaks its contract (primitives.hpp). tmin > tmax is legal.
/// A file without rays gives an empty vector.
[[nodiscard]] std::vector<Ray> read_rays_csv(const std::filesystem::path& path);

/// The same from a stream; `name` stands for the file in messages.
[[nodiscard]] std::vector<Ray> read_rays_csv(std::istream& in, std::string_view name);

/// One ray from a command line option, in the format of a line. `name` begins the message of an
/// error.
[[nodiscard]] Ray parse_ray(std::string_view text, std::string_view name = "--ray");

}  // namespace cde
