// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "hard_solids.hpp"

/// Spheres in a BVH, and rays and spheres that are hard for it.
namespace cde::testing::hard {

using Cloud = std::vector<Sphere>;

/// One sphere per triangle of a scene: as large as its edge, a part of that size, or tiny. Some
/// occur twice, some share a centre, and some touch the previous sphere.
inline Cloud cloud_of(const TriangleScene& scene, unsigned seed = 11) {
  Draw draw(seed);
  Cloud all;
  for (const Triangle& t : scene) {
    const float edge = std::max((t.v1 - t.v0).norm(), 0x1p-33f);
    Sphere s{t.v0, std::max(edge * draw.power(-6, 0) * draw(0.5f, 1), 0x1p-34f)};
    if (!all.empty()) {
      const Sphere& other = all[draw.below(all.size())];
      switch (draw.below(8)) {
        case 0:
          s = other;
          break;
        case 1:
          s.c = other.c;
          break;
        case 2:
          s.c = other.c + Vector3f::Unit(static_cast<int>(draw.below(3))) * (s.r + other.r);
          break;
        default:
          break;
      }
    }
    all.push_back(s);
  }
  return all;
}

/// Rays of ten kinds in turn.
class CloudRays {
 public:
  CloudRays(const Cloud& cloud, unsigned seed) : cloud_(cloud), draw_(seed) {
    for (const Sphere& s : cloud) box_.extend(s.c);
  }
  static constexpr unsigned kKinds = 10;

  Ray operator()(unsigned kind) {
    const Sphere& s = cloud_[draw_.below(cloud_.size())];
    const float size = std::max(box_.sizes().maxCoeff(), s.r);
    const Vector3f outside = box_.center() + draw_.point() * size;
    Vector3f away = draw_.point();
    if (away.norm() < 0.1f) away = Vector3f::UnitZ();
    const Vector3f surface = s.c + away.normalized() * s.r;
    switch (kind) {
      case 0:  // anywhere
        return to(outside, box_.center() + draw_.point() * size);
      case 1:  // aimed at a centre, from within another sphere
        return to(cloud_[draw_.below(cloud_.size())].c, s.c);
      case 2:  // from the surface
        return to(surface, box_.center() + draw_.point() * size);
      case 3: {  // grazing
        const Vector3f side = away.cross(draw_.point());
        return to(surface + side * (size / std::max(side.norm(), 0x1p-20f)),
                  surface + away.normalized() * (s.r * draw_(-1, 1) * draw_.power(-26, -3)));
      }
      case 4: {  // along an axis, grazing, zeros of either sign
        Ray ray{outside, Vector3f::Zero()};
        const int axis = static_cast<int>(draw_.below(3));
        for (int k = 0; k < 3; ++k) {
          if (k == axis) continue;
          ray.d[k] = draw_.below(2) == 0 ? 0.0f : -0.0f;
          ray.o[k] = s.c[k];
        }
        ray.o[(axis + 1) % 3] += draw_.below(2) == 0 ? s.r : -s.r;
        ray.d[axis] = draw_.below(2) == 0 ? 1.0f : -1.0f;
        return ray;
      }
      case 5:  // from far away
        return to(box_.center() + draw_.point() * size * 0x1p14f, surface);
      case 6: {  // any length, with a T interval
        Ray ray = to(outside, surface);
        const float length = draw_.power(-12, 12) / std::max(0x1p-20f, ray.d.norm());
        ray.d *= length;
        ray.tmin = draw_(-1, 2) / length, ray.tmax = draw_(-1, 4) / length;
        return ray;
      }
      case 7: {  // lengths for which T^2 is not a normal number
        Ray ray = to(outside, surface);
        const float most = ray.d.cwiseAbs().maxCoeff();
        ray.d *= draw_.below(2) == 0 ? 0x1p39f / most : 0x1p-33f / most;
        if (draw_.below(2) == 0) ray.tmin = -std::numeric_limits<float>::infinity();
        return ray;
      }
      case 8:  // leaves the sphere that it starts in
        return to(s.c + draw_.point() * s.r * 0.5f, box_.center() + draw_.point() * size);
      default: {  // ends at a surface
        Ray ray = to(outside, surface);
        ray.tmax = 1;
        return ray;
      }
    }
  }

 private:
  static Ray to(const Vector3f& from, const Vector3f& at) {
    Ray ray{from, at - from};
    if (ray.d.cwiseAbs().maxCoeff() < 0x1p-34f) ray.d = Vector3f::UnitX();
    return ray;
  }
  const Cloud& cloud_;
  Draw draw_;
  Eigen::AlignedBox3f box_;
};

/// Spheres of eight kinds in turn.
class CloudSpheres {
 public:
  CloudSpheres(const Cloud& cloud, unsigned seed) : cloud_(cloud), draw_(seed) {
    for (const Sphere& s : cloud) box_.extend(s.c);
  }
  static constexpr unsigned kKinds = 8;

  Sphere operator()(unsigned kind) {
    const Sphere& s = cloud_[draw_.below(cloud_.size())];
    const float size = std::max(box_.sizes().maxCoeff(), s.r);
    const Vector3f outside = box_.center() + draw_.point() * size;
    const int axis = static_cast<int>(draw_.below(3));
    switch (kind) {
      case 0:  // anywhere
        return {outside, size * draw_(0.01f, 0.5f)};
      case 1:  // with the same centre
        return {s.c, s.r * draw_.power(-3, 3)};
      case 2: {  // touches along an axis, so only the signed distance of boxes decides
        const float r = s.r * draw_.power(-3, 3);
        return {s.c + Vector3f::Unit(axis) * (s.r + r), r};
      }
      case 3:  // inside a sphere
        return {s.c + draw_.point() * s.r * 0.5f, s.r * draw_(0.1f, 0.5f)};
      case 4:  // larger than the scene
        return {outside, size * draw_(1, 20)};
      case 5:  // tiny
        return {s.c + draw_.point() * s.r * 2, std::max(s.r * draw_.power(-16, -6), 0x1p-34f)};
      case 6:  // far away
        return {box_.center() + draw_.point() * size * 0x1p14f, size * draw_.power(-4, 13)};
      default: {  // just touches, or just does not
        const Vector3f away = draw_.point() * s.r * 4;
        return {s.c + away,
                std::max((away.norm() - s.r) * (1 + draw_(-1, 1) * 0x1p-20f), 0x1p-34f)};
      }
    }
  }

 private:
  const Cloud& cloud_;
  Draw draw_;
  Eigen::AlignedBox3f box_;
};

}  // namespace cde::testing::hard
