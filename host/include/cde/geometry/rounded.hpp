// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/fp/scalars.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/shapes.hpp"
#include "cde/geometry/transform.hpp"

namespace cde {

/// A primitive or transform as a card of a number format has it: every word the nearest of the
/// format, ties to even. The formats of cards are no wider than fp32, so that floats hold them.
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
