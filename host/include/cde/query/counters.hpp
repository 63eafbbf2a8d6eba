// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// Where the modelled time of a packet went: loading it, its pass, its records. Picoseconds, of
/// both clocks and with the bus, as Board::time_ps() counts them. The parts do not overlap and
/// nothing is left out.
struct ModelledTime {
  std::uint64_t load = 0;        ///< primaries into the register file
  std::uint64_t engine = 0;      ///< waiting for the pass, up to its interrupt
  std::uint64_t write_back = 0;  ///< of that wait, clocks that wrote the kept records to SRAM
  std::uint64_t download = 0;    ///< transfers of records. In modes all and hits the pass goes on
                                 ///< meanwhile, as far as the ring of records has room
  std::uint64_t registers = 0;   ///< accesses to registers: settings, go, status, counters

  ModelledTime& operator+=(const ModelledTime& other);
  [[nodiscard]] std::uint64_t total() const {
    return load + engine + write_back + download + registers;
  }
};

/// What the card counted during passes. One clock is one period of the core clock.
struct Counters {
  std::uint64_t cycles = 0;           ///< clocks from go to done, without writeback
  std::uint64_t writeback = 0;        ///< clocks that wrote the kept records to SRAM
  std::uint64_t rows = 0;             ///< rows of `lanes` pairs that entered the pipe
  std::uint64_t stalls = 0;           ///< clocks the pipe waited for room for records, a cylinder
                                      ///< pipe's ring for a free slot, or facets for their turns
  std::uint64_t bubbles = 0;          ///< clocks the pipe waited for a triangle
  std::uint64_t open = 0;             ///< BoardConfig::verdicts: pairs that narrow lanes left open
  std::uint64_t bad_primaries = 0;    ///< rays refused as bad input
  std::uint64_t corrected_words = 0;  ///< BoardConfig::ecc: words of DDR read with one wrong bit
  std::uint64_t bad_secondaries = 0;  ///< triangles refused as bad input
  std::uint64_t secondaries = 0;      ///< triangles swept (mode any may end early)
  std::uint64_t pairs = 0;            ///< ray-triangle tests: triangles swept times unmasked rays
  // Of passes through a hierarchy, whose `pairs` are those of the leaves that rays met:
  std::uint64_t nodes = 0;          ///< read
  std::uint64_t leaves = 0;         ///< visited
  std::uint64_t deepest = 0;        ///< groups on a ray's stack at a time, at most
  std::uint64_t records = 0;        ///< records written, all of which were downloaded
  std::uint64_t upload_clocks = 0;  ///< core clocks of loading the rays
  std::uint64_t total_clocks = 0;   ///< everything: loading, pass, download, register accesses
  ModelledTime time;                ///< the same, and where it went

  Counters& operator+=(const Counters& other);
  /// Time of the passes (cycles and writeback) at a core clock.
  [[nodiscard]] double modelled_seconds(double clock_hz) const {
    return static_cast<double>(cycles + writeback) / clock_hz;
  }
};

}  // namespace cde
