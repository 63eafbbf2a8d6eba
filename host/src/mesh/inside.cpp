// SPDX-License-Identifier: Apache-2.0
#include "cde/mesh/inside.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "mesh/readers.hpp"

namespace cde {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The corners of all faces. Vertices with equal coordinates share one number; +0 and -0 are equal.
std::vector<std::uint32_t> welded(const Mesh& mesh) {
  std::vector<Eigen::Vector3f> vertices;
  mesh_readers::VertexPool pool(vertices);
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.faces.size());
  for (const auto& face : mesh.faces)
    for (const std::uint32_t corner : face)
      corners.push_back(pool.add(mesh.vertices[corner] + Eigen::Vector3f::Zero()));
  return corners;
}

struct Side {
  Edge edge;  ///< the lower corner first
  bool forward;
  std::uint32_t face;
  bool operator<(const Side& other) const { return edge < other.edge; }
};

void require_closed(const Mesh& mesh) {
  const std::vector<std::uint32_t> corners = welded(mesh);
  std::vector<Side> sides;
  sides.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t a = corners[i], b = corners[i - i % 3 + (i + 1) % 3];
    if (a != b) sides.push_back({std::minmax(a, b), a < b, static_cast<std::uint32_t>(i / 3)});
  }
  std::sort(sides.begin(), sides.end());
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::upper_bound(first, sides.end(), *first);
    const auto forward = std::count_if(first, last, [](const Side& s) { return s.forward; });
    if (2 * forward != last - first)
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{}: is not closed: an edge of triangle {} has {} triangle{} one way "
                              "round and {} the other",
                              printable_name(mesh.name), first->face, forward,
                              forward == 1 ? "" : "s", last - first - forward));
    first = last;
  }
}

}  // namespace

Inside::Inside(const Mesh& mesh) : box_(bounds(mesh)) {
  require_closed(mesh);
  triangles_.reserve(mesh.faces.size());
  for (const auto& f : mesh.faces)
    triangles_.push_back({mesh.vertices[f[0]].cast<double>(), mesh.vertices[f[1]].cast<double>(),
                          mesh.vertices[f[2]].cast<double>()});
}

double Inside::winding_number(const Eigen::Vector3f& point) const {
  if (!box_.contains(point)) return 0;
  const Eigen::Vector3d at = point.cast<double>();
  double sum = 0;
  for (const auto& t : triangles_) {
    const Eigen::Vector3d a = t[0] - at, b = t[1] - at, c = t[2] - at;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (2 * std::numbers::pi);
}

bool Inside::contains(const Eigen::Vector3f& point) const {
  return std::abs(winding_number(point)) > 0.5;
}

}  // namespace cde
