// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "cde/mesh/mesh.hpp"

namespace cde {

/// A sequence of triangles stored elsewhere. The storage must outlive the view.
class TriangleView {
 public:
  TriangleView(std::span<const Triangle> triangles)  // NOLINT(google-explicit-constructor)
      : triangles_(triangles) {}
  TriangleView(const std::vector<Triangle>& triangles)  // NOLINT(google-explicit-constructor)
      : triangles_(triangles) {}
  TriangleView(const Mesh& mesh) : mesh_(&mesh) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] std::size_t size() const {
    return mesh_ != nullptr ? mesh_->faces.size() : triangles_.size();
  }
  [[nodiscard]] Triangle operator[](std::size_t i) const {
    return mesh_ != nullptr ? mesh_->triangle(i) : triangles_[i];
  }

 private:
  std::span<const Triangle> triangles_;
  const Mesh* mesh_ = nullptr;
};

}  // namespace cde
