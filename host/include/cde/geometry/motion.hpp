// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <variant>
#include <vector>

namespace cde {

/// Pose of an object at a time. Everything is computed in binary64. A motion is a function of the
/// time alone, so any frame can be computed without those before it.
///
/// x_parent = pose * x_object, in the right-handed frame and length unit of the scene; times in
/// seconds.
using Pose = Eigen::Isometry3d;

/// Random numbers that depend on the arguments only and are the same with every compiler.
[[nodiscard]] std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t n);
/// 0 <= x < 1, of 53 bits.
[[nodiscard]] double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t n);
/// Uniform on the unit sphere.
[[nodiscard]] Eigen::Vector3d random_direction(std::uint64_t seed, std::uint64_t stream,
                                               std::uint64_t n);

/// Stays where it is placed.
struct Still {
  Pose place = Pose::Identity();
};

/// Constant velocity from `place`, turning about the object's own origin.
struct Velocity {
  Pose place = Pose::Identity();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< units per second, parent's frame
  /// Radians per second about this axis, parent's frame.
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
};

/// The object's origin moves through the points at constant mean speed per segment, then stays at
/// the last one. The time between two points is proportional to their distance.
struct Path {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector3d> points;  ///< at least 2, neighbours differ
  double duration = 1;                  ///< seconds for the whole path, > 0
  bool smooth = false;                  ///< cubic Hermite through the points, else straight lines
  bool loop = false;  ///< closed: from the last point back to the first, repeatedly
};

struct Keyframe {
  double time = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit
};

/// Between keyframes the position is linear, and the rotation turns the shorter way at constant
/// speed (slerp). Before the first keyframe and after the last the pose is constant.
struct Keyframes {
  std::vector<Keyframe> frames;  ///< at least 1, times strictly increasing
  bool loop = false;             ///< repeats from the first keyframe after the last
};

/// Straight at constant speed in a random direction, mirrored by the walls of a box.
struct RandomMotion {
  Pose place = Pose::Identity();
  std::uint64_t seed = 1;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  ///< min <= max
  double speed = 0;   ///< units per second
  double spin = 0;    ///< radians per second about a random axis
  bool each = false;  ///< each shape of the object moves independently, about its own centre
};

using Motion = std::variant<Still, Velocity, Path, Keyframes, RandomMotion>;

/// The pose at a time. For RandomMotion with `each` it is the identity: use member_pose.
[[nodiscard]] Pose pose(const Motion& motion, double seconds);

/// The pose of one member that moves independently, in the frame of its object.
[[nodiscard]] Pose member_pose(const RandomMotion& motion, const Eigen::Vector3d& centre,
                               std::uint64_t member, double seconds);

[[nodiscard]] bool moves(const Motion& motion);    ///< the pose changes with time
[[nodiscard]] bool rotates(const Motion& motion);  ///< the pose contains a rotation at some time

}  // namespace cde
