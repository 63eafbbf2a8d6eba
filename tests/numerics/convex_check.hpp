// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "cde/oracle/oracle.hpp"
#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/obb_plane.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_plane.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"

/// Answers of the mirror references of the convex pairs, checked by certificate.
namespace cde::testing {

using oracle::Pair;
using reference::Outcome;

inline constexpr std::array kConvexPairs = {
    Pair::kSphereSphere, Pair::kTriangleSphere, Pair::kSphereObb,
    Pair::kObbPlane,     Pair::kSpherePlane,    Pair::kObbObb,
    Pair::kTriangleObb,  Pair::kTriangleAabb,   Pair::kTriangleTriangle};

using Words = std::vector<double>;

template <template <class> class P, class S>
P<S> primitive(const Words& words) {
  std::array<S, P<S>::kWords> as_s;
  for (std::size_t i = 0; i < as_s.size(); ++i) as_s[i] = static_cast<S>(words.at(i));
  return from_words<P<S>>(as_s);
}

template <class S>
Outcome<S> run(Pair pair, const Words& a, const Words& b) {
  namespace r = reference;
  switch (pair) {
    case Pair::kSphereSphere:
      return r::sphere_sphere(primitive<BasicSphere, S>(a), primitive<BasicSphere, S>(b));
    case Pair::kTriangleSphere:
      return r::triangle_sphere(primitive<BasicTriangle, S>(a), primitive<BasicSphere, S>(b));
    case Pair::kSphereObb:
      return r::sphere_obb(primitive<BasicSphere, S>(a), primitive<BasicObb, S>(b));
    case Pair::kObbPlane:
      return r::obb_plane(primitive<BasicObb, S>(a), primitive<BasicPlane, S>(b));
    case Pair::kSpherePlane:
      return r::sphere_plane(primitive<BasicSphere, S>(a), primitive<BasicPlane, S>(b));
    case Pair::kObbObb:
      return r::obb_obb(primitive<BasicObb, S>(a), primitive<BasicObb, S>(b));
    case Pair::kTriangleObb:
      return r::triangle_obb(primitive<BasicTriangle, S>(a), primitive<BasicObb, S>(b));
    case Pair::kTriangleAabb:
      return r::triangle_aabb(primitive<BasicTriangle, S>(a), primitive<BasicAabb, S>(b));
    case Pair::kTriangleTriangle:
      return r::triangle_triangle(primitive<BasicTriangle, S>(a), primitive<BasicTriangle, S>(b));
    default:
      throw std::logic_error("not a convex pair with a closed form");
  }
}

template <class S>
oracle::Result judged(const Outcome<S>& o) {
  const auto vec = [](const Vector3<S>& v) {
    return oracle::Vec(static_cast<double>(v.x()), static_cast<double>(v.y()),
                       static_cast<double>(v.z()));
  };
  return {o.f, static_cast<double>(o.t), vec(o.cp), vec(o.n)};
}

/// check(), repeated with a hundredfold work limit if the oracle could not decide.
inline oracle::Decision decision(const oracle::Shape& a, const oracle::Shape& b,
                                 const oracle::Result& r, oracle::CheckOptions options) {
  oracle::Decision v = oracle::check(a, b, r, options);
  if (v.failure == oracle::Failure::kOracleTooWide) {
    options.distance.max_evaluations *= 100;
    v = oracle::check(a, b, r, options);
  }
  return v;
}

/// Worst errors of a set of cases, in units of u S; errors of witness points as a share of tolP /
/// u.
struct Worst {
  int cases = 0, hits = 0, in_band = 0, excused = 0, failed = 0;
  double c1 = 0, c2 = 0, witness = 0;

  void add(const Worst& w) {
    cases += w.cases, hits += w.hits, in_band += w.in_band, excused += w.excused;
    failed += w.failed;
    c1 = std::max(c1, w.c1), c2 = std::max(c2, w.c2), witness = std::max(witness, w.witness);
  }
};

template <class S>
Worst judge(const Outcome<S>& o, const oracle::Shape& a, const oracle::Shape& b, double u,
            std::string& message) {
  if (o.bad) {
    message = "flagged as bad input";
    return {.cases = 1, .failed = 1};
  }
  const oracle::Decision v = decision(a, b, judged(o), {.u = u, .distance = {}});
  if (!v.ok()) message = v.describe();
  const double us = u * v.scale;
  return {1,
          o.f,
          v.in_band,
          v.excused,
          !v.ok(),
          v.error_c1 / us,
          v.error_c2 / us,
          16 * std::max(v.witness_a, v.witness_b) / v.tolerance_p};
}

class Report {
 public:
  explicit Report(const std::string& title) {
    std::printf("%-32s %6s %6s %5s %7s %6s %6s %8s\n", title.c_str(), "cases", "hits", "band",
                "excused", "c1/uS", "c2/uS", "c3/16");
  }

  template <class S>
  void add(const std::string& family, const oracle::Case& c, double u) {
    const Outcome<S> o = run<S>(c.pair, {c.a.begin(), c.a.end()}, {c.b.begin(), c.b.end()});
    add(family, o, c.shape_a(), c.shape_b(), u, c.describe());
  }

  template <class S>
  void add(const std::string& family, const Outcome<S>& o, const oracle::Shape& a,
           const oracle::Shape& b, double u, const std::string& description) {
    std::string message;
    const Worst w = judge<S>(o, a, b, u, message);
    if (w.failed != 0 && ++shown_ <= 5) ADD_FAILURE() << message << '\n' << description;
    families_[family].add(w);
    all_.add(w);
  }

  const Worst& finish() {
    if (families_.size() > 1) {
      for (const auto& [name, w] : families_) line("  " + name, w);
    }
    line("  all", all_);
    EXPECT_EQ(all_.failed, 0) << "failed certificates";
    return all_;
  }

 private:
  static void line(const std::string& name, const Worst& w) {
    std::printf("%-32s %6d %5.1f%% %5d %7d %6.2f %6.2f %8.2f\n", name.c_str(), w.cases,
                100.0 * w.hits / w.cases, w.in_band, w.excused, w.c1, w.c2, w.witness);
  }

  std::map<std::string, Worst> families_;
  Worst all_;
  int shown_ = 0;
};

}  // namespace cde::testing
