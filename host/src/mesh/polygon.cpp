// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <random>

#include "mesh/readers.hpp"

namespace cde::mesh_readers {
namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The polygon seen along its Newell normal's largest component, counter-clockwise.
std::vector<Point> project(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = mesh.vertices[corners[0]].cast<double>();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = mesh.vertices[corners[i]].cast<double>() - origin;
    const Eigen::Vector3d b =
        mesh.vertices[corners[(i + 1) % corners.size()]].cast<double>() - origin;
    normal += a.cross(b);
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index u = (axis + 1) % 3;
  const Eigen::Index v = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const auto corner : corners) {
    const Eigen::Vector3d p = mesh.vertices[corner].cast<double>() - origin;
    points.emplace_back(sign * p[u], p[v]);
  }
  return points;
}

bool is_convex(const std::vector<Point>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (cross(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0.0) return false;
  }
  return true;
}

/// An ear: a convex corner whose triangle holds no other corner of the polygon.
bool is_ear(const std::vector<Point>& p, const std::vector<std::size_t>& ring, std::size_t at) {
  const std::size_t n = ring.size();
  const Point& a = p[ring[(at + n - 1) % n]];
  const Point& b = p[ring[at]];
  const Point& c = p[ring[(at + 1) % n]];
  if (cross(a, b, c) <= 0.0) return false;
  for (const std::size_t k : ring) {
    const Point& q = p[k];
    if (q == a || q == b || q == c) continue;
    if (cross(a, b, q) >= 0.0 && cross(b, c, q) >= 0.0 && cross(c, a, q) >= 0.0) return false;
  }
  return true;
}

}  // namespace

std::string append_polygon(Mesh& mesh, std::span<const std::uint32_t> corners,
                           const Deadline& deadline) {
  // Ear clipping takes cubic time at worst.
  constexpr std::size_t kMostConcaveCorners = 1024, kFewCorners = 32;
  if (corners.size() < 3) {
    ++mesh.dropped;
    return {};
  }
  if (corners.size() == 3) {
    mesh.faces.push_back({corners[0], corners[1], corners[2]});
    return {};
  }
  const std::vector<Point> points = project(mesh, corners);
  std::vector<std::size_t> ring(corners.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = i;
  if (!is_convex(points)) {
    if (corners.size() > kMostConcaveCorners)
      return fmt::format("concave polygon of {} corners (limit {})", corners.size(),
                         kMostConcaveCorners);
    if (corners.size() > kFewCorners && std::chrono::steady_clock::now() > deadline.end)
      return fmt::format("not read within {} s (CDE_READ_SECONDS sets another limit)",
                         deadline.limit.count());
    for (std::size_t at = 0, tried = 0; ring.size() > 3 && tried < ring.size();) {
      const std::size_t n = ring.size();
      if (!is_ear(points, ring, at % n)) {
        ++at;
        ++tried;
        continue;
      }
      at %= n;
      mesh.faces.push_back(
          {corners[ring[(at + n - 1) % n]], corners[ring[at]], corners[ring[(at + 1) % n]]});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
      tried = 0;
    }
  }
  // The remaining polygon is convex, or it is flat or crosses itself and has no right
  // triangulation.
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    mesh.faces.push_back({corners[ring[0]], corners[ring[i]], corners[ring[i + 1]]});
  }
  return {};
}

namespace {

/// The same for all meshes of a process.
std::array<std::uint64_t, 4> random_keys() {
  static const std::array<std::uint64_t, 4> keys = [] {
    std::random_device random;
    std::array<std::uint64_t, 4> drawn{};
    for (std::uint64_t& key : drawn) key = std::uint64_t{random()} << 32 | random();
    return drawn;
  }();
  return keys;
}

}  // namespace

std::size_t VertexPool::Hash::operator()(const Bits& b) const noexcept {
  // Multiply-shift (Dietzfelbinger 1996): any two vertices collide with probability 2^-32.
  return (keys[0] + keys[1] * b.x + keys[2] * b.y + keys[3] * b.z) >> 32;
}

VertexPool::VertexPool(std::vector<Eigen::Vector3f>& vertices)
    : vertices_(vertices), numbers_(0, Hash{random_keys()}) {}

std::uint32_t VertexPool::add(const Eigen::Vector3f& vertex) {
  const Bits bits{std::bit_cast<std::uint32_t>(vertex.x()),
                  std::bit_cast<std::uint32_t>(vertex.y()),
                  std::bit_cast<std::uint32_t>(vertex.z())};
  const auto [at, is_new] =
      numbers_.try_emplace(bits, static_cast<std::uint32_t>(vertices_.size()));
  if (is_new) vertices_.push_back(vertex);
  return at->second;
}

}  // namespace cde::mesh_readers
