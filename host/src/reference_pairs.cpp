#include "cde/reference/pairs.hpp"

#include <fmt/format.h>

#include <bit>

#include "cde/error.hpp"
#include "cde/fp.hpp"
#include "cde/reference/convex/obb_obb.hpp"
#include "cde/reference/convex/obb_plane.hpp"
#include "cde/reference/convex/sphere_obb.hpp"
#include "cde/reference/convex/sphere_sphere.hpp"
#include "cde/reference/convex/triangle_box.hpp"
#include "cde/reference/convex/triangle_sphere.hpp"
#include "cde/reference/cylinder/pairs.hpp"
#include "cde/reference/ray_cylinder.hpp"
#include "cde/reference/ray_sphere.hpp"
#include "cde/reference/ray_triangle.hpp"

namespace cde::reference {

namespace {

template <class S>
S from_word(std::uint64_t word) {
  if constexpr (std::is_same_v<S, float>)
    return std::bit_cast<float>(static_cast<std::uint32_t>(word));
  else if constexpr (std::is_same_v<S, double>)
    return std::bit_cast<double>(word);
  else
    return S::from_bits(static_cast<typename S::Bits>(word));
}

template <class S>
std::uint64_t to_word(S x) {
  x = canonical(x);
  if constexpr (std::is_same_v<S, float>)
    return std::bit_cast<std::uint32_t>(x);
  else if constexpr (std::is_same_v<S, double>)
    return std::bit_cast<std::uint64_t>(x);
  else
    return x.bits();
}

template <class P>
P shape(const std::uint64_t* words) {
  P p;
  visit_words(p, [&words](const char*, int, auto& word) {
    word = from_word<typename P::Scalar>(*words++);
  });
  return p;
}

template <class S, class A, class B, class Test>
void sweep(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
           std::span<PairResult> results, Test test) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Outcome<S> o = test(shape<A>(&a[i * A::kWords]), shape<B>(&b[i * B::kWords]));
    PairResult& r = results[i];
    r.f = o.f;
    r.bad = o.bad;
    r.t = to_word(o.t);
    for (int k = 0; k < 3; ++k) {
      r.cp[k] = to_word<S>(o.cp[k]);
      r.n[k] = to_word<S>(o.n[k]);
    }
  }
}

template <class S>
void test_pairs_in(Pair pair, Algorithm algorithm, PlaneSide plane, const PairBudget& work,
                   std::span<const std::uint64_t> a, std::span<const std::uint64_t> b,
                   std::span<PairResult> r) {
  using R = BasicRay<S>;
  using T = BasicTriangle<S>;
  using Ball = BasicSphere<S>;
  using Box = BasicObb<S>;
  using Can = BasicCylinder<S>;
  const cylinder::Budget budget{static_cast<int>(work.samples), static_cast<int>(work.circle),
                                static_cast<int>(work.free)};
#define CDE_SEARCH(A, FUNCTION) \
  sweep<S, A, Can>(a, b, r, [&](const A& x, const Can& y) { return FUNCTION<S>(x, y, budget); })
#define CDE_SWEEP(A, B, FUNCTION) \
  sweep<S, A, B>(a, b, r, [](const A& x, const B& y) { return FUNCTION<S>(x, y); })
  switch (pair) {
    case Pair::kRayTriangle:
      switch (algorithm) {
        case Algorithm::kMoller:
          return CDE_SWEEP(R, T, ray_triangle_moller);
        case Algorithm::kBadouel:
          return CDE_SWEEP(R, T, ray_triangle_badouel);
        case Algorithm::kPluecker:
          return CDE_SWEEP(R, T, ray_triangle_pluecker);
        case Algorithm::kWatertight:
          return CDE_SWEEP(R, T, ray_triangle_watertight);
      }
      break;
    case Pair::kObbObb:
      return CDE_SWEEP(Box, Box, obb_obb);
    case Pair::kTriangleAabb:
      return CDE_SWEEP(T, BasicAabb<S>, triangle_aabb);
    case Pair::kTriangleObb:
      return CDE_SWEEP(T, Box, triangle_obb);
    case Pair::kSphereSphere:
      return CDE_SWEEP(Ball, Ball, sphere_sphere);
    case Pair::kTriangleSphere:
      return CDE_SWEEP(T, Ball, triangle_sphere);
    case Pair::kRayCylinder:
      return CDE_SWEEP(R, BasicCylinder<S>, ray_cylinder);
    case Pair::kObbPlane:
      return sweep<S, Box, BasicPlane<S>>(a, b, r, [plane](const Box& x, const BasicPlane<S>& y) {
        return obb_plane<S>(x, y, plane);
      });
    case Pair::kRaySphere:
      return CDE_SWEEP(R, Ball, ray_sphere);
    case Pair::kSphereObb:
      return CDE_SWEEP(Ball, Box, sphere_obb);
    case Pair::kTriangleCylinder:
      return CDE_SEARCH(T, triangle_cylinder);
    case Pair::kCylinderCylinder:
      return CDE_SEARCH(Can, cylinder_cylinder);
    case Pair::kObbCylinder:
      return CDE_SEARCH(Box, obb_cylinder);
  }
#undef CDE_SWEEP
#undef CDE_SEARCH
  throw Error(ErrorCode::kUsage, fmt::format("no reference for {}", name(pair)));
}

}  // namespace

bool has_pair(Pair pair, Algorithm algorithm) {
  return pair == Pair::kRayTriangle || algorithm == Algorithm::kMoller;
}

void test_pairs(Pair pair, Algorithm algorithm, FpFormat format, std::span<const std::uint64_t> a,
                std::span<const std::uint64_t> b, std::span<PairResult> results, PlaneSide plane,
                const PairBudget& budget) {
  budget.check();
  if (a.size() != results.size() * primary_words(pair) ||
      b.size() != results.size() * secondary_words(pair))
    throw Error(ErrorCode::kUsage,
                fmt::format("{} pairs of {} need {} and {} words, not {} and {}", results.size(),
                            name(pair), results.size() * primary_words(pair),
                            results.size() * secondary_words(pair), a.size(), b.size()));
  if (format == FpFormat{8, 23})
    return test_pairs_in<float>(pair, algorithm, plane, budget, a, b, results);
  if (format == FpFormat{11, 52})
    return test_pairs_in<double>(pair, algorithm, plane, budget, a, b, results);
  if (format == FpFormat{5, 10})
    return test_pairs_in<Fp<5, 10>>(pair, algorithm, plane, budget, a, b, results);
  if (format == FpFormat{8, 7})
    return test_pairs_in<Fp<8, 7>>(pair, algorithm, plane, budget, a, b, results);
  if (format == FpFormat{7, 16})
    return test_pairs_in<Fp<7, 16>>(pair, algorithm, plane, budget, a, b, results);
  throw Error(ErrorCode::kUsage, fmt::format("pairs have no reference in {}", format.name()));
}

}  // namespace cde::reference
