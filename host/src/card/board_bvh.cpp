// SPDX-License-Identifier: Apache-2.0
// Loads a BVH into the card, and decides whether a query can traverse it.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "card/bvh_pass.hpp"
#include "cde/reference/pipes/root_bounds.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "cde/reference/refit.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

/// Whether a BVH over this shape can be traversed.
bool is_leaf(Shape shape) {
  for (unsigned p = 0; p < kPairs; ++p)
    for (const bool swap : {false, true}) {
      const auto shapes = traversal_shapes(static_cast<Pair>(p), swap);
      if (shapes && shapes->secondary == shape) return true;
    }
  return false;
}

void check_fits(const Board::Impl& card, const Bvh& bvh, std::uint64_t secondaries, Shape shape) {
  const std::uint64_t in_memory = secondaries;
  if (card.traversal_units == 0)
    throw Error(ErrorCode::kUsage, "this card has no traversal units, and so no BVH");
  const std::vector<Object>& objects = card.objects.objects;
  if (!objects.empty()) secondaries = card.tested_secondaries({});
  if (bvh.order().size() != secondaries)
    throw Error(
        ErrorCode::kUsage,
        fmt::format("a BVH of {} secondaries does not match {}{}", bvh.order().size(),
                    counted(secondaries, name(shape)), objects.empty() ? "" : " of objects"));
  const auto parts = bvh.parts();
  if (!parts.empty() && !std::equal(parts.begin(), parts.end(), objects.begin(), objects.end(),
                                    [](const Bvh::Part& part, const Object& object) {
                                      return part.secondaries == object.count;
                                    }))
    throw Error(ErrorCode::kUsage,
                fmt::format("a BVH of {} objects does not match the {} objects of the card",
                            parts.size(), objects.size()));
  if (bvh.nodes().size() > card.node_capacity || secondaries > card.slot_capacity)
    throw Error(
        ErrorCode::kCapacity,
        fmt::format(
            "a BVH of {} nodes and {} slots does not fit this card, which has memory for {} and {}",
            bvh.nodes().size(), secondaries, card.node_capacity, card.slot_capacity));
  if (!card.node_cache) return;
  // With a node cache they share DDR with the shapes. A slot has an index, and with objects
  // another.
  const std::uint64_t slot_bytes = 4 * (secondaries + 2) * (card.objects.entries == 0 ? 1 : 2),
                      node_bytes = 4 * bvh::Node::kWords * (bvh.nodes().size() + 1);
  const std::uint64_t shapes = 4 * std::uint64_t{words(shape)} * in_memory;
  if (shapes + slot_bytes + node_bytes > card.capacity)
    throw Error(ErrorCode::kCapacity,
                fmt::format("{} of {} bytes and a BVH of {} bytes do not fit the card's DDR, which "
                            "holds {}",
                            counted(in_memory, name(shape)), shapes, slot_bytes + node_bytes,
                            card.capacity));
}

std::array<std::uint32_t, 8> root_words(const Eigen::AlignedBox3f& box) {
  const auto root = reference::root_bounds<float>(box.min(), box.max());
  std::array<std::uint32_t, 8> words{};
  for (int k = 0; k < 3; ++k) {
    words.at(static_cast<unsigned>(k)) = std::bit_cast<std::uint32_t>(root.lower[k]);
    words.at(static_cast<unsigned>(3 + k)) = std::bit_cast<std::uint32_t>(root.upper[k]);
  }
  words[6] = std::bit_cast<std::uint32_t>(root.margin);
  return words;
}

/// A secondary and its object.
struct Place {
  std::uint32_t index, object;
};
std::vector<Place> places_of(const std::vector<Object>& objects) {
  std::vector<Place> places;
  for (std::uint32_t k = 0; k < objects.size(); ++k)
    for (std::uint32_t i = 0; i < objects[k].count; ++i)
      places.push_back({objects[k].first + i, k});
  return places;
}

/// Nodes that take less time to skip than another pass takes.
constexpr std::uint32_t kNodesOfAPass = 256;

/// Ranges [first, end) of nodes that need a refit, last range first: nodes of moved objects and all
/// nodes above objects.
std::vector<std::array<std::uint32_t, 2>> outdated(const LoadedBvh& bvh) {
  if (bvh.parts.empty() || bvh.moved.size() != bvh.parts.size()) return {{0, bvh.nodes}};
  std::vector<std::array<std::uint32_t, 2>> ranges = {{0, bvh.parts.front().first_node}};
  for (std::size_t k = 0; k < bvh.parts.size(); ++k) {
    const Bvh::Part& part = bvh.parts[k];
    if (!bvh.moved[k] || part.nodes == 0) continue;
    if (part.first_node - ranges.back()[1] <= kNodesOfAPass)
      ranges.back()[1] = part.first_node + part.nodes;
    else
      ranges.push_back({part.first_node, part.first_node + part.nodes});
  }
  std::reverse(ranges.begin(), ranges.end());
  return ranges;
}

}  // namespace

void Board::upload(const TriangleView& triangles, const Bvh& bvh, bool validate) {
  check_fits(idle_card(), bvh, triangles.size(), Shape::kTriangle);
  upload(triangles, validate);
  upload(bvh);
}

template <class P>
void Board::upload_with(std::span<const P> shapes, const Bvh& bvh, bool validate) {
  check_fits(idle_card(), bvh, shapes.size(), kShapeOf<P>);
  upload_shapes(shapes, validate);
  upload(bvh);
}
void Board::upload(std::span<const Sphere> spheres, const Bvh& bvh, bool validate) {
  upload_with(spheres, bvh, validate);
}
void Board::upload(std::span<const Aabb> boxes, const Bvh& bvh, bool validate) {
  upload_with(boxes, bvh, validate);
}
void Board::upload(std::span<const Obb> boxes, const Bvh& bvh, bool validate) {
  upload_with(boxes, bvh, validate);
}

void Board::upload(const Bvh& bvh) {
  Impl& it = idle_card();
  it.link->alive();
  if (it.secondaries == 0 || !is_leaf(it.secondary_shape))
    throw Error(ErrorCode::kUsage, "a BVH needs uploaded triangles, spheres, AABBs or OBBs");
  check_fits(it, bvh, it.secondaries, it.secondary_shape);
  const std::uint64_t start = cycles();
  it.write_bvh(bvh);
  it.upload_cycles += cycles() - start;
}

void Board::Impl::place_in_ddr(std::uint64_t node_count, std::uint64_t slot_count) {
  constexpr std::uint64_t kWords = bvh::Node::kWords;
  // A leaf with one slot reads another word, whose check bits must be right.
  const std::uint64_t even = (slot_count + 2) / 2 * 2;
  const std::uint64_t nodes_at = (capacity / 4 - kWords * node_count) / kWords * kWords;
  bvh.node_base = static_cast<std::uint32_t>(nodes_at);
  bvh.slot_base = static_cast<std::uint32_t>(nodes_at - even);
  bvh.object_base =
      objects.entries == 0 ? bvh.slot_base : static_cast<std::uint32_t>(nodes_at - 2 * even);
}

void Board::Impl::write_chip_nodes(std::span<const bvh::Node> nodes) {
  constexpr std::size_t kChunk = 4096;
  constexpr unsigned kFront = 16;  // leading words of a node; the rest is behind all nodes
  std::vector<std::uint32_t> front, rest;
  for (std::size_t first = 0; first < nodes.size(); first += kChunk) {
    front.clear();
    rest.clear();
    for (const bvh::Node& node : nodes.subspan(first, std::min(kChunk, nodes.size() - first))) {
      front.insert(front.end(), node.words.begin(), node.words.begin() + kFront);
      rest.insert(rest.end(), node.words.begin() + kFront, node.words.end());
    }
    write(card::kSpaceNodes, static_cast<std::uint32_t>(4 * kFront * first), front.data(),
          front.size() / 2);
    write(card::kSpaceNodes,
          static_cast<std::uint32_t>(4 * kFront * std::uint64_t{chip_nodes} + 8 * first),
          rest.data(), rest.size() / 2);
  }
}

void Board::Impl::write_ddr_nodes(std::span<const bvh::Node> nodes) {
  constexpr std::size_t kChunk = 4096;
  std::vector<std::uint32_t> words;
  for (std::size_t first = chip_nodes; first < nodes.size(); first += kChunk) {
    words.clear();
    for (const bvh::Node& node : nodes.subspan(first, std::min(kChunk, nodes.size() - first)))
      words.insert(words.end(), node.words.begin(), node.words.end());
    write(card::kSpaceDdr,
          static_cast<std::uint32_t>(4 * (bvh.node_base + bvh::Node::kWords * first)), words.data(),
          words.size() / 2);
  }
}

void Board::Impl::write_bvh(const Bvh& source) {
  for (std::size_t i = 0; i < objects.objects.size(); ++i)
    check_object(objects, i, objects.objects[i]);
  bvh = {};
  const auto nodes = source.nodes();
  const std::uint64_t shape_words = words_uploaded;
  write_chip_nodes(nodes.first(std::min<std::size_t>(nodes.size(), chip_nodes)));
  card::Space space = card::kSpaceSlots;
  std::uint64_t slots_at = 0, objects_at = 4 * slot_capacity;
  if (node_cache) {
    place_in_ddr(nodes.size(), source.order().size());
    write_ddr_nodes(nodes);
    space = card::kSpaceDdr;
    slots_at = 4 * std::uint64_t{bvh.slot_base};
    objects_at = 4 * std::uint64_t{bvh.object_base};
  }
  const std::vector<Place> places = places_of(objects.objects);
  write_slots_of(source.order(), space, slots_at,
                 [&](std::uint32_t at) { return places.empty() ? at : places[at].index; });
  if (!places.empty())
    write_slots_of(source.order(), space, objects_at,
                   [&](std::uint32_t at) { return places[at].object; });
  words_uploaded = shape_words;
  check_bus("the upload of a BVH");
  for (const Object& object : objects.objects) {
    bvh.firsts.push_back(object.first);
    bvh.counts.push_back(object.count);
  }
  bvh.parts.assign(source.parts().begin(), source.parts().end());
  bvh.root = root_words(source.box());
  bvh.slots = static_cast<std::uint32_t>(source.order().size());
  bvh.nodes = static_cast<std::uint32_t>(nodes.size());
}

void Board::Impl::write_slots_of(std::span<const std::uint32_t> order, card::Space space,
                                 std::uint64_t byte,
                                 const std::function<std::uint32_t(std::uint32_t)>& word) {
  constexpr std::size_t kChunk = 65'536;
  std::vector<std::uint32_t> words;
  for (std::size_t first = 0; first < order.size(); first += kChunk) {
    const auto some = order.subspan(first, std::min(kChunk, order.size() - first));
    words.clear();
    std::transform(some.begin(), some.end(), std::back_inserter(words), word);
    if (space == card::kSpaceDdr) words.push_back(0);  // place_in_ddr()
    if (words.size() % 2 != 0) words.push_back(0);
    write(space, static_cast<std::uint32_t>(byte + 4 * first), words.data(), words.size() / 2);
  }
}

void Board::Impl::outdate_bvh(std::uint64_t first, std::uint64_t count) {
  if (count == 0) return;
  bvh.moved.resize(bvh.parts.size());
  bvh.stale = true;
  for (std::size_t k = 0; k < bvh.parts.size(); ++k)
    if (first < std::uint64_t{bvh.firsts[k]} + bvh.counts[k] && bvh.firsts[k] < first + count)
      bvh.moved[k] = true;
}

void Board::Impl::outdate_bvh(std::size_t object) {
  bvh.moved.resize(bvh.parts.size());
  bvh.stale = true;
  if (object < bvh.moved.size()) bvh.moved[object] = true;
}

void Board::Impl::configure_bvh(std::uint32_t first, std::uint32_t end) {
  if (objects.entries != 0) write_register(card::kRegObjectCount, objects.objects.size());
  if (primary_objects.entries != 0) write_register(card::kRegPrimObjectCount, 0);
  write_register(card::kRegSecFirst, 0);
  write_register(card::kRegSecCount, secondaries);
  write_register(card::kRegSlotCount, bvh.slots);
  if (node_cache) {
    write_register(card::kRegNodeBase, bvh.node_base);
    write_register(card::kRegSlotBase,
                   card::kSlotBaseSlots(bvh.slot_base) | card::kSlotBaseObjects(bvh.object_base));
  }
  write_register(card::kRegNodeFirst, first);
  write_register(card::kRegNodeCount, end);
  for (unsigned k = 0; k < 4; ++k)
    write_register(card::kRegRoot + 8 * k,
                   bvh.root[2 * k] | std::uint64_t{bvh.root[2 * k + 1]} << 32);
}

bool Board::refits() const {
  return card().node_cache == 0;
}

Counters Board::refit() {
  Impl& it = idle_card();
  it.link->alive();
  if (it.bvh.nodes == 0) throw Error(ErrorCode::kUsage, "no BVH was uploaded to the board");
  if (it.secondary_shape != Shape::kTriangle)
    throw Error(ErrorCode::kUsage, fmt::format("the card refits a BVH over triangles only; for {}s "
                                               "call Bvh::refit() and upload the result",
                                               name(it.secondary_shape)));
  if (!refits())
    throw Error(ErrorCode::kUsage,
                "the card has a node cache and does not refit; call Bvh::refit() and upload the "
                "result");
  if (const auto why = it.why_objects_not_traversable()) throw Error(ErrorCode::kUsage, *why);
  Query query;
  query.pair = Pair::kRayTriangle;
  it.prepare_objects();
  const auto ranges = it.bvh.stale ? outdated(it.bvh) : std::vector{std::array{0u, it.bvh.nodes}};
  it.bvh.stale = true;
  Counters counters;
  for (const auto& [first, end] : ranges) counters += RefitPass(it, query).execute(first, end);
  bvh::Node root;
  for (unsigned k = 0; k < bvh::Node::kWords / 2; ++k) {
    const std::uint64_t words = it.read_register(card::kRegNewRoot + 8 * k);
    root.words[2 * k] = static_cast<std::uint32_t>(words);
    root.words[2 * k + 1] = static_cast<std::uint32_t>(words >> 32);
  }
  it.bvh.root = root_words(reference::box_of(root));
  it.bvh.stale = false;
  it.bvh.moved.clear();
  return counters;
}

/// Checks the card's current objects against the BVH.
std::optional<std::string> Board::Impl::why_objects_not_traversable() const {
  const auto& all = objects.objects;
  if (bvh.firsts.size() != all.size()) {
    return all.empty() ? "the BVH is over objects, and the card has no objects now"
                       : "the BVH is not over the card's objects";
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].first != bvh.firsts[k] || all[k].count != bvh.counts[k])
      return fmt::format("object {} of the BVH differs from the card's", k);
    // For equal T a brute-force pass keeps the first pair it tests, and traversal keeps the lowest
    // index. Ascending objects make these the same.
    if (k > 0 && all[k].first < std::uint64_t{all[k - 1].first} + all[k - 1].count)
      return fmt::format("object {} overlaps or precedes object {}", k, k - 1);
  }
  return std::nullopt;
}

std::optional<std::string> Board::Impl::why_not_traversable(const Query& q) const {
  (void)name_of(q.mode);  // throws for an unknown mode
  if (traversal_units == 0) return "the card has no traversal units";
  if (bvh.nodes == 0) return "no BVH was uploaded";
  if (auto why = why_objects_not_traversable()) return why;
  if (bvh.stale)
    return objects.objects.empty()
               ? "secondaries were uploaded or moved after their BVH; upload a new BVH"
           : secondary_shape == Shape::kTriangle
               ? "objects or their triangles have moved since the last refit(); call refit()"
               : "objects or their shapes have moved after the upload of their BVH; upload a new "
                 "BVH";
  if (q.mode == Mode::kAll) return "mode all reports every secondary, hit or not";
  const Pair pair = q.pair.value_or(pairs.front());
  if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end())
    return fmt::format("the card has no pipe for {}", name(pair));
  const auto shapes = traversal_shapes(pair, q.swap);
  if (!shapes)
    return fmt::format("{}{} cannot traverse a BVH", name(pair),
                       q.swap ? " with its roles swapped" : "");
  if (q.swap && !can_swap) return "the card cannot exchange primaries and secondaries";
  if (shapes->secondary != secondary_shape)
    return fmt::format("the BVH is over {}s", name(secondary_shape));
  if (has_filter(pair) && filter) return "pairs with the certified filter use brute force";
  if (has_box_rule(pair) && !box) return "the card has no box rule";
  if (is_solid(pair) && q.mode == Mode::kFarthest)
    return "no box can be culled in a search for the farthest shape from a solid";
  if (q.second) return "two pairs at a time use brute force";
  if (q.normals && !is_solid(pair)) return "rays have no normals";
  if (q.normals && !has_normals) return "the card has no normals";
  if (q.first_secondary != 0 || q.secondary_count != 0)
    return "a range of secondaries uses brute force";
  if (!primary_objects.objects.empty()) return "primaries that move with objects use brute force";
  return std::nullopt;
}

std::optional<std::string> Board::why_not_traversable(const Query& query) const {
  return card().why_not_traversable(query);
}

namespace {

template <class Shapes>
Bvh bvh_of_any(const Shapes& shapes, std::span<const Object> objects, const BvhOptions& options) {
  if (objects.empty()) throw Error(ErrorCode::kUsage, "a BVH needs at least one object");
  std::vector<std::uint32_t> counts;
  for (const Object& object : objects) {
    if (object.count == 0 || std::uint64_t{object.first} + object.count > shapes.size())
      throw Error(
          ErrorCode::kUsage,
          fmt::format(
              "object {}: {} secondaries from {} on; expected 1 or more, within the {} secondaries",
              counts.size(), object.count, object.first, shapes.size()));
    if (const auto why = defect(object.transform))
      throw Error(ErrorCode::kBadInput, fmt::format("object {}: {}", counts.size(), *why));
    if constexpr (std::is_same_v<Shapes, std::span<const Aabb>>)
      if (object.transform.rotation != Eigen::Matrix3f::Identity())
        throw Error(ErrorCode::kUsage,
                    fmt::format("object {}: AABBs cannot be rotated", counts.size()));
    counts.push_back(object.count);
  }
  const auto moved = reference::pass_secondaries(shapes, objects).shapes;
  return Bvh::build(std::span(moved), counts, options);
}

}  // namespace

Bvh bvh_of(const TriangleView& triangles, std::span<const Object> objects,
           const BvhOptions& options) {
  return bvh_of_any(triangles, objects, options);
}

Bvh bvh_of(std::span<const Sphere> spheres, std::span<const Object> objects,
           const BvhOptions& options) {
  return bvh_of_any(spheres, objects, options);
}
Bvh bvh_of(std::span<const Aabb> boxes, std::span<const Object> objects,
           const BvhOptions& options) {
  return bvh_of_any(boxes, objects, options);
}
Bvh bvh_of(std::span<const Obb> boxes, std::span<const Object> objects, const BvhOptions& options) {
  return bvh_of_any(boxes, objects, options);
}

}  // namespace cde
