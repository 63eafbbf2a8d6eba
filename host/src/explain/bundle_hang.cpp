// SPDX-License-Identifier: Apache-2.0
// Explains a card that did not finish a command: the last transactions on it.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <deque>

#include "cde/explain/bundle.hpp"
#include "cde/support/error.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/transaction.hpp"

namespace cde {
namespace {

// The card is polled, so it stopped within this many cycles.
constexpr std::uint64_t kAheadOfHang = 400, kBehind = 20'000;
constexpr std::size_t kLast = 16;  // number of transactions listed

}  // namespace

void bundle_hang(Bundle& bundle, const Failure& failure) {
  const auto& f = std::get<HangFailure>(failure.kind);
  bundle.add("What failed", failure.message);
  bundle.json().update(
      {{"failure", "timeout"},
       {"repeat_command", failure.repeat.empty() ? nlohmann::ordered_json()
                                                 : nlohmann::ordered_json(failure.repeat)}});
  const NamelessFile waves = bundle.whole_waves();
  const std::string whole = waves.by_name();
  const std::uint64_t from = f.cycle > kAheadOfHang ? f.cycle - kAheadOfHang : 0;
  (void)failure.rerun(whole, {.from = from, .to = f.cycle + kBehind});
  std::deque<wave::Transaction> last, open;
  std::uint64_t fail = 0;
  std::string text;
  {
    wave::Trace trace(whole);
    const wave::Times times(trace, "");
    fail = trace.start();
    wave::each_transaction(trace, {}, trace.start(), trace.end(), [&](const wave::Transaction& t) {
      auto& list = t.outcome == "open" ? open : last;
      if (&list == &last) fail = std::max(fail, t.end);
      list.push_back(t);
      if (list.size() > kLast) list.pop_front();
      return true;
    });
    const auto lines = [&](const char* heading, const std::deque<wave::Transaction>& list) {
      if (list.empty()) return;
      text += fmt::format("{}\n", heading);
      for (const wave::Transaction& t : list)
        text += fmt::format("  {:>12}  {:<9}  {:<8}  {}\n", times.text(t.begin), t.kind, t.outcome,
                            t.label);
    };
    lines("Last finished transactions:", last);
    lines("Unfinished transactions:", open);
    if (f.unit) {
      // Rising edges are at odd times. The answer is visible after this many edges.
      const std::uint64_t edges = std::max<std::uint64_t>(f.cycle - from, 1);
      fail = std::min((trace.start() | 1) + 2 * (edges - 1), trace.end());
    }
  }
  if (!failure.repeat.empty())
    bundle.add("Again", fmt::format("{}\n\n    {}\n",
                                    f.unit ? "In this folder:" : "Repeat with:", failure.repeat));
  if (!f.unit)
    bundle.add("On the card", text.empty() ? "Nothing happened in these cycles.\n" : text);
  cut_waves(bundle, whole,
            {.fail = fail,
             .before = kAheadOfHang,
             .behind = kAheadOfHang,
             .shown = f.shown,
             .first = f.shown,
             .what = "the last transaction"});
}

}  // namespace cde
