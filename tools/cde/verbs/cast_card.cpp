// SPDX-License-Identifier: Apache-2.0
// cde cast on its cards: one, or several that share the rays.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <span>

#include "cde/contract/records.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/reference.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "output/busy.hpp"
#include "output/machine.hpp"
#include "output/output.hpp"
#include "verbs/cast.hpp"
#include "wave/waves.hpp"

namespace cde::cli {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kPacket = card::kMostPrimaries;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Holds the records of a card against the reference, whichever algorithm it has. Of the plain
/// Moller card there is a fast one, which also prints what differs.
class Judge {
 public:
  Judge(const CastOptions& o, const CastJob& job, Mode mode, const RayView& rays,
        const Board& board)
      : job_(job), mode_(mode), rays_(rays), board_(board), packet_(board.primaries()) {
    command_ = fmt::format("cde cast {} --mode {} --lanes {} --arith {}{}{}", shell_word(o.mesh),
                           name_of(mode), job.config.lanes, o.arithmetic, o.box ? "" : " --no-box",
                           job.config.format == FpFormat{} ? "" : " --format " + o.format);
    swept_rays_ = std::min<std::uint64_t>(o.swept_rays, rays.size());
    if (job.config.algorithm != Algorithm::kMoller) command_ += " --algorithm " + o.algorithm;
    if (job.hierarchy) {
      command_ += " --bvh";
      walk_.emplace(job.mesh, *job.hierarchy, job.config.algorithm);
      return;
    }
    if (o.bvh < 0) command_ += " --no-bvh";
    if (job.config.algorithm == Algorithm::kMoller) {
      moller_.emplace(rays, job.mesh, mode, Stencil(), packet_, command_, std::span<const Object>(),
                      o.box, job.config.format);
      moller_->place_by([&board](std::uint32_t primary) { return place_on_card(board, primary); });
      return;
    }
    std::vector<Triangle> triangles;
    triangles.reserve(job.mesh.faces.size());
    for (std::size_t i = 0; i < job.mesh.faces.size(); ++i)
      triangles.push_back(job.mesh.triangle(i));
    triangles_ = std::move(triangles);
  }

  void compare(std::span<const Record> records) {
    if (moller_) return moller_->compare(records);
    for (const Record& r : records) {
      const Record* expected = next();
      ++compared_;
      if (expected != nullptr && same_bits(r, *expected))
        ++matching_;
      else
        differ(&r, expected);
    }
  }
  void end() {
    if (moller_) return moller_->compare_end();
    if (const Record* expected = next()) differ(nullptr, expected);
    if (walk_) sweep_some();
  }
  void report(CastOutcome& to) const {
    to.swept_rays = swept_;
    to.compared = moller_ ? moller_->compared() : compared_;
    to.matching = moller_ ? moller_->matching() : matching_;
    to.difference = moller_ ? moller_->difference() : difference_;
    to.first_difference = moller_ ? moller_->first_difference() : first_difference_;
  }

 private:
  /// The reference's next record; null at the end.
  const Record* next() {
    while (pending_.empty()) {
      if (pass_) pending_ = pass_->next();
      if (!pending_.empty()) break;
      if (first_ >= rays_.size()) return nullptr;
      const std::size_t count = std::min<std::size_t>(packet_, rays_.size() - first_);
      if (walk_) {
        walk_packet(first_, count);
        first_ += count;
        continue;
      }
      std::vector<std::uint32_t> numbers(count);
      for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<std::uint32_t>(first_ + i);
      pass_.emplace(reference::PassQuery{.algorithm = job_.config.algorithm,
                                         .box = job_.config.box,
                                         .mode = mode_,
                                         .format = job_.config.format},
                    rays_.subview(first_, count).copy(), std::move(numbers), triangles_);
      first_ += count;
    }
    const Record* r = &pending_.front();
    pending_ = pending_.subspan(1);
    return r;
  }

  [[nodiscard]] std::vector<Record> walked(std::size_t ray) {
    const auto number = static_cast<std::uint32_t>(ray);
    const bool f_alone = mode_ == Mode::kOccluded;
    std::vector<Record> some = walk_->trace(rays_[ray], number, f_alone ? Mode::kAny : mode_);
    if (f_alone)
      for (Record& r : some) {
        Record plain;
        plain.f = r.f, plain.bad = r.bad, plain.primary = r.primary;
        if (r.bad) plain.t = r.t, plain.cp = r.cp;
        r = plain;
      }
    return some;
  }

  /// The reference's way through the hierarchy, in the order of the card.
  void walk_packet(std::size_t first, std::size_t count) {
    walked_.clear();
    for (std::size_t i = first; i < first + count; ++i)
      for (const Record& r : walked(i)) walked_.push_back(r);
    if (mode_ == Mode::kHits)
      std::sort(walked_.begin(), walked_.end(), [](const Record& a, const Record& b) {
        return a.index != b.index ? a.index < b.index : a.primary < b.primary;
      });
    pending_ = walked_;
  }

  /// Some rays, evenly spread: what the hierarchy answers against all triangles.
  void sweep_some() {
    while (swept_ < swept_rays_ && difference_.empty()) sweep_packet();
  }

  /// As many of them as meet the triangles together. (64 and 259,572 triangles: 22 ms; one by
  /// one 1.4 s.)
  void sweep_packet() {
    const std::uint64_t count = std::min<std::uint64_t>(card::kMostPrimaries, swept_rays_ - swept_);
    std::vector<Ray> rays;
    std::vector<std::size_t> numbers;
    for (std::uint64_t k = swept_; k < swept_ + count; ++k) {
      numbers.push_back(static_cast<std::size_t>(k * rays_.size() / swept_rays_));
      rays.push_back(rays_[numbers.back()]);
    }
    const Mode mode = mode_ == Mode::kOccluded ? Mode::kAny : mode_;
    std::vector<std::vector<Record>> all(count);
    for (Record r :
         reference::cast(rays, job_.mesh, mode, {}, {}, true, {}, job_.config.algorithm)) {
      std::vector<Record>& of_ray = all[r.primary];
      r.primary = static_cast<std::uint32_t>(numbers[r.primary]);
      of_ray.push_back(r);
    }
    for (std::uint64_t k = 0; k < count; ++k, ++swept_)
      if (!as_all_triangles(walked(numbers[k]), all[k])) return;
  }

  [[nodiscard]] bool as_all_triangles(std::span<const Record> some, std::span<const Record> all) {
    const auto same = [&](const Record& a, const Record& b) {
      return mode_ == Mode::kOccluded ? a.f == b.f : same_bits(a, b);
    };
    for (std::size_t r = 0; r < std::max(all.size(), some.size()); ++r) {
      if (r < all.size() && r < some.size() && same(some[r], all[r])) continue;
      differ(r < some.size() ? &some[r] : nullptr, r < all.size() ? &all[r] : nullptr);
      return false;
    }
    return true;
  }

  static std::string text(const Record* r) {
    if (r == nullptr) return "no record";
    return fmt::format("ray {} F {} T {:a} CP {:a} {:a} {:a} index {}", r->primary, r->f ? 1 : 0,
                       r->t, r->cp.x(), r->cp.y(), r->cp.z(), r->index);
  }

  void keep(const Record* card, const Record* expected) {
    first_difference_.emplace();
    if (card != nullptr) first_difference_->card = *card;
    if (expected != nullptr) first_difference_->reference = *expected;
    if (first_difference_->number() < rays_.size()) {
      const auto words = to_words(rays_[first_difference_->number()]);
      first_difference_->primary.assign(words.begin(), words.end());
    }
    for (const auto& r : {first_difference_->reference, first_difference_->card}) {
      if (!r || r->index >= job_.mesh.faces.size()) continue;
      const auto words = to_words(job_.mesh.triangle(r->index));
      first_difference_->secondaries.emplace_back(r->index,
                                                  std::vector<float>(words.begin(), words.end()));
    }
  }

  void differ(const Record* card, const Record* expected) {
    if (!difference_.empty()) return;
    const Record& any = card != nullptr ? *card : *expected;
    keep(card, expected);
    std::string again = command_;
    if (any.primary < rays_.size()) {
      const Ray r = rays_[any.primary];
      again += fmt::format(" --ray={:a},{:a},{:a},{:a},{:a},{:a},{:a},{:a}", r.o.x(), r.o.y(),
                           r.o.z(), r.d.x(), r.d.y(), r.d.z(), r.tmin, r.tmax);
    }
    difference_ = fmt::format(
        "ray {}: the card's record differs from the reference\n  card      {}\n  reference {}\n"
        "  differ in {}\n  where     {}\nrepeat with: {}",
        any.primary, text(card), text(expected),
        card != nullptr && expected != nullptr ? differing_fields(*card, *expected) : "all",
        walk_ ? fmt::format("clock {} (record read)", board_.clocks())
              : place_on_card(board_, any.primary % packet_),
        again);
  }

  const CastJob& job_;
  Mode mode_;
  RayView rays_;
  const Board& board_;
  unsigned packet_;
  std::string command_, difference_;
  std::optional<Difference> first_difference_;
  std::optional<reference::Checker> moller_;
  std::optional<reference::Traversal> walk_;
  std::vector<Record> walked_;
  std::uint64_t swept_rays_ = 0, swept_ = 0;
  Shapes triangles_;
  std::optional<reference::Pass> pass_;
  std::span<const Record> pending_;
  std::size_t first_ = 0;
  std::uint64_t compared_ = 0, matching_ = 0;
};

/// load_mesh has checked it.
void upload(Board& board, const CastJob& job) {
  if (job.hierarchy)
    board.upload(job.mesh, *job.hierarchy, false);
  else
    board.upload(job.mesh, false);
}

/// A card with waves, which has the mesh.
Board traced_board(const CastJob& job) {
  BoardConfig config = job.config;
  config.trace = true;
  Board board = Board::open(config);
  upload(board, job);
  return board;
}

Query query_of(const CastOptions& o, Mode mode) {
  return {.mode = mode,
          .pair = Pair::kRayTriangle,
          .deadline_clocks = o.deadline,
          .watchdog = std::chrono::duration<double>(o.timeout)};
}

std::string pack_hang(const CastOptions& o, const CastJob& job, Mode mode, const RayView& rays,
                      const Error& error, std::uint64_t clock) {
  HangFailure f{.message = error.what(), .repeat = "", .clock = clock};
  f.rerun = [&](const std::string& file, const TraceOptions& which) {
    Board board = traced_board(job);
    board.trace_open(file, which);
    try {
      (void)board.cast(rays, query_of(o, mode), [](std::span<const Record>) {});
    } catch (const Error& e) {
      if (!is_hang(e)) throw;
    }
    board.trace_close();
  };
  return packed(o.bundle, o.quiet, [&](Bundle& bundle) { bundle_hang(bundle, f); });
}

}  // namespace

Board card_of(const CastOptions& o, const CastJob& job) {
  Board board = Board::open(
      job.config,
      {.clock_period_ps = static_cast<std::uint32_t>(std::max(1.0, 1e6 / o.clock.mhz))});
  upload(board, job);
  return board;
}

CastOutcome cast_on(Board& board, const CastOptions& o, const CastJob& job, Mode mode,
                    const RayView& rays, const std::function<void(double)>& progress,
                    const RecordSink& take) {
  std::optional<Judge> judge;
  if (o.check) judge.emplace(o, job, mode, rays, board);

  CastOutcome result;
  Waves waves(
      o.trace.file, [&](const std::string& file) { board.trace_open(file, o.trace.options()); },
      [&] { board.trace_close(); });
  std::optional<Interrupts> interrupts;
  if (o.trace.wanted()) interrupts.emplace();
  const std::uint64_t began = board.clocks();
  std::uint64_t seen = 0, before = 0;  // since when the card was not seen to go on
  double seen_share = -1;
  const std::function<void(double)> noting = [&](double share) {
    if (o.trace.wanted() && Interrupts::signal() != 0) throw CastStopped();
    if (share != seen_share) seen = before;
    seen_share = share;
    before = board.clocks() - began;
    if (progress) progress(share);
  };
  Query query = query_of(o, mode);
  query.progress = noting;
  double host_seconds = 0;
  const auto start = Clock::now();
  const RecordSink sink = [&](std::span<const Record> records) {
    const auto received = Clock::now();
    if (judge) judge->compare(records);
    for (const Record& r : records) result.hits += r.f ? 1 : 0;
    take(records);
    host_seconds += seconds_since(received);
  };
  try {
    result.counters = board.cast(rays, query, sink);
  } catch (const Error& e) {
    if (!is_hang(e) || o.deadline != 0) throw;
    waves.close();
    throw Error(e.code(), e.what() + pack_hang(o, job, mode, rays, e, seen), e.fault());
  }
  result.simulation_seconds = seconds_since(start) - host_seconds;
  {
    const Busy busy("writing waves", o.quiet || !o.trace.wanted());
    waves.close();
  }
  if (judge) {
    judge->end();
    judge->report(result);
  }
  result.modelled_seconds = result.counters.modelled_seconds(o.clock.mhz * 1e6);
  result.upload_clocks = board.upload_clocks();
  result.bitstream = board.bitstream().string();
  result.config_hash = board.config_hash();
  return result;
}

namespace {

/// These rays on a card of their own; `take` gets the checked records in order.
CastOutcome cast_on_card(const CastOptions& o, const CastJob& job, const RayView& rays,
                         const std::function<void(double)>& progress, const RecordSink& take) {
  Board board = [&] {
    const Busy busy("uploading triangles", o.quiet || !progress);
    return card_of(o, job);
  }();
  return cast_on(board, o, job, job.mode, rays, progress, take);
}

/// What several cards take: each a DDR with the mesh, and all but the first one keep their records
/// until it is their turn. Where nobody knows how many there will be, they are counted as they
/// come.
class SharedMemory {
 public:
  SharedMemory(const CastOptions& o, const CastJob& job, std::size_t boards, std::size_t waiting)
      : boards_(boards), spare_(job.mode == Mode::kHits ? 2 : 1) {
    const std::uint64_t triangles = job.mesh.faces.size();
    cards_ = boards * triangles * 4 * words(Shape::kTriangle);
    if (o.check && !job.hierarchy &&
        (job.config.algorithm != Algorithm::kMoller ||
         job.config.format != FpFormat{}))  // the Judge's copy
      cards_ += boards * triangles * sizeof(Triangle);
    // 2^32 rays and 2^26 triangles of 64 bytes: their product may leave 64 bits, its size does not.
    const double each = job.mode == Mode::kHits  ? 0.0
                        : job.mode == Mode::kAll ? static_cast<double>(triangles)
                                                 : 1.0;
    check(static_cast<double>(waiting) * each * sizeof(Record));
  }
  /// So many more records wait. Error kCapacity if they are too many.
  void add(std::size_t records) {
    check(static_cast<double>(bytes_ += records * sizeof(Record) * spare_));
  }

 private:
  void check(double waiting) const {
    const double all = static_cast<double>(cards_) + waiting;
    if (all <= static_cast<double>(memory_limit())) return;
    throw Error(ErrorCode::kCapacity,
                fmt::format("{} cards take {} MB, and records that wait for those of the cards "
                            "before them {:.0f} MB; the limit on this machine is {} MB (fewer "
                            "--boards take less, of one card no records wait)",
                            boards_, cards_ >> 20, waiting / (1 << 20), memory_limit() >> 20));
  }
  std::size_t boards_;
  unsigned spare_;  // a list that grows without being told how long it will be has room to spare
  std::uint64_t cards_ = 0;
  std::atomic<std::uint64_t> bytes_ = 0;
};

/// Whole packets of the rays shared out over `o.boards` cards, each in a thread; records in the
/// order of one card.
CastOutcome cast_on_cards(const CastOptions& o, const CastJob& job,
                          const std::function<void(double)>& progress, const RecordSink& take) {
  const std::size_t packets = (job.rays.size() + kPacket - 1) / kPacket;
  struct Share {
    std::size_t first = 0, size = 0;
    std::vector<Record> records;
    std::future<CastOutcome> outcome;
  };
  std::vector<Share> shares(std::min<std::size_t>(o.boards, packets));
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].first = std::min(job.rays.size(), packets * i / shares.size() * kPacket);
    shares[i].size =
        std::min(job.rays.size(), packets * (i + 1) / shares.size() * kPacket) - shares[i].first;
  }
  SharedMemory memory(o, job, shares.size(), job.rays.size() - shares.front().size);
  CastOptions of_share = o;
  of_share.swept_rays = (o.swept_rays + shares.size() - 1) / shares.size();
  (void)Bitstream::open(job.config.top(),
                        job.config.parameters());  // built once, before all want it
  for (std::size_t i = 0; i < shares.size(); ++i) {
    Share& share = shares[i];
    if (i != 0 && job.mode != Mode::kHits)
      share.records.reserve(share.size * (job.mode == Mode::kAll ? job.mesh.faces.size() : 1));
    const auto keep = [&memory, &share](std::span<const Record> records) {
      memory.add(records.size());
      share.records.insert(share.records.end(), records.begin(), records.end());
    };
    // It is the first card's turn from the beginning, and nobody else's before it has ended.
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
    all.swept_rays += one.swept_rays;
    if (all.difference.empty() && !one.difference.empty()) {
      all.difference = one.difference;
      all.first_difference = one.first_difference;
      for (auto* r : {&all.first_difference->card, &all.first_difference->reference})
        if (*r) (*r)->primary += static_cast<std::uint32_t>(share.first);
    }
    all.upload_clocks += one.upload_clocks;
    all.modelled_seconds = std::max(all.modelled_seconds, one.modelled_seconds);
    all.simulation_seconds = std::max(all.simulation_seconds, one.simulation_seconds);
    all.bitstream = one.bitstream;
    all.config_hash = one.config_hash;
  }
  return all;
}

/// Casts one packet on a card with waves; its records of one primary.
std::vector<Record> cast_traced(const CastOptions& o, const CastJob& job, std::size_t packet,
                                std::uint32_t primary, const std::string& file,
                                const TraceOptions& which) {
  Board board = traced_board(job);
  board.trace_open(file, which);
  const std::size_t first = packet * kPacket, count = std::min(kPacket, job.rays.size() - first);
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

void bundle_cast(Bundle& bundle, const CastOptions& o, const CastJob& job,
                 const CastOutcome& outcome) {
  const Difference& d = *outcome.first_difference;
  const std::size_t packet = d.number() / kPacket;
  const auto place = static_cast<std::uint32_t>(d.number() % kPacket);
  CardFailure f;
  f.pipe.algorithm = job.config.algorithm;
  f.pipe.box = job.config.box;
  f.pipe.arithmetic = job.config.arithmetic;
  f.pipe.format = job.config.format;
  f.pipe.lanes = job.config.lanes;
  f.mode = job.mode;
  f.difference = d;
  f.place = place;
  const std::size_t rays = std::min(kPacket, job.rays.size() - packet * kPacket);
  f.clocks = (rays + job.config.lanes - 1) / job.config.lanes * job.mesh.faces.size();
  f.message = outcome.difference;
  const std::size_t repeat = outcome.difference.find("repeat with: ");
  if (repeat != std::string::npos)
    f.repeat = outcome.difference.substr(repeat + std::string_view("repeat with: ").size());
  f.rerun = [&](const std::string& file, const TraceOptions& which) {
    const std::vector<Record> again = cast_traced(o, job, packet, place, file, which);
    if (!d.card) return again.empty() || job.mode == Mode::kAll || job.mode == Mode::kHits;
    return std::any_of(again.begin(), again.end(), [&](Record r) {
      r.primary = d.card->primary;
      return same_bits(r, *d.card);
    });
  };
  bundle_card(bundle, f);
}

CastOutcome cast_rays(const CastOptions& o, const CastJob& job, const std::string& what,
                      const RecordSink& take) {
  if (o.partition > 1 || Dealing::here().asked(o.deal)) return deal_rays(o, job, what, take);
  Progress bar(what, o.quiet);
  const auto progress = [&](double share) { bar(share); };
  return o.boards > 1 ? cast_on_cards(o, job, progress, take)
                      : cast_on_card(o, job, job.rays, progress, take);
}

}  // namespace cde::cli
