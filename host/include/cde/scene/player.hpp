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

struct PlayOptions {
  Check check = Check::kAll;
  std::filesystem::path trace = {};  ///< waves; needs a board with trace
  TraceOptions waves = {};           ///< which ones
  /// Waves begin with this packet of a query in a frame, before its primaries are loaded, and end
  /// with the packet; without it with the first frame. `waves` counts from there.
  struct Packet {
    std::uint32_t frame = 0;
    std::size_t query = 0, number = 0;
  };
  std::optional<Packet> waves_of = {};
  /// What that packet is made of, told before it is loaded: all primaries and secondaries of its
  /// query as they stand before the pipes, and which pairs count (empty: all).
  struct Made {
    const Shapes &primaries, &secondaries;
    std::function<bool(std::uint32_t primary, std::uint32_t secondary)> counts;
  };
  std::function<void(const Made&)> made_of = {};
  std::chrono::duration<double> watchdog = std::chrono::hours(1);  ///< wall clock, for one pass
  std::uint64_t deadline_clocks = 0;  ///< for one pass; 0: several times what it can take at worst
  std::vector<ScheduledFault> faults = {};  ///< each once, when its frame is played
  /// Called now and then with the frame and the share of the query's packets done; what it throws
  /// ends the run and leaves the card ready.
  std::function<void(std::uint32_t frame, double share)> progress = {};
};

/// One query in one frame.
struct QueryFrame {
  Counters counters;  ///< sums over the packets; records are those of the query, and tests what the
                      ///< card did for them, of pairs that do not count (SceneQuery::self), too
  std::uint64_t card_records = 0;  ///< records that the card wrote: where pairs of a thing with
                                   ///< itself do not count, more than those of the query
  std::uint64_t passes = 0;
  std::uint64_t secondary_words = 0;   ///< written for this query: shapes that changed, ranges of
                                       ///< objects, 12 an object that the card moves
  std::uint64_t primary_words = 0;     ///< likewise, in slots of whole beats
  std::uint64_t secondary_clocks = 0;  ///< core clocks that the secondaries took,
  std::uint64_t secondary_ps = 0;      ///< and modelled picoseconds
  std::uint64_t primary_clocks = 0;    ///< core clocks of loading primaries,
  std::uint64_t primary_ps = 0;        ///< and modelled picoseconds of loading and moving them
  std::uint64_t download_clocks = 0;   ///< the rest: reading records, register accesses. In modes
                                       ///< all and hits records are read while the pass runs, and
                                       ///< much of it counts as compute.
  std::uint64_t hits = 0;              ///< records with F = 1
  std::string swept_as;                ///< why rays that were to go through a hierarchy met all
                                       ///< triangles; empty if they did not
  std::uint64_t compared = 0;          ///< records compared with the reference
  std::uint64_t mismatches = 0;        ///< of them, and records missing or too many
  std::string first_mismatch;          ///< what differed first, for people; empty if nothing did
  std::optional<Difference> first_difference;  ///< the same as data
  double pass_seconds = 0;   ///< wall time of the simulated card: uploads, passes, downloads
  double check_seconds = 0;  ///< of the reference

  /// Where the modelled time of all of it went; `load` is secondaries and primaries.
  [[nodiscard]] ModelledTime time() const {
    ModelledTime t = counters.time;
    t.load = secondary_ps + primary_ps;
    return t;
  }
};

/// Plays frames of a scene on a simulated card: what moves is posed and uploaded, or moved by
/// the card as the plan says, the queries run, their records are compared with the reference.
class Player {
 public:
  /// Opens the planned board, building its bitstream if need be. The scene must outlive the player.
  /// Errors as Board::open, and kUsage if the board has no fault like one of those scheduled.
  Player(const Scene& scene, const Plan& plan, PlayOptions options);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  /// Takes the records of a query as they come off the card.
  using Sink = std::function<void(std::size_t query, std::span<const Record>)>;

  /// One frame: a QueryFrame a query of the scene. Any frame may follow any other. Mismatches are
  /// counted, not thrown. Errors: kTimeout, kDevice, and what the sink or progress throws.
  std::vector<QueryFrame> play(std::uint32_t frame, const Sink& sink = {});

  /// Which of PlayOptions::faults were injected so far; Board::bus_counters() and
  /// Counters::corrected_words say what came of them.
  [[nodiscard]] const std::vector<bool>& injected() const;

  [[nodiscard]] const Board& board() const;

  /// Ends the waves. Error kFile if not all of them could be written. The destructor ends them,
  /// too, and does not say.
  void trace_close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cde
