// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/rays.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "cde/oracle/exact.hpp"

namespace cde::oracle {
namespace {

namespace mp = boost::multiprecision;
using Real = mp::number<mp::cpp_bin_float<512, mp::digit_base_2>, mp::et_off>;
using Real3 = std::array<Real, 3>;

Real3 real3(const Vec& v) {
  return {Real(v.x()), Real(v.y()), Real(v.z())};
}
Real3 operator-(const Real3& a, const Real3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Real dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real norm(const Real3& a) {
  return sqrt(dot(a, a));
}
double to_double(const Real& x) {
  return x.convert_to<double>();
}

/// A crossing of the line with one surface.
struct Root {
  Real t;
  double cosine;  // of the angle between line and normal
};

/// The line's entry into or exit from the target: its last entry or first exit over all surfaces.
struct Crossing {
  bool entry;
  std::vector<Root> roots;

  [[nodiscard]] const Root& active() const {
    const auto before = [](const Root& a, const Root& b) { return a.t < b.t; };
    return entry ? *std::ranges::max_element(roots, before)
                 : *std::ranges::min_element(roots, before);
  }
  /// The displacement, to first order, that moves the crossing to the other side of the bound. One
  /// root suffices to pass it one way; the other way needs all roots.
  [[nodiscard]] double margin(double bound, double length) const {
    if (std::isinf(bound)) return kInfinity;
    const Real b(bound);
    const bool beyond = entry ? active().t > b : active().t < b;
    double least = kInfinity, most = 0;
    for (const Root& root : roots) {
      const double m = std::abs(to_double(root.t - b)) * length * root.cosine;
      least = std::min(least, m);
      if (entry ? root.t > b : root.t < b) most = std::max(most, m);
    }
    return beyond ? most : least;
  }
};

Vec point_at(const Ray& ray, const Real& t) {
  const Real3 o = real3(ray.o), d = real3(ray.d);
  return {to_double(o[0] + t * d[0]), to_double(o[1] + t * d[1]), to_double(o[2] + t * d[2])};
}

bool in_range(const Ray& ray, const Real& t) {
  return t >= Real(ray.tmin) && t <= Real(ray.tmax);
}

/// The cosine of the active root. At a rim, where another root is within `near`, it is the smaller
/// of the two cosines.
double cosine_of(const Crossing& crossing, double near) {
  double cosine = 1;
  for (const Root& root : crossing.roots)
    if (std::abs(to_double(root.t - crossing.active().t)) <= near)
      cosine = std::min(cosine, root.cosine);
  return cosine;
}

/// The answer for the crossings of a line, ascending in t. line_margin is the displacement, as a
/// length, that makes the line start or stop hitting the target.
RayAnswer decide(const Ray& ray, const std::vector<Crossing>& crossings, double line_margin,
                 double scale) {
  RayAnswer answer;
  answer.t = kInfinity;
  answer.scale = scale;
  const double length = ray.d.norm();
  if (crossings.empty() || ray.tmin > ray.tmax) {
    answer.margin = answer.margin_t = crossings.empty() ? line_margin / scale : kInfinity;
    return answer;
  }
  double enters = kInfinity, leaves = 0, others = kInfinity;
  for (const Crossing& crossing : crossings) {
    const Real& t = crossing.active().t;
    const double from_tmin = crossing.margin(ray.tmin, length);
    const double from_tmax = crossing.margin(ray.tmax, length);
    if (!in_range(ray, t)) {
      enters = std::min(enters, t < Real(ray.tmin) ? from_tmin : from_tmax);
      if (!answer.hit) others = std::min(others, from_tmin);
      continue;
    }
    const double margin = std::min(from_tmin, from_tmax);
    leaves = std::max(leaves, margin);
    if (answer.hit) continue;
    answer.hit = true;
    others = std::min(others, margin);
    answer.t = to_double(t);
    answer.point = point_at(ray, t);
    answer.cosine = cosine_of(crossing, 1e-5 * scale / length);
  }
  answer.margin = (answer.hit ? std::min(line_margin, leaves) : enters) / scale;
  answer.margin_t = answer.hit ? std::min(answer.margin, others / scale) : answer.margin;
  return answer;
}

/// The part of the line that lies inside one surface of a solid.
struct Interval {
  bool all = false;    // the whole line
  bool empty = false;  // no part of it
  Real in = 0, out = 0;
  double cosine = 1;          // of the angle between line and normal, at both ends
  double margin = kInfinity;  // displacement that changes `all` or `empty`
};

Interval lateral_interval(const Real3& d, const Real3& f, const Real3& axis, const Real& radius) {
  const Real length = norm(axis), r = radius * length;
  const Real3 n = cross(d, axis), m = cross(f, axis);
  const Real a = dot(n, n), b = dot(m, n), c = dot(m, m) - r * r;
  Interval found;
  if (a == 0) {
    found.margin = std::abs(to_double((norm(m) - r) / length));
    found.all = c <= 0;
    found.empty = !found.all;
    return found;
  }
  const Real apart = abs(dot(f, n)) / sqrt(a);  // distance between the lines
  found.margin = std::abs(to_double(apart - radius));
  const Real discriminant = b * b - a * c;
  found.empty = discriminant < 0;
  if (found.empty) return found;
  const Real root = sqrt(discriminant);
  found.in = (-b - root) / a;
  found.out = (-b + root) / a;
  // The outward normal is (m + t n) x axis / r. Along it, d advances by root / (r |axis|).
  found.cosine = to_double(root / (r * length * norm(d)));
  return found;
}

Interval slab_interval(const Real3& d, const Real3& f, const Real3& axis, const Real& half) {
  const Real length = norm(axis), h = half * dot(axis, axis);
  const Real along = dot(d, axis), at = dot(f, axis);
  Interval found;
  if (along == 0) {
    found.margin = std::abs(to_double((abs(at) - h) / length));
    found.all = abs(at) <= h;
    found.empty = !found.all;
    return found;
  }
  const Real t0 = (-h - at) / along, t1 = (h - at) / along;
  found.in = t0 < t1 ? t0 : t1;
  found.out = t0 < t1 ? t1 : t0;
  found.cosine = std::abs(to_double(along / (length * norm(d))));
  return found;
}

/// The displacement that ends or begins the overlap of the line with all surfaces at once. Moving
/// an end by e takes e times its cosine.
double overlap_margin(const Crossing& in, const Crossing& out, double length) {
  const bool apart = in.active().t > out.active().t;
  double least = kInfinity, most = 0;
  for (const Root& i : in.roots)
    for (const Root& o : out.roots) {
      const double m = std::abs(to_double(o.t - i.t)) * length / (1 / i.cosine + 1 / o.cosine);
      least = std::min(least, m);
      if (i.t > o.t) most = std::max(most, m);
    }
  return apart ? most : least;
}

/// Distance of the line o + t d from the segment p..q, in extended precision.
double line_to_segment(const Ray& ray, const Vec& p, const Vec& q) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const Long d = ray.d.cast<long double>().normalized();
  // In the projection along d the line is a point.
  const auto across = [&](const Vec& x) -> Long {
    const Long f = x.cast<long double>() - ray.o.cast<long double>();
    return f - d * d.dot(f);
  };
  const Long a = across(p), e = across(q) - a;
  const long double length = e.squaredNorm();
  const long double s = length > 0 ? std::clamp<long double>(-a.dot(e) / length, 0.0L, 1.0L) : 0.0L;
  return static_cast<double>((a + s * e).norm());
}

/// The distance by which a ray misses a triangle, for a ray parallel to its plane or a triangle
/// without area.
double from_parallel(const Ray& ray, const std::array<Vec, 3>& v, const Vec& normal) {
  const double area = normal.norm();
  const double off_plane = area > 0 ? std::abs(normal.dot(v[0] - ray.o)) / area : 0;
  if (off_plane > 0) return off_plane;
  return std::min({line_to_segment(ray, v[0], v[1]), line_to_segment(ray, v[1], v[2]),
                   line_to_segment(ray, v[2], v[0])});
}

double to_double(const ExactHit::Rational& x) {
  return x.convert_to<double>();
}

/// The answer for a ray that is not parallel to the triangle.
RayAnswer decide(const Ray& ray, const ExactHit& exact, const std::array<Vec, 3>& v,
                 const Vec& normal, double scale) {
  const double area = normal.norm();
  const double cosine = std::abs(normal.dot(ray.d)) / (area * ray.d.norm());
  // A barycentric coordinate times the height is the distance from an edge, negative outside.
  const double weights[3] = {to_double(ExactHit::Rational(1 - exact.u - exact.v)),
                             to_double(exact.u), to_double(exact.v)};
  double inside = kInfinity;
  for (int k = 0; k < 3; ++k)
    inside = std::min(inside, weights[k] * area / (v[(k + 2) % 3] - v[(k + 1) % 3]).norm());
  if (!exact.inside()) return decide(ray, {}, std::abs(inside) * cosine, scale);
  const Real t = Real(mp::numerator(exact.t)) / Real(mp::denominator(exact.t));
  return decide(ray, {{true, {{t, cosine}}}}, inside * cosine, scale);
}

void require_direction(const Ray& ray) {
  if (ray.d.isZero(0)) throw std::invalid_argument("the direction is zero");
}

}  // namespace

RayAnswer cast(const Ray& ray, const Sphere& sphere) {
  require_direction(ray);
  const Real3 d = real3(ray.d), f = real3(ray.o) - real3(sphere.c);
  const Real r(sphere.r), a = dot(d, d), b = dot(f, d), c = dot(f, f) - r * r;
  const Real discriminant = b * b - a * c;
  const double scale = (ray.o - sphere.c).norm() + sphere.r;
  const double line_margin = std::abs(to_double(norm(cross(f, d)) / sqrt(a) - r));
  std::vector<Crossing> crossings;
  if (discriminant >= 0) {
    const Real root = sqrt(discriminant);
    const double cosine = to_double(root / (r * sqrt(a)));
    crossings = {{true, {{(-b - root) / a, cosine}}}, {false, {{(-b + root) / a, cosine}}}};
  }
  return decide(ray, crossings, line_margin, scale);
}

RayAnswer cast(const Ray& ray, const Cylinder& cylinder) {
  require_direction(ray);
  const Real3 d = real3(ray.d), f = real3(ray.o) - real3(cylinder.c), axis = real3(cylinder.axis);
  const double length = ray.d.norm();
  const double scale = (ray.o - cylinder.c).norm() + cylinder.radius + cylinder.half_height;
  const Interval lateral = lateral_interval(d, f, axis, Real(cylinder.radius));
  const Interval slab = slab_interval(d, f, axis, Real(cylinder.half_height));
  if (lateral.empty || slab.empty) {
    const double margin =
        std::max(lateral.empty ? lateral.margin : 0.0, slab.empty ? slab.margin : 0.0);
    return decide(ray, {}, margin, scale);
  }
  Crossing in{true, {}}, out{false, {}};
  for (const Interval* interval : {&lateral, &slab}) {
    if (interval->all) continue;
    in.roots.push_back({interval->in, interval->cosine});
    out.roots.push_back({interval->out, interval->cosine});
  }
  const double overlap = overlap_margin(in, out, length);
  if (in.active().t > out.active().t) return decide(ray, {}, overlap, scale);
  return decide(ray, {in, out}, std::min({overlap, lateral.margin, slab.margin}), scale);
}

RayAnswer cast(const Ray& ray, const Triangle& triangle) {
  require_direction(ray);
  const std::array<Vec, 3> v = {triangle.v0, triangle.v1, triangle.v2};
  const ExactHit exact(cde::BasicRay<double>{ray.o, ray.d, ray.tmin, ray.tmax},
                       cde::BasicTriangle<double>{v[0], v[1], v[2]});
  double scale = 0;
  for (const Vec& w : v) scale = std::max(scale, (w - ray.o).norm());
  if (scale == 0) scale = 1;  // all points coincide: a miss in any unit

  const Vec normal = (v[1] - v[0]).cross(v[2] - v[0]);
  RayAnswer answer = exact.det == 0 ? decide(ray, {}, from_parallel(ray, v, normal), scale)
                                    : decide(ray, exact, v, normal, scale);
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (v[(k + 1) % 3] - v[k]).norm());
  const double area = normal.norm();
  answer.aspect = area > 0 ? longest * longest / area : kInfinity;
  return answer;
}

RayAnswer cast(const Case& ray_case) {
  const Ray ray = ray_case.ray();
  const Shape target = ray_case.shape_b();
  if (const auto* sphere = std::get_if<Sphere>(&target)) return cast(ray, *sphere);
  if (const auto* cylinder = std::get_if<Cylinder>(&target)) return cast(ray, *cylinder);
  if (const auto* triangle = std::get_if<Triangle>(&target)) return cast(ray, *triangle);
  throw std::invalid_argument("not a ray pair");
}

std::string RayDecision::describe() const {
  std::ostringstream out;
  out.precision(9);
  out << (ok ? "ok" : "wrong") << "; oracle F " << answer.hit << " T " << answer.t << " margin "
      << answer.margin << " of T " << answer.margin_t << " cosine " << answer.cosine << " scale "
      << answer.scale << ", T off by " << error_t << ", CP off by " << error_point;
  return out.str();
}

RayDecision check(const Ray& ray, const RayAnswer& answer, bool f, double t, const Vec& cp,
                  double band, double tolerance) {
  RayDecision decision;
  decision.answer = answer;
  decision.in_band = answer.margin <= band;
  if (f != answer.hit) {
    decision.excused = decision.in_band;
    decision.ok = decision.in_band;
    return decision;
  }
  if (!f) {
    decision.ok = t == kInfinity && cp == Vec::Zero();
    return decision;
  }
  decision.error_t = std::abs(t - answer.t) * ray.d.norm() * answer.cosine / answer.scale;
  const double world =
      std::max(ray.o.lpNorm<Eigen::Infinity>(), answer.point.lpNorm<Eigen::Infinity>());
  decision.error_point = (cp - answer.point).norm() / (answer.scale / answer.cosine + world);
  const bool right = decision.error_t <= tolerance && decision.error_point <= tolerance;
  decision.excused = !right && (answer.margin_t <= band || answer.cosine * answer.cosine <= band);
  decision.ok = right || decision.excused;
  return decision;
}

}  // namespace cde::oracle
