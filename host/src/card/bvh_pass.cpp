// SPDX-License-Identifier: Apache-2.0
#include "card/bvh_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

constexpr unsigned kPlaceWords = 8;
unsigned words_of(const Query& query) {
  return words(query.swap ? secondary_shape(*query.pair) : primary_shape(*query.pair));
}
/// Rays written at a time after go, enough for long transfers. Before go, the driver fills all
/// places, so that small passes measure only the card's own time.
constexpr std::uint32_t kMoreRays = 1024;

}  // namespace

std::string node_fault(Board::Impl& card, std::uint64_t fault) {
  const std::uint64_t place = card::kNodeFaultPlace.of(fault);
  const auto what = [&] {
    switch (card::kNodeFaultKind.of(fault)) {
      case card::kNodeFaultNode:
        return fmt::format("node {} was requested; there are {}", place, card.bvh.nodes);
      case card::kNodeFaultSlot:
        return fmt::format("slot {} was requested; there are {}", place, card.bvh.slots);
      case card::kNodeFaultIndex:
        return fmt::format("slot {} has a secondary above the {} uploaded", place,
                           card.secondaries);
      case card::kNodeFaultObject:
        return fmt::format("slot {} has an object above the {} of the card", place,
                           card.objects.objects.size());
      case card::kNodeFaultDepth:
        return fmt::format("node {} has more than {} levels above it", place, Bvh::kMostDepth);
      case card::kNodeFaultNodeBits:
        return fmt::format("node {} has an uncorrectable error", place);
      case card::kNodeFaultSlotBits:
        return fmt::format("slot {} has an uncorrectable error", place);
      default:
        return fmt::format("its traversal does not end; the last node was {}", place);
    }
  };
  return "the BVH in the card's memory is malformed: " + what();
}

BvhPass::BvhPass(Board::Impl& card, const Query& query, std::span<const std::uint32_t> numbers,
                 const Rays& rays)
    : CardPass(card, query),
      numbers_(numbers),
      normals_(query.normals && query.mode != Mode::kOccluded),
      place_words_(words_of(query) > kPlaceWords ? 2 * kPlaceWords : kPlaceWords),
      places_(card.ray_places * kPlaceWords / place_words_),
      rays_(rays),
      last_progress_(started_) {}

Counters BvhPass::execute(std::vector<Record>& records) {
  configure();
  try {
    provide(places_);
    card_.write_register(card::kRegControl, card::kControlGo);
    wait_until_done();
    drain(card_.read_register(card::kRegRecords));
    const Counters counters = finish();
    put_in_order(records);
    if (query_.progress) query_.progress(1);
    return counters;
  } catch (...) {
    abort();
    throw;
  }
}

void BvhPass::configure() {
  card_.write_register(card::kRegControl, card::kControlClear);
  card_.write_register(card::kRegCommand, card::kCommandMode(query_.mode) | card::kCommandBvh |
                                              (query_.swap ? card::kCommandSwap : 0) |
                                              (normals_ ? card::kCommandNormals : 0) |
                                              card::kCommandPair(*query_.pair));
  card_.configure_bvh(0, card_.bvh.nodes);
  card_.write_register(card::kRegRayCount, numbers_.size());
}

bool BvhPass::provide(std::uint32_t most) {
  const auto all = static_cast<std::uint32_t>(numbers_.size());
  const std::uint32_t wanted = std::min(most, all - provided_);
  if (wanted == 0) return true;
  if (provided_ + wanted - taken_ > places_) taken_ = taken();
  if (provided_ + wanted - taken_ > places_) return false;
  write_rays(wanted);
  card_.write_register(card::kRegRays, provided_);
  return provided_ == all;
}

std::uint32_t BvhPass::taken() const {
  const auto now =
      static_cast<std::uint32_t>(card::kRaysTaken.of(card_.read_register(card::kRegRays)));
  return std::max(now, taken_);  // after its end a pass reports 0
}

void BvhPass::write_rays(std::uint32_t count) {
  const std::uint64_t before = card_.link->time_ps();
  while (count != 0) {
    const std::uint32_t place = provided_ % places_;
    const std::uint32_t n = std::min(count, places_ - place);
    ray_words_.assign(std::size_t{n} * place_words_, 0);
    for (std::uint32_t i = 0; i < n; ++i)
      rays_(provided_ + i, &ray_words_[std::size_t{i} * place_words_]);
    card_.write(card::kSpaceRays, place * place_words_ * 4, ray_words_.data(),
                std::uint64_t{n} * place_words_ / 2);
    provided_ += n;
    count -= n;
  }
  ray_ps_ += card_.link->time_ps() - before;
}

void BvhPass::wait_until_done() {
  constexpr std::uint64_t kSlice = 16384, kRaySlice = 512, kStreamSlice = 4096, kEnough = 1024;
  const bool hits = query_.mode == Mode::kHits;
  for (bool all = false;;) {
    bool wrote = false;
    if (!all) {
      const std::uint32_t before = provided_;
      all = provide(std::min(kMoreRays, places_ / 2));
      wrote = provided_ != before;
    }
    // After it wrote rays, the driver gives the card only one clock before it checks again.
    const std::uint64_t status = work(until_deadline(wrote  ? 1
                                                     : !all ? kRaySlice
                                                     : hits ? kStreamSlice
                                                            : kSlice));
    if (bit(status, card::kStatusDone)) {
      if (bit(status, card::kStatusNodeError)) {
        const std::uint64_t fault = card_.read_register(card::kRegNodeFault);
        device_error(
            node_fault(card_, fault) +
                (bit(status, card::kStatusEccError) ? ", and DDR has an uncorrectable error" : ""),
            status, card::kNodeFaultPlace.of(fault));
      }
      return;
    }
    const bool full = bit(status, card::kStatusSramWait);
    if (full || hits) {
      const std::uint64_t waiting = card_.read_register(card::kRegRecords);
      if (full)
        drain(std::min(off_full_ring(), waiting));
      else if (waiting >= kEnough)
        drain(waiting - waiting % 2);
    }
    if (!wrote) check_progress();
    check_watchdog();
    if (query_.progress) {
      taken_ = taken();
      tell_progress(static_cast<double>(taken_) / static_cast<double>(numbers_.size()));
    }
  }
}

/// The smaller of `cycles` and the cycles until the deadline.
std::uint64_t BvhPass::until_deadline(std::uint64_t cycles) const {
  if (query_.deadline_cycles == 0) return cycles;
  const std::uint64_t gone = card_.cycles() - started_;
  if (gone >= query_.deadline_cycles) return 1;
  return std::min(cycles, query_.deadline_cycles - gone);
}

void BvhPass::check_progress() {
  const std::uint64_t now = card_.cycles();
  if (query_.deadline_cycles != 0) {
    if (now - started_ >= query_.deadline_cycles)
      timeout(fmt::format("deadline of {} cycles", query_.deadline_cycles));
    return;
  }
  // The card always ends by itself, unless the memory never answers.
  const std::uint64_t still = 1'000'000 + 1'000 * std::uint64_t{card_.ddr_latency};
  if (now - last_progress_ < still / 2) return;
  const std::uint64_t nodes = card_.read_register(card::kRegNodes) +
                              card_.read_register(card::kRegTested) +
                              card_.read_register(card::kRegWritten);
  if (nodes == last_nodes_ && now - last_progress_ >= still)
    timeout(fmt::format("limit of {} cycles without progress", still));
  if (nodes != last_nodes_) last_progress_ = now;
  last_nodes_ = nodes;
}

void BvhPass::drain(std::uint64_t wanted) {
  constexpr std::uint64_t kChunk = 8192;
  while (wanted != 0) {
    const std::uint64_t n = std::min(wanted, kChunk);
    fetch(n);
    for (std::uint64_t i = 0; i < n; ++i) take(&words_[card::kRecordWords * i]);
    received_ += n;
    wanted -= n;
  }
}

void BvhPass::take(const std::uint32_t* entry) {
  const bool normal = bit(entry[card::kRecordFlags], card::kFlagNormal);
  if (normal != has_half_)
    device_error("a record without its normal", card_.read_register(card::kRegStatus));
  const Record r = decode(entry, card_.coding);
  if (normal)
    records_.back().n = r.cp;
  else
    records_.push_back(r);
  has_half_ = normals_ && !normal;
}

Counters BvhPass::finish() {
  Counters c;
  c.cycles = card_.read_register(card::kRegCycles);
  c.nodes = card_.read_register(card::kRegNodes);
  c.leaves = card_.read_register(card::kRegLeaves);
  if (card_.node_cache) {
    c.cached_nodes = card_.read_register(card::kRegCached);
    c.fetched_nodes = card_.read_register(card::kRegFetched);
  }
  c.pairs = card_.read_register(card::kRegTested);
  c.deepest = card_.read_register(card::kRegDeepest);
  c.records = card_.read_register(card::kRegWritten);
  const std::uint64_t status = check_end(c);
  if (received_ != c.records || has_half_)
    device_error(fmt::format("{} records downloaded; expected {}", received_, c.records), status);
  c.records = records_.size();
  for (const Record& r : records_) {
    if (r.primary >= numbers_.size())
      device_error(fmt::format("a record of ray {}; there are {} rays", r.primary, numbers_.size()),
                   status);
    if (r.bad) ++c.bad_primaries;
  }
  c.total_cycles = card_.cycles() - started_;
  c.time = times();
  c.time.load = ray_ps_;
  return c;
}

void BvhPass::put_in_order(std::vector<Record>& records) {
  if (query_.mode == Mode::kHits) {
    for (Record& r : records_) r.primary = numbers_[r.primary];
    std::sort(records_.begin(), records_.end(), [&](const Record& a, const Record& b) {
      const auto key = [&](const Record& r) {
        return std::tuple(r.primary / card_.primaries, r.index, r.primary);
      };
      return key(a) < key(b);
    });
    records.swap(records_);
    return;
  }
  std::vector<bool> there(numbers_.size());
  records.resize(numbers_.size());
  if (records_.size() != numbers_.size())
    device_error(fmt::format("{} records for {} rays", records_.size(), numbers_.size()), 0);
  for (const Record& r : records_) {
    if (there[r.primary]) device_error(fmt::format("ray {} has two records", r.primary), 0);
    there[r.primary] = true;
    records[r.primary] = r;
    records[r.primary].primary = numbers_[r.primary];
  }
}

std::string BvhPass::state() {
  return fmt::format(
      "status {:#x}, {} of {} rays provided, {} nodes read, {} secondaries tested, {} records "
      "written, {} waiting, cycle {}",
      card_.read_register(card::kRegStatus), provided_, numbers_.size(),
      card_.read_register(card::kRegNodes), card_.read_register(card::kRegTested),
      card_.read_register(card::kRegWritten), card_.read_register(card::kRegRecords),
      card_.cycles());
}

Counters RefitPass::execute(std::uint32_t first, std::uint32_t end) {
  card_.write_register(card::kRegControl, card::kControlClear);
  card_.write_register(card::kRegCommand, card::kCommandBvh |
                                              card::kCommandPair(Pair::kRayTriangle) |
                                              std::uint64_t{card::kModeRefit});
  card_.configure_bvh(first, end);
  try {
    card_.write_register(card::kRegControl, card::kControlGo);
    std::uint64_t status = 0;
    // The card ends by itself, unless the memory never answers.
    const std::uint64_t most =
        1'000'000 + (64 + card_.ddr_latency) * std::uint64_t{card_.bvh.slots};
    while (!bit(status, card::kStatusDone)) {
      if (card_.cycles() - started_ > most) timeout(fmt::format("deadline of {} cycles", most));
      status = work(16384);
      check_watchdog();
    }
    Counters c;
    c.cycles = card_.read_register(card::kRegCycles);
    check_end(c);
    c.total_cycles = card_.cycles() - started_;
    c.time = times();
    if (!bit(status, card::kStatusNodeError)) return c;
    const std::uint64_t fault = card_.read_register(card::kRegNodeFault);
    const std::uint64_t place = card::kNodeFaultPlace.of(fault);
    if (card::kNodeFaultKind.of(fault) != card::kNodeFaultSecondary)
      device_error(node_fault(card_, fault), status, place);
    throw Error(ErrorCode::kBadInput,
                fmt::format("the triangle in slot {} of the BVH is not finite or exceeds 2^40, so "
                            "no box can contain it",
                            place));
  } catch (...) {
    abort();
    throw;
  }
}

std::string RefitPass::state() {
  return fmt::format("status {:#x}, refitting {} nodes, cycle {}",
                     card_.read_register(card::kRegStatus), card_.bvh.nodes, card_.cycles());
}

}  // namespace cde
