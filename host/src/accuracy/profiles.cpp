// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/profiles.hpp"
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cde/oracle/random.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/progress.hpp"

namespace cde::accuracy {
namespace {

using Json = nlohmann::ordered_json;
using oracle::Vec;

constexpr int kValues = 13;       // per axis, evenly on a logarithmic scale
constexpr std::size_t kFew = 10;  // fewer rays give no reliable value

double value_at(const ProfileAxis& axis, int k) {
  return axis.first * std::pow(axis.last / axis.first, static_cast<double>(k) / (kValues - 1));
}

struct RayAtTriangle {
  oracle::Ray ray;
  oracle::Triangle triangle;
};

/// A ray of length 1 aimed steeply at a triangle near the world's origin. The axis changes one of
/// these properties to x.
RayAtTriangle make(std::size_t axis, double x, std::uint64_t seed, std::uint64_t index) {
  oracle::Random random(seed, 3000 + axis, index);
  const Eigen::Matrix3d turn = random.rotation();
  const double usual_angle = random.uniform(0.8, 1.5), turned = random.uniform(0, 6.28);
  const double angle = axis == 0 ? x : usual_angle, size = axis == 1 ? x : 0.5;
  const double height = axis == 3 ? size / x : 0.8 * size;
  const Vec away = (axis == 2 ? x : 1) * random.direction();
  const double slant = random.uniform(0.3, 0.7);
  const Vec edge = turn * Vec(std::cos(turned), std::sin(turned), 0),
            up = turn * Vec(-std::sin(turned), std::cos(turned), 0);
  const Vec v0 = Vec::Zero(), v1 = size * edge, v2 = slant * size * edge + height * up;
  const double a = random.uniform(0.2, 0.4), b = random.uniform(0.2, 0.4);
  const Vec aim = a * v1 + b * v2;
  const Vec along = std::cos(angle) * turn.col(0) + std::sin(angle) * turn.col(2);
  const Vec origin = away - along;
  return {{origin, along, 0, std::numeric_limits<double>::infinity()},
          {v0 - aim + away, v1 - aim + away, v2 - aim + away}};
}

ProfilePoint measured_at(const AccuracyPipe& pipe, std::size_t axis, double x, std::uint64_t seed,
                         std::uint64_t cases) {
  const oracle::Format format{pipe.format.exp_bits, pipe.format.man_bits};
  const auto round = [&](Vec& v) {
    v = v.unaryExpr([&](double number) { return format.round(number); }).eval();
  };
  std::vector<RayAtTriangle> all;
  std::vector<std::uint64_t> a, b;
  const auto append = [&](std::vector<std::uint64_t>& words, const std::vector<double>& numbers) {
    for (const double number : numbers) words.push_back(pipe.format.encode(number));
  };
  for (std::uint64_t i = 0; i < cases; ++i) {
    RayAtTriangle c = make(axis, x, seed, i);
    for (Vec* v : {&c.ray.o, &c.ray.d, &c.triangle.v0, &c.triangle.v1, &c.triangle.v2}) round(*v);
    append(a, oracle::to_words(c.ray, format));
    append(b, oracle::to_words(oracle::Shape(c.triangle), format));
    all.push_back(c);
  }
  std::vector<PairResult> results(all.size());
  reference::test_pairs(pipe.pair, pipe.algorithm, pipe.format, a, b, results, PlaneSide::kSurface,
                        {}, pipe.box);
  ProfilePoint point{.x = x};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (results[i].bad) continue;
    const oracle::RayAnswer exact = oracle::cast(all[i].ray, all[i].triangle);
    if (!exact.hit) continue;
    ++point.met;
    if (results[i].f)
      point.error.add(std::abs(pipe.format.decode(results[i].t) - exact.t) / exact.t);
    else
      ++point.missed;
  }
  return point;
}

}  // namespace

const std::vector<ProfileAxis>& profile_axes() {
  static const std::vector<ProfileAxis> all = {
      {"grazing_angle", "Error against the grazing angle", "angle between ray and plane, radian",
       1e-4, 1},
      {"triangle_size", "Error against the size of the triangle",
       "longest edge over the ray's distance", 1e-4, 10},
      {"origin_distance", "Error against the distance from the world's origin",
       "distance from the world's origin in lengths of the ray", 1, 1e6},
      {"aspect", "Error against the aspect of the triangle", "longest edge over height", 1.25,
       1e5}};
  return all;
}

std::vector<Profile> profiles(const std::vector<AccuracyPipe>& pipes, std::uint64_t seed,
                              std::uint64_t cases, bool quiet) {
  std::vector<AccuracyPipe> wanted;
  for (AccuracyPipe pipe : pipes) {
    if (pipe.pair != Pair::kRayTriangle) continue;
    pipe.box = false;
    const auto same = [&](const AccuracyPipe& p) {
      return p.algorithm == pipe.algorithm && p.format == pipe.format;
    };
    if (std::ranges::none_of(wanted, same)) wanted.push_back(pipe);
  }
  Progress progress("profiles", quiet);
  std::vector<Profile> all;
  const auto& axes = profile_axes();
  for (const AccuracyPipe& pipe : wanted) {
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      progress(static_cast<double>(all.size()) / static_cast<double>(wanted.size() * axes.size()));
      Profile profile{.pipe = pipe, .along = axes[axis].name, .points = {}};
      for (int k = 0; k < kValues; ++k)
        profile.points.push_back(measured_at(pipe, axis, value_at(axes[axis], k), seed, cases));
      all.push_back(std::move(profile));
    }
  }
  return all;
}

Json profiles_json(const std::vector<Profile>& all) {
  Json list = Json::array();
  for (const Profile& profile : all) {
    Json points = Json::array();
    for (const ProfilePoint& p : profile.points) {
      const auto at = [&](double share) {
        const double value = p.error.quantile(share);
        return p.error.count() < kFew || !std::isfinite(value) ? Json() : Json(value);
      };
      points.push_back({{"axis_value", p.x},
                        {"cases", p.met},
                        {"missed_rays", p.missed},
                        {"median", at(0.5)},
                        {"p99", at(0.99)}});
    }
    list.push_back({{"along", profile.along},
                    {"format", profile.pipe.format.name()},
                    {"algorithm", name(profile.pipe.algorithm)},
                    {"profile_points", points}});
  }
  return list;
}

}  // namespace cde::accuracy
