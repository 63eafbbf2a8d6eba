// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/reference/pipes/cylinder/evaluator.hpp"
#include "cde/reference/pipes/cylinder/schedule.hpp"

/// @file
/// The search for the best normal as a state machine. Function step() is one pass of a pair through
/// the datapath. Every value that it computes is straight-line; the phase selects what a pass
/// keeps.
///
/// The best normal is a face normal, or is perpendicular to an edge or axis of one body (a circle
/// of normals). It may also be a direction from a vertex, or, between two rims, free. On a circle
/// the maximum is bracketed between two normals whose derivatives point inward. The next normal is
/// a Newton step. If that leaves the bracket, it is the normal at which the two support points tie,
/// which solves kinks at once. Free tracks use Newton steps on the sphere with the curvatures of
/// the support functions.
///
/// T is the largest g. Many normals share it up to rounding, because g is flat at its maximum.
/// Between a polyhedron and a cylinder, n is the one of them with the least derivative.
namespace cde::reference::cylinder {

/// State of a pair beside its operands: 34 words between cylinders, otherwise 41, and the pass
/// number.
template <typename S>
struct Search {
  S best_g = -std::numeric_limits<S>::infinity();
  Vector<S> best_n = Vector<S>::Constant(canonical_nan<S>());
  S best_slope = std::numeric_limits<S>::infinity();  ///< magnitude of the derivative at best_n
  /// Normal of the next pass, if its phase does not define one.
  Vector<S> next = Vector<S>::Zero();
  /// Circle: ends of the bracket, with e x n pointing from lo to hi. Free track: lo_n is the base,
  /// lo_y the step from it, and score its g.
  Vector<S> lo_n = Vector<S>::Zero(), lo_y = Vector<S>::Zero();
  Vector<S> hi_n = Vector<S>::Zero(), hi_y = Vector<S>::Zero();
  S score = S(0);                   ///< of the bracket: g of the better end
  Vector<S> q = Vector<S>::Zero();  ///< circle: also perpendicular to B's axis. Witness: the point
  Touch<S> last = {S(0), Vector<S>::Zero(), Vector<S>::Zero()};  ///< the previous sample
  Touch<S> back = last;  ///< the opposite of the previous sample
  S last_slope = S(0), back_slope = S(0);
  Vector<S> witness = Vector<S>::Zero();  ///< the best point of A so far; its squared error
  S off = S(0);
};

/// Derivatives of g along the circle perpendicular to e, in the direction e x n; for -n in the
/// direction e x -n.
template <typename S>
struct Slopes {
  Vector<S> t;  ///< e x n
  S plus, minus;
};

template <typename S>
[[nodiscard]] Slopes<S> slopes(const Vector<S>& e, const Evaluation<S>& at) {
  const Vector<S> t = cross<S>(e, at.plus.n);
  return {t, dot<S>(at.plus.y, t), -dot<S>(at.minus.y, t)};
}

template <typename S>
[[nodiscard]] Touch<S> select_touch(Mask<S> mask, const Touch<S>& a, const Touch<S>& b) {
  return {select<S>(mask, a.g, b.g), select<S>(mask, a.n, b.n), select<S>(mask, a.y, b.y)};
}

/// sqrt(16 times the smallest normal number): smaller weights would vanish when squared.
template <typename S>
inline const double kLeastWeight = [] {
  double x = 1;
  while (x * x > 16 * static_cast<double>(std::numeric_limits<S>::min())) x /= 2;
  return x;
}();

/// The normal of the bracket at which the support points of both ends tie. Here g(n) is the least
/// y.n, so the weights have the signs that put it inside. If an end is that normal itself, or the
/// support points coincide (a corner and a rim point), a sixteenth of the weight still moves on.
template <typename S>
[[nodiscard]] Vector<S> tie(const Search<S>& s) {
  const Vector<S> d = sub<S>(s.lo_y, s.hi_y);
  const S lo = magnitude(dot<S>(d, s.hi_n)), hi = magnitude(dot<S>(d, s.lo_n));
  const S least = max_num((lo + hi) * S(0x1p-4), S(kLeastWeight<S>));
  return add<S>(scale<S>(s.lo_n, max_num(lo, least)), scale<S>(s.hi_n, max_num(hi, least)));
}

// ---- Front of a pass: the normal, not yet of unit length ----

/// The direction from vertex v of A to the nearest point of B's surface, reversed. It is radial if
/// that point is on a cap or v is inside: caps have their own candidate.
template <typename S>
[[nodiscard]] Vector<S> vertex_normal(const Pair<S>& pair, const Vector<S>& v) {
  const S zero(0);
  const Vector<S> w = sub<S>(v, pair.d);
  const S z = dot<S>(pair.b, w);
  const Vector<S> x = cross<S>(pair.b, w), radial = cross<S>(x, pair.b);
  const S rho = square_root(dot<S>(x, x));
  const S above = magnitude(z) - pair.b_half, beyond = rho - pair.b_radius;
  const Vector<S> corner =
      add<S>(scale<S>(pair.b, move_sign(z, above * rho)), scale<S>(radial, beyond));
  return select<S>(zero < above && zero < beyond, corner, radial);
}

template <typename S>
[[nodiscard]] Vector<S> vertex(const Pair<S>& pair, int i) {
  if (pair.body == Body::kTriangle)
    return i == 0 ? Vector<S>(Vector<S>::Zero()) : pair.reach[i - 1];
  std::array<Vector<S>, 3> r = pair.reach;
  for (int k = 0; k < 3; ++k)
    if (i >> k & 1) r[k] = -r[k];
  return add<S>(r[0], add<S>(r[1], r[2]));
}

/// Frame of a circle. A projects along e to a rectangle (box) or segment (triangle) with sides
/// along u and e x u.
template <typename S>
[[nodiscard]] Vector<S> frame_u(const Pair<S>& pair, int track) {
  return pair.body == Body::kBox ? pair.axis[(track + 1) % 3] : pair.face;
}

/// Sample m of M on half the circle. Function g has kinks at u, at w = e x u and where b.n = 0 (q),
/// and its sharpest curve at p = q x e. Let f be the one of +-q, +-p that lies between u and w. The
/// four directions u, f, w, e x f divide the half circle into four arcs, with M/4 samples inside
/// each.
template <typename S>
[[nodiscard]] Vector<S> sample(const Pair<S>& pair, const Vector<S>& q, const Pass& p,
                               int samples) {
  const Vector<S> e = pair.axis[p.track], u = frame_u<S>(pair, p.track), w = cross<S>(e, u);
  const Vector<S> c = cross<S>(e, q);
  const S qu = dot<S>(q, u), qw = dot<S>(q, w);
  const Mask<S> same =
      (is_negative(qu) && is_negative(qw)) || (!is_negative(qu) && !is_negative(qw));
  const S sign = select<S>(is_negative(select<S>(same, qu, -qw)), S(-1), S(1));
  const Vector<S> x = select<S>(same, q, c), y = select<S>(same, c, Vector<S>(-q));
  Vector<S> f, f2;
  for (int k = 0; k < 3; ++k) f[k] = move_sign(sign, x[k]), f2[k] = move_sign(sign, y[k]);
  const int m = p.index % samples, per_arc = samples / 4, arc = m / per_arc;
  const Vector<S> middle = add<S>(w, arc < 2 ? u : Vector<S>(-u));
  const S narrow(0x1p-15);
  const Mask<S> none = magnitude(qu) <= narrow || magnitude(qw) <= narrow;
  (arc < 2 ? f : f2) = select<S>(none, middle, arc < 2 ? f : f2);
  const std::array<Vector<S>, 5> ends = {u, f, w, f2, -u};
  const S tau((2.0 * (m % per_arc) + 1) / (2 * per_arc)), rest(1 - static_cast<double>(tau));
  const Vector<S> raw = add<S>(scale<S>(ends[arc], rest), scale<S>(ends[arc + 1], tau));
  return p.index == samples ? Vector<S>(-raw) : raw;
}

/// sqrt(u): so near to a kink at q that a maximum between them is missed by less than rounding.
template <typename S>
inline constexpr double kBeside = [] {
  double x = 1;
  while (x * x > kUnitRoundoff<S>) x /= 2;
  return x;
}();

/// e x (1 0 0) or e x (0 1 0), whichever is longer. 2 cmp.
template <typename S>
[[nodiscard]] Vector<S> perpendicular(const Vector<S>& e) {
  const S zero(0);
  const Mask<S> along_x =
      magnitude(e.y()) <= magnitude(e.x()) && magnitude(e.z()) <= magnitude(e.x());
  return select<S>(along_x, Vector<S>(-e.z(), zero, e.x()), Vector<S>(zero, e.z(), -e.y()));
}

/// The triangle's normal (0) and edges (1, 2, 3). If the normal is below rounding, the triangle is
/// a segment, and any normal of its longer edge at v0 serves. If it is a point, any normal of B's
/// axis serves, because a point on that axis has no direction to B's side.
template <typename S>
[[nodiscard]] Vector<S> triangle_frame(const Pair<S>& pair, int i) {
  const Vector<S> e1 = pair.reach[0], e2 = pair.reach[1], face = cross<S>(e1, e2);
  const S e11 = dot<S>(e1, e1), e22 = dot<S>(e2, e2), tiny(16 * kUnitRoundoff<S>);
  const Mask<S> flat = dot<S>(face, face) <= (tiny * tiny) * (e11 * e22);
  const S least(4 * static_cast<double>(std::numeric_limits<S>::min()));
  const Mask<S> point = e11 < least && e22 < least;
  const Vector<S> longer = select<S>(e11 < e22, e2, e1);
  const Vector<S> other = perpendicular<S>(select<S>(point, pair.b, longer));
  if (i == 0) return select<S>(flat, other, face);
  return i == 1 ? e1 : i == 2 ? pair.reach[2] : e2;
}

template <typename S>
[[nodiscard]] Vector<S> front(const Pair<S>& pair, const Search<S>& s, const Pass& p, int samples) {
  const bool cylinders = pair.body == Body::kCylinder;
  const Vector<S> a = pair.axis[0];
  const Vector<S> e = cylinders && p.track == 1 ? pair.b : pair.axis[p.track];
  const Vector<S> other = cylinders && p.track == 1 ? a : pair.b;
  switch (p.phase) {
    case Phase::kFrame:
      return pair.body == Body::kBox ? pair.axis[p.index] : triangle_frame<S>(pair, p.index);
    case Phase::kAxis:
      return pair.b;
    case Phase::kCentre: {
      const Vector<S> c = p.index == 1 ? a : pair.b;
      return p.index == 0 ? pair.d : cross<S>(cross<S>(c, pair.d), c);
    }
    case Phase::kVertex:
      return vertex_normal<S>(pair, vertex<S>(pair, p.index));
    case Phase::kCap:
      return cross<S>(cross<S>(e, other), e);
    case Phase::kSide: {
      // The axis is along the edge: any direction of the circle serves as q.
      const Vector<S> q = cross<S>(e, other);
      const S tiny(16 * kUnitRoundoff<S>);
      return select<S>(dot<S>(q, q) <= tiny * tiny,
                       cylinders ? perpendicular<S>(e) : frame_u<S>(pair, p.track), q);
    }
    case Phase::kBeside:
      return add<S>(s.q, scale<S>(s.last.n, S(kBeside<S>)));
    case Phase::kSample:
      return sample<S>(pair, s.q, p, samples);
    case Phase::kPole:
      return p.track == 0 ? a : pair.b;
    case Phase::kStart:
      return p.track == 2 ? s.best_n : s.next;
    case Phase::kTouch:
      return s.best_n;
    case Phase::kRefine:  // back onto the circle, which rounding has left
      return cross<S>(cross<S>(e, s.next), e);
    default:
      return s.next;
  }
}

// ---- Back of a pass: what the pair keeps ----

/// The better one of both orientations.
template <typename S>
[[nodiscard]] Touch<S> better(const Evaluation<S>& e) {
  return select_touch<S>(e.plus.g < e.minus.g, e.minus, e.plus);
}

/// The next normal on a circle: a Newton step from `at` if it stays in the bracket, else the tie.
template <typename S>
[[nodiscard]] Vector<S> circle_step(const Vector<S>& e, const Search<S>& s, const Evaluation<S>& at,
                                    const Slopes<S>& slope) {
  const S zero(0);
  const Vector<S>& t = slope.t;
  const S va = dot<S>(at.a.v, t), vb = dot<S>(at.b.v, t);
  const S curve = (at.a.kappa * (va * va) + at.b.kappa * (vb * vb)) + at.plus.g;
  const Vector<S> n = add<S>(at.plus.n, scale<S>(t, slope.plus / curve));
  const Mask<S> inside = zero < curve && zero < dot<S>(cross<S>(e, s.lo_n), n) &&
                         dot<S>(cross<S>(e, s.hi_n), n) < zero;
  return select<S>(inside, n, tie<S>(s));
}

/// Makes the arc between two samples the bracket if both slopes point inward and no earlier bracket
/// has a better end.
template <typename S>
void keep_arc(Search<S>& s, const Touch<S>& lo, S lo_slope, const Touch<S>& hi, S hi_slope) {
  const S score = max_num(lo.g, hi.g);
  const Mask<S> take = S(0) < lo_slope && hi_slope < S(0) && s.score < score;
  s.score = select<S>(take, score, s.score);
  s.lo_n = select<S>(take, lo.n, s.lo_n), s.lo_y = select<S>(take, lo.y, s.lo_y);
  s.hi_n = select<S>(take, hi.n, s.hi_n), s.hi_y = select<S>(take, hi.y, s.hi_y);
}

/// Handles a sample: the arc from the previous sample to it, and the opposite arc.
template <typename S>
void keep_sample(Search<S>& s, const Evaluation<S>& at, const Slopes<S>& slope, bool first) {
  if (first) {
    s.score = -std::numeric_limits<S>::infinity();
    s.lo_n = s.lo_y = s.hi_n = s.hi_y = Vector<S>::Zero();
  } else {
    keep_arc<S>(s, s.last, s.last_slope, at.plus, slope.plus);
    keep_arc<S>(s, s.back, s.back_slope, at.minus, slope.minus);
  }
  s.last = at.plus, s.last_slope = slope.plus;
  s.back = at.minus, s.back_slope = slope.minus;
}

/// A step inside the bracket replaces the end whose slope has the same sign.
template <typename S>
void keep_step(Search<S>& s, const Evaluation<S>& at, const Slopes<S>& slope) {
  const Mask<S> up = S(0) < slope.plus;
  s.lo_n = select<S>(up, at.plus.n, s.lo_n), s.lo_y = select<S>(up, at.plus.y, s.lo_y);
  s.hi_n = select<S>(up, s.hi_n, at.plus.n), s.hi_y = select<S>(up, s.hi_y, at.plus.y);
}

/// Makes two ends, in either order, the bracket.
template <typename S>
void bracket(Search<S>& s, const Vector<S>& e, const Touch<S>& x, const Touch<S>& y) {
  const Mask<S> ahead = S(0) < dot<S>(cross<S>(e, x.n), y.n);
  s.lo_n = select<S>(ahead, x.n, y.n), s.lo_y = select<S>(ahead, x.y, y.y);
  s.hi_n = select<S>(ahead, y.n, x.n), s.hi_y = select<S>(ahead, y.y, x.y);
}

/// A cylinder in the search beside a cap's axis.
template <typename S>
struct Cap {
  Vector<S> axis, reach;
  S radius;
};

/// The next normal off a cap's axis n, towards the steepest ascent t = y - g n, taken at the cap's
/// centre. Function g changes by |t| - r per radian, and curves by kappa (v.t)^2/|t|^2 + g of the
/// other body. The step is the Newton step of that derivative, limited to 2^-13 to 1/8 radian. From
/// a start farther off, the search would miss maxima close to the axis.
///
/// In two cases y is the wrong point to start from. First, the other cylinder's axis may be
/// perpendicular to n within a 32nd of t's slope. Its nearer end is then the one on the side of the
/// step, not the one that n happens to touch. Second, the axes may be parallel up to 2^-15. Then
/// the contribution of its rim turns with the step: the slope is |t| - r - r', with t between the
/// axes.
template <typename S>
[[nodiscard]] Vector<S> beside_pole(const Touch<S>& at, const Vector<S>& d, const Cap<S>& own,
                                    const Cap<S>& other, const Rim<S>& rim) {
  const S zero(0), far(0.125), near(0x1p-13);
  const S tilt = dot<S>(other.axis, at.n);
  const S side = dot<S>(d, other.axis) - tilt * dot<S>(d, at.n);
  Vector<S> end;
  for (int k = 0; k < 3; ++k) end[k] = move_sign(side, other.reach[k]);
  const Vector<S> x = sub<S>(d, end), across = sub<S>(x, scale<S>(at.n, dot<S>(x, at.n)));
  const S ahead = dot<S>(across, other.axis);
  const Mask<S> crosses = (tilt * tilt) * dot<S>(across, across) <= (ahead * ahead) * S(0x1p-10);
  const Mask<S> parallel = rim.kappa == zero || other.radius <= rim.kappa * S(0x1p-15);
  const Vector<S> touched = sub<S>(at.y, scale<S>(at.n, at.g));
  const Vector<S> t = select<S>(crosses || parallel, across, touched);
  const S tt = dot<S>(t, t), length = square_root(tt), vt = dot<S>(rim.v, t);
  const S curve = select<S>(parallel, zero, rim.kappa * (vt * vt)) + at.g * tt;
  const S radius = select<S>(parallel, own.radius + other.radius, own.radius);
  const S angle = ((length - radius) * tt) / curve;
  const S step = select<S>(zero < curve, clamp<S>(angle, near, far), far);
  return add<S>(scale<S>(at.n, length), scale<S>(t, step));
}

/// The step off the axis of A's caps, or of B's.
template <typename S>
[[nodiscard]] Vector<S> pole_step(const Pair<S>& pair, const Evaluation<S>& at, bool of_a) {
  const Cap<S> a = {pair.axis[0], pair.reach[0], pair.radius};
  const Cap<S> b = {pair.b, pair.b_reach, pair.b_radius};
  return of_a ? beside_pole<S>(better<S>(at), pair.d, a, b, at.b)
              : beside_pole<S>(better<S>(at), pair.d, b, a, at.a);
}

/// Newton step of g on the sphere from n: (kappa_a va va^T + kappa_b vb vb^T + g) step = y - g n in
/// the tangent plane. Enough of the identity is added to the matrix to make its smaller eigenvalue
/// |y - g n|. This limits the step to 1; each component is limited to 1/2.
template <typename S>
[[nodiscard]] Vector<S> newton_step(const Touch<S>& at, const Rim<S>& a, const Rim<S>& b) {
  const S zero(0), half(0.5);
  const Mask<S> swap = a.kappa == zero;
  const S k1 = select<S>(swap, b.kappa, a.kappa), k2 = select<S>(swap, a.kappa, b.kappa);
  const Vector<S> v1 = select<S>(swap, b.v, a.v), v2 = select<S>(swap, a.v, b.v);
  const Vector<S> t = cross<S>(v1, at.n);
  const S c = dot<S>(v2, v1), s = dot<S>(v2, t), kc = k2 * c, ks = k2 * s;
  const S h11 = k1 + kc * c, h12 = kc * s, h22 = ks * s, hh = h12 * h12;
  const S d11 = h11 + at.g, d22 = h22 + at.g;
  const S mean = (d11 + d22) * half, apart = (d11 - d22) * half;
  const S lesser = mean - square_root(apart * apart + hh);
  const S y1 = dot<S>(at.y, v1), y2 = dot<S>(at.y, t);
  const S more = max_num(zero, square_root(y1 * y1 + y2 * y2) - lesser);
  const S e11 = d11 + more, e22 = d22 + more;
  const S inverse = S(1) / (e11 * e22 - hh);
  const S s1 = clamp<S>((e22 * y1 - h12 * y2) * inverse, -half, half);
  const S s2 = clamp<S>((e11 * y2 - h12 * y1) * inverse, -half, half);
  return add<S>(scale<S>(v1, s1), scale<S>(t, s2));
}

/// A step of a free track: accepted if g grew, else a quarter of it is tried next.
template <typename S>
void keep_newton(Search<S>& s, const Evaluation<S>& at, bool start) {
  const Touch<S> now = better<S>(at);
  const Mask<S> up = start ? Mask<S>(true) : s.score < now.g;
  s.lo_y = select<S>(up, newton_step<S>(now, at.a, at.b), Vector<S>(scale<S>(s.lo_y, S(0.25))));
  s.lo_n = select<S>(up, now.n, s.lo_n);
  s.score = select<S>(up, now.g, s.score);
  s.next = add<S>(s.lo_n, s.lo_y);
}

/// Keeps the largest g so far, and its normal. Between cylinders the first of equal values stays:
/// with a rim switched off, g would be too large by r |a x n|, a rounding error on the axis itself.
/// Otherwise, of values equal up to rounding, the one with the least slope is kept. A vertex' own
/// normal has slope 0. Normals of faces and sides are right only on a kink, where a circle
/// finds them again.
template <typename S>
void keep_best(Search<S>& s, const Pair<S>& pair, const Pass& p, const Evaluation<S>& at,
               Mask<S> turned, const Slopes<S>& slope) {
  const Touch<S> best = select_touch<S>(turned, at.minus, at.plus);
  const Mask<S> raised = s.best_g < best.g;
  if (pair.body == Body::kCylinder) {
    s.best_n = select<S>(raised, best.n, s.best_n);
  } else {
    const bool on_circle = p.phase == Phase::kSample || p.phase == Phase::kRefine;
    const S along = select<S>(turned, magnitude(slope.minus), magnitude(slope.plus));
    const S size = on_circle                   ? along
                   : p.phase == Phase::kVertex ? S(0)
                                               : S(std::numeric_limits<S>::infinity());
    const S near = (magnitude(at.plus.g) + magnitude(at.minus.g)) * S(2 * kUnitRoundoff<S>);
    const Mask<S> equal = magnitude(best.g - s.best_g) <= near;
    const Mask<S> take = (equal && size < s.best_slope) || (!equal && raised);
    s.best_n = select<S>(take, best.n, s.best_n);
    s.best_slope = select<S>(take, size, s.best_slope);
  }
  s.best_g = select<S>(raised, best.g, s.best_g);
}

/// One pass of the search. `p` is pass(body, iterations, k), not yet a witness pass.
template <typename S>
void step(Pair<S>& pair, Search<S>& s, const Pass& p, const Iterations& iterations) {
  const bool cylinders = pair.body == Body::kCylinder, pole = p.phase == Phase::kPole;
  const Vector<S> n = normalise<S>(front<S>(pair, s, p, iterations.samples));
  const Evaluation<S> at = evaluate<S>(pair, n, pole && p.track == 0, pole && p.track == 1);
  const Mask<S> turned = at.plus.g < at.minus.g;
  const Touch<S> best = select_touch<S>(turned, at.minus, at.plus);
  const Vector<S> e = cylinders && p.track == 1 ? pair.b : pair.axis[p.track];
  const bool on_circle = p.phase == Phase::kSample || p.phase == Phase::kRefine;
  const Slopes<S> slope = on_circle ? slopes<S>(e, at) : Slopes<S>{e, S(0), S(0)};

  switch (p.phase) {
    case Phase::kFrame:
      (pair.body == Body::kTriangle && p.index == 0
           ? pair.face
           : pair.axis[pair.body == Body::kTriangle ? p.index - 1 : p.index]) = n;
      break;
    case Phase::kCap:
      s.last = best;
      break;
    case Phase::kSide:
      s.q = best.n;
      break;
    case Phase::kBeside:
      bracket<S>(s, e, s.last, best);
      s.next = tie<S>(s);
      break;
    case Phase::kSample:
      keep_sample<S>(s, at, slope, p.index == 0);
      s.next = tie<S>(s);
      break;
    case Phase::kRefine:
      keep_step<S>(s, at, slope);
      s.next = circle_step<S>(e, s, at, slope);
      break;
    case Phase::kPole:
      s.next = pole_step<S>(pair, at, p.track == 0);
      break;
    case Phase::kStart:
    case Phase::kNewton:
      keep_newton<S>(s, at, p.phase == Phase::kStart);
      break;
    default:
      break;
  }
  keep_best<S>(s, pair, p, at, turned, slope);
}

}  // namespace cde::reference::cylinder
