// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/scene.hpp"

// Makes operands as people write them: whole numbers, equal coordinates, stacked things. Rare
// events among random numbers, mostly ties, are the rule here.
namespace cde::oracle {
namespace {

/// The shape, turned about its own middle.
Shape tilted(const Shape& shape, const Frame& by) {
  if (std::holds_alternative<Aabb>(shape)) return shape;
  const Vec c = center(shape);
  return moved(turned(moved(shape, -c), by), c);
}

/// A pair under construction. Each draw is a statement or an element in braces; otherwise the
/// compiler would choose their order.
struct Pieces : Lengths {
  Format format;
  ShapeKind kind_a, kind_b;
  Shape a, b;
  Ray ray;

  Shape axis_parallel(ShapeKind kind) {
    return with_kind(kind, [&]<class S>() -> Shape { return S::whole(*this); });
  }

  /// The middle and half size of the shape's extent along the axes.
  static Vec middle(const Shape& s) {
    Vec m;
    for (int k = 0; k < 3; ++k) m[k] = (support(s, Vec::Unit(k)) - support(s, -Vec::Unit(k))) / 2;
    return m;
  }
  static Vec half_width(const Shape& s) {
    Vec h;
    for (int k = 0; k < 3; ++k) h[k] = (support(s, Vec::Unit(k)) + support(s, -Vec::Unit(k))) / 2;
    return h;
  }

  /// Places both shapes. A's middle is at or near the origin. B's middle is at most `apart` times
  /// the sum of the half widths away. Coordinates are equal with probability `equal`.
  void place(double apart, double equal) {
    whole = random.chance(0.6);
    a = axis_parallel(kind_a);
    b = axis_parallel(kind_b);
    if (auto* plane = std::get_if<Plane>(&b)) {
      plane->d = coordinate(2 * apart * half_width(a).dot(plane->n.cwiseAbs()));
      if (random.chance(equal / 3)) plane->d = 0;
      return;
    }
    if (!whole || random.chance(0.8)) a = moved(a, -middle(a));
    const double spread = with_kind(kind_b, []<class S>() { return S::kSpread; });
    const Vec reach = spread * apart * (half_width(a) + half_width(b));
    Vec to;
    for (int k = 0; k < 3; ++k) to[k] = coordinate(reach[k]);
    const int free = random.below(3);
    for (int k = 0; k < 3; ++k)
      if (k != free && random.chance(equal)) to[k] = 0;
    b = moved(b, middle(a) + to - middle(b));
  }

  /// Sometimes turns or moves both shapes, and sometimes tilts one slightly.
  void disturb() {
    const double angle = random.decades(1e-7, 1e-2);
    const Vec axis = random.chance(0.5) ? Vec(Vec::Unit(random.below(3))) : random.direction();
    const Frame hair = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const bool tilts = random.chance(0.25), turns = random.chance(0.4), moves = random.chance(0.3);
    const Frame any = random.chance(0.5) ? random.rotation() : turn_of_15_degrees(random);
    const Vec by{random.below(41) - 20., random.below(41) - 20., random.below(41) - 20.};
    if (tilts) a = tilted(a, hair);
    if (turns && kind_b != ShapeKind::kAabb) {
      a = turned(a, any);
      b = turned(b, any);
    }
    if (moves) a = moved(a, by), b = moved(b, by);
  }

  /// Multiplies all lengths by a power of two, exactly, while the squares fit the format.
  void scale(int exponent) {
    const double by = std::ldexp(1, exponent);
    a = scaled(rounded(kind_a, a, format), by);
    b = scaled(rounded(kind_b, b, format), by);
  }
  int any_exponent() {
    const int most = std::max(0, -format.emin() / 6 - 1);
    return random.below(2 * most + 1) - most;
  }
};

const char* aligned(Pieces& p) {
  p.place(1.15, 0);
  p.disturb();
  return "aligned";
}

const char* tied(Pieces& p) {
  p.place(1.7, 0.75);
  p.disturb();
  return "tied";
}

/// Face to face, with a signed distance of zero, a small value, or half a unit, of either sign.
const char* stacked(Pieces& p) {
  p.place(0.9, 0.5);
  const Vec n = p.random.flipped(Vec::Unit(p.random.below(3)));
  const std::array distances = {0.0, 0.0, -0.5, 0.5, 16 * p.format.u(), -16 * p.format.u()};
  const double distance = distances[p.random.below(static_cast<int>(distances.size()))];
  if (auto* plane = std::get_if<Plane>(&p.b))
    plane->d = plane->n.dot(center(p.a)) +
               p.random.either_sign(half_width_along(p.a, plane->n) + distance);
  else
    p.b = moved(p.b, (distance + support(p.a, n) + support(p.b, -n)) * n);
  p.disturb();
  return "stacked";
}

/// A triangle without area or thinner than its rounding error; a box or disc that is a plate.
const char* flat(Pieces& p) {
  p.place(1.15, 0.3);
  const double thin = std::ldexp(1, -4 - p.random.below(std::max(1, p.format.man_bits - 8)));
  const auto flatten = [&](Shape& shape) {
    std::visit(
        [&](auto& s) {
          if constexpr (requires { s.flatten(p.random, thin, p.format.u()); })
            s.flatten(p.random, thin, p.format.u());
        },
        shape);
  };
  flatten(p.a);
  if (p.kind_a != ShapeKind::kTriangle || p.random.chance(0.2)) flatten(p.b);
  p.disturb();
  return "flat";
}

const char* from_a_scene(Pieces& p) {
  const Scene scene = make_scene(p.random, {p.kind_a, p.kind_b});
  const auto [a, b] = neighbours(p.random, scene, p.kind_a, p.kind_b);
  p.a = a, p.b = b;
  return "scene";
}

const char* scaled(Pieces& p) {
  using Family = const char* (*)(Pieces&);
  static constexpr std::array<Family, 4> kFamilies = {aligned, tied, stacked, from_a_scene};
  kFamilies[p.random.below(4)](p);
  p.scale(p.any_exponent());
  return "scaled";
}

// ---- Rays ----

/// A special point of the target: a vertex, an edge's middle, a rim, a pole or the centre.
Vec landmark(Random& random, const Shape& target) {
  if (const auto* t = std::get_if<Triangle>(&target)) {
    const std::array<Vec, 3> v = {t->v0, t->v1, t->v2};
    const int k = random.below(3);
    return random.chance(0.5) ? v[k] : Vec((v[k] + v[(k + 1) % 3]) / 2);
  }
  const Vec c = center(target);
  if (random.chance(0.4)) return c;
  const Vec n = random.flipped(Vec::Unit(random.below(3)));
  return c + support(moved(target, -c), n) * n;
}

/// A ray through whole points: along an axis, along a diagonal, or to a landmark. Rays hit solids
/// more often than triangles, so they aim at solids less often.
void ray_through(Pieces& p, double at_it) {
  const double share = p.kind_b == ShapeKind::kTriangle ? at_it : 0.6 * at_it;
  const Vec at = p.random.chance(share) ? landmark(p.random, p.b) : Vec(center(p.b) + p.point(6));
  Vec direction = p.random.flipped(Vec::Unit(p.random.below(3)));
  if (p.random.chance(0.4)) {
    const Vec diagonal{p.random.below(5) - 2., p.random.below(5) - 2., p.random.below(5) - 2.};
    if (!diagonal.isZero(0)) direction = diagonal;
  }
  const double back = 1 + p.random.below(16);
  p.ray = {at - back * direction, direction, 0, kInfinity};
  if (p.random.chance(0.2)) p.ray.tmax = back;  // ends at the target
}

void disturb_ray(Pieces& p) {
  if (!p.random.chance(0.4)) return;
  const Frame any = p.random.chance(0.5) ? p.random.rotation() : turn_of_15_degrees(p.random);
  p.b = rounded(p.kind_b, turned(p.b, any), p.format);
  p.ray.o = any * p.ray.o, p.ray.d = any * p.ray.d;
}

void whole_target(Pieces& p) {
  p.whole = p.random.chance(0.7);
  const Shape target = p.axis_parallel(p.kind_b);
  p.b = moved(target, p.point(4));
}

const char* ray_aligned(Pieces& p) {
  whole_target(p);
  ray_through(p, 0.3);
  disturb_ray(p);
  return "aligned";
}

const char* ray_tied(Pieces& p) {
  whole_target(p);
  ray_through(p, 0.9);
  disturb_ray(p);
  return "tied";
}

/// A ray in the plane of the triangle, at a triangle without area, or along a face or side of a
/// solid.
const char* ray_flat(Pieces& p) {
  whole_target(p);
  if (auto* t = std::get_if<Triangle>(&p.b)) {
    const int step = p.random.below(3);
    if (step == 0) t->v2 = t->v0 + (p.random.below(9) / 4. - 0.5) * (t->v1 - t->v0);
    if (step == 0 && p.random.chance(0.2)) t->v1 = t->v2 = t->v0;
    const int u = p.random.below(9) - 4, v = p.random.below(9) - 4;
    const Vec inside = t->v0 + (t->v1 - t->v0) / 4 + (t->v2 - t->v0) / 4;
    Vec direction = u * (t->v1 - t->v0) + v * (t->v2 - t->v0);
    if (step == 0 || direction.isZero(0)) direction = p.point(6) + Vec(0.5, 0, 0);
    p.ray = {inside - 2 * direction, direction, 0, kInfinity};
    disturb_ray(p);
    return "flat";
  }
  const Vec c = center(p.b), n = p.random.flipped(Vec::Unit(p.random.below(3)));
  const Vec along = n.cross(p.random.direction()).cross(n).normalized();
  const int k = p.random.below(3);
  const Vec direction = p.random.chance(0.5) ? along : Vec(n.cross(Vec::Unit(k)));
  if (direction.isZero(0)) return ray_tied(p);
  const double by = p.random.chance(0.3) ? 1 + 16 * p.format.u() : 1;
  p.ray = {c + by * support(moved(p.b, -c), n) * n - 8 * direction, direction, 0, kInfinity};
  disturb_ray(p);
  return "flat";
}

/// A ray from an eye on the grid: straight down, along the floor, at a landmark or anywhere.
const char* ray_in_a_scene(Pieces& p) {
  const Scene scene = make_scene(p.random, {p.kind_b});
  p.b = rounded(p.kind_b, any_of(p.random, scene, p.kind_b), p.format);
  const Vec at = p.random.chance(p.kind_b == ShapeKind::kTriangle ? 0.8 : 0.4)
                     ? landmark(p.random, p.b)
                     : Vec(snapped(center(p.b)) + snapped(p.point(2)));
  Vec eye = snapped(center(p.b) + 8 * p.random.direction());
  eye.z() = std::abs(eye.z()) + kGrid;
  const int view = p.random.below(3);
  if (view == 0) eye = Vec(at.x(), at.y(), 10);
  if (view == 1) eye = Vec(p.random.either_sign(10), at.y(), at.z());
  p.ray = {eye, at - eye, 0, kInfinity};
  if (p.random.chance(0.7) && view != 2) p.ray.d.normalize();
  return "scene";
}

const char* ray_scaled(Pieces& p) {
  using Family = const char* (*)(Pieces&);
  static constexpr std::array<Family, 3> kFamilies = {ray_aligned, ray_tied, ray_in_a_scene};
  kFamilies[p.random.below(3)](p);
  const double by = std::ldexp(1, p.any_exponent());
  p.ray = ray_from_words(to_words(p.ray, p.format));
  p.b = scaled(rounded(p.kind_b, p.b, p.format), by);
  p.ray.o *= by, p.ray.d *= by;
  return "scaled";
}

}  // namespace

Case everyday(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  using Family = const char* (*)(Pieces&);
  static constexpr std::array<Family, 8> kConvex = {from_a_scene, aligned, tied, from_a_scene,
                                                    stacked,      tied,    flat, scaled};
  static constexpr std::array<Family, 8> kRays = {ray_in_a_scene, ray_aligned, ray_tied,
                                                  ray_in_a_scene, ray_flat,    ray_tied,
                                                  ray_flat,       ray_scaled};
  static_assert(kConvex.size() == detail::kEverydayFamilies &&
                kRays.size() == detail::kEverydayFamilies);
  // Every pair has its own random stream, separate from the streams of generate().
  Pieces p{{Random(seed, 500 + static_cast<std::uint64_t>(pair), index)},
           format,
           primary(pair),
           secondary(pair),
           {},
           {},
           {}};
  if (!has_ray(pair)) {
    const char* family = kConvex[index % kConvex.size()](p);
    return {pair, seed, index, family, to_words(p.a, format), to_words(p.b, format)};
  }
  const char* family = kRays[index % kRays.size()](p);
  Case made{pair, seed, index, family, to_words(p.ray, format), to_words(p.b, format)};
  if (made.ray().d.isZero(0)) made.a[3] = 1;  // rounding has erased the direction
  return made;
}

}  // namespace cde::oracle
