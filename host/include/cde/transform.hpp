#pragma once
#include <Eigen/Core>

namespace cde {

/// A rigid motion of an object: x_world = rotation * x_object + translation.
struct Transform {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();  ///< orthonormal within 2^-20
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();   ///< finite
};

}  // namespace cde
