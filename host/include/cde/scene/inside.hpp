// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "cde/mesh/inside.hpp"
#include "cde/scene/scene.hpp"

namespace cde {

/// Tells which primaries of a query have their middle inside a secondary object, frame by frame.
/// The middle of a ray is its origin. Each secondary object must be a closed mesh (Inside). The
/// host computes this in binary64 from the shapes before they are rounded to the card's format.
class SceneInside {
 public:
  /// Error kBadInput, naming the object, if its mesh is not closed in frame 0 or its triangles move
  /// one by one. The scene must outlive this object.
  SceneInside(const Scene& scene, const SceneQuery& query);

  /// One entry per primary, in the query's order; valid until the next call. Error kBadInput if a
  /// deformed mesh is not closed in this frame.
  [[nodiscard]] const std::vector<bool>& of(std::uint32_t frame);

 private:
  struct Body {
    std::size_t object;
    Inside inside;
    bool deforms;
  };
  [[nodiscard]] std::vector<Eigen::Vector3f> middles(std::uint32_t frame) const;

  const Scene* scene_;
  const SceneQuery* query_;
  std::vector<Body> bodies_;
  std::optional<std::uint32_t> frame_;
  std::vector<bool> inside_;
};

}  // namespace cde
