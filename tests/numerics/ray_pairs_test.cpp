// SPDX-License-Identifier: Apache-2.0
// Answers of the four ray-triangle mirror references against exact rational arithmetic; leaks of
// closed meshes; the operators in the docs. moller_test.cpp tests Moeller's bound.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "cde/mesh/mesh.hpp"
#include "cde/oracle/exact.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "in_docs.hpp"
#include "operators.hpp"
#include "random.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();

// ---- Comparison with exact arithmetic ----

struct Scene {
  const char* name;
  double offset;           ///< of the scene from the world's origin
  double size;             ///< of the triangles
  double distance;         ///< of the ray's origin, at most
  double near_edge = 0.5;  ///< share of rays aimed close to an edge
  double needle = 1;       ///< height over length of the triangles
  double least_cos = 0.01;
  double finest = -7;  ///< decade of the closest misses of an edge, in barycentric coordinates
};

std::ostream& operator<<(std::ostream& out, const Scene& s) {
  return out << s.name;
}

/// A ray, and a triangle that it meets at known, often awkward, barycentric coordinates.
std::pair<Ray, Triangle> make(Random& random, const Scene& scene) {
  BasicRay<double> ray;
  ray.o = random.vector() + Vector3d::Constant(scene.offset);
  ray.d = random.vector() * random.decades(-1, 1);
  const double t = random.between(0.1, 1) * scene.distance / ray.d.norm();
  if (random.chance(0.25)) ray.tmin = t * random.between(0, 1.5), ray.tmax = 2 * t;
  const Vector3d at = ray.o + t * ray.d;
  const Vector3d e1 = scene.size * random.vector();
  const Vector3d e2 = random.between(-1, 2) * e1 + scene.size * scene.needle * random.vector();
  double u = random.between(-0.15, 1.15), v = random.between(-0.15, 1.15) * (1 - u);
  if (random.chance(scene.near_edge)) {
    const double off = random.sign() * random.decades(scene.finest, -2);
    switch (random.below(3)) {
      case 0:
        u = off, v = random.unit();
        break;
      case 1:
        v = off, u = random.unit();
        break;
      default:
        u = random.unit(), v = 1 - u + off;
    }
  }
  const Vector3d v0 = at - u * e1 - v * e2;
  const BasicTriangle<double> triangle{v0, v0 + e1, v0 + e2};
  return {primitive_cast<float>(ray), primitive_cast<float>(triangle)};
}

/// The lengths that scale the bands.
struct Shape {
  double world = 0;  ///< L: largest |coordinate|
  double reach = 0;  ///< largest |v - o|
  double slim;       ///< |E1| |E2| (|E1| + |E2|) / |N|
  double aspect;     ///< square of the longest edge over |N|
  double around;     ///< sum of the edge lengths, over |N|
  double cos;        ///< |N.D| / (|N| |D|)
  double height[3];  ///< of v1, v2, v0 above the edge across
  double direction;  ///< |D|

  Shape(const Ray& ray, const Triangle& triangle) {
    const Vector3d o = ray.o.cast<double>(), d = ray.d.cast<double>();
    const Vector3d v[3] = {triangle.v0.cast<double>(), triangle.v1.cast<double>(),
                           triangle.v2.cast<double>()};
    world = o.cwiseAbs().maxCoeff();
    for (const Vector3d& p : v) {
      world = std::max(world, p.cwiseAbs().maxCoeff());
      reach = std::max(reach, (p - o).norm());
    }
    const Vector3d e1 = v[1] - v[0], e2 = v[2] - v[0], normal = e1.cross(e2);
    const double a = e1.norm(), b = e2.norm(), c = (e2 - e1).norm(), area = normal.norm();
    direction = d.norm();
    slim = a * b * (a + b) / area, around = (a + b + c) / area;
    aspect = std::max({a * a, b * b, c * c}) / area;
    cos = std::abs(normal.dot(d)) / (area * direction);
    height[0] = area / b, height[1] = area / a, height[2] = area / c;
  }
};

/// One of the algorithms, with its band and bound over u. Within the band, a length in the
/// triangle's plane, it may decide differently from exact arithmetic. The bound of T is a length
/// along the ray.
struct Algorithm {
  const char* name;
  template <typename S>
  using Function = reference::Outcome<S> (*)(const BasicRay<S>&, const BasicTriangle<S>&);
  Function<float> fp32;
  Function<Fp16> fp16;
  Function<Bf16> bf16;
  Function<Fp24> fp24;
  Function<double> fp64;
  double (*band)(const Shape&);
  double (*depth)(const Shape&, double distance);  ///< distance: t |D|
};

template <typename S>
Algorithm::Function<S> pick(const Algorithm& a) {
  if constexpr (std::is_same_v<S, float>) return a.fp32;
  if constexpr (std::is_same_v<S, Fp16>) return a.fp16;
  if constexpr (std::is_same_v<S, Bf16>) return a.bf16;
  if constexpr (std::is_same_v<S, Fp24>) return a.fp24;
  if constexpr (std::is_same_v<S, double>) return a.fp64;
}

#define CDE_EVERY_FORMAT(FUNCTION) \
  FUNCTION<float>, FUNCTION<Fp16>, FUNCTION<Bf16>, FUNCTION<Fp24>, FUNCTION<double>

const Algorithm kBadouel{
    "badouel", CDE_EVERY_FORMAT(reference::ray_triangle_badouel),
    [](const Shape& s) { return reference::kBadouelBand * (s.world + s.slim / 4) / s.cos; },
    [](const Shape& s, double) { return reference::kBadouelDepth * (s.world + s.slim) / s.cos; }};
const Algorithm kPluecker{"pluecker", CDE_EVERY_FORMAT(reference::ray_triangle_pluecker),
                          [](const Shape& s) { return reference::kPlueckerBand * s.world / s.cos; },
                          [](const Shape& s, double distance) {
                            return reference::kPlueckerDepth * s.world / s.cos *
                                   (1 + distance * s.around);
                          }};
const Algorithm kWatertight{
    "watertight", CDE_EVERY_FORMAT(reference::ray_triangle_watertight),
    [](const Shape& s) { return reference::kWatertightBand * s.reach / s.cos; },
    [](const Shape& s, double) {
      return reference::kWatertightDepth * s.reach * (1 + s.aspect) / s.cos;
    }};
#undef CDE_EVERY_FORMAT

std::ostream& operator<<(std::ostream& out, const Algorithm* algorithm) {
  return out << algorithm->name;
}

enum class Truth { kHit, kMiss, kUncertain };

/// How far inside the edges (in the triangle's plane) and the interval (along the ray) the hit is;
/// negative outside.
struct Margins {
  double edge, interval;
  Margins(const Ray& ray, const ExactHit& exact, const Shape& shape) {
    const double u = static_cast<double>(exact.u), v = static_cast<double>(exact.v),
                 rest = static_cast<double>(ExactHit::Rational(1 - exact.u - exact.v)),
                 t = static_cast<double>(exact.t);
    edge = std::min({u * shape.height[0], v * shape.height[1], rest * shape.height[2]});
    interval = std::min(t - ray.tmin, ray.tmax - t) * shape.direction;
  }
};

Truth decide(const Margins& m, double band, double depth) {
  if (m.edge < -band || m.interval < -depth) return Truth::kMiss;
  return m.edge > band && m.interval > depth ? Truth::kHit : Truth::kUncertain;
}

struct Report {
  int pairs = 0, hits = 0, uncertain = 0, uncertain_wrong = 0, wrong = 0;
  double worst_edge = 0;   ///< largest distance from an edge with wrong F, over the band
  double worst_depth = 0;  ///< worst error of T, over its bound
  double worst_point = 0;  ///< worst error of CP, over the bound of T and u of the terms
};

template <typename S>
Report judge(const Algorithm& algorithm, Scene scene, int pairs) {
  const double u = reference::kUnitRoundoff<S>;
  scene.finest = std::max(-9.0, std::log10(u));
  Random random;
  Report r;
  while (r.pairs < pairs) {
    // The words that the format holds, as floats, which represent all formats except fp64.
    const auto [made_ray, made_triangle] = make(random, scene);
    const auto ray_s = primitive_cast<S>(made_ray);
    const auto triangle_s = primitive_cast<S>(made_triangle);
    const Ray ray = primitive_cast<float>(ray_s);
    const Triangle triangle = primitive_cast<float>(triangle_s);
    if (reference::bad(ray_s) || reference::bad(triangle_s)) continue;
    const ExactHit exact(ray, triangle);
    if (exact.det == 0) continue;
    const Shape shape(ray, triangle);
    if (shape.cos < scene.least_cos) continue;
    ++r.pairs;
    const Margins margins(ray, exact, shape);
    const double t = static_cast<double>(exact.t), distance = std::abs(t) * shape.direction;
    const double band = u * algorithm.band(shape), depth = u * algorithm.depth(shape, distance);
    const Truth truth = decide(margins, band, depth);
    const auto got = pick<S>(algorithm)(ray_s, triangle_s);
    r.hits += got.f;
    if (got.f != exact.hit(ray) && margins.interval > depth)
      r.worst_edge = std::max(r.worst_edge, std::abs(margins.edge) / band);
    if (truth == Truth::kUncertain) {
      ++r.uncertain, r.uncertain_wrong += got.f != exact.hit(ray);
    } else {
      r.wrong += got.f != (truth == Truth::kHit);
    }
    if (!got.f) continue;
    const double error = std::abs(static_cast<double>(got.t) - t) * shape.direction;
    r.worst_depth = std::max(r.worst_depth, error / depth);
    const Vector3d cp = got.cp.template cast<double>(),
                   at = ray.o.cast<double>() + t * ray.d.cast<double>();
    const double rounding = 2 * u * (at.cwiseAbs().maxCoeff() + ray.o.cwiseAbs().maxCoeff());
    r.worst_point = std::max(r.worst_point, (cp - at).cwiseAbs().maxCoeff() / (depth + rounding));
  }
  return r;
}

template <typename S>
void expect_right(const Algorithm& algorithm, const Scene& scene, int pairs, const char* format,
                  double most_uncertain = 0.5) {
  const Report r = judge<S>(algorithm, scene, pairs);
  std::printf(
      "%s %s %s: seed %u, %d pairs, %.1f %% hit, wrong outside the band %d, uncertain %d (%.2f "
      "%%), of "
      "them %d decided otherwise than exact arithmetic; furthest wrong F at %.2f of the band, T "
      "off by %.2f of its bound, CP by %.2f\n",
      algorithm.name, format, scene.name, Random::kSeed, r.pairs, 100.0 * r.hits / r.pairs, r.wrong,
      r.uncertain, 100.0 * r.uncertain / r.pairs, r.uncertain_wrong, r.worst_edge, r.worst_depth,
      r.worst_point);
  EXPECT_EQ(r.wrong, 0);
  EXPECT_LE(r.worst_depth, 1);
  EXPECT_LE(r.worst_point, 1);
  EXPECT_GT(r.hits, 0.3 * r.pairs);
  EXPECT_LT(r.hits, 0.7 * r.pairs);
  EXPECT_LT(r.uncertain, most_uncertain * r.pairs) << "the band excuses too many pairs";
}

using Judged = std::tuple<Scene, const Algorithm*>;
class RayTriangle : public ::testing::TestWithParam<Judged> {};
INSTANTIATE_TEST_SUITE_P(
    Scenes, RayTriangle,
    ::testing::Combine(::testing::Values(Scene{"AtOrigin", 0, 1, 4}, Scene{"TenAway", 10, 1, 4},
                                         Scene{"ThousandAway", 1000, 10, 40},
                                         Scene{"Small", 0, 1e-2, 1}, Scene{"Large", 0, 1e3, 1e3},
                                         Scene{"Needles", 0, 1, 4, 0.2, 1e-2}),
                       ::testing::Values(&kBadouel, &kPluecker, &kWatertight)),
    [](const auto& info) {
      return std::string(std::get<0>(info.param).name) + "_" + std::get<1>(info.param)->name;
    });

TEST_P(RayTriangle, Decisions_AreRightOutsideTheBand) {
  const auto& [scene, algorithm] = GetParam();
  expect_right<float>(*algorithm, scene, 4000, "fp32");
}

class RayTriangleFormats : public ::testing::TestWithParam<const Algorithm*> {};
INSTANTIATE_TEST_SUITE_P(Algorithms, RayTriangleFormats,
                         ::testing::Values(&kBadouel, &kPluecker, &kWatertight),
                         [](const auto& info) { return std::string(info.param->name); });

TEST_P(RayTriangleFormats, Band_ScalesWithTheRoundoff) {
  const Scene scene{"Unit", 0, 4, 2, 0.1, 1, 0.3};
  expect_right<Fp16>(*GetParam(), scene, 2000, "fp16");
  expect_right<Bf16>(*GetParam(), scene, 2000, "bf16", 0.95);
  expect_right<Fp24>(*GetParam(), scene, 2000, "fp24");
  expect_right<double>(*GetParam(), scene, 2000, "fp64");
}

// ---- Leaks ----

using ReferenceF = Algorithm::Function<float>;
const std::pair<const char*, ReferenceF> kAll[] = {
    {"moller", reference::ray_triangle_moller<float>},
    {"badouel", reference::ray_triangle_badouel<float>},
    {"pluecker", reference::ray_triangle_pluecker<float>},
    {"watertight", reference::ray_triangle_watertight<float>},
    {"moller_box", reference::ray_triangle_moller<float, true>},
    {"badouel_box", reference::ray_triangle_badouel<float, true>},
    {"pluecker_box", reference::ray_triangle_pluecker<float, true>},
    {"watertight_box", reference::ray_triangle_watertight<float, true>}};

bool leaks(const std::vector<Triangle>& triangles, const Ray& ray, ReferenceF run) {
  for (const Triangle& triangle : triangles)
    if (run(ray, triangle).f) return false;
  return true;
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> all;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) all.push_back(mesh.triangle(i));
  return all;
}

/// Rays from inside a closed mesh, aimed at its edges and vertices, where the rounded point lies on
/// either side.
TEST(Leaks, RaysInAnIcosphere_LeakOnlyWithoutWatertight) {
  constexpr int kRays = 20000;
  const std::vector<Triangle> mesh =
      triangles_of(load_mesh(std::string(CDE_SOURCE_DIR) + "/meshes/icosphere.ply"));
  std::map<std::string, int> leaked;
  Random random;
  for (int i = 0; i < kRays; ++i) {
    const Triangle& aim = mesh[random.below(mesh.size())];
    const double s = random.chance(0.3) ? 0 : random.unit();
    const Vector3d at = aim.v0.cast<double>() * (1 - s) + aim.v1.cast<double>() * s;
    Ray ray;
    ray.o = (0.5 * random.vector()).cast<float>();
    ray.d = ((at - ray.o.cast<double>()) * random.decades(-1, 1)).cast<float>();
    for (const auto& [name, run] : kAll) leaked[name] += leaks(mesh, ray, run);
  }
  for (const auto& [name, n] : leaked)
    std::printf("icosphere, seed %u, %d rays at edges and vertices: %s leaks %d (%.2f %%)\n",
                Random::kSeed, kRays, name.c_str(), n, 100.0 * n / kRays);
  EXPECT_EQ(leaked["watertight"], 0);
  EXPECT_EQ(leaked["watertight_box"], 0);
  EXPECT_GT(leaked["moller"], 0) << "the rays are too easy";
}

/// Embree's recipe: a sphere of radius 2 with 200 by 200 quads, and rays from anywhere inside in
/// any direction. It lies so far from the world's origin that vertices stand on a grid of 1/64. On
/// this grid differences and products are exact, so Moeller does not leak either.
TEST(Leaks, FarSphere_LeaksOnlyInWorldCoordinates) {
  constexpr int kSteps = 200, kRays = 300;
  const Vector3d centre(148376, 1234, -223423);
  std::vector<Vector3f> vertices;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double theta = M_PI * i / kSteps, phi = 2 * M_PI * j / kSteps;
      const double ring = i == 0 || i == kSteps ? 0 : std::sin(theta);  // the poles are one point
      vertices.push_back(
          (centre + 2 * Vector3d(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta)))
              .cast<float>());
    }
  }
  std::vector<Triangle> mesh;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const auto at = [&](int a, int b) { return vertices[a * kSteps + b % kSteps]; };
      mesh.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  std::map<std::string, int> leaked;
  Random random;
  for (int i = 0; i < kRays; ++i) {
    Ray ray;
    ray.o = (centre + random.vector()).cast<float>();
    ray.d = random.vector().cast<float>();
    if (i % 2 == 0) ray.d = vertices[random.below(vertices.size())] - ray.o;  // exact
    for (const auto& [name, run] : kAll) leaked[name] += leaks(mesh, ray, run);
  }
  for (const auto& [name, n] : leaked)
    std::printf("sphere far from the origin, seed %u, %d rays: %s leaks %d\n", Random::kSeed, kRays,
                name.c_str(), n);
  EXPECT_EQ(leaked["watertight"], 0);
  EXPECT_EQ(leaked["watertight_box"], 0);
  EXPECT_GT(leaked["badouel"], 0) << "badouel must leak: it works in world coordinates";
}

/// The same in the other formats: the edge functions stay antisymmetric in all of them.
template <typename S>
int leaks_of_octahedron(int rays) {
  std::vector<BasicTriangle<S>> mesh;
  for (int k = 0; k < 8; ++k) {
    const auto corner = [&](int axis) {
      return Vector3d(Vector3d::Unit(axis) * ((k >> axis & 1) != 0 ? 1 : -1));
    };
    const Vector3d shift(0.1, -0.2, 0.05);
    mesh.push_back(primitive_cast<S>(
        BasicTriangle<double>{corner(0) + shift, corner(1) + shift, corner(2) + shift}));
  }
  Random random;
  int leaked = 0;
  for (int i = 0; i < rays; ++i) {
    const double s = random.chance(0.2) ? 0 : random.unit();
    const auto& aim = mesh[random.below(mesh.size())];
    const Vector3d at =
        aim.v0.template cast<double>() * (1 - s) + aim.v1.template cast<double>() * s;
    BasicRay<double> ray{0.15 * random.vector(), {}, 0, std::numeric_limits<double>::infinity()};
    ray.d = at - ray.o;
    const auto ray_s = primitive_cast<S>(ray);
    bool out = true;
    for (const auto& triangle : mesh)
      out = out && !reference::ray_triangle_watertight<S, true>(ray_s, triangle).f;
    leaked += out;
  }
  return leaked;
}

TEST(Leaks, Watertight_LeaksInNoFormat) {
  constexpr int kRays = 20000;
  EXPECT_EQ(leaks_of_octahedron<Fp16>(kRays), 0);
  EXPECT_EQ(leaks_of_octahedron<Bf16>(kRays), 0);
  EXPECT_EQ(leaks_of_octahedron<Fp24>(kRays), 0);
  EXPECT_EQ(leaks_of_octahedron<float>(kRays), 0);
  EXPECT_EQ(leaks_of_octahedron<double>(kRays), 0);
}

// ---- Watertight against its source ----

/// Woop, Benthin and Wald 2013, appendix A, two-sided, with their exchange of kx and ky (which the
/// mirror omits) and their own sign test. Their T multiplies by Sz first, the mirror's last.
/// `reach` is the scale of both roundings.
reference::Outcome<float> woop(const Ray& ray, const Triangle& triangle, float& reach) {
  int kz = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(ray.d[k]) > std::abs(ray.d[kz])) kz = k;
  int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
  if (ray.d[kz] < 0) std::swap(kx, ky);
  const float sz = 1.0f / ray.d[kz], sx = ray.d[kx] * sz, sy = ray.d[ky] * sz;
  const Vector3f a = triangle.v0 - ray.o, b = triangle.v1 - ray.o, c = triangle.v2 - ray.o;
  const float ax = a[kx] - sx * a[kz], ay = a[ky] - sy * a[kz];
  const float bx = b[kx] - sx * b[kz], by = b[ky] - sy * b[kz];
  const float cx = c[kx] - sx * c[kz], cy = c[ky] - sy * c[kz];
  const float u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  reference::Outcome<float> r;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return r;
  const float det = u + v + w;
  if (det == 0) return r;
  reach = std::abs(sz) * std::max({std::abs(a[kz]), std::abs(b[kz]), std::abs(c[kz])});
  const float t = (u * (sz * a[kz]) + v * (sz * b[kz]) + w * (sz * c[kz])) / det;
  if (t < ray.tmin || t > ray.tmax) return r;
  r.f = true, r.t = t;
  return r;
}

TEST(Watertight, Watertight_EqualsThePublishedAlgorithm) {
  Random random;
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto [ray, triangle] = make(random, {"", 0, 1, 4});
    float reach = 0;
    const auto expected = woop(ray, triangle, reach),
               got = reference::ray_triangle_watertight(ray, triangle);
    ASSERT_EQ(got.f, expected.f);
    if (got.f) {
      ASSERT_LE(std::abs(got.t - expected.t), 0x1p-20f * reach);
    }
    hits += got.f;
  }
  EXPECT_GT(hits, 6000);
}

// ---- Cases by hand ----

class EveryAlgorithm : public ::testing::TestWithParam<std::pair<const char*, ReferenceF>> {};
INSTANTIATE_TEST_SUITE_P(Algorithms, EveryAlgorithm, ::testing::ValuesIn(kAll),
                         [](const auto& info) { return std::string(info.param.first); });

const Triangle kPlain{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}};

TEST_P(EveryAlgorithm, CornersEdgesAndBothFaces_AreHit) {
  const ReferenceF run = GetParam().second;
  const Triangle turned{kPlain.v0, kPlain.v2, kPlain.v1};
  for (const Triangle& triangle : {kPlain, turned}) {
    for (const auto& [x, y] : {std::pair{0.0f, 0.0f},
                               {1, 0},
                               {0, 1},
                               {0.5f, 0},
                               {0, 0.5f},
                               {0.5f, 0.5f},
                               {0.25f, 0.25f}}) {
      for (const float from : {0.0f, 4.0f}) {
        const auto got = run({{x, y, from}, {-0.0f, 0, 2 - from}}, triangle);
        EXPECT_TRUE(got.f) << x << " " << y;
        EXPECT_EQ(got.t, 1);
        EXPECT_EQ(got.cp, Vector3f(x, y, 2));
      }
    }
    for (const auto& [x, y] : {std::pair{-1e-6f, 0.5f}, {0.5f, -1e-6f}, {0.500001f, 0.500001f}})
      EXPECT_FALSE(run({{x, y, 0}, {0, 0, 1}}, triangle).f) << x << " " << y;
  }
}

TEST_P(EveryAlgorithm, IntervalEnds_AreInside) {
  const ReferenceF run = GetParam().second;
  const auto hit = [&](float tmin, float tmax) {
    return run({{0.25f, 0.25f, 0}, {0, 0, 1}, tmin, tmax}, kPlain).f;
  };
  const float after = std::nextafter(2.0f, 3.0f), before = std::nextafter(2.0f, 1.0f);
  EXPECT_TRUE(hit(0, 2));
  EXPECT_TRUE(hit(2, kInf));
  EXPECT_TRUE(hit(2, 2));
  EXPECT_FALSE(hit(0, before));
  EXPECT_FALSE(hit(after, kInf));
  EXPECT_FALSE(hit(3, 1));
  EXPECT_FALSE(hit(-kInf, 0));
}

TEST_P(EveryAlgorithm, TrianglesWithoutApparentArea_AreMissed) {
  const ReferenceF run = GetParam().second;
  const Vector3f a(0, 0, 2), b(1, 0, 2), c(2, 0, 2);
  const Ray down{{0.5f, 0, 0}, {0, 0, 1}};
  EXPECT_FALSE(run(down, {a, b, c}).f) << "collinear corners";
  EXPECT_FALSE(run(down, {a, a, b}).f) << "a segment";
  EXPECT_FALSE(run({{0, 0, 0}, {0, 0, 1}}, {a, a, a}).f) << "a point";
  EXPECT_FALSE(run({{-1, 0.25f, 2}, {1, 0, 0}}, kPlain).f) << "ray in its plane";
  EXPECT_FALSE(run({{-1, 0.25f, 1}, {1, 0, 0}}, kPlain).f) << "ray parallel to its plane";
}

TEST_P(EveryAlgorithm, Miss_IsInfinityAndZero) {
  const auto got = GetParam().second({{5, 5, 0}, {0, 0, 1}}, kPlain);
  EXPECT_FALSE(got.f);
  EXPECT_FALSE(got.bad);
  EXPECT_EQ(got.t, kInf);
  EXPECT_EQ(got.cp, Vector3f(0, 0, 0));
}

TEST_P(EveryAlgorithm, BadInputInAnyWord_IsFlagged) {
  const ReferenceF run = GetParam().second;
  const Ray ray{{0.25f, 0.25f, 0}, {0, 0, 1}};
  for (const float poison : {std::numeric_limits<float>::quiet_NaN(), kInf, -kInf}) {
    for (std::size_t i = 0; i < 17; ++i) {
      if ((i == 6 || i == 7) && std::isinf(poison)) continue;  // an interval may be infinite
      auto ray_words = to_words(ray);
      auto triangle_words = to_words(kPlain);
      (i < 8 ? ray_words[i] : triangle_words[i - 8]) = poison;
      const auto got = run(from_words<Ray>(ray_words), from_words<Triangle>(triangle_words));
      EXPECT_TRUE(got.bad) << i;
      EXPECT_FALSE(got.f) << i;
      EXPECT_TRUE(std::isnan(got.t) && got.cp.array().isNaN().all()) << i;
    }
  }
}

// ---- The table of docs/reference/pairs_rays.md ----

TEST(Operators, Counts_EqualTheDocs) {
  std::string multipliers = "| multipliers |", dividers = "| dividers |",
              adders = "| adders, subtractors |", comparators = "| comparators |",
              cycles = "| cycles at one per operator |";
  for (unsigned a = 0; a < kAlgorithms; ++a) {
    const Tally n = operators(Pair::kRayTriangle, static_cast<cde::Algorithm>(a));
    multipliers += fmt::format(" {} |", n.mul), dividers += fmt::format(" {} |", n.div);
    adders += fmt::format(" {}, {} |", n.add, n.sub), comparators += fmt::format(" {} |", n.cmp);
    cycles += fmt::format(" {} |", n.depth + 1);  // plus the selection of the outcome
  }
  expect_in_docs("reference/pairs_rays.md", {multipliers, dividers, adders, comparators, cycles});
}

}  // namespace
}  // namespace cde::testing
