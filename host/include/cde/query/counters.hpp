// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// Modelled time of a packet, in picoseconds as Board::time_ps() counts them, with both clocks and
/// the bus. The parts do not overlap, and together they cover all of it.
struct ModelledTime {
  std::uint64_t load = 0;        ///< writing primaries to the register file
  std::uint64_t engine = 0;      ///< waiting for the pass until its interrupt
  std::uint64_t write_back = 0;  ///< part of `engine`: cycles that wrote the kept records to SRAM
  std::uint64_t download = 0;    ///< transfers of records. In modes all and hits the pass continues
                                 ///< meanwhile while the record ring has space
  std::uint64_t registers = 0;   ///< register accesses: settings, go, status, counters

  ModelledTime& operator+=(const ModelledTime& other);
  [[nodiscard]] std::uint64_t total() const {
    return load + engine + write_back + download + registers;
  }
};

/// What the card counted during passes, in cycles of the core clock.
struct Counters {
  std::uint64_t cycles = 0;     ///< cycles from go to done, without writeback
  std::uint64_t writeback = 0;  ///< cycles that wrote the kept records to SRAM
  std::uint64_t rows = 0;       ///< rows of `lanes` pairs that entered the pipe
  std::uint64_t stalls = 0;   ///< cycles in which the pipe waited for record space, for a free slot
                              ///< of an iterative pipeline, or for the interval of a SAT pipe
  std::uint64_t bubbles = 0;  ///< cycles in which the pipe waited for a secondary
  /// `BoardConfig::filter`: pairs that the certified filter left uncertain.
  std::uint64_t uncertain = 0;
  std::uint64_t bad_primaries = 0;    ///< primaries refused as bad input
  std::uint64_t corrected_words = 0;  ///< BoardConfig::ecc: words read from DDR with one wrong bit
  std::uint64_t bad_secondaries = 0;  ///< secondaries refused as bad input
  std::uint64_t secondaries = 0;      ///< secondaries streamed (mode any may end early)
  std::uint64_t pairs = 0;  ///< pair tests: secondaries streamed times unmasked primaries.
  // BVH passes, whose `pairs` count the pairs of the visited leaves:
  std::uint64_t nodes = 0;         ///< nodes read
  std::uint64_t leaves = 0;        ///< leaves visited
  std::uint64_t cached_nodes = 0;  ///< reads of nodes that are not pinned (BoardConfig::node_cache)
  std::uint64_t fetched_nodes = 0;  ///< nodes that a cache fetched from DDR, 72 bytes each
  std::uint64_t deepest = 0;        ///< most groups on a ray's stack at a time
  std::uint64_t records = 0;        ///< records written, all of which were downloaded
  std::uint64_t upload_cycles = 0;  ///< core cycles of loading the primaries
  std::uint64_t total_cycles = 0;  ///< core cycles of loading, pass, download and register accesses
  ModelledTime time;               ///< modelled time of the same, by part

  Counters& operator+=(const Counters& other);
  /// Seconds of the passes (cycles and writeback) at a core clock.
  [[nodiscard]] double modelled_seconds(double clock_hz) const {
    return static_cast<double>(cycles + writeback) / clock_hz;
  }
};

}  // namespace cde
