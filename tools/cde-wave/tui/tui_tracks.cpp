// SPDX-License-Identifier: Apache-2.0
#include "tui/tui_tracks.hpp"

#include <algorithm>
#include <utility>

#include "cde/wave/four_state.hpp"

namespace cde::wave::tui {

void Track::add(std::uint64_t time, std::string_view value) {
  if (!times_.empty() && value == last_) return;
  if (!times_.empty() && time == times_.back()) {
    // Only the last of several values at one time counts.
    values_.resize(values_.size() - (text_ ? last_.size() : (width_ + 3) / 4));
    times_.pop_back();
    if (text_) ends_.pop_back();
    last_ = before_;
    if (!times_.empty() && value == last_) return;
  }
  before_ = std::exchange(last_, std::string(value));
  times_.push_back(time);
  if (text_ || value.size() != width_) {
    // A real number, or text that is not bits: from now on all values are kept as text.
    text_ = true;
    values_ += value;
    ends_.push_back(values_.size());
    return;
  }
  for (std::size_t at = 0; at < value.size(); at += 4) {
    unsigned byte = 0;
    for (std::size_t i = at; i < std::min(at + 4, value.size()); ++i) {
      const char c = four_state(value[i]);
      byte |= (c == '0' ? 0u : c == '1' ? 1u : c == 'z' ? 2u : 3u) << 2 * (i - at);
    }
    values_.push_back(static_cast<char>(byte));
  }
}

std::string Track::value(std::size_t change) const {
  if (text_) {
    const std::size_t begin = change == 0 ? 0 : ends_[change - 1];
    return values_.substr(begin, ends_[change] - begin);
  }
  const std::size_t begin = change * ((width_ + 3) / 4);
  std::string bits(width_, '0');
  for (std::size_t i = 0; i < width_; ++i)
    bits[i] = "01zx"[static_cast<unsigned char>(values_[begin + i / 4]) >> 2 * (i % 4) & 3u];
  return bits;
}

std::size_t Track::at(std::uint64_t time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return after == times_.begin() ? 0 : static_cast<std::size_t>(after - times_.begin()) - 1;
}

std::size_t Track::bytes() const {
  return sizeof(Track) + times_.capacity() * sizeof(std::uint64_t) + values_.capacity() +
         ends_.capacity() * sizeof(std::size_t);
}

Tracks::Tracks(Trace& trace, std::size_t most_bytes) : trace_(trace), most_bytes_(most_bytes) {
  std::vector<std::uint64_t> begins;
  for (const Section& s : trace.structure().sections) begins.push_back(s.begin);
  std::sort(begins.begin(), begins.end());
  begins.erase(std::unique(begins.begin(), begins.end()), begins.end());
  const std::size_t step = (begins.size() + kMostBlocks - 1) / kMostBlocks;
  blocks_.push_back({trace.start(), trace.end()});
  for (std::size_t i = step; i < begins.size(); i += step) {
    if (begins[i] <= blocks_.back().begin || begins[i] > trace.end()) continue;
    blocks_.back().end = begins[i] - 1;
    blocks_.push_back({begins[i], trace.end()});
  }
  widths_.resize(trace.handles() + std::size_t{1});
  events_.resize(widths_.size());
  for (const Signal& s : trace.signals()) {
    widths_[s.handle] = s.real || s.text ? 0 : s.width;
    events_[s.handle] = s.event;
  }
}

std::size_t Tracks::block_of(std::uint64_t time) const {
  const auto after =
      std::upper_bound(blocks_.begin(), blocks_.end(), time,
                       [](std::uint64_t t, const Stretch& b) { return t < b.begin; });
  return after == blocks_.begin() ? 0 : static_cast<std::size_t>(after - blocks_.begin()) - 1;
}

Tracks::Shared Tracks::find(std::uint32_t handle, std::size_t block) {
  const auto found = kept_.find({handle, block});
  if (found == kept_.end()) return nullptr;
  order_.splice(order_.begin(), order_, found->second.place);
  return found->second.track;
}

void Tracks::load(std::size_t block, const std::vector<std::uint32_t>& handles) {
  std::map<std::uint32_t, std::shared_ptr<Track>> read;
  for (const std::uint32_t h : handles)
    if (!kept_.contains({h, block}))
      read.try_emplace(h, std::make_shared<Track>(widths_[h], widths_[h] == 0));
  if (read.empty()) return;
  std::vector<std::uint32_t> wanted;
  for (const auto& [handle, track] : read) wanted.push_back(handle);
  // Millions of changes may come: each finds its track by index, without a search.
  std::vector<Track*> of(widths_.size());
  for (const auto& [handle, track] : read) of[handle] = track.get();
  trace_.stream(wanted, blocks_[block].begin, blocks_[block].end,
                [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                  of[handle]->add(time, value);
                  // An event is a pulse of one unit of time, drawn as a mark.
                  if (events_[handle] && value == "1" && time < blocks_[block].end)
                    of[handle]->add(time + 1, "0");
                  return true;
                });
  for (auto& [handle, track] : read) {
    ++loads_;
    keep({handle, block}, std::move(track));
  }
}

void Tracks::keep(const Key& key, Shared track) {
  bytes_ += track->bytes();
  order_.push_front(key);
  kept_[key] = {std::move(track), order_.begin()};
  while (bytes_ > most_bytes_ && order_.size() > 1 && order_.back() != key) {
    const auto oldest = kept_.find(order_.back());
    bytes_ -= oldest->second.track->bytes();
    kept_.erase(oldest);
    order_.pop_back();
  }
}

Tracks::Shared Tracks::get(std::uint32_t handle, std::size_t block) {
  if (Shared track = find(handle, block)) return track;
  load(block, {handle});
  const auto found = kept_.find({handle, block});
  return found->second.track;
}

}  // namespace cde::wave::tui
