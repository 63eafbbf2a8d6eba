// SPDX-License-Identifier: Apache-2.0
#include "cde/mesh/inside.hpp"

#include <random>

#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;
using testing::Folder;
using testing::small_mesh;

Eigen::Vector3f drawn(std::mt19937& random, float reach) {
  std::uniform_real_distribution<float> one(-reach, reach);
  return {one(random), one(random), one(random)};
}

TEST(InsideTest, PointsOfACube_AreClassified) {
  const Inside inside(load_mesh(small_mesh("cube.obj")));  // from -1 to 1
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3f p = drawn(random, 1.5f);
    const float most = p.cwiseAbs().maxCoeff();
    if (most == 1.0f) continue;
    EXPECT_EQ(inside.contains(p), most < 1.0f) << p.transpose();
  }
  // In line with vertices, edges and diagonals of faces.
  for (const float x : {-1.0f, 0.0f, 1.0f})
    for (const float y : {-1.0f, 0.0f, 1.0f}) {
      EXPECT_FALSE(inside.contains({x, y, -1.25f}));
      EXPECT_FALSE(inside.contains({x, y, 1.25f}));
      EXPECT_TRUE(inside.contains({0.5f * x, 0.5f * y, 0.0f}));
    }
  EXPECT_NEAR(inside.winding_number({0, 0, 0}), 1.0, 1e-12);
  EXPECT_NEAR(inside.winding_number({0.999999f, 0.5f, 0.25f}), 1.0, 1e-9);
}

TEST(InsideTest, InvertedFaces_CountFromTheOtherSide) {
  Mesh cube = load_mesh(small_mesh("cube.obj"));
  for (auto& f : cube.faces) std::swap(f[1], f[2]);
  const Inside inside(cube);
  EXPECT_NEAR(inside.winding_number({0, 0, 0}), -1.0, 1e-12);
  EXPECT_TRUE(inside.contains({0, 0, 0}));
}

TEST(InsideTest, HoleOfATorus_IsOutside) {
  const Inside torus(load_mesh(small_mesh("torus.stl")));  // each facet has its own vertices
  std::mt19937 random(2);
  const Mesh mesh = load_mesh(small_mesh("torus.stl"));
  const Eigen::AlignedBox3f box = bounds(mesh);
  EXPECT_FALSE(torus.contains(box.center())) << "in the hole";
  int within = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f p = box.center() + drawn(random, box.sizes().maxCoeff());
    const double winding = torus.winding_number(p);
    EXPECT_NEAR(winding, std::round(winding), 1e-9);
    within += torus.contains(p);
  }
  EXPECT_GT(within, 20);
}

TEST(InsideTest, OpenMesh_IsAnError) {
  const Folder folder;
  const auto refused = [&](const std::string& text, const std::string& what) {
    const Mesh mesh = load_mesh(folder.write("a.obj", text));
    expect_error(ErrorCode::kBadInput, what, [&] { (void)Inside(mesh); });
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  refused(corners + "f 1 3 2\n", "a.obj: is not closed: an edge of triangle 0");
  refused(corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\n", "is not closed");
  refused(corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 4 1\n", "2 triangles one way round and 0");
  const Mesh whole =
      load_mesh(folder.write("a.obj", corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 1 2\n"));
  EXPECT_TRUE(Inside(whole).contains({0.1f, 0.1f, 0.1f}));
  EXPECT_FALSE(Inside(whole).contains({0.5f, 0.5f, 0.5f}));
}

}  // namespace
}  // namespace cde
