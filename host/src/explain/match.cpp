// SPDX-License-Identifier: Apache-2.0
#include "cde/explain/match.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace cde::explain {
namespace {

constexpr unsigned kEnough = 60;     // percent of the pairs that must agree for a seat
constexpr std::size_t kSeeds = 3;    // pairs per operation whose operands are searched everywhere
constexpr std::size_t kAlike = 200;  // most operations of a pair with the same operands
constexpr std::size_t kCandidates = 96;  // seats tried per operation
constexpr std::size_t kSought = 20;      // missing operations for which other operators are tried

bool compares(FpOp op) {
  return op == FpOp::kLt || op == FpOp::kLe || op == FpOp::kEq;
}

std::uint64_t canonical_word(const FpFormat& format, std::uint64_t word) {
  return format.is_nan(word) ? format.canonical_nan() : word;
}

/// The operands of an operation, unordered.
struct Operands {
  std::uint64_t low, high;
  Operands(std::uint64_t a, std::uint64_t b) : low(std::min(a, b)), high(std::max(a, b)) {}
  bool operator==(const Operands&) const = default;
};
struct Hash {
  std::size_t operator()(const Operands& o) const {
    return (o.low * 0x9e3779b97f4a7c15u) ^ (o.high * 0xc2b2ae3d27d4eb4fu);
  }
};

/// An operation of the reference, in the words of a track.
Operation expected(const Observed& card, const PairRecording& pair, std::size_t k) {
  const Step& step = pair.steps[static_cast<std::size_t>(pair.operators[k])];
  const auto word = [&card](std::uint64_t w) { return canonical_word(card.format, w); };
  return {step.operation, word(step.a), word(step.b),
          compares(step.operation) ? step.result : word(step.result)};
}

/// What an operator did with its operands in a cycle; nothing if its result comes after the end.
std::optional<Operation> done(const Observed& card, std::int32_t which, std::size_t cycle) {
  const auto w = static_cast<std::size_t>(which);
  const Track& track = card.tracks[w];
  const std::size_t end = cycle + card.operators[w].latency;
  if (end >= track.result.size()) return std::nullopt;
  return Operation{card.operators[w].operation, track.a[cycle], track.b[cycle], track.result[end]};
}

Comparison compare_operations(const Operation& card, const Operation& reference) {
  if (Operands(card.a, card.b) != Operands(reference.a, reference.b)) return Comparison::kOperands;
  return card.operation == reference.operation && card.result == reference.result
             ? Comparison::kSame
             : Comparison::kResult;
}

/// Whether the operands are specific: neither is zero.
bool tells(const Operation& o) {
  return (o.a << 1) != 0 && (o.b << 1) != 0;
}

/// Whether the operation's operands would be found: they are specific, and differ between most
/// pairs.
bool tells(const Observed& card, std::size_t operation, std::span<const PairRecording> pairs,
           std::span<const std::size_t> rows) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> seen;
  for (const std::size_t row : rows) {
    const Operation o = expected(card, pairs[row], operation);
    if (tells(o)) seen.emplace_back(o.a, o.b);
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen.size() * 100 >= kEnough * rows.size();
}

/// Finds the places of these operations' operands for one pair, up to a limit per operation.
using Places = std::vector<std::vector<std::pair<std::int32_t, unsigned>>>;
void find_places(const Observed& card, const PairRecording& pair, std::size_t row,
                 std::span<const std::size_t> sought, Places& places) {
  std::unordered_map<Operands, std::vector<std::uint32_t>, Hash> operations;
  for (const std::size_t k : sought) {
    const Operation o = expected(card, pair, k);
    operations[{o.a, o.b}].push_back(static_cast<std::uint32_t>(k));
  }
  const std::size_t entry = row * card.interval;
  for (std::size_t which = 0; which < card.tracks.size(); ++which) {
    const Track& track = card.tracks[which];
    for (std::size_t t = entry; t < track.a.size(); ++t) {
      const auto found = operations.find({track.a[t], track.b[t]});
      if (found == operations.end() || found->second.size() > kAlike) continue;
      const std::pair place(static_cast<std::int32_t>(which), static_cast<unsigned>(t - entry));
      for (const std::uint32_t k : found->second)
        if (auto& of = places[k];
            of.size() < kCandidates && std::find(of.begin(), of.end(), place) == of.end())
          of.push_back(place);
    }
  }
}

/// How well the operands that one pair gives an operation tell where the operation is done.
enum class Clue : std::uint8_t {
  kNone,    ///< an operand is zero, and zeros are everywhere
  kNumber,  ///< no operand is zero; one is infinite or NaN, or other pairs give the same operands
  kOne,     ///< no other pair gives these operands; one is finite and not zero
  kBoth,    ///< no other pair gives these operands; both are finite and not zero
};

/// The clue from each row's pair for an operation. The last pair stays at the input port, so its
/// words appear in many cycles: it is a poor clue.
std::vector<Clue> clues(const Observed& card, std::span<const PairRecording> pairs,
                        std::span<const std::size_t> rows, std::size_t operation) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, unsigned> seen;
  std::vector<Operation> all;
  for (const std::size_t row : rows) {
    all.push_back(expected(card, pairs[row], operation));
    const Operands words(all.back().a, all.back().b);
    ++seen[{words.low, words.high}];
  }
  const auto number = [&card](std::uint64_t w) {
    return (w << 1) != 0 && (w & card.format.magnitude_mask()) < card.format.infinity();
  };
  std::vector<Clue> list;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Operation& o = all[i];
    const Operands words(o.a, o.b);
    const bool alone = seen[{words.low, words.high}] == 1 && i + 1 < rows.size();
    if (alone && number(o.a) && number(o.b))
      list.push_back(Clue::kBoth);
    else if (alone && (number(o.a) || number(o.b)))
      list.push_back(Clue::kOne);
    else
      list.push_back(tells(o) ? Clue::kNumber : Clue::kNone);
  }
  return list;
}

/// Possible places of each operation. Searches for the operands of the pairs with the best clue.
Places possible_places(const Observed& card, std::span<const PairRecording> pairs,
                       std::span<const std::size_t> rows) {
  const std::size_t count = pairs[rows[0]].operators.size();
  // Distant rows come first.
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < kSeeds; ++s)
    for (std::size_t i = s; i < rows.size(); i += kSeeds) order.push_back(i);
  std::vector<std::vector<std::size_t>> sought(rows.size());  // operations per row
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<Clue> clue = clues(card, pairs, rows, k);
    const Clue best = *std::max_element(clue.begin(), clue.end());
    if (best == Clue::kNone) {
      sought[0].push_back(k);
      continue;
    }
    std::size_t seeds = 0;
    for (const std::size_t i : order)
      if (clue[i] == best && seeds++ < kSeeds) sought[i].push_back(k);
  }
  Places places(count);
  for (const std::size_t i : order)
    if (!sought[i].empty()) find_places(card, pairs[rows[i]], rows[i], sought[i], places);
  return places;
}

/// The operators that a step depends on through wires alone.
void parents(const std::vector<Step>& steps, std::int32_t step, std::vector<std::int32_t>& out) {
  for (const std::int32_t from : steps[static_cast<std::size_t>(step)].from) {
    if (from < 0) continue;
    if (steps[static_cast<std::size_t>(from)].is_operator)
      out.push_back(from);
    else
      parents(steps, from, out);
  }
}

/// Steps that the answer depends on: inputs of T, CP and n, and of comparisons without a reader,
/// one of which is F.
std::vector<char> that_matter(const PairRecording& pair) {
  const auto index = [](std::int32_t step) { return static_cast<std::size_t>(step); };
  std::vector<char> used(pair.steps.size()), matter(pair.steps.size());
  for (const Step& step : pair.steps)
    for (const std::int32_t from : step.from)
      if (from >= 0) used[index(from)] = 1;
  for (const std::int32_t output : pair.outputs)
    if (output >= 0) matter[index(output)] = 1;
  for (std::size_t i = pair.steps.size(); i-- > 0;) {
    const Step& step = pair.steps[i];
    if (step.is_operator && compares(step.operation) && used[i] == 0) matter[i] = 1;
    if (matter[i] == 0) continue;
    for (const std::int32_t from : step.from)
      if (from >= 0) matter[index(from)] = 1;
  }
  return matter;
}

/// The best cycle offset from a pair's entry at which the operator has one of the operation's
/// nonzero operands for most pairs.
std::optional<unsigned> half_seat(const Observed& card, std::size_t which, std::size_t operation,
                                  std::span<const PairRecording> pairs,
                                  std::span<const std::size_t> rows) {
  const Track& track = card.tracks[which];
  const std::size_t last = rows.back() * card.interval;
  std::map<unsigned, unsigned> votes;
  for (const std::size_t row : rows) {
    const Operation o = expected(card, pairs[row], operation);
    const std::size_t entry = row * card.interval;
    const auto is_one = [&o](std::uint64_t w) { return w << 1 != 0 && (w == o.a || w == o.b); };
    for (std::size_t t = entry; t + last < track.a.size() + entry; ++t)
      if (is_one(track.a[t]) || is_one(track.b[t])) ++votes[static_cast<unsigned>(t - entry)];
  }
  const auto best = std::max_element(
      votes.begin(), votes.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  if (best == votes.end() || best->second * 100 < kEnough * rows.size()) return std::nullopt;
  return best->first;
}

/// Unmatched operators that may do a missing operation: for most pairs they have one of its
/// operands at the same offset. Operators of its kind come first, then those with lower offsets.
std::vector<std::int32_t> strangers(const Observed& card, std::size_t operation,
                                    const std::vector<bool>& seated,
                                    std::span<const PairRecording> pairs,
                                    std::span<const std::size_t> rows) {
  const FpOp kind = expected(card, pairs[rows[0]], operation).operation;
  std::vector<std::tuple<bool, unsigned, std::int32_t>> found;
  for (std::size_t which = 0; which < card.operators.size(); ++which)
    if (!seated[which])
      if (const auto offset = half_seat(card, which, operation, pairs, rows))
        found.emplace_back(card.operators[which].operation != kind, *offset,
                           static_cast<std::int32_t>(which));
  std::sort(found.begin(), found.end());
  std::vector<std::int32_t> list;
  list.reserve(found.size());
  for (const auto& entry : found) list.push_back(std::get<2>(entry));
  return list;
}

}  // namespace

Observed observe(PairUnit& unit, std::span<const std::uint64_t> a,
                 std::span<const std::uint64_t> b) {
  Observed card;
  card.format = unit.config().format;
  card.operators = unit.operators();
  card.interval = unit.config().sat_interval;
  card.tracks.resize(card.operators.size());
  card.results.resize(a.size() / primary_words(unit.config().pair));
  unit.watch(a, b, card.results, [&card](const OperatorWords& seen) {
    Track& track = card.tracks[seen.which];
    const FpOp op = card.operators[seen.which].operation;
    track.a.push_back(canonical_word(card.format, seen.a));
    track.b.push_back(op == FpOp::kSqrt ? track.a.back() : canonical_word(card.format, seen.b));
    track.result.push_back(compares(op) ? (seen.result != 0 ? 1 : 0)
                                        : canonical_word(card.format, seen.result));
  });
  return card;
}

std::vector<Seat> learn(const Observed& card, std::span<const PairRecording> pairs,
                        std::span<const std::size_t> rows) {
  const std::size_t count = pairs[rows[0]].operators.size();
  const Places places = possible_places(card, pairs, rows);
  std::vector<Seat> seats(count);
  std::vector<bool> taken(card.operators.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto rank = [&taken](const Seat& s) {
      return std::tuple(s.agree, s.operands,
                        s.which >= 0 && !taken[static_cast<std::size_t>(s.which)]);
    };
    for (const auto& [which, offset] : places[k]) {
      Seat seat{which, offset, 0, 0};
      std::size_t telling = 0,
                  told = 0;  // pairs with nonzero operands, and pairs with the right ones
      for (const std::size_t row : rows) {
        const auto did = done(card, which, row * card.interval + offset);
        if (!did) continue;
        const Operation reference = expected(card, pairs[row], k);
        const Comparison comparison = compare_operations(*did, reference);
        if (comparison == Comparison::kSame) ++seat.agree;
        if (comparison == Comparison::kSame || (comparison == Comparison::kResult && tells(*did)))
          ++seat.operands;
        telling += tells(reference) ? 1 : 0;
        told += tells(reference) && comparison <= Comparison::kResult ? 1 : 0;
      }
      if (seat.operands * 100 >= kEnough * rows.size() && told * 100 >= kEnough * telling &&
          (seats[k].which < 0 || rank(seat) > rank(seats[k])))
        seats[k] = seat;
    }
    if (seats[k].which >= 0) taken[static_cast<std::size_t>(seats[k].which)] = true;
  }
  // An operator with the right operands but another result is no seat if another operation matches
  // it there. Both operations take the same operands, such as a difference and the smaller of two
  // corners.
  std::set<std::pair<std::int32_t, unsigned>> agreed;
  for (const Seat& s : seats)
    if (s.agree * 100 >= kEnough * rows.size()) agreed.insert({s.which, s.offset});
  for (Seat& s : seats)
    if (s.agree * 100 < kEnough * rows.size() && agreed.contains({s.which, s.offset})) s = Seat{};
  return seats;
}

std::vector<Compared> compare(const Observed& card, std::span<const PairRecording> pairs,
                              std::size_t row, std::span<const Seat> seats,
                              std::span<const std::size_t> learnt_from, bool iterative) {
  const PairRecording& pair = pairs[row];
  std::vector<bool> seated(card.operators.size());
  for (const Seat& seat : seats)
    if (seat.which >= 0) seated[static_cast<std::size_t>(seat.which)] = true;
  std::vector<Compared> all(pair.operators.size());
  std::vector<char> same(pair.steps.size(), 1);  // by step; steps of the input check count as same
  const std::vector<char> matter = that_matter(pair);
  std::size_t sought = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Compared& c = all[k];
    const std::int32_t at = pair.operators[k];
    c.operation = k;
    c.seat = seats[k];
    if (c.seat.which >= 0) {
      if (const auto did = done(card, c.seat.which, row * card.interval + c.seat.offset)) {
        c.card = *did;
        c.comparison = compare_operations(c.card, expected(card, pair, k));
      }
    }
    if (c.comparison == Comparison::kMissing &&
        (matter[static_cast<std::size_t>(at)] == 0 || !tells(card, k, pairs, learnt_from)))
      c.comparison = Comparison::kUnknown;
    const auto all_of_them = learnt_from.size();
    if (iterative && c.seat.which >= 0 && c.seat.agree != all_of_them &&
        (c.seat.agree != 0 || c.seat.operands != all_of_them))
      c.comparison = Comparison::kUnknown;
    const bool differs = c.comparison != Comparison::kSame && c.comparison != Comparison::kUnknown;
    same[static_cast<std::size_t>(at)] = differs ? 0 : 1;
    std::vector<std::int32_t> from;
    parents(pair.steps, at, from);
    c.first = differs && std::all_of(from.begin(), from.end(), [&](auto p) {
                return same[static_cast<std::size_t>(p)] != 0;
              });
    if (c.first && c.comparison == Comparison::kMissing && sought++ < kSought)
      c.others = strangers(card, k, seated, pairs, learnt_from);
  }
  return all;
}

}  // namespace cde::explain
