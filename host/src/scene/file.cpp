// SPDX-License-Identifier: Apache-2.0
// Reads a whole scene file: run options, [card], [[query]], and references between objects.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "cde/contract/records.hpp"
#include "cde/contract/registers.hpp"
#include "cde/scene/inside.hpp"
#include "cde/support/message.hpp"
#include "scene/parts.hpp"
#include "support/file_io.hpp"
#include "support/sha256.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

using toml_reader::Table;
using toml_reader::Tables;

constexpr std::uint64_t kMostBytes = 64u << 20;  ///< of a scene file

const std::vector<std::string> kModes = {"nearest", "farthest", "any", "all", "hits"};

FpFormat read_format(Table& t, const char* key = "format") {
  const std::string text = t.text(key, "fp32");
  try {
    const FpFormat format = FpFormat::parse(text);
    check_card_format(format);
    return format;
  } catch (const Error& e) {
    t.fail(e.code(), key, e.what());
  }
}

/// Reads a pair. Its shapes may have any order: the query's objects decide the roles.
Pair read_pair(const Table& t, const char* key, const std::string& text) {
  try {
    return pair_in_any_order(text).pair;
  } catch (const Error& e) {
    t.fail(e.code(), key, e.what());
  }
}

SceneCard read_card(Table t) {
  SceneCard card;
  if (t.has("lanes")) card.lanes = t.integer<unsigned>("lanes", {}, 1, 256);
  t.also_known({"lanes", "pairs", "filter"});
  if (t.has("pairs")) {
    for (const std::string& text : t.texts("pairs")) {
      const Pair pair = read_pair(t, "pairs", text);
      if (std::find(card.pairs.begin(), card.pairs.end(), pair) == card.pairs.end())
        card.pairs.push_back(pair);
    }
  }
  card.arithmetic = static_cast<Arithmetic>(t.choice("arithmetic", {"host", "rtl"}, 0));
  card.format = read_format(t);
  if (t.has("filter")) {
    card.filter = read_format(t, "filter");
    try {
      check_narrow_format(*card.filter, card.format);
    } catch (const Error& e) {
      t.fail(e.code(), "filter", e.what());
    }
  }
  card.algorithm = static_cast<Algorithm>(t.choice(
      "algorithm", {"moller", "badouel", "pluecker", "watertight"}, static_cast<int>(kLeakFree)));
  card.box = t.flag("box", true);
  std::vector<std::string> known;
  for (const Device& d : devices()) known.push_back(d.name);
  card.device = devices()[t.choice("device", known, 0)];
  card.device.clock_mhz =
      t.number("clock_mhz", card.device.clock_mhz, {.min = kLeastClockMhz, .max = kMostClockMhz});
  card.cycle_bus = t.choice("bus", {"functional", "cycle"}, 0) == 1;
  std::vector<std::string> hosts;
  hosts.reserve(std::size(kHostProfiles));
  for (const HostProfile& p : kHostProfiles) hosts.emplace_back(p.name);
  card.host = kHostProfiles.at(t.choice("host", hosts, 0));
  card.burst = t.integer<unsigned>("burst", 4096, 64, 4096);
  if (card.burst % 8 != 0)
    t.fail("burst", fmt::format("is {}; it must be a multiple of 8 bytes", card.burst));
  card.narrow = t.flag("narrow", false);
  card.cycle_memory = t.choice("memory", {"ideal", "cycle"}, 0) == 1;
  card.ecc = t.flag("ecc", false);
  card.trace = t.flag("trace", false);
  card.transform_site =
      static_cast<TransformSite>(t.choice("transform_site", {"auto", "host", "card"}, 0));
  card.bvh = static_cast<UseBvh>(t.choice("bvh", {"auto", "on", "off"}, 0));
  if (auto latency = t.table("latency")) {
    OperatorLatencies& l = card.device.latencies;
    for (const auto& [key, cycles] : {std::pair{"add", &l.add},
                                      {"mul", &l.mul},
                                      {"div", &l.div},
                                      {"sqrt", &l.sqrt},
                                      {"compare", &l.compare}})
      *cycles = latency->integer<unsigned>(key, *cycles, 1, kMostOperatorLatency);
    latency->finish();
  }
  if (card.lanes && (*card.lanes & (*card.lanes - 1)) != 0)
    t.fail("lanes", fmt::format("is {}; it must be a power of two from 1 to 256", *card.lanes));
  t.finish();
  return card;
}

/// The objects' numbers by name, and their places in the file.
struct Names {
  std::map<std::string, std::size_t> numbers;

  [[nodiscard]] std::size_t find(const Table& t, const char* key, const std::string& name) const {
    const auto found = numbers.find(name);
    if (found != numbers.end()) return found->second;
    std::vector<std::string> all;
    for (const auto& [known, number] : numbers) all.push_back(known);
    t.fail(key, fmt::format("there is no object {}{}", in_quotes(name),
                            toml_reader::suggestion(name, all)));
  }
};

/// Checks that the parents of each object end, and their demands on the objects below them. Each
/// object is visited once.
class ParentCheck {
 public:
  explicit ParentCheck(const Scene& scene) : scene_(scene), chains_(scene.objects.size()) {}

  void check(std::size_t number, const Table& t) {
    follow(number, t);
    if (chains_[number].turned && shape_of(scene_.objects[number].shapes) == Shape::kAabb)
      t.fail(ErrorCode::kUsage, t.has("motion") ? "motion" : "parent",
             "an AABB cannot be rotated; use obb, or a motion without rotation");
  }

 private:
  /// An object and the objects that it follows.
  struct Chain {
    std::size_t length = 0;   ///< objects; 0: not known yet
    bool turned = false;      ///< whether one of them rotates
    bool on_the_way = false;  ///< met by this call of follow()
  };

  void follow(std::size_t number, const Table& t) {
    const auto& objects = scene_.objects;
    std::vector<std::size_t> way;
    Chain above;
    for (std::optional<std::size_t> at = number; at; at = objects[*at].parent) {
      if (!way.empty()) check_parent(objects[number], *at, t);
      above = chains_[*at];
      if (above.length != 0) break;
      chains_[*at].on_the_way = true;
      way.push_back(*at);
    }
    if (above.length + way.size() > kMostParents + 1)
      t.fail("parent", fmt::format("more than {} parents are above this object", kMostParents));
    for (; !way.empty(); way.pop_back()) {
      above.turned = above.turned || rotates(objects[way.back()].motion);
      ++above.length;
      chains_[way.back()] = above;
    }
  }

  void check_parent(const SceneObject& object, std::size_t number, const Table& t) const {
    const SceneObject& parent = scene_.objects[number];
    if (chains_[number].on_the_way)
      t.fail("parent", fmt::format("the parents of {} and {} form a cycle", in_quotes(object.name),
                                   in_quotes(parent.name)));
    if (has_member_poses(parent))
      t.fail(ErrorCode::kUsage, "parent",
             fmt::format("every shape of {} moves on its own, so no object can follow it",
                         in_quotes(parent.name)));
  }

  const Scene& scene_;
  std::vector<Chain> chains_;  ///< by object
};

void read_objects(Scene& scene, Tables tables, const std::filesystem::path& folder, Names& names) {
  std::vector<std::string> parents;
  scene_parts::Memory memory;
  scene_parts::Meshes meshes;
  for (Table& t : tables) {
    SceneObject object = scene_parts::read_object(t, folder, memory, meshes, scene.card.format);
    parents.push_back(t.text("parent", ""));
    t.finish();
    if (!names.numbers.emplace(object.name, scene.objects.size()).second)
      t.fail("name", "another object has that name");
    for (const std::string& warning : object.warnings)
      scene.warnings.push_back(fmt::format("object '{}': {}", object.name, warning));
    scene.objects.push_back(std::move(object));
  }
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (tables[i].has("parent"))
      scene.objects[i].parent = names.find(tables[i], "parent", parents[i]);
  ParentCheck parent_check(scene);
  for (std::size_t i = 0; i < parents.size(); ++i) parent_check.check(i, tables[i]);
}

/// The shape that all these objects share.
Shape common_shape(const Scene& scene, const std::vector<std::size_t>& objects, const Table& t,
                   const char* key) {
  const SceneObject& first = scene.objects[objects.front()];
  for (const std::size_t number : objects) {
    const SceneObject& object = scene.objects[number];
    if (object.shapes.index() != first.shapes.index())
      t.fail(ErrorCode::kUsage, key,
             fmt::format("{} holds {}s and {} {}s; a query takes one shape on each side",
                         in_quotes(first.name), name(shape_of(first.shapes)),
                         in_quotes(object.name), name(shape_of(object.shapes))));
  }
  return shape_of(first.shapes);
}

std::vector<std::size_t> read_group(const Names& names, Table& t, const char* key) {
  std::vector<std::size_t> group;
  std::set<std::size_t> known;
  for (const std::string& name : t.texts(key)) {
    const std::size_t number = names.find(t, key, name);
    if (!known.insert(number).second) t.fail(key, fmt::format("names {} twice", in_quotes(name)));
    group.push_back(number);
  }
  return group;
}

void check_name(const Table& t, const std::string& name) {
  constexpr std::string_view kLegal =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  if (name.empty() || name.size() > 64 || name.find_first_not_of(kLegal) != std::string::npos)
    t.fail("name",
           fmt::format("{} becomes part of file names; expected 1 to 64 letters, digits, _ and -",
                       in_quotes(name)));
}

/// `closed`: objects that earlier queries have checked.
void check_inside(const Scene& scene, const SceneQuery& q, Shape primary, Shape secondary,
                  std::set<std::size_t>& closed, const Table& t) {
  if (primary == Shape::kPlane || secondary != Shape::kTriangle)
    t.fail(ErrorCode::kUsage, "inside",
           fmt::format("needs secondaries that are closed meshes and primaries that have a middle, "
                       "but the primaries are {}s and the secondaries {}s",
                       name(primary), name(secondary)));
  SceneQuery fresh = q;
  std::erase_if(fresh.secondaries, [&](std::size_t number) { return closed.contains(number); });
  try {
    SceneInside{scene, fresh};
    closed.insert(fresh.secondaries.begin(), fresh.secondaries.end());
  } catch (const Error& e) {
    t.fail(e.code(), "inside", e.what());
  }
}

SceneQuery read_query(const Scene& scene, const Names& names, std::set<std::size_t>& closed,
                      Table& t) {
  SceneQuery q;
  q.name = t.text("name");
  check_name(t, q.name);
  t = t.named(fmt::format("query '{}'", q.name));
  q.pair = read_pair(t, "pair", t.text("pair"));
  q.primaries = read_group(names, t, "primaries");
  q.secondaries = read_group(names, t, "secondaries");
  const Shape primary = common_shape(scene, q.primaries, t, "primaries");
  const Shape secondary = common_shape(scene, q.secondaries, t, "secondaries");
  if (primary == primary_shape(q.pair) && secondary == secondary_shape(q.pair)) {
    q.swap = false;
  } else if (primary == secondary_shape(q.pair) && secondary == primary_shape(q.pair)) {
    q.swap = true;
  } else {
    t.fail(ErrorCode::kUsage, "pair",
           fmt::format("{} takes {}s and {}s, but the primaries are {}s and the secondaries {}s",
                       name(q.pair), name(primary_shape(q.pair)), name(secondary_shape(q.pair)),
                       name(primary), name(secondary)));
  }
  q.mode = *mode_named(kModes[t.choice("mode", kModes, 0)]);
  q.normals = t.flag("normals", false);
  q.self = t.flag("self", false);
  q.inside = t.flag("inside", false);
  if (q.inside) check_inside(scene, q, primary, secondary, closed, t);
  if (q.normals && !is_solid(q.pair)) t.fail(ErrorCode::kUsage, "normals", "rays have no normals");
  if (auto iterations = t.table("iterations")) {
    if (!has_iterations(q.pair))
      t.fail(
          ErrorCode::kUsage, "iterations",
          fmt::format(
              "{} has no iterations; expected cylinder-cylinder, obb-cylinder or triangle-cylinder",
              name(q.pair)));
    q.iterations.samples = iterations->integer<unsigned>("samples", q.iterations.samples, 4, 16);
    q.iterations.circle =
        iterations->integer<unsigned>("circle", q.iterations.circle, 0, card::kIterationsMost);
    q.iterations.free =
        iterations->integer<unsigned>("free", q.iterations.free, 0, card::kIterationsMost);
    iterations->finish();
    try {
      q.iterations.check();
    } catch (const Error& e) {
      t.fail("iterations", e.what());
    }
  }
  std::size_t primaries = 0;
  for (const std::size_t number : q.primaries) primaries += size(scene.objects[number].shapes);
  q.mask = t.number_ranges("mask", static_cast<std::int64_t>(primaries) - 1);
  if (count(q.mask) == primaries) t.fail(ErrorCode::kUsage, "mask", "leaves out every primary");
  const std::uint64_t packets = (primaries + card::kMostPrimaries - 1) / card::kMostPrimaries;
  const auto most = t.integer<std::uint64_t>("packets", packets, 1, 1 << 24);
  if (packets > most)
    t.fail(ErrorCode::kUsage, "packets",
           fmt::format("{} primaries overflow {} packet{} of {} and need {} packets", primaries,
                       most, most == 1 ? "" : "s", card::kMostPrimaries, packets));
  t.finish();
  return q;
}

/// Warns of objects that no query uses and that no used object moves with: perhaps a name is
/// missing.
void warn_of_unused(Scene& scene) {
  std::vector<bool> used(scene.objects.size());
  for (const SceneQuery& query : scene.queries)
    for (const auto* side : {&query.primaries, &query.secondaries})
      for (const std::size_t number : *side)
        for (std::optional<std::size_t> at = number; at && !used[*at];
             at = scene.objects[*at].parent)
          used[*at] = true;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      scene.warnings.push_back(fmt::format("{}: no query uses object {}",
                                           printable_name(scene.file),
                                           in_quotes(scene.objects[i].name)));
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& name) {
  const auto document = toml_reader::parse(text, name);
  const std::filesystem::path folder = std::filesystem::path(name).parent_path();
  Table t(name, *document, "");
  Scene scene;
  scene.file = name;
  scene.digest = sha256(text);
  scene.title = t.text("title", "");
  scene.frames = t.integer<std::uint32_t>("frames", 1, 1, 1'000'000);
  scene.rate = t.number("rate", 30.0, {.min = 1e-6, .max = 1e6});
  scene.check = static_cast<Check>(t.choice("check", {"all", "sample", "none"}, 0));
  if (auto report = t.table("report")) {
    scene.results =
        static_cast<Results>(report->choice("results", {"none", "csv", "binary", "npy"}, 1));
    scene.bits = report->flag("bits", false);
    scene.only_hits = report->flag("only_hits", false);
    report->finish();
  }
  if (auto card = t.table("card")) scene.card = read_card(*card);
  t.also_known({"object", "query"});
  for (const char* key : {"object", "query"}) {
    if (!t.has(key)) {
      t.finish();  // a misspelt key gets its own message
      t.fail(ErrorCode::kFile, "", fmt::format("there is no [[{}]]", key));
    }
  }
  Names names;
  read_objects(scene, t.tables("object"), folder, names);
  std::set<std::string> query_names;
  std::set<std::size_t> closed;
  for (Table& query : t.tables("query")) {
    scene.queries.push_back(read_query(scene, names, closed, query));
    if (!query_names.insert(scene.queries.back().name).second)
      query.fail("name", "another query has that name");
  }
  warn_of_unused(scene);
  t.finish();
  return scene;
}

Scene load_scene(const std::filesystem::path& path) {
  return parse_scene(file_io::read(path, nullptr, kMostBytes), path.string());
}

Scene load_named_scene(const std::filesystem::path& path) {
  return parse_scene(file_io::read_regular(path, kMostBytes), path.string());
}

}  // namespace cde
