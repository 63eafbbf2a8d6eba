// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

/// @file
/// Shapes and pairs of shapes: the tables of rtl/contract/pairs_pkg.sv in C++, in the order of the
/// codes. cde/geometry/pair.hpp builds on them.
namespace cde {

/// What a primary or secondary is.
enum class Shape : unsigned { kRay, kTriangle, kSphere, kAabb, kPlane, kCylinder, kObb };
inline constexpr unsigned kShapes = 7;
inline constexpr unsigned kShapeBits = 6;  ///< of a code: up to 64 shapes
inline constexpr unsigned kShapeCodes = 1u << kShapeBits;
inline constexpr unsigned kWordsBits = 6;  ///< of the number of words of a shape

/// Meaning of a word of a slot.
enum class WordKind : unsigned {
  kCoordinate,  ///< a length of either sign
  kSize,        ///< a length above zero
  kDirection,   ///< ray direction: each is a length in units of its own
  kInterval,    ///< tmin, tmax: lengths in the ray's units
  kPure,        ///< component of a unit vector or rotation
  kNone = 7     ///< the shape has no such word
};

/// The pairs, primary first.
enum class Pair : unsigned {
  kRayTriangle,
  kObbObb,
  kTriangleAabb,
  kTriangleObb,
  kSphereSphere,
  kTriangleSphere,
  kRayCylinder,
  kTriangleCylinder,
  kCylinderCylinder,
  kObbCylinder,
  kObbPlane,
  kRaySphere,
  kSphereObb,
  kSpherePlane,
  kTriangleTriangle,
};
inline constexpr unsigned kPairs = 15;
inline constexpr unsigned kPairBits = 6;  ///< of a code: up to 63 pairs
inline constexpr unsigned kPairCodes = 1u << kPairBits;
inline constexpr unsigned kNoPair = kPairCodes - 1;  ///< code that means no pair
static_assert(kPairs <= 31, "the parameter PAIRS of a card is an int above zero");

/// Ray-triangle algorithms.
enum class Algorithm : unsigned { kMoller, kBadouel, kPluecker, kWatertight };
/// The algorithm of casts, pictures and scenes that name none. No ray leaks through an edge or
/// vertex that triangles share.
inline constexpr Algorithm kLeakFree = Algorithm::kWatertight;
inline constexpr unsigned kAlgorithms = 4;

/// Objects that the transformer moves: parameter TRANSFORM of a card.
inline constexpr unsigned kTransformNone = 0;
inline constexpr unsigned kTransformSecondaries = 1;
inline constexpr unsigned kTransformBoth = 2;

namespace contract {

inline constexpr unsigned kMostWords = 15;  ///< most words of a shape
struct ShapeRow {
  std::string_view name;
  unsigned words;
  std::string_view kinds;  ///< per word: c coordinate, s size, d direction, i interval, p pure
};
inline constexpr std::array<ShapeRow, kShapes> kShapeTable{{{"ray", 8, "cccdddii"},
                                                            {"triangle", 9, "ccccccccc"},
                                                            {"sphere", 4, "cccs"},
                                                            {"aabb", 6, "cccccc"},
                                                            {"plane", 4, "pppc"},
                                                            {"cylinder", 8, "cccpppss"},
                                                            {"obb", 15, "cccsssppppppppp"}}};

struct PairRow {
  std::string_view name;
  Shape primary, secondary;
};
inline constexpr std::array<PairRow, kPairs> kPairTable{
    {{"ray-triangle", Shape::kRay, Shape::kTriangle},
     {"obb-obb", Shape::kObb, Shape::kObb},
     {"triangle-aabb", Shape::kTriangle, Shape::kAabb},
     {"triangle-obb", Shape::kTriangle, Shape::kObb},
     {"sphere-sphere", Shape::kSphere, Shape::kSphere},
     {"triangle-sphere", Shape::kTriangle, Shape::kSphere},
     {"ray-cylinder", Shape::kRay, Shape::kCylinder},
     {"triangle-cylinder", Shape::kTriangle, Shape::kCylinder},
     {"cylinder-cylinder", Shape::kCylinder, Shape::kCylinder},
     {"obb-cylinder", Shape::kObb, Shape::kCylinder},
     {"obb-plane", Shape::kObb, Shape::kPlane},
     {"ray-sphere", Shape::kRay, Shape::kSphere},
     {"sphere-obb", Shape::kSphere, Shape::kObb},
     {"sphere-plane", Shape::kSphere, Shape::kPlane},
     {"triangle-triangle", Shape::kTriangle, Shape::kTriangle}}};
inline constexpr std::array<std::string_view, kAlgorithms> kAlgorithmNames{
    "moller", "badouel", "pluecker", "watertight"};

/// Sets of pairs: bit p stands for pair p.
constexpr std::uint32_t set_of(std::initializer_list<Pair> pairs) {
  std::uint32_t set = 0;
  for (const Pair pair : pairs) set |= 1u << static_cast<unsigned>(pair);
  return set;
}
constexpr bool has(std::uint32_t set, Pair pair) {
  return (set >> static_cast<unsigned>(pair) & 1) != 0;
}
/// All pairs of a shape. Named configurations: PAIRS=everything, rays, solids, spheres of
/// verilator/model_builder.
constexpr std::uint32_t set_with(Shape shape) {
  std::uint32_t set = 0;
  for (unsigned p = 0; p < kPairs; ++p)
    if (kPairTable[p].primary == shape || kPairTable[p].secondary == shape) set |= 1u << p;
  return set;
}
inline constexpr std::uint32_t kSetEverything = (1u << kPairs) - 1;
inline constexpr std::uint32_t kSetRays = set_with(Shape::kRay);
inline constexpr std::uint32_t kSetSolids = kSetEverything & ~kSetRays;  ///< T is a signed distance
inline constexpr std::uint32_t kSetSpheres = set_with(Shape::kSphere);
/// Pairs with an iterative pipeline, whose work is set by a number of iterations.
inline constexpr unsigned kIterativeRows = 1024;  ///< more rows than an iterative pipeline can hold
inline constexpr std::uint32_t kIterativePairs =
    set_of({Pair::kTriangleCylinder, Pair::kCylinderCylinder, Pair::kObbCylinder});
/// Pairs that are tested on candidate axes (SAT), whose units can be shared.
inline constexpr std::uint32_t kSatPairs =
    set_of({Pair::kObbObb, Pair::kTriangleAabb, Pair::kTriangleObb});
/// Pairs that have the box rule as an option.
inline constexpr std::uint32_t kBoxPairs = set_of({Pair::kRayTriangle});
/// Pairs whose signed distance is at least the distance of the boxes, with the box rule.
inline constexpr std::uint32_t kBoundPairs =
    set_of({Pair::kTriangleSphere, Pair::kTriangleAabb, Pair::kTriangleObb, Pair::kTriangleTriangle,
            Pair::kSphereObb, Pair::kObbObb});
/// Pairs that traverse a BVH without further options (bvh_pkg.sv).
inline constexpr std::uint32_t kPlainPairs = set_of({Pair::kRaySphere, Pair::kSphereSphere});
/// Pairs with a certified filter: narrow lanes propose misses, a wide sum proves them
/// (`BoardConfig::filter`).
inline constexpr std::uint32_t kFilterPairs =
    set_of({Pair::kSphereSphere, Pair::kSphereObb, Pair::kTriangleSphere, Pair::kTriangleAabb,
            Pair::kTriangleObb, Pair::kObbObb});
/// Pairs with a short pipe latency.
inline constexpr std::uint32_t kShortPairs =
    set_of({Pair::kRayTriangle, Pair::kRayCylinder, Pair::kRaySphere, Pair::kSphereSphere,
            Pair::kSpherePlane});
/// Pairs that multiply four lengths. Their operands are scaled to about 1 in every format.
inline constexpr std::uint32_t kScaledPairs =
    kIterativePairs | kSatPairs | set_of({Pair::kTriangleSphere, Pair::kTriangleTriangle});

constexpr std::size_t words(Shape shape) {
  return kShapeTable[static_cast<std::size_t>(shape)].words;
}

constexpr WordKind word_kind(std::string_view kinds, std::size_t word) {
  switch (word < kinds.size() ? kinds[word] : ' ') {
    case 'c':
      return WordKind::kCoordinate;
    case 's':
      return WordKind::kSize;
    case 'd':
      return WordKind::kDirection;
    case 'i':
      return WordKind::kInterval;
    case 'p':
      return WordKind::kPure;
    default:
      return WordKind::kNone;
  }
}
constexpr WordKind word_kind(Shape shape, std::size_t word) {
  return word_kind(kShapeTable[static_cast<std::size_t>(shape)].kinds, word);
}

}  // namespace contract
}  // namespace cde
