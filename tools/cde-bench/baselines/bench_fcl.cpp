// SPDX-License-Identifier: Apache-2.0
#include "baselines/bench_fcl.hpp"

#ifdef CDE_FCL
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <exception>

#include "baselines/fcl_objects.hpp"
#include "bench/bench.hpp"

namespace cde::cli {
namespace {

using Object = fcl::CollisionObjectd;
using fcl_objects::in_child;
using fcl_objects::object;
using Solver = fcl::detail::GJKSolver_libccdd;

constexpr std::size_t kMostStops = 50;  // with more stops, the query counts as absent in FCL

enum class Call { kCollide, kDistance };

/// FCL has triangles only as parts of meshes. A pair with triangles calls the function that its
/// meshes use.
class Pairs {
 public:
  Pairs(Pair pair, std::span<const float> a, std::span<const float> b) {
    const Shape shape_a = primary_shape(pair), shape_b = secondary_shape(pair);
    const std::size_t a_words = primary_words(pair), b_words = secondary_words(pair);
    for (std::size_t i = 0; i < a.size() / a_words; ++i) {
      const auto words = a.subspan(i * a_words, a_words);
      if (shape_a == Shape::kTriangle)
        triangles_.push_back(triangle(words));
      else
        a_.push_back(object(shape_a, words));
      const auto words_b = b.subspan(i * b_words, b_words);
      if (shape_b == Shape::kTriangle)
        others_.push_back(triangle(words_b));
      else
        b_.push_back(object(shape_b, words_b));
    }
    plane_ = shape_b == Shape::kPlane;
    // FCL's signed distance of overlapping spheres fails an assertion.
    request_.enable_signed_distance =
        triangles_.empty() && shape_a != Shape::kSphere && shape_b != Shape::kSphere;
    request_.enable_nearest_points = true;
  }
  [[nodiscard]] std::size_t size() const { return b_.size() + others_.size(); }
  [[nodiscard]] bool has(Call call) const { return call == Call::kCollide || !plane_; }
  [[nodiscard]] bool has_signed_distance() const { return request_.enable_signed_distance; }

  /// Whether the pair touches, 1 or 0; -1 if FCL's solver gives up.
  [[nodiscard]] signed char ask(Call call, std::size_t i) const {
    try {
      if (!others_.empty()) return ask_triangles(call, i) ? 1 : 0;
      if (!triangles_.empty()) return ask_triangle(call, i) ? 1 : 0;
      if (call == Call::kCollide) {
        fcl::CollisionResultd result;
        const fcl::CollisionRequestd request(1, true);
        return fcl::collide(&a_[i], &b_[i], request, result) > 0 ? 1 : 0;
      }
      fcl::DistanceResultd result;
      return fcl::distance(&a_[i], &b_[i], request_, result) <= 0 ? 1 : 0;
    } catch (const std::exception&) {
      return -1;
    }
  }

 private:
  [[nodiscard]] static BasicTriangle<double> triangle(std::span<const float> words) {
    return primitive_cast<double>(from_words<Triangle>(words.first<Triangle::kWords>()));
  }
  [[nodiscard]] bool ask_triangles(Call call, std::size_t i) const {
    const BasicTriangle<double>&s = triangles_[i], &t = others_[i];
    if (call == Call::kCollide)
      return fcl::detail::Intersectd::intersect_Triangle(s.v0, s.v1, s.v2, t.v0, t.v1, t.v2);
    fcl::Vector3d p, q;
    return fcl::detail::TriangleDistanced::triDistance(s.v0, s.v1, s.v2, t.v0, t.v1, t.v2, p, q) <=
           0;
  }
  [[nodiscard]] bool ask_triangle(Call call, std::size_t i) const {
    const fcl::CollisionGeometryd* geometry = b_[i].collisionGeometry().get();
    switch (geometry->getNodeType()) {
      case fcl::GEOM_SPHERE:
        return ask_triangle(call, static_cast<const fcl::Sphered&>(*geometry), i);
      case fcl::GEOM_CYLINDER:
        return ask_triangle(call, static_cast<const fcl::Cylinderd&>(*geometry), i);
      default:
        return ask_triangle(call, static_cast<const fcl::Boxd&>(*geometry), i);
    }
  }
  template <class Solid>
  [[nodiscard]] bool ask_triangle(Call call, const Solid& shape, std::size_t i) const {
    const BasicTriangle<double>& t = triangles_[i];
    fcl::Vector3d p, q;
    double depth = 0;
    if (call == Call::kCollide)
      return solver_.shapeTriangleIntersect(shape, b_[i].getTransform(), t.v0, t.v1, t.v2, &p,
                                            &depth, &q);
    return !solver_.shapeTriangleDistance(shape, b_[i].getTransform(), t.v0, t.v1, t.v2, &depth, &p,
                                          &q);
  }

  std::vector<BasicTriangle<double>> triangles_, others_;
  std::vector<Object> a_, b_;
  bool plane_ = false;
  fcl::DistanceRequestd request_;
  Solver solver_;
};

/// FCL's answer to each pair. It is -1 if FCL gives up or stops the program. Nothing if too many
/// pairs stop the program.
std::vector<signed char> answers(const Pairs& pairs, Call call) {
  std::vector<signed char> all;
  std::size_t stops = 0;
  while (all.size() < pairs.size()) {
    const auto some = in_child<signed char>([&](const auto& put) {
      for (std::size_t i = all.size(); i < pairs.size(); ++i) put(pairs.ask(call, i));
    });
    all.insert(all.end(), some.begin(), some.end());
    if (all.size() == pairs.size()) break;
    all.push_back(-1);
    if (++stops > kMostStops) return {};
  }
  return all;
}

std::optional<double> rate(const Pairs& pairs, Call call, const std::vector<signed char>& answers,
                           double seconds) {
  std::vector<std::size_t> sound;
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (answers[i] >= 0) sound.push_back(i);
  if (sound.empty()) return std::nullopt;
  const auto measured = in_child<double>([&](const auto& put) {
    const double start = thread_seconds();
    double asked = 0, elapsed = 0;
    volatile signed char answer = 0;
    do {
      for (const std::size_t i : sound) answer = pairs.ask(call, i);
      asked += static_cast<double>(sound.size());
      elapsed = thread_seconds() - start;
    } while (elapsed < seconds);
    (void)answer;
    put(asked / elapsed);
  });
  if (measured.empty()) return std::nullopt;
  return measured.front();
}

}  // namespace

bool has_fcl() {
  return true;
}

FclRates measure_fcl(Pair pair, std::span<const float> a, std::span<const float> b,
                     double seconds) {
  FclRates rates;
  if (name(pair).starts_with("ray-")) return rates;
  const Pairs pairs(pair, a, b);
  const auto stops = [](const std::vector<signed char>& all) {
    return static_cast<std::size_t>(std::count(all.begin(), all.end(), -1));
  };
  rates.hits = answers(pairs, Call::kCollide);
  rates.collide_stops = stops(rates.hits);
  rates.collide = rate(pairs, Call::kCollide, rates.hits, seconds);
  if (!pairs.has(Call::kDistance)) return rates;
  const auto distances = answers(pairs, Call::kDistance);
  rates.distance_stops = stops(distances);
  rates.distance = rate(pairs, Call::kDistance, distances, seconds);
  rates.distance_signed = pairs.has_signed_distance();
  return rates;
}

}  // namespace cde::cli

#else

namespace cde::cli {

bool has_fcl() {
  return false;
}

FclRates measure_fcl(Pair, std::span<const float>, std::span<const float>, double) {
  return {};
}

}  // namespace cde::cli

#endif
