// SPDX-License-Identifier: Apache-2.0
// Reads [object.motion].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/parts.hpp"

namespace cde::scene_parts {
namespace {

using toml_reader::kNotNegative;
using toml_reader::kPositive;
using toml_reader::Table;

/// Reads quaternion = [w, x, y, z], or axis and degrees. Without either it is the identity.
Eigen::Quaterniond read_rotation(Table& t) {
  if (t.has("quaternion")) {
    if (t.has("axis")) t.fail(ErrorCode::kFile, "axis", "excludes 'quaternion'");
    const std::vector<double> q = t.numbers("quaternion", 4);
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    if (!(std::fabs(rotation.norm() - 1) < 1e-3))
      t.fail("quaternion",
             fmt::format("[w, x, y, z] has length {}; it must be 1", rotation.norm()));
    return rotation.normalized();
  }
  t.also_known({"quaternion"});
  if (!t.has("axis") && !t.has("degrees")) {
    t.also_known({"axis", "degrees"});
    return Eigen::Quaterniond::Identity();
  }
  const Eigen::Vector3d axis = t.vector("axis");
  if (!(axis.norm() > 1e-30)) t.fail("axis", "has no direction");
  return Eigen::Quaterniond(Eigen::AngleAxisd(t.number("degrees") * kDegree, axis.normalized()));
}

Pose read_place(Table& t) {
  Pose place = Pose::Identity();
  place.translation() = t.vector("position", Eigen::Vector3d(0, 0, 0));
  // An identity rotation stays exact.
  place.linear() = read_rotation(t).toRotationMatrix();
  return place;
}

Path read_path(Table& t) {
  Path path;
  path.rotation = read_rotation(t);
  path.points = t.vectors("points");
  if (path.points.size() < 2) t.fail("points", "must be at least 2");
  path.loop = t.flag("loop", false);
  double length = 0;
  for (std::size_t i = 0; i + (path.loop ? 0 : 1) < path.points.size(); ++i) {
    const double step = (path.points[(i + 1) % path.points.size()] - path.points[i]).norm();
    if (!(step > 0))
      t.fail("points", fmt::format("{} and the next point are the same{}", i,
                                   path.loop ? "; a loop closes itself" : ""));
    length += step;
  }
  path.smooth = t.choice("interpolation", {"linear", "smooth"}, 0) == 1;
  path.duration = t.one_of({"duration", "speed"}) == "duration"
                      ? t.number("duration", {}, kPositive)
                      : length / t.number("speed", {}, kPositive);
  return path;
}

Keyframes read_keyframes(Table& t) {
  Keyframes keys;
  if (!t.has("keyframe")) t.fail(ErrorCode::kFile, "", "the key 'keyframe' is missing");
  for (Table& k : t.tables("keyframe")) {
    Keyframe key;
    key.time = k.number("time");
    key.position = k.vector("position");
    key.rotation = read_rotation(k);
    k.finish();
    if (!keys.frames.empty() && !(key.time > keys.frames.back().time))
      k.fail("time", fmt::format("is {}; times must increase, and the one before is {}", key.time,
                                 keys.frames.back().time));
    keys.frames.push_back(key);
  }
  keys.loop = t.flag("loop", false);
  return keys;
}

RandomMotion read_random(Table& t, const SceneObject& object) {
  RandomMotion m;
  m.each = t.flag("each", false);
  if (m.each && object.rays)
    t.fail(ErrorCode::kUsage, "each",
           "random_rays start at the object's origin and cannot move alone");
  if (m.each && std::holds_alternative<std::vector<Plane>>(object.shapes))
    t.fail(ErrorCode::kUsage, "each", "a plane has no position to move from");
  if (!m.each) m.place = read_place(t);
  m.seed = t.integer<std::uint64_t>("seed", 1, 0, std::numeric_limits<std::int64_t>::max());
  m.min = t.vector("min");
  m.max = t.vector("max");
  for (int k = 0; k < 3; ++k)
    if (!(m.min[k] <= m.max[k])) t.fail("max", "must be at least min on every axis");
  m.speed = t.number("speed", {}, kNotNegative);
  m.spin = kDegree * t.number("spin", 0.0, kNotNegative);
  const auto inside = [&](const Eigen::Vector3d& p) {
    return (p.array() >= m.min.array()).all() && (p.array() <= m.max.array()).all();
  };
  if (m.each) {
    const std::vector<Eigen::Vector3d> places = centres(object.shapes);
    const auto out = std::find_if_not(places.begin(), places.end(), inside);
    if (out != places.end())
      t.fail("min",
             fmt::format("shape {} starts outside the box of the motion", out - places.begin()));
  } else if (!inside(m.place.translation())) {
    t.fail(t.has("position") ? "position" : "min",
           "the object's origin starts outside the box of the motion");
  }
  return m;
}

}  // namespace

Motion read_motion(Table& t, const SceneObject& object) {
  const std::size_t kind = t.choice("kind", {"still", "velocity", "path", "keyframes", "random"});
  Motion motion;
  switch (kind) {
    case 0:
      motion = Still{read_place(t)};
      break;
    case 1: {
      Velocity v;
      v.place = read_place(t);
      v.linear = t.vector("linear", Eigen::Vector3d(0, 0, 0));
      v.angular = kDegree * t.vector("angular", Eigen::Vector3d(0, 0, 0));
      motion = v;
      break;
    }
    case 2:
      motion = read_path(t);
      break;
    case 3:
      motion = read_keyframes(t);
      break;
    default:
      motion = read_random(t, object);
  }
  t.finish();
  return motion;
}

}  // namespace cde::scene_parts
