#pragma once
#include <cstdint>
#include <vector>

#include "cde/board.hpp"
#include "cde/scene.hpp"

/// How objects get onto the card. Private to the player.
namespace cde::player {

/// An object of the scene as it is in one frame.
class ObjectState {
 public:
  ObjectState(const Scene& scene, const SceneObject& object);

  /// Other frames may come in any order. Returns at once if this is the frame already.
  void show(std::uint32_t frame);

  [[nodiscard]] const Shapes& world() const { return world_; }
  /// Shapes that differ from those of the frame shown before, ascending.
  [[nodiscard]] const std::vector<Range>& changed() const { return changed_; }
  /// Counts up whenever something changed.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  const Scene* scene_;
  const SceneObject* object_;
  bool still_;
  std::vector<Range> deforming_;
  Shapes world_;
  std::vector<Range> changed_;
  std::optional<std::uint32_t> frame_;
  std::uint64_t version_ = 0;
};

/// What lies in the card's DDR. This one has rigid objects posed by the host and uploads the slots
/// that changed; whoever moves them otherwise is an implementation of the same two functions.
class Secondaries {
 public:
  explicit Secondaries(Board& board) : board_(&board) {}

  /// The passes that follow sweep these objects, numbers into `states`, one after the other.
  /// Returns the words uploaded.
  std::uint64_t show(const std::vector<std::size_t>& objects,
                     const std::vector<ObjectState>& states);

  /// All of them as the card has them now.
  [[nodiscard]] const Shapes& shapes() const { return shapes_; }

 private:
  std::uint64_t upload(std::size_t first, std::size_t count);
  Board* board_;
  std::vector<std::size_t> objects_;
  std::vector<std::uint64_t> versions_;
  Shapes shapes_;
};

/// These objects' shapes in a row.
[[nodiscard]] Shapes joined(const std::vector<std::size_t>& objects,
                            const std::vector<ObjectState>& states);

}  // namespace cde::player
