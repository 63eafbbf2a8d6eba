// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "hard_rays.hpp"

/// Spheres and OBBs that are hard on a hierarchy over triangles.
namespace cde::testing::hard {

/// Ten kinds in turn.
class Solids {
 public:
  explicit Solids(const Scene& scene, unsigned seed) : scene_(scene), draw_(seed) {
    for (const Triangle& t : scene)
      for (const Vector3f& v : {t.v0, t.v1, t.v2}) box_.extend(v);
  }
  static constexpr unsigned kKinds = 10;

  Sphere sphere(unsigned kind) {
    const Place p = place(kind);
    return {p.centre, p.size};
  }

  /// Some along the axes, the others turned anyhow.
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
      case 1:  // with the centre in a triangle
        return {within, edge * draw_(0.1f, 2)};
      case 2:  // at a vertex
        return {t.v1, edge * draw_.power(-6, 1)};
      case 3:  // that touches a vertex along an axis, so that gaps of boxes are all there is
        return axis(t.v2, edge);
      case 4:  // in the plane of a triangle, beside it
        return {t.v0 + (t.v1 - t.v0) * draw_(-3, 3) + (t.v2 - t.v0) * draw_(-3, 3),
                edge * draw_(0.1f, 1)};
      case 5:  // larger than all
        return {outside, size * draw_(1, 20)};
      case 6:  // tiny
        return {within + draw_.point() * edge, edge * draw_.power(-16, -6)};
      case 7:  // far away
        return {box_.center() + draw_.point() * size * 0x1p14f, size * draw_.power(-4, 13)};
      case 8:  // on a corner of all
        return {box_.max(), size * draw_.power(-8, 0)};
      default:  // that just does or does not touch
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

  const Scene& scene_;
  Draw draw_;
  Eigen::AlignedBox3f box_;
};

inline std::string text(const Sphere& s) {
  return fmt::format("sphere {:a} {:a} {:a}, {:a}", s.c.x(), s.c.y(), s.c.z(), s.r);
}
inline std::string text(const Obb& b) {
  return fmt::format("obb {:a} {:a} {:a}, {:a} {:a} {:a}", b.c.x(), b.c.y(), b.c.z(), b.half.x(),
                     b.half.y(), b.half.z());
}

}  // namespace cde::testing::hard
