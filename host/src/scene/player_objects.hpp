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

/// How objects get onto the card, and how they move there. Private to the player.
namespace cde::player {

/// An object of the scene in one frame: its shapes as they are written to the card, in its own
/// frame if the card moves it and posed by the host otherwise, and the transforms that are left to
/// the card.
class ObjectState {
 public:
  ObjectState(const Scene& scene, const SceneObject& object, bool by_card);

  /// Other frames may come in any order; the same one again changes nothing.
  void show(std::uint32_t frame);

  [[nodiscard]] const Shapes& shapes() const { return shapes_; }
  /// Shapes that the last show() changed, ascending.
  [[nodiscard]] const std::vector<Range>& changed() const { return changed_; }
  /// One for all shapes, or one each.
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

/// What an object table has to hold.
enum class Table {
  kMoved,  ///< objects that the card moves; other shapes stay as they are
  kAll,    ///< every object if the card moves any of them
};

/// Objects one after the other, on one side of the card: what lies there, and the object table that
/// moves it.
class Row {
 public:
  Row(const Scene& scene, const std::vector<bool>& by_card, Table table)
      : scene_(&scene), by_card_(by_card), table_(table) {}

  /// What differs from the frame shown before.
  struct Change {
    bool all = false;                  ///< these are other objects
    std::vector<Range> shapes;         ///< unless all: ascending
    std::vector<std::size_t> entries;  ///< unless all: that have another transform
  };
  [[nodiscard]] Change show(const std::vector<std::size_t>& objects, std::uint32_t frame);
  /// The next frame counts as one of other objects.
  void forget() { objects_.clear(); }

  /// As written: in numbers of the card's format.
  [[nodiscard]] const Shapes& shapes() const { return shapes_; }
  [[nodiscard]] const std::vector<Object>& entries() const { return entries_; }
  /// As a pass meets them.
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

/// Over triangles that passes meet, with the objects that the card moves as its parts, or over
/// solids. Error kUsage for other shapes, beside those of Hierarchy::build.
[[nodiscard]] Hierarchy tree_of(const Row& row);

/// What lies in the card's DDR.
class Secondaries {
 public:
  Secondaries(Board& board, const Scene& scene, const Plan& plan);

  /// The passes that follow meet these objects. Writes what changed since the last call, and makes
  /// the hierarchy one of it, where the plan has one; where it has a box of none it is not used.
  void show(const std::vector<std::size_t>& objects, std::uint32_t frame);

  /// All of them as a pass meets them.
  [[nodiscard]] const Shapes& placed() const { return row_.placed(); }
  /// Why there is no hierarchy of them as they are now; nothing if none is missing.
  [[nodiscard]] const std::optional<std::string>& no_tree() const { return no_tree_; }
  /// Whether passes sweep objects, and so cannot sweep ranges.
  [[nodiscard]] bool moved_by_card() const { return !row_.entries().empty(); }

 private:
  void write(const Row::Change& change);
  void fit_tree(const Row::Change& change, const std::vector<std::size_t>& objects);
  Board* board_;
  bool has_table_, has_tree_, tree_there_ = false;
  const Scene* scene_;
  std::vector<bool> by_card_;
  std::optional<std::string> no_tree_;
  Row row_;
};

/// What lies in the card's register file.
class Primaries {
 public:
  Primaries(Board& board, const Scene& scene, const Plan& plan);

  /// The passes that follow have these objects. Writes nothing yet.
  void show(const std::vector<std::size_t>& objects, std::uint32_t frame);

  /// Loads the shapes [first, first + count) and moves their objects, unless they lie there as they
  /// are to be.
  void load(std::size_t first, std::size_t count);

  /// All of them, packet after packet, as passes meet them.
  [[nodiscard]] const Shapes& placed() const { return row_.placed(); }

 private:
  Board* board_;
  bool has_table_;
  Row row_;
  std::optional<Range> loaded_;
  std::vector<std::size_t> moved_;  ///< entries that the card does not have yet
};

}  // namespace cde::player
