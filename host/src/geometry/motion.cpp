// SPDX-License-Identifier: Apache-2.0
#include "cde/geometry/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cde {
namespace {

/// The finaliser of SplitMix64.
std::uint64_t scramble(std::uint64_t h) {
  h += 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

Pose posed(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& position) {
  Pose p = Pose::Identity();
  p.linear() = rotation.toRotationMatrix();
  p.translation() = position;
  return p;
}

Eigen::Quaterniond turned(const Eigen::Vector3d& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

/// x mirrored at low and high until it lies between them.
double mirrored(double x, double low, double high) {
  if (low <= x && x <= high) return x;  // keeps every bit
  const double width = high - low;
  if (!(width > 0)) return low;
  const double phase = std::fmod(std::fabs(x - low), 2 * width);
  return phase <= width ? low + phase : high - (phase - width);
}

Eigen::Vector3d in_box(const RandomMotion& m, const Eigen::Vector3d& start, std::uint64_t member,
                       double seconds) {
  const Eigen::Vector3d free = start + random_direction(m.seed, 0, member) * m.speed * seconds;
  Eigen::Vector3d inside;
  for (int k = 0; k < 3; ++k) inside[k] = mirrored(free[k], m.min[k], m.max[k]);
  return inside;
}

Eigen::Quaterniond spun(const RandomMotion& m, std::uint64_t member, double seconds) {
  return turned(random_direction(m.seed, 1, member), m.spin * seconds);
}

/// The path's points as knots. With `loop` the first point follows the last.
Eigen::Vector3d on_path(const Path& path, double seconds) {
  const std::size_t n = path.points.size();
  if (n == 0) return Eigen::Vector3d::Zero();
  const std::size_t segments = path.loop ? n : n - 1;
  const auto point = [&](std::size_t i) -> const Eigen::Vector3d& { return path.points[i % n]; };
  std::vector<double> knots{0};
  for (std::size_t i = 0; i < segments; ++i)
    knots.push_back(knots.back() + (point(i + 1) - point(i)).norm());
  const double length = knots.back();
  const double share = seconds / path.duration;
  const double s = length * (path.loop ? share - std::floor(share) : std::clamp(share, 0.0, 1.0));
  std::size_t i = 0;
  while (i + 1 < segments && s > knots[i + 1]) ++i;
  const double span = knots[i + 1] - knots[i];
  const double u = span > 0 ? (s - knots[i]) / span : 0;
  if (!path.smooth) return point(i) + u * (point(i + 1) - point(i));

  // A tangent is the difference of the neighbours. At an open end it uses the end itself.
  const auto tangent = [&](std::size_t k) -> Eigen::Vector3d {
    const bool first = k == 0, last = k == segments;
    if (path.loop && (first || last)) {
      const double before = knots[segments] - knots[segments - 1], after = knots[1];
      return (point(1) - point(n - 1)) / (before + after);
    }
    const std::size_t low = first ? 0 : k - 1, high = last ? segments : k + 1;
    return (point(high) - point(low)) / (knots[high] - knots[low]);
  };
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * point(i) + (u3 - 2 * u2 + u) * span * tangent(i) +
         (3 * u2 - 2 * u3) * point(i + 1) + (u3 - u2) * span * tangent(i + 1);
}

Pose at_keyframes(const Keyframes& keys, double seconds) {
  const auto& frames = keys.frames;
  const double first = frames.front().time, last = frames.back().time;
  if (keys.loop && last > first && seconds > last)
    seconds = first + std::fmod(seconds - first, last - first);
  const auto after = std::upper_bound(frames.begin(), frames.end(), seconds,
                                      [](double t, const Keyframe& k) { return t < k.time; });
  if (after == frames.begin()) return posed(frames.front().rotation, frames.front().position);
  if (after == frames.end()) return posed(frames.back().rotation, frames.back().position);
  const Keyframe &a = *(after - 1), &b = *after;
  const double u = (seconds - a.time) / (b.time - a.time);
  return posed(a.rotation.slerp(u, b.rotation), a.position + u * (b.position - a.position));
}

template <class... F>
struct Cases : F... {
  using F::operator()...;
};
template <class... F>
Cases(F...) -> Cases<F...>;

bool turned_at_all(const Eigen::Matrix3d& rotation) {
  return !(rotation.array() == Eigen::Matrix3d::Identity().array()).all();
}

}  // namespace

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t n) {
  return scramble(scramble(scramble(seed) ^ stream) ^ n);
}

double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t n) {
  return static_cast<double>(random_bits(seed, stream, n) >> 11) * 0x1p-53;
}

Eigen::Vector3d random_direction(std::uint64_t seed, std::uint64_t stream, std::uint64_t n) {
  const std::uint64_t own = random_bits(seed, stream, n);
  // Draws points of the cube until one lies in the ball. These operations round the same on all
  // machines.
  for (std::uint64_t k = 0;; k += 3) {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i)
      v[i] = 2 * random_unit(own, 0, k + static_cast<std::uint64_t>(i)) - 1;
    const double square = v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
    if (square <= 1 && square > 1e-6) return v / std::sqrt(square);
  }
}

Pose pose(const Motion& motion, double seconds) {
  return std::visit(
      Cases{[](const Still& m) { return m.place; },
            [&](const Velocity& m) {
              const double speed = m.angular.norm();
              Pose p = m.place;
              if (speed > 0)
                p.linear() = turned(m.angular / speed, speed * seconds).toRotationMatrix() *
                             m.place.linear();
              p.translation() += m.linear * seconds;
              return p;
            },
            [&](const Path& m) { return posed(m.rotation, on_path(m, seconds)); },
            [&](const Keyframes& m) { return at_keyframes(m, seconds); },
            [&](const RandomMotion& m) {
              if (m.each) return Pose(Pose::Identity());
              Pose p = m.place;
              p.translation() = in_box(m, m.place.translation(), 0, seconds);
              if (m.spin != 0)
                p.linear() = spun(m, 0, seconds).toRotationMatrix() * m.place.linear();
              return p;
            }},
      motion);
}

Pose member_pose(const RandomMotion& m, const Eigen::Vector3d& centre, std::uint64_t member,
                 double seconds) {
  Pose p = Pose::Identity();
  if (m.spin != 0) p.linear() = spun(m, member, seconds).toRotationMatrix();
  p.translation() = in_box(m, centre, member, seconds) - p.linear() * centre;
  return p;
}

bool moves(const Motion& motion) {
  return std::visit(
      Cases{[](const Still&) { return false; },
            [](const Velocity& m) { return !m.linear.isZero(0) || !m.angular.isZero(0); },
            [](const Path&) { return true; },
            [](const Keyframes& m) { return m.frames.size() > 1; },
            [](const RandomMotion& m) { return (m.speed != 0 && m.min != m.max) || m.spin != 0; }},
      motion);
}

bool rotates(const Motion& motion) {
  return std::visit(
      Cases{
          [](const Still& m) { return turned_at_all(m.place.linear()); },
          [](const Velocity& m) { return !m.angular.isZero(0) || turned_at_all(m.place.linear()); },
          [](const Path& m) { return turned_at_all(m.rotation.toRotationMatrix()); },
          [](const Keyframes& m) {
            return std::any_of(m.frames.begin(), m.frames.end(), [](const Keyframe& k) {
              return turned_at_all(k.rotation.toRotationMatrix());
            });
          },
          [](const RandomMotion& m) { return m.spin != 0 || turned_at_all(m.place.linear()); }},
      motion);
}

}  // namespace cde
