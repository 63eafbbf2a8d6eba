// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "cde/geometry/primitives.hpp"

namespace cde {

/// Rigid transform x -> R x + t as in the card's object tables: kWords words, the rotation row by
/// row, then the translation.
template <class S>
struct BasicTransform {
  using Scalar = S;
  static constexpr std::size_t kWords = 12;
  static constexpr std::string_view kKinds = "pppppppppccc";
  Matrix3<S> rotation = Matrix3<S>::Identity();  ///< R, orthonormal; a reflection is legal
  Vector3<S> translation = Vector3<S>::Zero();   ///< t, finite, in the unit of the scene

  template <class Self, class Visit>
  static void visit(Self& self, Visit&& field) {
    field("rotation", self.rotation), field("translation", self.translation);
  }
};
using Transform = BasicTransform<float>;

/// Whether R is the identity; zeros of either sign are equal.
template <class S>
[[nodiscard]] bool is_translation(const BasicTransform<S>& transform) {
  return transform.rotation == Matrix3<S>::Identity();
}

/// Why the card would refuse the transform: a word is not finite, or the rotation is not
/// orthonormal within the tolerance for an OBB. Other formats are treated as for primitives.
[[nodiscard]] std::optional<std::string> defect(const Transform& transform, FpFormat format = {});

/// A range of slots that moves as one object. Ranges may overlap.
struct Object {
  std::uint32_t first = 0;  ///< secondaries: in upload order; primaries: in load order
  std::uint32_t count = 0;  ///< at least 1
  Transform transform = {};
};

}  // namespace cde
