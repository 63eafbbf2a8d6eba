// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_runner_objects.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "cde/geometry/rounded.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"

namespace cde::scene_runner {
namespace {

bool same_bits(const Transform& a, const Transform& b) {
  using Bits = std::array<std::uint32_t, Transform::kWords>;
  return std::bit_cast<Bits>(to_words(a)) == std::bit_cast<Bits>(to_words(b));
}

/// An empty list of the same shape.
Shapes cleared(const Shapes& shapes) {
  return std::visit([](const auto& list) -> Shapes { return std::decay_t<decltype(list)>(); },
                    shapes);
}

/// Copies the shapes of `range` into another list, moved up by `base` and rounded to a format.
void copy(const Shapes& from, const Range& range, Shapes& to, std::size_t base,
          FpFormat format = {}) {
  std::visit(
      [&](const auto& own) {
        auto& all = std::get<std::decay_t<decltype(own)>>(to);
        all.resize(std::max(all.size(), base + range.first + range.count));
        for (std::size_t i = range.first; i < range.first + range.count; ++i)
          all[base + i] = rounded(own[i], format);
      },
      from);
}

}  // namespace

ObjectState::ObjectState(const Scene& scene, const SceneObject& object, bool by_card)
    : scene_(&scene),
      object_(&object),
      by_card_(by_card),
      still_(is_still(scene, object)),
      deforming_(deforming(object)) {}

void ObjectState::show(std::uint32_t frame) {
  changed_.clear();
  if (frame_ == frame) return;
  const bool first = !frame_.has_value();
  frame_ = frame;
  if (!first && still_ && deforming_.empty()) return;
  const bool each = has_member_poses(*object_);
  std::vector<Transform> poses = each ? member_poses(*scene_, *object_, frame)
                                      : std::vector<Transform>{pose(*scene_, *object_, frame)};
  shapes_ = local_shapes(*scene_, *object_, frame);
  if (by_card_)
    transforms_ = std::move(poses);
  else
    shapes_ = each ? posed(shapes_, poses) : posed(shapes_, poses.front());
  changed_ = deforming_;
  if (first || (!still_ && !by_card_)) changed_ = {{0, size(shapes_)}};
}

ObjectState& Row::state(std::size_t number) {
  return states_.try_emplace(number, *scene_, scene_->objects[number], by_card_[number])
      .first->second;
}

/// Writes the changes of an object into the row, from place `base` on.
void Row::write(const ObjectState& object, std::size_t base, Change& change) {
  std::vector<Range> changed = object.changed();
  if (change.all) changed = {{0, size(object.shapes())}};
  for (const Range& range : changed) {
    copy(object.shapes(), range, shapes_, base, scene_->card.format);
    change.shapes.push_back({base + range.first, range.count});
  }
}

void Row::enter(const ObjectState& object, std::size_t base, std::vector<Object>& entries) const {
  if (table_ == Table::kMoved && !object.by_card()) return;
  const auto& transforms = object.transforms();
  const std::size_t each = size(object.shapes()) / transforms.size();
  for (std::size_t k = 0; k < transforms.size(); ++k)
    entries.push_back({static_cast<std::uint32_t>(base + k * each),
                       static_cast<std::uint32_t>(each),
                       rounded(transforms[k], scene_->card.format)});
}

/// Computes the placed shapes of an entry, as the card does.
void Row::place(const Object& entry) {
  std::visit(
      [&](const auto& written) {
        auto& moved = std::get<std::decay_t<decltype(written)>>(placed_);
        for (std::size_t i = entry.first; i < std::size_t{entry.first} + entry.count; ++i)
          moved[i] = reference::transformed_in(scene_->card.format, entry.transform, written[i]);
      },
      shapes_);
}

Row::Change Row::show(const std::vector<std::size_t>& objects, std::uint32_t frame) {
  Change change;
  change.all = objects != objects_;
  if (change.all) shapes_ = cleared(scene_->objects[objects.front()].shapes);
  objects_ = objects;
  bool moves = false;
  for (const std::size_t i : objects) moves = moves || by_card_[i];
  std::vector<Object> entries;
  std::size_t base = 0;
  for (const std::size_t i : objects) {
    ObjectState& object = state(i);
    object.show(frame);
    write(object, base, change);
    if (moves) enter(object, base, entries);
    base += size(object.shapes());
  }
  for (std::size_t k = 0; k < entries.size() && !change.all; ++k)
    if (!same_bits(entries_[k].transform, entries[k].transform)) change.entries.push_back(k);
  entries_ = std::move(entries);
  if (moves) place(change);
  return change;
}

void Row::place(const Change& change) {
  if (change.all) placed_ = shapes_;
  for (const Range& range : change.shapes) copy(shapes_, range, placed_, 0);
  auto moved = change.entries.begin();
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    const Object& e = entries_[k];
    const bool other = moved != change.entries.end() && *moved == k;
    if (other) ++moved;
    const bool written =
        std::any_of(change.shapes.begin(), change.shapes.end(), [&](const Range& range) {
          return range.first < std::size_t{e.first} + e.count &&
                 e.first < range.first + range.count;
        });
    if (other || written) place(e);
  }
}

Secondaries::Secondaries(Board& board, const Scene& scene, const Plan& plan)
    : board_(&board),
      has_table_(plan.board.transform != Transformer::kNone),
      has_bvh_(std::any_of(plan.queries.begin(), plan.queries.end(),
                           [](const QueryWork& w) { return w.bvh; })),
      scene_(&scene),
      by_card_(plan.card_moves),
      row_(scene, plan.card_moves, Table::kAll) {}

void Secondaries::show(const std::vector<std::size_t>& objects, std::uint32_t frame) {
  const Row::Change change = row_.show(objects, frame);
  try {
    write(change);
    if (has_bvh_) fit_bvh(change, objects);
  } catch (...) {
    row_.forget();  // the card's state is now unknown
    throw;
  }
}

void Secondaries::write(const Row::Change& change) {
  std::visit(
      [&](const auto& list) {
        const std::span all(list);
        if (change.all) return board_->upload_shapes(all, false);
        for (const Range& range : change.shapes)
          board_->update_shapes(range.first, all.subspan(range.first, range.count), false);
      },
      row_.shapes());
  if (change.all && has_table_) board_->set_objects(row_.entries());
  for (const std::size_t k : change.entries) board_->move_object(k, row_.entries()[k].transform);
}

/// The card refits boxes if all nodes are on chip. Otherwise the host does, and writes the nodes.
void Secondaries::refit() {
  if (board_->refits()) {
    board_->refit();
    return;
  }
  bvh_->refit(std::get<std::vector<Triangle>>(row_.placed()));
  board_->upload(*bvh_);
}

/// A BVH over triangles is built for the first frame, whichever frame is shown first. If something
/// moves, its boxes are refitted. A BVH over solids is built for each frame. So the reads of a
/// frame do not depend on earlier frames.
void Secondaries::fit_bvh(const Row::Change& change, const std::vector<std::size_t>& objects) {
  if (!change.all && change.shapes.empty() && change.entries.empty()) return;
  no_bvh_.reset();
  try {
    if (!std::holds_alternative<std::vector<Triangle>>(row_.placed())) {
      board_->upload(bvh_of_row(row_));
    } else if (change.all) {
      bvh_.reset();
      Row first(*scene_, by_card_, Table::kAll);
      (void)first.show(objects, 0);
      Bvh built = bvh_of_row(first);
      board_->upload(built);
      bvh_ = std::move(built);
      if (std::any_of(objects.begin(), objects.end(), [&](std::size_t i) {
            return !is_still(*scene_, scene_->objects[i]) || !deforming(scene_->objects[i]).empty();
          }))
        refit();
    } else if (bvh_) {
      refit();
    }
  } catch (const Error& e) {
    // Some secondaries exceed the range of boxes, or DDR has no room for the BVH: brute force.
    if (e.code() != ErrorCode::kBadInput && e.code() != ErrorCode::kCapacity) throw;
    no_bvh_ = e.what();
  }
}

Bvh bvh_of_row(const Row& row) {
  if (const auto* triangles = std::get_if<std::vector<Triangle>>(&row.shapes()))
    return row.entries().empty() ? Bvh::build(*triangles) : bvh_of(*triangles, row.entries());
  return std::visit(
      [](const auto& list) -> Bvh {
        using P = typename std::decay_t<decltype(list)>::value_type;
        if constexpr (reference::Solid<P>)
          return Bvh::build(list);
        else
          throw Error(ErrorCode::kUsage, "such shapes cannot be in a BVH");
      },
      row.placed());
}

Primaries::Primaries(Board& board, const Scene& scene, const Plan& plan)
    : board_(&board),
      has_table_(plan.board.transform == Transformer::kBoth),
      row_(scene, plan.card_moves_primaries, Table::kMoved) {}

void Primaries::show(const std::vector<std::size_t>& objects, std::uint32_t frame) {
  const Row::Change change = row_.show(objects, frame);
  if (change.all || !change.shapes.empty()) loaded_.reset();
  moved_.insert(moved_.end(), change.entries.begin(), change.entries.end());
}

void Primaries::load(std::size_t first, std::size_t count) {
  const bool there = loaded_ && loaded_->first == first && loaded_->count == count;
  loaded_.reset();  // until the load is complete
  if (!there) {
    std::visit(
        [&](const auto& list) {
          board_->load_shapes(std::span(list).subspan(first, count), false);
        },
        row_.shapes());
    if (has_table_) board_->set_primary_objects(row_.entries());
  } else {
    for (const std::size_t k : moved_) board_->move_primary_object(k, row_.entries()[k].transform);
  }
  moved_.clear();
  loaded_ = {first, count};
}

}  // namespace cde::scene_runner
