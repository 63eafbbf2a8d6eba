// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/picture.hpp"
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cde/geometry/length_range.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/progress.hpp"

namespace cde::accuracy {
namespace {

using oracle::Vec;
constexpr std::uint32_t kNone = ~0u;

/// Mesh and rays as numbers of a format and as its words.
struct Scene {
  std::vector<oracle::Triangle> triangles;
  std::vector<oracle::Ray> rays;
  std::vector<std::uint64_t> triangle_words, ray_words;
  int scaled_by = 0;
};

constexpr std::size_t kTriangleWords = 9, kRayWords = 8;

/// The power of two that scales all coordinates into the format's range; 0 if they are within it.
int scaling_into(FpFormat format, double largest) {
  const int high = LengthRange::of(format.exp_bits, format.man_bits).high;
  return largest <= std::ldexp(1, high) ? 0 : high - 1 - std::ilogb(largest);
}

Scene scene_in(FpFormat format, const Mesh& mesh, std::span<const Ray> rays) {
  double largest = 0;
  for (const auto& v : mesh.vertices) largest = std::max<double>(largest, v.cwiseAbs().maxCoeff());
  for (const Ray& ray : rays) largest = std::max<double>(largest, ray.o.cwiseAbs().maxCoeff());
  Scene scene;
  scene.scaled_by = scaling_into(format, largest);
  const oracle::Format rounds{format.exp_bits, format.man_bits};
  const auto rounded = [&](const Eigen::Vector3f& v, bool length) -> Vec {
    const Vec exact = std::ldexp(1, length ? scene.scaled_by : 0) * v.cast<double>();
    return exact.unaryExpr([&](double x) { return rounds.round(x); });
  };
  const auto append = [&](std::vector<std::uint64_t>& words, const std::vector<double>& numbers) {
    for (const double x : numbers) words.push_back(format.encode(x));
  };
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    scene.triangles.push_back({rounded(t.v0, true), rounded(t.v1, true), rounded(t.v2, true)});
    append(scene.triangle_words, oracle::to_words(oracle::Shape(scene.triangles.back()), rounds));
  }
  for (const Ray& ray : rays) {
    // T counts in units of d, which is not a length here.
    scene.rays.push_back(
        {rounded(ray.o, true), rounded(ray.d, false), 0, std::numeric_limits<double>::infinity()});
    append(scene.ray_words, oracle::to_words(scene.rays.back(), rounds));
  }
  return scene;
}

/// What a ray sees.
struct Seen {
  std::uint32_t index = kNone;
  double t = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool hit() const { return index != kNone; }
};

/// The exact answer. Binary64 rejects clear misses first.
Seen truth(const Scene& scene, const oracle::Ray& ray) {
  Seen seen;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const oracle::Triangle& t = scene.triangles[i];
    const Vec e1 = t.v1 - t.v0, e2 = t.v2 - t.v0, f = ray.o - t.v0;
    const Vec p = ray.d.cross(e2), q = f.cross(e1);
    const double det = p.dot(e1), size = std::abs(det);
    const double u = std::copysign(1, det) * p.dot(f), v = std::copysign(1, det) * q.dot(ray.d);
    // A bound for products of three lengths: a thousand times their largest rounding error.
    const double slack = 1e-12 * ray.d.norm() * (f.norm() + e1.norm() + e2.norm()) *
                         (e1.norm() + e2.norm() + f.norm());
    if (u < -slack || v < -slack || u + v > size + slack) continue;
    const oracle::RayAnswer exact = oracle::cast(ray, t);
    if (exact.hit && exact.t < seen.t) seen = {static_cast<std::uint32_t>(i), exact.t};
  }
  return seen;
}

std::vector<Seen> truths(const Scene& scene, Progress& progress, double from, double to) {
  std::vector<Seen> all;
  for (const oracle::Ray& ray : scene.rays) {
    progress(from + (to - from) * static_cast<double>(all.size()) /
                        static_cast<double>(scene.rays.size()));
    all.push_back(truth(scene, ray));
  }
  return all;
}

/// Triangles that the pipe may report as hit. Without the box rule these are all triangles: noise
/// may look like a hit anywhere in a triangle's plane. With the rule they are the triangles whose
/// widened box the ray comes near.
std::vector<std::uint32_t> candidates(const Scene& scene, const oracle::Ray& ray, bool box,
                                      double u) {
  std::vector<std::uint32_t> all;
  const double length = ray.d.norm();
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (box) {
      const oracle::Triangle& t = scene.triangles[i];
      const Vec low = t.v0.cwiseMin(t.v1).cwiseMin(t.v2), high = t.v0.cwiseMax(t.v1).cwiseMax(t.v2);
      const Vec middle = (low + high) / 2;
      const double radius = (high - low).norm() / 2;
      const double reach = (middle - ray.o).norm() + radius;
      const double world = high.cwiseAbs().cwiseMax(low.cwiseAbs()).maxCoeff();
      // The box rule (docs/reference/pairs_rays.md) widens by less than 64 u |T d|_1 and 12 u W
      // along each of three axes.
      const double widened = 2 * u * (3 * 64 * reach + 12 * world);
      if ((middle - ray.o).cross(ray.d).norm() > length * (radius + 2 * widened)) continue;
    }
    all.push_back(static_cast<std::uint32_t>(i));
  }
  return all;
}

Seen pipe_sees(const Scene& scene, const AccuracyPipe& pipe, std::size_t ray) {
  const double u = std::ldexp(1, -1 - pipe.format.man_bits);
  const std::vector<std::uint32_t> near = candidates(scene, scene.rays[ray], pipe.box, u);
  std::vector<std::uint64_t> a, b;
  for (const std::uint32_t i : near) {
    a.insert(a.end(), &scene.ray_words[ray * kRayWords],
             &scene.ray_words[ray * kRayWords] + kRayWords);
    const std::uint64_t* words = &scene.triangle_words[i * kTriangleWords];
    b.insert(b.end(), words, words + kTriangleWords);
  }
  std::vector<PairResult> results(near.size());
  reference::test_pairs(pipe.pair, pipe.algorithm, pipe.format, a, b, results, PlaneSide::kSurface,
                        {}, pipe.box);
  Seen seen;
  for (std::size_t k = 0; k < near.size(); ++k) {
    if (!results[k].f) continue;
    const double t = pipe.format.decode(results[k].t);
    if (t < seen.t || !seen.hit()) seen = {near[k], t};
  }
  return seen;
}

/// `saw` holds T in units of the scene's ray.
PixelKind compare(PixelCounts& counts, const Scene& scene, std::size_t ray, const Seen& is,
                  const Seen& saw, double u) {
  if (is.hit() != saw.hit()) {
    ++(saw.hit() ? counts.false_hits : counts.false_misses);
    return saw.hit() ? PixelKind::kFalseHit : PixelKind::kFalseMiss;
  }
  if (!is.hit()) return PixelKind::kNothing;
  counts.depth.add(std::abs(saw.t - is.t) / std::abs(is.t));
  if (saw.index == is.index) return PixelKind::kRight;
  const oracle::RayAnswer there = oracle::cast(scene.rays[ray], scene.triangles[saw.index]),
                          here = oracle::cast(scene.rays[ray], scene.triangles[is.index]);
  const double band = 16 * u;
  const bool met = there.hit || there.margin <= band;
  const double apart = std::abs(saw.t - is.t) * scene.rays[ray].d.norm() * here.cosine;
  const bool tie = met && apart <= band * here.scale;
  ++(tie ? counts.ties : counts.other);
  return tie ? PixelKind::kRight : PixelKind::kOther;
}

nlohmann::ordered_json counts_json(const PixelCounts& c, std::uint64_t rays) {
  const auto depth = [&](double share) {
    return c.depth.count() == 0 ? 0 : c.depth.quantile(share);
  };
  const Interval95 share = wilson(c.wrong(), rays);
  return {{"wrong_pixels", c.wrong()},
          {"interval_95", {1e6 * share.low, 1e6 * share.high}},
          {"false_hit_pixels", c.false_hits},
          {"false_miss_pixels", c.false_misses},
          {"other_triangle_pixels", c.other},
          {"tied_pixels", c.ties},
          {"depth_error",
           {{"count", c.depth.count()},
            {"median", depth(0.5)},
            {"p99", depth(0.99)},
            {"p999", depth(0.999)},
            {"largest", c.depth.count() == 0 ? 0 : c.depth.largest()}}}};
}

}  // namespace

std::vector<PictureAccuracy> picture_accuracy(const Mesh& mesh, std::span<const Ray> rays,
                                              const std::vector<AccuracyPipe>& pipes, bool quiet) {
  Progress progress("picture", quiet);
  const auto steps = static_cast<double>(2 * pipes.size() + 1);
  const Scene given = scene_in(FpFormat{11, 52}, mesh, rays);
  const std::vector<Seen> of_given = truths(given, progress, 0, 1 / steps);
  std::vector<PictureAccuracy> all;
  Scene scene;
  std::vector<Seen> of_words;
  for (std::size_t k = 0; k < pipes.size(); ++k) {
    const AccuracyPipe& pipe = pipes[k];
    const double from = static_cast<double>(2 * k + 1) / steps;
    if (k == 0 || pipe.format != pipes[k - 1].format) {
      scene = scene_in(pipe.format, mesh, rays);
      of_words = truths(scene, progress, from, from + 1 / steps);
    }
    const double u = std::ldexp(1, -1 - pipe.format.man_bits);
    PictureAccuracy row;
    row.pipe = pipe, row.rays = rays.size(), row.triangles = mesh.faces.size();
    row.scaled_by = scene.scaled_by;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      progress(from + (1 + static_cast<double>(i) / static_cast<double>(rays.size())) / steps);
      Seen saw = pipe_sees(scene, pipe, i);
      row.hits += saw.hit() ? 1 : 0;
      (void)compare(row.of_words, scene, i, of_words[i], saw, u);
      saw.t = std::ldexp(saw.t, -scene.scaled_by);
      const PixelKind kind = compare(row.of_scene, given, i, of_given[i], saw, u);
      row.pixels.push_back(kind);
      if (kind > PixelKind::kRight) {
        const double t = of_given[i].hit() ? of_given[i].t : saw.t;
        row.wrong.push_back({kind, (given.rays[i].o + t * given.rays[i].d).cast<float>()});
      }
    }
    std::vector<PairResult> results(mesh.faces.size());
    std::vector<std::uint64_t> ray;
    for (std::size_t i = 0; i < results.size(); ++i)
      ray.insert(ray.end(), scene.ray_words.begin(), scene.ray_words.begin() + kRayWords);
    reference::test_pairs(pipe.pair, pipe.algorithm, pipe.format, ray, scene.triangle_words,
                          results, PlaneSide::kSurface, {}, pipe.box);
    row.refused = static_cast<std::uint64_t>(
        std::count_if(results.begin(), results.end(), [](const PairResult& r) { return r.bad; }));
    all.push_back(row);
  }
  return all;
}

nlohmann::ordered_json picture_json(const std::vector<PictureAccuracy>& rows) {
  auto all = nlohmann::ordered_json::array();
  for (const PictureAccuracy& row : rows)
    all.push_back({{"format", row.pipe.format.name()},
                   {"algorithm", name(row.pipe.algorithm)},
                   {"box", row.pipe.box},
                   {"rays", row.rays},
                   {"hits", row.hits},
                   {"triangles", row.triangles},
                   {"bad_secondaries", row.refused},
                   {"scaled_by_power", row.scaled_by},
                   {"of_scene", counts_json(row.of_scene, row.rays)},
                   {"of_words", counts_json(row.of_words, row.rays)}});
  return all;
}

}  // namespace cde::accuracy
