// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cde/wave/blackouts.hpp"
#include "cde/wave/handshakes.hpp"
#include "cde/wave/stalls.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {

/// Activity of a signal in a window.
struct Activity {
  View view;
  std::uint64_t changes = 0, toggles = 0;
  std::uint64_t high = 0;  ///< time at 1, for one bit
  std::uint64_t quiet = 0, quiet_from = 0;
  std::uint64_t last = 0;  ///< time of the last change
  std::string value;
  std::string next;       ///< value of the current instant
  bool waits = false;     ///< the current instant is not settled yet
  std::uint64_t now = 0;  ///< time of the current instant
  /// The current change comes from the simulation, not from $dumpoff or $dumpon.
  bool counts = true;
  bool bits = true;                             ///< the signal has bits
  const std::vector<Blackout>* dark = nullptr;  ///< times that do not count

  void begin(std::uint64_t time, std::string_view now) {
    last = quiet_from = time;
    value = view.bits(now);
    if (view.signal.event && value == "1" && (dark == nullptr || !is_dark(*dark, time))) ++changes;
  }
  /// `of_run`: the change comes from the simulation, not from $dumpoff or $dumpon.
  void change(std::uint64_t time, std::string_view whole, bool of_run) {
    if (waits && time != now) settle();
    next = view.bits(whole);
    now = time;
    counts = of_run;
    waits = true;
  }
  /// Ends an instant; changes.hpp defines a change.
  void settle() {
    if (!waits) return;
    waits = false;
    if (next == value && !view.signal.event) return;
    if (counts) ++changes;
    if (counts && bits && !view.signal.event && next.size() == value.size()) {
      // Branch-free: with large files most of the time is spent here.
      unsigned flips = 0;
      for (std::size_t i = 0; i < next.size(); ++i)
        flips += static_cast<unsigned>(next[i] != value[i]) &
                 static_cast<unsigned>((next[i] | 1) == '1') &
                 static_cast<unsigned>((value[i] | 1) == '1');
      toggles += flips;
    }
    stretch(now);
    value.swap(next);
    last = now;
  }
  /// Ends the stretch since the last change.
  void stretch(std::uint64_t time) {
    const std::uint64_t length = time - last - (dark != nullptr ? dark_time(*dark, last, time) : 0);
    if (length > quiet) {
      quiet = length;
      quiet_from = last;
    }
    if (view.width == 1 && value == "1" && !view.signal.event) high += length;
  }
};

/// Use of a handshake.
struct Use {
  std::uint64_t cycles = 0, transferred = 0, stalled = 0, idle = 0, unknown = 0, address = 0;
  std::uint64_t longest = 0, longest_time = 0;
  std::uint64_t run = 0, run_time = 0;  ///< of the current stall
  bool framed = false;                  ///< PCI: frame in the cycle before
};

/// Cycles of a pipe that has only a valid signal.
struct Bubbles {
  std::uint64_t cycles = 0, valid = 0, empty = 0, longest = 0, longest_time = 0;
  std::uint64_t gap = 0, gap_time = 0;  ///< the current gap, which may turn out to be the end
  std::uint64_t first = 0, last = 0;    ///< times of the first and the last valid cycle
};

/// Measures how busy signals, handshakes and pipes are between two times. Cycles sample the values
/// just before their rising edges, as flip-flops do. An edge at the very begin is outside the
/// window. Times for which the simulation wrote no changes ($dumpoff) do not count.
class Measure {
 public:
  Measure(Trace& trace, Flows flows, std::vector<View> views);
  void run(Trace& trace, std::uint64_t from, std::uint64_t to);

  std::vector<Handshake> handshakes;
  std::vector<PipeValid> pipes;
  std::vector<Use> uses;         ///< of the handshakes
  std::vector<Bubbles> bubbles;  ///< of the pipes
  std::vector<Activity> signals;
  std::vector<Stall> stalls;
  std::vector<Blackout> dark;  ///< within the window; these times do not count

 private:
  /// A clock and the signals that it samples.
  struct Domain {
    std::uint32_t handle = 0;
    std::uint64_t cycles = 0;
    std::vector<std::size_t> handshakes, pipes;
  };
  void sample(std::uint32_t handle) { now_[handle] = 'x'; }
  Domain& domain(std::uint32_t clock);
  [[nodiscard]] char level(const HandshakeWire& w) const;
  void step(std::uint64_t time, bool begins);
  void cycle(Domain& d, std::uint64_t time);
  void handshake(std::size_t i, std::uint64_t time, std::uint64_t number);
  void pci(std::size_t i, std::uint64_t time, std::uint64_t number);
  void stall(std::size_t i, std::uint64_t time, std::uint64_t number);
  void end_stall(std::size_t i);
  void pipe(std::size_t i, std::uint64_t time);

  std::vector<std::vector<std::size_t>> of_;  ///< signals by handle
  std::vector<char> now_;                     ///< sampled value, reduced to a bit; 0: not sampled
  std::vector<std::pair<std::uint32_t, char>> waiting_;
  std::vector<Domain> domains_;
  std::vector<std::size_t> open_;  ///< current stall of each handshake
};

}  // namespace cde::wave
