// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/mesh/terrain.hpp"

/// Triangles and BVHs for tests of refits.
namespace cde::testing {

class RefitDice {
 public:
  explicit RefitDice(unsigned seed) : engine_(seed) {}
  unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }
  int between(int low, int high) {
    return low + static_cast<int>(below(static_cast<unsigned>(high - low + 1)));
  }
  bool once_in(unsigned n) { return below(n) == 0; }
  float unit() { return static_cast<float>(below(1u << 25)) * 0x1p-24f - 1; }
  Eigen::Vector3f point() { return {unit(), unit(), unit()}; }

 private:
  std::mt19937 engine_;
};

using Triangles = std::vector<Triangle>;

/// Makes `count` triangles. `vertex` gets the number of the triangle and returns a vertex.
template <class Vertex>
Triangles drawn(std::size_t count, Vertex&& vertex) {
  Triangles all;
  for (std::size_t i = 0; i < count; ++i)
    all.push_back(
        {vertex(static_cast<int>(i)), vertex(static_cast<int>(i)), vertex(static_cast<int>(i))});
  return all;
}

inline Triangles terrain_triangles(std::size_t count) {
  const Mesh mesh = make_terrain({.quads_x = 40, .quads_y = 40});
  Triangles all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(mesh.triangle(i % mesh.faces.size()));
  return all;
}

struct RefitScene {
  const char* name;
  std::function<Triangles(std::size_t count, RefitDice& dice)> make;
};

/// Each scene is hard in its own way, and all scenes are legal input.
inline const RefitScene kRefitScenes[] = {
    {"terrain", [](std::size_t count, RefitDice&) { return terrain_triangles(count); }},
    {"random",
     [](std::size_t count, RefitDice& d) { return drawn(count, [&](int) { return d.point(); }); }},
    {"needles",
     [](std::size_t count, RefitDice& d) {
       Triangles all;
       for (std::size_t i = 0; i < count; ++i) {
         const Eigen::Vector3f from = d.point(), along = d.point();
         all.push_back({from, from + along,
                        from + along * 0.5f + d.point() * std::ldexp(1.0f, d.between(-20, -2))});
       }
       return all;
     }},
    {"one_point",
     [](std::size_t count, RefitDice&) {
       return drawn(count, [](int) { return Eigen::Vector3f(0x1.234566p10f, -0x1p40f, 3); });
     }},
    {"zeros",
     [](std::size_t count, RefitDice& d) {
       const auto zero = [&] { return d.once_in(2) ? 0.0f : -0.0f; };
       return drawn(count, [&](int) { return Eigen::Vector3f(zero(), zero(), zero()); });
     }},
    {"subnormals",
     [](std::size_t count, RefitDice& d) {
       return drawn(count, [&](int i) {
         return Eigen::Vector3f(d.point() * std::ldexp(1.0f, i % 3 == 0 ? -126 : -145));
       });
     }},
    {"about_the_least_byte",
     [](std::size_t count, RefitDice& d) {
       return drawn(count, [&](int) {
         return Eigen::Vector3f(d.point() * std::ldexp(1.0f, d.between(-90, -60)));
       });
     }},
    {"steps_at_2^40",
     [](std::size_t count, RefitDice& d) {
       const auto step = [&](float from, unsigned most) {
         float x = from;
         for (unsigned k = d.below(most); k > 0; --k) x = std::nextafter(x, 0.0f);
         return x;
       };
       return drawn(count, [&](int i) {
         return Eigen::Vector3f(step(0x1p40f, 6),
                                step(-0x1p40f, 1 + static_cast<unsigned>(i) % 600),
                                step(0x1.000002p39f, 4));
       });
     }},
    {"2^40_beside_2^-80",
     [](std::size_t count, RefitDice& d) {
       const auto either = [&] {
         const float size = d.once_in(4) ? 0x1p40f : 0x1p-80f;
         return d.once_in(3) ? std::copysign(size, d.unit()) : d.unit() * size;
       };
       return drawn(count, [&](int) { return Eigen::Vector3f(either(), either(), either()); });
     }},
    {"all_sizes",
     [](std::size_t count, RefitDice& d) {
       return drawn(count, [&](int) {
         Eigen::Vector3f p;
         for (float& x : p) x = std::ldexp(d.unit(), d.between(-149, 40));
         return p;
       });
     }},
    {"far_away",
     [](std::size_t count, RefitDice& d) {
       const Eigen::Vector3f away(148376, -0x1p30f, 0x1p39f);
       return drawn(count, [&](int) {
         return Eigen::Vector3f(away + d.point() * std::ldexp(1.0f, d.between(-4, 18)));
       });
     }},
};

/// A random BVH that bvh::check accepts. Nodes stand in the order in which their parents were
/// drawn. Any child slot may be empty, leaves hold one or two secondaries, and some nodes have no
/// children.
struct RandomBvh {
  std::vector<bvh::Node> nodes;
  std::size_t slots = 0;
};
inline RandomBvh random_bvh(std::size_t nodes, RefitDice& dice) {
  using bvh::Child;
  RandomBvh bvh;
  std::vector<unsigned> levels = {1};
  std::vector<std::size_t> open = {0};
  bvh.nodes.resize(1);
  while (!open.empty()) {
    const std::size_t which =
        dice.once_in(2) ? open.size() - 1 : dice.below(static_cast<unsigned>(open.size()));
    const std::size_t n = open[which];
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(which));
    bvh::Node node;
    node.set_first_node(static_cast<std::uint32_t>(bvh.nodes.size()));
    node.set_first_slot(static_cast<std::uint32_t>(bvh.slots));
    const unsigned sparse = 1 + dice.below(6);
    for (unsigned i = 0; i < bvh::Node::kChildren; ++i) {
      if (!dice.once_in(sparse) && !(n == 0 && i == 3)) continue;
      auto child = static_cast<Child>(1 + dice.below(3));
      const bool full = bvh.nodes.size() >= nodes || levels[n] == Bvh::kMostDepth;
      if (child == Child::kNode && full) child = Child::kLeafOfOne;
      if (n == 0 && i == 3 && nodes > 1) child = Child::kNode;
      node.set_child(i, child);
      bvh.slots += slots_of(child);
      if (child != Child::kNode) continue;
      open.push_back(bvh.nodes.size());
      levels.push_back(levels[n] + 1);
      bvh.nodes.emplace_back();
    }
    bvh.nodes[n] = node;
  }
  return bvh;
}

}  // namespace cde::testing
