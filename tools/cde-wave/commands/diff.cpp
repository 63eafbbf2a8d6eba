// SPDX-License-Identifier: Apache-2.0
// cde wave diff: finds where two files differ first.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/changes.hpp"
#include "commands/commands.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

struct Change {
  std::uint64_t time;
  std::uint32_t handle;
  std::string value;
};

/// The changes of a file one by one. A thread reads them, at most a few batches ahead.
class Puller {
 public:
  /// `settled`: only changes (changes.hpp), else all values in the file.
  Puller(Trace& trace, std::vector<std::uint32_t> handles, bool settled = false)
      : settled_(settled),
        thread_([this, &trace, handles = std::move(handles)] { read(trace, handles); }) {}
  ~Puller() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Puller(const Puller&) = delete;
  Puller& operator=(const Puller&) = delete;

  /// The next change, valid until pop(); null at the end.
  const Change* peek() {
    if (at_ == batch_.size() && !refill()) return nullptr;
    return &batch_[at_];
  }
  void pop() { ++at_; }

 private:
  static constexpr std::size_t kBatch = 4096, kAhead = 4;

  bool refill() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !ready_.empty() || ended_; });
    if (ready_.empty()) {
      if (failed_) std::rethrow_exception(failed_);
      return false;
    }
    batch_ = std::move(ready_.front());
    ready_.pop_front();
    at_ = 0;
    changed_.notify_all();
    return true;
  }
  bool hand_over(std::vector<Change>& batch) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ready_.size() < kAhead || stop_; });
    if (!batch.empty()) ready_.push_back(std::move(batch));
    batch.clear();
    changed_.notify_all();
    return !stop_;
  }
  void read(Trace& trace, const std::vector<std::uint32_t>& handles) {
    std::exception_ptr failed;
    try {
      std::vector<Change> batch;
      const Trace::Visit visit = [&](std::uint64_t time, std::uint32_t handle,
                                     std::string_view value) {
        batch.push_back({time, handle, std::string(value)});
        return batch.size() < kBatch || hand_over(batch);
      };
      if (settled_)
        stream_changes(trace, handles, trace.start(), trace.end(), visit);
      else
        trace.stream(handles, trace.start(), trace.end(), visit);
      (void)hand_over(batch);
    } catch (...) {
      failed = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    failed_ = failed;
    ended_ = true;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<Change>> ready_;
  std::vector<Change> batch_;
  std::size_t at_ = 0;
  bool ended_ = false, stop_ = false;
  std::exception_ptr failed_;
  const bool settled_;
  std::thread thread_;
};

/// A signal that is in both files.
struct Pair {
  View a, b;
  std::string value_a, value_b;
  std::deque<Change> ahead_a,
      ahead_b;  ///< for --align event: changes that the other file does not have yet
  std::uint64_t event = 0;
  bool done = false;
};

struct Divergence {
  std::size_t pair;
  std::uint64_t time_a, time_b;
  std::string value_a, value_b;
  std::string what;  ///< the difference, if it is not one of values
  std::optional<std::uint64_t> cycle;
};

/// The distance between two words of a format, counted in representable numbers.
std::uint64_t ulps(std::uint64_t a, std::uint64_t b, const FpFormat& f) {
  const auto line = [&](std::uint64_t w) {
    const auto magnitude = static_cast<std::int64_t>(w & f.magnitude_mask());
    return (w & f.sign_bit()) != 0 ? -magnitude : magnitude;
  };
  const std::int64_t x = line(a), y = line(b);
  return x > y ? static_cast<std::uint64_t>(x) - static_cast<std::uint64_t>(y)
               : static_cast<std::uint64_t>(y) - static_cast<std::uint64_t>(x);
}

/// Decides which values count as equal.
class Equal {
 public:
  explicit Equal(const Request& r) : ulp_(r.ulp), eps_(r.eps) {}

  [[nodiscard]] bool operator()(const View& v, std::string_view a, std::string_view b) const {
    if (a == b) return true;
    if (ulp_ == 0 && eps_ == 0) return false;  // 0 and -0 differ
    if (v.signal.real) return near_reals(a, b);
    if (v.form.kind != Form::Kind::kFloat || v.signal.text) return false;
    if (a.size() != b.size()) return false;
    const auto own = static_cast<std::size_t>(v.form.format.width());
    const std::size_t lane = v.form.lane != 0 ? v.form.lane
                             : a.size() % own == 0
                                 ? own
                                 : static_cast<std::size_t>(contract::container(
                                       v.form.format.exp_bits, v.form.format.man_bits));
    if (lane < own || a.size() % lane != 0) return false;
    for (std::size_t at = 0; at < a.size(); at += lane)
      if (!lanes(v.form, a.substr(at, lane), b.substr(at, lane))) return false;
    return true;
  }

 private:
  [[nodiscard]] bool near_reals(std::string_view a, std::string_view b) const {
    double x = 0, y = 0;
    if (std::from_chars(a.data(), a.data() + a.size(), x).ec != std::errc() ||
        std::from_chars(b.data(), b.data() + b.size(), y).ec != std::errc())
      return false;
    return std::fabs(x - y) <= eps_;
  }
  [[nodiscard]] bool lanes(const Form& form, std::string_view a, std::string_view b) const {
    if (a == b) return true;
    const auto ones = [](std::string_view bits) {
      return bits.find('0') == std::string_view::npos;
    };
    if (form.mask && (ones(a) || ones(b))) return false;
    const FpFormat& f = form.format;
    const auto own = static_cast<std::size_t>(f.width());
    const auto x = word(a.substr(a.size() - own)), y = word(b.substr(b.size() - own));
    if (!x || !y || f.is_nan(*x) != f.is_nan(*y)) return false;
    if (f.is_nan(*x)) return true;
    return ulps(*x, *y, f) <= ulp_ || std::fabs(f.decode(*x) - f.decode(*y)) <= eps_;
  }
  std::uint64_t ulp_;
  double eps_;
};

class Comparison {
 public:
  Comparison(const Request& r, Trace& a, Trace& b)
      : r_(r), a_(a), b_(b), forms_a_(a), forms_b_(b), equal_(r) {
    match();
  }

  [[nodiscard]] bool any_numbers() const {
    return std::any_of(pairs.begin(), pairs.end(),
                       [](const Pair& p) { return p.a.form.kind == Form::Kind::kFloat; });
  }
  void run() {
    if (r_.align == "cycle")
      by_cycle();
    else if (r_.align == "event")
      by_event();
    else
      by_time();
    std::stable_sort(found.begin(), found.end(),
                     [](const Divergence& x, const Divergence& y) { return x.time_a < y.time_a; });
  }

  std::vector<Pair> pairs;
  std::vector<Divergence> found;
  std::size_t only_a = 0, only_b = 0, ignored = 0;

 private:
  [[nodiscard]] bool is_ignored(const std::string& name) const {
    return std::any_of(r_.ignore.begin(), r_.ignore.end(), [&](const std::string& glob) {
      return matches(glob, name) || matches("*." + glob, name);
    });
  }

  void match() {
    // Signals with the same name are paired in the order of the files.
    std::map<std::string_view, std::deque<const Signal*>> there;
    for (const Signal& s : b_.signals()) there[s.name].push_back(&s);
    of_a_.resize(a_.handles() + std::size_t{1});
    of_b_.resize(b_.handles() + std::size_t{1});
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> seen;
    std::size_t common = 0;
    for (const Signal& s : a_.signals()) {
      const auto other = there.find(s.name);
      if (other == there.end() || other->second.empty()) {
        ++only_a;
        continue;
      }
      ++common;
      const Signal& t = *other->second.front();
      other->second.pop_front();
      if (s.event || is_ignored(s.name)) {
        ++ignored;
        continue;
      }
      if (!seen.emplace(std::pair{s.handle, t.handle}, true).second)
        continue;  // an alias of a pair that is already there
      Pair p;
      p.a = whole(forms_a_, s);
      p.b = whole(forms_b_, t);
      if (s.width != t.width) {
        p.done = true;
        found.push_back({pairs.size(),
                         a_.start(),
                         b_.start(),
                         "",
                         "",
                         fmt::format("{}, {}", counted(s.width, "bit"), counted(t.width, "bit")),
                         {}});
      }
      of_a_[s.handle].push_back(pairs.size());
      of_b_[t.handle].push_back(pairs.size());
      pairs.push_back(std::move(p));
    }
    only_b = b_.signals().size() - std::min(b_.signals().size(), common);
    if (common == 0)
      throw Error(ErrorCode::kUsage, "the files have no signal in common; no name is in both");
  }
  [[nodiscard]] View whole(const FileForms& forms, const Signal& s) const {
    View v;
    v.signal = s;
    v.label = s.name;
    v.width = s.width;
    v.form = forms.of(s, r_.default_form());
    return v;
  }
  [[nodiscard]] std::vector<std::uint32_t> handles(bool of_a) const {
    std::vector<std::uint32_t> all;
    for (const Pair& p : pairs) all.push_back(of_a ? p.a.signal.handle : p.b.signal.handle);
    return all;
  }
  void diverges(std::size_t i, std::uint64_t time_a, std::uint64_t time_b,
                std::optional<std::uint64_t> cycle = {}) {
    Pair& p = pairs[i];
    p.done = true;
    found.push_back({i, time_a, time_b, p.a.text(p.value_a), p.b.text(p.value_b), "", cycle});
  }

  /// Applies a change to the pairs with its signal.
  void take(const Change& c, bool of_a, std::vector<std::size_t>& touched) {
    for (const std::size_t i : of_a ? of_a_[c.handle] : of_b_[c.handle]) {
      if (pairs[i].done) continue;
      (of_a ? pairs[i].value_a : pairs[i].value_b) = c.value;
      touched.push_back(i);
    }
  }
  void compare(std::vector<std::size_t>& touched, std::uint64_t time_a, std::uint64_t time_b,
               std::optional<std::uint64_t> cycle = {}) {
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const std::size_t i : touched)
      if (!pairs[i].done && !equal_(pairs[i].a, pairs[i].value_a, pairs[i].value_b))
        diverges(i, time_a, time_b, cycle);
    touched.clear();
  }

  /// Compares values at the same times. The shorter file ends the comparison.
  void by_time() {
    Puller a(a_, handles(true)), b(b_, handles(false));
    const std::uint64_t start = std::max(a_.start(), b_.start()),
                        end = std::min(a_.end(), b_.end());
    std::vector<std::size_t> touched;
    for (;;) {
      const Change *x = a.peek(), *y = b.peek();
      if (x == nullptr && y == nullptr) break;
      const std::uint64_t time =
          std::min(x != nullptr ? x->time : UINT64_MAX, y != nullptr ? y->time : UINT64_MAX);
      if (time > end) break;
      for (; x != nullptr && x->time == time; a.pop(), x = a.peek()) take(*x, true, touched);
      for (; y != nullptr && y->time == time; b.pop(), y = b.peek()) take(*y, false, touched);
      if (time >= start) compare(touched, time, time);
    }
  }

  /// Compares values just before each rising edge of the clocks. The shorter file ends the
  /// comparison.
  void by_cycle() {
    Times times_a(a_, r_.clock), times_b(b_, r_.clock);
    const std::uint32_t clock_a = times_a.clock().handle, clock_b = times_b.clock().handle;
    std::vector<std::uint32_t> all_a = handles(true), all_b = handles(false);
    all_a.push_back(clock_a);
    all_b.push_back(clock_b);
    Puller a(a_, all_a), b(b_, all_b);
    char state_a = 'x', state_b = 'x';
    std::vector<std::size_t> touched;
    std::vector<Change> step_a, step_b;
    for (std::uint64_t cycle = 0;; ++cycle) {
      const auto at_a = to_edge(a, true, clock_a, state_a, step_a, touched);
      const auto at_b = to_edge(b, false, clock_b, state_b, step_b, touched);
      if (!at_a || !at_b) break;
      compare(touched, *at_a, *at_b, cycle);
    }
  }
  /// Takes the changes before the next rising edge. `step` gets the changes at the edge.
  std::optional<std::uint64_t> to_edge(Puller& p, bool of_a, std::uint32_t clock, char& state,
                                       std::vector<Change>& step,
                                       std::vector<std::size_t>& touched) {
    for (const Change& c : step)
      if (c.handle != clock) take(c, of_a, touched);
    step.clear();
    while (const Change* c = p.peek()) {
      const std::uint64_t time = c->time;
      bool rises = false;
      for (; c != nullptr && c->time == time; p.pop(), c = p.peek()) {
        if (c->handle == clock) {
          rises = rises || (state == '0' && c->value[0] == '1');
          state = c->value[0];
        }
        step.push_back(*c);
      }
      if (rises) return time;
      for (const Change& s : step)
        if (s.handle != clock) take(s, of_a, touched);
      step.clear();
    }
    return std::nullopt;
  }

  /// Compares the changes of each signal one by one, at any time.
  void by_event() {
    Puller a(a_, handles(true), true), b(b_, handles(false), true);
    for (;;) {
      const Change* x = a.peek();
      if (x != nullptr) {
        event(*x, true);
        a.pop();
      }
      const Change* y = b.peek();
      if (y != nullptr) {
        event(*y, false);
        b.pop();
      }
      if (x == nullptr && y == nullptr) break;
    }
  }
  void event(const Change& c, bool of_a) {
    for (const std::size_t i : of_a ? of_a_[c.handle] : of_b_[c.handle]) {
      Pair& p = pairs[i];
      if (p.done) continue;
      // Writing the same value again is no change.
      std::string& last = of_a ? last_a(i) : last_b(i);
      if (last == c.value) continue;
      last = c.value;
      (of_a ? p.ahead_a : p.ahead_b).push_back(c);
      while (!p.done && !p.ahead_a.empty() && !p.ahead_b.empty()) {
        p.value_a = p.ahead_a.front().value;
        p.value_b = p.ahead_b.front().value;
        if (!equal_(p.a, p.value_a, p.value_b))
          diverges(i, p.ahead_a.front().time, p.ahead_b.front().time);
        p.ahead_a.pop_front();
        p.ahead_b.pop_front();
      }
      if (p.done) {
        p.ahead_a.clear();
        p.ahead_b.clear();
      }
    }
  }
  std::string& last_a(std::size_t i) {
    last_a_.resize(pairs.size());
    return last_a_[i];
  }
  std::string& last_b(std::size_t i) {
    last_b_.resize(pairs.size());
    return last_b_[i];
  }

  const Request& r_;
  Trace& a_;
  Trace& b_;
  const FileForms forms_a_, forms_b_;
  Equal equal_;
  std::vector<std::vector<std::size_t>> of_a_, of_b_;
  std::vector<std::string> last_a_, last_b_;
};

}  // namespace

int diff(const Request& r) {
  if (r.words.size() != 1)
    throw Error(ErrorCode::kUsage, "cde wave diff needs two files: cde wave diff A B");
  Trace a(r.file), b(r.words.front());
  warn_if_cut(a, Times(a, ""));
  warn_if_cut(b, Times(b, ""));
  if (a.scale() != b.scale())
    throw Error(ErrorCode::kUsage, fmt::format("the files count time in units of 1e{} s and 1e{} s",
                                               a.scale(), b.scale()));
  Comparison c(r, a, b);
  if ((r.ulp != 0 || r.eps != 0) && !c.any_numbers())
    throw Error(ErrorCode::kUsage,
                "--ulp and --eps need the format of the numbers, e.g. --as fp32");
  c.run();
  const Times times(a, "");
  Lines lines(r.max);
  Json list = Json::array();
  std::string text;
  for (const Divergence& d : c.found) {
    if (!lines.next()) continue;
    const std::string& name = c.pairs[d.pair].a.label;
    if (r.json) {
      list.push_back({{"name", name},
                      {"time", times.number(d.time_a)},
                      {"other_time", times.number(d.time_b)},
                      {"at", times.text(d.time_a)},
                      {"cycle", nullptr},
                      {"value", d.value_a},
                      {"other_value", d.value_b},
                      {"why", d.what.empty() ? Json() : Json(d.what)}});
      if (d.cycle) list.back()["cycle"] = *d.cycle;
      continue;
    }
    std::string when = times.text(d.time_a);
    if (d.time_b != d.time_a) when += " / " + times.text(d.time_b);
    if (d.cycle) when += fmt::format("  cyc:{}", *d.cycle);
    text += fmt::format("{}  {}  {}\n", when, printable_name(name),
                        d.what.empty() ? printable_name(d.value_a + " / " + d.value_b) : d.what);
  }
  const int status = c.found.empty() ? 0 : 1;
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"other_file", r.words.front()},
              {"align", r.align},
              {"compared", c.pairs.size()},
              {"differing", c.found.size()},
              {"only_in_file", c.only_a},
              {"only_in_other", c.only_b},
              {"ignored", c.ignored},
              {"differences", list},
              {"more", lines.more()}});
    cli::print_json(j);
    return status;
  }
  text += lines.rest();
  text += fmt::format("{} of {} {}", c.found.size(), counted(c.pairs.size(), "signal"),
                      c.found.size() == 1 ? "differs" : "differ");
  if (c.only_a + c.only_b + c.ignored != 0)
    text += fmt::format("; {} only in the first file, {} only in the second, {} ignored", c.only_a,
                        c.only_b, c.ignored);
  cli::print(text + "\n");
  return status;
}

}  // namespace cde::wave
