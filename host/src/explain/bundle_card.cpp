// SPDX-License-Identifier: Apache-2.0
// Explains a record that differs between a card and its reference. Follows the primary from its
// load to the record, and finds the first wrong transaction in the waves.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <optional>

#include "cde/card/pipe_options.hpp"
#include "cde/explain/bundle.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/pairs.hpp"
#include "cde/scene/scene_pair.hpp"
#include "cde/support/error.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/transaction.hpp"
#include "cde/wave/value.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using wave::Transaction;

/// Shorter passes are traced whole, with their primaries and records.
constexpr std::uint64_t kWhole = 6000;
constexpr std::uint64_t kWindow = 600;
constexpr std::uint64_t kAhead = 200;   // cycles of waves before the error
constexpr std::uint64_t kEnd = 12'000;  // from the earliest end of a brute-force pass

struct Waves {
  std::vector<Transaction> all;
  bool whole = false;
};

std::string field_of(const Transaction& t, std::string_view name) {
  for (const auto& [key, value] : t.fields)
    if (key == name) return value;
  return "";
}
std::optional<std::uint64_t> number_of(const Transaction& t, std::string_view name) {
  const std::string text = field_of(t, name);
  std::uint64_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return n;
}

/// The numbers of "{1 0 0.5}".
std::vector<float> numbers_in(std::string_view text) {
  std::vector<float> all;
  while (!text.empty()) {
    const std::size_t start = text.find_first_not_of("{} ");
    if (start == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of("} ", start), text.size());
    float x = std::numeric_limits<float>::quiet_NaN();
    (void)std::from_chars(text.data() + start, text.data() + end, x);
    all.push_back(x);
    text.remove_prefix(end);
  }
  return all;
}

/// The first word that differs; nothing if none does.
std::optional<std::size_t> differing_word(std::span<const float> sent,
                                          std::span<const float> seen) {
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const bool both_nan = i < seen.size() && std::isnan(sent[i]) && std::isnan(seen[i]);
    if (i >= seen.size() || (!both_nan && std::bit_cast<std::uint32_t>(sent[i]) !=
                                              std::bit_cast<std::uint32_t>(seen[i])))
      return i;
  }
  return std::nullopt;
}

/// The stage at which the card went wrong, with a signal that shows it.
struct Stage {
  std::string name, text, signal;
  std::uint64_t time = 0;
};

class Tracker {
 public:
  Tracker(const CardFailure& f, const PairConfig& pipe, const PairIterations& iterations,
          Waves waves)
      : f_(f), pipe_(pipe), iterations_(iterations), waves_(std::move(waves)) {}

  /// Writes lines about each stage, and returns the first wrong stage.
  std::optional<Stage> follow(std::string& text) {
    primary(text);
    for (const auto& [index, words] : f_.difference.secondaries) {
      secondary(text, index, words);
      test(text, index, words);
    }
    record(text);
    return wrong_;
  }

 private:
  void tell(std::string& text, std::string line, bool right, const Transaction& t,
            const std::string& stage, const std::string& signal) {
    text += fmt::format("  {} {}\n", right ? "   " : "-->", line);
    if (right || wrong_) return;
    wrong_ = Stage{stage, std::move(line), signal.empty() ? "" : t.scope + "." + signal,
                   t.end > 0 ? t.end - 1 : 0};
  }

  void operand(std::string& text, const Transaction& t, std::span<const float> sent,
               const std::string& what, const std::string& stage, const std::string& slot) {
    const std::string shown = field_of(t, "operand");
    if (shown.empty()) return;
    const auto word = differing_word(sent, numbers_in(shown));
    tell(text,
         fmt::format(
             "{} is {}{}", what, shown,
             word ? fmt::format(", word {} differs from the sent word", *word) : ", as sent"),
         !word, t, stage, word ? fmt::format("{}[{}]", slot, *word) : "");
  }

  void primary(std::string& text) {
    for (const Transaction& t : waves_.all)
      if (t.kind == "primary" && number_of(t, "primary") == f_.place &&
          !f_.difference.primary.empty())
        operand(text, t, f_.difference.primary, fmt::format("primary {}", f_.place),
                "between the bus and the registers of the primaries", "engine.primaries.slot");
  }
  void secondary(std::string& text, std::uint32_t index, std::span<const float> words) {
    for (const Transaction& t : waves_.all)
      if (t.kind == "secondary" && number_of(t, "index") == index)
        return operand(text, t, words, fmt::format("secondary {}", index),
                       "between the DDR and the pipes, or in the transformer",
                       "secondaries.slot_o");
  }

  /// Whether a list of primaries contains this one; nothing if it does not say.
  [[nodiscard]] std::optional<bool> listed(const Transaction& t, const char* field) const {
    const std::string who = fmt::format(" {} ", field_of(t, field));
    if (who.find(fmt::format(" {} ", f_.place)) != std::string::npos) return true;
    if (who.find("...") != std::string::npos) return std::nullopt;
    return false;
  }

  void test(std::string& text, std::uint32_t index, std::span<const float> words) {
    if (f_.difference.primary.empty()) return;
    const bool hit = expected(words).f;
    for (const Transaction& t : waves_.all) {
      if (t.kind != "test" || number_of(t, "index") != index || row() != number_of(t, "row"))
        continue;
      const std::string port =
          fmt::format("engine.group[0].lanes.port[{}].results.", number_of(t, "port").value_or(0));
      if (const auto seen = listed(t, "hit_primaries"))
        tell(text,
             fmt::format("the pipe says that primary {} and secondary {} {}, {} the reference",
                         f_.place, index, *seen ? "meet" : "do not meet",
                         *seen == hit ? "as" : "unlike"),
             *seen == hit, t, "in the pipe, or between it and its operands",
             fmt::format("{}f[{}]", port, lane()));
      const auto kept = listed(t, "kept_primaries"), wanted = to_be_kept(index);
      if (kept && wanted)
        tell(text,
             fmt::format("the card {} secondary {} for primary {}, {} the reference",
                         *kept ? "keeps" : "does not keep", index, f_.place,
                         *kept == *wanted ? "as" : "unlike"),
             *kept == *wanted, t, "in the choice of the better answer",
             fmt::format("{}update.better[{}]", port, lane()));
      return;
    }
    if (waves_.whole)
      text +=
          fmt::format("  --> primary {} was not tested against secondary {}\n", f_.place, index);
  }

  /// Whether the record of this index must be kept. The reference's winner is better than all
  /// before it and no later one is better.
  [[nodiscard]] std::optional<bool> to_be_kept(std::uint32_t index) const {
    if (f_.mode == Mode::kAll || f_.mode == Mode::kHits || !f_.difference.reference)
      return std::nullopt;
    const std::uint32_t winner = f_.difference.reference->index;
    if (index == winner) return true;
    if (winner == ~0u || index > winner) return false;
    return std::nullopt;
  }

  void record(std::string& text) {
    const auto& wanted = f_.difference.reference;
    for (const Transaction& t : waves_.all) {
      if (t.kind != "record" || number_of(t, "primary") != f_.place) continue;
      const std::string index = field_of(t, "index");
      if (wanted && wanted->f && index != "none" && number_of(t, "index") != wanted->index &&
          waves_.all.size() > 1 && field_of(t, "normal") == "0" && many_records() &&
          !is_of_no_pair(t))
        continue;  // record of another secondary
      const std::vector<float> distance = numbers_in(field_of(t, "T"));
      const bool same =
          wanted && !distance.empty() && !differing_word(std::span(&wanted->t, 1), distance) &&
          (wanted->index == ~0u ? index == "none" : number_of(t, "index") == wanted->index);
      return tell(
          text,
          fmt::format("the record of primary {} has secondary {}, T {}, {}", f_.place, index,
                      field_of(t, "T"), same ? "as the reference" : "unlike the reference"),
          same, t, "between the kept answer and the record", "records.record_o[4]");
    }
    if (waves_.whole && wanted)
      text += fmt::format("  --> no record of primary {} was written\n", f_.place);
  }
  /// Whether the record's distance differs from the distance of its secondary's pair.
  [[nodiscard]] bool is_of_no_pair(const Transaction& record) const {
    const std::vector<float> distance = numbers_in(field_of(record, "T"));
    const auto index = number_of(record, "index");
    for (const auto& [secondary, words] : f_.difference.secondaries) {
      if (secondary != index || distance.empty()) continue;
      const float t = FloatWords(pipe_.format).decode(expected(words).t);
      return differing_word(std::span(&t, 1), distance).has_value();
    }
    return false;
  }
  [[nodiscard]] bool many_records() const {
    return std::count_if(waves_.all.begin(), waves_.all.end(), [this](const Transaction& t) {
             return t.kind == "record" && number_of(t, "primary") == f_.place;
           }) > 1;
  }

  [[nodiscard]] PairResult expected(std::span<const float> secondary) const {
    const PairWords pair = pair_words(pipe_.format, f_.difference.primary, secondary, f_.swap);
    std::vector<PairResult> result(1);
    reference::test_pairs(pipe_.pair, pipe_.algorithm, pipe_.format, pair.a, pair.b, result,
                          pipe_.plane, iterations_, pipe_.box);
    return result[0];
  }
  [[nodiscard]] std::uint64_t row() const { return f_.place / pipe_.lanes; }
  [[nodiscard]] std::uint64_t lane() const { return f_.place % pipe_.lanes; }

  const CardFailure& f_;
  const PairConfig& pipe_;
  const PairIterations& iterations_;
  Waves waves_;
  std::optional<Stage> wrong_;
};

Waves transactions_of(const fs::path& file, bool whole) {
  wave::Trace trace(file);
  return {wave::transactions(trace, {"primary", "secondary", "test", "record"}, trace.start(),
                             trace.end()),
          whole};
}

/// Windows to trace in turn. A short pass is traced whole. For a long pass, the first windows show
/// the fetch of the secondary that the pipe answers wrong, or else of the reference's and the
/// card's secondary. The last window shows the writing of records after the brute-force pass.
std::vector<TraceOptions> windows_of(const CardFailure& f, std::optional<std::uint32_t> wrong) {
  if (f.cycles <= kWhole) return {{.to = 3 * kWhole}};
  std::vector<TraceOptions> windows;
  const auto add = [&](std::uint32_t index) {
    if (index == ~0u) return;
    for (const TraceOptions& w : windows)
      if (w.secondary == index) return;
    windows.push_back({.secondary = index, .cycles = kWindow});
  };
  if (wrong) add(*wrong);
  if (f.difference.reference) add(f.difference.reference->index);
  if (f.difference.card) add(f.difference.card->index);
  windows.push_back({.from = f.cycles, .to = f.cycles + kEnd});
  return windows;
}

/// Explains the pairs of the records until one is wrong, and returns that secondary, if any.
std::optional<std::uint32_t> explained(Bundle& bundle, const CardFailure& f, const PairOptions& o,
                                       const PairConfig& pipe) {
  std::optional<explain::Explanation> kept;
  std::string words;
  std::optional<std::uint32_t> wrong;
  for (const auto& [index, secondary] : f.difference.secondaries) {
    const PairWords pair = pair_words(pipe.format, f.difference.primary, secondary, f.swap);
    explain::Explanation e = explain::explain(pipe, pair.a, pair.b, iterations_of(o));
    if (kept && e.same()) continue;
    words = pair.text();
    kept = std::move(e);
    if (kept->same()) continue;
    wrong = index;
    break;
  }
  if (kept) (void)bundle_explanation(bundle, *kept, words_of(o, pipe, false), words);
  return wrong;
}

Json hexfloats(std::span<const float> words) {
  Json all = Json::array();
  for (const float w : words) all.push_back(fmt::format("{:a}", w));
  return all;
}

/// Runs the pass again and follows the primary. Leaves the waves that show the error in `file`.
std::optional<Stage> followed(Bundle& bundle, const Failure& failure, const CardFailure& f,
                              const PairIterations& iterations, std::optional<std::uint32_t> wrong,
                              const fs::path& file, std::string& text) {
  bool same = true;
  std::optional<Stage> stage;
  for (const TraceOptions& which : windows_of(f, wrong)) {
    same = failure.rerun(file.string(), which) && same;
    stage = Tracker(f, f.pipe, iterations, transactions_of(file, f.cycles <= kWhole)).follow(text);
    if (stage) break;
  }
  bundle.json()["happened_again"] = same;
  if (!same)
    bundle.add("Not repeated",
               "A card with waves gives another record: the waves do not show the error.\n");
  return stage;
}

}  // namespace

void bundle_card(Bundle& bundle, const Failure& failure) {
  const auto& f = std::get<CardFailure>(failure.kind);
  const PairOptions o = options_of({f.pipe, f.iterations});
  const PairIterations iterations = iterations_of(o);
  bundle.add("What failed", failure.message);
  bundle.json().update(
      {{"failure", "mismatch"},
       {"repeat_command", failure.repeat},
       {"pair", o.pair},
       {"primary_number", f.difference.number()},
       {"lane", f.place % f.pipe.lanes},
       {"row", f.place / f.pipe.lanes},
       {"a_words", f.difference.primary.empty() ? Json() : hexfloats(f.difference.primary)},
       {"card_answer", record_json(f.difference.card)},
       {"reference_answer", record_json(f.difference.reference)}});
  const std::optional<std::uint32_t> wrong =
      f.difference.primary.empty() ? std::nullopt : explained(bundle, f, o, f.pipe);
  const NamelessFile whole = bundle.whole_waves();
  const std::string whole_file = whole.by_name();
  std::string text;
  const std::optional<Stage> stage =
      followed(bundle, failure, f, iterations, wrong, whole_file, text);
  if (text.empty()) text = "The waves do not contain this primary.\n";
  if (stage) {
    text += fmt::format("\nThe first error is {}.\n", stage->name);
    bundle.json()["stage"] = stage->name;
  }
  bundle.add("On the card", text);
  WaveWindow window{.before = kAhead, .behind = 60};
  std::optional<wave::Origin> made;
  if (stage && !stage->signal.empty()) {
    window.shown = {stage->signal};
    window.first = {stage->signal};
    made = origin_at(whole_file, stage->signal, stage->time);
  }
  {
    wave::Trace trace(whole_file);
    window.fail = stage ? stage->time : trace.start() + (trace.end() - trace.start()) / 2;
    // The waves also include a word that was made long before.
    wave::Times times(trace, "");
    if (made && made->time < window.fail && times.clock_if_any() != nullptr)
      window.before += *times.cycle(window.fail) - times.cycle(made->time).value_or(0);
  }
  cut_waves(bundle, whole_file, window);
  if (made) bundle_causes(bundle, stage->signal, *made);
}

}  // namespace cde
