// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/card/fault.hpp"
#include "cde/query/difference.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

namespace cde {

struct RunnerOptions {
  Check check = Check::kAll;
  std::filesystem::path trace = {};  ///< wave file; needs a board with trace
  TraceOptions waves = {};           ///< which waves
  /// With this, waves begin with a packet of a query in a frame, before its primaries are loaded,
  /// and end with it. Without it, waves begin with the first frame. `waves` counts from there.
  struct Packet {
    std::uint32_t frame = 0;
    std::size_t query = 0, number = 0;
  };
  std::optional<Packet> waves_of = {};
  /// Contents of that packet, reported before it is loaded: all primaries and secondaries of its
  /// query in front of the pipes. `counts` selects the pairs that count (empty: all).
  struct PacketContents {
    const Shapes &primaries, &secondaries;
    std::function<bool(std::uint32_t primary, std::uint32_t secondary)> counts;
  };
  std::function<void(const PacketContents&)> on_packet = {};
  std::chrono::duration<double> watchdog = std::chrono::hours(1);  ///< wall-clock limit per pass
  std::uint64_t deadline_cycles = 0;        ///< per pass; 0: several times the worst case
  std::vector<ScheduledFault> faults = {};  ///< each is injected once, in its frame
  /// Called from time to time with the frame and the share of the query's packets done. An
  /// exception ends the run and leaves the card ready.
  std::function<void(std::uint32_t frame, double share)> progress = {};
};

/// Figures of one query in one frame.
struct QueryFrame {
  Counters counters;  ///< sums over the packets. Records are counted for the query. Tests also
                      ///< include pairs that do not count (SceneQuery::self)
  std::uint64_t card_records = 0;  ///< records that the card wrote; more than the query's if pairs
                                   ///< of a shape with itself do not count
  std::uint64_t passes = 0;
  std::uint64_t secondary_words = 0;   ///< words written for this query: changed shapes, ranges of
                                       ///< objects, 12 words per object that the card moves
  std::uint64_t primary_words = 0;     ///< the same, in slots of whole beats
  std::uint64_t secondary_cycles = 0;  ///< core cycles of writing the secondaries
  std::uint64_t secondary_ps = 0;      ///< modelled picoseconds of writing the secondaries
  std::uint64_t primary_cycles = 0;    ///< core cycles of loading primaries
  std::uint64_t primary_ps = 0;        ///< modelled picoseconds of loading and moving primaries
  /// The other cycles: reading records, register accesses. In modes all and hits, records are read
  /// during the pass, so most of that time counts as compute.
  std::uint64_t download_cycles = 0;
  std::uint64_t hits = 0;          ///< records with F = 1
  std::string brute_force_reason;  ///< why rays used brute force instead of the requested BVH;
                                   ///< empty if they traversed it
  std::uint64_t compared = 0;      ///< records compared with the reference
  std::uint64_t mismatches = 0;    ///< differing, missing or extra records
  std::string first_mismatch;      ///< the first difference as text; empty if none
  std::optional<Difference> first_difference;  ///< the first difference as data
  double pass_seconds = 0;   ///< wall time of the simulated card: uploads, passes, downloads
  double check_seconds = 0;  ///< wall time of the reference

  /// Modelled time by part; `load` covers secondaries and primaries.
  [[nodiscard]] ModelledTime time() const {
    ModelledTime t = counters.time;
    t.load = secondary_ps + primary_ps;
    return t;
  }
};

/// Runs frames of a scene on a simulated card. Moving objects are posed and uploaded, or moved by
/// the card as the plan says. Then the queries run, and their records are compared with the
/// reference.
class SceneRunner {
 public:
  /// Opens the planned board, building its simulation model if needed. The scene must outlive the
  /// runner. Errors as for Board::open. Error kUsage if the board does not support a scheduled
  /// fault.
  SceneRunner(const Scene& scene, const Plan& plan, RunnerOptions options);
  ~SceneRunner();
  SceneRunner(const SceneRunner&) = delete;
  SceneRunner& operator=(const SceneRunner&) = delete;

  /// Receives the records of a query in the order of the card.
  using Sink = std::function<void(std::size_t query, std::span<const Record>)>;

  /// Runs one frame and returns a QueryFrame per query of the scene. Frames may be run in any
  /// order. Mismatches are counted, not thrown. Errors: kTimeout, kDevice, and exceptions of the
  /// sink or progress.
  std::vector<QueryFrame> run_frame(std::uint32_t frame, const Sink& sink = {});

  /// Which of RunnerOptions::faults were injected so far. Board::bus_counters() and
  /// Counters::corrected_words show their effects.
  [[nodiscard]] const std::vector<bool>& injected() const;

  [[nodiscard]] const Board& board() const;

  /// Ends the waves. Error kFile if they could not be written completely. The destructor also ends
  /// them, but reports nothing.
  void trace_close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cde
