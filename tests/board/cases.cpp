// SPDX-License-Identifier: Apache-2.0
#include "cases.hpp"
#include "pair_failure.hpp"

#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

namespace cde::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kTiny = std::numeric_limits<float>::denorm_min();
constexpr float kMax = std::numeric_limits<float>::max();

using Eigen::Vector3f;

float* slot(Ray& ray, unsigned k) {
  if (k < 3) return &ray.o[k];
  if (k < 6) return &ray.d[k - 3];
  return k == 6 ? &ray.tmin : &ray.tmax;
}
float* slot(Triangle& t, unsigned k) {
  Vector3f* corner[] = {&t.v0, &t.v1, &t.v2};
  return &(*corner[k / 3])[k % 3];
}

}  // namespace

Random::Random(std::uint32_t seed) : engine_(seed) {
  std::printf("seed %u\n", seed);
}

RayScene beam(Random& random, std::size_t rays, std::size_t triangles, float scale) {
  RayScene scene;
  for (std::size_t i = 0; i < rays; ++i) {
    Ray ray;
    ray.o = Vector3f(random.in(-1, 1), random.in(-1, 1), random.in(-6, -4)) * scale;
    ray.d = Vector3f(random.in(-0.2f, 0.2f), random.in(-0.2f, 0.2f), random.in(0.5f, 2)) * scale;
    if (random.below(8) == 0) ray.d = -ray.d, ray.tmin = -kInf;
    if (random.below(16) == 0) ray.tmax = random.in(2, 8);
    scene.rays.push_back(ray);
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    const float turn = random.in(0, 6.2831853f), size = random.in(1, 7);
    const auto corner = [&](float angle) {
      angle += turn + random.in(-0.7f, 0.7f);
      return Vector3f(Vector3f(size * std::cos(angle) + random.in(-1, 1),
                               size * std::sin(angle) + random.in(-1, 1), random.in(-2, 6)) *
                      scale);
    };
    Triangle t{corner(0), corner(2.0944f), corner(4.18879f)};
    if (random.below(2) == 0) std::swap(t.v1, t.v2);
    scene.triangles.push_back(t);
  }
  return scene;
}

RayScene cloud(Random& random, std::size_t rays, std::size_t triangles) {
  RayScene scene;
  for (std::size_t i = 0; i < rays; ++i) {
    const Vector3f o = random.in_box(10), target = random.in_box(4);
    scene.rays.push_back({.o = o, .d = target - o});
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vector3f centre = random.in_box(8);
    scene.triangles.push_back(
        {centre + random.in_box(1), centre + random.in_box(1), centre + random.in_box(1)});
  }
  return scene;
}

RayScene directed() {
  RayScene s;
  const Triangle plain{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const auto down = [](float x, float y) { return Ray{.o = {x, y, 0}, .d = {0, 0, 1}}; };

  // Interior, corners, edges and points just beside them, for both directions and orientations,
  // with unit and other lengths.
  for (float x : {0.25f, 0.0f, -0.0f, 1.0f, 0.5f, std::nextafter(0.0f, -1.0f),
                  std::nextafter(1.0f, 2.0f), std::nextafter(0.5f, 1.0f)})
    for (float y : {0.25f, 0.0f, -0.0f, 1.0f, 0.5f, kTiny, -kTiny}) s.rays.push_back(down(x, y));
  s.rays.push_back({.o = {0.25f, 0.25f, 2}, .d = {-0.0f, -0.0f, -1}});
  s.rays.push_back({.o = {0.3f, 0.3f, 3}, .d = {-0.0f, 0.0f, -3.7f}, .tmin = -1});
  s.rays.push_back({.o = {-0.0f, -0.0f, -0.0f}, .d = {0.1f, 0.2f, 0.9f}});
  // In the plane, and parallel beside it.
  for (float z : {1.0f, std::nextafter(1.0f, 2.0f), 0.5f})
    s.rays.push_back({.o = {-1, 0.25f, z}, .d = {1, 0, 0}});
  s.rays.push_back({.o = {0.2f, 0.2f, 1}, .d = {0.3f, 0.1f, -0.0f}});
  s.rays.push_back({.o = {0.2f, 0.2f, 1}, .d = {0, 0, 1}});  // starts on the plane: T = 0
  s.rays.push_back({.o = {0.2f, 0.2f, 1}, .d = {0, 0, -1}});
  // Intervals that end on the hit or one ulp beside it.
  for (const Ray& ray :
       {Ray{.o = {0.3f, 0.2f, -0.7f}, .d = {0.01f, 0.02f, 0.3f}}, down(0.25f, 0.25f)}) {
    const float t = reference::record_of(ray, plain, 0, 0).t;
    for (float end : {t, std::nextafter(t, -kInf), std::nextafter(t, kInf)}) {
      s.rays.push_back({.o = ray.o, .d = ray.d, .tmin = end, .tmax = kInf});
      s.rays.push_back({.o = ray.o, .d = ray.d, .tmin = 0, .tmax = end});
      s.rays.push_back({.o = ray.o, .d = ray.d, .tmin = end, .tmax = end});
    }
  }
  for (float a : {-kInf, -0.0f, 0.0f, kInf, 2.0f})
    for (float b : {-kInf, -0.0f, 0.0f, kInf, 0.5f})
      s.rays.push_back({.o = {0.2f, 0.3f, 0}, .d = {0, 0, 1}, .tmin = a, .tmax = b});
  // Subnormal and huge rays, for which T and CP overflow, underflow or become NaN.
  for (float m : {kTiny, 0x1p-126f, 0x1p-35f, 0x1p-34f, 0x1p-25f, 0x1p-17f, 0x1p-9f, 0x1p20f,
                  0x1p30f, 0x1p40f, 0x1p41f, kMax}) {
    s.rays.push_back({.o = {0.2f, 0.3f, 0}, .d = {0, 0, m}});
    s.rays.push_back({.o = {0.2f * m, 0.3f * m, -m}, .d = {m * 0.1f, m * 0.1f, m}});
    s.rays.push_back({.o = {0.1f, 0.1f, -m}, .d = {0, 0, 1}, .tmin = -kInf});
    s.rays.push_back({.o = {m, m, m}, .d = {-m, -m, -m}, .tmin = -kInf});
  }
  // Bad input in every word.
  for (unsigned k = 0; k < 8; ++k)
    for (float x : {kNan, -kNan, std::bit_cast<float>(0x7f800001u), kInf, -kInf}) {
      Ray ray = down(0.25f, 0.25f);
      *slot(ray, k) = x;
      s.rays.push_back(ray);
    }
  for (float zero : {0.0f, -0.0f})
    s.rays.push_back({.o = {0.2f, 0.2f, 0}, .d = {zero, -zero, zero}});

  s.triangles = {plain, {plain.v0, plain.v2, plain.v1}, {plain.v1, plain.v2, plain.v0}};
  // Triangles without area (a point, segments, a repeated corner), needles and slivers.
  s.triangles.push_back({plain.v0, plain.v0, plain.v0});
  s.triangles.push_back({plain.v0, plain.v1, plain.v1});
  s.triangles.push_back({plain.v0, plain.v0, plain.v2});
  s.triangles.push_back({{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
  s.triangles.push_back({{0, 0, 1}, {1, 0, 1}, {0.5f, 1e-7f, 1}});
  s.triangles.push_back({{-1e6f, 0.25f, 1}, {1e6f, 0.25f, 1}, {0, std::nextafter(0.25f, 1.0f), 1}});
  for (float m : {kTiny, 0x1p-126f, 0x1p-63f, 0x1p-20f, 0x1p-5f, 0x1p5f, 0x1p20f, 0x1p40f, kMax}) {
    s.triangles.push_back({plain.v0 * m, plain.v1 * m, plain.v2 * m});
    s.triangles.push_back({{-m, -m, 1}, {m, -m, 1}, {0, m, 1}});
    s.triangles.push_back({{0.1f, 0.1f, 1}, {0.1f + m, 0.1f, 1}, {0.1f, 0.1f + m, 1}});
  }
  for (unsigned k = 0; k < 9; ++k)
    for (float x : {k % 2 == 0 ? kNan : std::bit_cast<float>(0xffc00001u),
                    k % 2 == 0 ? kInf : std::bit_cast<float>(0x7f800001u), -kInf, -0.0f, 0.25f,
                    1.5f, kTiny, k % 2 == 0 ? kMax : 0x1p-40f}) {
      Triangle t = plain;
      *slot(t, k) = x;
      s.triangles.push_back(t);
    }
  return s;
}

BoardConfig host_config() {
  return {};
}
BoardConfig rtl_config() {
  return {.arithmetic = Arithmetic::kRtl};
}
BoardConfig small_config() {
  return {.lanes = 4,
          .latency = {.add = 2, .mul = 3, .div = 9, .compare = 2},
          .ddr_slots = 1000,
          .sram_records = 64};
}
BoardConfig pci_config() {
  BoardConfig c = small_config();
  c.bus = Bus::kCycle;
  return c;
}

BoardConfig rich_config(Bus bus) {
  return {.lanes = 4,
          .pairs = {Pair::kRayTriangle, Pair::kTriangleSphere},
          .swap = true,
          .parallel = true,
          .transform = Transformer::kBoth,
          .ddr_slots = 1000,
          .sram_records = 64,
          .bus = bus,
          .ecc = true};
}

std::string explain_lines(const reference::Checker& checker) {
  std::string lines;
  if (!checker.first_difference()) return lines;
  const auto words = [](const std::vector<float>& from) {
    std::vector<std::uint64_t> to;
    for (const float x : from) to.push_back(std::bit_cast<std::uint32_t>(x));
    return to;
  };
  const std::vector<std::uint64_t> a = words(checker.first_difference()->primary);
  if (a.empty()) return lines;
  for (const auto& [index, triangle] : checker.first_difference()->secondaries) {
    const std::vector<std::uint64_t> b = words(triangle);
    const std::string line =
        "\n  " + explain_line({{.lanes = 1, .arithmetic = Arithmetic::kRtl}, a, b, 0});
    if (lines != line) lines += line;  // both lists may name one triangle
  }
  return lines;
}

std::vector<Record> cast_and_compare(Board& board, const RayScene& scene, const Query& query,
                                     Counters* counters) {
  board.upload(scene.triangles, false);
  reference::Checker checker(scene.rays, scene.triangles, query.mode, query.stencil,
                             board.primaries(), "cde cast ...");
  std::vector<Record> records;
  Counters c;
  try {
    c = board.cast(scene.rays, query, [&](std::span<const Record> some) {
      checker.check(some);
      records.insert(records.end(), some.begin(), some.end());
    });
    checker.finish();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kMismatch) throw;
    throw Error(e.code(), e.what() + explain_lines(checker));
  }
  EXPECT_EQ(checker.compared(), records.size());
  if (counters != nullptr) *counters = c;
  return records;
}

}  // namespace cde::testing
