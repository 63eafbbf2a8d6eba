// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "cde/reference/pipes/cylinder/evaluator.hpp"

/// @file
/// Selects the phase of each pass of a pair: counters, no arithmetic.
namespace cde::reference::cylinder {

/// Iterations of a pair. One pass is one evaluation of g and one cycle of the pipe.
struct Iterations {
  int samples = 8;  ///< M: directions sampled on each circle (box, triangle): 4, 8 or 16
  int circle = 8;   ///< K1: steps on each circle
  int free = 8;     ///< K2: Newton steps on each free track (cylinder-cylinder)
};

enum class Phase {
  kFrame,    ///< box, triangle: face normals and edges
  kAxis,     ///< box, triangle: B's axis
  kCentre,   ///< cylinder: the line of centres, and its part perpendicular to each axis
  kVertex,   ///< box, triangle: from each vertex to the nearest point of B's surface
  kCap,      ///< circle: the direction nearest the other cylinder's axis
  kSide,     ///< circle: perpendicular to both axes
  kBeside,   ///< circle: just beside that; completes the bracket
  kSample,   ///< circle: fixed directions
  kRefine,   ///< circle: a step inside the bracket
  kPole,     ///< free track: a cap axis
  kStart,    ///< free track: the normal beside the axis, or the best so far
  kNewton,   ///< free track: a step
  kTouch,    ///< the best normal again: witness points; track 0 uses the features that it touches
  kProject,  ///< witness points: alternating projections; track 1 uses all that it nearly touches
  kDone
};

/// Steps of alternating projection at the end: first between the features that the normal touches,
/// then between those that it nearly touches. The last two steps are between the solids.
inline constexpr std::array<int, 2> kProjections = {4, 7};

/// Index of the second steps from which solids that are clearly apart are not shifted.
inline constexpr int kUnshifted = kProjections[1] - 4;

struct Pass {
  Phase phase;
  int track;  ///< circle or free track
  int index;  ///< within the phase
};

/// Counts through a schedule: `take` tells whether the pass is one of the next `count`.
class Countdown {
 public:
  explicit Countdown(int k) : left_(k) {}
  bool take(int count) {
    if (left_ < count) return true;
    left_ -= count;
    return false;
  }
  [[nodiscard]] int left() const { return left_; }

 private:
  int left_;
};

/// Passes of the witness points, after the passes of the search.
[[nodiscard]] inline Pass witness_pass(Countdown k) {
  for (int t = 0; t < 2; ++t) {
    if (k.take(1)) return {Phase::kTouch, t, 0};
    if (k.take(kProjections[t])) return {Phase::kProject, t, k.left()};
  }
  return {Phase::kDone, 0, 0};
}

/// Cylinder-cylinder: 3 + 2 (3 + K1) + 2 (2 + K2) + 1 + K2 evaluations.
[[nodiscard]] inline Pass cylinder_pass(const Iterations& iterations, Countdown k) {
  if (k.take(3)) return {Phase::kCentre, 0, k.left()};
  for (int t = 0; t < 2; ++t) {
    if (k.take(1)) return {Phase::kCap, t, 0};
    if (k.take(1)) return {Phase::kSide, t, 0};
    if (k.take(1)) return {Phase::kBeside, t, 0};
    if (k.take(iterations.circle)) return {Phase::kRefine, t, k.left()};
  }
  for (int t = 0; t < 3; ++t) {
    if (t < 2 && k.take(1)) return {Phase::kPole, t, 0};
    if (k.take(1)) return {Phase::kStart, t, 0};
    if (k.take(iterations.free)) return {Phase::kNewton, t, k.left()};
  }
  return witness_pass(k);
}

/// 12 (box) or 8 (triangle) + 3 (2 + M + K1) evaluations.
[[nodiscard]] inline Pass polyhedron_pass(bool box, const Iterations& iterations, Countdown k) {
  if (k.take(box ? 3 : 4)) return {Phase::kFrame, 0, k.left()};
  if (k.take(1)) return {Phase::kAxis, 0, 0};
  if (k.take(box ? 8 : 3)) return {Phase::kVertex, 0, k.left()};
  for (int t = 0; t < 3; ++t) {
    if (k.take(1)) return {Phase::kSide, t, 0};
    if (k.take(iterations.samples + 1)) return {Phase::kSample, t, k.left()};
    if (k.take(iterations.circle)) return {Phase::kRefine, t, k.left()};
  }
  return witness_pass(k);
}

/// Pass k of a pair, from 0.
[[nodiscard]] inline Pass pass(Body body, const Iterations& iterations, int k) {
  return body == Body::kCylinder ? cylinder_pass(iterations, Countdown(k))
                                 : polyhedron_pass(body == Body::kBox, iterations, Countdown(k));
}

/// Evaluations of g by the search.
[[nodiscard]] inline int evaluations(Body body, const Iterations& iterations) {
  int k = 0;
  while (pass(body, iterations, k).phase != Phase::kTouch) ++k;
  return k;
}

/// Passes until the pair leaves: the search, two more evaluations, and the projections.
[[nodiscard]] inline int passes(Body body, const Iterations& iterations) {
  return evaluations(body, iterations) + 2 + kProjections[0] + kProjections[1];
}

}  // namespace cde::reference::cylinder
