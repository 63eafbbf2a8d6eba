// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/measure.hpp"

#include <algorithm>

#include "cde/wave/four_state.hpp"

namespace cde::wave {
namespace {

/// 1 if any bit is 1, x if none is 1 and one is unknown.
char reduced(std::string_view value) {
  char all = '0';
  for (const char own : value) {
    const char c = four_state(own);
    if (c == '1') return '1';
    if (c != '0') all = 'x';
  }
  return all;
}

}  // namespace

Measure::Measure(Trace& trace, Flows flows, std::vector<View> views)
    : handshakes(std::move(flows.handshakes)),
      pipes(std::move(flows.pipes)),
      uses(handshakes.size()),
      bubbles(pipes.size()),
      of_(trace.handles() + std::size_t{1}),
      now_(trace.handles() + std::size_t{1}, 0) {
  for (View& v : views) {
    Activity& a = signals.emplace_back();
    a.bits = !v.signal.real && !v.signal.text;
    a.view = std::move(v);
  }
  for (std::size_t i = 0; i < signals.size(); ++i) of_[signals[i].view.signal.handle].push_back(i);
  for (std::size_t i = 0; i < handshakes.size(); ++i) {
    const Handshake& h = handshakes[i];
    domain(h.clock).handshakes.push_back(i);
    sample(h.valid.handle);
    sample(h.ready.handle);
    if (h.is_pci()) sample(h.frame.handle);
  }
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    domain(pipes[i].clock).pipes.push_back(i);
    sample(pipes[i].handle);
  }
}

void Measure::run(Trace& trace, std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint32_t> handles;
  for (std::uint32_t h = 0; h < now_.size(); ++h)
    if (now_[h] != 0 || !of_[h].empty()) handles.push_back(h);
  std::uint64_t time = from;
  dark = blackouts_in(trace, from, to);
  if (!dark.empty())
    for (Activity& a : signals) a.dark = &dark;
  bool counts = true;
  trace.stream(
      handles, from, to, [&](std::uint64_t t, std::uint32_t handle, std::string_view value) {
        if (t != time) {
          step(time, time == from);
          time = t;
          counts = dark.empty() || (!is_dark(dark, t) && (t == 0 || !is_dark(dark, t - 1)));
        }
        for (const std::size_t i : of_[handle])
          t == from ? signals[i].begin(t, value) : signals[i].change(t, value, counts);
        if (now_[handle] != 0) waiting_.emplace_back(handle, reduced(value));
        return true;
      });
  step(time, time == from);
  for (Activity& a : signals) {
    a.settle();
    a.stretch(to);
  }
  for (std::size_t i = 0; i < uses.size(); ++i) end_stall(i);
}

Measure::Domain& Measure::domain(std::uint32_t clock) {
  for (Domain& d : domains_)
    if (d.handle == clock) return d;
  sample(clock);
  return domains_.emplace_back(Domain{clock, 0, {}, {}});
}
/// '0', '1' or 'x' of a wire, corrected for polarity.
char Measure::level(const HandshakeWire& w) const {
  const char c = now_[w.handle];
  return !w.low || c == 'x' ? c : c == '1' ? '0' : '1';
}

/// Called when all changes of a time have arrived. A clock samples the values before them.
void Measure::step(std::uint64_t time, bool begins) {
  if (!begins)
    for (Domain& d : domains_) {
      char before = now_[d.handle];
      bool rises = false;
      for (const auto& [handle, value] : waiting_)
        if (handle == d.handle) {
          rises = rises || (before == '0' && value == '1');
          before = value;
        }
      if (rises && (dark.empty() || !is_dark(dark, time))) cycle(d, time);
    }
  for (const auto& [handle, value] : waiting_) now_[handle] = value;
  waiting_.clear();
}

void Measure::cycle(Domain& d, std::uint64_t time) {
  for (const std::size_t i : d.handshakes)
    handshakes[i].is_pci() ? pci(i, time, d.cycles) : handshake(i, time, d.cycles);
  for (const std::size_t i : d.pipes) pipe(i, time);
  ++d.cycles;
}

void Measure::handshake(std::size_t i, std::uint64_t time, std::uint64_t number) {
  Use& u = uses[i];
  ++u.cycles;
  const char valid = level(handshakes[i].valid), ready = level(handshakes[i].ready);
  if (valid == '1' && ready == '0') return stall(i, time, number);
  end_stall(i);
  if (valid == '0')
    ++u.idle;
  else if (valid == '1' && ready == '1')
    ++u.transferred;
  else
    ++u.unknown;
}

void Measure::pci(std::size_t i, std::uint64_t time, std::uint64_t number) {
  Use& u = uses[i];
  ++u.cycles;
  const Handshake& h = handshakes[i];
  const char frame = level(h.frame), irdy = level(h.valid), trdy = level(h.ready);
  const bool address = frame == '1' && !u.framed;
  u.framed = frame == '1';
  const bool known = frame != 'x' && irdy != 'x' && trdy != 'x';
  if (known && !address && (frame == '1' || irdy == '1') && !(irdy == '1' && trdy == '1'))
    return stall(i, time, number);
  end_stall(i);
  if (!known)
    ++u.unknown;
  else if (address)
    ++u.address;
  else if (irdy == '1')
    ++u.transferred;
  else
    ++u.idle;
}

void Measure::stall(std::size_t i, std::uint64_t time, std::uint64_t number) {
  Use& u = uses[i];
  ++u.stalled;
  if (u.run++ == 0) {
    u.run_time = time;
    stalls.push_back({i, number, number, time});
    open_.resize(uses.size());
    open_[i] = stalls.size() - 1;
  }
  stalls[open_[i]].last = number;
}
void Measure::end_stall(std::size_t i) {
  Use& u = uses[i];
  if (u.run > u.longest) {
    u.longest = u.run;
    u.longest_time = u.run_time;
  }
  u.run = 0;
}

void Measure::pipe(std::size_t i, std::uint64_t time) {
  Bubbles& b = bubbles[i];
  ++b.cycles;
  if (now_[pipes[i].handle] == '1') {
    if (b.valid++ == 0) b.first = time;
    b.last = time;
    b.empty += b.gap;  // not the end of the burst
    if (b.gap > b.longest) {
      b.longest = b.gap;
      b.longest_time = b.gap_time;
    }
    b.gap = 0;
  } else if (b.valid != 0 && now_[pipes[i].handle] == '0' && b.gap++ == 0) {
    b.gap_time = time;
  }
}

}  // namespace cde::wave
