// SPDX-License-Identifier: Apache-2.0
// Runs a pass: invokeCDE and downloadSRAM.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "card/bvh_pass.hpp"
#include "card/card_pass.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/contract/records.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

/// One pass from go to the last record.
class Pass : private CardPass {
 public:
  Pass(Board::Impl& card, const Query& query, const RecordSink& sink)
      : CardPass(card, query), sink_(sink), secondaries_(card.tested_secondaries(query)) {
    split_ = card.split();
    const unsigned second = query.second ? card.second_loaded : 0;
    slots_ = second != 0 ? split_ + second : card.loaded;
    stencil_ = query.stencil;
    for (unsigned p = card.loaded; p < card.primaries; ++p) {
      // Slots between the two pairs' primaries are empty. The query's bits do not count them.
      const unsigned number = p - split_ + card.loaded;
      stencil_[p] = p < split_ || number >= card.primaries || query.stencil[number];
    }
    for (unsigned p = 0; p < slots_; ++p) active_ += stencil_[p] ? 0u : 1u;
    const std::uint64_t rows = (std::max(card.loaded, second) + card.lanes - 1) / card.lanes;
    // An iterative pipeline takes a row in as many cycles as the pair needs passes.
    const std::uint64_t passes =
        std::max(reference::passes(*query.pair, query.iterations),
                 query.second ? reference::passes(query.second->pair, query.iterations) : 0u);
    const bool sat =
        has_sat_interval(*query.pair) || (query.second && has_sat_interval(query.second->pair));
    // Behind the certified filter, a row takes up to one cycle per lane.
    const bool filter = card.filter && (has_filter(*query.pair) ||
                                        (query.second && has_filter(query.second->pair)));
    const std::uint64_t cycles_per_row = passes != 0 ? passes
                                         : filter    ? card.lanes
                                         : sat       ? card.sat_interval
                                                     : card.row_cycles;
    const std::uint64_t rows_total = rows * secondaries_ * cycles_per_row;
    streaming_ = query.mode == Mode::kAll || query.mode == Mode::kHits;
    const std::uint64_t records = streaming_ ? active_ * secondaries_ : active_;
    expected_cycles_ = rows_total + (streaming_ && query.mode == Mode::kAll ? records : 0) + 1;
    // Twice the worst case: all rows, writing and reading back all records, memory latency per
    // slot, whose words may come in halves, and register accesses.
    constexpr std::uint64_t kAccessesPs = 100'000'000;
    const std::uint64_t halves = 2 * std::uint64_t{words(card.secondary_shape)};
    const std::uint64_t worst = rows_total + 2 * (2 + beats_of(1) + record_cycles()) * records +
                                secondaries_ * (card.ddr_latency / 32 + 2 + halves) + 8192 +
                                card.pipe_latency + passes * contract::kIterativeRows +
                                kAccessesPs / card.period_ps;
    ring_entries_ = query.normals ? 2 : 1;
    deadline_ = query.deadline_cycles != 0 ? query.deadline_cycles : 2 * worst;
  }

  /// Core cycles that a record takes over the bus, in transfers of the least size.
  [[nodiscard]] std::uint64_t record_cycles() const {
    const std::uint64_t together =
        std::min<std::uint64_t>({off_full_ring(), card_.sram_records, 1024});
    const std::uint64_t ps =
        card_.bus.transfer(static_cast<std::uint32_t>(8 * beats_of(together)), true).cycles.ps() +
        3 * card_.bus.read().ps();
    return ps / (together * card_.period_ps) + 1;
  }

  Counters execute() {
    configure();
    try {
      card_.write_register(card::kRegControl, card::kControlGo);
      wait_until_done();
      drain(card_.read_register(card::kRegRecords));
      return finish();
    } catch (...) {
      abort();
      throw;
    }
  }

 private:
  void configure() {
    card_.write_register(card::kRegControl, card::kControlClear);
    card_.write_register(card::kRegCommand, card::kCommandMode(query_.mode) |
                                                (query_.swap ? card::kCommandSwap : 0) |
                                                (query_.normals ? card::kCommandNormals : 0) |
                                                card::kCommandPair(*query_.pair) | second());
    card_.write_register(card::kRegPrimCount, slots_);
    card_.write_register(card::kRegPrimSplit, split_);
    card_.write_register(card::kRegIterations, card::kIterationsM(query_.iterations.samples) |
                                                   card::kIterationsK1(query_.iterations.circle) |
                                                   card::kIterationsK2(query_.iterations.free));
    if (card_.objects.entries != 0)
      card_.write_register(card::kRegObjectCount, card_.objects.objects.size());
    if (card_.primary_objects.entries != 0)
      card_.write_register(card::kRegPrimObjectCount, card_.primary_objects.objects.size());
    card_.write_register(card::kRegSecFirst, query_.first_secondary);
    card_.write_register(card::kRegSecCount,
                         card_.objects.objects.empty() ? secondaries_ : card_.secondaries);
    for (unsigned base = 0; base < card_.primaries; base += 64) {
      std::uint64_t mask = 0;
      for (unsigned p = 0; p < 64; ++p) mask |= std::uint64_t{stencil_[base + p]} << p;
      card_.write_register(card::kRegStencil + base / 8, mask);
    }
  }

  /// The second pair's part of the command.
  [[nodiscard]] std::uint64_t second() const {
    if (!query_.second) return 0;
    return card::kCommandSecond | (query_.second->swap ? card::kCommandSecondSwap : 0) |
           card::kCommandSecondPair(query_.second->pair);
  }

  /// Waits for the end of the pass. In the streaming modes it takes records meanwhile, once they
  /// fill long bursts.
  void wait_until_done() {
    // Slices are short enough for the watchdog and for records, and long enough to cost little.
    constexpr std::uint64_t kSlice = 16384, kStreamSlice = 4096, kEnough = 1024;
    for (;;) {
      const std::uint64_t spent = card_.cycles() - started_;
      if (spent >= deadline_) timeout(fmt::format("deadline of {} cycles", deadline_));
      const std::uint64_t status =
          work(std::min(streaming_ ? kStreamSlice : kSlice, deadline_ - spent));
      if (bit(status, card::kStatusDone)) return;
      const bool full = bit(status, card::kStatusSramWait);
      if (full || streaming_) {
        const std::uint64_t waiting = card_.read_register(card::kRegRecords);
        if (full)
          drain(std::min(off_full_ring(), waiting));
        else if (waiting >= kEnough)
          drain(waiting - waiting % 2);
      }
      check_watchdog();
      tell_progress(std::min(1.0, static_cast<double>(card_.cycles() - started_) /
                                      static_cast<double>(expected_cycles_)));
    }
  }

  /// Takes this many ring entries, which the ring must hold. A record with normals is two entries.
  void drain(std::uint64_t wanted) {
    constexpr std::uint64_t kChunk = 8192;
    while (wanted != 0) {
      const std::uint64_t n = std::min(wanted, kChunk);
      fetch(n);
      records_.clear();
      for (std::uint64_t i = 0; i < n; ++i) take(&words_[card::kRecordWords * i]);
      received_ += n;
      wanted -= n;
      if (!records_.empty()) sink_(records_);
    }
  }

  void take(const std::uint32_t* entry) {
    check_numbers(entry);
    const bool normal = bit(entry[card::kRecordFlags], card::kFlagNormal);
    if (normal != half_.has_value())
      device_error("a record without its normal", card_.read_register(card::kRegStatus));
    if (normal) {
      half_->n = decode(entry, card_.coding).cp;
      records_.push_back(*half_);
      half_.reset();
      return;
    }
    Record r = decode(entry, card_.coding);
    if (r.index != ~0u)
      r.index += query_.first_secondary;  // the card counts from the first secondary
    if (query_.second && r.primary >= split_) r.primary -= split_ - card_.loaded;
    if (query_.normals) {
      half_ = r;
    } else {
      records_.push_back(r);
    }
  }

  /// A format narrower than the card's words leaves the upper bits zero.
  void check_numbers(const std::uint32_t* entry) {
    const auto width = static_cast<unsigned>(card_.format.width());
    if (width == kCardWord) return;
    for (const unsigned k :
         {card::kRecordCp, card::kRecordCp + 1, card::kRecordCp + 2, card::kRecordT})
      if (entry[k] >> width != 0)
        device_error(fmt::format("a record has the word {:#010x}, which does not exist in {}",
                                 entry[k], card_.format.name()),
                     card_.read_register(card::kRegStatus));
  }

  Counters finish() {
    Counters c;
    c.cycles = card_.read_register(card::kRegCycles);
    c.writeback = card_.read_register(card::kRegWriteback);
    c.rows = card_.read_register(card::kRegRows);
    c.stalls = card_.read_register(card::kRegStalls);
    c.bubbles = card_.read_register(card::kRegBubbles);
    if (card_.filter) c.uncertain = card_.read_register(card::kRegUncertain);
    c.bad_primaries = card_.read_register(card::kRegBadPrim);
    c.bad_secondaries = card_.read_register(card::kRegBadSec);
    c.secondaries = card_.read_register(card::kRegSecondaries);
    c.pairs = c.secondaries * active_;
    c.records = card_.read_register(card::kRegWritten);
    const std::uint64_t status = check_end(c);
    const auto promise = [&](const char* what, std::uint64_t value, std::uint64_t wanted) {
      if (value != wanted)
        device_error(fmt::format("{} {}; expected {}", value, what, wanted), status);
    };
    promise("records downloaded", received_, c.records);
    if (query_.mode != Mode::kAny) promise("secondaries tested", c.secondaries, secondaries_);
    const std::uint64_t each = ring_entries_;
    if (query_.mode == Mode::kAll) promise("records", received_, c.secondaries * active_ * each);
    if (!streaming_) promise("records", received_, active_ * each);
    c.records = received_ / each;
    c.upload_cycles = card_.load_cycles;
    c.total_cycles = card_.cycles() - started_ + card_.load_cycles;
    c.time = times();
    c.time.write_back = std::min(c.time.engine, c.writeback * card_.period_ps);
    c.time.engine -= c.time.write_back;
    return c;
  }

  [[nodiscard]] std::string state() override {
    return fmt::format(
        "status {:#x}, {} of {} secondaries tested, {} rows issued, {} records waiting, cycle {}",
        card_.read_register(card::kRegStatus), card_.read_register(card::kRegSecondaries),
        secondaries_, card_.read_register(card::kRegRows), card_.read_register(card::kRegRecords),
        card_.cycles());
  }

  const RecordSink& sink_;
  std::uint64_t secondaries_;  // number of secondaries
  std::uint64_t deadline_ = 0, expected_cycles_ = 0, received_ = 0;
  unsigned active_ = 0, slots_ = 0, split_ = 0;  // numbers of primaries
  Stencil stencil_;
  std::uint64_t ring_entries_ = 1;  // per record
  bool streaming_ = false;
  std::vector<Record> records_;
  std::optional<Record> half_;  // waits for its normal
};

}  // namespace

namespace {

void check_shapes(const Board::Impl& card, Pair pair, bool swap, Shape loaded) {
  Shape primary = primary_shape(pair), secondary = secondary_shape(pair);
  if (swap) std::swap(primary, secondary);
  if (primary != loaded || secondary != card.secondary_shape)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("{} needs loaded {}s and uploaded {}s; the board has {}s and {}s", name(pair),
                    name(primary), name(secondary), name(loaded), name(card.secondary_shape)));
}

void check_second(const Board::Impl& card, const Query& q) {
  const auto require = [](bool ok, const std::string& why) {
    if (!ok) throw Error(ErrorCode::kUsage, why);
  };
  const Pair pair = q.second->pair;
  require(card.parallel, "this card works on one pair at a time");
  require(pair != *q.pair, fmt::format("the card has one pipe for {}, not two", name(pair)));
  require(std::find(card.pairs.begin(), card.pairs.end(), pair) != card.pairs.end(),
          fmt::format("this card has no pipe for {}", name(pair)));
  require(!q.second->swap || card.can_swap, "this card cannot exchange primaries and secondaries");
  require(
      q.mode != Mode::kAll && q.mode != Mode::kHits,
      "two pairs at a time keep one record per primary; expected mode nearest, farthest or any");
  require(!q.normals || is_solid(pair), "rays have no normals");
  require(card.second_loaded != 0, "no primaries were loaded for the second pair");
  check_shapes(card, pair, q.second->swap, card.second_shape);
}

/// Completes the query with its pair. The card must have that pair, and it must fit the uploaded
/// secondaries and the loaded primaries.
Query complete(const Board::Impl& card, const Query& query, Shape loaded) {
  if (card.secondaries == 0)
    throw Error(ErrorCode::kUsage, "no secondaries were uploaded to the board");
  Query q = query;
  (void)name_of(q.mode);  // throws for an unknown mode
  check_watchdog(q.watchdog);
  if (q.first_secondary != 0 || q.secondary_count != 0) {
    if (!card.objects.objects.empty())
      throw Error(ErrorCode::kUsage, "a range of secondaries cannot be combined with objects");
    if (q.first_secondary >= card.secondaries ||
        q.secondary_count > card.secondaries - q.first_secondary)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} secondaries from {} on exceed the {} uploaded", q.secondary_count,
                              q.first_secondary, card.secondaries));
  }
  if (!q.pair) {
    if (card.pairs.size() != 1)
      throw Error(ErrorCode::kUsage, "the card has several pipes; the query must name its pair");
    q.pair = card.pairs.front();
  }
  if (std::find(card.pairs.begin(), card.pairs.end(), *q.pair) == card.pairs.end())
    throw Error(ErrorCode::kUsage, fmt::format("this card has no pipe for {}", name(*q.pair)));
  if (q.swap && !card.can_swap)
    throw Error(ErrorCode::kUsage, "this card cannot exchange primaries and secondaries");
  if (q.normals && (!card.has_normals || !is_solid(*q.pair)))
    throw Error(ErrorCode::kUsage,
                is_solid(*q.pair) ? "this card has no normals" : "rays have no normals");
  check_shapes(card, *q.pair, q.swap, loaded);
  if (q.second) check_second(card, q);
  q.iterations.check();
  return q;
}

void require_sink(const RecordSink& sink) {
  if (!sink) throw Error(ErrorCode::kUsage, "records need a sink, and this sink is empty");
}

/// Sets a flag during its lifetime.
class Passing {
 public:
  explicit Passing(bool& flag) : flag_(flag) { flag_ = true; }
  ~Passing() { flag_ = false; }
  Passing(const Passing&) = delete;
  Passing& operator=(const Passing&) = delete;

 private:
  bool& flag_;
};

/// Whether the query traverses the BVH. Error kUsage if it must and cannot.
bool through_bvh(const Board::Impl& card, const Query& query) {
  if (query.through > Through::kBruteForce)
    throw Error(ErrorCode::kUsage,
                fmt::format("there is no Through value {}", static_cast<unsigned>(query.through)));
  if (query.through == Through::kBruteForce) return false;
  const auto why = card.why_not_traversable(query);
  if (why && query.through == Through::kBvh)
    throw Error(ErrorCode::kUsage, "this query cannot traverse a BVH: " + *why);
  return !why;
}

/// Runs a pass again if the bus lost records: every run gives the same records.
template <class Attempt>
Counters with_retries(Board::Impl& card, const Attempt& attempt) {
  for (unsigned failures = 0;;) {
    try {
      return attempt();
    } catch (const Error& error) {
      if (!error.fault() || !error.fault()->repeatable || ++failures > card.pass_retry_limit) throw;
      ++card.pass_retries;
    }
  }
}

Counters traverse(Board::Impl& card, const Query& query, std::span<const std::uint32_t> numbers,
                  const BvhPass::Rays& rays, std::vector<Record>& records) {
  records.clear();
  if (numbers.empty()) return {};
  return with_retries(card, [&] {
    card.prepare_objects();
    return BvhPass(card, query, numbers, rays).execute(records);
  });
}

/// Reduces a record of mode any to the record of mode occluded.
Record f_alone(const Record& any) {
  Record r;
  r.f = any.f;
  r.primary = any.primary;
  if (!any.bad) return r;
  r.bad = true;
  r.t = any.t;
  r.cp = any.cp;
  return r;
}

/// A brute-force pass over all secondaries. `present` throws if the board is gone.
Counters brute_force(Board::Impl& card, const Query& query, const RecordSink& sink,
                     const std::function<void()>& present) {
  Query asked = query;
  std::vector<Record> blank;
  RecordSink out = sink;
  if (query.mode == Mode::kOccluded) {
    asked.mode = Mode::kAny;
    out = [&](std::span<const Record> some) {
      blank.clear();
      std::transform(some.begin(), some.end(), std::back_inserter(blank), f_alone);
      sink(blank);
    };
  }
  // A repeated pass skips the records that `sink` already has.
  std::uint64_t delivered = 0;
  return with_retries(card, [&] {
    std::uint64_t known = delivered;
    const RecordSink rest = [&](std::span<const Record> some) {
      const std::uint64_t skipped = std::min<std::uint64_t>(known, some.size());
      known -= skipped;
      delivered += some.size() - skipped;
      if (skipped == some.size()) return;
      out(some.subspan(skipped));
      present();
    };
    card.prepare();
    return Pass(card, asked, rest).execute();
  });
}

/// Most primaries per traversal pass. A large pass hides the latency of its last primaries. But the
/// driver keeps a pass's records until it ends, and mode hits has up to one record per pair.
std::size_t max_per_pass(const Board::Impl& card, Shape shape, Mode mode) {
  if (mode != Mode::kHits) return 65'536;
  return shape == Shape::kRay ? 4096 : card.primaries;
}

}  // namespace

Counters Board::run(const Query& query, const RecordSink& sink) {
  idle_card().link->alive();
  require_sink(sink);
  const std::shared_ptr<Impl> kept = impl_;  // survives if a callback destroys the board
  Impl& it = *kept;
  const auto present = [&kept] {
    if (kept.use_count() == 1)
      throw Error(ErrorCode::kUsage, "the sink or progress of a pass destroyed its board");
  };
  if (it.secondaries != 0 && it.loaded == 0)
    throw Error(ErrorCode::kUsage, "no primaries were loaded into the board");
  Query whole = complete(it, query, it.primary_shape);
  if (query.progress) {
    whole.progress = [&](double share) {
      query.progress(share);
      present();
    };
  }
  const bool through = through_bvh(it, whole);
  const Passing passing(it.passing);
  if (!through) return brute_force(it, whole, sink, present);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t p = 0; p < it.loaded; ++p)
    if (!query.stencil[p]) numbers.push_back(p);
  std::vector<Record> records;
  const auto ray = [&](std::uint32_t i, std::uint32_t* words) {
    std::copy_n(it.loaded_words(numbers[i]), cde::words(it.primary_shape), words);
  };
  Counters c = traverse(it, whole, numbers, ray, records);
  c.upload_cycles += it.load_cycles;
  c.total_cycles += it.load_cycles;
  c.time.load += it.load_ps;
  if (!records.empty()) sink(records);
  present();
  return c;
}

std::vector<Record> Board::run(const Query& query, Counters* counters) {
  std::vector<Record> records;
  const Counters c = run(query, [&](std::span<const Record> some) {
    records.insert(records.end(), some.begin(), some.end());
  });
  if (counters != nullptr) *counters = c;
  return records;
}

Counters Board::cast(const RayView& rays, const Query& query, const RecordSink& sink) {
  return cast_words(
      Shape::kRay, rays.size(),
      [&](std::size_t i, float* words) { to_words(rays[i], slot<Ray>(words)); }, query, sink);
}

Counters Board::cast_words(Shape shape, std::size_t count, const Words& words, const Query& query,
                           const RecordSink& sink) {
  if (count > 0xffffffff)
    throw Error(ErrorCode::kCapacity,
                fmt::format("{} {}s are more than 2^32 - 1", count, name(shape)));
  idle_card().link->alive();
  require_sink(sink);
  (void)name_of(query.mode);
  if (count != 0 && through_bvh(card(), complete(card(), query, shape)))
    return cast_through(shape, count, words, query, sink);
  const std::size_t packet = primaries();
  Counters total;
  Query each = query;
  std::vector<Record> renumbered;
  for (std::size_t first = 0; first < count; first += packet) {
    const std::size_t some = std::min(packet, count - first);
    if (query.progress) {
      each.progress = [&](double share) {
        query.progress((static_cast<double>(first) + share * static_cast<double>(some)) /
                       static_cast<double>(count));
      };
    }
    load_words(shape, some, [&](std::size_t i, float* at) { words(first + i, at); });
    total += run(each, [&](std::span<const Record> records) {
      renumbered.assign(records.begin(), records.end());
      for (Record& r : renumbered) r.primary += static_cast<std::uint32_t>(first);
      sink(renumbered);
    });
  }
  return total;
}

Counters Board::cast_through(Shape shape, std::size_t count, const Words& shapes,
                             const Query& query, const RecordSink& sink) {
  const std::shared_ptr<Impl> kept = impl_;
  Impl& it = *kept;
  const Query whole = complete(it, query, shape);
  const std::size_t batch = max_per_pass(it, shape, query.mode);
  Counters total;
  std::vector<std::uint32_t> numbers;
  std::vector<Record> records;
  for (std::size_t first = 0; first < count; first += batch) {
    const std::size_t end = std::min(count, first + batch);
    numbers.clear();
    for (std::size_t i = first; i < end; ++i)
      if (!query.stencil[i % it.primaries]) numbers.push_back(static_cast<std::uint32_t>(i));
    Query each = whole;
    if (query.progress) {
      each.progress = [&](double share) {
        query.progress((static_cast<double>(first) + share * static_cast<double>(end - first)) /
                       static_cast<double>(count));
      };
    }
    const Passing passing(it.passing);
    total += traverse(
        it, each, numbers,
        [&](std::uint32_t i, std::uint32_t* words) {
          std::array<float, contract::kMostWords> floats{};
          shapes(numbers[i], floats.data());
          it.encode(shape, numbers[i], std::span(floats).first(cde::words(shape)), words);
        },
        records);
    if (records.empty()) continue;
    sink(records);
    if (kept.use_count() == 1)
      throw Error(ErrorCode::kUsage, "the sink or progress of a pass destroyed its board");
  }
  return total;
}

std::vector<Record> Board::cast(const RayView& rays, const Query& query) {
  std::vector<Record> records;
  cast(rays, query, [&](std::span<const Record> some) {
    records.insert(records.end(), some.begin(), some.end());
  });
  return records;
}

}  // namespace cde
