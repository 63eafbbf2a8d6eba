// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/scene_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "cde/contract/records.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/record_check.hpp"
#include "cde/support/error.hpp"
#include "query/record_choice.hpp"
#include "scene/scene_runner_faults.hpp"
#include "scene/scene_runner_objects.hpp"
#include "scene/self_pairs.hpp"

namespace cde {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string words_of(const Shapes& shapes, std::size_t i) {
  std::string words;
  for (const float w : numbers_of(shapes, i))
    words += fmt::format("{}{:a}", words.empty() ? "" : ",", w);
  return words;
}

/// A command that tests one pair on the same pipe.
std::string question(const SceneQuery& query, const BoardConfig& card, const std::string& primary,
                     const std::string& secondary) {
  std::string options = fmt::format("cde query {}", name(query.pair));
  if (query.pair == Pair::kRayTriangle)
    options += fmt::format(" --algorithm {}{}", name(card.algorithm), card.box ? "" : " --no-box");
  else if (card.box_rule(query.pair))
    options += " --box";
  if (card.format != FpFormat{}) options += " --format " + card.format.name();
  if (card.arithmetic == Arithmetic::kRtl) options += " --arith rtl";
  if (has_iterations(query.pair))
    options += fmt::format(" --iterations {},{},{}", query.iterations.samples,
                           query.iterations.circle, query.iterations.free);
  return fmt::format("echo '{} | {}' | {}", query.swap ? secondary : primary,
                     query.swap ? primary : secondary, options);
}

/// The shapes with these numbers.
Shapes picked(const Shapes& shapes, const std::vector<std::uint32_t>& numbers) {
  return std::visit(
      [&](const auto& list) -> Shapes {
        std::decay_t<decltype(list)> some;
        for (const std::uint32_t i : numbers) some.push_back(list[i]);
        return some;
      },
      shapes);
}

/// A predicate for the pairs that count; empty if all count.
std::function<bool(std::uint32_t, std::uint32_t)> counting(const SelfPairs& self) {
  if (!self.any()) return nullptr;
  return [&self](std::uint32_t p, std::uint32_t s) { return self.counts(p, s); };
}

/// Compares the records of one packet with the reference as they arrive. Only records of sampled
/// primaries are compared.
class PassCheck {
 public:
  PassCheck(const SceneQuery& query, const BoardConfig& card, const Board& board,
            const SelfPairs& self, const Shapes& primaries, std::vector<std::uint32_t> numbers,
            const Shapes& secondaries, bool streams)
      : numbers_(std::move(numbers)),
        pass_({.pair = query.pair,
               .algorithm = card.algorithm,
               .box = card.box_rule(query.pair),
               .swap = query.swap,
               .mode = query.mode,
               .normals = query.normals,
               .iterations = query.iterations,
               .format = card.format,
               .counts = counting(self)},
              picked(primaries, numbers_), numbers_, secondaries),
        check_([this] { return pass_.next(); },
               report_options(query, card, board, primaries, secondaries, streams)) {}

  void check(std::span<const Record> records) {
    for (const Record& record : records)
      if (std::binary_search(numbers_.begin(), numbers_.end(), record.primary))
        check_.compare({&record, 1});
  }

  void finish(QueryFrame& result) {
    check_.compare_end();
    result.compared += check_.compared();
    if (result.mismatches == 0 && check_.mismatches() != 0) {
      result.first_difference = check_.first_difference();
      result.first_mismatch = check_.difference();
    }
    result.mismatches += check_.mismatches();
  }

 private:
  static reference::RecordCheck::ReportOptions report_options(
      const SceneQuery& query, const BoardConfig& card, const Board& board, const Shapes& primaries,
      const Shapes& secondaries, bool streams) {
    const auto words = [](const Shapes& shapes, std::uint32_t i) {
      return i < size(shapes) ? numbers_of(shapes, i) : std::vector<float>();
    };
    return {.noun = "primary",
            .primary = [&, words](std::uint32_t i) { return words(primaries, i); },
            .secondary = [&, words](std::uint32_t i) { return words(secondaries, i); },
            .place =
                [&board, streams](std::uint32_t primary) {
                  return streams ? fmt::format("cycle {} (record read)", board.cycles())
                                 : place_on_card(board, primary % card::kMostPrimaries);
                },
            .repeat =
                [&](const Difference& d) {
                  std::string lines;
                  for (const auto& [index, unused] : d.secondaries)
                    if (!d.primary.empty())
                      lines += fmt::format("{}{}", lines.empty() ? "" : "\n             ",
                                           question(query, card, words_of(primaries, d.number()),
                                                    words_of(secondaries, index)));
                  return lines;
                }};
  }

  std::vector<std::uint32_t> numbers_;
  reference::Pass pass_;
  reference::RecordCheck check_;
};

/// Chooses one record per primary from the records of several passes.
class Chosen {
 public:
  Chosen(const SceneQuery& query, FpFormat format, const Shapes& primaries,
         const std::vector<std::uint32_t>& numbers)
      : query_(query) {
    std::visit(
        [&](const auto& list) {
          for (const std::uint32_t n : numbers)
            best_.push_back(unanswered(list[n], n, query.normals, format));
        },
        primaries);
  }
  /// Takes a record. Records come in ascending order of secondaries.
  void take(const Record& record) {
    const auto best =
        std::lower_bound(best_.begin(), best_.end(), record.primary,
                         [](const Record& r, std::uint32_t number) { return r.primary < number; });
    if (better(query_.pair, query_.mode, record, *best)) *best = record;
  }
  [[nodiscard]] std::span<const Record> records() const { return best_; }

 private:
  const SceneQuery& query_;
  std::vector<Record> best_;  // primaries ascending
};

}  // namespace

class SceneRunner::Impl {
 public:
  Impl(const Scene& scene, const Plan& plan, RunnerOptions options)
      : scene_(scene),
        options_(std::move(options)),
        card_(plan.board),
        board_(Board::open(plan.board, options_of(scene))),
        through_(plan.queries.size()),
        secondaries_(board_, scene, plan),
        primaries_(board_, scene, plan),
        faults_(board_, options_.faults) {
    for (std::size_t q = 0; q < through_.size(); ++q) through_[q] = plan.queries[q].bvh;
    if (!options_.waves_of) trace_open();
  }
  void trace_close() {
    if (traced_) board_.trace_close();
    traced_ = false;
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::vector<QueryFrame> run_frame(std::uint32_t frame, const Sink& sink) {
    faults_.start(frame);
    std::vector<QueryFrame> results;
    for (std::size_t q = 0; q < scene_.queries.size(); ++q) results.push_back(run(frame, q, sink));
    return results;
  }

  [[nodiscard]] const std::vector<bool>& injected() const { return faults_.done(); }
  [[nodiscard]] const Board& board() const { return board_; }

 private:
  static OpenOptions options_of(const Scene& scene) {
    OpenOptions o = options_on(scene.card.device, scene.card.cycle_memory);
    o.host = scene.card.host;
    o.bus_burst = scene.card.burst;
    o.narrow_bus = scene.card.narrow;
    return o;
  }

  void trace_open() {
    if (options_.trace.empty()) return;
    board_.trace_open(options_.trace, options_.waves);
    traced_ = true;
  }

  QueryFrame run(std::uint32_t frame, std::size_t number, const Sink& sink) {
    const SceneQuery& q = scene_.queries[number];
    QueryFrame result;
    const auto start = Clock::now();
    const std::uint64_t before = board_.cycles(), before_ps = board_.time_ps();
    const std::uint64_t written = board_.words_uploaded();
    secondaries_.show(q.secondaries, frame);
    result.secondary_words = board_.words_uploaded() - written;
    result.secondary_cycles = board_.cycles() - before;
    result.secondary_ps = board_.time_ps() - before_ps;
    result.pass_seconds = seconds_since(start);
    const SelfPairs self(scene_, q);
    const Shapes& there = secondaries_.placed();
    faults_.flip(frame, size(there) * words(shape_of(there)));
    const std::uint64_t shown_ps = board_.time_ps();
    primaries_.show(q.primaries, frame);
    result.primary_ps = board_.time_ps() - shown_ps;
    const std::size_t packets =
        (size(primaries_.placed()) + card::kMostPrimaries - 1) / card::kMostPrimaries;
    for (std::size_t packet = 0; packet < packets; ++packet) {
      const auto progress = [&](double share) {
        if (options_.progress)
          options_.progress(frame,
                            (static_cast<double>(packet) + share) / static_cast<double>(packets));
      };
      progress(0);
      run_packet({frame, number, packet, self, progress, sink}, result);
    }
    return result;
  }

  /// The work of one packet.
  struct Packet {
    std::uint32_t frame;
    std::size_t query, number;
    const SelfPairs& self;
    const std::function<void(double)>& progress;
    const Sink& sink;
    std::size_t active = 0;  // number of primaries that are not masked
  };

  void run_packet(Packet packet, QueryFrame& result) {
    const SceneQuery& q = scene_.queries[packet.query];
    const Shapes& primaries = primaries_.placed();
    const std::size_t first = packet.number * card::kMostPrimaries;
    const std::size_t count = std::min(card::kMostPrimaries, size(primaries) - first);
    Query query{.mode = q.mode,
                .pair = q.pair,
                .swap = q.swap,
                .normals = q.normals,
                .iterations = q.iterations,
                .deadline_cycles = options_.deadline_cycles,
                .watchdog = options_.watchdog};
    std::vector<std::uint32_t> active;
    for (std::size_t p = 0; p < count; ++p) {
      const auto n = static_cast<std::uint32_t>(first + p);
      query.stencil[p] = contains(q.mask, n);
      if (!query.stencil[p]) active.push_back(n);
    }
    if (active.empty()) return;  // no work for the card
    packet.active = active.size();
    const bool streams = through(packet, query);  // written during the pass, not loaded
    if (through_[packet.query] && !streams)
      result.brute_force_reason =
          secondaries_.no_bvh().value_or(*board_.why_not_traversable(query));
    std::optional<PassCheck> check;
    if (options_.check != Check::kNone)
      check.emplace(q, card_, board_, packet.self, primaries, sampled(active, packet.frame),
                    secondaries_.placed(), streams);
    const auto deliver = [&](std::span<const Record> records) {
      for (const Record& r : records) result.hits += r.f ? 1 : 0;
      result.counters.records += records.size();
      const auto checking = Clock::now();
      if (check) check->check(records);
      result.check_seconds += seconds_since(checking);
      if (packet.sink) packet.sink(packet.query, records);
    };
    const auto passes = packet.self.passes(first, count, secondaries_.moved_by_card());
    const auto& waves = options_.waves_of;
    const bool here = waves && waves->frame == packet.frame && waves->query == packet.query &&
                      waves->number == packet.number;
    if (here && options_.on_packet)
      options_.on_packet({primaries, secondaries_.placed(), counting(packet.self)});
    if (here) trace_open();
    if (!passes.empty() && !streams) load(first, count, result);
    if (!packet.self.any() || q.mode == Mode::kAll || q.mode == Mode::kHits) {
      for (const SelfPairs::PassRange& range : passes) pass(packet, query, range, deliver, result);
    } else {
      Chosen chosen(q, scene_.card.format, primaries, active);
      for (const SelfPairs::PassRange& range : passes)
        pass(
            packet, query, range,
            [&](std::span<const Record> some) {
              for (const Record& r : some) chosen.take(r);
            },
            result);
      deliver(chosen.records());
    }
    const auto checking = Clock::now();
    if (check) check->finish(result);
    result.check_seconds += seconds_since(checking);
    if (here) trace_close();
  }

  void load(std::size_t first, std::size_t count, QueryFrame& result) {
    const auto start = Clock::now();
    const std::uint64_t before = board_.cycles(), before_ps = board_.time_ps();
    const std::uint64_t words = board_.words_uploaded();
    primaries_.load(first, count);
    result.pass_seconds += seconds_since(start);
    result.primary_ps += board_.time_ps() - before_ps;
    result.primary_words += board_.words_uploaded() - words;
    const std::uint64_t loading = board_.cycles() - before;
    result.primary_cycles += loading;
    result.counters.upload_cycles += loading;
    result.counters.total_cycles += loading;
  }

  [[nodiscard]] bool through(const Packet& packet, const Query& query) const {
    return through_[packet.query] && !board_.why_not_traversable(query);
  }

  /// One pass of the packet, loaded before unless it traverses. `take` gets the records of pairs
  /// that count.
  void pass(const Packet& packet, Query query, const SelfPairs::PassRange& range,
            const RecordSink& take, QueryFrame& result) {
    const bool streams = through(packet, query);
    if (!streams && !secondaries_.moved_by_card()) {
      query.first_secondary = static_cast<std::uint32_t>(range.first);
      query.secondary_count = static_cast<std::uint32_t>(range.count);
    }
    if (range.pairwise) query.mode = query.mode == Mode::kAny ? Mode::kHits : Mode::kAll;
    if (options_.progress) {
      query.progress = [&](double share) {
        packet.progress(
            (static_cast<double>(range.first) + share * static_cast<double>(range.count)) /
            static_cast<double>(size(secondaries_.placed())));
      };
    }
    const bool pairwise = query.mode == Mode::kAll || query.mode == Mode::kHits;
    const auto first = static_cast<std::uint32_t>(packet.number * card::kMostPrimaries);
    const auto start = Clock::now();
    double host = 0;
    std::uint64_t seen = 0;
    std::vector<Record> renumbered;
    const RecordSink receive = [&](std::span<const Record> records) {
      const auto received = Clock::now();
      result.card_records += records.size();
      renumbered.clear();
      for (Record r : records) {
        r.primary += first;
        // A bad secondary's number is not in its record. But all records arrive in order, so it can
        // be counted.
        const std::uint64_t secondary =
            query.mode == Mode::kAll ? range.first + seen++ / packet.active : r.index;
        if (pairwise && !packet.self.counts(r.primary, static_cast<std::uint32_t>(secondary)))
          continue;
        renumbered.push_back(r);
      }
      if (!renumbered.empty()) take(renumbered);
      host += seconds_since(received);
    };
    Counters c = streams ? stream(packet, query, receive) : board_.run(query, receive);
    result.pass_seconds += seconds_since(start) - host;
    // The board counts its last load in every pass, and also the records that it wrote.
    c.total_cycles -= c.upload_cycles;
    c.upload_cycles = 0;
    c.records = 0;
    result.counters += c;
    ++result.passes;
    result.download_cycles += c.total_cycles - std::min(c.total_cycles, c.cycles + c.writeback);
  }

  /// Runs the pass through the BVH.
  Counters stream(const Packet& packet, const Query& query, const RecordSink& receive) {
    return std::visit(
        [&](const auto& list) {
          const std::size_t first = packet.number * card::kMostPrimaries;
          const std::span all(list);
          return board_.cast_shapes(
              all.subspan(first, std::min(card::kMostPrimaries, all.size() - first)), query,
              receive, false);
        },
        primaries_.placed());
  }

  /// The sampled primaries, whose records are compared, ascending.
  [[nodiscard]] std::vector<std::uint32_t> sampled(std::vector<std::uint32_t> active,
                                                   std::uint32_t frame) const {
    if (options_.check != Check::kSample || active.size() <= kSampledPrimaries) return active;
    for (std::uint64_t i = 0; i < kSampledPrimaries; ++i) {
      const std::uint64_t left = active.size() - i;
      std::swap(active[i], active[i + random_bits(active[0], frame, i) % left]);
    }
    active.resize(kSampledPrimaries);
    std::sort(active.begin(), active.end());
    return active;
  }

  const Scene& scene_;
  RunnerOptions options_;
  BoardConfig card_;
  Board board_;
  std::vector<bool> through_;  ///< by query: whether its primaries traverse the BVH
  scene_runner::Secondaries secondaries_;
  scene_runner::Primaries primaries_;
  scene_runner::Faults faults_;
  bool traced_ = false;
};

SceneRunner::SceneRunner(const Scene& scene, const Plan& plan, RunnerOptions options) {
  for (const ScheduledFault& fault : options.faults) check_fault(fault, plan.board);
  impl_ = std::make_unique<Impl>(scene, plan, std::move(options));
}
SceneRunner::~SceneRunner() = default;

std::vector<QueryFrame> SceneRunner::run_frame(std::uint32_t frame, const Sink& sink) {
  return impl_->run_frame(frame, sink);
}

const std::vector<bool>& SceneRunner::injected() const {
  return impl_->injected();
}

void SceneRunner::trace_close() {
  impl_->trace_close();
}

const Board& SceneRunner::board() const {
  return impl_->board();
}

}  // namespace cde
