// SPDX-License-Identifier: Apache-2.0
// Configurations of a card: their limits, and the builder's parameters.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <iterator>
#include <set>
#include <type_traits>

#include "cde/fp/scalars.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

/// A number of a configuration, and its name in the builder.
struct Number {
  const char* name;
  unsigned (*get)(const BoardConfig&);
  void (*set)(BoardConfig&, unsigned);
  Transformer since = Transformer::kNone;  ///< the least transformer with this number
};

template <auto Member>
constexpr Number field(const char* name, Transformer since = Transformer::kNone) {
  return {name, [](const BoardConfig& c) { return static_cast<unsigned>(c.*Member); },
          [](BoardConfig& c, unsigned value) {
            c.*Member = static_cast<std::decay_t<decltype(c.*Member)>>(value);
          },
          since};
}

unsigned pair_set(const BoardConfig& c) {
  unsigned set = 0;
  for (const Pair pair : c.pairs) set |= 1u << static_cast<unsigned>(pair);
  return set;
}
void set_pairs(BoardConfig& c, unsigned set) {
  c.pairs.clear();
  for (unsigned i = 0; i < kPairs; ++i)
    if ((set >> i & 1) != 0) c.pairs.push_back(static_cast<Pair>(i));
}

/// A number of the certified filter's format; 0 without the filter.
template <auto Member>
constexpr Number filter_field(const char* name) {
  return {name,
          [](const BoardConfig& c) {
            return c.filter ? static_cast<unsigned>((*c.filter).*Member) : 0u;
          },
          [](BoardConfig& c, unsigned value) {
            if (!c.filter) c.filter = FpFormat{0, 0};
            (*c.filter).*Member = static_cast<int>(value);
          }};
}

/// The latency of an operator.
template <auto Member>
constexpr Number latency_field(const char* name) {
  return {name, [](const BoardConfig& c) { return c.latency.*Member; },
          [](BoardConfig& c, unsigned value) { c.latency.*Member = value; }};
}

constexpr Number kFields[] = {
    field<&BoardConfig::lanes>("LANES"),
    {"EXP", [](const BoardConfig& c) { return static_cast<unsigned>(c.format.exp_bits); },
     [](BoardConfig& c, unsigned value) { c.format.exp_bits = static_cast<int>(value); }},
    {"MAN", [](const BoardConfig& c) { return static_cast<unsigned>(c.format.man_bits); },
     [](BoardConfig& c, unsigned value) { c.format.man_bits = static_cast<int>(value); }},
    {"PAIRS", pair_set, set_pairs},
    field<&BoardConfig::algorithm>("ALGORITHM"),
    field<&BoardConfig::box>("BOX"),
    field<&BoardConfig::swap>("SWAP"),
    field<&BoardConfig::normals>("NORMALS"),
    field<&BoardConfig::parallel>("PARALLEL"),
    field<&BoardConfig::sat_interval>("SAT_II"),
    filter_field<&FpFormat::exp_bits>("FILTER_EXP"),
    filter_field<&FpFormat::man_bits>("FILTER_MAN"),
    field<&BoardConfig::traversal_units>("TRAVERSAL_UNITS"),
    field<&BoardConfig::nodes>("NODES"),
    field<&BoardConfig::node_cycles>("NODE_CYCLES"),
    field<&BoardConfig::node_cache>("NODE_CACHE"),
    field<&BoardConfig::node_ways>("NODE_WAYS"),
    field<&BoardConfig::pinned_nodes>("PINNED_NODES"),
    field<&BoardConfig::contexts>("CONTEXTS"),
    field<&BoardConfig::shared_lane>("SHARED_LANE"),
    field<&BoardConfig::ray_places>("RAY_PLACES"),
    field<&BoardConfig::ecc>("ECC"),
    field<&BoardConfig::transform>("TRANSFORM"),
    field<&BoardConfig::objects>("OBJECTS", Transformer::kSecondaries),
    field<&BoardConfig::primary_objects>("PRIM_OBJECTS", Transformer::kBoth),
    latency_field<&OperatorLatencies::add>("LAT_ADD"),
    latency_field<&OperatorLatencies::mul>("LAT_MUL"),
    latency_field<&OperatorLatencies::div>("LAT_DIV"),
    latency_field<&OperatorLatencies::sqrt>("LAT_SQRT"),
    latency_field<&OperatorLatencies::compare>("LAT_CMP"),
    field<&BoardConfig::ddr_slots>("DDR_SLOTS"),
    field<&BoardConfig::sram_records>("SRAM_RECORDS"),
    field<&BoardConfig::trace>("TRACE"),
};

}  // namespace

void check(Arithmetic arithmetic) {
  if (arithmetic != Arithmetic::kHost && arithmetic != Arithmetic::kRtl)
    throw Error(ErrorCode::kUsage, fmt::format("there is no arithmetic {}; expected 0 or 1",
                                               static_cast<int>(arithmetic)));
}

void check_card_format(FpFormat format) {
  if (is_card_format(format)) return;
  std::string known;
  for (const FpFormat f : kPairFormats)
    if (is_card_format(f)) known += (known.empty() ? "" : ", ") + f.name();
  throw Error(ErrorCode::kUsage,
              format.width() > static_cast<int>(kCardWord)
                  ? fmt::format("a card cannot use {}: the words of its buses, memories and "
                                "records are {} bits wide; expected {}",
                                format.name(), kCardWord, known)
                  : fmt::format("a card cannot use {}; expected {}", format.name(), known));
}

void check_narrow_format(FpFormat narrow, FpFormat wide) {
  check_card_format(narrow);
  if (narrow.exp_bits > wide.exp_bits || narrow.man_bits >= wide.man_bits)
    throw Error(ErrorCode::kUsage,
                fmt::format("a certified filter in {} cannot precede {}; expected a format with no "
                            "more exponent bits and fewer fraction bits: fp16, bf16, tf32 or fp24 "
                            "before fp32, bf16 before tf32, fp16 before fp24",
                            narrow.name(), wide.name()));
}

namespace {

void check_filter(const BoardConfig& c) {
  if (!c.filter) return;
  check_narrow_format(*c.filter, c.format);
  if (std::none_of(c.pairs.begin(), c.pairs.end(), has_filter))
    throw Error(ErrorCode::kUsage,
                "the certified filter needs one of sphere-sphere, sphere-obb, triangle-sphere, "
                "triangle-aabb, triangle-obb and obb-obb; the card has none");
  constexpr unsigned kMostLanes = 32;  // all share the one wide lane
  if (c.lanes > kMostLanes)
    throw Error(ErrorCode::kUsage,
                fmt::format("lanes is {}; with the certified filter it must be 1 to {}", c.lanes,
                            kMostLanes));
  if (c.sat_interval != 1)
    throw Error(ErrorCode::kUsage,
                fmt::format("the SAT interval is {}; with the certified filter it must be 1",
                            c.sat_interval));
}

}  // namespace

namespace {

void check_node_cache(const BoardConfig& c) {
  const BoardConfig standard;
  if (c.node_cache == 0) {
    if (c.node_ways != standard.node_ways || c.pinned_nodes != standard.pinned_nodes)
      throw Error(ErrorCode::kUsage,
                  "a card without a node cache has no node_ways or pinned_nodes");
    return;
  }
  constexpr unsigned kMostWays = 16, kMostLines = 1u << 16;
  const auto power = [](unsigned value, const char* name, unsigned least, unsigned most) {
    if (!std::has_single_bit(value) || value < least || value > most)
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is {}; it must be a power of two from {} to {}", name, value,
                              least, most));
  };
  power(c.node_ways, "node_ways", 2, kMostWays);
  power(c.node_cache, "node_cache", 2 * c.node_ways, kMostLines);
  power(c.pinned_nodes, "pinned_nodes", 16, c.nodes);
}

void check_bvh(const BoardConfig& c) {
  const auto require = [](bool ok, const std::string& why) {
    if (!ok) throw Error(ErrorCode::kUsage, why);
  };
  if (c.traversal_units == 0) {
    require(c.nodes == BoardConfig().nodes, "a card without traversal units has no node memory");
    require(c.node_cycles == 1, "a card without traversal units has no cycles per node");
    require(c.node_cache == 0, "a card without traversal units has no node cache");
    require(c.contexts == BoardConfig().contexts && c.ray_places == BoardConfig().ray_places &&
                c.shared_lane == 0,
            "a card without traversal units has no contexts, no ray places and no shared lane");
    check_node_cache(c);
    return;
  }
  constexpr unsigned kMostUnits = 4, kLeastNodes = 16, kMostNodes = 1u << 22;
  require(std::has_single_bit(c.traversal_units) && c.traversal_units <= kMostUnits,
          fmt::format("traversal_units is {}; it must be 0, 1, 2 or 4", c.traversal_units));
  require(std::has_single_bit(c.nodes) && c.nodes >= kLeastNodes && c.nodes <= kMostNodes,
          fmt::format("nodes is {}; it must be a power of two from {} to {}", c.nodes, kLeastNodes,
                      kMostNodes));
  require(c.node_cycles == 1 || c.node_cycles == 2 || c.node_cycles == 4,
          fmt::format("node_cycles is {}; it must be 1, 2 or 4", c.node_cycles));
  check_node_cache(c);
  constexpr unsigned kLeastContexts = 16, kMostContexts = 256;
  require(std::has_single_bit(c.contexts) && c.contexts >= kLeastContexts &&
              c.contexts <= kMostContexts,
          fmt::format("contexts is {}; it must be a power of two from {} to {}", c.contexts,
                      kLeastContexts, kMostContexts));
  constexpr unsigned kLeastPlaces = 64, kMostPlaces = 4096;
  require(std::has_single_bit(c.ray_places) && c.ray_places >= kLeastPlaces &&
              c.ray_places <= kMostPlaces,
          fmt::format("ray_places is {}; it must be a power of two from {} to {}", c.ray_places,
                      kLeastPlaces, kMostPlaces));
  constexpr unsigned kMostTurns = 8;
  require(c.shared_lane == 0 || (std::has_single_bit(c.shared_lane) && c.shared_lane <= kMostTurns),
          fmt::format("shared_lane is {}; it must be 0, 1, 2, 4 or 8", c.shared_lane));
  require(c.shared_lane == 0 || c.can_share_lane(),
          "a shared lane needs one lane, and ray-triangle by moller as the only pair, without "
          "exchange of roles");
  require(c.format == FpFormat(),
          fmt::format("a BVH needs fp32, not {}: it widens boxes by 2^-16 of the scene, and a "
                      "coarser format would widen them by percents",
                      c.format.name()));
  const bool traversable = std::any_of(c.pairs.begin(), c.pairs.end(), [&c](Pair pair) {
    return c.traversal_shapes(pair, false).has_value();
  });
  require(
      traversable,
      "no pair of this card can traverse a BVH; expected ray-sphere or sphere-sphere, or with the "
      "box rule ray-triangle, sphere-obb, obb-obb or a triangle with a sphere, AABB, OBB or "
      "triangle; the certified filter cannot be combined with a BVH");
}

}  // namespace

bool BoardConfig::box_rule(Pair pair) const {
  return box && has_box_rule(pair) && !(filter && has_filter(pair));
}

bool BoardConfig::can_share_lane() const {
  return lanes == 1 && !swap && algorithm == Algorithm::kMoller &&
         pairs == std::vector<Pair>{Pair::kRayTriangle};
}

std::optional<TraversalShapes> BoardConfig::traversal_shapes(Pair pair, bool swapped) const {
  const bool there =
      (swap || !swapped) && (box || !has_box_rule(pair)) && !(filter && has_filter(pair));
  return there ? cde::traversal_shapes(pair, swapped) : std::nullopt;
}

std::vector<std::string> BoardConfig::parameters() const {
  const auto require = [](bool ok, const char* name, unsigned value, const std::string& range) {
    if (!ok)
      throw Error(ErrorCode::kUsage, fmt::format("{} is {}; it must be {}", name, value, range));
  };
  require(std::has_single_bit(lanes) && lanes <= 256, "lanes", lanes,
          "a power of two from 1 to 256");
  const auto in_cycles = [&](unsigned value, const char* name) {
    require(value >= 1 && value <= kMostOperatorLatency, name, value,
            fmt::format("1 to {} cycles", kMostOperatorLatency));
  };
  check(arithmetic);
  check_card_format(format);
  require(transform <= Transformer::kBoth, "transform", static_cast<unsigned>(transform), "0 to 2");
  require(bus == Bus::kFunctional || bus == Bus::kCycle, "bus", static_cast<unsigned>(bus),
          "0 or 1");
  (void)name(algorithm);
  for (const Pair pair : pairs) (void)name(pair);
  in_cycles(latency.add, "latency.add");
  in_cycles(latency.mul, "latency.mul");
  in_cycles(latency.div, "latency.div");
  in_cycles(latency.sqrt, "latency.sqrt");
  in_cycles(latency.compare, "latency.compare");
  if (parallel && pairs.size() < 2)
    throw Error(ErrorCode::kUsage, "two pipes at a time need a card with several pairs");
  if (pairs.empty()) throw Error(ErrorCode::kUsage, "a card has at least one pair");
  check_sat_interval(sat_interval, pairs);
  check_filter(*this);
  if (box && std::none_of(pairs.begin(), pairs.end(), has_box_rule))
    throw Error(ErrorCode::kUsage,
                "the box rule needs triangles with rays, spheres, AABBs, OBBs or triangles, or "
                "OBBs with spheres or OBBs; the card has no such pair");
  const BoardConfig standard;
  check_bvh(*this);
  const bool moves = transform != Transformer::kNone, poses = transform == Transformer::kBoth;
  const auto table = [&](unsigned value, const char* name) {
    require(value >= 2 && value <= 2048, name, value, "2 to 2048");
  };
  if (moves) table(objects, "objects");
  if (poses) table(primary_objects, "primary_objects");
  require(ddr_slots >= 1 && ddr_slots <= standard.ddr_slots, "ddr_slots", ddr_slots,
          "1 to 55555555");
  require(std::has_single_bit(sram_records) && sram_records >= 2 &&
              sram_records <= standard.sram_records,
          "sram_records", sram_records, "a power of two from 2 to 524288");

  std::vector<std::string> list = {
      fmt::format("ARITH={}", arithmetic == Arithmetic::kHost ? "host" : "rtl")};
  for (const Number& field : kFields)
    if (transform >= field.since && field.get(*this) != field.get(standard))
      list.push_back(fmt::format("{}={}", field.name, field.get(*this)));
  return list;
}

std::optional<BoardConfig> BoardConfig::of(const std::vector<std::string>& parameters) try {
  BoardConfig config;
  std::set<std::string> seen;
  for (const std::string& parameter : parameters) {
    const std::size_t equals = std::min(parameter.find('='), parameter.size());
    const std::string name = parameter.substr(0, equals);
    const std::string_view value = std::string_view(parameter).substr(equals).substr(
        std::min<std::size_t>(1, parameter.size() - equals));
    if (!seen.insert(name).second) return std::nullopt;
    if (name == "ARITH" && (value == "host" || value == "rtl")) {
      config.arithmetic = value == "host" ? Arithmetic::kHost : Arithmetic::kRtl;
      continue;
    }
    const auto* field = std::find_if(std::begin(kFields), std::end(kFields),
                                     [&](const Number& f) { return name == f.name; });
    unsigned number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (field == std::end(kFields) || error != std::errc() || stop != value.data() + value.size())
      return std::nullopt;
    field->set(config, number);
    if (field->get(config) != number) return std::nullopt;
  }
  (void)config.parameters();
  return config;
} catch (const Error&) {
  return std::nullopt;
}

}  // namespace cde
