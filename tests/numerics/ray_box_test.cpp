// SPDX-License-Identifier: Apache-2.0
// The box rule of ray and triangle: triangles without area, rays in a triangle's plane, dropped
// hits, and how far outside of its box an accepted hit may lie. Also the promises of every ray
// pair: finite T and CP, and no -0.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "cde/geometry/bounds.hpp"
#include "cde/oracle/exact.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/ray_triangle.hpp"
#include "in_docs.hpp"
#include "random.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using reference::Outcome;

constexpr double kU = 0x1p-24;

struct Algorithm {
  const char* name;
  Outcome<float> (*plain)(const Ray&, const Triangle&);
  Outcome<float> (*boxed)(const Ray&, const Triangle&);
};

std::ostream& operator<<(std::ostream& out, const Algorithm& a) {
  return out << a.name;
}

#define CDE_ALGORITHM(NAME)                                                                        \
  Algorithm {                                                                                      \
#NAME, reference::ray_triangle_##NAME < float, false>, reference::ray_triangle_##NAME < float, \
        true>                                                                                      \
  }
const Algorithm kAlgorithms[] = {CDE_ALGORITHM(moller), CDE_ALGORITHM(badouel),
                                 CDE_ALGORITHM(pluecker), CDE_ALGORITHM(watertight)};
#undef CDE_ALGORITHM

/// The distance of o + t d outside the triangle's box, over the allowed m' of ray_box.hpp.
double outside(const Ray& ray, const Triangle& triangle, float t, double& distance) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  const Wide td = static_cast<long double>(t) * ray.d.cast<long double>(),
             p = ray.o.cast<long double>() + td;
  const Vector3f low = triangle.v0.cwiseMin(triangle.v1).cwiseMin(triangle.v2),
                 high = triangle.v0.cwiseMax(triangle.v1).cwiseMax(triangle.v2);
  const Wide off =
      (low.cast<long double>() - p).cwiseMax(p - high.cast<long double>()).cwiseMax(0.0L);
  distance = static_cast<double>(off.maxCoeff());
  const double world = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff(),
               step = static_cast<double>(td.cwiseAbs().sum());
  return distance /
         (reference::kBoxRay * kU * step * (1 + 4 * kU) + (reference::kBoxWorld + 4) * kU * world);
}

class BoxRule : public ::testing::TestWithParam<Algorithm> {};
INSTANTIATE_TEST_SUITE_P(Algorithms, BoxRule, ::testing::ValuesIn(kAlgorithms),
                         [](const auto& info) { return std::string(info.param.name); });

// ---- Triangles without area, and rays in the plane of a triangle, in exact arithmetic ----

bool without_area(const Triangle& triangle) {
  using R = ExactHit::Rational;
  R a[3], b[3];
  for (int k = 0; k < 3; ++k)
    a[k] = R(triangle.v1[k]) - R(triangle.v0[k]), b[k] = R(triangle.v2[k]) - R(triangle.v0[k]);
  for (int i = 0; i < 3; ++i)
    if (a[i] * b[(i + 1) % 3] != a[(i + 1) % 3] * b[i]) return false;
  return true;
}

Triangle flat_triangle(Random& random) {
  const double scale = random.chance(0.5) ? 1 : 0.1;  // tenths are rounded
  const Vector3d a = scale * random.integers(9), along = scale * random.integers(9);
  const auto f = [](const Vector3d& v) -> Vector3f { return v.cast<float>(); };
  const Vector3f v = f(a), w = f(a + along);
  switch (random.integer(0, 4)) {
    case 0:
      return {v, v, w};
    case 1:
      return {v, w, w};
    case 2:
      return {v, w, v};
    case 3:
      return {v, v, v};
    default:  // on a line in exact arithmetic, for any coordinates
      const Vector3f d = f(random.decades(-3, 3) * random.vector());
      const float at = static_cast<float>(random.integer(-8, 8)) / 4;
      Triangle t{f(scale * random.integers(2)), {}, {}};
      for (int k = 0; k < 3; ++k) {
        // A grid on which both sums are exact.
        const float step = std::ldexp(std::round(std::ldexp(d[k], 8)), -8);
        t.v1[k] = t.v0[k] + step, t.v2[k] = t.v0[k] + at * step;
      }
      return t;
  }
}

TEST_P(BoxRule, TriangleWithoutArea_IsNeverHit) {
  constexpr int kCases = 4000;
  Random random;
  int cases = 0, plain = 0, boxed = 0;
  while (cases < kCases) {
    const Triangle triangle = flat_triangle(random);
    if (!without_area(triangle)) continue;
    const double scale = random.chance(0.5) ? 1 : 0.1;
    Ray ray;
    ray.o = (scale * random.integers(30)).cast<float>();
    const double s = random.unit();
    Vector3d at = scale * random.integers(9);
    if (random.chance(0.5))
      at = triangle.v0.cast<double>() * (1 - s) + triangle.v2.cast<double>() * s;
    ray.d = (at - ray.o.cast<double>()).cast<float>();
    if (reference::bad(ray)) continue;
    ++cases;
    plain += GetParam().plain(ray, triangle).f;
    boxed += GetParam().boxed(ray, triangle).f;
  }
  std::printf("%s, without area: seed %u, %d exact cases, plain pipe %d hits, with the rule %d\n",
              GetParam().name, Random::kSeed, kCases, plain, boxed);
  EXPECT_EQ(boxed, 0);
}

TEST_P(BoxRule, RaysInThePlane_HitTheBoxOrNothing) {
  constexpr int kCases = 4000;
  Random random;
  int cases = 0, plain = 0, boxed = 0;
  double far_plain = 0, far_boxed = 0, worst = 0;
  while (cases < kCases) {
    const double scale = random.chance(0.5) ? 1 : 0.1;
    const Vector3d a = random.integers(9), e1 = random.integers(9), e2 = random.integers(9);
    const Vector3d o = a + random.integer(-9, 9) * e1 + random.integer(-9, 9) * e2,
                   d = random.integer(-9, 9) * e1 + random.integer(-9, 9) * e2;
    const auto f = [scale](const Vector3d& v) -> Vector3f { return (scale * v).cast<float>(); };
    const Triangle triangle{f(a), f(a + e1), f(a + e2)};
    const Ray ray{f(o), f(d)};
    // Tenths are rounded, so their rays are only nearly in the plane.
    if (reference::bad(ray) || without_area(triangle)) continue;
    if (scale == 1 && ExactHit(ray, triangle).det != 0) continue;
    ++cases;
    const double size = (triangle.v1 - triangle.v0).norm() + (triangle.v2 - triangle.v0).norm();
    double distance = 0;
    if (const auto r = GetParam().plain(ray, triangle); r.f) {
      ++plain;
      (void)outside(ray, triangle, r.t, distance);
      far_plain = std::max(far_plain, distance / size);
    }
    if (const auto r = GetParam().boxed(ray, triangle); r.f) {
      ++boxed;
      worst = std::max(worst, outside(ray, triangle, r.t, distance));
      far_boxed = std::max(far_boxed, distance / size);
    }
  }
  std::printf(
      "%s, edge-on: seed %u, %d cases, plain pipe %d hits up to %.3g sizes outside of the box, "
      "with "
      "the rule %d up to %.3g sizes, %.2f of the margin\n",
      GetParam().name, Random::kSeed, kCases, plain, far_plain, boxed, far_boxed, worst);
  EXPECT_LE(worst, 1);
  EXPECT_GE(plain, boxed);
}

// ---- Hits that the rule drops ----

struct Scene {
  const char* name;
  double offset, size, distance;
  double needle = 0.1;  ///< smallest height over length
  int grazing = 0;      ///< rays along the plane: 1 within 2^-26 to 2^-3, 2 up to rounding
};

const Scene kScenes[] = {{"plain", 0, 1, 4},
                         {"ten thousand sizes away", 0, 1, 1e4},
                         {"a thousand from the origin", 1000, 10, 40},
                         {"large triangles", 0, 1e3, 4},
                         {"needles", 0, 1, 4, 0x1p-14},
                         {"needles far away", 0, 1e-2, 4, 0x1p-14},
                         {"grazing", 0, 1, 4, 0.1, 1},
                         {"grazing needles", 0, 1, 4, 0x1p-14, 1},
                         {"in the plane", 0, 1, 4, 0.1, 2}};

std::pair<Ray, Triangle> make(Random& random, const Scene& scene) {
  BasicRay<double> ray;
  ray.o = random.vector() + Vector3d::Constant(scene.offset);
  ray.d = random.vector() * random.decades(-1, 1);
  const Vector3d e1 = scene.size * random.vector();
  const double slim = std::pow(scene.needle, random.unit());
  const Vector3d e2 = random.between(-1, 2) * e1 + scene.size * slim * random.vector();
  if (scene.grazing != 0) {
    const double off = scene.grazing == 1 ? std::exp2(random.between(-26, -3)) : 0;
    const Vector3d in_plane = random.between(-1, 1) * e1 + random.between(-1, 1) * e2;
    ray.d = ray.d.norm() * (in_plane.normalized() + off * random.vector());
  }
  const double t = random.between(0.01, 1) * scene.distance / ray.d.norm();
  double u = random.between(-0.15, 1.15), v = random.between(-0.15, 1.15) * (1 - u);
  if (random.chance(0.5)) (random.chance(0.5) ? u : v) = random.sign() * random.decades(-9, -2);
  const Vector3d v0 = ray.o + t * ray.d - u * e1 - v * e2;
  return {primitive_cast<float>(ray),
          primitive_cast<float>(BasicTriangle<double>{v0, v0 + e1, v0 + e2})};
}

/// A hit that is certain within the bounds of the algorithm (ray_triangle.hpp, bounds.hpp).
bool certain(const Algorithm& algorithm, const Ray& ray, const Triangle& triangle) {
  const ExactHit exact(ray, triangle);
  if (exact.det == 0) return false;
  const double u = static_cast<double>(exact.u), v = static_cast<double>(exact.v),
               rest = static_cast<double>(ExactHit::Rational(1 - exact.u - exact.v)),
               t = static_cast<double>(exact.t), det = static_cast<double>(exact.det);
  const std::string name = algorithm.name;
  if (name == "moller") {
    const MollerBound b = moller_bound(ray, triangle);
    const double size = std::abs(det);
    return size > b.det && u * size > b.u && v * size > b.v && rest * size > b.uv + b.det &&
           t > b.t(det, t);
  }
  const Vector3d o = ray.o.cast<double>(), v0 = triangle.v0.cast<double>(),
                 e1 = triangle.v1.cast<double>() - v0, e2 = triangle.v2.cast<double>() - v0,
                 normal = e1.cross(e2);
  double world = o.cwiseAbs().maxCoeff(), reach = 0;
  for (const Vector3f& p : {triangle.v0, triangle.v1, triangle.v2}) {
    world = std::max<double>(world, p.cwiseAbs().maxCoeff());
    reach = std::max(reach, (p.cast<double>() - o).norm());
  }
  const double a = e1.norm(), b = e2.norm(), c = (e2 - e1).norm(), area = normal.norm(),
               direction = ray.d.cast<double>().norm(),
               cos = std::abs(normal.dot(ray.d.cast<double>())) / (area * direction);
  const double slim = a * b * (a + b) / area, longest = std::max({a, b, c});
  const double band = name == "badouel"    ? reference::kBadouelBand * (world + slim / 4)
                      : name == "pluecker" ? reference::kPlueckerBand * world
                                           : reference::kWatertightBand * reach,
               depth = name == "badouel" ? reference::kBadouelDepth * (world + slim)
                       : name == "pluecker"
                           ? reference::kPlueckerDepth * world *
                                 (1 + std::abs(t) * direction * (a + b + c) / area)
                           : reference::kWatertightDepth * reach * (1 + longest * longest / area);
  return std::min({u * area / b, v * area / a, rest * area / c}) > kU * band / cos &&
         t * direction > kU * depth / cos;
}

TEST_P(BoxRule, CertainHitsOfPlainTriangles_AreKept) {
  constexpr int kPairs = 20000;
  const bool own_t = std::string(GetParam().name) == "pluecker";  // divided by N.D
  for (const Scene& scene : kScenes) {
    Random random;
    int hits = 0, dropped = 0, sure = 0, more = 0;
    double worst = 0;
    for (int i = 0; i < kPairs; ++i) {
      const auto [ray, triangle] = make(random, scene);
      if (reference::bad(ray) || reference::bad(triangle)) continue;
      const auto plain = GetParam().plain(ray, triangle), boxed = GetParam().boxed(ray, triangle);
      hits += plain.f, more += boxed.f && !plain.f;
      if (plain.f && !boxed.f) ++dropped, sure += certain(GetParam(), ray, triangle);
      if (!boxed.f) continue;
      double distance = 0;
      worst = std::max(worst, outside(ray, triangle, boxed.t, distance));
      if (plain.f && !own_t) {
        ASSERT_EQ(boxed.t, plain.t);
        ASSERT_EQ(boxed.cp, plain.cp);
      }
    }
    std::printf(
        "%s, %s: seed %u, %d pairs, %d hits, the rule drops %d, %d of them certain; accepted ones "
        "at most %.2f of the margin outside\n",
        GetParam().name, scene.name, Random::kSeed, kPairs, hits, dropped, sure, worst);
    EXPECT_LE(worst, 1);
    // Only the T of pluecker differs, sometimes in sign where it is noise.
    EXPECT_LE(more, !own_t ? 0 : scene.grazing != 0 ? hits / 4 : hits / 100);
    EXPECT_GT(hits, kPairs / 20);
    const bool needles = scene.needle < 0.1;
    EXPECT_LE(sure, needles ? hits / 2000 : 0);
    if (!needles && scene.grazing == 0) {
      EXPECT_LE(dropped, hits / 200);
    }
  }
}

/// 12345 as 12,345.
std::string grouped(int n) {
  return n < 1000 ? std::to_string(n) : fmt::format("{},{:03}", n / 1000, n % 1000);
}

/// Dropped hits of rays aimed at the inside of needles, by their height over their length.
TEST(Needles, DroppedCertainHits_EqualTheDocs) {
  constexpr int kPairs = 10000;
  std::vector<std::string> lines;
  for (const int width : {4, 8, 10, 12, 14, 16}) {
    int hits[4] = {}, dropped[4] = {}, certain_dropped[4] = {}, sure = 0;
    Random random;
    for (int i = 0; i < kPairs; ++i) {
      BasicRay<double> exact{random.vector(), random.vector(), 0,
                             std::numeric_limits<double>::infinity()};
      const Vector3d e1 = random.vector();
      const Vector3d across = e1.cross(random.vector()).normalized();
      const double along = random.unit(), height = std::ldexp(e1.norm(), -width) * random.sign();
      const Vector3d e2 = along * e1 + height * across;
      const double u = random.unit(), v = random.unit() * (1 - u);
      const Vector3d v0 =
          exact.o + random.between(0.04, 4) * exact.d.normalized() - u * e1 - v * e2;
      const auto ray = primitive_cast<float>(exact);
      const auto triangle = primitive_cast<float>(BasicTriangle<double>{v0, v0 + e1, v0 + e2});
      if (reference::bad(ray) || reference::bad(triangle)) continue;
      for (int k = 0; k < 4; ++k) {
        const Algorithm& algorithm = kAlgorithms[k];
        if (!algorithm.plain(ray, triangle).f) continue;
        ++hits[k];
        const bool drops = !algorithm.boxed(ray, triangle).f;
        const bool of_moller = k == 0 && certain(algorithm, ray, triangle);
        sure += of_moller;
        if (!drops) continue;
        ++dropped[k];
        certain_dropped[k] += k == 0 ? of_moller : certain(algorithm, ray, triangle);
      }
    }
    const auto cell = [&](int k) {
      return fmt::format("{} ({}) of {}", grouped(dropped[k]), certain_dropped[k],
                         grouped(hits[k]));
    };
    lines.push_back(fmt::format("| 2^-{} | {} | {} | {} | {} | {} |", width, grouped(sure), cell(0),
                                cell(1), cell(2), cell(3)));
    for (const int n : certain_dropped) EXPECT_LE(n, width <= 4 ? 0 : kPairs / 400);
    EXPECT_GT(sure, kPairs / 10);
  }
  expect_in_docs("tables/pairs.md", lines);
}

TEST(FlatTriangle, FlatTriangle_IsFlatAtEveryScale) {
  // A triangle is flat at any size: the test scales.
  for (const float size : {0x1p-50f, 1.0f, 0x1p50f}) {
    const auto scaled = [size](float x, float y, float z) -> Vector3f {
      return size * Vector3f(x, y, z);
    };
    EXPECT_TRUE(reference::flat(Triangle{scaled(1, 2, 3), scaled(2, 4, 6), scaled(3, 6, 9)}));
    EXPECT_TRUE(reference::flat(Triangle{scaled(1, 2, 3), scaled(1, 2, 3), scaled(3, 6, 8)}));
    EXPECT_FALSE(reference::flat(Triangle{scaled(1, 2, 3), scaled(2, 4, 6), scaled(3, 6, 9.001f)}));
    EXPECT_FALSE(reference::flat(Triangle{scaled(0, 0, 0), scaled(1, 0, 0), scaled(1, 1e-5f, 0)}));
  }
}

TEST(FlatTriangle, FlatTriangle_IsFlatInEveryFormat) {
  // 4 u against the roundings of edges and products, where u is largest.
  const auto count = []<typename S>(S) {
    Random random;
    int flat = 0, cases = 0;
    while (cases < 20000) {
      const Vector3d o = random.integers(7), d = random.integers(7);
      const double k = random.integer(-3, 3), scale = std::exp2(random.integer(-6, 2));
      const auto exact = BasicTriangle<double>{scale * o, scale * (o + d), scale * (o + k * d)};
      const auto triangle = primitive_cast<S>(exact);
      if (primitive_cast<double>(triangle).v2 != exact.v2) continue;
      ++cases, flat += static_cast<bool>(reference::flat(triangle));
    }
    return cases - flat;
  };
  EXPECT_EQ(count(Fp16()), 0);
  EXPECT_EQ(count(Bf16()), 0);
  EXPECT_EQ(count(Fp24()), 0);
  EXPECT_EQ(count(float()), 0);
  EXPECT_EQ(count(double()), 0);
}

// ---- What every ray pair promises of a hit ----

/// Calls with(name, run) for every ray pipe. run(ray) returns the outcome against a shape in z = 0
/// that all rays along the z axis meet.
template <typename With>
void with_every_pipe(With with) {
  static const Triangle triangle{{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}};
  static const Sphere sphere{{0, 0, -1}, 1};
  static const Cylinder cylinder{{0, 0, -1}, {0, 0, 1}, 1, 1};
  for (const Algorithm& a : kAlgorithms) {
    with(std::string(a.name), [&](const Ray& r) { return a.plain(r, triangle); });
    with(std::string(a.name) + ", box rule", [&](const Ray& r) { return a.boxed(r, triangle); });
  }
  with("ray-sphere", [&](const Ray& r) { return reference::ray_sphere(r, sphere); });
  with("ray-cylinder", [&](const Ray& r) { return reference::ray_cylinder(r, cylinder); });
}

TEST(RayHits, Hits_AreFinite) {
  with_every_pipe([](const std::string& name, auto run) {
    SCOPED_TRACE(name);
    const auto met = run({{0, 0, 20}, {0, 0, -1}});
    EXPECT_TRUE(met.f);
    EXPECT_EQ(met.t, 20);
    for (const float z : {-1e-38f, -1e-40f, -0x1p-149f})
      EXPECT_FALSE(run({{0, 0, 20}, {0, 0, z}}).f);
    Random random;
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {  // any exponent in o and d
      const auto any = [&] { return std::bit_cast<float>(random.word()); };
      const float z = random.chance(0.5) ? 3 : std::abs(any());
      const Ray ray{
          {0, 0, z},
          {random.chance(0.5) ? 0 : any(), 0, random.chance(0.5) ? -1 : -std::abs(any())}};
      if (reference::bad(ray)) continue;
      const auto r = run(ray);
      if (!r.f) continue;
      ++hits;
      EXPECT_TRUE(std::isfinite(r.t) && r.cp.allFinite()) << r.t << " " << r.cp.transpose();
    }
    EXPECT_GT(hits, 1000);
  });
}

TEST(RayHits, HitsAtZero_AreNeverMinusZero) {
  with_every_pipe([](const std::string& name, auto run) {
    SCOPED_TRACE(name);
    int zeros = 0;
    for (const float z : {1.0f, -1.0f, 3.0f, -0.25f})
      for (const float x : {0.0f, -0.0f, 0.5f, -0.5f})
        for (const float tmin : {0.0f, -0.0f, -1.0f}) {
          // In the plane z = 0: on the triangle, on the sphere's pole, on the cylinder's cap.
          const auto r = run({{0, 0, 0}, {x, 0, z}, tmin, 0});
          if (!r.f || r.t != 0) continue;
          ++zeros;
          EXPECT_FALSE(std::signbit(r.t));
        }
    EXPECT_GT(zeros, 10);
  });
}

/// Lengths whose fourth powers leave the format, over the range of the contract: only products of
/// two lengths remain.
TEST(RayHits, WholeRange_KeepsHits) {
  for (int e = -34; e <= 38; e += 4) {
    const float s = std::ldexp(1.0f, e);
    const auto ball = reference::ray_sphere(Ray{{0, 0, -3 * s}, {0, 0, s}}, Sphere{{0, 0, 0}, s});
    EXPECT_TRUE(ball.f && ball.t == 2) << e;
    const auto can = reference::ray_cylinder(Ray{{0, -3 * s, s / 2}, {0, s, 0}},
                                             Cylinder{{0, 0, 0}, {0, 0, 1}, s, s});
    EXPECT_TRUE(can.f && can.t == 2) << e;
  }
  const auto half = reference::ray_sphere(primitive_cast<Fp16>(Ray{{0, 0, -60}, {0, 0, 20}}),
                                          primitive_cast<Fp16>(Sphere{{0, 0, 0}, 20}));
  EXPECT_TRUE(half.f && static_cast<double>(half.t) == 2);
}

// ---- Ties of the dominant axis ----

TEST(DominantAxis, Ties_TakeTheLowestAxis) {
  for (int low = 0; low < 3; ++low)
    for (int high = low + 1; high < 3; ++high)
      for (const float a : {1.0f, -1.0f})
        for (const float b : {1.0f, -1.0f}) {
          Vector3f v(0.5f, 0.5f, 0.5f);
          v[low] = a, v[high] = b;
          const reference::DominantAxis<float> axis(v);
          const Vector3f numbers(0, 1, 2);
          EXPECT_EQ(axis.largest(numbers), low);
          EXPECT_EQ(axis.next(numbers), (low + 1) % 3);
          EXPECT_EQ(axis.after_next(numbers), (low + 2) % 3);
        }
  const reference::DominantAxis<float> all(Vector3f(-2, 2, -2));
  EXPECT_EQ(all.largest(Vector3f(0, 1, 2)), 0);
}

/// Triangles in x + y = 1 and similar planes, and rays equally steep along two axes, against exact
/// arithmetic. Either choice of the axis must be right where the answer is certain.
TEST_P(BoxRule, TiesOfTheDominantAxis_AreRight) {
  Random random;
  int hits = 0, sure = 0, dominant = 0;
  for (int i = 0; i < 6000; ++i) {
    const int j = i % 3, k = (j + 1) % 3, l = (j + 2) % 3;
    const auto on = [&](double a, double b) {
      Vector3d p;
      p[j] = a, p[k] = 1 - a, p[l] = b;
      return Vector3f(p.cast<float>());
    };
    const auto eighths = [&] { return random.integer(-16, 16) / 8.0; };
    const Triangle triangle{on(eighths(), eighths()), on(eighths(), eighths()),
                            on(eighths(), eighths())};
    Ray ray;
    const double s = random.sign();
    ray.d[j] = static_cast<float>(s), ray.d[k] = static_cast<float>(random.chance(0.8) ? s : -s);
    ray.d[l] = static_cast<float>(random.between(-1, 1));
    const double u = random.between(-0.2, 1.2), v = random.between(-0.2, 1.2 - u);
    ray.o = (triangle.v0 * (1 - u - v) + triangle.v1 * u + triangle.v2 * v) -
            static_cast<float>(random.integer(1, 8)) * ray.d;
    const Vector3f n = (triangle.v1 - triangle.v0).cross(triangle.v2 - triangle.v0);
    dominant += n[j] != 0 && std::abs(n[j]) == std::abs(n[k]);
    const auto got = GetParam().plain(ray, triangle);
    hits += got.f;
    const ExactHit exact(ray, triangle);
    if (exact.det == 0) continue;
    if (exact.hit(ray) && certain(GetParam(), ray, triangle)) {
      ++sure;
      EXPECT_TRUE(got.f);
      EXPECT_NEAR(got.t, static_cast<double>(exact.t), 1e-4);
    }
  }
  std::printf("%s, ties: seed %u, 6000 pairs, %d with a tied normal, %d hits, %d certain\n",
              GetParam().name, Random::kSeed, dominant, hits, sure);
  EXPECT_GT(sure, 300);
  EXPECT_GT(dominant, 3000);
}

}  // namespace
}  // namespace cde::testing
