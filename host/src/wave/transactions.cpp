// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/transaction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <compare>
#include <deque>
#include <set>

#include "cde/support/error.hpp"
#include "cde/wave/candidates.hpp"
#include "cde/wave/decoder.hpp"

namespace cde::wave {
namespace {

/// A compact queue of waiting transactions: up to all rows of a pass. Repeated parts are stored
/// once, and the rest in one string.
class Parcels {
 public:
  using Key = std::array<std::uint64_t, 4>;  ///< begin, kind, end, number

  void add(std::size_t kind, Transaction t) {
    Parcel parcel{{t.begin, kind, t.end, number_++}, t.stalls.value_or(kNone), nullptr, {}};
    std::string& words = parcel.words;
    std::size_t size = t.label.size() + t.outcome.size() + 2;
    for (const auto& [name, value] : t.fields) size += value.size() + 1;
    words.reserve(size);  // exactly what is needed
    words.append(t.label).append(1, '\0').append(t.outcome).append(1, '\0');
    Common common{std::move(t.kind), std::move(t.scope), {}};
    for (auto& [name, value] : t.fields) {
      common.names.push_back(std::move(name));
      words.append(value).append(1, '\0');
    }
    parcel.common = &*common_.insert(std::move(common)).first;
    heap_.push_back(std::move(parcel));
    std::push_heap(heap_.begin(), heap_.end(), later);
  }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }
  [[nodiscard]] std::uint64_t first_begin() const { return heap_.front().key[0]; }
  [[nodiscard]] Transaction take_first() {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const Parcel parcel = std::move(heap_.back());
    heap_.pop_back();
    Transaction t;
    t.kind = parcel.common->kind;
    t.scope = parcel.common->scope;
    t.begin = parcel.key[0];
    t.end = parcel.key[2];
    if (parcel.stalls != kNone) t.stalls = parcel.stalls;
    const char* word = parcel.words.c_str();
    const auto next = [&word] {
      std::string text(word);
      word += text.size() + 1;
      return text;
    };
    t.label = next();
    t.outcome = next();
    for (const std::string& name : parcel.common->names) t.fields.emplace_back(name, next());
    return t;
  }

 private:
  static constexpr std::uint64_t kNone = UINT64_MAX;
  struct Common {
    std::string kind, scope;
    std::vector<std::string> names;  ///< of the fields
    auto operator<=>(const Common&) const = default;
  };
  struct Parcel {
    Key key;
    std::uint64_t stalls;
    const Common* common;
    std::string words;  ///< label, outcome and field values, each ended by a zero byte
  };
  static bool later(const Parcel& a, const Parcel& b) { return a.key > b.key; }

  std::deque<Parcel> heap_;
  std::set<Common> common_;
  std::uint64_t number_ = 0;
};

/// Orders transactions by their begin. Decoders report them at their end.
class Order {
 public:
  Order(std::uint64_t from, std::uint64_t to, const std::function<bool(const Transaction&)>& take)
      : from_(from), to_(to), take_(take) {}

  void add(std::size_t kind, Transaction t) {
    if (t.begin <= to_ && t.end >= from_) waiting_.add(kind, std::move(t));
  }
  /// Passes on the transactions that began before a time, when no earlier one can follow.
  void give(std::uint64_t before) {
    while (!stopped_ && waiting_.size() != 0 && waiting_.first_begin() < before)
      stopped_ = !take_(waiting_.take_first());
  }
  void give_all() { give(UINT64_MAX); }
  [[nodiscard]] bool many() const { return waiting_.size() > 1024; }
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  std::uint64_t from_, to_;
  const std::function<bool(const Transaction&)>& take_;
  Parcels waiting_;
  bool stopped_ = false;
};

/// Passes changes of a file to decoders. At each time, clock edges come first, with the values
/// before them, as flip-flops see them.
class Conductor {
 public:
  Conductor(Trace& trace, Order& order, std::uint64_t to) : trace_(trace), order_(order), to_(to) {
    wires_.resize(trace.handles() + std::size_t{1});
    clocks_.resize(wires_.size());
    levels_.resize(wires_.size(), 'x');
  }

  void add(std::unique_ptr<Decoder> decoder) {
    for (const auto& input : decoder->inputs()) {
      wires_[input.handle].push_back(input.wire.get());
      handles_.push_back(input.handle);
    }
    const SignalPlace& place = decoder->place();
    for (unsigned c = 0; c < place.of->clocks.size(); ++c) {
      const std::uint32_t handle = place.signals.at(place.of->clocks[c])->handle;
      clocks_[handle].push_back({decoder.get(), c});
      handles_.push_back(handle);
    }
    decoders_.push_back(std::move(decoder));
  }

  void run() {
    if (handles_.empty()) return;
    std::uint64_t now = trace_.start();
    bool go_on = true;
    trace_.stream(handles_, now, trace_.end(),
                  [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                    if (time != now) {
                      go_on = step(now);
                      if (!go_on) return false;
                      now = time;
                    }
                    waiting_.push_back({handle, text_.size(), value.size()});
                    text_ += value;
                    return true;
                  });
    if (go_on && step(now))
      for (const auto& d : decoders_) d->finish(trace_.end());
    order_.give_all();
  }

 private:
  struct Change {
    std::uint32_t handle;
    std::size_t at, length;
  };
  struct Listener {
    Decoder* decoder;
    unsigned clock;
  };

  /// Called when all changes of a time have arrived. False to stop.
  bool step(std::uint64_t time) {
    bool edge = false;
    for (const Change& c : waiting_) {
      if (clocks_[c.handle].empty()) continue;
      const char level = c.length == 0 ? 'x' : text_[c.at + c.length - 1];
      if (levels_[c.handle] == '0' && level == '1') {
        edge = true;
        for (const Listener& l : clocks_[c.handle]) l.decoder->edge(l.clock, time);
      }
      levels_[c.handle] = level;
    }
    for (const Change& c : waiting_)
      for (Wire* w : wires_[c.handle]) w->bits.assign(text_, c.at, c.length);
    waiting_.clear();
    text_.clear();
    if (!edge || (time <= to_ && !order_.many())) return true;
    std::uint64_t open = time;
    for (const auto& d : decoders_) open = std::min(open, d->oldest().value_or(time));
    order_.give(open);
    return !order_.stopped() && open <= to_;
  }

  Trace& trace_;
  Order& order_;
  std::uint64_t to_;
  std::vector<std::unique_ptr<Decoder>> decoders_;
  std::vector<std::vector<Wire*>> wires_;      ///< by handle
  std::vector<std::vector<Listener>> clocks_;  ///< by handle
  std::string levels_;
  std::vector<std::uint32_t> handles_;
  std::vector<Change> waiting_;
  std::string text_;
};

}  // namespace

const std::vector<std::string>& transaction_kinds() {
  static const std::vector<std::string> kAll = [] {
    std::vector<std::string> names;
    for (const KindSignals& k : card_signals()) names.emplace_back(k.kind);
    return names;
  }();
  return kAll;
}

void each_transaction(Trace& trace, const std::vector<std::string>& kinds, std::uint64_t from,
                      std::uint64_t to, const std::function<bool(const Transaction&)>& take) {
  const SignalPlaces places(trace);
  Order order(from, to, take);
  Conductor conductor(trace, order, to);
  for (std::size_t k = 0; k < card_signals().size(); ++k) {
    const KindSignals& kind = card_signals()[k];
    if (!kinds.empty() && std::find(kinds.begin(), kinds.end(), kind.kind) == kinds.end()) continue;
    for (const SignalPlace& place : places.of(kind)) {
      const Decoder::Take add = [&order, k](Transaction t) { order.add(k, std::move(t)); };
      auto decoder = bus_decoder(place, add);
      if (!decoder) decoder = engine_decoder(place, add);
      if (!decoder) decoder = answer_decoder(place, add);
      conductor.add(std::move(decoder));
    }
  }
  conductor.run();
}

void each_tested(Trace& trace, std::uint64_t primary, const TakeTested& take) {
  const SignalPlaces places(trace);
  const std::vector<SignalPlace> found = places.of(tested_signals());
  if (found.empty())
    throw Error(ErrorCode::kUsage, fmt::format("the waves lack {}",
                                               fmt::join(places.missing(tested_signals()), ", ")));
  const std::function<bool(const Transaction&)> none = [](const Transaction&) { return true; };
  Order order(0, UINT64_MAX, none);
  Conductor conductor(trace, order, UINT64_MAX);
  for (const SignalPlace& place : found) conductor.add(tested_decoder(place, primary, take));
  conductor.run();
}

std::vector<Transaction> transactions(Trace& trace, const std::vector<std::string>& kinds,
                                      std::uint64_t from, std::uint64_t to) {
  std::vector<Transaction> all;
  each_transaction(trace, kinds, from, to, [&](const Transaction& t) {
    all.push_back(t);
    return true;
  });
  return all;
}

}  // namespace cde::wave
