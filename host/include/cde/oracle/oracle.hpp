// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Independent oracles for the pairs. They define the right results by arithmetic and algorithms
/// that share nothing with the pipes or their reference. CMake target `cde::oracle`.
///
///     #include "cde/oracle/oracle.hpp"
///     namespace oracle = cde::oracle;
///     for (std::uint64_t i = 0; i < 20000; ++i) {
///       const oracle::Case c = oracle::generate(oracle::Pair::kObbObb, kSeed, i);
///       const oracle::Result result = ...;              // F, T, CP, n of the words c.a and c.b
///       const oracle::Decision v = oracle::check(c.shape_a(), c.shape_b(), result);
///       EXPECT_TRUE(v.ok()) << v.describe() << '\n' << c.describe();
///       band += v.in_band, excused += v.excused;        // count and print these
///     }
///
/// For a format other than binary32, pass its unit roundoff: check(a, b, result, {.u = 0x1p-11}).
/// The cylinder pairs, whose s_K <= s is a lower bound, are checked with {.lower_bound = true}. For
/// them, publish the distribution of v.shortfall and the number of v.false_hit.
///
/// Headers:
/// - shapes.hpp: shapes in binary64, support functions, distances, the measures S and L.
/// - signed_distance.hpp: the signed distance as a certified interval, by branch and bound over
///   normals.
/// - certificate.hpp: check() with conditions c1, c2, c3 and F for pairs of solids.
/// - rays.hpp: exact results of the three ray pairs, with their distance from flipping.
/// - cases.hpp: generate(pair, seed, i), operands near the decision and of directed families;
///   everyday(pair, seed, i), everyday scenes, where ties are the rule.
/// - scene.hpp: random scenes of bodies at rest on a floor and on each other.
///
/// At the default tolerance of 1e-8 S, signed_distance() takes tens of microseconds for a pair of
/// boxes or triangles, and about 0.1 ms for a pair with a cylinder.
#include "cde/oracle/cases.hpp"
#include "cde/oracle/certificate.hpp"
#include "cde/oracle/rays.hpp"
#include "cde/oracle/shapes.hpp"
#include "cde/oracle/signed_distance.hpp"
