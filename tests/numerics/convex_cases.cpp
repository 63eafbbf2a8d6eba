// SPDX-License-Identifier: Apache-2.0
#include "convex_cases.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "cde/oracle/random.hpp"

namespace cde::testing {
namespace {

using oracle::Random;
using oracle::Shape;
using oracle::ShapeKind;
using oracle::Vec;
using Frame = Eigen::Matrix3d;

/// The flat features of a shape, as targets for generated normals.
struct Features {
  std::vector<Vec> vertices, edges, normals;
  double radius = 0;  ///< of a sphere, about its only vertex

  [[nodiscard]] Vec extreme(const Vec& n) const {
    const auto by = [&](const Vec& p, const Vec& q) { return p.dot(n) < q.dot(n); };
    return *std::max_element(vertices.begin(), vertices.end(), by) + radius * n;
  }
};

Features box_features(const Vec& c, const Vec& half, const Frame& axes) {
  Features f;
  for (int k = 0; k < 8; ++k) {
    const Vec signs(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    f.vertices.emplace_back(c + axes * half.cwiseProduct(signs));
  }
  for (int k = 0; k < 3; ++k) {
    f.edges.emplace_back(axes.col(k));
    f.normals.emplace_back(axes.col(k));
  }
  return f;
}

struct FeaturesOf {
  Features operator()(const oracle::Sphere& s) const { return {{s.c}, {}, {}, s.r}; }
  Features operator()(const oracle::Aabb& s) const {
    return box_features((s.min + s.max) / 2, (s.max - s.min) / 2, Frame::Identity());
  }
  Features operator()(const oracle::Obb& s) const { return box_features(s.c, s.half, s.rotation); }
  Features operator()(const oracle::Triangle& s) const {
    return {{s.v0, s.v1, s.v2},
            {s.v1 - s.v0, s.v2 - s.v1, s.v0 - s.v2},
            {(s.v1 - s.v0).cross(s.v2 - s.v0)},
            0};
  }
  Features operator()(const oracle::Plane& s) const { return {{s.n * s.d}, {}, {s.n}, 0}; }
  Features operator()(const oracle::Cylinder&) const { throw std::logic_error("no cylinders"); }
};

Shape random_shape(ShapeKind kind, Random& random, bool thin) {
  const Vec c(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  Vec half(random.decades(0.1, 1), random.decades(0.1, 1), random.decades(0.1, 1));
  if (thin) half[random.below(3)] *= random.decades(1e-6, 1e-2);
  switch (kind) {
    case ShapeKind::kSphere:
      return oracle::Sphere{c, random.decades(1e-3, 1)};
    case ShapeKind::kAabb:
      return oracle::Aabb{c - half, c + half};
    case ShapeKind::kObb:
      return oracle::Obb{c, half, random.rotation()};
    case ShapeKind::kPlane:
      return oracle::Plane{random.direction(), random.uniform(-1, 1)};
    case ShapeKind::kTriangle: {
      const Vec v0 = c + random.direction(), v1 = c + random.direction();
      Vec v2 = c + random.direction();
      // Nearly on the first edge, or nearly on its end.
      if (thin) {
        const double at = random.chance(0.5) ? random.uniform(-0.2, 1.2) : 1.0;
        v2 = v0 + at * (v1 - v0) + random.decades(1e-8, 1e-2) * random.direction();
      }
      return oracle::Triangle{v0, v1, v2};
    }
    default:
      throw std::logic_error("not a shape of these pairs");
  }
}

/// Nearly zero: 0, or a vector of length 1e-9 to 1e-2.
Vec hair(Random& random) {
  return random.chance(0.25) ? Vec::Zero() : Vec(random.decades(1e-9, 1e-2) * random.direction());
}

Frame small_turn(Random& random) {
  const Vec axis = random.chance(0.5) ? Vec(Vec::Unit(random.below(3))) : random.direction();
  return Eigen::AngleAxisd(hair(random).norm(), axis).toRotationMatrix();
}

/// Makes a face of one shape nearly parallel to a face of the other, if one can be rotated.
void align(Shape& a, Shape& b, Random& random) {
  const auto* box = std::get_if<oracle::Obb>(&b);
  const Frame axes = box ? box->rotation : Frame::Identity();
  const Frame turn = small_turn(random) * axes;
  if (auto* other = std::get_if<oracle::Obb>(&a)) {
    const Frame quarter = random.quarter_turns();
    const Frame about =
        Eigen::AngleAxisd(random.chance(0.5) ? 0.0 : random.uniform(0, 3), Vec::UnitZ())
            .toRotationMatrix();
    other->rotation = turn * about * quarter;
  } else if (auto* triangle = std::get_if<oracle::Triangle>(&a)) {
    const int flat = random.below(3);
    const auto put = [&](const Vec& v) {
      Vec local = v;
      local[flat] = 0.1;
      return Vec(turn * local);
    };
    *triangle = {put(triangle->v0), put(triangle->v1), put(triangle->v2)};
  }
}

Vec perpendicular_to(const Vec& edge, Random& random) {
  return edge.cross(random.direction()).normalized();
}

/// The normal from A to B that a family aims at.
Vec aim(DirectedFamily family, const Features& a, const Features& b, Random& random) {
  const auto any = [&](const std::vector<Vec>& from) {
    return from[static_cast<std::size_t>(random.below(static_cast<int>(from.size())))];
  };
  Vec n = random.direction();
  const bool face = family == DirectedFamily::kFaces || random.chance(0.3);
  if (family != DirectedFamily::kCorners && face) {
    const auto& normals = b.normals.empty() || random.chance(0.5) ? a.normals : b.normals;
    if (!normals.empty()) n = random.flipped(any(normals));
  } else if (family != DirectedFamily::kCorners) {
    const auto& some = a.edges.empty() ? b.edges : a.edges;
    if (!some.empty()) n = perpendicular_to(any(some), random);
    if (!a.edges.empty() && !b.edges.empty() && random.chance(0.5))
      n = random.flipped(any(a.edges).cross(any(b.edges)));
  }
  if (n.norm() < 1e-30) n = random.direction();  // parallel edges
  n.normalize();
  return (n + hair(random)).normalized();
}

}  // namespace

const char* to_string(DirectedFamily family) {
  switch (family) {
    case DirectedFamily::kCorners:
      return "corners";
    case DirectedFamily::kEdges:
      return "edges";
    case DirectedFamily::kFaces:
      return "faces";
    case DirectedFamily::kThin:
      return "thin";
  }
  return "?";
}

oracle::Case directed_case(oracle::Pair pair, DirectedFamily family, std::uint64_t seed,
                           std::uint64_t index) {
  Random random(seed,
                1000 + 16 * static_cast<std::uint64_t>(pair) + static_cast<std::uint64_t>(family),
                index);
  const bool thin = family == DirectedFamily::kThin;
  Shape a = random_shape(oracle::primary(pair), random, thin);
  Shape b = random_shape(oracle::secondary(pair), random, thin);
  if (family == DirectedFamily::kFaces && random.chance(0.7)) align(a, b, random);
  const Features fa = std::visit(FeaturesOf{}, a), fb = std::visit(FeaturesOf{}, b);
  const Vec n = std::holds_alternative<oracle::Plane>(b)
                    ? random.flipped(std::get<oracle::Plane>(b).n)
                    : aim(family, fa, fb, random);
  const double size = random.decades(1e-7, 1e-1) * (random.chance(0.75) ? 1 : -1);
  const double d = size * oracle::scene_size(a, b);
  const Vec to = fa.extreme(n) + d * n;
  a = oracle::moved(a, fb.extreme(-n) - to);
  return {pair, seed, index, to_string(family), oracle::to_words(a), oracle::to_words(b)};
}

}  // namespace cde::testing
