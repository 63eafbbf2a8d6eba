// SPDX-License-Identifier: Apache-2.0
// cde cast on its cards: one card, or several that share the rays.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <span>

#include "cast/check.hpp"
#include "cast/job.hpp"
#include "cde/card/machine.hpp"
#include "cde/card/trace_file.hpp"
#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/output.hpp"

namespace cde::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Uploads the triangles. load_mesh has checked the mesh.
void upload(Board& board, const CastJob& job) {
  if (job.bvh)
    board.upload(job.mesh, *job.bvh, false);
  else
    board.upload(job.mesh, false);
}

/// A card with waves, with the mesh uploaded.
Board traced_board(const CastJob& job) {
  BoardConfig config = job.config;
  config.trace = true;
  Board board = Board::open(config);
  upload(board, job);
  return board;
}

Query query_of(const CastTask& o, Mode mode) {
  return {.mode = mode,
          .pair = Pair::kRayTriangle,
          .deadline_cycles = o.deadline,
          .watchdog = std::chrono::duration<double>(o.timeout)};
}

std::string pack_hang(const CastTask& o, const CastJob& job, Mode mode, const RayView& rays,
                      const Error& error, std::uint64_t cycle) {
  Failure f{.kind = HangFailure{.cycle = cycle}, .message = error.what()};
  f.rerun = [&](const std::string& file, const TraceOptions& which) {
    Board board = traced_board(job);
    board.trace_open(file, which);
    try {
      (void)board.cast(rays, query_of(o, mode), [](std::span<const Record>) {});
    } catch (const Error& e) {
      if (!is_hang(e)) throw;
    }
    board.trace_close();
    return true;
  };
  return packed(o.bundle, o.quiet, f);
}

}  // namespace

Board card_of(const CastTask& o, const CastJob& job) {
  Board board = Board::open(job.config, options_on(o.request.device));
  upload(board, job);
  return board;
}

CastOutcome cast_on(Board& board, const CastTask& o, const CastJob& job, Mode mode,
                    const RayView& rays, const std::function<void(double)>& progress,
                    const RecordSink& take) {
  std::optional<CastCheck> check;
  if (o.check) check.emplace(o, job, mode, rays, board);

  CastOutcome result;
  TraceFile waves(
      o.trace.file, [&](const std::string& file) { board.trace_open(file, o.trace.options()); },
      [&] { board.trace_close(); });
  std::optional<Interrupts> interrupts;
  if (o.trace.wanted()) interrupts.emplace();
  const std::uint64_t began = board.cycles();
  std::uint64_t seen = 0, before = 0;  // cycles at which the card last made progress
  double seen_share = 0;
  const std::function<void(double)> noting = [&](double share) {
    if (o.trace.wanted() && Interrupts::signal() != 0) throw CastStopped();
    if (share != seen_share) {  // a repeated share is no progress
      seen = before;
      seen_share = share;
      before = board.cycles() - began;
    }
    if (progress) progress(share);
  };
  Query query = query_of(o, mode);
  query.progress = noting;
  double host_seconds = 0;
  const auto start = Clock::now();
  const RecordSink sink = [&](std::span<const Record> records) {
    const auto received = Clock::now();
    if (check) check->compare(records);
    for (const Record& r : records) result.hits += r.f ? 1 : 0;
    take(records);
    host_seconds += seconds_since(received);
  };
  try {
    result.counters = board.cast(rays, query, sink);
  } catch (const CastStopped&) {
    throw CastStopped{waves.close()};
  } catch (const Error& e) {
    if (!is_hang(e) || o.deadline != 0) throw;
    waves.close();
    throw Error(e.code(), e.what() + pack_hang(o, job, mode, rays, e, seen), e.fault());
  }
  result.simulation_seconds = seconds_since(start) - host_seconds;
  {
    const Progress busy("writing waves", o.quiet || !o.trace.wanted());
    waves.close();
  }
  if (check) {
    check->end();
    check->report(result);
  }
  result.modelled_seconds = result.counters.modelled_seconds(o.request.device.clock_hz());
  result.upload_cycles = board.upload_cycles();
  result.model = board.model_path().string();
  result.config_hash = board.config_hash();
  return result;
}

namespace {

/// Casts these rays on a card of their own. `take` gets the checked records in order.
CastOutcome cast_on_card(const CastTask& o, const CastJob& job, const RayView& rays,
                         const std::function<void(double)>& progress, const RecordSink& take) {
  Board board = [&] {
    const Progress busy("uploading triangles", o.quiet || !progress);
    return card_of(o, job);
  }();
  return cast_on(board, o, job, job.mode, rays, progress, take);
}

/// Memory that several cards take. Each card has a DDR with the mesh. All cards but the first keep
/// their records until it is their turn. If the number of records is not known in advance, they are
/// counted as they arrive.
class SharedMemory {
 public:
  SharedMemory(const CastTask& o, const CastJob& job, std::size_t boards, std::size_t waiting)
      : boards_(boards), spare_(job.mode == Mode::kHits ? 2 : 1) {
    const std::uint64_t triangles = job.mesh.faces.size();
    cards_ = boards * triangles * 4 * words(Shape::kTriangle);
    if (o.check && !job.bvh &&
        !reference::has_fast_brute_force(job.config.algorithm,
                                         job.config.format))  // the copy that the check makes
      cards_ += boards * triangles * sizeof(Triangle);
    // In double: 2^32 rays times 2^26 triangles of 64 bytes may exceed 64 bits.
    const double each = job.mode == Mode::kHits  ? 0.0
                        : job.mode == Mode::kAll ? static_cast<double>(triangles)
                                                 : 1.0;
    check(static_cast<double>(waiting) * each * sizeof(Record));
  }
  /// Adds waiting records. Error kCapacity if there are too many.
  void add(std::size_t records) {
    check(static_cast<double>(bytes_ += records * sizeof(Record) * spare_));
  }

 private:
  void check(double waiting) const {
    const double all = static_cast<double>(cards_) + waiting;
    if (all <= static_cast<double>(memory_limit())) return;
    throw Error(
        ErrorCode::kCapacity,
        fmt::format(
            "{} cards take {} MB, and records that wait for earlier cards {:.0f} MB; the limit on "
            "this machine is {} MB; use fewer --boards (with one card no records wait)",
            boards_, cards_ >> 20, waiting / (1 << 20), memory_limit() >> 20));
  }
  std::size_t boards_;
  unsigned spare_;  // a list of unknown final length reserves up to this many times its size
  std::uint64_t cards_ = 0;
  std::atomic<std::uint64_t> bytes_ = 0;
};

/// Shares whole packets of rays among `o.boards` cards, each in a thread. Records come in the order
/// of one card.
CastOutcome cast_on_cards(const CastTask& o, const CastJob& job,
                          const std::function<void(double)>& progress, const RecordSink& take) {
  const std::size_t packets = (job.rays.size() + card::kMostPrimaries - 1) / card::kMostPrimaries;
  struct Share {
    std::size_t first = 0, size = 0;
    std::vector<Record> records;
    std::future<CastOutcome> outcome;
  };
  std::vector<Share> shares(std::min<std::size_t>(o.boards, packets));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].first = std::min(job.rays.size(), packets * i / shares.size() * card::kMostPrimaries);
    shares[i].size =
        std::min(job.rays.size(), packets * (i + 1) / shares.size() * card::kMostPrimaries) -
        shares[i].first;
  }
  SharedMemory memory(o, job, shares.size(), job.rays.size() - shares.front().size);
  CastTask of_share = o;
  of_share.brute_force_rays = (o.brute_force_rays + shares.size() - 1) / shares.size();
  (void)SimulationModel::open(job.config.top(),
                              job.config.parameters());  // built once, before all cards need it
  for (std::size_t i = 0; i < shares.size(); ++i) {
    Share& share = shares[i];
    if (i != 0 && job.mode != Mode::kHits)
      share.records.reserve(share.size * (job.mode == Mode::kAll ? job.mesh.faces.size() : 1));
    const auto keep = [&memory, &share](std::span<const Record> records) {
      memory.add(records.size());
      share.records.insert(share.records.end(), records.begin(), records.end());
    };
    // The first card hands on its records at once. The others keep theirs until it has ended.
    const RecordSink sink = i == 0 ? take : RecordSink(keep);
    share.outcome = std::async(std::launch::async, [&, i, sink] {
      return cast_on_card(of_share, job, job.rays.subview(share.first, share.size),
                          i == 0 ? progress : std::function<void(double)>(), sink);
    });
  }
  CastOutcome all;
  for (Share& share : shares) {
    const CastOutcome one = share.outcome.get();
    for (Record& r : share.records) r.primary += static_cast<std::uint32_t>(share.first);
    if (!share.records.empty()) take(share.records);
    std::vector<Record>().swap(share.records);
    all.counters += one.counters;
    all.hits += one.hits;
    all.compared += one.compared;
    all.matching += one.matching;
    all.brute_force_rays += one.brute_force_rays;
    if (all.difference.empty() && !one.difference.empty()) {
      all.difference = one.difference;
      all.first_difference = one.first_difference;
      for (auto* r : {&all.first_difference->card, &all.first_difference->reference})
        if (*r) (*r)->primary += static_cast<std::uint32_t>(share.first);
    }
    all.upload_cycles += one.upload_cycles;
    all.modelled_seconds = std::max(all.modelled_seconds, one.modelled_seconds);
    all.simulation_seconds = std::max(all.simulation_seconds, one.simulation_seconds);
    all.model = one.model;
    all.config_hash = one.config_hash;
  }
  return all;
}

/// Casts one packet on a card with waves. Returns the records of one primary.
std::vector<Record> cast_traced(const CastTask& o, const CastJob& job, std::size_t packet,
                                std::uint32_t primary, const std::string& file,
                                const TraceOptions& which) {
  Board board = traced_board(job);
  board.trace_open(file, which);
  const std::size_t first = packet * card::kMostPrimaries,
                    count = std::min(card::kMostPrimaries, job.rays.size() - first);
  std::vector<Record> found;
  (void)board.cast(job.rays.subview(first, count), query_of(o, job.mode),
                   [&](std::span<const Record> records) {
                     std::copy_if(records.begin(), records.end(), std::back_inserter(found),
                                  [&](const Record& r) { return r.primary == primary; });
                   });
  board.trace_close();
  return found;
}

}  // namespace

Failure failure_of(const CastTask& o, const CastJob& job, const CastOutcome& outcome) {
  const Difference& d = *outcome.first_difference;
  const std::size_t packet = d.number() / card::kMostPrimaries;
  const auto place = static_cast<std::uint32_t>(d.number() % card::kMostPrimaries);
  CardFailure f;
  f.pipe.algorithm = job.config.algorithm;
  f.pipe.box = job.config.box;
  f.pipe.arithmetic = job.config.arithmetic;
  f.pipe.format = job.config.format;
  f.pipe.lanes = job.config.lanes;
  f.mode = job.mode;
  f.difference = d;
  f.place = place;
  const std::size_t rays =
      std::min(card::kMostPrimaries, job.rays.size() - packet * card::kMostPrimaries);
  f.cycles = (rays + job.config.lanes - 1) / job.config.lanes * job.mesh.faces.size();
  Failure failure{.kind = f, .message = outcome.difference};
  const std::size_t repeat = outcome.difference.find("repeat with: ");
  if (repeat != std::string::npos)
    failure.repeat = outcome.difference.substr(repeat + std::string_view("repeat with: ").size());
  failure.rerun = [&o, &job, d, packet, place](const std::string& file, const TraceOptions& which) {
    const std::vector<Record> again = cast_traced(o, job, packet, place, file, which);
    if (!d.card) return again.empty() || job.mode == Mode::kAll || job.mode == Mode::kHits;
    return std::any_of(again.begin(), again.end(), [&](Record r) {
      r.primary = d.card->primary;
      return same_bits(r, *d.card);
    });
  };
  return failure;
}

CastOutcome cast_here(const CastTask& o, const CastJob& job, const std::string& what,
                      const RecordSink& take) {
  Progress bar(what, o.quiet);
  const auto progress = [&](double share) { bar(share); };
  return o.boards > 1 ? cast_on_cards(o, job, progress, take)
                      : cast_on_card(o, job, job.rays, progress, take);
}

}  // namespace cde::cli
