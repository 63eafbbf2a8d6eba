// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <variant>
#include <vector>

namespace cde {

/// Where something is at a time. Everything is computed in binary64; a motion is a function of the
/// time alone, so any frame can be had without those before it.
///
/// x_parent = pose * x_object, in the right-handed frame and length unit of the scene; times in
/// seconds.
using Pose = Eigen::Isometry3d;

/// Numbers that depend on their arguments only and are the same with every compiler.
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
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< units a second, parent's frame
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< radians a second about this axis,
                                                      ///< parent's frame
};

/// The object's origin runs through the points, the time between two in proportion to their
/// distance, and then stays at the last one.
struct Path {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector3d> points;  ///< at least 2, neighbours differ
  double duration = 1;                  ///< seconds for the whole path, > 0
  bool smooth = false;                  ///< cubic Hermite through the points, else straight lines
  bool loop = false;                    ///< from the last point back to the first, and on
};

struct Keyframe {
  double time = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit
};

/// Between keyframes the position is linear and the rotation turns the shorter way at constant
/// speed (slerp); before the first and after the last it holds.
struct Keyframes {
  std::vector<Keyframe> frames;  ///< at least 1, times strictly increasing
  bool loop = false;             ///< after the last one continues with the first
};

/// Straight at constant speed in a random direction, mirrored by the walls of a box.
struct RandomMotion {
  Pose place = Pose::Identity();
  std::uint64_t seed = 1;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  ///< min <= max
  double speed = 0;                                                              ///< units a second
  double spin = 0;    ///< radians a second about a random axis
  bool each = false;  ///< every shape of the object on its own, about its own centre
};

using Motion = std::variant<Still, Velocity, Path, Keyframes, RandomMotion>;

/// The pose at a time. Of RandomMotion with `each` the identity: use member_pose.
[[nodiscard]] Pose pose(const Motion& motion, double seconds);

/// The pose of one member that moves on its own, in the frame of the object it belongs to.
[[nodiscard]] Pose member_pose(const RandomMotion& motion, const Eigen::Vector3d& centre,
                               std::uint64_t member, double seconds);

[[nodiscard]] bool moves(const Motion& motion);    ///< it is not always in the same pose
[[nodiscard]] bool rotates(const Motion& motion);  ///< the pose is a rotation at some time

}  // namespace cde
