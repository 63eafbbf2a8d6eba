// SPDX-License-Identifier: Apache-2.0
#include "record_story.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <filesystem>
#include <map>

#include "cde/contract/records.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/model/model.hpp"
#include "cde/reference/pass.hpp"
#include "cde/scene/packet_again.hpp"
#include "cde/scene/scene_runner.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/scratch.hpp"
#include "cde/wave/candidates.hpp"
#include "cde/wave/trace.hpp"
#include "options/values.hpp"
#include "output/run_folder.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Side = StoryPair::Side;

bool one_per_pair(Mode mode) {
  return mode == Mode::kAll || mode == Mode::kHits;
}

/// The scene of a record name, given directly or by the folder of a run.
struct Named {
  std::string scene;
  std::uint32_t first = 0;  ///< first frame of the run, or the record's frame
  bool failed = false;      ///< the run found differing records of the query in this frame
};

Named scene_named(const RecordName& name) {
  Named found{name.run, name.frame};
  if (!fs::is_directory(name.run)) return found;
  const auto run = RunFolder::run_in(name.run);
  const auto no_run = [&](const std::string& why) {
    throw Error(ErrorCode::kUsage, fmt::format("{}: {}", printable_name(name.run), why));
  };
  if (run.is_null()) no_run("the folder has no run.json of a run");
  try {
    found.scene = run.at("scene");
    const std::uint32_t first = run.at("frames").at(0);
    for (const auto& frame : run.at("frame_results"))
      for (const auto& q : frame.at("queries"))
        found.failed = found.failed || (frame.at("frame") == name.frame &&
                                        q.at("query") == name.query && q.at("mismatches") != 0);
    if (found.failed) found.first = std::min(first, name.frame);
  } catch (const nlohmann::json::exception&) {
    no_run("its run.json is from another version");
  }
  return found;
}

class Teller {
 public:
  Teller(const RecordName& name, bool exact, bool quiet) : name_(name), quiet_(quiet) {
    named_ = scene_named(name);
    s_.scene = read_scene(named_.scene, quiet, named_.scene != name.run);
    s_.scene.card.trace = true;
    find_record();
    plan_ = plan(s_.scene);
    s_.brute_force_instead = plan_.queries.at(s_.query).bvh;
    if (s_.brute_force_instead) {
      s_.scene.card.bvh = UseBvh::kOff;
      plan_ = plan(s_.scene);
    }
    if (!exact) use_built_card(s_.scene, plan_);
    s_.board = plan_.board;
    s_.stands_in_for = plan_.stands_in_for;
    check_number();
  }

  RecordStory tell() {
    const Scratch scratch("cde-record");
    const std::string waves = scratch / "waves.fst";
    (void)model_path(plan_.board.top(), plan_.board.parameters());  // prints its own progress
    const Progress busy("simulating the packet", quiet_);
    const QueryFrame alone = run_frames(name_.frame, waves);
    // State from earlier frames may cause the error.
    if (named_.failed && alone.mismatches == 0 && named_.first < name_.frame)
      (void)run_frames(named_.first, waves);
    if (s_.of_pairs())
      match_records();
    else
      match_arrivals(waves);
    for (const auto& [secondary, side] : by_secondary_)
      if (side.candidate && is_seen(side))
        s_.missing.push_back({.secondary = secondary, .card = {}, .reference = side});
    return std::move(s_);
  }

 private:
  void find_record() {
    std::vector<std::string> names;
    for (const SceneQuery& q : s_.scene.queries) names.push_back(q.name);
    check_known(name_.query, names, "query");
    s_.query = static_cast<std::size_t>(std::find(names.begin(), names.end(), name_.query) -
                                        names.begin());
    if (name_.frame >= s_.scene.frames)
      throw Error(ErrorCode::kUsage,
                  fmt::format("frame {}: {} has 0..{}", name_.frame, printable_name(named_.scene),
                              s_.scene.frames - 1));
    s_.frame = name_.frame;
    s_.primary = name_.primary;
  }
  void check_number() const {
    const QueryWork& work = plan_.queries.at(s_.query);
    if (name_.primary >= work.primaries)
      throw Error(ErrorCode::kUsage, fmt::format("primary {}: query '{}' has 0..{}", name_.primary,
                                                 name_.query, work.primaries - 1));
    if (contains(s_.asked().mask, name_.primary))
      throw Error(ErrorCode::kUsage,
                  fmt::format("primary {} is masked in query '{}' and has no record", name_.primary,
                              name_.query));
  }

  /// Plays the frames from `first` to the record's frame, and takes the reference's data of the
  /// primary.
  QueryFrame run_frames(std::uint32_t first, const std::string& waves) {
    fs::remove(waves);
    s_.first_frame = first;
    s_.card.clear();
    RunnerOptions options;
    options.check = named_.failed ? Check::kAll : Check::kNone;
    options.on_packet = [&](const RunnerOptions::PacketContents& made) { take(made); };
    const TraceOptions which = {.scopes = wave::tested_scopes()};
    return run_packet({s_.scene, plan_, options, s_.frame, s_.query, s_.primary}, first, waves,
                      which, [&](std::span<const Record> records) {
                        for (const Record& r : records)
                          if (r.primary == s_.primary) s_.card.push_back(r);
                      });
  }

  /// Takes the reference's side.
  void take(const RunnerOptions::PacketContents& made) {
    const SceneQuery& q = s_.asked();
    s_.words = numbers_of(made.primaries, s_.primary);
    s_.secondaries = made.secondaries;
    s_.chosen_by_host = made.counts != nullptr;
    const reference::PassQuery asked = {.pair = q.pair,
                                        .algorithm = s_.scene.card.algorithm,
                                        .box = s_.board.box_rule(q.pair),
                                        .swap = q.swap,
                                        .mode = q.mode,
                                        .normals = q.normals,
                                        .iterations = q.iterations,
                                        .format = s_.board.format,
                                        .counts = made.counts};
    auto tested = reference::brute_force(asked, made.primaries, s_.primary, made.secondaries);
    s_.reference = std::move(tested.records);
    s_.pairs_in_reference = tested.pairs.size();
    s_.candidates = 0;
    by_secondary_.clear();
    order_.clear();
    for (const reference::BruteForcePair& p : tested.pairs) {
      const Record& r = p.record;
      const bool negative = !s_.of_pairs() && is_solid(q.pair) && r.f;
      by_secondary_[p.secondary] = {.f = r.f,
                                    .bad = r.bad,
                                    .candidate = p.candidate,
                                    .kept = p.kept,
                                    .t = negative ? -r.t : r.t};
      order_.push_back(p.secondary);
      s_.candidates += p.candidate ? 1 : 0;
    }
  }

  void arrived(StoryPair pair) {
    const auto known = by_secondary_.find(pair.secondary);
    if (known != by_secondary_.end()) {
      pair.reference = known->second;
      by_secondary_.erase(known);
    }
    s_.arrived.push_back(pair);
  }

  /// Matches records of pairs, in stream order. Records of misses do not name their secondary; mode
  /// all has a record for every pair, so their place tells it.
  void match_records() {
    for (std::size_t i = 0; i < s_.card.size(); ++i) {
      const Record& r = s_.card[i];
      const bool in_order = s_.asked().mode == Mode::kAll && i < order_.size();
      arrived({.secondary = in_order ? order_[i] : r.index,
               .card = Side{.f = r.f, .bad = r.bad, .candidate = true, .t = r.t},
               .reference = {}});
    }
  }

  void match_arrivals(const std::string& waves) {
    wave::Trace trace(waves);
    wave::each_tested(trace, s_.primary % card::kMostPrimaries, [&](const wave::Tested& t) {
      const auto number = FloatWords(s_.board.format).decode;
      s_.passes = t.pass + 1;
      arrived({.secondary = static_cast<std::uint32_t>(t.index),
               .card = Side{.f = t.f,
                            .bad = t.bad,
                            .candidate = t.candidate,
                            .kept = t.kept,
                            .t = number(t.t)},
               .reference = {},
               .pass = t.pass,
               .cycle = t.cycle,
               .held = number(t.held)});
    });
  }

  /// Whether the waves must show the card's test of a pair. Mode any stops at the first hit. Passes
  /// with a record per pair, among which the host chooses, do not show it.
  [[nodiscard]] bool is_seen(const Side& side) const {
    if (s_.of_pairs()) return true;
    if (s_.chosen_by_host) return false;
    return s_.asked().mode != Mode::kAny || side.kept;
  }

  const RecordName& name_;
  bool quiet_;
  Named named_;
  Plan plan_;
  RecordStory s_;
  std::map<std::uint32_t, Side> by_secondary_;  ///< reference pairs not seen on the card yet
  std::vector<std::uint32_t> order_;            ///< secondaries in the order of the reference
};

}  // namespace

RecordName record_named(const std::string& text) {
  const auto refuse = [&] {
    throw Error(ErrorCode::kUsage,
                fmt::format("--from-record is {}; it must be RUN:QUERY:FRAME:PRIMARY, where RUN is "
                            "a scene or the folder of a run, and FRAME and PRIMARY are numbers",
                            in_quotes(text)));
  };
  RecordName name;
  std::string rest = text;
  const auto last = [&] {
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string::npos) refuse();
    std::string part = rest.substr(colon + 1);
    rest.resize(colon);
    return part;
  };
  for (std::uint32_t* number : {&name.primary, &name.frame}) {
    const std::string part = last();
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), *number);
    if (part.empty() || error != std::errc() || end != part.data() + part.size()) refuse();
  }
  name.query = last();
  name.run = rest;
  if (name.query.empty() || name.run.empty()) refuse();
  return name;
}

bool operator==(const Side& x, const Side& y) {
  return x.f == y.f && x.bad == y.bad && x.candidate == y.candidate && bits(x.t) == bits(y.t) &&
         x.kept == y.kept;
}

bool RecordStory::of_pairs() const {
  return one_per_pair(asked().mode);
}

bool RecordStory::same() const {
  return std::equal(card.begin(), card.end(), reference.begin(), reference.end(), same_bits);
}

bool RecordStory::same(const StoryPair& pair) const {
  if (!pair.card) return false;
  Side c = *pair.card;
  if (!pair.reference) return !c.candidate;
  Side r = *pair.reference;
  if (!c.candidate && !r.candidate) return true;  // its values do not matter
  // The host chose among the records of several passes.
  if (chosen_by_host) c.kept = r.kept = false;
  return c == r;
}

std::optional<std::uint32_t> RecordStory::winner() const {
  if (of_pairs() || reference.empty() || reference[0].index == ~0u) return std::nullopt;
  return reference[0].index;
}

std::optional<std::uint32_t> RecordStory::telling() const {
  for (const auto* list : {&arrived, &missing})
    for (const StoryPair& p : *list)
      if (!same(p) && p.secondary < size(secondaries)) return p.secondary;
  if (winner()) return winner();
  for (const StoryPair& p : arrived)
    if (p.reference && p.reference->f) return p.secondary;
  return std::nullopt;
}

RecordStory record_story(const RecordName& name, bool exact, bool quiet) {
  return Teller(name, exact, quiet).tell();
}

}  // namespace cde::cli
