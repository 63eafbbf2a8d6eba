#include "time_split.hpp"

#include <algorithm>

namespace cde::cli {

TimeSplit& TimeSplit::operator+=(const TimeSplit& other) {
  dma += other.dma, compute += other.compute, memory += other.memory, bus += other.bus;
  return *this;
}

std::array<double, 4> parts(const TimeSplit& split) {
  return {split.dma, split.compute, split.memory, split.bus};
}

TimeSplit time_split(const QueryFrame& frame, Mode mode, Pair pair, double clock_hz) {
  const Counters& c = frame.counters;
  // In the streaming modes a pipe stalls while a full ring is read. Rings of cylinder pairs and
  // facet units stall too, because they work.
  const bool streaming = mode == Mode::kAll || mode == Mode::kHits;
  const std::uint64_t unread =
      streaming && !has_budget(pair) && !has_facets(pair) ? c.stalls : 0;
  const std::uint64_t waits = std::min(c.bubbles + unread, c.cycles);
  const auto time = [clock_hz](std::uint64_t clocks) {
    return static_cast<double>(clocks) / clock_hz;
  };
  return {.dma = time(frame.secondary_clocks + frame.primary_clocks),
          .compute = time(c.cycles - waits),
          .memory = time(std::min(c.bubbles, waits) + c.writeback),
          .bus = time(waits - std::min(c.bubbles, waits) + frame.download_clocks)};
}

}  // namespace cde::cli
