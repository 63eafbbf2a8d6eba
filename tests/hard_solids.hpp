// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "hard_rays.hpp"

/// Spheres, OBBs and triangles that are hard on a hierarchy over triangles.
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

  Triangle triangle(unsigned kind) {
    const Triangle& t = scene_[draw_.below(scene_.size())];
    const float a = draw_(0, 1), b = draw_(0, 1 - a);
    const Vector3f within = t.v0 + (t.v1 - t.v0) * a + (t.v2 - t.v0) * b;
    const float edge = std::max((t.v1 - t.v0).norm(), 0x1p-20f * box_.sizes().maxCoeff());
    switch (kind) {
      case 1:  // one that is there
        return t;
      case 2:  // beside one, with an edge of it
        return {t.v1, t.v0, t.v0 + draw_.point() * edge};
      case 3: {  // that touches a vertex along an axis, so that gaps of boxes are all there is
        Vector3f x = Vector3f::Zero(), y = x;
        const int axis = static_cast<int>(draw_.below(3));
        x[axis] = y[axis] = draw_.below(2) == 0 ? edge : -edge;
        y[(axis + 1) % 3] = edge;
        return {t.v2, t.v2 + x, t.v2 + y};
      }
      case 4: {  // in the plane of one
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
      case 9: {  // through one
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

inline std::string text(const Triangle& t) {
  std::string words = "triangle";
  for (const float x : to_words(t)) words += fmt::format(" {:a}", x);
  return words;
}

}  // namespace cde::testing::hard
