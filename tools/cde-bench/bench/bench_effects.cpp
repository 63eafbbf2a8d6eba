// SPDX-License-Identifier: Apache-2.0
// Section effects of cde bench: measures how much each part of the card slows down its simulation.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
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

void all_but_waves(BoardConfig& c) {
  all_pipes(c);
  c.swap = c.normals = c.ecc = true;
  c.transform = Transformer::kBoth;
  c.bus = Bus::kCycle;
}

constexpr const char* kEverything = "everything and waves, none written";
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
    {"transformer, secondaries", "",
     [](BoardConfig& c) { c.transform = Transformer::kSecondaries; }},
    {"transformer, both", "transformer", [](BoardConfig& c) { c.transform = Transformer::kBoth; }},
    {"normals", "normals", [](BoardConfig& c) { c.normals = true; }},
    {"exchange of roles (SWAP)", "exchange of roles", [](BoardConfig& c) { c.swap = true; }},
    {"check bits", "ecc", [](BoardConfig& c) { c.ecc = true; }},
    {"bus cycle by cycle", "bus timing", [](BoardConfig& c) { c.bus = Bus::kCycle; }},
    {"memory cycle by cycle", "memory timing", [](BoardConfig&) {}, When::kNotQuick, false,
     Memory::kCycle},
    {"waves compiled in, none written", "trace", [](BoardConfig& c) { c.trace = true; }},
    {"gates", "gates", [](BoardConfig& c) { c.arithmetic = Arithmetic::kRtl; }, When::kAlways},
    {"everything but waves, with roles and normals", "", all_but_waves},
    {kEverything, "",
     [](BoardConfig& c) {
       all_but_waves(c);
       c.trace = true;
     }},
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

/// Processor time of this thread and wall time.
struct Times {
  double processor = 0, wall = 0;
};

template <class Work>
Times timed(Work work) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const double processor = thread_seconds();
  work();
  return {thread_seconds() - processor,
          std::chrono::duration<double>(Clock::now() - start).count()};
}

/// A card with the triangles uploaded, and its measurements.
class Card {
 public:
  Card(const Variant& variant, const BoardConfig& config, const Workload& w)
      : variant_(variant), config_(config), workload_(w), board_(open()) {
    board_.upload(w.triangles);
  }

  /// Runs a frame of a still scene: rays, registers, pass and records. The records must equal the
  /// reference's.
  Times frame() {
    std::vector<Record> records;
    const Times t = timed([&] {
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
  Times pass() {
    const Times t = timed([&] {
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

  /// Measures one round: a frame of another card, directly after it a frame of this card, then this
  /// card's pass.
  void measure(Card& other) {
    const Times before = other.frame(), mine = &other == this ? before : frame();
    const Times bare = pass();
    slower_.push_back(mine.processor / before.processor);
    slower_wall_.push_back(mine.wall / before.wall);
    seconds_.push_back(mine.processor);
    wall_.push_back(mine.wall);
    pass_.push_back(bare.processor);
  }

  [[nodiscard]] const Variant& variant() const { return variant_; }
  [[nodiscard]] double slower() const { return median(slower_); }
  /// Time of a frame outside the pass, relative to the pass. It takes the fastest rounds, because
  /// it is smaller than the noise of a single round.
  [[nodiscard]] double bus() const { return least(seconds_) / least(pass_) - 1; }
  /// Cycles of a frame outside the pass, relative to the cycles of the pass.
  [[nodiscard]] double bus_cycles() const {
    const auto pass = static_cast<double>(counters_.cycles + counters_.writeback);
    return static_cast<double>(counters_.total_cycles) / pass - 1;
  }

  void print_markdown() const {
    print_figure("| {} | {:.2f} | {:.2f} to {:.2f} | {} |\n", variant_.name, slower(),
                 least(slower_), most(slower_), counters_.cycles);
  }

  void print() const {
    const std::optional<double> known = simulation_cost(variant_.effect);
    print_figure("{:<44}{:>7.3f}{:>15}{:>9.3f}{:>12.4f}{:>10.2f}{:>11}{:>9}{:>9}\n", variant_.name,
                 slower(), fmt::format("{:.2f} to {:.2f}", least(slower_), most(slower_)),
                 median(slower_wall_), median(wall_), 100 * bus(), counters_.cycles,
                 build_seconds_ ? fmt::format("{:.0f}", *build_seconds_) : "-",
                 known ? fmt::format("{:.1f}", *known) : "-");
  }

  [[nodiscard]] ordered_json json(const Device& device) const {
    const std::optional<double> known = simulation_cost(variant_.effect);
    return {{"name", variant_.name},
            {"effect", *variant_.effect != '\0' ? ordered_json(variant_.effect) : ordered_json()},
            {"slower_in_plans", known ? ordered_json(*known) : ordered_json()},
            {"top", config_.top()},
            {"parameters", config_.parameters()},
            {"slower", slower()},
            {"slower_least", least(slower_)},
            {"slower_most", most(slower_)},
            {"slower_wall", median(slower_wall_)},
            {"frame_seconds", median(seconds_)},
            {"wall_seconds", median(wall_)},
            {"frame_over_pass", bus()},
            {"frame_over_pass_cycles", bus_cycles()},
            {"device_cycles", counters_.cycles},
            {"modelled_pass_seconds", counters_.modelled_seconds(device.clock_hz())},
            {"build_seconds", build_seconds_ ? ordered_json(*build_seconds_) : ordered_json()}};
  }

 private:
  Board open() {
    const std::vector<std::string> parameters = config_.parameters();
    if (!model_file(config_.top(), parameters).built)
      build_seconds_ = timed([&] { (void)model_path(config_.top(), parameters); }).wall;
    return Board::open(config_, {.memory = variant_.memory});
  }
  static double least(const std::vector<double>& v) {
    return *std::min_element(v.begin(), v.end());
  }
  static double most(const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); }
  static double median(std::vector<double> v) {
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
    std::nth_element(v.begin(), middle, v.end());
    return *middle;
  }

  const Variant& variant_;
  BoardConfig config_;
  const Workload& workload_;
  std::optional<double>
      build_seconds_;  ///< if this run built the card; declared before board_, which sets it
  Board board_;
  Counters counters_;
  std::vector<double> slower_, slower_wall_, seconds_, wall_, pass_;  ///< one value per round
};

std::vector<Card> open_cards(const BenchOptions& o, const Workload& w) {
  std::vector<Card> cards;
  cards.emplace_back(kPlanned, w.planned, w);
  for (const Variant& v : kVariants) {
    if (v.when == When::kNotQuick && o.quick) continue;
    BoardConfig config = w.planned;
    v.change(config);
    cards.emplace_back(v, config, w);
  }
  return cards;
}

/// The promises of the project, with the measurements.
ordered_json promises(const std::vector<Card>& cards) {
  ordered_json list = ordered_json::array();
  const auto promise = [&](const char* what, const char* target, double figure, bool met) {
    print_figure("{:<66} {:>8.3f}  {}: {}\n", what, figure, target, met ? "met" : "NOT met");
    list.push_back({{"what", what}, {"target", target}, {"figure", figure}, {"met", met}});
  };
  for (const Card& c : cards) {
    const std::string_view name = c.variant().name;
    if (name == kEverything)
      promise("everything, times the planned card", "at least 5", c.slower(), c.slower() >= 5);
    if (name == "pipe alone")
      promise("planned card, times that with the pipe alone", "within 10 %", 1 / c.slower(),
              1 / c.slower() <= 1.1);
  }
  const double bus = cards.front().bus();
  promise("functional bus of the planned card, share of the pass", "under 0.05", bus, bus < 0.05);
  return list;
}

}  // namespace

ordered_json bench_effects(const BenchOptions& o) {
  const Workload w = make_workload(o);
  const int rounds = o.quick ? 3 : 9;
  std::vector<Card> cards = open_cards(o, w);
  if (o.markdown)
    print_figure("| card | times the planned card | least to most | cycles of the pass |\n{}\n",
                 "| --- | --- | --- | --- |");
  else
    print_figure(
        "\n{} x {}, nearest, {}, fp32, one thread. The planned card: {}.\nEach other card is the "
        "planned card with one change. Slower: ratio of processor times, and (wall) of wall times; "
        "medians of {}, each measured in turn with the planned "
        "card.\n{:<44}{:>7}{:>15}{:>9}{:>12}{:>10}{:>11}{:>9}{:>9}\n",
        counted(w.rays.size(), "ray"), counted(w.triangles.size(), "triangle"),
        counted(w.planned.lanes, "lane"), fmt::join(w.planned.parameters(), " "),
        counted(static_cast<unsigned>(rounds), "round"), "card", "slower", "least to most",
        "(wall)", "frame, s", "bus, %", "cycles", "built, s", "in plans");
  std::optional<Progress> progress("effects, each card in turn");
  for (Card& c : cards) c.frame(), c.pass();  // warms the caches
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < cards.size(); ++i) {
      const std::size_t done = static_cast<std::size_t>(round) * cards.size() + i;
      (*progress)(static_cast<double>(done) /
                  static_cast<double>(static_cast<std::size_t>(rounds) * cards.size()));
      cards[i].measure(cards[cards[i].variant().beside_last ? i - 1 : 0]);
    }
  }
  progress.reset();
  ordered_json list = ordered_json::array();
  for (const Card& c : cards) {
    o.markdown ? c.print_markdown() : c.print();
    list.push_back(c.json(o.device));
  }
  if (o.markdown)
    print_figure("\n");
  else
    print_figure(
        "bus: extra processor time of a frame (rays, registers, pass, records) over its pass, "
        "fastest of each; built: by this run\nall records of all frames equal the reference\n");
  return {{"rays", w.rays.size()},
          {"triangles", w.triangles.size()},
          {"lanes", w.planned.lanes},
          {"format", "fp32"},
          {"bus", "functional, unless the card's top is \"card\"; host profile ideal"},
          {"rounds", rounds},
          {"what", "simulation time of a frame relative to the planned card, medians"},
          {"cards", list},
          {"promises", promises(cards)}};
}

}  // namespace cde::cli
