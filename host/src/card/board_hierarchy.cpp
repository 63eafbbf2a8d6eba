// SPDX-License-Identifier: Apache-2.0
// A hierarchy in the card: into its memory, and whether a query can take it.
#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "card/hierarchy_pass.hpp"
#include "cde/reference/pipes/ray_node.hpp"
#include "cde/reference/refit.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

void check_fits(const Board::Impl& card, const Hierarchy& hierarchy, std::uint64_t triangles) {
  if (card.node_units == 0)
    throw Error(ErrorCode::kUsage, "this card has no node units, and so no hierarchy");
  if (hierarchy.order().size() != triangles)
    throw Error(ErrorCode::kUsage, fmt::format("a hierarchy of {} secondaries over {} triangles",
                                               hierarchy.order().size(), triangles));
  if (hierarchy.nodes().size() > card.node_capacity || triangles > card.slot_capacity)
    throw Error(
        ErrorCode::kCapacity,
        fmt::format("a hierarchy of {} nodes and {} slots does not fit this card, which "
                    "has memory for {} and {}",
                    hierarchy.nodes().size(), triangles, card.node_capacity, card.slot_capacity));
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

}  // namespace

void Board::upload(const TriangleView& triangles, const Hierarchy& hierarchy, bool validate) {
  check_fits(idle_card(), hierarchy, triangles.size());
  upload(triangles, validate);
  upload(hierarchy);
}

void Board::upload(const Hierarchy& hierarchy) {
  Impl& it = idle_card();
  it.link->alive();
  if (it.secondaries == 0 || it.secondary_shape != Shape::kTriangle)
    throw Error(ErrorCode::kUsage, "a hierarchy is of triangles that were uploaded");
  check_fits(it, hierarchy, it.secondaries);
  const std::uint64_t start = clocks();
  it.write_hierarchy(hierarchy);
  it.upload_clocks += clocks() - start;
}

void Board::Impl::write_hierarchy(const Hierarchy& tree) {
  hierarchy = {};
  constexpr std::size_t kChunk = 4096;
  constexpr unsigned kFront = 16;  // words of a node that lie together, the others behind all
  const auto nodes = tree.nodes();
  std::vector<std::uint32_t> front, rest;
  for (std::size_t first = 0; first < nodes.size(); first += kChunk) {
    front.clear();
    rest.clear();
    for (const hierarchy::Node& node :
         nodes.subspan(first, std::min(kChunk, nodes.size() - first))) {
      front.insert(front.end(), node.words.begin(), node.words.begin() + kFront);
      rest.insert(rest.end(), node.words.begin() + kFront, node.words.end());
    }
    write(card::kSpaceNodes, static_cast<std::uint32_t>(4 * kFront * first), front.data(),
          front.size() / 2);
    write(card::kSpaceNodes,
          static_cast<std::uint32_t>(4 * kFront * std::uint64_t{node_capacity} + 8 * first),
          rest.data(), rest.size() / 2);
  }
  const auto order = tree.order();
  for (std::size_t first = 0; first < order.size(); first += 16 * kChunk) {
    const auto some = order.subspan(first, std::min(16 * kChunk, order.size() - first));
    front.assign(some.begin(), some.end());
    if (front.size() % 2 != 0) front.push_back(0);
    write(card::kSpaceSlots, static_cast<std::uint32_t>(4 * first), front.data(), front.size() / 2);
  }
  check_bus("the upload of a hierarchy");
  hierarchy.root = root_words(tree.box());
  hierarchy.nodes = static_cast<std::uint32_t>(nodes.size());
}

void Board::Impl::configure_hierarchy() {
  if (objects.entries != 0) write_register(card::kRegObjectCount, 0);
  write_register(card::kRegSecFirst, 0);
  write_register(card::kRegSecCount, secondaries);
  write_register(card::kRegNodeCount, hierarchy.nodes);
  for (unsigned k = 0; k < 4; ++k)
    write_register(card::kRegRoot + 8 * k,
                   hierarchy.root[2 * k] | std::uint64_t{hierarchy.root[2 * k + 1]} << 32);
}

Counters Board::refit() {
  Impl& it = idle_card();
  it.link->alive();
  if (it.hierarchy.nodes == 0)
    throw Error(ErrorCode::kUsage, "no hierarchy was uploaded to the board");
  Query query;
  query.pair = Pair::kRayTriangle;
  it.hierarchy.stale = true;
  const Counters counters = RefitPass(it, query).execute();
  hierarchy::Node root;
  for (unsigned k = 0; k < hierarchy::Node::kWords / 2; ++k) {
    const std::uint64_t words = it.read_register(card::kRegNewRoot + 8 * k);
    root.words[2 * k] = static_cast<std::uint32_t>(words);
    root.words[2 * k + 1] = static_cast<std::uint32_t>(words >> 32);
  }
  it.hierarchy.root = root_words(reference::box_of(root));
  it.hierarchy.stale = false;
  return counters;
}

std::optional<std::string> Board::Impl::no_way_through(const Query& q) const {
  (void)name_of(q.mode);  // or it is none
  if (node_units == 0) return "the card has no node units";
  if (hierarchy.nodes == 0) return "no hierarchy was uploaded";
  if (hierarchy.stale) return "secondaries were uploaded anew, and no hierarchy of them";
  if (q.mode == Mode::kAll) return "mode all has records of all secondaries, hit or not";
  if (q.pair.value_or(Pair::kRayTriangle) != Pair::kRayTriangle || q.swap)
    return "it is of rays with triangles";
  if (q.second) return "two pairs at a time sweep";
  if (q.normals) return "rays have no normals";
  if (q.first_secondary != 0 || q.secondary_count != 0) return "a range of secondaries is swept";
  if (!objects.objects.empty()) return "objects are swept";
  if (!primary_objects.objects.empty()) return "rays that move with objects sweep";
  return std::nullopt;
}

std::optional<std::string> Board::no_way_through(const Query& query) const {
  return card().no_way_through(query);
}

}  // namespace cde
