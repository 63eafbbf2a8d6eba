// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#include <fmt/format.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/support/error.hpp"
#include "cde/support/process.hpp"

/// Converts shapes to FCL objects, and runs work in a child process, because an assertion of FCL
/// ends the process.
namespace cde::cli::fcl_objects {

[[nodiscard]] inline fcl::CollisionObjectd object(const BasicSphere<double>& s) {
  return {std::make_shared<fcl::Sphered>(s.r), Eigen::Matrix3d::Identity(), s.c};
}
[[nodiscard]] inline fcl::CollisionObjectd object(const BasicAabb<double>& s) {
  return {std::make_shared<fcl::Boxd>(s.max - s.min), Eigen::Matrix3d::Identity(),
          (s.min + s.max) / 2};
}
[[nodiscard]] inline fcl::CollisionObjectd object(const BasicCylinder<double>& s) {
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), s.axis);
  return {std::make_shared<fcl::Cylinderd>(s.radius, 2 * s.half_height), turn.toRotationMatrix(),
          s.c};
}
[[nodiscard]] inline fcl::CollisionObjectd object(const BasicPlane<double>& s) {
  return {std::make_shared<fcl::Planed>(s.n, s.d), Eigen::Matrix3d::Identity(),
          Eigen::Vector3d::Zero()};
}
[[nodiscard]] inline fcl::CollisionObjectd object(const BasicObb<double>& s) {
  return {std::make_shared<fcl::Boxd>(2 * s.half), s.rotation, s.c};
}
[[nodiscard]] inline fcl::CollisionObjectd object(Shape shape, std::span<const float> words) {
  return with_shape<float>(shape, [&]<class P>() -> fcl::CollisionObjectd {
    const auto wide = primitive_cast<double>(from_words<P>(words.template first<P::kWords>()));
    if constexpr (requires { object(wide); })
      return object(wide);
    else
      throw Error(ErrorCode::kUsage, fmt::format("FCL has no {}", name(shape)));
  });
}

/// Runs `work` in a child process. `work` calls its argument with each value. Returns all values up
/// to the end or the child's death.
template <class Value, class Work>
[[nodiscard]] std::vector<Value> in_child(const Work& work) {
  const process::Result ran = process::run_isolated([&](int out) {
    ::close(STDERR_FILENO);  // drops the assertion's message
    work([out](Value value) {
      if (::write(out, &value, sizeof value) != sizeof value) ::_exit(1);
    });
  });
  std::vector<Value> values(ran.output.size() / sizeof(Value));
  std::memcpy(values.data(), ran.output.data(), values.size() * sizeof(Value));
  return values;
}

}  // namespace cde::cli::fcl_objects
