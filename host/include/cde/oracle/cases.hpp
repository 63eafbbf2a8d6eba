// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "cde/contract/pairs.hpp"
#include "cde/oracle/format.hpp"
#include "cde/oracle/shapes.hpp"

namespace cde::oracle {

/// Which pairs there are, and of what shapes, the contract says; what they mean is said here.
using cde::Pair;
inline constexpr std::array kPairs = [] {
  std::array<Pair, cde::kPairs> all{};
  for (unsigned p = 0; p < all.size(); ++p) all.at(p) = static_cast<Pair>(p);
  return all;
}();

/// "ray-triangle", "obb-obb", ...
[[nodiscard]] const char* to_string(Pair pair);
[[nodiscard]] ShapeKind primary(Pair pair);
[[nodiscard]] ShapeKind secondary(Pair pair);
[[nodiscard]] inline bool has_ray(Pair pair) {
  return primary(pair) == ShapeKind::kRay;
}
[[nodiscard]] inline bool has_cylinder(Pair pair) {
  return primary(pair) == ShapeKind::kCylinder || secondary(pair) == ShapeKind::kCylinder;
}

/// Two valid operands as the words of their slots, so that the hardware, the reference and the
/// oracle get the very same numbers.
struct Case {
  Pair pair;
  std::uint64_t seed, index;
  const char* family;        ///< which set of cases it belongs to: "near contact", "aligned", ...
  std::vector<double> a, b;  ///< exact in the format of the operands

  [[nodiscard]] Shape shape_a() const { return shape_from_words(primary(pair), a); }
  [[nodiscard]] Shape shape_b() const { return shape_from_words(secondary(pair), b); }
  [[nodiscard]] Ray ray() const { return ray_from_words(a); }
  /// Pair, seed, index, family and all words in hexfloat: enough to feed the case back in.
  [[nodiscard]] std::string describe() const;
};

/// Case `index` of a pair, a function of the four arguments. All words are exact in the format.
///
/// Even indices are near the decision. Convex pairs: signed gap of +-1e-7 to +-1e-3 of the scene,
/// or as many times the unit roundoff of another format (small_offset), generic shapes, a tenth of
/// the scenes scaled by up to 2^+-10. Rays: aimed past the silhouette, an edge or a rim by as
/// little.
///
/// Odd indices take turns through the directed families. Convex pairs: random, deep, aligned (exact
/// face-to-face contact, +-2^-10 and +-16 u), concentric, containment, needles and plates, no area
/// (triangles that are a segment or a point), half turns, tilted by 1e-7 to 1e-2, parallel and
/// perpendicular axes, normal within 2 degrees of a cap axis or face normal, sizes a thousandfold
/// apart, far from the world's origin (10, 1e3, 1e5, and at most 6e-3 / u). Rays: see
/// ray_cases.cpp.
[[nodiscard]] Case generate(Pair pair, std::uint64_t seed, std::uint64_t index,
                            const Format& format = {});

/// Case `index` of what people build, where ties are the rule: families aligned (boxes, triangles,
/// cylinders along the axes, coordinates whole or real), tied (one or two coordinates of the
/// centres equal), stacked (face to face: in contact, or a little off), flat (triangles without
/// area or thinner than rounding, plates; rays edge-on), scaled (by a power of two), and scene: two
/// neighbours of a random scene (scene.hpp). Of the first four, many are turned together or tilted
/// by 1e-7 to 1e-2. Like generate(), a function of the four arguments, exact in the format.
[[nodiscard]] Case everyday(Pair pair, std::uint64_t seed, std::uint64_t index,
                            const Format& format = {});

/// Case `index` of what is hard for an arithmetic of few bits; the families take turns. Convex
/// pairs: close (signed gap of +-1e-4 to +-0.1 of the scene), touching, hair turn (face to face but
/// for a rotation by 1e-9 to 1e-2), coaxial, huge and tiny (sizes 2^20 apart), and 1e3, 1e5 and 1e7
/// away from the world's origin. Rays: grazing, sliver, huge and tiny, and as far away. Like
/// generate(), a function of the four arguments, exact in the format.
[[nodiscard]] Case hard(Pair pair, std::uint64_t seed, std::uint64_t index,
                        const Format& format = {});

namespace detail {
[[nodiscard]] Case convex_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                               const Format& format);
[[nodiscard]] Case ray_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                            const Format& format);
[[nodiscard]] Case hard_convex_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                                    const Format& format);
[[nodiscard]] Case hard_ray_case(Pair pair, std::uint64_t seed, std::uint64_t index,
                                 const Format& format);
// Directed families of generate(), which take turns at odd indices, and families of the others.
inline constexpr std::uint64_t kConvexFamilies = 14, kRayFamilies = 12, kEverydayFamilies = 8,
                               kHardConvexFamilies = 8, kHardRayFamilies = 6;
}  // namespace detail

}  // namespace cde::oracle
