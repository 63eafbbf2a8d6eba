// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/mesh/terrain.hpp"

/// Scenes and rays that are hard for a BVH, for tests of the reference and of cards.
namespace cde::testing::hard {

using Eigen::Vector3f;

// ---- Scenes ----

/// Random numbers that are the same in every run.
class Draw {
 public:
  explicit Draw(unsigned seed) : bits_(seed) {}
  float operator()(float low, float high) { return static_cast<float>(between(low, high)); }
  Vector3f point() {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return Eigen::Vector3d(x, y, z).cast<float>();
  }
  float power(int low, int high) {
    return std::ldexp(1.0f, low + static_cast<int>(below(static_cast<unsigned>(high - low + 1))));
  }
  std::size_t below(std::size_t n) { return bits_() % n; }

 private:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  std::mt19937_64 bits_;
};

using TriangleScene = std::vector<Triangle>;

inline TriangleScene triangles_of(const Mesh& mesh) {
  TriangleScene all;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) all.push_back(mesh.triangle(i));
  return all;
}

inline TriangleScene icosphere(const Vector3f& centre, float radius = 1) {
  TriangleScene all =
      triangles_of(load_mesh(std::string(CDE_SOURCE_DIR) + "/meshes/icosphere.ply"));
  for (Triangle& t : all)
    for (Vector3f* v : {&t.v0, &t.v1, &t.v2}) *v = *v * radius + centre;
  return all;
}

/// Axis-aligned squares on a grid with step 0.5. Some occur twice, some have no area.
inline TriangleScene flat() {
  Draw draw(2);
  TriangleScene all;
  for (int i = 0; i < 200; ++i) {
    const auto half = [&] { return std::floor(draw(-4, 5)) * 0.5f; };
    const int axis = static_cast<int>(draw.below(3));
    const Vector3f corner(half(), half(), half());
    Vector3f a = Vector3f::Zero(), b = Vector3f::Zero();
    a[(axis + 1) % 3] = 0.5f, b[(axis + 2) % 3] = i % 10 == 0 ? 0.0f : 0.5f;
    all.push_back({corner, corner + a, corner + b});
    if (i % 4 == 0) all.push_back(all[draw.below(all.size())]);
  }
  return all;
}

/// Triangles whose width is 2^-14 of their length.
inline TriangleScene needles() {
  Draw draw(3);
  TriangleScene all;
  for (int i = 0; i < 300; ++i) {
    const Vector3f from = draw.point(), along = draw.point();
    all.push_back({from, from + along, from + along * 0.5f + draw.point() * draw.power(-14, -2)});
  }
  return all;
}

inline TriangleScene tilted_plane() {
  TriangleScene all;
  const Vector3f x(0.9f, 0.3f, 0.1f), y(-0.2f, 0.8f, 0.4f);
  const auto at = [&](int i, int j) -> Vector3f {
    return x * static_cast<float>(i) * 0.1f + y * static_cast<float>(j) * 0.1f;
  };
  for (int i = -8; i < 8; ++i) {
    for (int j = -8; j < 8; ++j) {
      all.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      all.push_back({at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)});
    }
  }
  return all;
}

/// Triangles at distances from 2^-20 to 2^20, each as large as its distance.
inline TriangleScene sizes() {
  Draw draw(4);
  TriangleScene all;
  for (int i = 0; i < 300; ++i) {
    const float size = draw.power(-20, 20);
    const Vector3f from = draw.point() * size;
    all.push_back({from, from + draw.point() * size, from + draw.point() * size});
  }
  return all;
}

struct Case {
  const char* name;
  std::function<TriangleScene()> make;
};
inline std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}
inline const Case kScenes[] = {
    {"icosphere", [] { return icosphere(Vector3f::Zero()); }},
    {"icosphere_far_away",
     [] {
       return icosphere({148376, 1234, -223423});
     }},
    {"flat", flat},
    {"needles", needles},
    {"tilted_plane", tilted_plane},
    {"sizes", sizes},
    {"terrain", [] { return triangles_of(make_terrain({.quads_x = 16, .quads_y = 16})); }},
    {"one_triangle", [] {
       return TriangleScene{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}}};
     }}};

// ---- Rays ----

/// Rays that are hard for a BVH: ten kinds in turn.
class Rays {
 public:
  explicit Rays(const TriangleScene& scene, unsigned seed) : scene_(scene), draw_(seed) {
    for (const Triangle& t : scene)
      for (const Vector3f& v : {t.v0, t.v1, t.v2}) box_.extend(v);
  }
  static constexpr unsigned kKinds = 10;

  Ray operator()(unsigned kind) {
    const Triangle& t = scene_[draw_.below(scene_.size())];
    const float size = box_.sizes().maxCoeff();
    const Vector3f outside = box_.center() + draw_.point() * size;
    const float a = draw_(0, 1), b = draw_(0, 1 - a);
    const Vector3f within = t.v0 + (t.v1 - t.v0) * a + (t.v2 - t.v0) * b;
    switch (kind) {
      case 0:  // anywhere
        return to(outside, box_.center() + draw_.point() * size);
      case 1:  // aimed at an edge
        return to(outside, t.v0 + (t.v1 - t.v0) * a);
      case 2:  // aimed at a vertex
        return to(outside, t.v1);
      case 3:  // from vertex to vertex
        return to(t.v0, scene_[draw_.below(scene_.size())].v2);
      case 4:  // in the plane of a triangle
        return to(t.v0 + (t.v1 - t.v0) * draw_(-3, 3) + (t.v2 - t.v0) * draw_(-3, 3), within);
      case 5: {  // along an axis, from a plane of a box, zeros of either sign
        Ray ray = to(outside, within);
        const int axis = static_cast<int>(draw_.below(3));
        for (int k = 0; k < 3; ++k)
          if (k != axis) ray.d[k] = draw_.below(2) == 0 ? 0.0f : -0.0f, ray.o[k] = t.v0[k];
        if (ray.d[axis] == 0) ray.d[axis] = 1;
        return ray;
      }
      case 6: {  // one component zero, in a plane of a box
        Ray ray = to(outside, within);
        const int axis = static_cast<int>(draw_.below(3));
        ray.d[axis] = draw_.below(2) == 0 ? 0.0f : -0.0f;
        ray.o[axis] = draw_.below(2) == 0 ? t.v0[axis] : box_.max()[axis];
        if (ray.d.isZero()) ray.d[(axis + 1) % 3] = -1;
        return ray;
      }
      case 7:  // from far away
        return to(box_.center() + draw_.point() * size * 0x1p14f, within);
      case 8: {  // any length, with a T interval
        Ray ray = to(outside, within);
        const float length = draw_.power(-12, 12) / std::max(1.0f, ray.d.cwiseAbs().maxCoeff());
        ray.d *= length;
        ray.tmin = draw_(-1, 2) / length, ray.tmax = draw_(-1, 4) / length;
        return ray;
      }
      default: {  // grazing
        const Vector3f start = t.v0 + (t.v1 - t.v0) * draw_(-3, 3);
        Ray ray = to(start, within);
        ray.d += draw_.point() * draw_.power(-26, -3) * size;
        return ray;
      }
    }
  }

 private:
  static Ray to(const Vector3f& from, const Vector3f& at) {
    Ray ray{from, at - from};
    if (ray.d.isZero()) ray.d = Vector3f::UnitX();
    return ray;
  }
  const TriangleScene& scene_;
  Draw draw_;
  Eigen::AlignedBox3f box_;
};

/// A ray from inside an icosphere, aimed at one of its edges or vertices.
inline Ray from_inside(const TriangleScene& mesh, const Vector3f& centre, float radius,
                       Draw& draw) {
  const Triangle& t = mesh[draw.below(mesh.size())];
  const Vector3f o = centre + draw.point() * radius * 0.5f;
  const float share = draw.below(3) == 0 ? 0 : draw(0, 1);
  return {o, t.v0 + (t.v1 - t.v0) * share - o};
}

/// A triangle, and a ray that starts beside it and leaves along its plane. The roundings of moller
/// give 0 <= u, v and T = 1.1 2^127. There |T d|_1 overflows, and so does the margin of the box
/// rule.
inline TriangleScene edge_on() {
  return {{{0, 0, 0},
           {0x1.6337a6p18f, 0x1.6337a6p18f, 0x1.eb8818p19f},
           {0, 0x1.f6c33p-113f, 0x1.0d159ap19f}}};
}
inline Ray beyond_numbers() {
  return {{0x1.f88eecp20f, 0x1.f88eeap20f, 0}, {1, 1, 0}, 0};
}

inline std::string text(const Ray& ray) {
  std::string words;
  for (const float x : to_words(ray)) words += fmt::format("{}{:a}", words.empty() ? "" : ",", x);
  return words;
}

}  // namespace cde::testing::hard
