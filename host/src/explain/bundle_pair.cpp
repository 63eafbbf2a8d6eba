// SPDX-License-Identifier: Apache-2.0
// Explains a pair whose answer differs between a pipe alone and its reference.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>

#include "cde/explain/bundle.hpp"
#include "cde/fp/number_text.hpp"
#include "cde/support/error.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kRowsAround = 4;

/// Rows to run through the unit again, including the pair.
struct Again {
  std::size_t first = 0, count = 0;  ///< pairs
  TraceOptions window = {};
};

/// The time at which answer `row` is at the outputs; without `row`, the last answer.
std::uint64_t answer_time(const fs::path& file, std::optional<std::uint64_t> row) {
  wave::Trace trace(file);
  const std::uint32_t clock = wave::find_signal(trace, "pair_unit.clk_i").handle,
                      valid = wave::find_signal(trace, "pair_unit.valid_o").handle;
  const std::vector<std::uint32_t> handles = {clock, valid};
  char clock_value = 'x', valid_value = 'x';
  bool edge = false;
  std::uint64_t now = 0, seen = 0, found = trace.end();
  const auto step = [&] {
    if (edge && valid_value == '1' && (!row || seen++ == *row)) found = now;
    edge = false;
  };
  trace.stream(handles, trace.start(), trace.end(),
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) step();
                 now = time;
                 if (handle == clock) {
                   edge = clock_value == '0' && value[0] == '1';
                   clock_value = value[0];
                 }
                 if (handle == valid) valid_value = value[0];
                 return true;
               });
  step();
  return found;
}

/// The pair's part of the output that carries the first differing field.
std::string differing_signal(const PairFailure& f) {
  const std::size_t lane = f.at % f.config.lanes;
  const auto of = [lane](const char* name) { return fmt::format("pair_unit.{}[{}]", name, lane); };
  const auto element = [lane](const char* name, unsigned i) {
    return fmt::format("pair_unit.{}[{}][{}]", name, i, lane);
  };
  if (f.card.bad != f.reference.bad) return of("bad_o");
  if (f.card.f != f.reference.f) return of("f_o");
  if (f.card.t != f.reference.t) return of("t_o");
  for (unsigned i = 0; i < 3; ++i)
    if (f.card.cp[i] != f.reference.cp[i]) return element("cp_o", i);
  for (unsigned i = 0; i < 3; ++i)
    if (f.card.n[i] != f.reference.n[i]) return element("n_o", i);
  return of("t_o");
}

/// Signals of the unit to show first: its handshake and the pair's lane.
std::vector<std::string> shown_signals(const PairFailure& f) {
  const std::size_t lane = f.at % f.config.lanes;
  const std::string form = fmt::format(":{}", f.config.format.name());
  std::vector<std::string> words = {"pair_unit.clk_i", "pair_unit.valid_i", "pair_unit.ready_o"};
  const auto add = [&](const char* name, std::size_t elements) {
    for (std::size_t i = 0; i < elements; ++i)
      words.push_back(fmt::format("pair_unit.{}[{}][{}]{}", name, i, lane, form));
  };
  add("a_i", primary_words(f.config.pair));
  add("b_i", secondary_words(f.config.pair));
  words.emplace_back("pair_unit.valid_o");
  for (const char* name : {"f_o", "bad_o"})
    words.push_back(fmt::format("pair_unit.{}[{}]", name, lane));
  words.push_back(fmt::format("pair_unit.t_o[{}]{}", lane, form));
  add("cp_o", 3);
  add("n_o", 3);
  return words;
}

class Rerun {
 public:
  explicit Rerun(const PairFailure& f)
      : f_(f), aw_(primary_words(f.config.pair)), bw_(secondary_words(f.config.pair)) {}

  /// Whether the pair gives the same answer again. Writes waves to `file`.
  bool run(const Again& again, const fs::path& file) {
    PairConfig config = f_.config;
    config.trace = true;
    PairUnit unit(config);
    if (has_iterations(config.pair)) unit.set_iterations(f_.iterations);
    std::vector<PairResult> results(again.count);
    unit.open_trace(file.string(), again.window);
    cycles = unit.test(std::span(f_.a).subspan(again.first * aw_, again.count * aw_),
                       std::span(f_.b).subspan(again.first * bw_, again.count * bw_), results);
    unit.close_trace();
    latency = unit.latency();
    return results[f_.at - again.first] == f_.card;
  }

  std::uint64_t cycles = 0;
  unsigned latency = 0;

 private:
  const PairFailure& f_;
  std::size_t aw_, bw_;
};

void bundle_waves(Bundle& bundle, const PairFailure& f) {
  const NamelessFile waves = bundle.whole_waves();
  const std::string whole = waves.by_name();
  const std::size_t lanes = f.config.lanes, row = f.at / lanes,
                    pairs = f.a.size() / primary_words(f.config.pair);
  const std::size_t first = row > kRowsAround ? row - kRowsAround : 0;
  Rerun rerun(f);
  Again some{first * lanes, std::min(pairs, (row + kRowsAround + 1) * lanes) - first * lanes};
  bool same = rerun.run(some, whole);
  std::optional<std::uint64_t> answer = row - first;
  if (!same && first > 0) {
    // Earlier rows matter: runs all of them again, with waves of the end only.
    const Again all{0, std::min(pairs, (row + 1) * lanes)};
    Again last = all;
    last.window = {.from = 0, .to = 0};
    (void)rerun.run(last, whole);
    last.window.from = rerun.cycles > rerun.latency + 40 ? rerun.cycles - rerun.latency - 40 : 0;
    last.window.to = rerun.cycles + 40;
    same = rerun.run(last, whole);
    answer.reset();
  }
  bundle.json()["happened_again"] = same;
  WaveWindow window{.before = rerun.latency + 10, .behind = 4};
  window.fail = answer_time(whole, answer);
  window.shown = shown_signals(f);
  window.first = {"pair_unit.clk_i", "pair_unit.valid_o", differing_signal(f)};
  cut_waves(bundle, whole, window);
  if (!same)
    bundle.add(
        "Not repeated",
        "A unit with waves answers the same pairs differently: the waves do not show the error.\n");
}

}  // namespace

void bundle_pair(Bundle& bundle, const Failure& failure) {
  const auto& f = std::get<PairFailure>(failure.kind);
  const WordText text(f.config.format);
  const std::size_t aw = primary_words(f.config.pair), bw = secondary_words(f.config.pair);
  const auto a = std::span(f.a).subspan(f.at * aw, aw), b = std::span(f.b).subspan(f.at * bw, bw);
  std::string words;
  Json ja = Json::array(), jb = Json::array();
  for (const std::uint64_t w : a) ja.push_back(text.hexfloat(w));
  for (const std::uint64_t w : b) jb.push_back(text.hexfloat(w));
  const auto add = [&words](const Json& list) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (i != 0) words += ',';
      words += list[i].get<std::string>();
    }
  };
  add(ja);
  words += " | ";
  add(jb);
  bundle.add("What failed", failure.message);
  bundle.json().update({{"failure", "mismatch"},
                        {"repeat_command", failure.repeat},
                        {"pair", name(f.config.pair)},
                        {"parameters", f.config.parameters()},
                        {"lane", f.at % f.config.lanes},
                        {"row", f.at / f.config.lanes},
                        {"a_words", ja},
                        {"b_words", jb},
                        {"card_answer", result_json(f.config.format, f.card)},
                        {"reference_answer", result_json(f.config.format, f.reference)},
                        {"differ_in", differing_fields(f.card, f.reference)}});
  bundle_waves(bundle, f);
  const explain::Explanation e = explain::explain(f.config, a, b, f.iterations);
  (void)bundle_explanation(bundle, e, f.options, words);
  const std::string wrong = differing_signal(f);
  bundle_causes(bundle, wrong,
                origin_at(bundle.file("waves.fst"), wrong,
                          bundle.json()["wave_window"]["fail_time"].get<std::uint64_t>()));
}

}  // namespace cde
