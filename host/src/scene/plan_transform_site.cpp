// SPDX-License-Identifier: Apache-2.0
#include "scene/plan_transform_site.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "scene/self_pairs.hpp"

namespace cde::plan_transform_site {
namespace {

constexpr unsigned kMostEntries = 2048;  // limit of an object table

using Group = std::vector<std::size_t>;  // numbers of objects
using Side = Group SceneQuery::*;

/// All objects on this side of some query, ascending.
Group used(const Scene& scene, Side side) {
  Group all;
  for (const SceneQuery& q : scene.queries)
    all.insert(all.end(), (q.*side).begin(), (q.*side).end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

Group moving(const Scene& scene, const Group& objects) {
  Group some;
  for (const std::size_t i : objects)
    if (!is_still(scene, scene.objects[i])) some.push_back(i);
  return some;
}

std::uint64_t slot_words(const SceneObject& object) {
  return words(shape_of(object.shapes));
}

/// Entries of an object table: one, or one per shape if every shape moves on its own.
std::uint64_t entries(const SceneObject& object) {
  return has_member_poses(object) ? size(object.shapes) : 1;
}

/// Entries of a query with these secondaries. Objects that the card does not move have one entry
/// each.
std::uint64_t entries(const Scene& scene, const Group& objects, const std::vector<bool>& by_card) {
  std::uint64_t sum = 0;
  for (const std::size_t i : objects) sum += by_card[i] ? entries(scene.objects[i]) : 1;
  return sum;
}

std::string objects(std::uint64_t n) {
  return fmt::format("{} object{}", n, n == 1 ? "" : "s");
}

struct Sums {
  std::uint64_t host = 0, card = 0, chosen = 0;  ///< words per frame for the moving objects
  std::uint64_t entries = 0;                     ///< of all moving objects
};

Sums sums_of(const Scene& scene, const Group& moving, const std::vector<bool>& by_card) {
  Sums sums;
  for (const std::size_t i : moving) {
    const SceneObject& object = scene.objects[i];
    sums.host += words_per_frame(scene, object, false);
    sums.card += words_per_frame(scene, object, true);
    sums.chosen += words_per_frame(scene, object, by_card[i]);
    sums.entries += entries(object);
  }
  return sums;
}

/// Whether a query keeps one record per primary and leaves out pairs. Its passes then test ranges
/// of secondaries around the packet's own shapes, which card objects do not allow.
bool needs_range_passes(const Scene& scene) {
  return std::any_of(scene.queries.begin(), scene.queries.end(), [&](const SceneQuery& q) {
    return q.mode != Mode::kAll && q.mode != Mode::kHits && SelfPairs(scene, q).any();
  });
}

void choose_secondaries(const Scene& scene, bool resident, TransformSites& sites) {
  const Group move = moving(scene, used(scene, &SceneQuery::secondaries));
  const bool asked = scene.card.transform_site == TransformSite::kCard;
  std::vector<bool>& by_card = sites.secondaries;
  for (const std::size_t i : move)
    by_card[i] = asked || words_per_frame(scene, scene.objects[i], true) <
                              words_per_frame(scene, scene.objects[i], false);
  const bool cheaper = std::any_of(by_card.begin(), by_card.end(), [](bool b) { return b; });
  for (const SceneQuery& q : scene.queries) {
    const std::uint64_t n = entries(scene, q.secondaries, by_card);
    if (asked && n > kMostEntries)
      throw Error(
          ErrorCode::kUsage,
          fmt::format(
              "{}: card, transform_site = \"card\": query '{}' has {} among its secondaries "
              "(each shape that moves on its own counts as one), but a card's "
              "table holds {}; use transform_site = \"host\"",
              printable_name(scene.file), q.name, objects(n), kMostEntries));
    sites.entries = std::max(sites.entries,
                             static_cast<unsigned>(std::min<std::uint64_t>(n, kMostEntries + 1)));
  }
  Effect e{"transformer", false, "none", "", ""};
  if (move.empty()) {
    e.why = "no secondary moves as a rigid body";
    e.cost = simulation_text(e.name);
  } else if (scene.card.transform_site == TransformSite::kHost) {
    e.why = "transform_site = \"host\": the host poses moving shapes and uploads them again";
  } else if (asked) {
    e.why = "asked for: transform_site = \"card\"";
  } else if (scene.frames == 1) {
    e.why = "in a single frame everything is uploaded once";
  } else if (!resident) {
    e.why = "queries have different secondaries, which are uploaded again for each query";
  } else if (needs_range_passes(scene)) {
    e.why =
        "a query omits pairs of a shape with itself, which needs passes over ranges of secondaries";
  } else if (!cheaper) {
    e.why = "uploading the moving shapes again takes no more words";
  } else if (sites.entries > kMostEntries) {
    e.why = fmt::format("more objects than the {} of a card's table", kMostEntries);
  } else {
    e.why = "moving an object takes 12 words";
    e.used = true;
  }
  e.used = e.used || (asked && !move.empty());
  if (!e.used) by_card.assign(by_card.size(), false);
  const Sums sums = sums_of(scene, move, by_card);
  if (e.used) {
    e.choice = "secondaries";
    e.cost = fmt::format("{} words per frame; the host would upload {}", sums.chosen, sums.host);
  } else if (!move.empty()) {
    e.cost = fmt::format("uploads {} words per frame; a transformer would take {} for {}",
                         sums.host, sums.card, objects(sums.entries));
  }
  sites.effects.push_back(e);
}

/// Why primaries do not stay in the register file between frames; empty if they do.
std::string against_staying(const Scene& scene) {
  const Group& all = scene.queries.front().primaries;
  std::uint64_t count = 0;
  for (const std::size_t i : all) count += size(scene.objects[i].shapes);
  for (const SceneQuery& q : scene.queries)
    if (q.primaries != all) return "queries have different primaries, which are loaded for each";
  if (count > card::kMostPrimaries) return "they are loaded packet by packet";
  for (const std::size_t i : all)
    if (!deforming(scene.objects[i]).empty()) return "they deform, so they differ in every frame";
  return "";
}

/// Why the card does not move primaries, at 12 words for each of `objects`; empty if it does.
std::string against_moving(const Scene& scene, std::uint64_t objects, std::uint64_t load) {
  const unsigned most = BoardConfig{}.primary_objects;
  if (objects == 0) return "no primary moves as a rigid body";
  if (scene.card.transform_site == TransformSite::kHost) return "transform_site = \"host\"";
  if (scene.frames == 1) return "in a single frame everything is loaded once";
  if (objects > most) return fmt::format("more objects than the {} of a card's table", most);
  if (12 * objects >= load) return "loading them again takes no more words";
  return "";
}

void choose_primaries(const Scene& scene, TransformSites& sites) {
  const Group move = moving(scene, used(scene, &SceneQuery::primaries));
  std::uint64_t load = 0, n = 0;
  for (const std::size_t i : scene.queries.front().primaries)
    load += size(scene.objects[i].shapes) * slot_words(scene.objects[i]);
  for (const std::size_t i : move) n += entries(scene.objects[i]);
  const std::string load_again = against_staying(scene);
  Effect e{"transformer of primaries", false, "none", "", ""};
  e.why = load_again.empty() ? against_moving(scene, n, load) : load_again;
  if (e.why.empty()) {
    e.used = true;
    e.choice = objects(n);
    e.why = "they stay in the register file";
    e.cost = fmt::format("{} words per frame; the host would load {}", 12 * n, load);
    for (const std::size_t i : move) sites.primaries[i] = true;
  }
  if (load_again.empty() && (e.used || n == 0)) sites.primary_words = 12 * n;
  if (!e.used) e.cost = sites.primary_words ? "0 words per frame" : "loaded in every pass";
  sites.effects.push_back(e);
}

}  // namespace

void leave_primaries(TransformSites& sites, const std::string& why) {
  sites.primaries.assign(sites.primaries.size(), false);
  sites.primary_words.reset();
  sites.effects.back() = {"transformer of primaries", false, "none", why, "written in every frame"};
}

std::uint64_t words_per_frame(const Scene& scene, const SceneObject& object, bool by_card) {
  std::uint64_t deformed = 0;
  for (const Range& range : deforming(object)) deformed += range.count;
  deformed *= slot_words(object);
  if (is_still(scene, object)) return deformed;
  return by_card ? deformed + 12 * entries(object) : size(object.shapes) * slot_words(object);
}

TransformSites choose(const Scene& scene, bool resident) {
  TransformSites sites;
  sites.secondaries.assign(scene.objects.size(), false);
  sites.primaries = sites.secondaries;
  choose_secondaries(scene, resident, sites);
  choose_primaries(scene, sites);
  return sites;
}

}  // namespace cde::plan_transform_site
