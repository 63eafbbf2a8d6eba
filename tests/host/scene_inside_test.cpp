// SPDX-License-Identifier: Apache-2.0
// The key `inside` of a scene's queries.
#include "cde/scene/inside.hpp"

#include <fmt/format.h>

#include "scenes.hpp"

namespace cde::testing {
namespace {

std::string mesh_object(const std::string& name, const Folder& folder, const std::string& more) {
  folder.write(
      "box.obj",
      "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  return fmt::format("[[object]]\nname = \"{}\"\nmesh = \"box.obj\"\n{}\n", name, more);
}

std::string query(const std::string& pair, const std::string& primaries,
                  const std::string& secondaries) {
  return fmt::format(
      "[[query]]\nname = \"q\"\npair = \"{}\"\nprimaries = {}\nsecondaries = {}\ninside = true\n",
      pair, primaries, secondaries);
}

std::vector<bool> inside(const Folder& folder, const std::string& text, std::uint32_t frame) {
  const Scene scene = parse_scene(text, (folder / "s.toml").string());
  return SceneInside(scene, scene.queries.at(0)).of(frame);
}

TEST(SceneInside, FollowsBothSidesAsTheyMove) {
  const Folder folder;
  const std::string ball =
      "[[object]]\nname = \"ball\"\nsphere = [{ center = [0, 0, 0], radius = 0.1 }, "
      "{ center = [1.5, 0, 0], radius = 0.1 }]\n"
      "motion = { kind = \"velocity\", linear = [1, 0, 0] }\n";
  const std::string text = "frames = 9\nrate = 1\n" + ball +
                           mesh_object("a", folder,
                                       "motion = { kind = \"velocity\", position = [3, 0, "
                                       "0], axis = [0, 0, 1], degrees = 45 }") +
                           mesh_object("b", folder,
                                       "motion = { kind = \"velocity\", position = [0, 9, "
                                       "0], linear = [4, -4.5, 0] }") +
                           query("sphere-triangle", "\"ball\"", "[\"a\", \"b\"]");
  // Box a turned by 45 degrees reaches from x = 1.59 to 4.41; box b is around (8, 0) in frame 2.
  EXPECT_EQ(inside(folder, text, 0), (std::vector{false, false}));
  EXPECT_EQ(inside(folder, text, 1), (std::vector{false, true}));
  EXPECT_EQ(inside(folder, text, 2), (std::vector{true, true}));
  EXPECT_EQ(inside(folder, text, 3), (std::vector{true, false}));
  EXPECT_EQ(inside(folder, text, 5), (std::vector{false, false}));
}

TEST(SceneInside, KnowsADeformedMesh) {
  const Folder folder;
  const std::string text =
      "frames = 2\nrate = 1\n[[object]]\nname = \"ray\"\nray = { origin = [0, 0, 1.5], direction = "
      "[0, 0, 1] }\n" +
      mesh_object(
          "a", folder,
          "deform = { kind = \"wave\", vertices = [4, 7], amplitude = [0, 0, 2], period = 4, "
          "wavelength = 1e9, direction = [1, 0, 0] }") +
      query("ray-triangle", "\"ray\"", "\"a\"");
  EXPECT_EQ(inside(folder, text, 0), std::vector{false});
  EXPECT_EQ(inside(folder, text, 1), std::vector{true}) << "the lid has risen to z = 3";
}

TEST(SceneInside, RefusesWhatHasNoInside) {
  const std::string triangle =
      "[[object]]\nname = \"open\"\ntriangle = { v0 = [0, 0, 0], v1 = [1, 0, 0], v2 = [0, 1, 0] "
      "}\n";
  refused(kRays + triangle + query("ray-triangle", "\"rays\"", "\"open\""),
          "inside: object 'open': is not closed: an edge of triangle 0");
  refused(kRays + kBall + query("ray-sphere", "\"rays\"", "\"ball\""),
          "needs secondaries that are closed meshes and primaries that have a middle, but the "
          "primaries are rays and the secondaries spheres",
          ErrorCode::kUsage);
  refused(kRays + triangle +
              "motion = { kind = \"random\", speed = 1, min = [0, 0, 0], max = [1, 1, 1], each = "
              "true }\n" +
              query("ray-triangle", "\"rays\"", "\"open\""),
          "object 'open' has triangles that move one by one");
}

}  // namespace
}  // namespace cde::testing
