// SPDX-License-Identifier: Apache-2.0
#include "cde/explain/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "cde/check/random_pairs.hpp"
#include "cde/model/cache_entry.hpp"
#include "cde/model/model.hpp"
#include "cde/netlist/cache_name.hpp"
#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"

namespace cde::explain {
namespace {

// Pairs before and after the explained one. Seats are learnt from them. They also show operands of
// another row: without neighbours the inputs would stay at the port. Their sum is below the slots
// of an iterative pipeline, so that one enters per cycle.
constexpr std::size_t kBefore = 32, kBehind = 16;
constexpr std::uint64_t kSeed = 20261123;

/// A pipe of one lane whose operators report their work.
PairConfig tapped(PairConfig config) {
  config.lanes = 1;
  config.tap = true;
  return config;
}

/// Words of random pairs in the format, with the explained pair in the middle.
struct Rows {
  std::vector<std::uint64_t> a, b;
};
Rows rows_around(const PairConfig& config, std::span<const std::uint64_t> a,
                 std::span<const std::uint64_t> b) {
  RandomPairs random(kSeed);
  Rows rows;
  const auto add = [&] {
    std::vector<float> fa, fb;
    random.pair(config.pair, fa, fb);
    const auto word = [&config](float x) { return config.format.encode(x); };
    std::transform(fa.begin(), fa.end(), std::back_inserter(rows.a), word);
    std::transform(fb.begin(), fb.end(), std::back_inserter(rows.b), word);
  };
  for (std::size_t i = 0; i < kBefore; ++i) add();
  rows.a.insert(rows.a.end(), a.begin(), a.end());
  rows.b.insert(rows.b.end(), b.begin(), b.end());
  for (std::size_t i = 0; i < kBehind; ++i) add();
  return rows;
}

/// The RTL, elaborated for the configuration.
netlist::Elaboration design_of(const PairConfig& config) {
  PairConfig plain = config;
  plain.tap = plain.trace = false;
  const std::filesystem::path rtl = model_builder().parent_path().parent_path() / "rtl";
  try {
    return {rtl, "pair_unit", plain.parameters()};
  } catch (const netlist::ElaborationError& e) {
    throw Error(ErrorCode::kBuild, e.what());
  }
}

/// Lines of an operator, from inside the pipe on. The operator's own cell in a dataflow line
/// (df_operator.sv, fp_add.sv, ...) is left out.
Source source_of(const netlist::Elaboration& design, std::string path) {
  const std::size_t top = path.find("pair_unit.", 1);  // Verilator's own name comes first
  path.erase(0, top == std::string::npos ? 0 : top);
  path.resize(path.size() - std::string_view(".tap").size());
  Source source{design.places(path)};
  std::erase_if(source.places, [](const netlist::Place& p) {
    return p.file == "pair_unit.sv" || p.file == "scaled_pipe.sv" || p.file == "bounded_pipe.sv" ||
           p.file == "pair_pipe.sv" ||
           (p.module == "fp_lanes" && (p.instance == "cell_u" || p.instance == "lanes"));
  });
  return source;
}

using Json = nlohmann::ordered_json;

Json to_json(const Source& source) {
  Json list = Json::array();
  for (const netlist::Place& p : source.places)
    list.push_back({p.instance, p.module, p.file, p.line});
  return list;
}
Source from_json(const Json& list) {
  Source source;
  for (const Json& p : list)
    source.places.push_back({p.at(0).get<std::string>(), p.at(1).get<std::string>(),
                             p.at(2).get<std::string>(), p.at(3).get<unsigned>()});
  return source;
}

/// Lines of the card's operators. They come from the cache if the RTL was elaborated before, which
/// takes seconds.
std::vector<Source> sources_of(const PairConfig& config,
                               const std::vector<PairOperator>& operators) {
  const auto name = netlist::cache_name("pair_unit", config.parameters(), ".places.json");
  std::vector<Source> sources;
  if (const auto text = name ? read_cache_entry(*name) : std::nullopt) {
    const Json kept = parse_json(*text);
    try {
      for (const Json& list : kept) sources.push_back(from_json(list));
    } catch (const Json::exception&) {
      sources.clear();
    }
    if (sources.size() == operators.size()) return sources;
    sources.clear();
  }
  const netlist::Elaboration design = design_of(config);
  Json kept = Json::array();
  for (const PairOperator& o : operators) {
    sources.push_back(source_of(design, o.path));
    kept.push_back(to_json(sources.back()));
  }
  if (name) write_cache_entry(*name, kept.dump());
  return sources;
}

/// Removes operators of the operand check, if other candidates remain. They see the reference's
/// operands but do none of its operations.
void leave_out_checks(std::vector<std::int32_t>& operators, const std::vector<Source>& sources) {
  const auto checks = [&sources](std::int32_t which) {
    const auto& places = sources[static_cast<std::size_t>(which)].places;
    return !places.empty() && places.front().file == "shape_check.sv";
  };
  if (!std::all_of(operators.begin(), operators.end(), checks)) std::erase_if(operators, checks);
}

/// Orders findings, most informative first. If the answers agree, drops operations that were not
/// found and all findings of an iterative pipeline. Otherwise drops operations for which no
/// operator of the card remains, if other findings exist. For example, the box rule of host
/// arithmetic has no operators.
void rank(Explanation& e) {
  const auto missing = [](const Finding& f) {
    return f.compared.comparison == Comparison::kMissing;
  };
  const auto nowhere = [](const Finding& f) { return f.sources.empty(); };
  if (e.same()) {
    const bool iterative = has_iterations(e.config.pair);
    std::erase_if(e.findings, [&](const Finding& f) { return iterative || missing(f); });
    return;
  }
  std::stable_partition(e.findings.begin(), e.findings.end(),
                        [&](const Finding& f) { return !missing(f); });
  if (!std::all_of(e.findings.begin(), e.findings.end(), nowhere))
    std::erase_if(e.findings, nowhere);
}

}  // namespace

std::string Source::name() const {
  std::string all;
  for (const netlist::Place& p : places)
    if (p.instance != "cell_u") all += fmt::format("{}{}", all.empty() ? "" : ".", p.instance);
  if (all.ends_with(".op")) all.resize(all.size() - 3);
  return all;
}

std::string Source::line() const {
  std::string line = "?";
  for (const netlist::Place& p : places) {
    if (p.file.starts_with("df_") || p.file.starts_with("vec_")) break;
    line = fmt::format("{}:{}", p.file, p.line);
  }
  return line;
}

std::string Source::text() const {
  std::string all;
  for (const netlist::Place& p : places)
    all += fmt::format("{}{}:{} {}", all.empty() ? "" : ", ", p.file, p.line, p.instance);
  return all;
}

Explainer::Explainer(const PairConfig& asked, const PairIterations& iterations)
    : iterations_(iterations), unit_(tapped(asked)) {
  if (has_iterations(asked.pair)) unit_.set_iterations(iterations);
}

Explanation Explainer::explain(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b) {
  Explanation e;
  e.config = unit_.config();
  const Pair pair = e.config.pair;
  const Rows rows = rows_around(e.config, a, b);
  const Observed card = observe(unit_, rows.a, rows.b);
  const std::size_t count = card.results.size();
  recordings_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i != kBefore && !recordings_[i].steps.empty())
      continue;  // the other recordings are unchanged
    const std::size_t aw = primary_words(pair), bw = secondary_words(pair);
    recordings_[i] = record(e.config, std::span(rows.a).subspan(i * aw, aw),
                            std::span(rows.b).subspan(i * bw, bw), iterations_);
  }
  // The reference is straight-line code, or depends on the iterations alone.
  std::vector<std::size_t> learnt;
  for (std::size_t i = 0; i < count; ++i)
    if (i != kBefore && !recordings_[i].result.bad &&
        recordings_[i].operators.size() == recordings_[kBefore].operators.size())
      learnt.push_back(i);
  e.recording = recordings_[kBefore];
  e.card = card.results[kBefore];
  e.reference = e.recording.result;
  e.operators = card.operators;
  if (e.reference.bad || learnt.empty()) return e;
  if (seats_.size() != e.recording.operators.size()) seats_ = learn(card, recordings_, learnt);
  e.operations = compare(card, recordings_, kBefore, seats_, learnt, has_iterations(pair));
  if (sources_.empty()) sources_ = sources_of(e.config, card.operators);
  e.sources = sources_;
  const auto source = [&](std::int32_t which) {
    return e.sources[static_cast<std::size_t>(which)];
  };
  for (Compared& c : e.operations) {
    leave_out_checks(c.others, e.sources);
    e.found += c.seat.which >= 0 ? 1 : 0;
    if (!c.first) continue;
    Finding finding{c, {}};
    if (c.seat.which >= 0) finding.sources.push_back(source(c.seat.which));
    for (const std::int32_t other : c.others) finding.sources.push_back(source(other));
    e.findings.push_back(std::move(finding));
  }
  rank(e);
  return e;
}

Explanation explain(const PairConfig& config, std::span<const std::uint64_t> a,
                    std::span<const std::uint64_t> b, const PairIterations& iterations) {
  return Explainer(config, iterations).explain(a, b);
}

}  // namespace cde::explain
