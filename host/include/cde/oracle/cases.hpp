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

/// The contract lists the pairs and their shapes. Their meaning is defined here.
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

/// Two valid operands as the words of their slots, so that hardware, reference and oracle get
/// identical numbers.
struct Case {
  Pair pair;
  std::uint64_t seed, index;
  const char* family;        ///< its family: "near contact", "aligned", ...
  std::vector<double> a, b;  ///< exact in the format of the operands

  [[nodiscard]] Shape shape_a() const { return shape_from_words(primary(pair), a); }
  [[nodiscard]] Shape shape_b() const { return shape_from_words(secondary(pair), b); }
  [[nodiscard]] Ray ray() const { return ray_from_words(a); }
  /// Pair, seed, index, family and all words in hexfloat: enough to repeat the case.
  [[nodiscard]] std::string describe() const;
};

/// Case `index` of a pair. It depends only on the four arguments. All words are exact in the
/// format.
///
/// Even indices are near the decision. Convex pairs have generic shapes and a signed distance of
/// +-1e-7 to +-1e-3 of the scene. Other formats have the same multiple of their unit roundoff
/// (small_offset). A tenth of the scenes are scaled by up to 2^+-10. Rays are aimed past the
/// silhouette, an edge or a rim by as little.
///
/// Odd indices cycle through the directed families. The families of rays are listed in
/// ray_cases.cpp. The families of convex pairs are:
/// - random, deep, concentric, containment;
/// - aligned: exact face-to-face contact, +-2^-10 and +-16 u;
/// - needles and plates;
/// - no area: triangles that are a segment or a point;
/// - half turns, and turns tilted by 1e-7 to 1e-2;
/// - parallel and perpendicular axes, and a normal within 2 degrees of a cap axis or face normal;
/// - sizes a thousandfold apart;
/// - far from the world's origin: 10, 1e3, 1e5, and at most 6e-3 / u.
[[nodiscard]] Case generate(Pair pair, std::uint64_t seed, std::uint64_t index,
                            const Format& format = {});

/// Case `index` of everyday scenes, where ties are the rule. Like generate(), it depends only on
/// the four arguments and is exact in the format. Many cases of the first four families are turned
/// together or tilted by 1e-7 to 1e-2. The families are:
/// - aligned: boxes, triangles and cylinders along the axes, coordinates whole or real;
/// - tied: one or two coordinates of the centres are equal;
/// - stacked: face to face, in contact or slightly off;
/// - flat: triangles without area or thinner than rounding, plates; rays edge-on;
/// - scaled: by a power of two;
/// - scene: two neighbours of a random scene (scene.hpp).
[[nodiscard]] Case everyday(Pair pair, std::uint64_t seed, std::uint64_t index,
                            const Format& format = {});

/// Case `index` of families that are hard for arithmetic of few bits. Like generate(), it depends
/// only on the four arguments and is exact in the format. Families of convex pairs:
/// - close: signed distance of +-1e-4 to +-0.1 of the scene;
/// - touching, coaxial;
/// - hair turn: face to face except for a rotation by 1e-9 to 1e-2;
/// - huge and tiny: sizes 2^20 apart;
/// - 1e3, 1e5 and 1e7 away from the world's origin.
///
/// Families of rays: grazing, sliver, huge and tiny, and equally far away.
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
// Number of families: directed ones of generate() at odd indices, and the other families.
inline constexpr std::uint64_t kConvexFamilies = 14, kRayFamilies = 12, kEverydayFamilies = 8,
                               kHardConvexFamilies = 8, kHardRayFamilies = 6;
}  // namespace detail

}  // namespace cde::oracle
