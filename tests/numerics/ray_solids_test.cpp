// SPDX-License-Identifier: Apache-2.0
// Answers of the mirror references of ray-sphere and ray-cylinder, against 168-bit arithmetic. An
// answer must fit a solid whose sizes are off by at most the band; uncertain cases are
// counted. Random rays use a band of 8, half of the sum of all roundings. Searches for the worst
// case use the bound itself.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <vector>

#include "amount.hpp"
#include "cde/reference/pipes/ray_cylinder.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "exact_solids.hpp"
#include "in_docs.hpp"
#include "random.hpp"

namespace cde::testing {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUsualBand = 8;

/// 1, or off by 10^finest to 10^-2.
double almost_one(Random& random, double finest) {
  return random.chance(0.2) ? 1 : 1 + random.sign() * random.decades(finest, -2);
}

struct Scene {
  const char* name;
  double size;           ///< of the solid
  double near, far;      ///< decades of the distance of the ray's origin, in sizes
  double offset;         ///< of the scene from the world's origin
  double slim;           ///< decades of radius over half height, either way
  double ends = 0.25;    ///< share of rays with a finite interval
  bool special = false;  ///< rays along and across a world axis, which is the cylinder's
  double graze = 0.5;    ///< share of rays aimed next to a sphere's silhouette
  double finest = -7;    ///< decade of the closest misses of a surface, in sizes
  bool tangent = false;  ///< rays that start at the surface, nearly along it
};

std::ostream& operator<<(std::ostream& out, const Scene& s) {
  return out << s.name;
}

/// A ray aimed at `at` from about `distance` away, with any direction length within two decades.
BasicRay<double> aimed(Random& random, const Vector3d& from, const Vector3d& at, const Scene& scene,
                       double distance) {
  const double back = random.chance(0.15) ? -1 : 1;
  BasicRay<double> ray{from, back * (at - from) * random.decades(-1, 1), 0, kInfinity};
  if (random.chance(scene.ends)) {
    const double t = distance / ray.d.norm();
    ray.tmin = t * random.between(0, 1.2), ray.tmax = ray.tmin + t * random.between(0, 1);
  }
  return ray;
}

struct SphereCase {
  using Exact = ExactSphere;
  static constexpr const char* kName = "ray-sphere";
  static constexpr double kBound = reference::kRaySphereBand;
  template <typename S>
  using Solid = BasicSphere<S>;
  template <typename S>
  static reference::Outcome<S> run(const BasicRay<S>& ray, const BasicSphere<S>& sphere) {
    return reference::ray_sphere(ray, sphere);
  }
  static std::pair<BasicRay<double>, BasicSphere<double>> make(Random& random, const Scene& scene) {
    const BasicSphere<double> sphere{Vector3d::Constant(scene.offset) + random.direction(),
                                     scene.size};
    const double distance = scene.size * random.decades(scene.near, scene.far);
    const Vector3d out = random.direction();
    // The distance of the line from the centre: any, or near the silhouette.
    double miss = scene.size * random.between(0, 2);
    if (random.chance(scene.graze))
      miss = scene.size * (1 + random.sign() * random.decades(scene.finest, -1));
    Vector3d from = sphere.c + distance * out, at = sphere.c + miss * random.across(out);
    if (scene.tangent) {
      from = sphere.c + scene.size * almost_one(random, scene.finest) * out;
      const Vector3d along = random.across(out);
      at = from + distance * (along + random.sign() * random.decades(-7, -1) * out);
    }
    return {aimed(random, from, at, scene, distance), sphere};
  }
};

struct CylinderCase {
  using Exact = ExactCylinder;
  static constexpr const char* kName = "ray-cylinder";
  static constexpr double kBound = reference::kRayCylinderBand;
  template <typename S>
  using Solid = BasicCylinder<S>;
  template <typename S>
  static reference::Outcome<S> run(const BasicRay<S>& ray, const BasicCylinder<S>& cylinder) {
    return reference::ray_cylinder(ray, cylinder);
  }
  static std::pair<BasicRay<double>, BasicCylinder<double>> make(Random& random,
                                                                 const Scene& scene) {
    BasicCylinder<double> cylinder{Vector3d::Constant(scene.offset) + random.direction(),
                                   random.direction(), scene.size, scene.size};
    if (scene.special) cylinder.axis = Vector3d::Unit(static_cast<int>(3 * random.unit()));
    const double slim = random.decades(-scene.slim, scene.slim);
    (slim < 1 ? cylinder.radius : cylinder.half_height) *= slim < 1 ? slim : 1 / slim;
    const double distance = scene.size * random.decades(scene.near, scene.far);
    // Aims at a point of the solid or beside it, often near the lateral surface, a cap or a rim.
    double h = random.between(-1.3, 1.3), r = 1.3 * std::sqrt(random.unit());
    if (random.chance(0.3)) r = 1 + random.sign() * random.decades(scene.finest, -1);
    if (random.chance(0.3)) h = random.sign() + random.sign() * random.decades(scene.finest, -1);
    const Vector3d side = random.across(cylinder.axis);
    Vector3d at =
        cylinder.c + h * cylinder.half_height * cylinder.axis + r * cylinder.radius * side;
    Vector3d out = random.direction();
    if (random.chance(0.2)) out = random.across(side);  // grazes the lateral surface
    if (random.chance(0.2)) out = (cylinder.axis + random.decades(-6, 0) * out).normalized();
    if (scene.special) out = random.chance(0.5) ? cylinder.axis : random.across(cylinder.axis);
    Vector3d from = at + distance * random.sign() * out;
    if (scene.tangent) {
      const Vector3d foot =
          cylinder.c + random.between(-1, 1) * cylinder.half_height * cylinder.axis;
      from = foot + cylinder.radius * almost_one(random, scene.finest) * side;
      const Vector3d along = random.across(side);
      const Vector3d rim = from + distance * along;
      at = rim + distance * random.sign() * random.decades(-7, -1) * side;
    }
    BasicRay<double> ray = aimed(random, from, at, scene, distance);
    if (scene.special) {
      // Exactly along or across the world axis, also with a zero of either sign.
      for (int k = 0; k < 3; ++k) {
        const bool along = cylinder.axis[k] != 0, wanted = std::abs(out.dot(cylinder.axis)) > 0.5;
        if (along != wanted) ray.d[k] = random.sign() * 0.0;
      }
    }
    return {ray, cylinder};
  }
};

struct Report {
  int underflows = 0;  ///< pairs left out, as |d|^2 or A is subnormal in the format
  int pairs = 0, hits = 0, uncertain = 0, uncertain_wrong = 0, wrong = 0;
  double residual = 0;  ///< worst distance of o + T d from the surface, in u (|o-c| + sizes)
  double point = 0;     ///< worst error of CP against o + T d, in u of the largest term
};

template <typename S, typename Case>
Report judge(Scene scene, int pairs) {
  using reference::kUnitRoundoff;
  scene.finest = std::log10(kUnitRoundoff<S>);
  Random random;
  Report report;
  while (report.pairs < pairs) {
    const auto [ray64, solid64] = Case::make(random, scene);
    const auto ray = primitive_cast<S>(ray64);
    const auto solid = primitive_cast<S>(solid64);
    if (reference::bad(ray) || reference::bad(solid)) continue;  // rounded to zero in this format
    const BasicRay<double> exact_ray = primitive_cast<double>(ray);
    const typename Case::Exact exact(exact_ray, primitive_cast<double>(solid));
    const double product = exact.least_product();
    if (product != 0 && product < static_cast<double>(std::numeric_limits<S>::min())) {
      ++report.underflows;
      continue;
    }
    ++report.pairs;
    const double unit = kUnitRoundoff<S> * exact.size();
    const Judgement truth(exact, exact_ray, kUsualBand * unit);
    const reference::Outcome<S> got = Case::run(ray, solid);
    report.hits += got.f;
    if (truth.truth() == Judgement::Truth::kUncertain) {
      ++report.uncertain;
      report.uncertain_wrong += got.f != truth.exact();
    } else if (got.f != (truth.truth() == Judgement::Truth::kHit)) {
      ++report.wrong;
      if (report.wrong < 4) {
        std::printf("wrong F = %d: o", got.f);
        for (const double x : to_words(exact_ray)) std::printf(" %a", x);
        std::printf(" solid");
        for (const double x : to_words(primitive_cast<double>(solid))) std::printf(" %a", x);
        std::printf("\n");
      }
    }
    if (!got.f) continue;
    const double t = static_cast<double>(got.t);
    EXPECT_TRUE(truth.accepts(t)) << "T " << t << ", exact " << truth.exact_t();
    report.residual = std::max(report.residual, static_cast<double>(exact.residual(t)) / unit);
    for (int k = 0; k < 3; ++k) {
      const double step = t * exact_ray.d[k], at = exact_ray.o[k] + step;
      const double largest = std::max({std::abs(exact_ray.o[k]), std::abs(step), std::abs(at)});
      const double error = std::abs(static_cast<double>(got.cp[k]) - at);
      const double tiny = static_cast<double>(std::numeric_limits<S>::denorm_min());
      report.point = std::max(report.point, (error - tiny) / (kUnitRoundoff<S> * largest));
    }
  }
  return report;
}

template <typename S, typename Case>
void expect_right(const Scene& scene, int pairs, const char* format) {
  const Report r = judge<S, Case>(scene, pairs);
  std::printf(
      "%s %s %s: seed %u, %d pairs, %.1f %% hit, wrong outside the band %d, uncertain %d (%.2f "
      "%%), of "
      "them %d decided otherwise than exact arithmetic; %d more underflow; surface missed by %.2f "
      "u (band %g), CP "
      "off by %.2f u\n",
      Case::kName, format, scene.name, Random::kSeed, r.pairs, 100.0 * r.hits / r.pairs, r.wrong,
      r.uncertain, 100.0 * r.uncertain / r.pairs, r.uncertain_wrong, r.underflows, r.residual,
      kUsualBand, r.point);
  EXPECT_EQ(r.wrong, 0);
  EXPECT_LE(r.underflows, (std::numeric_limits<S>::min_exponent > -100 ? 0.2 : 0) * r.pairs);
  EXPECT_LE(r.residual, kUsualBand);
  EXPECT_LE(r.point, 2) << "one rounding of the product, one of the sum";
  EXPECT_GT(r.hits, 0.3 * r.pairs);
  EXPECT_LT(r.hits, 0.7 * r.pairs);
  EXPECT_LT(r.uncertain, 0.5 * r.pairs) << "the band excuses too many pairs";
}

const Scene kScenes[] = {
    {"Unit", 1, -1, 1, 0, 1},
    {"TenRadiiAway", 1, 1, 1, 0, 0},
    {"TenThousandRadiiAway", 1, 4, 4, 0, 0},
    {"Tiny", 1e-4, -1, 2, 0, 1},
    {"Huge", 1e4, -1, 2, 0, 1},
    {"OffsetThousand", 1, -1, 1, 1000, 1},
    {"Inside", 1, -3, -0.5, 0, 0.3, 0.5},
};
const Scene kCylinderShapes[] = {
    {"Slim", 1, -1, 1, 0, 3},
    {"AlongAndAcross", 1, -1, 1, 0, 0.5, 0.25, true},
};

/// Like rays that bounce off the surface. Only rounding decides between their two roots, so a
/// quotient of two such numbers would be useless.
const Scene kTangents[] = {
    {"TangentFromTheSurface", 1, -1, 1, 0, 0.5, 0.25, false, 0.5, -7, true},
    {"TangentFromTheSurfaceOffsetTen", 1, -1, 1, 10, 0.5, 0.25, false, 0.5, -7, true},
};

std::string scene_name(const ::testing::TestParamInfo<Scene>& info) {
  return info.param.name;
}

class RaySphereScene : public ::testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, RaySphereScene, ::testing::ValuesIn(kScenes), scene_name);
INSTANTIATE_TEST_SUITE_P(Tangents, RaySphereScene, ::testing::ValuesIn(kTangents), scene_name);
TEST_P(RaySphereScene, Decisions_AreRightOutsideTheBand) {
  expect_right<float, SphereCase>(GetParam(), 10000, "fp32");
}

class RayCylinderScene : public ::testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, RayCylinderScene, ::testing::ValuesIn(kScenes), scene_name);
INSTANTIATE_TEST_SUITE_P(Tangents, RayCylinderScene, ::testing::ValuesIn(kTangents), scene_name);
INSTANTIATE_TEST_SUITE_P(Shapes, RayCylinderScene, ::testing::ValuesIn(kCylinderShapes),
                         scene_name);
TEST_P(RayCylinderScene, Decisions_AreRightOutsideTheBand) {
  expect_right<float, CylinderCase>(GetParam(), 10000, "fp32");
}

/// The distance of P from a surface, and |o - c| and the sizes, in 64 bits of precision. This is
/// enough for fp32, and much faster than 168 bits.
struct Miss {
  long double distance, size;
};
using Long = Eigen::Matrix<long double, 3, 1>;

Miss miss(const Long& o, const Long& p, const BasicSphere<float>& sphere) {
  const Long c = sphere.c.cast<long double>();
  return {std::abs((p - c).norm() - sphere.r), (o - c).norm() + sphere.r};
}
Miss miss(const Long& o, const Long& p, const BasicCylinder<float>& cylinder) {
  const Long c = cylinder.c.cast<long double>();
  const Long axis = cylinder.axis.cast<long double>().normalized();
  const long double along = (p - c).dot(axis);
  const long double out = (p - c - along * axis).norm() - cylinder.radius;
  return {std::abs(std::max(out, std::abs(along) - cylinder.half_height)),
          (o - c).norm() + cylinder.radius + cylinder.half_height};
}

/// The distance of o + T d from the surface, in u (|o-c| + sizes); empty for a miss or bad input.
template <typename Case, typename Solid>
std::optional<double> miss_of(const BasicRay<float>& ray, const Solid& solid) {
  if (reference::bad(ray) || reference::bad(solid)) return std::nullopt;
  const auto got = Case::run(ray, solid);
  if (!got.f) return std::nullopt;
  const Long o = ray.o.cast<long double>();
  const Miss m = miss(o, o + static_cast<long double>(got.t) * ray.d.cast<long double>(), solid);
  return static_cast<double>(m.distance / m.size) * 0x1p24;
}

/// The largest such distance for so many rays per scene.
template <typename Case>
double worst_miss(std::span<const Scene> scenes, int rays) {
  double worst = 0;
  for (Scene scene : scenes) {
    scene.finest = std::log10(reference::kUnitRoundoff<float>);
    Random random;
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
      const auto [ray64, solid64] = Case::make(random, scene);
      const BasicRay<float> ray = primitive_cast<float>(ray64);
      const auto solid = primitive_cast<float>(solid64);
      const std::optional<double> miss = miss_of<Case>(ray, solid);
      if (miss) ++hits, worst = std::max(worst, *miss);
    }
    EXPECT_GT(hits, 0.3 * rays) << scene.name;
  }
  return worst;
}

// More rays find larger distances: the page states the figures for a million and ten million rays
// per scene.
TEST(RaySolidFigures, RandomRays_MissSurfacesAsTheDocsState) {
  const int millions = amount(1, 10);
  std::vector<Scene> balls(std::begin(kScenes), std::end(kScenes));
  balls.insert(balls.end(), std::begin(kTangents), std::end(kTangents));
  std::vector<Scene> shapes = balls;
  shapes.insert(shapes.end(), std::begin(kCylinderShapes), std::end(kCylinderShapes));
  const double sphere = worst_miss<SphereCase>(balls, millions * 1000000);
  const double cylinder = worst_miss<CylinderCase>(shapes, millions * 1000000);
  EXPECT_LE(sphere, reference::kRaySphereBand);
  EXPECT_LE(cylinder, reference::kRayCylinderBand);
  const auto line = [&](const char* pair, std::size_t scenes, double worst) {
    return fmt::format("- {}, {} million rays in each of {} scenes: {:.2f} u", pair, millions,
                       scenes, worst);
  };
  expect_in_docs("tables/pairs.md", {line("ray-sphere", balls.size(), sphere),
                                     line("ray-cylinder", shapes.size(), cylinder)});
}

/// One word of a primitive changed slightly, at every scale. An axis may end as far from unit
/// length as the contract allows.
template <typename P>
void nudge(Random& random, P& primitive, double step) {
  auto words = to_words(primitive);
  const std::size_t k = static_cast<std::size_t>(random.unit() * static_cast<double>(words.size()));
  words[k] = static_cast<float>(words[k] * (1 + step * random.between(-1, 1)));
  primitive = from_words<P>(words);
}

/// The worst case of so many searches. Each starts with a pair of a random scene and keeps every
/// change that makes it worse, until a thousand changes in a row do not.
template <typename Case>
double worst_found(int searches) {
  const Scene kStarts[] = {{"", 1, -1, 4, 0, 1}, {"", 1, 4, 4, 0, 1}, {"", 1, -3, -0.5, 0, 0.5}};
  Random random;
  double worst = 0;
  for (int i = 0; i < searches; ++i) {
    const auto [ray64, solid64] = Case::make(random, kStarts[i % 3]);
    BasicRay<float> ray = primitive_cast<float>(ray64);
    ray.tmin = 0, ray.tmax = kInfinity;
    auto solid = primitive_cast<float>(solid64);
    double most = miss_of<Case>(ray, solid).value_or(0);
    for (int failed = 0; failed < 1000; ++failed) {
      auto other_ray = ray;
      auto other_solid = solid;
      const double step = std::exp2(-24 * random.unit());
      nudge(random, other_ray, step);
      if (random.chance(0.5)) nudge(random, other_solid, step);
      const double now = miss_of<Case>(other_ray, other_solid).value_or(0);
      if (now > most) most = now, ray = other_ray, solid = other_solid, failed = 0;
    }
    worst = std::max(worst, most);
  }
  return worst;
}

// The bounds are sums of roundings. Random rays do not come close to them; searches come closer.
TEST(RaySolidFigures, SearchesForTheWorst_EqualTheDocs) {
  constexpr int kSearches = 600;
  const double sphere = worst_found<SphereCase>(kSearches),
               cylinder = worst_found<CylinderCase>(kSearches);
  EXPECT_LE(sphere, reference::kRaySphereBand);
  EXPECT_LE(cylinder, reference::kRayCylinderBand);
  EXPECT_GT(std::min(sphere, cylinder), 7) << "the searches find no bad case";
  const auto line = [&](const char* pair, double worst) {
    return fmt::format("- {}, the worst of {} searches: {:.2f} u", pair, kSearches, worst);
  };
  expect_in_docs("tables/pairs.md", {line("ray-sphere", sphere), line("ray-cylinder", cylinder)});
}

const Scene kUnitScene{"Unit", 1, -0.2, 0.5, 0, 0.3};

TEST(RaySolidFormats, Sphere_IsRightInEveryFormat) {
  expect_right<Fp16, SphereCase>(kUnitScene, 4000, "fp16");
  expect_right<Bf16, SphereCase>(kUnitScene, 4000, "bf16");
  expect_right<Fp24, SphereCase>(kUnitScene, 4000, "fp24");
  expect_right<double, SphereCase>(kUnitScene, 4000, "fp64");
}
TEST(RaySolidFormats, Cylinder_IsRightInEveryFormat) {
  expect_right<Fp16, CylinderCase>(kUnitScene, 4000, "fp16");
  expect_right<Bf16, CylinderCase>(kUnitScene, 4000, "bf16");
  expect_right<Fp24, CylinderCase>(kUnitScene, 4000, "fp24");
  expect_right<double, CylinderCase>(kUnitScene, 4000, "fp64");
}

// ---- Cases by hand ----

const Sphere kBall{{1, 2, 3}, 2};
const Cylinder kCan{{0, 0, 0}, {0, 0, 1}, 2, 1};  // axis, half height, radius

struct Known {
  const char* name;
  bool cylinder;
  Ray ray;
  bool f;
  float t = 0;
};

std::ostream& operator<<(std::ostream& out, const Known& known) {
  return out << known.name;
}

class RaySolidKnown : public ::testing::TestWithParam<Known> {};

constexpr float kInf = std::numeric_limits<float>::infinity();
const float kAfter2 = std::nextafter(2.0f, 3.0f), kBefore2 = std::nextafter(2.0f, 1.0f);

INSTANTIATE_TEST_SUITE_P(
    Cases, RaySolidKnown,
    ::testing::Values(
        Known{"SphereThroughTheCentre", false, {{1, 2, -1}, {0, 0, 1}}, true, 2},
        Known{"SphereFromTheCentre", false, {{1, 2, 3}, {0, 0, 4}}, true, 0.5f},
        Known{"SphereFromInsideReportsTheExit", false, {{1, 2, 2}, {0, 0, 1}}, true, 3},
        Known{"SphereBehind", false, {{1, 2, 6}, {0, 0, 1}}, false},
        Known{"SphereBehindWithNegativeInterval", false, {{1, 2, 6}, {0, 0, 1}, -kInf}, true, -5},
        Known{"SphereTangent", false, {{3, 2, 0}, {0, 0, 1}}, true, 3},
        Known{"SphereTangentAtTheOrigin", false, {{3, 2, 3}, {0, 0, 1}}, true, 0},
        Known{"SphereJustPassed", false, {{3.000001f, 2, 0}, {0, 0, 1}}, false},
        Known{"SphereOriginOnTheSurface", false, {{1, 2, 1}, {0, 0, 1}}, true, 0},
        Known{"SphereEndsAtTheSurface", false, {{1, 2, -1}, {0, 0, 1}, 0, 2}, true, 2},
        Known{"SphereEndsBefore", false, {{1, 2, -1}, {0, 0, 1}, 0, kBefore2}, false},
        Known{"SphereStartsAtTheSurface", false, {{1, 2, -1}, {0, 0, 1}, 2}, true, 2},
        Known{"SphereStartsAfter", false, {{1, 2, -1}, {0, 0, 1}, kAfter2}, true, 6},
        Known{"SphereEmptyInterval", false, {{1, 2, -1}, {0, 0, 1}, 3, 1}, false},
        Known{"CylinderAlongTheAxis", true, {{0, 0, -4}, {0, 0, 1}}, true, 2},
        Known{"CylinderAlongBeside", true, {{1.0001f, 0, -4}, {0, 0, 1}}, false},
        Known{"CylinderAlongTheMantle", true, {{1, 0, -4}, {0, 0, 1}}, true, 2},
        Known{"CylinderAlongFromInside", true, {{0.5f, 0, 1}, {0, -0.0f, -2}}, true, 1.5f},
        Known{"CylinderAcross", true, {{-3, 0, 1}, {1, 0, 0}}, true, 2},
        Known{"CylinderAcrossNegativeZero", true, {{-3, 0, 1}, {1, -0.0f, -0.0f}}, true, 2},
        Known{"CylinderAcrossInTheCap", true, {{-3, 0, 2}, {1, 0, 0}}, true, 2},
        Known{"CylinderAcrossAbove", true, {{-3, 0, 2.0001f}, {1, 0, 0}}, false},
        Known{"CylinderTangentAtTheOrigin", true, {{1, 0, 0}, {0, 1, 0}}, true, 0},
        Known{"CylinderTangent", true, {{1, -5, 0}, {0, 2, 0}}, true, 2.5f},
        Known{"CylinderFromInsideReportsTheExit", true, {{0, 0, 1}, {0.5f, 0, 0}}, true, 2},
        Known{"CylinderThroughTheCapOut", true, {{0, 0, 1}, {0, 0, 0.25f}}, true, 4},
        Known{"CylinderPastTheRim", true, {{-2, 0, 2.0f}, {1, 0, 1}}, false},
        Known{"CylinderEndsBefore", true, {{0, 0, -4}, {0, 0, 1}, 0, kBefore2}, false},
        Known{"CylinderEndsAtTheCap", true, {{0, 0, -4}, {0, 0, 1}, 0, 2}, true, 2},
        Known{"CylinderStartsAfter", true, {{0, 0, -4}, {0, 0, 1}, kAfter2}, true, 6},
        Known{"CylinderAllButAlongTheAxis", true, {{0.25f, 0.5f, -4}, {1e-19f, 0, 1}}, true, 2},
        Known{"CylinderAllButAlongBeside", true, {{1.25f, 0.5f, -4}, {1e-19f, 0, 1}}, false},
        Known{"CylinderTinyDirection", true, {{0, 0, 0}, {0x1p-34f, 0, 0x1p-34f}}, true, 0x1p34f}),
    [](const auto& info) { return info.param.name; });

TEST_P(RaySolidKnown, Case_HasItsAnswer) {
  const Known& known = GetParam();
  const reference::Outcome<float> got = known.cylinder ? reference::ray_cylinder(known.ray, kCan)
                                                       : reference::ray_sphere(known.ray, kBall);
  EXPECT_EQ(got.f, known.f);
  EXPECT_FALSE(got.bad);
  EXPECT_EQ(got.t, known.f ? known.t : kInf);
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(got.cp[k], known.f ? known.ray.o[k] + known.t * known.ray.d[k] : 0);
}

/// The reason for the pipe's formula: b^2 - ac would be wrong in a quarter of the cases.
TEST(RaySphere, FarRay_IsRightWhereTheTextbookIsWrong) {
  Random random;
  const Scene far{"", 1, 4, 4, 0, 0, 0, false, 0};
  constexpr int kPairs = 10000;
  int textbook = 0, pipe = 0;
  for (int i = 0; i < kPairs; ++i) {
    const auto [ray64, sphere64] = SphereCase::make(random, far);
    const auto ray = primitive_cast<float>(ray64);
    const auto sphere = primitive_cast<float>(sphere64);
    const BasicRay<double> exact_ray = primitive_cast<double>(ray);
    const ExactSphere exact(exact_ray, primitive_cast<double>(sphere));
    const bool truth = Judgement(exact, exact_ray, 0).exact();
    const Eigen::Vector3f w = ray.o - sphere.c;
    const float a = ray.d.dot(ray.d), b = w.dot(ray.d), c = w.dot(w) - sphere.r * sphere.r;
    const float discriminant = b * b - a * c;
    textbook += (discriminant >= 0 && -b + std::sqrt(discriminant) >= 0) != truth;
    pipe += reference::ray_sphere(ray, sphere).f != truth;
  }
  std::printf("seed %u, %d pairs: textbook wrong in %.2f %%, pipe in %.2f %%\n", Random::kSeed,
              kPairs, 100.0 * textbook / kPairs, 100.0 * pipe / kPairs);
  EXPECT_GT(textbook, 4 * pipe);
}

/// A ray nearly along the axis, from 10,000 radii away. There n = d x a is only rounding error. If
/// n kept its part along the axis, w.n would multiply that part by 10,000.
TEST(RayCylinder, RayNearTheAxis_IgnoresRoundingOfTheNormal) {
  Random random;
  int hits = 0;
  constexpr int kRays = 2000;
  for (int i = 0; i < kRays; ++i) {
    const Vector3d axis = random.direction();
    const Cylinder cylinder{{0, 0, 0}, axis.cast<float>(), 1, 1};
    const Vector3d a = cylinder.axis.cast<double>().normalized();
    Ray ray;
    ray.d = (a + 1e-6 * random.direction()).cast<float>();
    ray.o = (-1e4 * ray.d.cast<double>() + 0.9 * random.unit() * random.across(a)).cast<float>();
    hits += reference::ray_cylinder(ray, cylinder).f;
  }
  EXPECT_EQ(hits, kRays);
}

/// Every angle from the axis down to zero. (e/A)^2 and r^2/A overflow long before 1 / A does. If 1
/// / A alone decided that a ray is parallel to the axis, rays through the solid would miss it.
TEST(RayCylinder, AnyTiltFromTheAxis_HitsTheSolid) {
  Random random;
  int hits = 0, misses = 0, tiny = 0;
  for (int i = 0; i < 20000; ++i) {
    const double size = std::exp2(random.between(-33, 37)),
                 tilt = std::exp2(random.between(-148, 0));
    Cylinder cylinder{{0, 0, 0},
                      {0, 0, 1},
                      static_cast<float>(size),
                      static_cast<float>(size * std::exp2(random.between(-1, 1)))};
    if (random.chance(0.3)) cylinder.axis = random.direction().cast<float>();
    const Vector3d a = cylinder.axis.cast<double>().normalized();
    const Vector3d side = random.across(a), other = a.cross(side);
    const double from = size * random.between(1.5, 8), out = random.between(0, 2);
    Ray ray;
    ray.o = (-from * a + cylinder.radius * out * side).cast<float>();
    const double angle = random.between(0, 2 * M_PI);
    const double length = std::exp2(random.between(-1, 1));
    ray.d =
        (length * (a + tilt * (std::cos(angle) * side + std::sin(angle) * other))).cast<float>();
    const BasicRay<double> exact_ray = primitive_cast<double>(ray);
    const ExactCylinder exact(exact_ray, primitive_cast<double>(cylinder));
    const Judgement truth(exact, exact_ray, reference::kRayCylinderBand * 0x1p-24 * exact.size());
    if (truth.truth() == Judgement::Truth::kUncertain) continue;
    const bool hit = truth.truth() == Judgement::Truth::kHit;
    const auto got = reference::ray_cylinder(ray, cylinder);
    ASSERT_EQ(got.f, hit) << "size " << size << ", tilt " << tilt << ", out " << out;
    if (hit) {
      ASSERT_TRUE(truth.accepts(static_cast<double>(got.t)));
    }
    ++(hit ? hits : misses);
    tiny += hit && tilt * length < 0x1p-63 * size;
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(misses, 5000);
  EXPECT_GT(tiny, 2000);
}

template <typename P, typename Reference>
void expect_bad_in_every_word(const Ray& ray, const P& solid, Reference run) {
  const auto expect_bad = [&](const Ray& r, const P& s, const std::string& what) {
    const reference::Outcome<float> got = run(r, s);
    const auto nan = [](float x) { return std::bit_cast<std::uint32_t>(x) == 0x7fc00000; };
    EXPECT_TRUE(got.bad) << what;
    EXPECT_FALSE(got.f) << what;
    EXPECT_TRUE(nan(got.t) && nan(got.cp.x()) && nan(got.cp.y()) && nan(got.cp.z()) &&
                nan(got.n.x()) && nan(got.n.y()) && nan(got.n.z()))
        << what;
  };
  ASSERT_FALSE(run(ray, solid).bad);
  for (const float poison : {std::numeric_limits<float>::quiet_NaN(), kInf, -kInf}) {
    for (std::size_t i = 0; i < 8; ++i) {
      if (i >= 6 && std::isinf(poison)) continue;  // an interval may be infinite
      auto words = to_words(ray);
      words[i] = poison;
      expect_bad(from_words<Ray>(words), solid, "ray word " + std::to_string(i));
    }
    for (std::size_t i = 0; i < P::kWords; ++i) {
      auto words = to_words(solid);
      words[i] = poison;
      expect_bad(ray, from_words<P>(words), "solid word " + std::to_string(i));
    }
  }
  expect_bad(Ray{ray.o, {0, -0.0f, 0}}, solid, "zero direction");
}

TEST(RaySolids, BadInputInAnyWord_IsFlagged) {
  const Ray ray{{1, 2, -5}, {0.1f, 0, 1}};
  expect_bad_in_every_word(ray, kBall, reference::ray_sphere<float>);
  expect_bad_in_every_word(ray, kCan, reference::ray_cylinder<float>);
  EXPECT_TRUE(reference::ray_sphere(ray, Sphere{{0, 0, 0}, 0}).bad);
  EXPECT_TRUE(reference::ray_sphere(ray, Sphere{{0, 0, 0}, -1}).bad);
  EXPECT_TRUE(reference::ray_cylinder(ray, Cylinder{{0, 0, 0}, {0, 0, 1}, 0, 1}).bad);
  EXPECT_TRUE(reference::ray_cylinder(ray, Cylinder{{0, 0, 0}, {0, 0, 1}, 1, 0}).bad);
  EXPECT_TRUE(reference::ray_cylinder(ray, Cylinder{{0, 0, 0}, {0, 0, 2}, 1, 1}).bad);
}

}  // namespace
}  // namespace cde::testing
