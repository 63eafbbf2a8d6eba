// SPDX-License-Identifier: Apache-2.0
#include "moving_cases.hpp"

#include <Eigen/Geometry>

namespace cde::testing {

BoardConfig config_of(const MovingBoard& kind, Transformer transform) {
  BoardConfig c;
  c.lanes = kind.lanes;
  c.arithmetic = kind.arithmetic;
  c.pairs = kind.pairs;
  c.swap = true;
  c.transform = transform;
  c.latency.add += kind.slower;
  c.latency.mul += 2 * kind.slower;
  c.latency.compare += kind.slower;
  c.ddr_slots = 4000;
  c.sram_records = 1024;
  return c;
}

Eigen::Matrix3f rotation(Random& random) {
  const Eigen::Vector3d axis = random.in_box(1).cast<double>().normalized();
  return Eigen::AngleAxisd(random.in(-3, 3), axis).toRotationMatrix().cast<float>();
}

Transform motion(Random& random) {
  return {rotation(random), random.in_box(3)};
}

Eigen::Vector3f direction(Random& random) {
  return random.in_box(1).cast<double>().normalized().cast<float>();
}

std::vector<Object> objects(Random& random, std::uint32_t slots, std::size_t count, bool boxes) {
  std::vector<Object> all;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t first = random.below(slots);
    const std::uint32_t most = random.below(2) == 0 ? 1 : slots - first;
    Transform transform = motion(random);
    if (boxes) transform.rotation.setIdentity();
    if (random.below(16) == 0) transform.translation.x() = 0x1p40f;
    all.push_back({first, 1 + random.below(most), transform});
  }
  return all;
}

MovingRays rays(Random& random, std::size_t primaries, std::size_t secondaries) {
  MovingRays all;
  for (std::size_t i = 0; i < primaries; ++i) all.primaries.push_back(shape<Ray>(random));
  for (std::size_t i = 0; i < secondaries; ++i) all.secondaries.push_back(shape<Triangle>(random));
  return all;
}

}  // namespace cde::testing
