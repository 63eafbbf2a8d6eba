// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <type_traits>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "hard_rays.hpp"

/// Spheres, AABBs, OBBs and triangles that are hard for a BVH over triangles, and boxes as
/// secondaries of a BVH.
namespace cde::testing::hard {

/// Solids of ten kinds in turn.
class Solids {
 public:
  explicit Solids(const TriangleScene& scene, unsigned seed) : scene_(scene), draw_(seed) {
    for (const Triangle& t : scene)
      for (const Vector3f& v : {t.v0, t.v1, t.v2}) box_.extend(v);
  }
  static constexpr unsigned kKinds = 10;

  template <class Solid>
  Solid draw(std::size_t i) {
    const auto kind = static_cast<unsigned>(i % kKinds);
    if constexpr (std::is_same_v<Solid, Sphere>)
      return sphere(kind);
    else if constexpr (std::is_same_v<Solid, Obb>)
      return obb(kind);
    else if constexpr (std::is_same_v<Solid, Aabb>)
      return aabb(kind);
    else
      return triangle(kind);
  }

  Sphere sphere(unsigned kind) {
    const Place p = place(kind);
    return {p.centre, p.size};
  }

  Aabb aabb(unsigned kind) {
    const Place p = place(kind);
    Vector3f half;
    for (int k = 0; k < 3; ++k) half[k] = p.size * (draw_.below(3) == 0 ? 1 : draw_(0.05f, 1));
    return around(p.centre, half);
  }
  /// A box that is at least as large as the spacing of numbers at its centre.
  static Aabb around(const Vector3f& centre, const Vector3f& half) {
    const Vector3f least = centre.cwiseAbs() * 0x1p-22f + Vector3f::Constant(0x1p-33f);
    const Vector3f size = half.cwiseMax(least);
    return {centre - size, centre + size};
  }

  /// Some boxes are aligned with the axes, the others have a random rotation.
  Obb obb(unsigned kind) {
    const Place p = place(kind);
    Obb box;
    box.c = p.centre;
    for (int k = 0; k < 3; ++k) box.half[k] = p.size * (draw_.below(3) == 0 ? 1 : draw_(0.05f, 1));
    box.rotation.setIdentity();
    if (draw_.below(4) == 0) return box;
    const Eigen::Quaternionf turn(draw_(-1, 1), draw_(-1, 1), draw_(-1, 1), draw_(-1, 1));
    if (turn.norm() > 0.1f) box.rotation = turn.normalized().toRotationMatrix();
    return box;
  }

  Triangle triangle(unsigned kind) {
    const Triangle& t = scene_[draw_.below(scene_.size())];
    const float a = draw_(0, 1), b = draw_(0, 1 - a);
    const Vector3f within = t.v0 + (t.v1 - t.v0) * a + (t.v2 - t.v0) * b;
    const float edge = std::max((t.v1 - t.v0).norm(), 0x1p-20f * box_.sizes().maxCoeff());
    switch (kind) {
      case 1:  // a triangle of the scene
        return t;
      case 2:  // beside a triangle, with which it shares an edge
        return {t.v1, t.v0, t.v0 + draw_.point() * edge};
      case 3: {  // touches a vertex along an axis, so only the signed distance of boxes decides
        Vector3f x = Vector3f::Zero(), y = x;
        const int axis = static_cast<int>(draw_.below(3));
        x[axis] = y[axis] = draw_.below(2) == 0 ? edge : -edge;
        y[(axis + 1) % 3] = edge;
        return {t.v2, t.v2 + x, t.v2 + y};
      }
      case 4: {  // in the plane of a triangle
        const auto on = [&]() -> Vector3f {
          return t.v0 + (t.v1 - t.v0) * draw_(-2, 2) + (t.v2 - t.v0) * draw_(-2, 2);
        };
        const Vector3f v0 = on(), v1 = on();
        return {v0, v1, on()};
      }
      case 8: {  // without area
        const Vector3f along = draw_.point() * edge;
        return {within, within + along, within + along * draw_(-1, 2)};
      }
      case 9: {  // through a triangle
        const Vector3f along = draw_.point() * edge;
        return {within + along, within - along * draw_(0, 1), within + draw_.point() * edge};
      }
      default: {
        const Place p = place(kind);
        const Vector3f v0 = p.centre + draw_.point() * p.size;
        const Vector3f v1 = p.centre + draw_.point() * p.size;
        return {v0, v1, p.centre + draw_.point() * p.size};
      }
    }
  }

 private:
  struct Place {
    Vector3f centre;
    float size;
  };

  Place place(unsigned kind) {
    const Triangle& t = scene_[draw_.below(scene_.size())];
    const float size = std::max(box_.sizes().maxCoeff(), 0x1p-20f);
    const float a = draw_(0, 1), b = draw_(0, 1 - a);
    const Vector3f within = t.v0 + (t.v1 - t.v0) * a + (t.v2 - t.v0) * b;
    const Vector3f outside = box_.center() + draw_.point() * size;
    const float edge = std::max((t.v1 - t.v0).norm(), 0x1p-20f * size);
    switch (kind) {
      case 0:  // anywhere
        return {outside, size * draw_(0.01f, 0.5f)};
      case 1:  // with the centre inside a triangle
        return {within, edge * draw_(0.1f, 2)};
      case 2:  // at a vertex
        return {t.v1, edge * draw_.power(-6, 1)};
      case 3:  // touches a vertex along an axis, so only the signed distance of boxes decides
        return axis(t.v2, edge);
      case 4:  // in the plane of a triangle, beside it
        return {t.v0 + (t.v1 - t.v0) * draw_(-3, 3) + (t.v2 - t.v0) * draw_(-3, 3),
                edge * draw_(0.1f, 1)};
      case 5:  // larger than the scene
        return {outside, size * draw_(1, 20)};
      case 6:  // tiny
        return {within + draw_.point() * edge, edge * draw_.power(-16, -6)};
      case 7:  // far away
        return {box_.center() + draw_.point() * size * 0x1p14f, size * draw_.power(-4, 13)};
      case 8:  // on a corner of the scene's box
        return {box_.max(), size * draw_.power(-8, 0)};
      default:  // just touches, or just does not
        return grazing(within, edge);
    }
  }
  Place axis(const Vector3f& at, float edge) {
    const float r = edge * draw_.power(-3, 2);
    Vector3f centre = at;
    centre[static_cast<int>(draw_.below(3))] += draw_.below(2) == 0 ? r : -r;
    return {centre, r};
  }
  Place grazing(const Vector3f& within, float edge) {
    const Vector3f away = draw_.point() * edge;
    return {within + away, away.norm() * (1 + draw_(-1, 1) * 0x1p-20f) + 0x1p-30f * edge};
  }

  const TriangleScene& scene_;
  Draw draw_;
  Eigen::AlignedBox3f box_;
};

/// One box per triangle of a scene: as large as its edge, a part of that size, or flat. Some occur
/// twice, some share a centre, and some touch the previous box along an axis.
inline std::vector<Obb> obbs_of(const TriangleScene& scene, unsigned seed = 13) {
  Draw draw(seed);
  std::vector<Obb> all;
  for (const Triangle& t : scene) {
    const float edge = std::max((t.v1 - t.v0).norm(), 0x1p-30f);
    Obb box{t.v0, Vector3f::Constant(edge * draw.power(-4, 0)), Eigen::Matrix3f::Identity()};
    box.half[static_cast<int>(draw.below(3))] *= draw.power(-8, 0);
    box.half = box.half.cwiseMax(Vector3f::Constant(0x1p-33f));
    const Eigen::Quaternionf turn(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1));
    if (draw.below(3) != 0 && turn.norm() > 0.1f)
      box.rotation = turn.normalized().toRotationMatrix();
    if (!all.empty()) {
      const Obb& other = all[draw.below(all.size())];
      const auto axis = static_cast<int>(draw.below(3));
      const auto which = draw.below(8);
      if (which == 0) box = other;
      if (which == 1) box.c = other.c;
      if (which == 2)
        box.c = other.c + other.rotation.col(axis) * (other.half[axis] + box.half[axis]);
    }
    if (!defect(box)) all.push_back(box);
  }
  return all;
}
inline std::vector<Aabb> aabbs_of(const TriangleScene& scene, unsigned seed = 13) {
  std::vector<Aabb> all;
  for (const Obb& box : obbs_of(scene, seed)) all.push_back(Solids::around(box.c, box.half));
  return all;
}
/// Three corners of each box as a triangle, so that shapes drawn from the triangles lie at these
/// corners.
inline TriangleScene corners_of(const std::vector<Aabb>& boxes) {
  TriangleScene corners;
  for (const Aabb& b : boxes)
    corners.push_back(
        {b.min, {b.max.x(), b.min.y(), b.max.z()}, {b.min.x(), b.max.y(), b.max.z()}});
  return corners;
}
inline TriangleScene corners_of(const std::vector<Obb>& boxes) {
  TriangleScene corners;
  for (const Obb& b : boxes) {
    const auto corner = [&b](float x, float y, float z) -> Vector3f {
      return b.c + b.rotation * b.half.cwiseProduct(Vector3f(x, y, z));
    };
    corners.push_back({corner(-1, -1, -1), corner(1, -1, 1), corner(-1, 1, 1)});
  }
  return corners;
}
inline TriangleScene corners_of(const std::vector<Sphere>& spheres) {
  TriangleScene points;
  for (const Sphere& s : spheres)
    points.push_back({s.c, s.c + s.r * Vector3f::UnitX(), s.c + s.r * Vector3f::UnitY()});
  return points;
}
inline const TriangleScene& corners_of(const TriangleScene& scene) {
  return scene;
}

inline std::string text(const Aabb& b) {
  return fmt::format("aabb {:a} {:a} {:a}, {:a} {:a} {:a}", b.min.x(), b.min.y(), b.min.z(),
                     b.max.x(), b.max.y(), b.max.z());
}
inline std::string text(const Sphere& s) {
  return fmt::format("sphere {:a} {:a} {:a}, {:a}", s.c.x(), s.c.y(), s.c.z(), s.r);
}
inline std::string text(const Obb& b) {
  return fmt::format("obb {:a} {:a} {:a}, {:a} {:a} {:a}", b.c.x(), b.c.y(), b.c.z(), b.half.x(),
                     b.half.y(), b.half.z());
}

inline std::string text(const Triangle& t) {
  std::string words = "triangle";
  for (const float x : to_words(t)) words += fmt::format(" {:a}", x);
  return words;
}

}  // namespace cde::testing::hard
