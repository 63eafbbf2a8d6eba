// SPDX-License-Identifier: Apache-2.0
// Casts rays from inside a closed mesh at the edges and vertices of its triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "cde/accuracy/tally.hpp"
#include "cde/oracle/random.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/reference/pairs.hpp"

namespace cde::accuracy {
namespace {

using oracle::Vec;

struct ClosedMesh {
  std::vector<Vec> vertices;
  std::vector<std::array<std::size_t, 3>> faces;
};

/// A mesh of 320 triangles and radius 1: an icosahedron whose faces are cut into four twice.
const ClosedMesh& icosphere() {
  static const ClosedMesh sphere = [] {
    constexpr double kGolden = std::numbers::phi;
    ClosedMesh mesh;
    for (const double y : {-1.0, 1.0})
      for (const double z : {-kGolden, kGolden})
        for (const Vec& v : {Vec(0, y, z), Vec(y, z, 0), Vec(z, 0, y)})
          mesh.vertices.push_back(v.normalized());
    const double edge = 2 / Vec(0, 1, kGolden).norm() + 1e-9;
    const auto near = [&](std::size_t i, std::size_t k) {
      return (mesh.vertices[i] - mesh.vertices[k]).norm() < edge;
    };
    for (std::size_t i = 0; i < 12; ++i)
      for (std::size_t k = i + 1; k < 12; ++k)
        for (std::size_t m = k + 1; m < 12; ++m)
          if (near(i, k) && near(k, m) && near(i, m)) mesh.faces.push_back({i, k, m});
    for (int cut = 0; cut < 2; ++cut) {
      std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
      const auto middle = [&](std::size_t i, std::size_t k) {
        const auto [at, is_new] = middles.try_emplace(std::minmax(i, k), mesh.vertices.size());
        if (is_new) mesh.vertices.push_back((mesh.vertices[i] + mesh.vertices[k]).normalized());
        return at->second;
      };
      std::vector<std::array<std::size_t, 3>> finer;
      for (const auto& [i, k, m] : mesh.faces) {
        const std::size_t ik = middle(i, k), km = middle(k, m), mi = middle(m, i);
        finer.insert(finer.end(), {{i, ik, mi}, {ik, k, km}, {mi, km, m}, {ik, km, mi}});
      }
      mesh.faces = std::move(finer);
    }
    return mesh;
  }();
  return sphere;
}

/// A ray and the mesh around it, as numbers of the format.
struct LeakCase {
  oracle::Ray ray;
  std::vector<Vec> vertices;
};

LeakCase make(std::size_t family, std::uint64_t seed, std::uint64_t index,
              const oracle::Format& format) {
  const ClosedMesh& mesh = icosphere();
  oracle::Random random(seed, 2000 + family, index);
  const bool vertex = family == 1 || (family > 1 && random.chance(0.3));
  const double size = family == 2 ? random.decades(1e-3, 1e6) : 1;
  const double away = family == 3 ? random.decades(10, 1e5) : 0;
  const Vec centre = away * random.direction();
  const auto round = [&](const Vec& v) -> Vec {
    return v.unaryExpr([&](double x) { return format.round(x); });
  };
  LeakCase made;
  for (const Vec& v : mesh.vertices) made.vertices.push_back(round(centre + size * v));
  const auto& face =
      mesh.faces[static_cast<std::size_t>(random.below(static_cast<int>(mesh.faces.size())))];
  const double along = vertex ? 0 : random.unit();
  const Vec at = (1 - along) * made.vertices[face[0]] + along * made.vertices[face[1]];
  const double from = random.unit();
  made.ray.o = round(centre + 0.5 * size * from * random.direction());
  const double length = random.decades(0.1, 10);
  made.ray.d = round(length * (at - made.ray.o));
  made.ray.tmin = 0;
  made.ray.tmax = std::numeric_limits<double>::infinity();
  return made;
}

}  // namespace

const std::vector<std::string>& leak_families() {
  static const std::vector<std::string> all = {"mesh-edges", "mesh-vertices", "mesh-sizes",
                                               "mesh-offsets"};
  return all;
}

Tally measured_leaks(const AccuracyPipe& pipe, const std::string& family, std::uint64_t seed,
                     std::uint64_t first, std::uint64_t count) {
  const oracle::Format format{pipe.format.exp_bits, pipe.format.man_bits};
  const auto& names = leak_families();
  const auto which =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), family) - names.begin());
  const auto& faces = icosphere().faces;
  std::vector<PairResult> results(faces.size());
  std::vector<std::uint64_t> a, b;
  const auto append = [&](std::vector<std::uint64_t>& words, const std::vector<double>& numbers) {
    for (const double x : numbers) words.push_back(pipe.format.encode(x));
  };
  Tally tally;
  for (std::uint64_t i = first; i < first + count; ++i) {
    const LeakCase c = make(which, seed, i, format);
    a.clear(), b.clear();
    std::vector<std::uint64_t> ray;
    append(ray, oracle::to_words(c.ray, format));
    std::vector<oracle::Triangle> triangles;
    for (const auto& f : faces) {
      triangles.push_back({c.vertices[f[0]], c.vertices[f[1]], c.vertices[f[2]]});
      a.insert(a.end(), ray.begin(), ray.end());
      append(b, oracle::to_words(oracle::Shape(triangles.back()), format));
    }
    reference::test_pairs(pipe.pair, pipe.algorithm, pipe.format, a, b, results,
                          PlaneSide::kSurface, {}, pipe.box);
    ++tally.cases;
    if (std::any_of(results.begin(), results.end(), [](const auto& r) { return r.bad; })) {
      ++tally.refused;
      continue;
    }
    ++tally.leak_rays;
    if (std::any_of(results.begin(), results.end(), [](const auto& r) { return r.f; })) continue;
    // Choose the triangle that is hit by the largest margin.
    std::optional<std::size_t> met;
    double margin = -1;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const oracle::RayAnswer exact = oracle::cast(c.ray, triangles[k]);
      if (exact.hit && exact.margin > margin) met = k, margin = exact.margin;
    }
    if (!met) continue;
    ++tally.leaks;
    const auto* words = &b[*met * b.size() / faces.size()];
    keep_worst(tally.worst_leak,
               {family, i, margin / format.u(), ray, {words, words + b.size() / faces.size()}});
  }
  return tally;
}

}  // namespace cde::accuracy
