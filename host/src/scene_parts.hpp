#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cde/scene.hpp"
#include "toml_reader.hpp"

/// Parts of a scene file. Private to the library.
namespace cde::scene_parts {

/// Reads [[object]]; its parent is resolved by the caller. Paths are relative to `folder`.
[[nodiscard]] SceneObject read_object(toml_reader::Table& table,
                                      const std::filesystem::path& folder);

/// Reads [object.motion]; `object` has its shapes.
[[nodiscard]] Motion read_motion(toml_reader::Table& table, const SceneObject& object);

/// Where each shape is: what it moves from when it moves on its own.
[[nodiscard]] std::vector<Eigen::Vector3d> centres(const Shapes& shapes);

}  // namespace cde::scene_parts
