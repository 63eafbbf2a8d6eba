// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/rays.hpp"

// Makes operands of the three ray pairs. Builds and rounds the target first, then aims the ray by
// the family's rule.
namespace cde::oracle {
namespace {

// Each draw is a statement or an element in braces; otherwise the compiler would choose their
// order.
struct RayDraft {
  Random random;
  Format format;
  ShapeKind kind;
  Frame frame;
  Build build;
  Shape target;
  Ray ray;

  void make_target() { target = rounded(kind, build_shape(random, kind, frame, build), format); }

  /// A point of the triangle, or inside the solid.
  Vec inner_point() {
    if (const auto* s = std::get_if<Triangle>(&target)) {
      const double u = random.unit(), v = random.unit() * (1 - u);
      return (1 - u - v) * s->v0 + u * s->v1 + v * s->v2;
    }
    const double depth = random.unit();
    const Vec n = random.direction();
    if (const auto* s = std::get_if<Sphere>(&target)) return s->c + depth * s->r * n;
    const auto& s = std::get<Cylinder>(target);
    const double z = random.uniform(-1, 1) * s.half_height;
    return s.c + z * s.axis + depth * s.radius * n.cross(s.axis).normalized();
  }
  /// A point on the silhouette as seen from `eye`, on an edge or a rim, and the direction that
  /// leads past the target.
  void rim_point(const Vec& eye, Vec& point, Vec& out);

  Vec eye() {
    const double away = build.scale * random.uniform(2, 8);
    return center(target) + away * random.direction();
  }
  void aim(const Vec& from, const Vec& at) { ray = {from, at - from, 0, kInfinity}; }
  [[nodiscard]] Case made(Pair pair, std::uint64_t seed, std::uint64_t index,
                          const char* family) const {
    return {pair, seed, index, family, to_words(ray, format), to_words(target, format)};
  }
  /// The exact answer for the final words.
  [[nodiscard]] RayAnswer answer() const {
    const Ray words = ray_from_words(to_words(ray, format));
    if (const auto* s = std::get_if<Sphere>(&target)) return cast(words, *s);
    if (const auto* s = std::get_if<Cylinder>(&target)) return cast(words, *s);
    return cast(words, std::get<Triangle>(target));
  }
};

void RayDraft::rim_point(const Vec& eye, Vec& point, Vec& out) {
  if (const auto* s = std::get_if<Triangle>(&target)) {
    const std::array<Vec, 3> v = {s->v0, s->v1, s->v2};
    const int k = random.below(3);
    const Vec edge = v[(k + 1) % 3] - v[k];
    point = v[k] + (random.chance(0.2) ? 0.0 : random.unit()) * edge;
    out = edge.cross((v[1] - v[0]).cross(v[2] - v[0])).normalized();
    if (!out.allFinite()) out = random.direction();
  } else if (const auto* sphere = std::get_if<Sphere>(&target)) {
    const Vec back = eye - sphere->c;
    const double cosine = sphere->r / back.norm();
    const Vec side = back.cross(random.direction()).normalized();
    out = cosine * back.normalized() + std::sqrt(1 - cosine * cosine) * side;
    point = sphere->c + sphere->r * out;
  } else {
    const auto& cylinder = std::get<Cylinder>(target);
    const Vec across = cylinder.axis.cross(eye - cylinder.c).cross(cylinder.axis);
    const double away = across.norm();
    if (random.chance(0.5) && away > cylinder.radius) {  // along the side
      const double cosine = cylinder.radius / away;
      const Vec side = cylinder.axis.cross(across) / away;
      const double turn = random.either_sign(std::sqrt(1 - cosine * cosine));
      out = cosine * across / away + turn * side;
      const double z = random.uniform(-1, 1) * cylinder.half_height;
      point = cylinder.c + z * cylinder.axis + cylinder.radius * out;
    } else {
      // A rim lies on the silhouette where the eye sees just one of cap and side.
      for (int attempt = 0; attempt < 32; ++attempt) {
        const Vec radial = cylinder.axis.cross(random.direction()).normalized();
        const double cap = random.either_sign(cylinder.half_height);
        point = cylinder.c + cap * cylinder.axis + cylinder.radius * radial;
        const Vec back = eye - point;
        if ((cap * back.dot(cylinder.axis) > 0) != (back.dot(radial) > 0)) break;
      }
      out = random.direction();
    }
  }
}

const char* past_the_edge(RayDraft& d) {
  d.make_target();
  const Vec from = d.eye();
  Vec point, out;
  d.rim_point(from, point, out);
  const double by = small_offset(d.random, d.format) * (from - point).norm();
  d.aim(from, point + by * out);
  return "past the edge";
}

const char* aimed(RayDraft& d) {
  d.make_target();
  const Vec from = d.eye();
  d.aim(from, d.inner_point());
  return "aimed";
}

const char* anywhere(RayDraft& d) {
  d.make_target();
  const Vec from = d.eye();
  const double away = d.random.uniform(0, 2);
  d.aim(from, center(d.target) + away * d.random.direction());
  return "anywhere";
}

const char* from_inside(RayDraft& d) {
  d.make_target();
  const Vec from = d.inner_point();
  d.aim(from, from + d.random.direction());
  return "from inside";
}

/// T at an end of the interval or one ulp to either side, for either crossing.
const char* at_bounds(RayDraft& d) {
  aimed(d);
  if (d.random.chance(0.4) && d.kind != ShapeKind::kTriangle) {
    const RayAnswer first = d.answer();
    if (first.hit) d.ray.tmin = d.format.next(d.format.round(first.t), kInfinity);
  }
  const RayAnswer answer = d.answer();
  if (!answer.hit) return "at bounds";
  double t = d.format.round(answer.t);
  const int step = d.random.below(3);
  if (step == 1) t = d.format.next(t, kInfinity);
  if (step == 2) t = d.format.next(t, -kInfinity);
  (d.random.chance(0.5) ? d.ray.tmin : d.ray.tmax) = t;
  return "at bounds";
}

const char* intervals(RayDraft& d) {
  aimed(d);
  switch (d.random.below(5)) {
    case 0:
      d.ray.tmin = 2, d.ray.tmax = 0.5;
      break;  // empty interval
    case 1:
      d.ray.tmin = -kInfinity;
      break;
    case 2:
      d.ray.tmin = -100, d.ray.d = -d.ray.d;
      break;  // interval behind the origin
    case 3:
      d.ray.tmax = d.random.uniform(0, 2);
      break;
    default:
      d.ray.tmin = kInfinity;
      break;
  }
  return "intervals";
}

/// A direction along one or two axes, with zeros of either sign.
const char* along_axes(RayDraft& d) {
  if (d.random.chance(0.5)) d.frame = d.random.quarter_turns();
  d.build.dyadic = d.random.chance(0.5);
  d.make_target();
  Vec direction = Vec::Zero();
  const int axis = d.random.below(3);
  direction[axis] = d.random.sign();
  if (d.random.chance(0.3)) direction[(axis + 1) % 3] = d.random.sign();
  for (int k = 0; k < 3; ++k)
    if (direction[k] == 0) direction[k] = std::copysign(0.0, d.random.sign());
  const Vec middle = center(d.target);
  Vec from = middle + 1.4 * (d.inner_point() - middle) - 4 * direction;
  if (d.build.dyadic) from = (16 * from).array().round().matrix() / 16;
  d.ray = {from, direction, 0, kInfinity};
  return "along axes";
}

/// Along a cylinder's axis, through a sphere's centre, or in a triangle's plane.
const char* degenerate_view(RayDraft& d) {
  if (d.random.chance(0.5)) d.frame = d.random.quarter_turns();
  d.build.dyadic = true;
  d.make_target();
  const double away = d.random.uniform(1, 6);
  if (const auto* s = std::get_if<Cylinder>(&d.target)) {
    const Vec direction = d.random.flipped(s->axis);
    const Vec aside =
        d.random.uniform(0, 1.3) * s->radius * s->axis.cross(d.random.direction()).normalized();
    d.ray = {s->c - away * direction, direction, 0, kInfinity};
    if (d.random.chance(0.7)) d.ray.o += aside;
  } else if (const auto* t = std::get_if<Triangle>(&d.target)) {
    const double u = d.random.uniform(-1, 1), v = d.random.uniform(-1, 1);
    const Vec direction = u * (t->v1 - t->v0) + v * (t->v2 - t->v0);
    const double in = d.random.unit();
    d.ray = {t->v0 + in * (t->v2 - t->v0) - away * direction, direction, 0, kInfinity};
  } else {
    const Vec direction = d.random.direction();
    d.ray = {center(d.target) - away * direction, direction, 0, kInfinity};
  }
  return "degenerate view";
}

/// Exactly tangent, through a vertex or the middle of an edge, or along a cylinder's side.
const char* tangent(RayDraft& d) {
  d.frame = d.random.quarter_turns();
  d.build.dyadic = true;
  d.make_target();
  const Vec n = d.frame.col(2);
  if (const auto* t = std::get_if<Triangle>(&d.target)) {
    const Vec at = d.random.chance(0.5) ? t->v0 : Vec((t->v1 + t->v2) / 2);
    const Vec aside{d.random.below(9) / 16., d.random.below(9) / 16., d.random.below(9) / 16.};
    const Vec direction = 2 * d.random.flipped(n) + aside;
    d.ray = {at - 2 * direction, direction, 0, kInfinity};
    return "tangent";
  }
  const Vec side = d.frame.col(0);
  const bool along = d.random.chance(0.5);
  const double reach = d.kind == ShapeKind::kSphere ? std::get<Sphere>(d.target).r
                                                    : std::get<Cylinder>(d.target).radius;
  const Vec direction = along ? n : d.frame.col(1);
  d.ray = {center(d.target) + reach * side - 4 * direction, direction, 0, kInfinity};
  return "tangent";
}

/// From up to 1e4 sizes away, at the target or past its edge.
const char* far_away(RayDraft& d) {
  d.make_target();
  const double away = d.random.decades(10, 1e4);
  const Vec from = center(d.target) + away * d.random.direction();
  Vec at = d.inner_point();
  if (d.random.chance(0.5)) {
    Vec out;
    d.rim_point(from, at, out);
    at += d.random.either_sign(d.random.decades(1e-4, 0.1)) * out;
  }
  d.aim(from, at);
  return "far away";
}

const char* any_length(RayDraft& d) {
  d.random.chance(0.5) ? aimed(d) : past_the_edge(d);
  d.ray.d *= d.random.decades(1e-3, 1e3);
  return "any length";
}

const char* offset(RayDraft& d) {
  d.random.chance(0.5) ? aimed(d) : anywhere(d);
  static constexpr std::array kOffsets = {10.0, 1e3, 1e5};
  const double far = std::min(kOffsets[d.random.below(3)], farthest(d.format));
  Vec by = far * Vec::Ones();
  by = by.cwiseProduct(d.random.direction());
  if (d.random.chance(0.2) && farthest(d.format) >= 1e5)
    by = Vec(148376, 1234, -223423);  // an offset at which Embree once was not watertight
  d.target = rounded(d.kind, moved(d.target, by), d.format);
  d.ray.o += by;
  return "offset";
}

/// Needles and plates; for a triangle also no area.
const char* thin(RayDraft& d) {
  d.build.thin = d.random.decades(1e-5, 1e-2);
  d.build.plate = d.random.chance(0.5);
  d.build.no_area = d.random.chance(0.4);
  d.random.chance(0.5) ? aimed(d) : past_the_edge(d);
  return "thin";
}

// ---- Hard cases ----

/// Almost along the surface. In a triangle's plane except for an angle of 1e-6 to 1e-1, or into a
/// solid by that fraction of its size past the silhouette.
const char* grazing(RayDraft& d) {
  d.make_target();
  const double slight = d.random.decades(1e-6, 1e-1);
  if (const auto* t = std::get_if<Triangle>(&d.target)) {
    const Vec normal = (t->v1 - t->v0).cross(t->v2 - t->v0).normalized();
    const Vec along = normal.cross(d.random.direction()).normalized();
    const double away = d.random.uniform(1, 6);
    const Vec at = d.inner_point();
    d.aim(at - away * (along + d.random.either_sign(slight) * normal), at);
    return "grazing";
  }
  const Vec from = d.eye();
  Vec point, out;
  d.rim_point(from, point, out);
  d.aim(from, point - slight * out);
  return "grazing";
}

const char* sliver(RayDraft& d) {
  d.build.thin = d.random.decades(1e-6, 1e-2);
  d.build.plate = d.random.chance(0.5);
  aimed(d);
  return "sliver";
}

const char* huge_and_tiny(RayDraft& d) {
  d.build.scale = std::ldexp(1, d.random.chance(0.5) ? 20 : -20);
  d.make_target();
  const double away = std::max(1.0, d.build.scale) * d.random.uniform(2, 8);
  const Vec from = center(d.target) + away * d.random.direction();
  d.aim(from, d.inner_point());
  return "huge and tiny";
}

const char* far_off(RayDraft& d, double distance, const char* family) {
  d.random.chance(0.5) ? aimed(d) : anywhere(d);
  const Vec by = distance * d.random.direction();
  d.target = rounded(d.kind, moved(d.target, by), d.format);
  d.ray.o += by;
  return family;
}
const char* far_1e3(RayDraft& d) {
  return far_off(d, 1e3, "far 1e3");
}
const char* far_1e5(RayDraft& d) {
  return far_off(d, 1e5, "far 1e5");
}
const char* far_1e7(RayDraft& d) {
  return far_off(d, 1e7, "far 1e7");
}

RayDraft blank(Pair pair, std::uint64_t seed, std::uint64_t stream, std::uint64_t index,
               const Format& format) {
  RayDraft d{Random(seed, stream + static_cast<std::uint64_t>(pair), index),
             format,
             secondary(pair),
             {},
             {},
             {},
             {}};
  d.frame = d.random.rotation();
  return d;
}

Case made_whole(RayDraft& d, Pair pair, std::uint64_t seed, std::uint64_t index,
                const char* family) {
  // Rounding may have merged the two points, which leaves no direction.
  if (d.made(pair, seed, index, family).ray().d.isZero(0)) d.ray.d = Vec::UnitX();
  return d.made(pair, seed, index, family);
}

}  // namespace

Case detail::hard_ray_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                           const Format& format) {
  static constexpr std::array kFamilies = {grazing, sliver,  huge_and_tiny,
                                           far_1e3, far_1e5, far_1e7};
  static_assert(kFamilies.size() == kHardRayFamilies);
  RayDraft d = blank(pair, seed, 1000, index, format);
  const char* family = kFamilies[index % kFamilies.size()](d);
  return made_whole(d, pair, seed, index, family);
}

Case detail::ray_case(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  static constexpr std::array kFamilies = {aimed,     anywhere,   from_inside,     at_bounds,
                                           intervals, along_axes, degenerate_view, tangent,
                                           far_away,  any_length, offset,          thin};
  static_assert(kFamilies.size() == kRayFamilies);
  RayDraft d = blank(pair, seed, 0, index, format);
  const char* family =
      index % 2 == 0 ? past_the_edge(d) : kFamilies[index / 2 % kFamilies.size()](d);
  return made_whole(d, pair, seed, index, family);
}

}  // namespace cde::oracle
