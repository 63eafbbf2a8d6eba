// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "cde/scene/scene.hpp"
#include "scene/toml_reader.hpp"

/// Parts of a scene file. Private to the library.
namespace cde::scene_parts {

inline constexpr double kDegree = std::numbers::pi / 180;  ///< in radians

/// What playing a scene will take of memory, counted before its shapes are made: a few lines of a
/// file can ask for any number of them.
class Memory {
 public:
  static constexpr std::uint64_t kMost = std::uint64_t{2} << 30;  ///< bytes

  /// So many more shapes. Error kCapacity at the key, with the size and the limit, if that is too
  /// much.
  void add(const toml_reader::Table& table, const char* key, Shape shape, std::uint64_t count);
  /// The same for shapes that are there, each with a pose of its own.
  void add_poses(const toml_reader::Table& table, std::uint64_t count);

 private:
  void add(const toml_reader::Table& table, const char* key, const std::string& what,
           std::uint64_t bytes);
  std::uint64_t bytes_ = 0;
};

/// Reads [[object]]; its parent is resolved by the caller. Paths are relative to `folder`. Shapes
/// that have a defect in the card's format are errors.
[[nodiscard]] SceneObject read_object(toml_reader::Table& table,
                                      const std::filesystem::path& folder, Memory& memory,
                                      FpFormat format);

/// Reads [object.motion]; `object` has its shapes.
[[nodiscard]] Motion read_motion(toml_reader::Table& table, const SceneObject& object);

/// Where each shape is: what it moves from when it moves on its own.
[[nodiscard]] std::vector<Eigen::Vector3d> centres(const Shapes& shapes);

}  // namespace cde::scene_parts
