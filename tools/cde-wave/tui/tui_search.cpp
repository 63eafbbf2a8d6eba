// SPDX-License-Identifier: Apache-2.0
// Searches of the viewer: edges, names, expressions, transactions, differences.
#include <fmt/format.h>

#include <algorithm>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "tui/tui_viewer.hpp"

namespace cde::wave::tui {
namespace {

constexpr std::size_t kMostTransactions = 1'000'000;

/// Splits "EXPRESSION @posedge clk" into its two parts.
std::pair<std::string, std::string> split(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos) return {text, ""};
  std::string what = text.substr(0, at), on = text.substr(at + 1);
  on.erase(0, on.find_first_not_of(' '));
  while (on.ends_with(' ')) on.pop_back();
  return {what, on};
}

/// In a block: the first change of a view after a time, or the last one before it.
std::optional<std::uint64_t> change_behind(const View& v, const Track& track, std::uint64_t time) {
  std::size_t i = track.at(time);
  const std::string whole = track.value(i);
  const std::string bits(v.bits(whole));
  while (++i < track.changes())
    if (track.time(i) > time && v.bits(track.value(i)) != bits) return track.time(i);
  return std::nullopt;
}

std::optional<std::uint64_t> change_before(const View& v, const Track& track, std::uint64_t time) {
  if (time <= track.time(0)) return std::nullopt;
  std::size_t i = track.at(time - 1);
  std::string now(v.bits(track.value(i)));
  for (; i > 0; --i) {
    std::string before(v.bits(track.value(i - 1)));
    if (before != now) return track.time(i);
    now = std::move(before);
  }
  return std::nullopt;
}

std::string value_at_end(const View& v, const Track& track) {
  return std::string(v.bits(track.value(track.changes() - 1)));
}

}  // namespace

void Viewer::begin_search(const std::string& what, Search piece) {
  searched_ = what;
  progress_ = cursor_;
  search_ = std::move(piece);
}

void Viewer::no_more(const std::string& what, bool forward) {
  show_message(fmt::format("{} {} the cursor", what, forward ? "after" : "before"), true);
}

void Viewer::next_edge(bool forward) {
  if (list_.empty()) return;
  const View v = list_[chosen_].wave.view();
  const std::string none = "no change of " + v.label;
  begin_search(v.label, [this, v, forward, none, k = tracks_.block_of(cursor_)]() mutable {
    const auto track = tracks_.get(v.signal.handle, k);
    at_progress(tracks_.blocks()[k].begin);
    auto found = forward ? change_behind(v, *track, cursor_) : change_before(v, *track, cursor_);
    // The first value of a block may be a change from the previous block.
    const bool next = forward ? k + 1 < tracks_.blocks().size() : k > 0;
    if (!found && next) {
      const auto neighbour = tracks_.get(v.signal.handle, forward ? k + 1 : k - 1);
      const Track& first = forward ? *track : *neighbour;
      const Track& second = forward ? *neighbour : *track;
      const std::uint64_t begin = second.time(0);
      if (v.bits(second.value(0)) != value_at_end(v, first) &&
          (forward ? begin > cursor_ : begin < cursor_))
        found = begin;
    }
    if (found) {
      move_to(*found);
      return true;
    }
    if (!next) {
      no_more(none, forward);
      return true;
    }
    k = forward ? k + 1 : k - 1;
    return false;
  });
}

void Viewer::next_name(bool forward) {
  if (name_.empty()) return;
  const bool glob = name_.find_first_of("*?") != std::string::npos;
  for (std::size_t step = 1; step <= list_.size(); ++step) {
    const std::size_t i = (chosen_ + (forward ? step : list_.size() - step)) % list_.size();
    const std::string& label = list_[i].wave.view().label;
    if (glob ? matches(name_, label) || matches("*." + name_, label)
             : label.find(name_) != std::string::npos) {
      choose(i);
      return;
    }
  }
  show_message(fmt::format("no signal {} in the list; press a to add signals", name_), true);
}

void Viewer::next_match(bool forward) {
  if (expression_.empty()) {
    show_message("no expression yet; press f to enter one", true);
    return;
  }
  try {
    if (forward)
      match_forward();
    else
      match_backward();
  } catch (const Error& e) {
    show_message(e.what(), true);
  }
}

void Viewer::match_forward() {
  const auto [what, on] = split(expression_);
  const auto follow = std::make_shared<Follow>(trace_, what, "", on);
  // An expression that looks back at edges must see all of them, from the begin of the file.
  const std::uint64_t begin = follow->needs_history() && !on.empty() ? trace_.start() : cursor_;
  begin_search(expression_, [this, follow, from = begin]() mutable {
    const std::size_t k = tracks_.block_of(from);
    const Stretch block = tracks_.blocks()[k];
    at_progress(from);
    std::optional<std::uint64_t> found;
    // Reads the whole block: stopping within it would make the reader lose its memory.
    follow->run(trace_, from, block.end, [&](std::uint64_t time) {
      if (!found && time > cursor_) found = time;
      return true;
    });
    if (found) {
      move_to(*found);
      return true;
    }
    if (k + 1 == tracks_.blocks().size()) {
      no_more("not true", true);
      return true;
    }
    from = block.end + 1;
    return false;
  });
}

/// Searches block by block backwards. An expression that looks back at edges starts at the begin of
/// the file.
void Viewer::match_backward() {
  const auto [what, on] = split(expression_);
  auto follow = std::make_shared<Follow>(trace_, what, "", on);
  if (cursor_ == trace_.start()) {
    no_more("not true", false);
    return;
  }
  const bool from_begin = follow->needs_history() && !on.empty();
  const std::size_t last = tracks_.block_of(cursor_ - 1);
  auto found = std::make_shared<std::optional<std::uint64_t>>();
  if (from_begin) {
    begin_search(expression_, [this, follow, found, last, k = std::size_t{0}]() mutable {
      const Stretch block = tracks_.blocks()[k];
      at_progress(block.begin);
      follow->run(trace_, block.begin, std::min(block.end, cursor_ - 1), [&](std::uint64_t time) {
        *found = time;
        return true;
      });
      if (k++ < last) return false;
      if (*found)
        move_to(**found);
      else
        no_more("not true", false);
      return true;
    });
    return;
  }
  begin_search(expression_, [this, what = what, on = on, k = last]() mutable {
    const Stretch block = tracks_.blocks()[k];
    // The value before the block decides whether the expression became true at the block's begin.
    const std::uint64_t from = k == 0 ? block.begin : block.begin - 1;
    at_progress(block.begin);
    Follow here(trace_, what, "", on);
    std::optional<std::uint64_t> time;
    here.run(trace_, from, std::min(block.end, cursor_ - 1), [&](std::uint64_t t) {
      if (k == 0 || t != from) time = t;
      return true;
    });
    if (time) {
      move_to(*time);
      return true;
    }
    if (k-- > 0) return false;
    no_more("not true", false);
    return true;
  });
}

void Viewer::next_transaction(bool forward) {
  if (transactions_.contains(kind_)) {
    show_transaction(forward);
    return;
  }
  // Transactions are decoded once, from the begin of the file. The first piece of work only lets
  // the screen show that.
  begin_search(
      kind_.empty() ? "transactions" : "transactions of kind " + kind_,
      [this, forward, told = false]() mutable {
        if (!told) {
          told = true;
          return false;
        }
        std::vector<Found> all;
        const std::vector<std::string> kinds =
            kind_.empty() ? std::vector<std::string>{} : std::vector<std::string>{kind_};
        each_transaction(trace_, kinds, trace_.start(), trace_.end(), [&](const Transaction& t) {
          all.push_back({t.begin, t.end, t.kind, fmt::format("{}, {}", t.label, t.outcome)});
          return all.size() < kMostTransactions;
        });
        transactions_[kind_] = std::move(all);
        show_transaction(forward);
        return true;
      });
}

void Viewer::show_transaction(bool forward) {
  const std::vector<Found>& all = transactions_.at(kind_);
  const std::string what = kind_.empty() ? "transaction" : "transaction of kind " + kind_;
  if (all.empty()) {
    show_message(fmt::format("the file has no {}", what), true);
    return;
  }
  // Transactions that begin at the same time are visited one by one.
  auto& at = transaction_;
  const bool here = at && *at < all.size() && all[*at].begin == cursor_ && shown_kind_ == kind_;
  std::optional<std::size_t> next;
  if (here) {
    if (forward ? *at + 1 < all.size() : *at > 0) next = forward ? *at + 1 : *at - 1;
  } else {
    const auto bound = [&](std::uint64_t time) {
      return static_cast<std::size_t>(
          std::partition_point(all.begin(), all.end(),
                               [&](const Found& f) { return f.begin < time; }) -
          all.begin());
    };
    const std::size_t i = forward ? bound(cursor_ + 1) : bound(cursor_);
    if (forward ? i < all.size() : i > 0) next = forward ? i : i - 1;
  }
  if (!next) {
    no_more("no " + what, forward);
    return;
  }
  at = next;
  shown_kind_ = kind_;
  const Found& f = all[*next];
  move_to(f.begin);
  show_message(fmt::format("{} {}, {} to {} ({} of {})", f.kind, f.text, times_.text(f.begin),
                           times_.text(f.end), *next + 1, all.size()));
}

void Viewer::next_difference(bool forward) {
  if (other_trace_ == nullptr) {
    show_message("there is no second file; start with cde wave tui FILE --diff OTHER.fst", true);
    return;
  }
  begin_search("differences",
               [this, forward, k = tracks_.block_of(cursor_), i = std::size_t{0},
                best = std::optional<std::uint64_t>(), row = std::size_t{0}]() mutable {
                 // Reads several signals at once, because reading a block for one signal takes as
                 // long.
                 std::vector<std::uint32_t> handles, others;
                 const std::size_t stop = std::min(list_.size(), i + batch_);
                 for (std::size_t n = i; n < stop; ++n)
                   if (list_[n].other && !list_[n].differ.contains(k)) {
                     handles.push_back(list_[n].wave.view().signal.handle);
                     others.push_back(list_[n].other->view().signal.handle);
                   }
                 const Stretch block = tracks_.blocks()[k];
                 at_progress(block.begin);
                 tracks_.load(k, handles);
                 if (!others.empty())
                   for (std::size_t b = other_tracks_->block_of(block.begin);
                        b <= other_tracks_->block_of(block.end); ++b)
                     other_tracks_->load(b, others);
                 for (; i < stop; ++i) {
                   if (!list_[i].other) continue;
                   for (const Stretch& s : differences_of(list_[i], k)) {
                     if (forward ? s.begin <= cursor_ : s.begin >= cursor_) continue;
                     if (best && (forward ? s.begin >= *best : s.begin <= *best)) continue;
                     if (s.begin == block.begin && k > 0) {  // may continue from the previous block
                       const auto& before = differences_of(list_[i], k - 1);
                       if (!before.empty() && before.back().end + 1 == s.begin) continue;
                     }
                     best = s.begin;
                     row = i;
                   }
                 }
                 if (i < list_.size()) return false;
                 if (best) {
                   move_to(*best);
                   choose(row);
                   show_message(fmt::format("{} differs", list_[row].wave.view().label));
                   return true;
                 }
                 if (forward ? k + 1 == tracks_.blocks().size() : k == 0) {
                   no_more("no difference", forward);
                   return true;
                 }
                 k = forward ? k + 1 : k - 1;
                 i = 0;
                 return false;
               });
}

}  // namespace cde::wave::tui
