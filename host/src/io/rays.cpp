// SPDX-License-Identifier: Apache-2.0
#include "cde/io/rays.hpp"

#include <fmt/format.h>

#include <cmath>
#include <istream>
#include <iterator>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suffix.hpp"
#include "io/array_table.hpp"
#include "io/ray_table.hpp"
#include "support/file_io.hpp"

namespace cde {
namespace {

RayList rays_in_array(std::string bytes, const std::string& name) {
  const io::ArrayTable table(std::move(bytes), name, ray_table());
  RayList list{.rays = {}, .shape = table.shape()};
  list.rays.reserve(table.rows());
  const auto fail = [&](std::uint64_t i, const std::string& why) {
    throw Error(ErrorCode::kBadInput, fmt::format("{}: ray {}: {}", name, i, why));
  };
  for (std::uint64_t i = 0; i < table.rows(); ++i) {
    Ray ray;
    double wide[8] = {0, 0, 0, 0, 0, 0, ray.tmin, ray.tmax};
    table.read(i, wide);
    float values[8];
    for (std::size_t c = 0; c < 8; ++c) {
      values[c] = static_cast<float>(wide[c]);
      if (std::isfinite(wide[c]) && !std::isfinite(values[c]))
        fail(i, fmt::format("{} overflows a float", wide[c]));
    }
    ray = {
        {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, values[6], values[7]};
    if (const auto why = defect(ray)) fail(i, *why);
    list.rays.push_back(ray);
  }
  return list;
}

RayList rays_in(std::string bytes, const std::string& name) {
  if (io::is_array(bytes)) return rays_in_array(std::move(bytes), name);
  RayList list{.rays = rays_in_text(bytes, name), .shape = {}};
  list.shape = {list.rays.size()};
  return list;
}

}  // namespace

const text::TableForm& ray_table() {
  static const text::TableForm kForm{
      .row = "ray",
      .names = {"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax"},
      .optional = {false, false, false, false, false, false, true, true},
      .widths = {6, 7, 8},
      .groups = {{"o", 0, 3}, {"d", 3, 3}},
      .expected = "expected ox, oy, oz, dx, dy, dz and optionally tmin, tmax, in any order",
      .arrays =
          "rays are (..., 6), (..., 7) or (..., 8) numbers, ox, oy, oz, dx, dy, dz, tmin, tmax, or "
          "structures of o and d of 3 numbers each and optionally tmin and tmax"};
  return kForm;
}

RayList read_rays(const std::filesystem::path& path) {
  const std::string name = printable_name(path.string());
  std::string bytes = file_io::read(path);
  const Suffix end = suffix_of(path.string());
  const std::string suffix = end.nameless ? "" : end.text;
  if ((suffix == ".npy" || suffix == ".npz") && !io::is_array(bytes))
    throw Error(ErrorCode::kFile, name + ": is not a NumPy array (" + suffix + ")");
  return rays_in(std::move(bytes), name);
}

RayList read_rays(std::istream& in, const std::string& name) {
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) throw Error(ErrorCode::kFile, fmt::format("{}: cannot be read", name));
  return rays_in(std::move(bytes), name);
}

}  // namespace cde
