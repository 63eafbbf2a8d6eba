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

namespace {

/// A template, so that only the branch is compiled for which QueryFrame has the fields.
template <class Frame>
TimeSplit split_of(const Frame& frame, Mode mode, Pair pair, double clock_hz) {
  const Counters& c = frame.counters;
  const auto time = [clock_hz](std::uint64_t clocks) {
    return static_cast<double>(clocks) / clock_hz;
  };
  if constexpr (requires { frame.secondary_ps; }) {
    const auto& t = frame.counters.time;  // picoseconds
    const double engine = 1e-12 * static_cast<double>(t.engine);
    const double waits = std::min(time(c.bubbles), engine);
    return {.dma = 1e-12 * static_cast<double>(frame.secondary_ps + t.load),
            .compute = engine - waits,
            .memory = waits + 1e-12 * static_cast<double>(t.write_back),
            .bus = 1e-12 * static_cast<double>(t.download + t.registers)};
  } else {
    // In the streaming modes a pipe stalls while a full ring is read. Rings of cylinder pairs and
    // facet units stall too, because they work.
    const bool streaming = mode == Mode::kAll || mode == Mode::kHits;
    const std::uint64_t unread = streaming && !has_budget(pair) && !has_facets(pair) ? c.stalls : 0;
    const std::uint64_t waits = std::min(c.bubbles + unread, c.cycles);
    return {.dma = time(frame.secondary_clocks + frame.primary_clocks),
            .compute = time(c.cycles - waits),
            .memory = time(std::min(c.bubbles, waits) + c.writeback),
            .bus = time(waits - std::min(c.bubbles, waits) + frame.download_clocks)};
  }
}

}  // namespace

TimeSplit time_split(const QueryFrame& frame, Mode mode, Pair pair, double clock_hz) {
  return split_of(frame, mode, pair, clock_hz);
}

}  // namespace cde::cli
