// SPDX-License-Identifier: Apache-2.0
#include "explain/match.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace cde::explain {
namespace {

constexpr std::size_t kCommon = 48;  // an operation that stands in more places says nothing
constexpr unsigned kEnough = 60;     // percent of the pairs that make a seat

bool compares(FpOp op) {
  return op == FpOp::kLt || op == FpOp::kLe || op == FpOp::kEq;
}

/// Any NaN is the canonical one.
std::uint64_t canonical_word(const FpFormat& format, std::uint64_t word) {
  return format.is_nan(word) ? format.canonical_nan() : word;
}

struct Operands {
  std::uint64_t low, high;
  bool operator==(const Operands&) const = default;
};
Operands operands(const FpFormat& format, std::uint64_t a, std::uint64_t b) {
  const std::uint64_t x = canonical_word(format, a), y = canonical_word(format, b);
  return {std::min(x, y), std::max(x, y)};
}
struct Hash {
  std::size_t operator()(const Operands& o) const {
    return (o.low * 0x9e3779b97f4a7c15u) ^ (o.high * 0xc2b2ae3d27d4eb4fu);
  }
};

struct At {
  std::int32_t which;
  std::uint32_t clock;
};

/// The result that belongs to the operands of a clock; nothing behind the end.
const OperatorWords* result_of(const Observed& card, std::int32_t which, std::size_t clock) {
  const auto& words = card.words[static_cast<std::size_t>(which)];
  const std::size_t at = clock + card.operators[static_cast<std::size_t>(which)].latency;
  return at < words.size() ? &words[at] : nullptr;
}

bool same_operation(FpOp card, FpOp reference) {
  return card == reference;
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

/// Operators of the card that may be one which nobody has found: of its kind, of no seat, and with
/// one of its operands at the same time after most pairs; those of the fewest clocks first.
std::vector<std::int32_t> strangers(const Observed& card, std::size_t operation,
                                    const std::vector<bool>& seated,
                                    std::span<const PairRecording> pairs,
                                    std::span<const std::size_t> rows) {
  std::vector<std::pair<unsigned, std::int32_t>> found;  // offset, operator
  for (std::size_t which = 0; which < card.operators.size(); ++which) {
    if (seated[which]) continue;
    const auto& words = card.words[which];
    std::map<unsigned, unsigned> votes;
    for (const std::size_t row : rows) {
      const PairRecording& pair = pairs[row];
      const Step& step = pair.steps[static_cast<std::size_t>(pair.operators[operation])];
      const std::uint64_t a = canonical_word(card.format, step.a),
                          b = canonical_word(card.format, step.b);
      const std::size_t entry = row * card.interval;
      const std::size_t end = std::min(words.size(), entry + words.size() - rows.size());
      for (std::size_t t = entry; t < end; ++t)
        if ((words[t].a == a || words[t].b == b || words[t].a == b || words[t].b == a) &&
            (words[t].a | words[t].b) << 1 != 0)
          ++votes[static_cast<unsigned>(t - entry)];
    }
    const auto best =
        std::max_element(votes.begin(), votes.end(),
                         [](const auto& x, const auto& y) { return x.second < y.second; });
    if (best == votes.end() || best->second * 100 < kEnough * rows.size()) continue;
    const bool kind =
        same_operation(card.operators[which].operation,
                       pairs[rows[0]]
                           .steps[static_cast<std::size_t>(pairs[rows[0]].operators[operation])]
                           .operation);
    found.emplace_back(best->first + (kind ? 0 : 1u << 20), static_cast<std::int32_t>(which));
  }
  std::sort(found.begin(), found.end());
  std::vector<std::int32_t> list;
  list.reserve(found.size());
  for (const auto& [offset, which] : found) list.push_back(which);
  return list;
}

}  // namespace

Observed observe(PairUnit& unit, std::span<const std::uint64_t> a,
                 std::span<const std::uint64_t> b) {
  Observed card;
  card.format = unit.config().format;
  card.operators = unit.operators();
  card.interval = unit.config().facet_interval;
  card.words.resize(card.operators.size());
  card.results.resize(a.size() / primary_words(unit.config().pair));
  unit.watch(a, b, card.results, [&card](const OperatorWords& seen) {
    OperatorWords w = seen;
    w.a = canonical_word(card.format, w.a);
    w.b = canonical_word(card.format, w.b);
    w.result = compares(card.operators[w.which].operation) ? (w.result != 0 ? 1 : 0)
                                                           : canonical_word(card.format, w.result);
    card.words[w.which].push_back(w);
  });
  return card;
}

std::vector<Seat> learn(const Observed& card, std::span<const PairRecording> pairs,
                        std::span<const std::size_t> rows) {
  std::unordered_map<Operands, std::vector<At>, Hash> where;
  for (std::size_t which = 0; which < card.words.size(); ++which) {
    const auto& words = card.words[which];
    for (std::size_t t = 0; t < words.size(); ++t) {
      auto& list = where[operands(card.format, words[t].a, words[t].b)];
      if (list.size() <= kCommon)
        list.push_back({static_cast<std::int32_t>(which), static_cast<std::uint32_t>(t)});
    }
  }
  const std::size_t count = pairs[rows[0]].operators.size();
  std::vector<Seat> seats(count);
  std::vector<bool> taken(card.operators.size());
  for (std::size_t k = 0; k < count; ++k) {
    std::map<std::pair<std::int32_t, unsigned>, Seat> votes;
    for (const std::size_t row : rows) {
      const Step& step = pairs[row].steps[static_cast<std::size_t>(pairs[row].operators[k])];
      const auto found = where.find(operands(card.format, step.a, step.b));
      if (found == where.end() || found->second.size() > kCommon) continue;
      const std::size_t entry = row * card.interval;
      for (const At at : found->second) {
        const OperatorWords* result = result_of(card, at.which, at.clock);
        if (at.clock < entry || result == nullptr) continue;
        const auto offset = static_cast<unsigned>(at.clock - entry);
        Seat& seat = votes[{at.which, offset}];
        seat.which = at.which;
        seat.offset = offset;
        ++seat.operands;
        const bool same =
            same_operation(card.operators[static_cast<std::size_t>(at.which)].operation,
                           step.operation) &&
            result->result ==
                (compares(step.operation) ? step.result : canonical_word(card.format, step.result));
        if (same) ++seat.agree;
      }
    }
    for (const auto& [place, seat] : votes) {
      if (seat.operands * 100 < kEnough * rows.size()) continue;
      const auto rank = [&](const Seat& s) {
        return std::tuple(s.agree, s.operands,
                          s.which >= 0 && !taken[static_cast<std::size_t>(s.which)]);
      };
      if (seats[k].which < 0 || rank(seat) > rank(seats[k])) seats[k] = seat;
    }
    if (seats[k].which >= 0) taken[static_cast<std::size_t>(seats[k].which)] = true;
  }
  return seats;
}

std::vector<Compared> compare(const Observed& card, const PairRecording& pair, std::size_t row,
                              std::span<const Seat> seats, std::span<const PairRecording> pairs,
                              std::span<const std::size_t> learnt_from) {
  std::vector<bool> seated(card.operators.size());
  for (const Seat& seat : seats)
    if (seat.which >= 0) seated[static_cast<std::size_t>(seat.which)] = true;
  std::vector<Compared> all(pair.operators.size());
  std::vector<char> same(pair.steps.size(), 1);  // of steps; those of the input check are taken so
  for (std::size_t k = 0; k < all.size(); ++k) {
    Compared& c = all[k];
    const auto at = static_cast<std::size_t>(pair.operators[k]);
    const Step& step = pair.steps[at];
    c.operation = k;
    c.seat = seats[k];
    if (c.seat.which >= 0) {
      const std::size_t clock = row * card.interval + c.seat.offset;
      const auto which = static_cast<std::size_t>(c.seat.which);
      const OperatorWords* result = result_of(card, c.seat.which, clock);
      c.card = card.words[which][clock];
      if (result != nullptr) c.card.result = result->result;
      const bool operands_same =
          operands(card.format, c.card.a, c.card.b) == operands(card.format, step.a, step.b);
      const bool result_same =
          result != nullptr && same_operation(card.operators[which].operation, step.operation) &&
          c.card.result ==
              (compares(step.operation) ? step.result : canonical_word(card.format, step.result));
      c.verdict = !operands_same ? Verdict::kOperands
                  : result_same  ? Verdict::kSame
                                 : Verdict::kResult;
    }
    same[at] = c.verdict == Verdict::kSame ? 1 : 0;
    std::vector<std::int32_t> from;
    parents(pair.steps, static_cast<std::int32_t>(at), from);
    c.first = c.verdict != Verdict::kSame && std::all_of(from.begin(), from.end(), [&](auto p) {
                return same[static_cast<std::size_t>(p)] != 0;
              });
  }
  for (Compared& c : all)
    if (c.first && c.verdict == Verdict::kMissing)
      c.others = strangers(card, c.operation, seated, pairs, learnt_from);
  return all;
}

}  // namespace cde::explain
