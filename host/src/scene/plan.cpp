// SPDX-License-Identifier: Apache-2.0
#include "cde/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <span>

#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "scene/bvh_choice.hpp"
#include "scene/plan_bvh.hpp"
#include "scene/plan_card.hpp"
#include "scene/plan_transform_site.hpp"
#include "scene/self_pairs.hpp"

namespace cde {
namespace {

/// Lanes of pipes with candidate axes (SAT) and iterative pipelines, which take longest to build:
/// one vector register of the host.
constexpr unsigned kLanesOfLargePipes = 8;

/// How many times as long a frame of rays and triangles takes to simulate with an effect: medians
/// of `cde bench effects`, which prints them beside its own.
struct Cost {
  std::string_view effect;
  double times;
};
constexpr Cost kCosts[] = {
    {"pipes", 2.2},
    {"gates", 58.0},
    {"transformer", 1.4},
    {"box rule", 1.0},
    {"normals", 1.0},
    {"exchange of roles", 1.1},
    {"two pairs at a time", 1.3},
    {"bus timing", 1.3},
    {"memory timing", 1.0},
    {"ecc", 1.8},
    {"trace", 1.1},
};

std::uint64_t count(const Scene& scene, const std::vector<std::size_t>& objects) {
  std::uint64_t n = 0;
  for (const std::size_t i : objects) n += size(scene.objects[i].shapes);
  return n;
}

/// Counts the tests of a query's passes, and their rows.
void add_passes(const Scene& scene, const SceneQuery& q, unsigned lanes, QueryWork& w) {
  const SelfPairs self(scene, q);
  for (std::uint64_t first = 0; first < w.primaries; first += card::kMostPrimaries) {
    const std::uint64_t n = std::min(card::kMostPrimaries, w.primaries - first);
    std::uint64_t masked = 0;
    for (std::uint64_t p = first; !q.mask.empty() && p < first + n; ++p)
      masked += contains(q.mask, p) ? 1 : 0;
    if (masked == n) continue;
    for (const SelfPairs::PassRange& range : self.passes(first, n, false)) {
      ++w.passes;
      w.tests += (n - masked) * range.count;
      w.rows += (n + lanes - 1) / lanes * range.count;
    }
  }
  const bool stream = q.mode == Mode::kAll || q.mode == Mode::kHits;
  const std::uint64_t active = w.primaries - w.masked;
  w.most_records = stream ? active * w.secondaries - self.left_out() : active;
  w.self_pairs = self.any();
}

QueryWork work_of(const Scene& scene, const SceneQuery& q, unsigned lanes) {
  QueryWork w;
  w.name = q.name;
  w.primaries = count(scene, q.primaries);
  w.secondaries = count(scene, q.secondaries);
  w.masked = count(q.mask);
  w.packets = (w.primaries + card::kMostPrimaries - 1) / card::kMostPrimaries;
  add_passes(scene, q, lanes, w);
  const unsigned slot = words(shape_of(scene.objects[q.secondaries.front()].shapes));
  w.secondary_words = w.secondaries * slot;
  w.primary_words = w.primaries * words(shape_of(scene.objects[q.primaries.front()].shapes));
  return w;
}

/// Cycles per frame in which the pipes get a row.
std::uint64_t rows_of(const Scene& scene, unsigned lanes) {
  std::uint64_t sum = 0;
  for (const SceneQuery& q : scene.queries) sum += work_of(scene, q, lanes).rows;
  return sum;
}

std::string join(std::span<const Pair> pairs) {
  std::string text;
  for (const Pair pair : pairs) text += fmt::format("{}{}", text.empty() ? "" : ", ", name(pair));
  return text;
}

std::vector<Pair> pairs_of(const Scene& scene) {
  std::vector<Pair> pairs;
  for (const SceneQuery& q : scene.queries) {
    if (std::find(pairs.begin(), pairs.end(), q.pair) == pairs.end()) pairs.push_back(q.pair);
  }
  std::sort(pairs.begin(), pairs.end());
  if (scene.card.pairs.empty()) return pairs;
  std::vector<Pair> asked = scene.card.pairs;
  std::sort(asked.begin(), asked.end());
  for (const SceneQuery& q : scene.queries) {
    if (std::find(asked.begin(), asked.end(), q.pair) == asked.end())
      throw Error(ErrorCode::kUsage,
                  fmt::format("{}: query '{}' needs a pipe for {}, but [card] has pairs = {}; add "
                              "the pair, or omit pairs",
                              printable_name(scene.file), q.name, name(q.pair), join(asked)));
  }
  return asked;
}

/// The lanes of the device, so that scenes share cards. Large pipes and gates take minutes to build
/// and are slow to simulate: they get fewer, and gates no more than there are primaries.
unsigned lanes_for(const Scene& scene, const std::vector<Pair>& pairs) {
  if (scene.card.lanes) return *scene.card.lanes;
  const unsigned lanes = scene.card.device.lanes;
  std::uint64_t most = 1;
  for (const SceneQuery& q : scene.queries)
    most = std::max(most, std::min<std::uint64_t>(card::kMostPrimaries, count(scene, q.primaries)));
  if (scene.card.arithmetic == Arithmetic::kRtl)
    return std::min(
        {std::bit_ceil(static_cast<unsigned>(most)), plan_card::kMostLanesOfGates, lanes});
  const bool large = scene.card.filter || std::ranges::any_of(pairs, plan_card::is_large);
  return large ? std::min(kLanesOfLargePipes, lanes) : lanes;
}

BoardConfig board_of(const Scene& scene) {
  BoardConfig b;
  b.pairs = pairs_of(scene);
  b.lanes = lanes_for(scene, b.pairs);
  b.arithmetic = scene.card.arithmetic;
  b.format = scene.card.format;
  b.filter = scene.card.filter;
  if (std::find(b.pairs.begin(), b.pairs.end(), Pair::kRayTriangle) != b.pairs.end())
    b.algorithm = scene.card.algorithm;
  b.box = scene.card.box;
  b.box = std::any_of(b.pairs.begin(), b.pairs.end(), [&b](Pair p) { return b.box_rule(p); });
  b.trace = scene.card.trace;
  b.bus = scene.card.cycle_bus ? Bus::kCycle : Bus::kFunctional;
  b.ecc = scene.card.ecc;
  for (const SceneQuery& q : scene.queries) {
    b.swap = b.swap || q.swap;
    b.normals = b.normals || q.normals;
  }
  b = on(scene.card.device, b);
  (void)b.parameters();  // throws for bad values
  return b;
}

void check_capacity(const Scene& scene, const Plan& plan) {
  const std::uint64_t held = std::uint64_t{plan.board.ddr_slots} * words(Shape::kTriangle);
  for (const QueryWork& w : plan.queries) {
    if (w.secondary_words > held)
      throw Error(
          ErrorCode::kCapacity,
          fmt::format("{}: query '{}': {} secondaries have {} words, but the card's DDR holds {}",
                      printable_name(scene.file), w.name, w.secondaries, w.secondary_words, held));
    if (w.most_records > ~std::uint32_t{0})
      throw Error(
          ErrorCode::kCapacity,
          fmt::format("{}: query '{}': mode {} may keep {} records, more than the 2^32 - 1 of a "
                      "card; use nearest, farthest or any",
                      printable_name(scene.file), w.name,
                      name_of(scene.queries[&w - plan.queries.data()].mode), w.most_records));
  }
}

// ---- Effects ----

std::uint64_t total(const Plan& plan, std::uint64_t QueryWork::*field) {
  std::uint64_t sum = 0;
  for (const QueryWork& w : plan.queries) sum += w.*field;
  return sum;
}

Effect pipes(const Scene& scene, const Plan& plan) {
  Effect e{"pipes", true, join(plan.board.pairs), "", ""};
  e.why = scene.card.pairs.empty() ? "the pairs of the queries" : "asked for in [card]";
  if (plan.board.pairs.size() < kPairs) {
    e.why += fmt::format("; the other {} are omitted", kPairs - plan.board.pairs.size());
    e.cost = fmt::format("with all {}, {}", kPairs, simulation_text("pipes"));
  }
  return e;
}

Effect box_rule(const Plan& plan) {
  const std::vector<Pair>& pairs = plan.board.pairs;
  const bool rays = std::find(pairs.begin(), pairs.end(), Pair::kRayTriangle) != pairs.end();
  const bool solids = std::any_of(pairs.begin(), pairs.end(), [&](Pair pair) {
    return pair != Pair::kRayTriangle &&
           (plan.board.box ? plan.board.box_rule(pair) : has_box_rule(pair));
  });
  std::string why = "no pair has it";
  if (plan.board.box) {
    why = rays ? "a ray's hit must lie in the triangle's box" : "";
    if (solids)
      why += fmt::format("{}the distance of two shapes is at least the distance of their boxes",
                         rays ? "; " : "");
  } else if (rays) {
    why = "the plain pipe was requested: a hit may be far from an edge-on triangle";
  } else if (solids) {
    why = plan.board.filter ? "the certified filter proves misses of solids"
                            : "the plain pipes were requested: solids cannot traverse a BVH";
  }
  return {"box rule", plan.board.box, plan.board.box ? "built in" : "none", why,
          simulation_text("box rule")};
}

Effect lanes(const Scene& scene, const Plan& plan) {
  const unsigned n = plan.board.lanes;
  Effect e{"lanes", true, fmt::format("{}", n), "", ""};
  if (std::all_of(plan.queries.begin(), plan.queries.end(),
                  [](const QueryWork& w) { return w.bvh; })) {
    e.why = scene.card.lanes ? "asked for in [card]" : "no query uses brute force";
    e.cost = "0 rows per frame";
    return e;
  }
  std::uint64_t most = 0;
  for (const QueryWork& w : plan.queries)
    most = std::max(most, std::min(card::kMostPrimaries, w.primaries));
  if (scene.card.lanes)
    e.why = "asked for in [card]";
  else if (n >= most)
    e.why = fmt::format("the largest packet has {} primaries: one row per secondary", most);
  else
    e.why = fmt::format(
        "the largest packet has {} primaries, and {} has {} lanes unless [card] sets more", most,
        n == scene.card.device.lanes                ? "the device"
        : plan.board.arithmetic == Arithmetic::kRtl ? "a card of gates"
                                                    : "a card of these pipes",
        n);
  const auto rows = [&](unsigned lanes) { return rows_of(scene, lanes); };
  e.cost = fmt::format("{} rows per frame", rows(n));
  if (n > 1) e.cost += fmt::format("; {} with {} lanes", rows(n / 2), n / 2);
  if (n < card::kMostPrimaries) e.cost += fmt::format("; {} with {}", rows(n * 2), n * 2);
  return e;
}

Effect arithmetic(const Plan& plan) {
  const bool gates = plan.board.arithmetic == Arithmetic::kRtl;
  return {"gates", gates, gates ? "rtl" : "host",
          gates ? "asked for in [card]" : "the host's arithmetic gives the same bits and cycles",
          simulation_text("gates")};
}

Effect number_format(const Plan& plan) {
  const FpFormat f = plan.board.format;
  const bool other = f != FpFormat{};
  return {
      "number format", other, f.name(),
      other
          ? fmt::format(
                "asked for in [card]: {} exponent and {} fraction bits, still in words of 32 bits",
                f.exp_bits, f.man_bits)
          : "[card] sets no other format",
      other ? "host arithmetic rounds to it in several steps; not measured" : "none"};
}

Effect filter(const Scene& scene, const Plan& plan) {
  if (!plan.board.filter)
    return {"filter", false, "none", "not asked for",
            "would take a cycle per row, and one per uncertain pair"};
  std::vector<std::string_view> spared;
  for (const SceneQuery& q : scene.queries)
    if (has_filter(q.pair) && (q.mode == Mode::kHits || q.mode == Mode::kAny))
      spared.push_back(q.name);
  const std::string why =
      spared.empty()
          ? "asked for, but no query with such a pair has mode any or hits, so every pair "
            "goes through the wide lane"
          : fmt::format("asked for; {} can omit misses", fmt::join(spared, ", "));
  return {
      "filter", true,
      fmt::format("{} lanes before one of {}", plan.board.filter->name(), plan.board.format.name()),
      why, "a cycle per row, and one per uncertain pair; not measured"};
}

Effect modes(const Scene& scene, const Plan& plan) {
  Effect e{"result mode", true, "", "", ""};
  for (std::size_t i = 0; i < plan.queries.size(); ++i) {
    const SceneQuery& q = scene.queries[i];
    const QueryWork& w = plan.queries[i];
    const char* sep = i == 0 ? "" : "; ";
    e.choice += fmt::format("{}{} {}", sep, q.name, name_of(q.mode));
    const bool stream = q.mode == Mode::kAll || q.mode == Mode::kHits;
    e.why += fmt::format("{}{} {} {} records per frame", sep, q.name,
                         stream ? "writes at most" : "keeps", w.most_records);
    const std::uint64_t bytes = 28 * (q.normals ? 2 : 1) * (w.primaries - w.masked) * w.secondaries;
    e.cost +=
        q.mode == Mode::kAll
            ? fmt::format("{}{} writes {} bytes per frame", sep, q.name, bytes)
            : fmt::format("{}in mode all {} would write {} bytes per frame", sep, q.name, bytes);
  }
  return e;
}

Effect normals(const Scene& scene, const Plan& plan) {
  Effect e{"normals", plan.board.normals, plan.board.normals ? "second records" : "none", "", ""};
  std::uint64_t records = 0;
  for (std::size_t i = 0; i < plan.queries.size(); ++i)
    if (is_solid(scene.queries[i].pair)) records += plan.queries[i].most_records;
  e.why = e.used         ? "a query asks for them"
          : records == 0 ? "rays have none"
                         : "no query asks for them";
  e.cost = simulation_text(e.name);
  if (records != 0)
    e.cost +=
        fmt::format("; at most {} further records per frame, one cycle each to write", records);
  return e;
}

Effect masks(const Plan& plan) {
  const std::uint64_t masked = total(plan, &QueryWork::masked);
  Effect e{"masks", masked != 0, fmt::format("{} primaries", masked), "", ""};
  std::uint64_t saved = 0;
  for (const QueryWork& w : plan.queries) saved += w.masked * w.secondaries;
  e.why = masked != 0 ? "the queries omit these" : "no query omits primaries";
  e.cost = masked != 0 ? fmt::format("saves {} tests per frame", saved) : "0 tests per frame";
  return e;
}

Effect self_pairs(const Scene& scene, const Plan& plan) {
  Effect e{"pairs with itself", false, "left out", "", ""};
  for (std::size_t i = 0; i < plan.queries.size(); ++i) {
    const QueryWork& w = plan.queries[i];
    if (!w.self_pairs) continue;
    const Mode mode = scene.queries[i].mode;
    const bool stream = mode == Mode::kAll || mode == Mode::kHits;
    const char* sep = e.why.empty() ? "" : "; ";
    e.why += fmt::format("{}{} has an object on both sides: no shape is tested with itself{}", sep,
                         w.name, stream ? ", and each pair counts once" : "");
    const std::uint64_t all = (w.primaries - w.masked) * w.secondaries;
    e.cost += fmt::format("{}{} of {} tests remain, in {} pass{}", sep, w.tests, all, w.passes,
                          w.passes == 1 ? "" : "es");
    if (w.passes != w.packets) e.cost += fmt::format(" instead of {}", w.packets);
  }
  return e;
}

Effect roles(const Plan& plan) {
  return {"exchange of roles", plan.board.swap, plan.board.swap ? "built in" : "none",
          plan.board.swap ? "a query has the pair's second shape as primaries"
                          : "every query has the pair's first shape as primaries",
          simulation_text("exchange of roles")};
}

Effect residence(const Plan& plan) {
  Effect e{"re-upload of secondaries", !plan.resident, plan.resident ? "none" : "every pass", "",
           ""};
  const std::uint64_t all = total(plan, &QueryWork::secondary_words);
  e.why = plan.resident
              ? "all queries have the same secondaries, which stay in DDR"
              : "queries have different secondaries, and DDR holds the secondaries of one query";
  e.cost = fmt::format("{}{} words per frame", plan.resident ? "would be " : "", all);
  return e;
}

std::vector<Effect> effects_of(const Scene& scene, const Plan& plan,
                               const std::vector<Effect>& sites) {
  const bool trace = plan.board.trace, cycle = plan.board.bus == Bus::kCycle;
  const bool banks = scene.card.cycle_memory;
  std::vector<Effect> effects = {
      pipes(scene, plan),
      box_rule(plan),
      lanes(scene, plan),
      arithmetic(plan),
      number_format(plan),
      filter(scene, plan),
      modes(scene, plan),
      normals(scene, plan),
      masks(plan),
      roles(plan),
      residence(plan),
      {"two pairs at a time", false, "none", "queries run one after another",
       simulation_text("two pairs at a time")},
      {"bus timing", cycle, cycle ? "cycle" : "functional",
       fmt::format("{}; host {}, {} bits, bursts of {} bytes",
                   cycle ? "asked for: PCI cycle by cycle" : "PCI time is computed, not simulated",
                   scene.card.host.name, scene.card.narrow ? 32 : 64, scene.card.burst),
       simulation_text("bus timing")},
      {"memory timing", banks, banks ? "cycle" : "ideal",
       banks ? "asked for: DDR-400 with banks, rows and refresh"
             : "one slot per cycle after a fixed latency",
       simulation_text("memory timing")},
      {"ecc", plan.board.ecc, plan.board.ecc ? "check bits in DDR" : "none",
       plan.board.ecc ? "asked for" : "not asked for", simulation_text("ecc")},
      {"trace", trace, trace ? "waves can be written" : "none",
       trace ? "asked for" : "not asked for",
       simulation_text("trace") + " even while none are written"},
  };
  if (std::any_of(plan.queries.begin(), plan.queries.end(),
                  [](const QueryWork& w) { return w.self_pairs; }))
    effects.insert(effects.begin() + 8, self_pairs(scene, plan));
  effects.insert(effects.begin() + 4, sites.begin(), sites.end());
  return effects;
}

/// Adds the transformer and its tables to the plan.
void add_transform_sites(const Scene& scene, const plan_transform_site::TransformSites& sites,
                         Plan& plan) {
  plan.card_moves = sites.secondaries;
  plan.card_moves_primaries = sites.primaries;
  const auto any = [](const std::vector<bool>& some) {
    return std::find(some.begin(), some.end(), true) != some.end();
  };
  if (any(sites.secondaries)) {
    plan.board.transform = Transformer::kSecondaries;
    while (plan.board.objects < sites.entries) plan.board.objects *= 2;
  }
  if (any(sites.primaries)) plan.board.transform = Transformer::kBoth;
  for (std::size_t q = 0; q < plan.queries.size(); ++q) {
    for (const std::size_t i : scene.queries[q].secondaries)
      plan.queries[q].moved_words +=
          plan_transform_site::words_per_frame(scene, scene.objects[i], sites.secondaries[i]);
    if (sites.primary_words) plan.queries[q].primary_words = q == 0 ? *sites.primary_words : 0;
  }
}

/// Adds traversal units if queries traverse a BVH. Their primaries are streamed in as the host
/// moved them. If every query traverses, the lanes are idle and few suffice.
Effect add_bvh(const Scene& scene, plan_transform_site::TransformSites& sites, Plan& plan) {
  const plan_bvh::Choice choice = plan_bvh::choose(scene, plan);
  if (choice.nodes == 0) return choice.effect;
  add_traversal_units(scene.card.device, choice.nodes, plan.board);
  for (std::size_t q = 0; q < plan.queries.size(); ++q) plan.queries[q].bvh = choice.queries[q];
  plan_transform_site::leave_primaries(sites, "the host writes them during BVH traversal");
  const bool brute_force =
      std::find(choice.queries.begin(), choice.queries.end(), false) != choice.queries.end();
  const std::vector<Pair>& pairs = plan.board.pairs;
  if (!brute_force && !scene.card.lanes)
    plan.board.lanes = std::any_of(pairs.begin(), pairs.end(), plan_card::is_large)
                           ? std::min(kLanesOfLargePipes, scene.card.device.lanes)
                           : scene.card.device.leaf_lanes();
  return choice.effect;
}

}  // namespace

std::optional<double> simulation_cost(std::string_view effect) {
  for (const Cost& c : kCosts)
    if (c.effect == effect) return c.times;
  return std::nullopt;
}

std::string simulation_text(std::string_view effect) {
  const std::optional<double> times = simulation_cost(effect);
  if (!times) return "not measured";
  return fmt::format("a simulation with it takes {:.1f} times as long (cde bench effects)", *times);
}

Plan plan(const Scene& scene) {
  Plan plan;
  plan.board = board_of(scene);
  for (const SceneQuery& q : scene.queries) {
    plan.queries.push_back(work_of(scene, q, plan.board.lanes));
    plan.resident = plan.resident && q.secondaries == scene.queries.front().secondaries;
  }
  check_capacity(scene, plan);
  plan_transform_site::TransformSites sites = plan_transform_site::choose(scene, plan.resident);
  plan.card_moves = sites.secondaries;
  const Effect bvh = add_bvh(scene, sites, plan);
  add_transform_sites(scene, sites, plan);
  plan.effects = effects_of(scene, plan, sites.effects);
  plan.effects.insert(plan.effects.begin() + 2, bvh);
  return plan;
}

void use_built_card(const Scene& scene, Plan& plan) {
  const bool small = std::all_of(plan.queries.begin(), plan.queries.end(), [](const QueryWork& w) {
    return w.primaries <= card::kMostPrimaries;
  });
  if (!small) return;
  const auto card =
      built_card(plan.board, scene.card, [&](unsigned lanes) { return rows_of(scene, lanes); });
  if (!card) return;
  plan.stands_in_for = {plan.board, card->times};
  plan.board = card->board;
  for (std::size_t i = 0; i < plan.queries.size(); ++i)
    plan.queries[i].rows = work_of(scene, scene.queries[i], plan.board.lanes).rows;
}

}  // namespace cde
