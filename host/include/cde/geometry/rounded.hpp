// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/fp/scalars.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/shapes.hpp"
#include "cde/geometry/transform.hpp"

namespace cde {

/// A primitive or transform in the number format of a card: each word rounded to nearest, ties to
/// even. Card formats are no wider than fp32, so floats hold them.
template <class P>
[[nodiscard]] P rounded(const P& primitive, FpFormat format) {
  P nearest = primitive;
  if (format == FpFormat{}) return nearest;
  const FloatWords words(format);
  visit_words(nearest,
              [&words](const char*, int, float& word) { word = words.decode(words.encode(word)); });
  return nearest;
}

}  // namespace cde
