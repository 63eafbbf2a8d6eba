// SPDX-License-Identifier: Apache-2.0
#include "cde/oracle/build_shape.hpp"

#include <algorithm>

namespace cde::oracle {

Shape build_shape(Random& random, ShapeKind kind, const Frame& frame, const Build& build) {
  return with_kind(kind, [&]<class S>() -> Shape { return S::build(random, frame, build); });
}

Shape rounded(ShapeKind kind, const Shape& shape, const Format& format) {
  return shape_from_words(kind, to_words(shape, format));
}

double small_offset(Random& random, const Format& format) {
  const double least = std::max(1e-11, 1e-7 * (format.u() * 0x1p24));
  return random.either_sign(random.decades(least, std::max(1e-3, 30 * least)));
}

double farthest(const Format& format) {
  return 1e5 / (format.u() * 0x1p24);
}

}  // namespace cde::oracle
