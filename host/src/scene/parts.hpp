// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "cde/scene/scene.hpp"
#include "scene/toml_reader.hpp"

/// Parts of a scene file. Private to the library.
namespace cde::scene_parts {

inline constexpr double kDegree = std::numbers::pi / 180;  ///< radians per degree

/// Adds up the memory that a scene will take, before its shapes are made. A few lines of a file can
/// ask for any number of shapes.
class Memory {
 public:
  static constexpr std::uint64_t kMost = std::uint64_t{2} << 30;  ///< bytes

  /// Adds shapes. Error kCapacity at the key, with the size and the limit, if the sum is too large.
  void add(const toml_reader::Table& table, const char* key, Shape shape, std::uint64_t count);
  /// Adds a pose for each of so many existing shapes.
  void add_poses(const toml_reader::Table& table, std::uint64_t count);

 private:
  void add(const toml_reader::Table& table, const char* key, const std::string& what,
           std::uint64_t bytes);
  std::uint64_t bytes_ = 0;
};

/// The mesh files that a scene names. Objects in a row that name the same file read it once. All
/// files together have a limit of time (ReadLimits).
class Meshes {
 public:
  /// load_named_mesh(). Error kFile if the time is over.
  const Mesh& load(const std::filesystem::path& file);

 private:
  std::filesystem::path last_file_;
  Mesh last_;
  std::set<std::filesystem::path> files_;
  std::uint64_t bytes_ = 0;  ///< of the files
  std::chrono::steady_clock::duration spent_{};
};

/// Reads [[object]]; the caller resolves its parent. Paths are relative to `folder`. Shapes with a
/// defect in the card's format are errors.
[[nodiscard]] SceneObject read_object(toml_reader::Table& table,
                                      const std::filesystem::path& folder, Memory& memory,
                                      Meshes& meshes, FpFormat format);

/// Reads [object.motion]. The shapes of `object` must be read already.
[[nodiscard]] Motion read_motion(toml_reader::Table& table, const SceneObject& object);

/// The centre of each shape, from which it moves when it moves on its own.
[[nodiscard]] std::vector<Eigen::Vector3d> centres(const Shapes& shapes);

}  // namespace cde::scene_parts
