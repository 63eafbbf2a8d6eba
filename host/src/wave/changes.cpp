// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/changes.hpp"

#include <string>
#include <vector>

namespace cde::wave {
namespace {

struct Settling {
  std::string value, next;
  bool known = false, waits = false, event = false;
};

/// Collects the changes of an instant and reports them at its end.
class Instant {
 public:
  Instant(Trace& trace, const Trace::Visit& visit)
      : visit_(visit), signals_(trace.handles() + std::size_t{1}) {
    for (const Signal& s : trace.signals()) signals_[s.handle].event = s.event;
  }
  bool take(std::uint64_t time, std::uint32_t handle, std::string_view value) {
    if (time != now_ && !end()) return false;
    now_ = time;
    Settling& s = signals_[handle];
    s.next = value;
    if (!s.waits) touched_.push_back(handle);
    s.waits = true;
    return true;
  }
  bool end() {
    bool go_on = true;
    for (const std::uint32_t handle : touched_) {
      Settling& s = signals_[handle];
      s.waits = false;
      if (!go_on || (s.known && !s.event && s.next == s.value)) continue;
      s.known = true;
      s.value.swap(s.next);
      go_on = visit_(now_, handle, s.value);
    }
    touched_.clear();
    return go_on;
  }

 private:
  const Trace::Visit& visit_;
  std::vector<Settling> signals_;
  std::vector<std::uint32_t> touched_;
  std::uint64_t now_ = 0;
};

}  // namespace

void stream_changes(Trace& trace, std::span<const std::uint32_t> handles, std::uint64_t from,
                    std::uint64_t to, const Trace::Visit& visit) {
  Instant instant(trace, visit);
  bool go_on = true;
  trace.stream(handles, from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 go_on = instant.take(time, handle, value);
                 return go_on;
               });
  if (go_on) (void)instant.end();
}

}  // namespace cde::wave
