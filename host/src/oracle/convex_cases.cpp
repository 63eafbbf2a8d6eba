// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "cde/oracle/build_shape.hpp"
#include "cde/oracle/cases.hpp"
#include "cde/oracle/signed_distance.hpp"

// Makes operands of the convex pairs. Builds both shapes around the origin in frames that the
// family chooses, rounds them, and places B by the family's rule.
namespace cde::oracle {
namespace {

double size_of(const Shape& shape) {
  const Shape origin = Sphere{center(shape), 0};
  return std::holds_alternative<Plane>(shape) ? 1.0 : scene_size(shape, origin);
}

/// Moves B so that the pair's signed distance is `distance`: it approaches from far away in the
/// given direction, then moves back along the separating normal.
Shape approach(const Shape& a, const Shape& b, const Vec& direction, double distance) {
  const double far = 20 * (size_of(a) + size_of(b));
  const Shape b_far = moved(b, center(a) - center(b) + far * direction);
  const SignedDistance found = signed_distance(a, b_far, {1e-12, 2000});
  return moved(b_far, (distance - found.middle()) * found.n);
}

/// Moves B so that its projection on n lies `distance` from A's.
Shape against(const Shape& a, const Shape& b, const Vec& n, double distance) {
  if (std::holds_alternative<Plane>(b)) return approach(a, b, n, distance);
  return moved(b, (distance + support(a, n) + support(b, -n)) * n);
}

Vec any_axis(Random& random) {
  return random.flipped(Vec::Unit(random.below(3)));
}

/// A small rotation by about `angle`.
Frame tilt(Random& random, double angle) {
  return Eigen::AngleAxisd(angle, random.direction()).toRotationMatrix();
}

/// A's frame, and B's frame relative to it.
struct Frames {
  Frame a, relative;
};

// Each draw is a statement or an element in braces; otherwise the compiler would choose their
// order.
struct Draft {
  Random random;
  Format format;
  ShapeKind kind_a, kind_b;
  Frame frame_a, frame_b;
  Build build_a, build_b;
  Shape a, b;

  void build() {
    a = rounded(kind_a, build_shape(random, kind_a, frame_a, build_a), format);
    b = rounded(kind_b, build_shape(random, kind_b, frame_b, build_b), format);
  }
  [[nodiscard]] double size() const { return size_of(a) + size_of(b); }
  double small_distance() { return small_offset(random, format) * size(); }
  void near_contact() {
    if (both_flat() && random.chance(0.5)) {
      cross();
      return;
    }
    const Vec direction = random.direction();
    b = approach(a, b, direction, small_distance());
  }
  [[nodiscard]] bool both_flat() const {
    return kind_a == ShapeKind::kTriangle && kind_b == ShapeKind::kTriangle;
  }
  /// Makes two triangles cross near their edges. Triangles that approach by a vertex usually slip
  /// past each other. So an edge of B goes through A slightly inside an edge of A, and the rest of
  /// B lies beyond that edge.
  void cross() {
    struct OnEdge {
      Vec at, edge, inwards;
    };
    const auto on_edge = [this](const Triangle& t) {
      const std::array<Vec, 3> v = {t.v0, t.v1, t.v2};
      const int k = random.below(3);
      const Vec edge = v[(k + 1) % 3] - v[k], at = v[k] + random.unit() * edge;
      return OnEdge{at, edge, v[(k + 2) % 3] - at};
    };
    const OnEdge of_a = on_edge(std::get<Triangle>(a));
    OnEdge of_b = on_edge(std::get<Triangle>(b));
    const double depth = std::abs(small_offset(random, format));
    // The direction in which B extends from its edge, within the plane of A.
    const Vec up = of_a.edge.cross(of_a.inwards);
    const Vec along = up.dot(of_b.edge) * of_b.inwards - up.dot(of_b.inwards) * of_b.edge;
    if (up.cross(of_a.edge).dot(along) * up.dot(of_b.edge) > 0) {
      const auto t = std::get<Triangle>(b);
      b = Triangle{-t.v0, -t.v1, -t.v2};
      of_b.at = -of_b.at;
    }
    b = moved(b, of_a.at + depth * of_a.inwards - of_b.at);
  }
  void beside(double least, double most) {
    const double length = random.uniform(least, most) * size();
    b = moved(b, center(a) - center(b) + length * random.direction());
  }
  /// Sets the frames. An AABB's frame is the world's.
  void frames(const Frames& chosen) {
    frame_a = chosen.a;
    frame_b = chosen.a * chosen.relative;
    if (kind_b == ShapeKind::kAabb) {
      frame_a = chosen.relative.transpose();
      frame_b = Frame::Identity();
    }
  }
};

const char* generic_near_contact(Draft& d) {
  if (d.random.chance(0.1))
    d.build_a.scale = d.build_b.scale = std::ldexp(1, d.random.below(21) - 10);
  d.build();
  d.near_contact();
  return "near contact";
}

const char* generic_random(Draft& d) {
  d.build();
  d.beside(0, 1);
  return "random";
}

const char* deep(Draft& d) {
  d.build();
  d.beside(0, 0.1);
  return "deep";
}

const char* aligned(Draft& d) {
  d.frames({d.random.quarter_turns(), d.random.quarter_turns()});
  d.build_a.dyadic = d.build_b.dyadic = true;
  d.build();
  const double fine = 16 * d.format.u(), coarse = std::max(0x1p-10, fine);
  const std::array distances = {0.0, 0.0, coarse, -coarse, fine, -fine};
  const Vec n = any_axis(d.random);
  Vec beside{d.random.below(17) - 8., d.random.below(17) - 8., d.random.below(17) - 8.};
  if (d.random.chance(0.3)) beside.setZero();
  if (d.random.chance(0.3)) {
    // A centre on the other shape's side plane, or side on side: move by half sizes.
    beside = 16 * Vec{d.random.below(3) - 1., d.random.below(3) - 1., d.random.below(3) - 1.};
  }
  d.b = moved(d.b, (beside - n.dot(beside) * n) / 16);
  d.b = against(d.a, d.b, n, distances[d.random.below(static_cast<int>(distances.size()))]);
  return "aligned";
}

const char* concentric(Draft& d) {
  if (d.random.chance(0.5)) d.frames({d.random.quarter_turns(), d.random.quarter_turns()});
  d.build_a.dyadic = d.build_b.dyadic = d.random.chance(0.5);
  d.build();
  d.b = moved(d.b, center(d.a) - center(d.b));
  return "concentric";
}

const char* containment(Draft& d) {
  const double scale = d.random.uniform(0.05, 0.3);
  (d.random.chance(0.5) ? d.build_a : d.build_b).scale = scale;
  d.build();
  d.beside(0, 0.1);
  return "containment";
}

const char* thin(Draft& d) {
  for (Build* build : {&d.build_a, &d.build_b})
    if (d.random.chance(0.7)) {
      build->thin = d.random.decades(1e-5, 1e-2);
      build->plate = d.random.chance(0.5);
    }
  d.build();
  d.random.chance(0.5) ? d.near_contact() : d.beside(0, 0.5);
  return "needles and plates";
}

const char* no_area(Draft& d) {
  if (d.kind_a != ShapeKind::kTriangle) return thin(d);
  d.build_a.no_area = true;
  d.build();
  d.random.chance(0.5) ? d.near_contact() : d.beside(0, 0.5);
  return "no area";
}

const char* half_turn(Draft& d) {
  Vec flip = -Vec::Ones();
  flip[d.random.below(3)] = 1;
  d.frames({d.random.rotation(), flip.asDiagonal()});
  d.build();
  d.random.chance(0.5) ? d.near_contact() : d.beside(0, 0.5);
  return "half turn";
}

const char* tilted(Draft& d) {
  const double angle = d.random.decades(1e-7, 1e-2);
  const Frame slightly = tilt(d.random, angle);
  d.frames({d.random.chance(0.5) ? d.random.rotation() : d.random.quarter_turns(),
            d.random.quarter_turns() * slightly});
  d.build();
  const Vec n = d.random.flipped(d.frame_a.col(d.random.below(3)));
  const double aside = d.random.unit();
  d.b = moved(d.b, aside * n.cross(d.random.direction()));
  if (d.random.chance(0.5))
    d.b = against(d.a, d.b, n, d.small_distance());
  else
    d.b = approach(d.a, d.b, n, d.small_distance());
  return "tilted";
}

const char* parallel_axes(Draft& d) {
  const Frame about_axis =
      Eigen::AngleAxisd(d.random.uniform(0, 6.28), Vec::UnitZ()).toRotationMatrix();
  Frame relative = about_axis;
  const double angle = d.random.decades(1e-7, 1e-3);
  if (d.random.chance(0.5)) relative = relative * tilt(d.random, angle);
  d.frames({d.random.rotation(), relative});
  d.build();
  d.random.chance(0.6) ? d.near_contact() : d.beside(0, 0.5);
  return "parallel axes";
}

const char* perpendicular_axes(Draft& d) {
  const Frame quarter = Eigen::AngleAxisd(1.5707963267948966, Vec::UnitX()).toRotationMatrix();
  d.frames({d.random.rotation(),
            Frame(Eigen::AngleAxisd(d.random.uniform(0, 6.28), Vec::UnitZ())) * quarter});
  d.build();
  d.random.chance(0.6) ? d.near_contact() : d.beside(0, 0.5);
  return "perpendicular axes";
}

/// The normal is within two degrees of the cap axis of a cylinder, or of a face normal.
const char* cap_axis(Draft& d) {
  d.build();
  const bool of_b = d.kind_b == ShapeKind::kCylinder && d.random.chance(0.6);
  const Vec axis = d.random.flipped((of_b ? d.frame_b : d.frame_a).col(2));
  const double angle = d.random.decades(1e-5, 0.035);
  const Vec n = tilt(d.random, angle) * axis;
  d.b = approach(d.a, d.b, n, d.small_distance());
  return "cap axis";
}

const char* mismatch(Draft& d) {
  const double scale = std::ldexp(1, d.random.chance(0.5) ? 10 : -10);
  (d.random.chance(0.5) ? d.build_a : d.build_b).scale = scale;
  d.build();
  d.random.chance(0.7) ? d.near_contact() : d.beside(0, 0.5);
  return "scale mismatch";
}

const char* offset(Draft& d) {
  d.build();
  d.random.chance(0.5) ? d.near_contact() : d.beside(0, 0.6);
  static constexpr std::array kOffsets = {10.0, 1e3, 1e5};
  const double far = std::min(kOffsets[d.random.below(3)], farthest(d.format));
  const Vec by = far * d.random.direction();
  d.a = moved(d.a, by);
  d.b = moved(d.b, by);
  return "offset";
}

// ---- Hard cases ----

/// Up to a tenth of the scene from contact, where narrow formats can tell hits from misses.
const char* close_by(Draft& d) {
  d.build();
  const Vec direction = d.random.direction();
  const double distance = d.random.either_sign(d.random.decades(1e-4, 1e-1));
  d.b = approach(d.a, d.b, direction, distance * d.size());
  return "close";
}

const char* touching(Draft& d) {
  d.build();
  d.b = approach(d.a, d.b, d.random.direction(), 0);
  return "touching";
}

/// Face to face, except for a rotation by 1e-9 to 1e-2.
const char* hair_turn(Draft& d) {
  const double angle = d.random.decades(1e-9, 1e-2);
  const Frame slightly = tilt(d.random, angle);
  d.frames({d.random.rotation(), slightly});
  d.build();
  const Vec n = d.random.flipped(d.frame_a.col(d.random.below(3)));
  d.b = against(d.a, d.b, n, d.small_distance());
  return "hair turn";
}

const char* coaxial(Draft& d) {
  d.frames({d.random.rotation(), Frame::Identity()});
  d.build();
  const Vec n = d.random.flipped(d.frame_a.col(2));
  d.b = against(d.a, d.b, n, d.random.chance(0.7) ? d.small_distance() : -0.3 * d.size());
  return "coaxial";
}

const char* huge_and_tiny(Draft& d) {
  const double scale = std::ldexp(1, d.random.chance(0.5) ? 20 : -20);
  (d.random.chance(0.5) ? d.build_a : d.build_b).scale = scale;
  d.build();
  d.near_contact();
  return "huge and tiny";
}

/// At `distance` times the shapes' size from the world's origin.
const char* far_off(Draft& d, double distance, const char* family) {
  d.build();
  d.random.chance(0.5) ? d.near_contact() : d.beside(0, 0.6);
  const Vec by = distance * d.random.direction();
  d.a = moved(d.a, by);
  d.b = moved(d.b, by);
  return family;
}
const char* far_1e3(Draft& d) {
  return far_off(d, 1e3, "far 1e3");
}
const char* far_1e5(Draft& d) {
  return far_off(d, 1e5, "far 1e5");
}
const char* far_1e7(Draft& d) {
  return far_off(d, 1e7, "far 1e7");
}

Draft blank(Pair pair, std::uint64_t seed, std::uint64_t stream, std::uint64_t index,
            const Format& format) {
  Draft d{Random(seed, stream + static_cast<std::uint64_t>(pair), index),
          format,
          primary(pair),
          secondary(pair),
          {},
          {},
          {},
          {},
          {},
          {}};
  d.frames({d.random.rotation(), d.random.rotation()});
  return d;
}

}  // namespace

Case detail::hard_convex_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                              const Format& format) {
  static constexpr std::array kFamilies = {close_by,      touching, hair_turn, coaxial,
                                           huge_and_tiny, far_1e3,  far_1e5,   far_1e7};
  static_assert(kFamilies.size() == kHardConvexFamilies);
  Draft d = blank(pair, seed, 1000, index, format);
  const char* family = kFamilies[index % kFamilies.size()](d);
  return {pair, seed, index, family, to_words(d.a, format), to_words(d.b, format)};
}

Case detail::convex_case(Pair pair, std::uint64_t seed, std::uint64_t index, const Format& format) {
  static constexpr std::array kFamilies = {
      generic_random, deep,   aligned,       concentric,         containment, thin,     no_area,
      half_turn,      tilted, parallel_axes, perpendicular_axes, cap_axis,    mismatch, offset};
  static_assert(kFamilies.size() == kConvexFamilies);
  Draft d = blank(pair, seed, 0, index, format);
  const char* family =
      index % 2 == 0 ? generic_near_contact(d) : kFamilies[index / 2 % kFamilies.size()](d);
  return {pair, seed, index, family, to_words(d.a, format), to_words(d.b, format)};
}

}  // namespace cde::oracle
