// SPDX-License-Identifier: Apache-2.0
#include "page/time_split.hpp"

#include <algorithm>

namespace cde::cli {

TimeSplit& TimeSplit::operator+=(const TimeSplit& other) {
  dma += other.dma, compute += other.compute, memory += other.memory, bus += other.bus;
  return *this;
}

std::array<double, 4> parts(const TimeSplit& split) {
  return {split.dma, split.compute, split.memory, split.bus};
}

TimeSplit time_split(const QueryFrame& frame, double clock_hz) {
  constexpr double kPs = 1e-12;
  const ModelledTime t = frame.time();
  const double engine = kPs * static_cast<double>(t.engine);
  const double waits = std::min(static_cast<double>(frame.counters.bubbles) / clock_hz, engine);
  return {.dma = kPs * static_cast<double>(t.load),
          .compute = engine - waits,
          .memory = waits + kPs * static_cast<double>(t.write_back),
          .bus = kPs * static_cast<double>(t.download + t.registers)};
}

}  // namespace cde::cli
