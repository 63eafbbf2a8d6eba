// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/signed_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace cde::oracle {
namespace {

// A core is a shape around its own centre, without a sphere's radius. It has a support point, and
// directions of faces and edges that only serve as first guesses.

double sign(double x) {
  return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0;
}

struct PointCore {
  [[nodiscard]] Vec support(const Vec&) const { return Vec::Zero(); }
  static constexpr std::array<Vec, 0> faces() { return {}; }
  static constexpr std::array<Vec, 0> edges() { return {}; }
};

struct TriangleCore {
  std::array<Vec, 3> v;
  [[nodiscard]] Vec support(const Vec& n) const {
    const double d0 = n.dot(v[0]), d1 = n.dot(v[1]), d2 = n.dot(v[2]);
    if (d0 >= d1 && d0 >= d2) return v[0];
    return d1 >= d2 ? v[1] : v[2];
  }
  [[nodiscard]] std::array<Vec, 1> faces() const { return {(v[1] - v[0]).cross(v[2] - v[0])}; }
  [[nodiscard]] std::array<Vec, 3> edges() const { return {v[1] - v[0], v[2] - v[1], v[0] - v[2]}; }
};

struct BoxCore {
  std::array<Vec, 3> e;  // half edges
  [[nodiscard]] Vec support(const Vec& n) const {
    return sign(n.dot(e[0])) * e[0] + sign(n.dot(e[1])) * e[1] + sign(n.dot(e[2])) * e[2];
  }
  [[nodiscard]] std::array<Vec, 3> faces() const {
    return {e[1].cross(e[2]), e[2].cross(e[0]), e[0].cross(e[1])};
  }
  [[nodiscard]] std::array<Vec, 3> edges() const { return e; }
};

struct CylinderCore {
  Vec axis;  // unit
  double half_height, radius;
  [[nodiscard]] Vec support(const Vec& n) const {
    // A double cross product: n - (a.n) a would cancel near the axis.
    const Vec across = axis.cross(n).cross(axis);
    const double length = across.norm();
    const Vec cap = (sign(axis.dot(n)) * half_height) * axis;
    return length > 0 ? Vec(cap + (radius / length) * across) : cap;
  }
  [[nodiscard]] std::array<Vec, 1> faces() const { return {axis}; }
  [[nodiscard]] std::array<Vec, 1> edges() const { return {axis}; }
};

/// Up to four points of the Minkowski difference, and the point of their hull nearest to -shift.
class Simplex {
 public:
  /// Adds y and drops the points that the nearest point does not need.
  void add(const Vec& y, const Vec& shift = Vec::Zero()) {
    points_[count_++] = y;
    shift_ = shift;
    norm_ = std::numeric_limits<double>::infinity();
    for (unsigned subset = 1; subset < 1U << count_; ++subset) try_subset(subset);
    std::array<Vec, 4> kept;
    std::size_t n = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if (best_subset_ >> i & 1U) kept[n++] = points_[i];
    points_ = kept;
    count_ = n;
  }
  [[nodiscard]] bool full() const { return count_ == 4; }  ///< -shift is inside
  [[nodiscard]] const Vec& nearest() const { return nearest_; }
  [[nodiscard]] double norm() const { return norm_; }  ///< of nearest() + shift

 private:
  /// The weights are positive and sum to 1, so they make a point of the hull despite rounding.
  void take(unsigned subset, const std::array<Vec, 4>& p, std::size_t n,
            const std::array<double, 4>& weights) {
    Vec point = p[0];
    for (std::size_t i = 1; i < n; ++i) point += weights[i] * (p[i] - p[0]);
    const double norm = n == 4 ? 0 : (point + shift_).norm();
    if (norm < norm_) norm_ = norm, best_subset_ = subset, nearest_ = point;
  }
  // Considers the interior of the sub-simplex. Its sides are separate subsets.
  void try_subset(unsigned subset) {
    std::array<Vec, 4> p, q;
    std::size_t n = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if (subset >> i & 1U) p[n] = points_[i], q[n] = p[n] + shift_, ++n;
    if (n == 1) take(subset, p, n, {});
    if (n == 2) {
      const Vec e = p[1] - p[0];
      const double length = e.squaredNorm(), t = -q[0].dot(e);
      if (t > 0 && t < length) take(subset, p, n, {0, t / length});
    }
    if (n == 3) {
      const Vec e1 = p[1] - p[0], e2 = p[2] - p[0], normal = e1.cross(e2);
      const double area = normal.squaredNorm();
      const double u = e2.cross(q[0]).dot(normal), v = q[0].cross(e1).dot(normal);
      if (area > 0 && u > 0 && v > 0 && u + v < area) take(subset, p, n, {0, u / area, v / area});
    }
    if (n == 4) {
      const auto volume = [](const Vec& a, const Vec& b, const Vec& c) {
        return a.cross(b).dot(c);
      };
      const double w0 = volume(q[1], q[2], q[3]), w1 = -volume(q[0], q[2], q[3]),
                   w2 = volume(q[0], q[1], q[3]), w3 = -volume(q[0], q[1], q[2]);
      const double sum = w0 + w1 + w2 + w3;
      if ((w0 > 0 && w1 > 0 && w2 > 0 && w3 > 0) || (w0 < 0 && w1 < 0 && w2 < 0 && w3 < 0))
        take(subset, p, n, {0, w1 / sum, w2 / sum, w3 / sum});
    }
  }

  std::array<Vec, 4> points_;
  std::size_t count_ = 0;
  unsigned best_subset_ = 1;
  Vec shift_ = Vec::Zero(), nearest_ = Vec::Zero();
  double norm_ = std::numeric_limits<double>::infinity();
};

/// A square on a face of the cube [-1, 1]^3, seen from the centre. It holds the directions p with
/// p[axis] = side and the next two coordinates within w of u and v. The coordinates are dyadic, so
/// they are exact.
struct Cell {
  double bound;  // upper bound of g over unit normals n of the cell
  double u, v, w;
  Vec y;  // point of the Minkowski difference that proves the bound
  int axis;
  double side;

  [[nodiscard]] Vec direction() const {
    Vec p;
    p[axis] = side;
    p[(axis + 1) % 3] = u;
    p[(axis + 2) % 3] = v;
    return p;
  }
  bool operator<(const Cell& other) const { return bound < other.bound; }
};

/// A cap of unit normals.
struct Cap {
  Vec n0;
  double cos_rho, sin_rho;

  /// Every direction of the cell is p + (0, du, dv) with |(du, dv)| <= sqrt(2) w. Its angle to p is
  /// at most asin(sqrt(2) w / |p|).
  explicit Cap(const Cell& cell) {
    const Vec p = cell.direction();
    const double length = p.norm();
    n0 = p / length;
    sin_rho = std::sqrt(2.0) * cell.w / length * (1 + 1e-15);
    cos_rho = std::sqrt((1 - sin_rho) * (1 + sin_rho));
  }
  /// The largest n.y over the cap. Sets n to a normal that attains it.
  double bound(const Vec& y, Vec& n) const {
    const double p = n0.dot(y);
    const Vec across = y - p * n0;
    const double t = across.norm();
    if (t * cos_rho <= p * sin_rho) {
      const double norm = y.norm();
      n = norm > 0 ? Vec(y / norm) : n0;
      return norm;
    }
    // Normalised, because `across` is not exactly perpendicular to n0 if y is nearly along n0.
    n = t > 0 ? Vec((cos_rho * n0 + (sin_rho / t) * across).normalized()) : n0;
    return p * cos_rho + t * sin_rho;
  }
  /// The vector c n0 for the point -c n0 from which the normal of bound(y) points at y. It is 0 if
  /// that normal is y's own direction.
  [[nodiscard]] Vec back_from(const Vec& y) const {
    const double p = n0.dot(y), t = (y - p * n0).norm();
    return std::max(0.0, t * cos_rho / sin_rho - p) * n0;
  }
  /// The point of the segment y..z with nearly the least bound. It is the zero of the derivative of
  /// cos_rho p + sin_rho t, where t is the length of the part perpendicular to n0.
  [[nodiscard]] Vec best_between(const Vec& y, const Vec& z) const {
    const Vec e = z - y;
    const double de = n0.dot(e);
    const Vec ya = y - n0.dot(y) * n0, ea = e - de * n0;
    const double a = ea.squaredNorm();
    const double k = cos_rho * de / sin_rho;
    if (a <= k * k) return k < 0 ? z : y;
    const double b = ya.dot(ea) / a;
    const double rest = (ya - b * ea).squaredNorm();
    const double m = -k * std::sqrt(rest / (a * (a - k * k)));
    return y + std::clamp(m - b, 0.0, 1.0) * e;
  }
};

template <class A, class B>
class Search {
 public:
  Search(const A& a, const B& b, const Vec& apart, double tolerance, long max_evaluations)
      : a_(a), b_(b), apart_(apart), tolerance_(tolerance), max_evaluations_(max_evaluations) {}

  SignedDistance run() {
    guess();
    if (!separate()) enclose();
    return {lo_, std::max(lo_, hi_), n_, hi_ - lo_ <= tolerance_, evaluations_};
  }

 private:
  static constexpr int kTightenings = 4;
  static constexpr int kHardTightenings = 20;
  static constexpr int kSeparationSteps = 60;
  static constexpr long kHard = 300;     // evaluations after which a pair counts as hard
  static constexpr double kNear = 0.25;  // least share of the way to lo_ for a step

  /// The point of B - A with the least n.y, which is g(n).
  Vec evaluate(const Vec& n) {
    ++evaluations_;
    Vec y = apart_ + b_.support(-n) - a_.support(n);
    const double g = n.dot(y);
    if (g > lo_) lo_ = g, n_ = n;
    return y;
  }

  void guess_both_ways(const Vec& n) {
    const double length = n.norm();
    if (!(length > 0)) return;
    evaluate(n / length);
    evaluate(-n / length);
  }

  /// Finds good lower bounds early. The proof does not depend on them.
  void guess() {
    evaluate(Vec::UnitZ());
    guess_both_ways(apart_);
    for (const Vec& n : a_.faces()) guess_both_ways(n);
    for (const Vec& n : b_.faces()) guess_both_ways(n);
    for (const Vec& e : a_.edges())
      for (const Vec& f : b_.edges()) guess_both_ways(e.cross(f));
  }

  /// True if the shapes are apart and the distance is found. |y| is an upper bound, and g(y / |y|)
  /// a lower bound.
  bool separate() {
    Simplex simplex;
    simplex.add(evaluate(n_));
    double last = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSeparationSteps && !simplex.full(); ++step) {
      const double norm = simplex.norm();
      hi_ = std::min(hi_, norm);
      if (hi_ - lo_ <= tolerance_) return true;
      if (!(norm < last)) return false;
      last = norm;
      simplex.add(evaluate(simplex.nearest() / norm));
    }
    return false;
  }

  void bound(Cell& cell) {
    const Cap cap(cell);
    Vec n;
    const Vec fresh = evaluate(cap.n0);
    cell.bound = std::min(cell.bound, cap.bound(cell.y, n));
    const double of_fresh = cap.bound(fresh, n);
    if (of_fresh < cell.bound) cell.bound = of_fresh, cell.y = fresh;
    Vec y = cap.best_between(cell.y, fresh);
    for (int i = 0; i < kTightenings; ++i) {
      const double of_y = cap.bound(y, n);
      if (of_y < cell.bound) cell.bound = of_y, cell.y = y;
      if (cell.bound <= lo_ + tolerance_) return;
      const Vec z = evaluate(n);
      // n.z = g(n) limits what any point of the difference can still prove over this cap.
      if (of_y - n.dot(z) <= kNear * (of_y - lo_)) return;
      y = cap.best_between(y, z);
    }
  }

  /// Tightens with more memory, for hard pairs. It views the difference from the point -c n0 on the
  /// cap's axis, from which the normal of cap.bound() points at y. Lowering the bound then means
  /// finding the nearest point, by the simplex of separate().
  void tighten(Cell& cell, const Cap& cap) {
    Vec n;
    double of_y = cap.bound(cell.y, n);
    Vec y = cell.y;
    Simplex simplex;
    simplex.add(y, cap.back_from(y));
    for (int i = 0; i < kHardTightenings; ++i) {
      const Vec z = evaluate(n);
      if (of_y - n.dot(z) <= kNear * (of_y - lo_)) return;
      simplex.add(z, cap.back_from(y));
      y = simplex.nearest();
      of_y = cap.bound(y, n);
      if (of_y < cell.bound) cell.bound = of_y, cell.y = y;
      if (cell.bound <= lo_ + tolerance_ || simplex.full()) return;
    }
  }

  void keep_or_prune(const Cell& cell) {
    if (cell.bound > lo_ + tolerance_) {
      cells_.push_back(cell);
      std::push_heap(cells_.begin(), cells_.end());
    } else {
      pruned_ = std::max(pruned_, cell.bound);
    }
  }

  /// Branch and bound over the whole sphere.
  void enclose() {
    const Vec start = evaluate(n_);
    for (int axis = 0; axis < 3; ++axis)
      for (double side : {-1.0, 1.0})
        for (double u : {-0.5, 0.5})
          for (double v : {-0.5, 0.5}) {
            Cell cell{hi_, u, v, 0.5, start, axis, side};
            bound(cell);
            keep_or_prune(cell);
          }
    while (!cells_.empty() && cells_.front().bound > lo_ + tolerance_ &&
           evaluations_ < max_evaluations_) {
      std::pop_heap(cells_.begin(), cells_.end());
      const Cell parent = cells_.back();
      cells_.pop_back();
      const double w = parent.w / 2;
      for (double u : {parent.u - w, parent.u + w})
        for (double v : {parent.v - w, parent.v + w}) {
          Cell cell{parent.bound, u, v, w, parent.y, parent.axis, parent.side};
          bound(cell);
          if (cell.bound > lo_ + tolerance_ && evaluations_ > kHard) tighten(cell, Cap(cell));
          keep_or_prune(cell);
        }
    }
    const double open = cells_.empty() ? pruned_ : cells_.front().bound;
    hi_ = std::min(hi_, std::max(pruned_, open));
  }

  const A& a_;
  const B& b_;
  Vec apart_;
  double tolerance_;
  long max_evaluations_;
  long evaluations_ = 0;
  double lo_ = -std::numeric_limits<double>::infinity();
  double hi_ = std::numeric_limits<double>::infinity();
  double pruned_ = -std::numeric_limits<double>::infinity();
  Vec n_ = Vec::UnitZ();
  std::vector<Cell> cells_;
};

using Core = std::variant<PointCore, TriangleCore, BoxCore, CylinderCore>;

struct Placed {
  Core core;
  Vec center;
  double radius;  // radius of a ball added to the core
};

Placed place(const Sphere& s) {
  return {PointCore{}, s.c, s.r};
}
Placed place(const Triangle& s) {
  return {TriangleCore{{Vec::Zero(), s.v1 - s.v0, s.v2 - s.v0}}, s.v0, 0};
}
Placed place(const Aabb& s) {
  const Vec half = (s.max - s.min) / 2;
  return {BoxCore{{half.x() * Vec::UnitX(), half.y() * Vec::UnitY(), half.z() * Vec::UnitZ()}},
          s.center(), 0};
}
Placed place(const Obb& s) {
  BoxCore core;
  for (int i = 0; i < 3; ++i) core.e[i] = s.half[i] * s.rotation.col(i);
  return {core, s.c, 0};
}
Placed place(const Cylinder& s) {
  const double length = s.axis.norm();
  return {CylinderCore{s.axis / length, s.half_height * length, s.radius}, s.c, 0};
}
Placed place(const Plane&) {
  throw std::invalid_argument("a plane has no core");
}
Placed place(const Shape& shape) {
  return std::visit([](const auto& s) { return place(s); }, shape);
}

/// s = |H| - R, or H - R for a half-space. A plane has a finite support in two directions, and a
/// half-space in one.
SignedDistance plane_distance(const Shape& a, const Plane& b) {
  const double length = b.n.norm();
  const Vec n = b.n / length;
  const Vec c = center(a);
  const double height = (b.n.dot(c) - b.d) / length;
  if (std::holds_alternative<Plane>(a))
    throw std::invalid_argument("two planes have no signed distance");
  const Shape centred = moved(a, -c);
  const double above =
      height - support(centred, -n);  // A is on the side of the normal, so A to B is -n
  const double below = -height - support(centred, n);
  const bool flip = b.half_space || above >= below;
  const double s = flip ? above : below;
  return {s, s, flip ? Vec(-n) : n, true, 2};
}

/// Cylinders with the same axis direction. Their difference is a cylinder with the summed heights
/// and radii, around the offset of the centres.
SignedDistance coaxial_distance(const CylinderCore& a, const CylinderCore& b, const Vec& apart) {
  const double along = a.axis.dot(apart);
  const Vec across = a.axis.cross(apart).cross(a.axis);
  const double off = across.norm();
  const double axial = std::abs(along) - a.half_height - b.half_height;
  const double radial = off - a.radius - b.radius;
  const Vec up = along < 0 ? Vec(-a.axis) : a.axis;
  const Vec out = off > 0 ? Vec(across / off) : a.axis.unitOrthogonal();
  if (axial > 0 && radial > 0) {
    const double s = std::hypot(axial, radial);
    return {s, s, (axial * up + radial * out) / s, true, 1};
  }
  return axial >= radial ? SignedDistance{axial, axial, up, true, 1}
                         : SignedDistance{radial, radial, out, true, 1};
}

SignedDistance core_distance(const Core& a, const Core& b, const Vec& apart, double tolerance,
                             long evaluations) {
  const auto* ca = std::get_if<CylinderCore>(&a);
  const auto* cb = std::get_if<CylinderCore>(&b);
  if (ca && cb && (ca->axis == cb->axis || ca->axis == -cb->axis))
    return coaxial_distance(*ca, *cb, apart);
  return std::visit(
      [&]<class A, class B>(const A& x, const B& y) {
        return Search<A, B>(x, y, apart, tolerance, evaluations).run();
      },
      a, b);
}

}  // namespace

double distance_along(const Shape& a, const Shape& b, const Vec& direction) {
  const Vec n = direction.normalized();
  if (const auto* plane = std::get_if<Plane>(&b)) return -support(*plane, -n) - support(a, n);
  if (const auto* plane = std::get_if<Plane>(&a)) return -support(b, -n) - support(*plane, n);
  const Placed pa = place(a), pb = place(b);
  const Vec ya = std::visit([&](const auto& core) { return core.support(n); }, pa.core);
  const Vec yb = std::visit([&](const auto& core) { return core.support(-n); }, pb.core);
  return n.dot(pb.center - pa.center + yb - ya) - pa.radius - pb.radius;
}

SignedDistance signed_distance(const Shape& a, const Shape& b, const DistanceOptions& options) {
  const double size = scene_size(a, b);
  SignedDistance distance;
  if (const auto* plane = std::get_if<Plane>(&b)) {
    distance = plane_distance(a, *plane);
  } else if (const auto* first = std::get_if<Plane>(&a)) {
    distance = plane_distance(b, *first);
    distance.n = -distance.n;
  } else {
    const Placed pa = place(a), pb = place(b);
    distance = core_distance(pa.core, pb.core, pb.center - pa.center, options.tolerance * size,
                             options.max_evaluations);
    distance.lo -= pa.radius + pb.radius;
    distance.hi -= pa.radius + pb.radius;
  }
  const double slack = std::ldexp(64.0, -53) * size;
  distance.lo -= slack;
  distance.hi += slack;
  return distance;
}

}  // namespace cde::oracle
