// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/support/error.hpp"
#include "cde/support/process.hpp"

/// Our shapes as FCL's, and a process of its own for what may end in one of its assertions.
namespace cde::cli::fcl_objects {

template <template <class> class P>
[[nodiscard]] P<double> primitive(std::span<const float> words) {
  return primitive_cast<double>(from_words<P<float>>(words.template first<P<float>::kWords>()));
}

[[nodiscard]] inline fcl::CollisionObjectd object(std::string_view shape,
                                                  std::span<const float> words) {
  const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
  if (shape == "sphere") {
    const auto s = primitive<BasicSphere>(words);
    return {std::make_shared<fcl::Sphered>(s.r), upright, s.c};
  }
  if (shape == "aabb") {
    const auto s = primitive<BasicAabb>(words);
    return {std::make_shared<fcl::Boxd>(s.max - s.min), upright, (s.min + s.max) / 2};
  }
  if (shape == "cylinder") {
    const auto s = primitive<BasicCylinder>(words);
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), s.axis);
    return {std::make_shared<fcl::Cylinderd>(s.radius, 2 * s.half_height), turn.toRotationMatrix(),
            s.c};
  }
  if (shape == "plane") {
    const auto s = primitive<BasicPlane>(words);
    return {std::make_shared<fcl::Planed>(s.n, s.d), upright, Eigen::Vector3d::Zero()};
  }
  const auto s = primitive<BasicObb>(words);
  return {std::make_shared<fcl::Boxd>(2 * s.half), s.rotation, s.c};
}

/// Runs `work` in a child process, which hands over what it finds by calling its argument. Returns
/// all of it, up to the end or the child's death.
template <class Value, class Work>
[[nodiscard]] std::vector<Value> in_child(const Work& work) {
  const process::Result ran = process::isolated([&](int out) {
    ::close(STDERR_FILENO);  // the assertion's message
    work([out](Value value) {
      if (::write(out, &value, sizeof value) != sizeof value) ::_exit(1);
    });
  });
  std::vector<Value> values(ran.output.size() / sizeof(Value));
  std::memcpy(values.data(), ran.output.data(), values.size() * sizeof(Value));
  return values;
}

}  // namespace cde::cli::fcl_objects
