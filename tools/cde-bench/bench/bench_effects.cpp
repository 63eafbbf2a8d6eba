// SPDX-License-Identifier: Apache-2.0
// Section effects of cde bench: measures how much each part of the card slows down its simulation.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <future>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/bench.hpp"
#include "cde/card/board.hpp"
#include "cde/contract/records.hpp"
#include "cde/reference/reference.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;

/// The scene: 256 rays in random directions from above the middle of a terrain, nearest hit. A card
/// with all parts and kLanes lanes takes minutes to build. --quick uses the lanes of a default
/// model.
constexpr unsigned kLanes = 8, kQuickLanes = 16;
constexpr const char* kScene = R"([card]
algorithm = "moller"
lanes = {}
bvh = "off"

[[object]]
name = "terrain"
mesh = "terrain:{},{},1"

[[object]]
name = "rays"
random_rays = {{ count = 256, seed = 7, half_angle = 80 }}
[object.motion]
kind = "still"
position = [500, 500, 500]

[[query]]
name = "hit"
pair = "ray-triangle"
primaries = "rays"
secondaries = "terrain"
)";

/// When a card is measured: always, or not with --quick.
enum class When { kAlways, kNotQuick };

/// The planned card with one change.
struct Variant {
  const char* name;
  const char* effect;  ///< its name in plans, or ""
  void (*change)(BoardConfig& card);
  When when = When::kNotQuick;
  bool beside_last = false;  ///< compared with the variant before it, not with the planned card
  Memory memory = Memory::kIdeal;
};

void all_pipes(BoardConfig& c) {
  c.pairs.clear();
  for (unsigned p = 0; p < kPairs; ++p) c.pairs.push_back(static_cast<Pair>(p));
}

/// Rays and spheres, which can be tested with the same triangles in one pass.
void two_pipes(BoardConfig& c) {
  c.pairs = {Pair::kRayTriangle, Pair::kTriangleSphere};
  c.swap = true;
}

void everything(BoardConfig& c) {
  all_pipes(c);
  c.swap = c.normals = c.ecc = c.trace = true;
  c.transform = Transformer::kBoth;
  c.bus = Bus::kCycle;
}

constexpr const char* kEverything = "everything, no waves written";
constexpr Variant kPlanned = {"planned", "", [](BoardConfig&) {}};
constexpr Variant kVariants[] = {
    {"pipe alone", "",
     [](BoardConfig& c) { c = BoardConfig{.lanes = c.lanes, .box = c.box, .latency = c.latency}; },
     When::kAlways},
    {"no box rule", "", [](BoardConfig& c) { c.box = false; }},
    {"box rule, against no box rule", "box rule", [](BoardConfig&) {}, When::kNotQuick, true},
    {"all pipes", "pipes", all_pipes},
    {"two pipes and exchange of roles", "", two_pipes},
    {"two pipes, both at a time, against one", "two pairs at a time",
     [](BoardConfig& c) {
       two_pipes(c);
       c.parallel = true;
     },
     When::kNotQuick, true},
    {"transformer", "transformer", [](BoardConfig& c) { c.transform = Transformer::kBoth; }},
    {"normals", "normals", [](BoardConfig& c) { c.normals = true; }},
    {"exchange of roles (SWAP)", "exchange of roles", [](BoardConfig& c) { c.swap = true; }},
    {"check bits", "ecc", [](BoardConfig& c) { c.ecc = true; }},
    {"bus cycle by cycle", "bus timing", [](BoardConfig& c) { c.bus = Bus::kCycle; }},
    {"memory cycle by cycle", "memory timing", [](BoardConfig&) {}, When::kNotQuick, false,
     Memory::kCycle},
    {"waves compiled in, none written", "trace", [](BoardConfig& c) { c.trace = true; }},
    {"gates", "gates", [](BoardConfig& c) { c.arithmetic = Arithmetic::kRtl; }, When::kAlways},
    {kEverything, "", everything},
};

struct Workload {
  BoardConfig planned;
  std::vector<Ray> rays;
  std::vector<Triangle> triangles;
  std::vector<Record> records;  ///< records of the reference
};

template <class P>
std::vector<P> placed(const Scene& scene, std::size_t object) {
  const SceneObject& o = scene.objects.at(object);
  return std::get<std::vector<P>>(posed(local_shapes(scene, o, 0), pose(scene, o, 0)));
}

Workload make_workload(const BenchOptions& o) {
  const unsigned side = o.quick ? 25 : 100;
  Scene scene = parse_scene(
      fmt::format(fmt::runtime(kScene), o.quick ? kQuickLanes : kLanes, side, side), "effects");
  scene.card.device = o.device;
  Workload w{plan(scene).board, placed<Ray>(scene, 1), placed<Triangle>(scene, 0), {}};
  w.records = reference::cast(w.rays, w.triangles);
  return w;
}

/// Processor time of this thread.
template <class Work>
double timed(Work work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

/// Rounds belong to this many groups in turn. Each group's fastest rounds give a figure, and the
/// groups' figures differ by as much as the figures of repeated runs.
constexpr std::size_t kGroups = 3;

/// A figure from the fastest rounds, with the spread of the groups.
struct Figure {
  double value = 0, least = 0, most = 0;
};

double fastest(const std::vector<double>& seconds, std::size_t first = 0, std::size_t step = 1) {
  double least = seconds.at(first);
  for (std::size_t i = first; i < seconds.size(); i += step) least = std::min(least, seconds[i]);
  return least;
}

/// The ratio of the fastest times of two works that were measured in the same rounds.
Figure ratio(const std::vector<double>& above, const std::vector<double>& below) {
  const double value = fastest(above) / fastest(below);
  Figure f{value, value, value};
  for (std::size_t group = 0; group < kGroups; ++group) {
    const double of_group = fastest(above, group, kGroups) / fastest(below, group, kGroups);
    f.least = std::min(f.least, of_group);
    f.most = std::max(f.most, of_group);
  }
  return f;
}

/// A card with the triangles uploaded, and its measurements.
class Card {
 public:
  Card(const Variant& variant, const BoardConfig& config, const Workload& w)
      : variant_(variant),
        config_(config),
        workload_(w),
        board_(Board::open(config, {.memory = variant.memory})) {
    board_.upload(w.triangles);
  }

  /// Runs a frame of a still scene: rays, registers, pass and records. The records must equal the
  /// reference's.
  double frame() {
    std::vector<Record> records;
    const double t = timed([&] {
      board_.load(workload_.rays);
      records = board_.run({.pair = Pair::kRayTriangle}, &counters_);
    });
    if (!std::equal(records.begin(), records.end(), workload_.records.begin(),
                    workload_.records.end(), same_bits))
      throw Error(ErrorCode::kMismatch,
                  fmt::format("card '{}': its records differ from the reference", variant_.name));
    return t;
  }

  /// Runs only the pass of the last frame again, from go to done.
  double pass() {
    const double t = timed([&] {
      board_.write_register(card::kRegControl, card::kControlGo);
      board_.wait(4 * counters_.cycles + 100'000);
    });
    if ((board_.read_register(card::kRegStatus) >> card::kStatusDone & 1) == 0)
      throw Error(ErrorCode::kDevice,
                  fmt::format("card '{}': the pass did not end", variant_.name));
    const std::uint64_t words = card::kRecordWords * board_.read_register(card::kRegRecords);
    std::vector<std::uint64_t> beats((words + 1) / 2);
    board_.bus_read(card::kSpaceSram, 0, beats);
    board_.write_register(card::kRegControl, card::kControlClear);
    return t;
  }

  /// Measures one round: a frame, then its pass alone.
  void measure() {
    frames_.push_back(frame());
    passes_.push_back(pass());
  }

  [[nodiscard]] const Variant& variant() const { return variant_; }
  /// Time of a frame over another card's.
  [[nodiscard]] Figure slower_than(const Card& other) const {
    return ratio(frames_, other.frames_);
  }
  /// Time of a frame over the time of its pass.
  [[nodiscard]] Figure frame_over_pass() const { return ratio(frames_, passes_); }
  /// Cycles of a frame outside the pass, relative to the cycles of the pass.
  [[nodiscard]] double bus_cycles() const {
    const auto pass = static_cast<double>(counters_.cycles + counters_.writeback);
    return static_cast<double>(counters_.total_cycles) / pass - 1;
  }

  void print_markdown(const Figure& slower) const {
    print_figure("| {} | {:.2f} | {:.2f} to {:.2f} | {} |\n", variant_.name, slower.value,
                 slower.least, slower.most, counters_.cycles);
  }

  void print(const Figure& slower) const {
    const std::optional<double> known = simulation_cost(variant_.effect);
    print_figure("{:<42}{:>7.3f}{:>15}{:>10.4f}{:>10.2f}{:>11}{:>10}\n", variant_.name,
                 slower.value, fmt::format("{:.2f} to {:.2f}", slower.least, slower.most),
                 fastest(frames_), 100 * (frame_over_pass().value - 1), counters_.cycles,
                 known ? fmt::format("{:.1f}", *known) : "-");
  }

  [[nodiscard]] ordered_json json(const Figure& slower, const Device& device) const {
    const std::optional<double> known = simulation_cost(variant_.effect);
    return {{"name", variant_.name},
            {"effect", *variant_.effect != '\0' ? ordered_json(variant_.effect) : ordered_json()},
            {"slower_in_plans", known ? ordered_json(*known) : ordered_json()},
            {"top", config_.top()},
            {"parameters", config_.parameters()},
            {"slower", slower.value},
            {"slower_least", slower.least},
            {"slower_most", slower.most},
            {"frame_seconds", fastest(frames_)},
            {"frame_over_pass", frame_over_pass().value - 1},
            {"frame_over_pass_cycles", bus_cycles()},
            {"device_cycles", counters_.cycles},
            {"modelled_pass_seconds", counters_.modelled_seconds(device.clock_hz())}};
  }

 private:
  const Variant& variant_;
  BoardConfig config_;
  const Workload& workload_;
  Board board_;
  Counters counters_;
  std::vector<double> frames_, passes_;  ///< one value per round
};

struct Planned {
  const Variant& variant;
  BoardConfig config;
};

std::vector<Planned> cards_of(const BenchOptions& o, const Workload& w) {
  std::vector<Planned> cards = {{kPlanned, w.planned}};
  for (const Variant& v : kVariants) {
    if (v.when == When::kNotQuick && o.quick) continue;
    cards.push_back({v, w.planned});
    v.change(cards.back().config);
  }
  return cards;
}

/// Builds the missing models, two at a time. The last card takes longest, so it comes first.
void build_missing(const std::vector<Planned>& cards) {
  std::set<std::pair<std::string, std::vector<std::string>>> known;
  std::vector<const BoardConfig*> missing;
  for (std::size_t i = cards.size(); i-- > 0;) {
    const BoardConfig& c = cards[i].config;
    if (known.emplace(c.top(), c.parameters()).second && !model_file(c.top(), c.parameters()).built)
      missing.push_back(&c);
  }
  if (missing.empty()) return;
  Progress progress(fmt::format("building {}, two at a time", counted(missing.size(), "card")));
  const bool told = report_builds(false);
  std::atomic<std::size_t> next = 0;
  const auto build = [&] {
    for (std::size_t i = next++; i < missing.size(); i = next++) {
      try {
        (void)model_path(missing[i]->top(), missing[i]->parameters());
      } catch (...) {
        next = missing.size();
        throw;
      }
    }
  };
  std::future<void> other = std::async(std::launch::async, build);
  build();
  other.get();
  report_builds(told);
}

/// Measures all cards in rounds: each card once per round, in the same order.
std::vector<Card> measured_cards(const std::vector<Planned>& planned, const Workload& w,
                                 unsigned rounds) {
  std::vector<Card> cards;
  cards.reserve(planned.size());
  for (const Planned& p : planned) cards.emplace_back(p.variant, p.config, w);
  Progress progress("effects, each card in turn");
  for (Card& c : cards) c.frame(), c.pass();  // warms the caches
  for (std::size_t i = 0; i < rounds * cards.size(); ++i) {
    progress(static_cast<double>(i) / static_cast<double>(rounds * cards.size()));
    cards[i % cards.size()].measure();
  }
  return cards;
}

/// Whether a figure and its whole spread meet a target. Null: the target is within the spread.
ordered_json verdict(const Figure& f, double least, double most) {
  const auto meets = [&](double x) { return least <= x && x <= most; };
  if (meets(f.least) != meets(f.most)) return nullptr;
  return meets(f.value);
}

/// The promises of the project, with the measurements.
ordered_json promises(const std::vector<Card>& cards) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  ordered_json list = ordered_json::array();
  const auto promise = [&](const char* what, const char* target, const Figure& f,
                           const ordered_json& met) {
    print_figure("{:<62} {:>6.3f} ({:.3f} to {:.3f})  {}: {}\n", what, f.value, f.least, f.most,
                 target,
                 met.is_null()     ? "not decided, within the spread"
                 : met.get<bool>() ? "met"
                                   : "NOT met");
    list.push_back({{"what", what},
                    {"target", target},
                    {"figure", f.value},
                    {"figure_least", f.least},
                    {"figure_most", f.most},
                    {"met", met}});
  };
  for (const Card& c : cards) {
    const std::string_view name = c.variant().name;
    if (name == kEverything) {
      const Figure f = c.slower_than(cards.front());
      promise("everything, times the planned card", "at least 5", f, verdict(f, 5, kAny));
    }
    if (name == "pipe alone") {
      const Figure f = cards.front().slower_than(c);
      promise("planned card, times that with the pipe alone", "at most 1.1", f, verdict(f, 0, 1.1));
    }
  }
  const Figure f = cards.front().frame_over_pass();
  promise("frame of the planned card over its pass, by a functional bus", "at most 1.05", f,
          verdict(f, 0, 1.05));
  return list;
}

}  // namespace

ordered_json bench_effects(const BenchOptions& o) {
  const Workload w = make_workload(o);
  const unsigned rounds = o.quick ? kGroups : 4 * kGroups;
  const std::vector<Planned> planned = cards_of(o, w);
  build_missing(planned);
  const std::vector<Card> cards = measured_cards(planned, w, rounds);
  if (o.markdown)
    print_figure("| card | times the planned card | spread | cycles of the pass |\n{}\n",
                 "| --- | --- | --- | --- |");
  else
    print_figure(
        "\n{} x {}, nearest, {}, fp32, one thread. The planned card: {}.\nEach other card is the "
        "planned card with one change. Slower: processor time of a frame over the planned card's, "
        "the fastest of {} each. Spread: the same of each third of the rounds.\n"
        "{:<42}{:>7}{:>15}{:>10}{:>10}{:>11}{:>10}\n",
        counted(w.rays.size(), "ray"), counted(w.triangles.size(), "triangle"),
        counted(w.planned.lanes, "lane"), fmt::join(w.planned.parameters(), " "),
        counted(rounds, "round"), "card", "slower", "spread", "frame, s", "bus, %", "cycles",
        "in plans");
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < cards.size(); ++i) {
    const Figure slower = cards[i].slower_than(cards[cards[i].variant().beside_last ? i - 1 : 0]);
    o.markdown ? cards[i].print_markdown(slower) : cards[i].print(slower);
    list.push_back(cards[i].json(slower, o.device));
  }
  if (o.markdown)
    print_figure("\n");
  else
    print_figure(
        "bus: processor time of a frame outside its pass (rays, registers, records) over the "
        "pass\nall records of all frames equal the reference\n");
  return {{"rays", w.rays.size()},
          {"triangles", w.triangles.size()},
          {"lanes", w.planned.lanes},
          {"format", "fp32"},
          {"bus", "functional, unless the card's top is \"card\"; host profile ideal"},
          {"rounds", rounds},
          {"what", "processor time of a frame over the planned card's, fastest rounds"},
          {"cards", list},
          {"promises", promises(cards)}};
}

}  // namespace cde::cli
