// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/follow.hpp"

#include <algorithm>

#include "cde/support/error.hpp"

namespace cde::wave {

Follow::Follow(Trace& trace, const std::string& what, const std::string& when,
               const std::string& on)
    : what_(trace, what, "the expression") {
  if (!when.empty()) when_.emplace(trace, when, "--when");
  if (!on.empty()) on_.emplace(trace, on);
  for (const View& v : what_.views()) note(v);
  if (when_)
    for (const View& v : when_->views()) note(v);
  if (on_) handles_.push_back(on_->handle);
  if (handles_.empty())
    throw Error(ErrorCode::kUsage, "the expression has no signal: it is always the same");
  values_.resize(trace.handles() + std::size_t{1});
}

void Follow::note(const View& v) {
  handles_.push_back(v.signal.handle);
  const bool known =
      std::any_of(views_.begin(), views_.end(), [&](const View& s) { return s.label == v.label; });
  if (!known) views_.push_back(v);
}

std::vector<std::string> Follow::texts() const {
  std::vector<std::string> all;
  for (const View& v : views_) all.push_back(v.text(values_[v.signal.handle]));
  return all;
}

bool Follow::needs_history() const {
  return what_.needs_history() || (when_ && when_->needs_history());
}

void Follow::run(Trace& trace, std::uint64_t from, std::uint64_t to, const Found& found) {
  now_ = from;
  const bool goes_on = begun_;
  bool go_on = true;
  trace.stream(handles_, from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now_) {
                   go_on = step(found);
                   if (!go_on) return false;
                   now_ = time;
                 }
                 // When a run resumes, it reports unchanged values again.
                 if (!goes_on || time != from || values_[handle] != value)
                   waiting_.emplace_back(handle, value);
                 return true;
               });
  if (go_on) (void)step(found);
}

bool Follow::edge() const {
  if (!on_ || !begun_) return false;
  bool any = false;
  char before = clock_;
  for (const auto& [handle, value] : waiting_)
    if (handle == on_->handle) {
      any = any || on_->happens(before, value[0]);
      before = value[0];
    }
  return any;
}

/// Called when all changes of `now_` have arrived. False to stop.
bool Follow::step(const Found& found) {
  if (begun_ && waiting_.empty()) return true;
  // Values from just before the edge: the new ones are not applied yet.
  const bool go_on = edge() && evaluate() ? found(now_) : true;
  for (const auto& [handle, value] : waiting_) {
    values_[handle] = value;
    what_.set(handle, value);
    if (when_) when_->set(handle, value);
    if (on_ && handle == on_->handle) clock_ = value[0];
  }
  waiting_.clear();
  begun_ = true;
  if (on_) {
    (void)what_.end_instant();
    if (when_) (void)when_->end_instant();
    return go_on;
  }
  const bool now = evaluate(), begins = now && (!was_ || needs_history());
  was_ = now;
  const bool goes_on = begins ? found(now_) : true;
  // An event ends with its instant.
  const bool events = what_.end_instant(), more = when_ && when_->end_instant();
  if (events || more) was_ = evaluate();
  return goes_on;
}

bool Follow::evaluate() {
  // Evaluates both, as either may look back.
  const bool a = what_.evaluate(), b = when_ ? when_->evaluate() : true;
  return a && b;
}

}  // namespace cde::wave
