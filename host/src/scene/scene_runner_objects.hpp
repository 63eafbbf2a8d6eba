// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/scene/plan.hpp"
#include "cde/scene/scene.hpp"

/// Brings objects onto the card and moves them there. Private to the scene runner.
namespace cde::scene_runner {

/// An object of the scene in one frame. If the card moves it, its shapes are in its own frame and
/// have transforms for the card. Otherwise the host has posed them.
class ObjectState {
 public:
  ObjectState(const Scene& scene, const SceneObject& object, bool by_card);

  /// Frames may come in any order. The same frame again changes nothing.
  void show(std::uint32_t frame);

  [[nodiscard]] const Shapes& shapes() const { return shapes_; }
  /// The shapes that the last show() changed, ascending.
  [[nodiscard]] const std::vector<Range>& changed() const { return changed_; }
  /// One transform for all shapes, or one per shape.
  [[nodiscard]] const std::vector<Transform>& transforms() const { return transforms_; }
  [[nodiscard]] bool by_card() const { return by_card_; }

 private:
  const Scene* scene_;
  const SceneObject* object_;
  bool by_card_, still_;
  std::vector<Range> deforming_;
  Shapes shapes_;
  std::vector<Range> changed_;
  std::vector<Transform> transforms_ = {{}};
  std::optional<std::uint32_t> frame_;
};

/// What an object table must hold.
enum class Table {
  kMoved,  ///< only objects that the card moves
  kAll,    ///< every object, if the card moves any
};

/// The objects on one side of the card, one after the other, and the object table that moves them.
class Row {
 public:
  Row(const Scene& scene, const std::vector<bool>& by_card, Table table)
      : scene_(&scene), by_card_(by_card), table_(table) {}

  /// Differences from the frame shown before.
  struct Change {
    bool all = false;                  ///< all objects are new
    std::vector<Range> shapes;         ///< changed shapes, ascending; unused if `all`
    std::vector<std::size_t> entries;  ///< entries with a changed transform; unused if `all`
  };
  [[nodiscard]] Change show(const std::vector<std::size_t>& objects, std::uint32_t frame);
  /// Makes the next show() report all objects as new.
  void forget() { objects_.clear(); }

  /// The shapes as written, in the card's number format.
  [[nodiscard]] const Shapes& shapes() const { return shapes_; }
  [[nodiscard]] const std::vector<Object>& entries() const { return entries_; }
  /// The shapes as a pass tests them.
  [[nodiscard]] const Shapes& placed() const { return entries_.empty() ? shapes_ : placed_; }

 private:
  ObjectState& state(std::size_t number);
  void write(const ObjectState& object, std::size_t base, Change& change);
  void enter(const ObjectState& object, std::size_t base, std::vector<Object>& entries) const;
  void place(const Change& change);
  void place(const Object& entry);
  const Scene* scene_;
  std::vector<bool> by_card_;
  Table table_;
  std::map<std::size_t, ObjectState> states_;
  std::vector<std::size_t> objects_;
  Shapes shapes_, placed_;
  std::vector<Object> entries_;
};

/// Builds a BVH over triangles, whose parts are the objects that the card moves, or over solids.
/// Error kUsage for other shapes, and the errors of Bvh::build.
[[nodiscard]] Bvh bvh_of_row(const Row& row);

/// The secondaries in the card's DDR.
class Secondaries {
 public:
  Secondaries(Board& board, const Scene& scene, const Plan& plan);

  /// Makes the following passes test these objects. Writes what changed since the last call. Fits
  /// the BVH to it if the plan has one. The BVH is unused if a secondary has no box.
  void show(const std::vector<std::size_t>& objects, std::uint32_t frame);

  /// All secondaries as a pass tests them.
  [[nodiscard]] const Shapes& placed() const { return row_.placed(); }
  /// Why these secondaries have no BVH; nothing if they have one or need none.
  [[nodiscard]] const std::optional<std::string>& no_bvh() const { return no_bvh_; }
  /// Whether passes test whole objects, and so cannot test ranges.
  [[nodiscard]] bool moved_by_card() const { return !row_.entries().empty(); }

 private:
  void write(const Row::Change& change);
  void fit_bvh(const Row::Change& change, const std::vector<std::size_t>& objects);
  void refit();
  Board* board_;
  bool has_table_, has_bvh_;
  std::optional<Bvh> bvh_;  ///< over triangles; what the card refits
  const Scene* scene_;
  std::vector<bool> by_card_;
  std::optional<std::string> no_bvh_;
  Row row_;
};

/// The primaries in the card's register file.
class Primaries {
 public:
  Primaries(Board& board, const Scene& scene, const Plan& plan);

  /// Makes the following passes use these objects. Writes nothing yet.
  void show(const std::vector<std::size_t>& objects, std::uint32_t frame);

  /// Loads the shapes [first, first + count) and moves their objects, unless the register file
  /// already holds them in this state.
  void load(std::size_t first, std::size_t count);

  /// All primaries, packet after packet, as passes test them.
  [[nodiscard]] const Shapes& placed() const { return row_.placed(); }

 private:
  Board* board_;
  bool has_table_;
  Row row_;
  std::optional<Range> loaded_;
  std::vector<std::size_t> moved_;  ///< entries that are not yet on the card
};

}  // namespace cde::scene_runner
