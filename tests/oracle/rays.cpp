#include "rays.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "numerics/exact.hpp"

namespace cde::oracle {
namespace {

namespace mp = boost::multiprecision;
using Real = mp::number<mp::cpp_bin_float<512, mp::digit_base_2>, mp::et_off>;
using Real3 = std::array<Real, 3>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

/// A crossing of the line and the surface.
struct Crossing {
  Real t;
  double cosine;  // of the angle between line and normal
};

Vec point_at(const Ray& ray, const Real& t) {
  const Real3 o = real3(ray.o), d = real3(ray.d);
  return {to_double(o[0] + t * d[0]), to_double(o[1] + t * d[1]), to_double(o[2] + t * d[2])};
}

/// How far t is from the end of the interval where it would change sides, as a length.
double from_bounds(const Ray& ray, const Real& t, double length) {
  const auto apart = [&](double bound) {
    return std::isinf(bound) ? kInfinity : std::abs(to_double(t - Real(bound))) * length;
  };
  return std::min(apart(ray.tmin), apart(ray.tmax));
}

bool in_range(const Ray& ray, const Real& t) {
  return t >= Real(ray.tmin) && t <= Real(ray.tmax);
}

/// The answer for the crossings of a line, ascending in t. line_margin: the displacement, as a
/// length, after which the line would meet the target no longer, or meet it after all.
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
  for (const Crossing& c : crossings) {
    const double margin = from_bounds(ray, c.t, length) * c.cosine;
    if (!in_range(ray, c.t)) {
      enters = std::min(enters, margin);
      if (!answer.hit) others = std::min(others, margin);
      continue;
    }
    leaves = std::max(leaves, margin);
    if (answer.hit) continue;
    answer.hit = true;
    others = std::min(others, margin);
    answer.t = to_double(c.t);
    answer.point = point_at(ray, c.t);
    answer.cosine = c.cosine;
  }
  answer.margin = (answer.hit ? std::min(line_margin, leaves) : enters) / scale;
  answer.margin_t = answer.hit ? std::min(answer.margin, others / scale) : answer.margin;
  return answer;
}

/// A convex piece of the line, and the cosine of the surface at either end.
struct Interval {
  bool all = false;    // the whole line
  bool empty = false;  // nothing of it
  Real in = 0, out = 0;
  double cosine_in = 1, cosine_out = 1;
  double margin = kInfinity;  // displacement after which all or empty would no longer hold
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
  const Real apart = abs(dot(f, n)) / sqrt(a);  // between the lines
  found.margin = std::abs(to_double(apart - radius));
  const Real discriminant = b * b - a * c;
  found.empty = discriminant < 0;
  if (found.empty) return found;
  const Real root = sqrt(discriminant);
  found.in = (-b - root) / a;
  found.out = (-b + root) / a;
  // The outward normal is (m + t n) x axis / r, along which d advances by root / (r |axis|).
  found.cosine_in = found.cosine_out = to_double(root / (r * length * norm(d)));
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
  found.cosine_in = found.cosine_out = std::abs(to_double(along / (length * norm(d))));
  return found;
}

/// The common part. Where both begin (or end) together, at a rim, the lesser cosine counts.
Interval intersect(const Interval& a, const Interval& b, double length, double scale) {
  if (a.all) return b;
  if (b.all) return a;
  const auto together = [&](const Real& s, const Real& t) {
    return std::abs(to_double(s - t)) * length < 1e-5 * scale;
  };
  Interval c;
  c.in = a.in > b.in ? a.in : b.in;
  c.out = a.out < b.out ? a.out : b.out;
  c.cosine_in = a.in > b.in ? a.cosine_in : b.cosine_in;
  c.cosine_out = a.out < b.out ? a.cosine_out : b.cosine_out;
  if (together(a.in, b.in)) c.cosine_in = std::min(a.cosine_in, b.cosine_in);
  if (together(a.out, b.out)) c.cosine_out = std::min(a.cosine_out, b.cosine_out);
  return c;
}

/// Distance of the line o + t d from the segment p..q, in extended precision.
double line_to_segment(const Ray& ray, const Vec& p, const Vec& q) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const Long d = ray.d.cast<long double>().normalized();
  // Across the direction the line is a point.
  const auto across = [&](const Vec& x) -> Long {
    const Long f = x.cast<long double>() - ray.o.cast<long double>();
    return f - d * d.dot(f);
  };
  const Long a = across(p), e = across(q) - a;
  const long double length = e.squaredNorm();
  const long double s = length > 0 ? std::clamp<long double>(-a.dot(e) / length, 0.0L, 1.0L) : 0.0L;
  return static_cast<double>((a + s * e).norm());
}

/// How far a ray in or parallel to a triangle's plane, or any ray from a triangle without area, is
/// from meeting it.
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

bool exact_in_float(const Vec& v) {
  return v.cast<float>().cast<double>() == v;
}

}  // namespace

RayAnswer cast(const Ray& ray, const Sphere& sphere) {
  const Real3 d = real3(ray.d), f = real3(ray.o) - real3(sphere.c);
  const Real r(sphere.r), a = dot(d, d), b = dot(f, d), c = dot(f, f) - r * r;
  const Real discriminant = b * b - a * c;
  const double scale = (ray.o - sphere.c).norm() + sphere.r;
  const double line_margin = std::abs(to_double(norm(cross(f, d)) / sqrt(a) - r));
  std::vector<Crossing> crossings;
  if (discriminant >= 0) {
    const Real root = sqrt(discriminant);
    const double cosine = to_double(root / (r * sqrt(a)));
    crossings = {{(-b - root) / a, cosine}, {(-b + root) / a, cosine}};
  }
  return decide(ray, crossings, line_margin, scale);
}

RayAnswer cast(const Ray& ray, const Cylinder& cylinder) {
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
  const Interval both = intersect(lateral, slab, length, scale);
  // Moving either end by e needs a displacement of e cosine.
  const double overlap =
      std::abs(to_double(both.out - both.in)) * length / (1 / both.cosine_in + 1 / both.cosine_out);
  if (both.in > both.out) return decide(ray, {}, overlap, scale);
  return decide(ray, {{both.in, both.cosine_in}, {both.out, both.cosine_out}},
                std::min({overlap, lateral.margin, slab.margin}), scale);
}

RayAnswer cast(const Ray& ray, const Triangle& triangle) {
  const std::array<Vec, 3> v = {triangle.v0, triangle.v1, triangle.v2};
  for (const Vec* w : {&ray.o, &ray.d, &v[0], &v[1], &v[2]})
    if (!exact_in_float(*w)) throw std::invalid_argument("operand is not exact in binary32");
  const auto f3 = [](const Vec& w) { return Eigen::Vector3f(w.cast<float>()); };
  const ExactHit exact(
      cde::Ray{f3(ray.o), f3(ray.d), static_cast<float>(ray.tmin), static_cast<float>(ray.tmax)},
      cde::Triangle{f3(v[0]), f3(v[1]), f3(v[2])});
  double scale = 0;
  for (const Vec& w : v) scale = std::max(scale, (w - ray.o).norm());
  if (scale == 0) scale = 1;  // all in one point: a miss whatever the unit

  const Vec normal = (v[1] - v[0]).cross(v[2] - v[0]);
  const double area = normal.norm();
  if (exact.det == 0) return decide(ray, {}, from_parallel(ray, v, normal), scale);
  const double cosine = std::abs(normal.dot(ray.d)) / (area * ray.d.norm());
  // Barycentric coordinate times height: the distance from an edge, negative outside.
  const double weights[3] = {to_double(ExactHit::Rational(1 - exact.u - exact.v)),
                             to_double(exact.u), to_double(exact.v)};
  double inside = kInfinity;
  for (int k = 0; k < 3; ++k)
    inside = std::min(inside, weights[k] * area / (v[(k + 2) % 3] - v[(k + 1) % 3]).norm());
  if (!exact.inside()) return decide(ray, {}, std::abs(inside) * cosine, scale);
  const Real t = Real(mp::numerator(exact.t)) / Real(mp::denominator(exact.t));
  return decide(ray, {{t, cosine}}, inside * cosine, scale);
}

RayAnswer cast(const Case& ray_case) {
  const Ray ray = ray_case.ray();
  const Shape target = ray_case.shape_b();
  if (const auto* sphere = std::get_if<Sphere>(&target)) return cast(ray, *sphere);
  if (const auto* cylinder = std::get_if<Cylinder>(&target)) return cast(ray, *cylinder);
  if (const auto* triangle = std::get_if<Triangle>(&target)) return cast(ray, *triangle);
  throw std::invalid_argument("not a ray pair");
}

std::string RayVerdict::describe() const {
  std::ostringstream out;
  out.precision(9);
  out << (ok ? "ok" : "wrong") << "; oracle F " << answer.hit << " T " << answer.t << " margin "
      << answer.margin << " of T " << answer.margin_t << " cosine " << answer.cosine << " scale "
      << answer.scale << ", T off by " << error_t << ", CP off by " << error_point;
  return out.str();
}

RayVerdict check(const Ray& ray, const RayAnswer& answer, bool f, double t, const Vec& cp,
                 double band, double tolerance) {
  RayVerdict verdict;
  verdict.answer = answer;
  verdict.in_band = answer.margin <= band;
  if (f != answer.hit) {
    verdict.excused = verdict.in_band;
    verdict.ok = verdict.in_band;
    return verdict;
  }
  if (!f) {
    verdict.ok = t == kInfinity && cp == Vec::Zero();
    return verdict;
  }
  verdict.error_t = std::abs(t - answer.t) * ray.d.norm() * answer.cosine / answer.scale;
  const double world =
      std::max(ray.o.lpNorm<Eigen::Infinity>(), answer.point.lpNorm<Eigen::Infinity>());
  verdict.error_point = (cp - answer.point).norm() / (answer.scale / answer.cosine + world);
  const bool right = verdict.error_t <= tolerance && verdict.error_point <= tolerance;
  verdict.excused = !right && (answer.margin_t <= band || answer.cosine * answer.cosine <= band);
  verdict.ok = right || verdict.excused;
  return verdict;
}

}  // namespace cde::oracle
