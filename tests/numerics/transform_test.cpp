// SPDX-License-Identifier: Apache-2.0
// Accuracy of transforms: every word that the card's transformer computes, and answers for pairs
// with moved shapes, against the same motion in double precision.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <random>

#include "cde/geometry/check.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/reference/pipes/transform.hpp"

namespace cde {
namespace {

constexpr unsigned kSeed = 11;
constexpr double kU = reference::kUnitRoundoff<float>;

class Motions {
 public:
  Motions() { std::printf("seed %u\n", kSeed); }
  float in(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  Eigen::Vector3f point(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Eigen::Matrix3f rotation() {
    const Eigen::Vector3d axis = point(1).cast<double>().normalized();
    return Eigen::AngleAxisd(in(-3, 3), axis).toRotationMatrix().cast<float>();
  }
  Eigen::Vector3f unit() { return point(1).cast<double>().normalized().cast<float>(); }
  /// Near and far, from 1e-3 to 1e5.
  float size() { return std::pow(10.0f, in(-3, 5)); }
  Transform motion(float size) { return {rotation(), point(size)}; }

 private:
  std::mt19937 engine_{kSeed};
};

BasicTransform<double> exactly(const Transform& m) {
  return {m.rotation.cast<double>(), m.translation.cast<double>()};
}

/// sum_j |R_ij p_j|, one per row.
Eigen::Vector3d products(const Transform& m, const Eigen::Vector3f& p) {
  return m.rotation.cast<double>().cwiseAbs() * p.cast<double>().cwiseAbs();
}

/// The error bound of a sum of n rounded terms is n u / (1 - n u) times the sum of their sizes.
/// Each subnormal product adds half of the smallest number.
double rounding(int n, double sizes) {
  return n * kU / (1 - n * kU) * sizes + n * 0x1p-150;
}
Eigen::Vector3d point_bound(const Transform& m, const Eigen::Vector3f& p) {
  const Eigen::Vector3d sizes = products(m, p) + m.translation.cast<double>().cwiseAbs();
  return sizes.unaryExpr([](double x) { return rounding(4, x); });
}
Eigen::Vector3d direction_bound(const Transform& m, const Eigen::Vector3f& d) {
  return products(m, d).unaryExpr([](double x) { return rounding(3, x); });
}

/// The largest ratio of a component's error to its bound.
double share(const Eigen::Vector3f& got, const Eigen::Vector3d& exact,
             const Eigen::Vector3d& bound) {
  return ((got.cast<double>() - exact).cwiseAbs().array() / bound.array()).maxCoeff();
}

TEST(TransformNumerics, EveryWord_IsWithinItsRounding) {
  Motions random;
  double point = 0, direction = 0, distance = 0, box = 0;
  for (int i = 0; i < 200'000; ++i) {
    const float size = random.size();
    const Transform m = random.motion(random.size());
    const BasicTransform<double> exact = exactly(m);
    const Ray ray{random.point(size), random.point(size), 0.5f, 7};
    const Ray moved = reference::transformed(m, ray);
    point =
        std::max(point, share(moved.o, exact.rotation * ray.o.cast<double>() + exact.translation,
                              point_bound(m, ray.o)));
    direction = std::max(direction, share(moved.d, exact.rotation * ray.d.cast<double>(),
                                          direction_bound(m, ray.d)));
    EXPECT_EQ(moved.tmin, ray.tmin);
    EXPECT_EQ(moved.tmax, ray.tmax);

    // d' = d + n'.t: three roundings of n', then four of the sum.
    const Plane plane{random.unit(), random.in(-size, size)};
    const Plane moved_plane = reference::transformed(m, plane);
    const Eigen::Vector3d t = exact.translation, n = exact.rotation * plane.n.cast<double>();
    const double terms = moved_plane.n.cast<double>().cwiseAbs().dot(t.cwiseAbs());
    const double bound =
        direction_bound(m, plane.n).dot(t.cwiseAbs()) + rounding(4, terms + std::abs(plane.d));
    distance = std::max(distance, std::abs(moved_plane.d - (plane.d + n.dot(t))) / bound);

    const Obb obb{random.point(size), {1, 2, 3}, random.rotation()};
    const Obb moved_obb = reference::transformed(m, obb);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f axis = obb.rotation.col(k);
      box = std::max(box, share(moved_obb.rotation.col(k), exact.rotation * axis.cast<double>(),
                                direction_bound(m, axis)));
    }
    EXPECT_FALSE(reference::bad(moved_obb)) << "two rotations, each rounded once from doubles";
    EXPECT_FALSE(reference::bad(moved_plane));
  }
  std::printf("largest share of the bound: points %.2f, directions %.2f, plane %.2f, box %.2f\n",
              point, direction, distance, box);
  for (const double worst : {point, direction, distance, box}) {
    EXPECT_LE(worst, 1);
    EXPECT_GT(worst, 0.1) << "the bound is too loose to test anything";
  }
}

/// The signed distance. The contract of the pairs is 16 u S (S = |cB - cA|_1 and the extents of
/// both). No signed distance changes by more than the points of its shapes, so the motion adds
/// their bounds.
class Distances {
 public:
  explicit Distances(Pair pair) : pair_(pair) {}

  template <class A, class B>
  void add(const A& a, const Transform& ma, double error_a, const B& b, const Transform& mb,
           double error_b, double extents) {
    const A moved_a = reference::transformed(ma, a);
    const B moved_b = reference::transformed(mb, b);
    const auto exact_a = reference::transformed(exactly(ma), primitive_cast<double>(a));
    const auto exact_b = reference::transformed(exactly(mb), primitive_cast<double>(b));
    const double scale = extents + (centre(exact_a) - centre(exact_b)).cwiseAbs().sum();
    const double bound = 16 * kU * scale + error_a + error_b;
    const double got = distance({8, 23}, moved_a, moved_b),
                 wanted = distance({11, 52}, exact_a, exact_b);
    worst_ = std::max(worst_, std::abs(got - wanted) / bound);
    ++(wanted <= 0 ? hits_ : misses_);
  }
  void judge() const {
    std::printf("%s: %d hit, %d miss, largest share of the bound %.2f\n",
                std::string(name(pair_)).c_str(), hits_, misses_, worst_);
    EXPECT_LE(worst_, 1);
    EXPECT_GT(worst_, 0.02);
    EXPECT_GE(hits_, 0.2 * (hits_ + misses_));
    EXPECT_GE(misses_, 0.2 * (hits_ + misses_));
  }

 private:
  static Eigen::Vector3d centre(const BasicSphere<double>& x) { return x.c; }
  static Eigen::Vector3d centre(const BasicObb<double>& x) { return x.c; }
  static Eigen::Vector3d centre(const BasicTriangle<double>& x) { return x.v0; }

  template <class A, class B>
  [[nodiscard]] double distance(FpFormat format, const A& a, const B& b) const {
    using S = typename A::Scalar;
    using Bits = std::conditional_t<std::is_same_v<S, float>, std::uint32_t, std::uint64_t>;
    std::vector<std::uint64_t> wa, wb;
    for (const S x : to_words(a)) wa.push_back(std::bit_cast<Bits>(x));
    for (const S x : to_words(b)) wb.push_back(std::bit_cast<Bits>(x));
    std::array<PairResult, 1> r;
    reference::test_pairs(pair_, Algorithm::kMoller, format, wa, wb, r);
    EXPECT_FALSE(r[0].bad);
    const double t = std::bit_cast<S>(static_cast<Bits>(r[0].t));
    return r[0].f ? -t : t;
  }

  Pair pair_;
  double worst_ = 0;
  int hits_ = 0, misses_ = 0;
};

TEST(TransformNumerics, Answers_EqualTheMotionInDoublePrecision) {
  Motions random;
  Distances spheres(Pair::kSphereSphere), triangles(Pair::kTriangleSphere), boxes(Pair::kSphereObb);
  for (int i = 0; i < 50'000; ++i) {
    // Both shapes start elsewhere in the world and move to where they meet.
    const float away = random.size();
    const auto onto = [&](const Eigen::Vector3f& from, float spread) {
      Transform m{random.rotation(), {}};
      m.translation = random.point(spread) - m.rotation * from;
      return m;
    };
    const Sphere a{random.point(away), random.in(0.5f, 2)}, b{random.point(away), 1};
    const Transform ma = onto(a.c, 2), mb = onto(b.c, 2);
    const double error_a = point_bound(ma, a.c).norm(), error_b = point_bound(mb, b.c).norm();
    spheres.add(a, ma, error_a, b, mb, error_b, 2.0 * (a.r + b.r));

    const Eigen::Vector3f corner = random.point(away);
    const Triangle t{corner, corner + random.point(2), corner + random.point(2)};
    const Transform mt = onto(corner, 1);
    const double error_t = std::max(
        {point_bound(mt, t.v0).norm(), point_bound(mt, t.v1).norm(), point_bound(mt, t.v2).norm()});
    triangles.add(t, mt, error_t, a, ma, error_a, 2.0 * a.r + 12);

    const Obb box{random.point(away), {random.in(0.2f, 1), 1, 0.5f}, random.rotation()};
    const Transform mo = onto(box.c, 2);
    double error_o = point_bound(mo, box.c).norm();
    for (int k = 0; k < 3; ++k)
      error_o += box.half[k] * direction_bound(mo, box.rotation.col(k)).norm();
    boxes.add(a, ma, error_a, box, mo, error_o, 2.0 * (a.r + box.half.cast<double>().sum()));
  }
  for (const Distances* distances : {&spheres, &triangles, &boxes}) distances->judge();
}

}  // namespace
}  // namespace cde
