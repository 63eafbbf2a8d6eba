// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <variant>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"

namespace cde {

/// A list of shapes of one kind. The alternatives are in the order of Shape.
using Shapes = ShapeList::Lists<float>;

[[nodiscard]] inline Shape shape_of(const Shapes& shapes) {
  return static_cast<Shape>(shapes.index());
}
[[nodiscard]] inline std::size_t size(const Shapes& shapes) {
  return std::visit([](const auto& list) { return list.size(); }, shapes);
}

/// Words of shape i, in slot order.
[[nodiscard]] inline std::vector<float> numbers_of(const Shapes& shapes, std::size_t i) {
  return std::visit(
      [i](const auto& list) {
        const auto words = to_words(list[i]);
        return std::vector<float>(words.begin(), words.end());
      },
      shapes);
}

}  // namespace cde
