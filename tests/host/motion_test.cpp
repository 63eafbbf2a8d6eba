// SPDX-License-Identifier: Apache-2.0
// Poses: rigid, continuous, reproducible.
#include "cde/geometry/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cde/geometry/check.hpp"
#include "cde/scene/scene.hpp"

namespace cde {
namespace {

Path triangle_path(bool smooth, bool loop) {
  Path p;
  p.points = {{0, 0, 0}, {3, 0, 0}, {3, 4, 0}};
  p.duration = 7;
  p.smooth = smooth;
  p.loop = loop;
  p.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  return p;
}

Velocity velocity() {
  Velocity v;
  v.place.translation() = Eigen::Vector3d(1, 2, 3);
  v.linear = Eigen::Vector3d(1, -2, 0.5);
  v.angular = Eigen::Vector3d(0, 0, std::numbers::pi / 2);
  return v;
}

Keyframes keyframes() {
  const auto turn = [](double degrees) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitX()));
  };
  Keyframes k;
  k.frames = {{1, {0, 0, 0}, turn(0)}, {2, {2, 0, 0}, turn(90)}, {4, {2, 8, 0}, turn(90)}};
  return k;
}

RandomMotion random_motion() {
  RandomMotion m;
  m.seed = 5;
  m.min = Eigen::Vector3d(-1, -2, -3);
  m.max = Eigen::Vector3d(1, 2, 3);
  m.speed = 3;
  m.spin = 2;
  return m;
}

std::vector<std::pair<const char*, Motion>> all_motions() {
  Still still;
  still.place.linear() =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  return {{"still", still},
          {"velocity", velocity()},
          {"path", triangle_path(false, false)},
          {"loop", triangle_path(false, true)},
          {"smooth", triangle_path(true, false)},
          {"smooth loop", triangle_path(true, true)},
          {"keyframes", keyframes()},
          {"random", random_motion()}};
}

/// The card's conditions on a rotation, after rounding to fp32.
TEST(Motion, Rotations_AreOrthonormal) {
  for (const auto& [name, motion] : all_motions()) {
    for (int i = 0; i <= 1000; ++i) {
      const double time = 0.0173 * i;
      Obb box{Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones(),
              pose(motion, time).linear().cast<float>()};
      ASSERT_FALSE(defect(box)) << name << " at " << time << ": " << *defect(box);
      const Eigen::Matrix3d r = box.rotation.cast<double>();
      ASSERT_LE((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
                4 * 0x1p-24)
          << name << " at " << time;
      ASSERT_GT(r.determinant(), 0.999) << name;
    }
  }
}

/// Small steps in time are small steps in space, also at corners and walls.
TEST(Motion, EveryMotion_IsContinuous) {
  constexpr double kStep = 1e-3, kFastest = 12, kFastestTurn = 4;
  for (const auto& [name, motion] : all_motions()) {
    double moved = 0;
    for (int step_number = -500; step_number < 15000; ++step_number) {
      const double time = kStep * step_number;
      const Pose a = pose(motion, time), b = pose(motion, time + kStep);
      const double step = (b.translation() - a.translation()).norm();
      moved += step;
      ASSERT_LE(step, kFastest * kStep) << name << " at " << time;
      ASSERT_LE(Eigen::AngleAxisd(b.linear() * a.linear().transpose()).angle(),
                kFastestTurn * kStep)
          << name << " at " << time;
    }
    EXPECT_EQ(moved > 1, moves(motion)) << name;
  }
}

TEST(Motion, Velocity_IsExact) {
  const Pose p = pose(velocity(), 2);
  EXPECT_LE((p.translation() - Eigen::Vector3d(3, -2, 4)).norm(), 1e-15);
  EXPECT_LE((p * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(2, -2, 4)).norm(), 1e-14)
      << "half a turn about its own origin";
}

TEST(Motion, Paths_PassTheirPoints) {
  for (const bool smooth : {false, true}) {
    const Path open = triangle_path(smooth, false), loop = triangle_path(smooth, true);
    const auto at = [](const Path& p, double t) { return pose(Motion(p), t).translation().eval(); };
    // 3 and 4 units of 7, and 12 with the way back.
    EXPECT_LE((at(open, 0) - open.points[0]).norm(), 1e-12);
    EXPECT_LE((at(open, 3) - open.points[1]).norm(), 1e-12);
    EXPECT_LE((at(open, 7) - open.points[2]).norm(), 1e-12);
    EXPECT_LE((at(open, 99) - open.points[2]).norm(), 1e-12) << "stays at the end";
    EXPECT_LE((at(open, -1) - open.points[0]).norm(), 1e-12);
    EXPECT_LE((at(loop, 7 * 3 / 12.0) - open.points[1]).norm(), 1e-12);
    EXPECT_LE((at(loop, 7 * 7 / 12.0) - open.points[2]).norm(), 1e-12);
    EXPECT_LE((at(loop, 7) - open.points[0]).norm(), 1e-12);
    EXPECT_LE((at(loop, 7 + 7 * 3 / 12.0) - open.points[1]).norm(), 1e-12);
  }
  // Straight lines at constant speed; a smooth path leaves them.
  EXPECT_LE((pose(triangle_path(false, false), 1).translation() - Eigen::Vector3d(1, 0, 0)).norm(),
            1e-12);
  EXPECT_GT(std::fabs(pose(triangle_path(true, false), 1.5).translation().y()), 0.1);
}

TEST(Motion, Keyframes_TurnAtConstantSpeed) {
  const Keyframes k = keyframes();
  const auto angle = [&](double t) {
    return Eigen::AngleAxisd(pose(Motion(k), t).linear()).angle() * 180 / std::numbers::pi;
  };
  EXPECT_NEAR(angle(0), 0, 1e-9);
  EXPECT_NEAR(angle(1.25), 22.5, 1e-9);
  EXPECT_NEAR(angle(1.5), 45, 1e-9);
  EXPECT_NEAR(angle(3), 90, 1e-9);
  EXPECT_LE((pose(Motion(k), 3).translation() - Eigen::Vector3d(2, 4, 0)).norm(), 1e-12);
  Keyframes loop = k;
  loop.loop = true;
  EXPECT_TRUE(pose(Motion(loop), 1.5 + 3).isApprox(pose(Motion(k), 1.5), 1e-12));
}

TEST(Motion, RandomMotion_StaysInItsBoxAndRepeats) {
  const RandomMotion m = random_motion();
  RandomMotion other = m;
  other.seed = 6;
  int differ = 0;
  Eigen::Vector3d least = m.max, most = m.min;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.05 * i;
    const Pose a = pose(Motion(m), t);
    ASSERT_TRUE((a.matrix().array() == pose(Motion(m), t).matrix().array()).all());
    ASSERT_TRUE((a.translation().array() >= m.min.array()).all() &&
                (a.translation().array() <= m.max.array()).all())
        << a.translation().transpose();
    least = least.cwiseMin(a.translation());
    most = most.cwiseMax(a.translation());
    differ += a.isApprox(pose(Motion(other), t), 1e-9) ? 0 : 1;
  }
  EXPECT_GT(differ, 1900);
  EXPECT_GT(((most - least).array() / (m.max - m.min).array()).minCoeff(), 0.9)
      << "the motion must fill its box";
}

TEST(Motion, Members_MoveFromTheirPlaces) {
  RandomMotion m = random_motion();
  m.each = true;
  const Eigen::Vector3d centre(0.25, -1, 2);
  EXPECT_LE((member_pose(m, centre, 3, 0) * centre - centre).norm(), 1e-15);
  const Eigen::Vector3d one = member_pose(m, centre, 3, 0.1) * centre;
  EXPECT_NEAR((one - centre).norm(), 0.3, 1e-12) << "0.1 s at 3 units per second";
  EXPECT_GT((one - member_pose(m, centre, 4, 0.1) * centre).norm(), 1e-3);
  ASSERT_NE(m.spin, 0);
  const auto turn = [&](std::uint64_t member) {
    return Eigen::Matrix3d(member_pose(m, centre, member, 0.1).linear());
  };
  for (std::uint64_t member = 1; member < 5; ++member)
    EXPECT_GT((turn(member) - turn(0)).norm(), 1e-3) << "each member needs its own axis";
}

/// Golden values: the same with every compiler.
TEST(Motion, RandomNumbers_AreFixed) {
  EXPECT_EQ(random_bits(1, 2, 3), random_bits(1, 2, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 3, 2));
  double sum = 0;
  Eigen::Vector3d directions = Eigen::Vector3d::Zero();
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const double x = random_unit(9, 0, i);
    ASSERT_TRUE(x >= 0 && x < 1);
    sum += x;
    const Eigen::Vector3d d = random_direction(9, 1, i);
    ASSERT_NEAR(d.norm(), 1, 1e-15);
    directions += d;
  }
  EXPECT_NEAR(sum / 4000, 0.5, 5 * std::sqrt(1 / 12.0 / 4000));
  EXPECT_LE((directions / 4000).norm(), 5 / std::sqrt(4000.0));
}

TEST(Motion, Rotates_IsTrueOnlyForRotations) {
  Still placed;
  placed.place.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_FALSE(rotates(placed));
  EXPECT_TRUE(rotates(velocity()));
  Velocity straight = velocity();
  straight.angular.setZero();
  EXPECT_FALSE(rotates(straight));
  EXPECT_TRUE(rotates(keyframes()));
  RandomMotion spinless = random_motion();
  spinless.spin = 0;
  EXPECT_FALSE(rotates(spinless));
  EXPECT_TRUE(rotates(random_motion()));
}

}  // namespace
}  // namespace cde
