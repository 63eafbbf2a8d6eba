// SPDX-License-Identifier: Apache-2.0
// BVHs: contents of their boxes, depth, files, and malformed nodes.
// tests/numerics/bvh_test.cpp tests which secondaries rays meet.
#include "cde/bvh/bvh.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

#include "../has.hpp"
#include "cde/card/board.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/pipes/transform.hpp"
#include "testing.hpp"

namespace cde::testing {
namespace {

using bvh::Child;
using bvh::Node;
using Eigen::AlignedBox3f;
using Eigen::Vector3f;
using Boxes = std::vector<AlignedBox3f>;

/// A box of a node's child, in numbers that represent it exactly.
struct Exact {
  long double lower, upper;
};
Exact side(const Node& node, unsigned child, int axis) {
  const auto at = [&](std::uint8_t q) {
    return static_cast<long double>(node.origin()[axis]) +
           std::ldexp(static_cast<long double>(q), node.exponent(axis));
  };
  return {at(node.lower(child, axis)), at(node.upper(child, axis))};
}

/// Every box lies within all boxes above it, and the nodes form a tree.
void expect_sound(const Bvh& h, const Boxes& boxes) {
  ASSERT_EQ(h.order().size(), boxes.size());
  EXPECT_EQ(bvh::check(h.nodes(), boxes.size()), h.depth());
  Boxes below(h.nodes().size());
  for (std::size_t n = h.nodes().size(); n-- > 0;) {
    const Node& node = h.nodes()[n];
    for (unsigned i = 0; i < Node::kChildren; ++i) {
      AlignedBox3f box;
      if (node.child(i) == Child::kNode) box = below[node.place(i)];
      for (unsigned s = 0; s < slots_of(node.child(i)); ++s)
        box.extend(boxes[h.order()[node.place(i) + s]]);
      if (node.child(i) == Child::kNone) continue;
      for (int k = 0; k < 3; ++k) {
        const Exact e = side(node, i, k);
        ASSERT_LE(e.lower, box.min()[k]) << "node " << n << " child " << i;
        ASSERT_GE(e.upper, box.max()[k]) << "node " << n << " child " << i;
        // The box is not much larger: a byte is at most a 127th of the node, rounded outwards.
        ASSERT_LE(e.upper - e.lower, static_cast<long double>(box.sizes()[k]) +
                                         2 * std::ldexp(1.0L, node.exponent(k)));
      }
      below[n].extend(box);
    }
    for (int k = 0; k < 3 && !below[n].isEmpty(); ++k) {
      const long double extent = static_cast<long double>(below[n].max()[k]) - below[n].min()[k];
      if (node.exponent(k) > Node::kLeastExponent) {
        ASSERT_GT(extent, std::ldexp(126.0L, node.exponent(k))) << "a smaller unit would suffice";
      }
    }
  }
  EXPECT_EQ(h.box().min(), below[0].min());
  EXPECT_EQ(h.box().max(), below[0].max());
}

Boxes random_boxes(std::size_t count, unsigned seed, int least = 0, int most = 0) {
  std::mt19937 bits(seed);
  const auto unit = [&] { return static_cast<float>(bits() >> 8) * 0x1p-23f - 1; };
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = std::ldexp(
        1.0f, least + static_cast<int>(bits() % static_cast<unsigned>(most - least + 1)));
    const Vector3f a = size * Vector3f(unit(), unit(), unit()),
                   b = a + size * 0.05f * Vector3f(unit(), unit(), unit());
    boxes.emplace_back(a.cwiseMin(b), a.cwiseMax(b));
  }
  return boxes;
}

AlignedBox3f point(float x, float y = 0, float z = 0) {
  return {Vector3f(x, y, z), Vector3f(x, y, z)};
}

TEST(Bvh, Boxes_ContainEverythingBelow) {
  for (const unsigned leaf : {1u, 2u}) {
    for (const std::size_t count : {1, 2, 3, 7, 8, 9, 16, 17, 100, 5000}) {
      const Boxes boxes = random_boxes(count, static_cast<unsigned>(count));
      expect_sound(Bvh::build(boxes, {.leaf = leaf}), boxes);
    }
  }
  for (const int most : {-90, -30, 0, 39}) {  // from the smallest numbers to the largest lengths
    const Boxes boxes = random_boxes(1000, 5, -140, most);
    expect_sound(Bvh::build(boxes), boxes);
  }
}

TEST(Bvh, NoSecondaries_BuildOneEmptyNode) {
  const Bvh none = Bvh::build(Boxes{});
  EXPECT_EQ(none.nodes().size(), 1u);
  EXPECT_EQ(none.depth(), 1u);
  EXPECT_TRUE(none.box().isEmpty());
  expect_sound(none, {});
}

/// Secondaries for which a binary BVH of least surface area would be a chain.
TEST(Bvh, DegenerateSecondaries_StayWithinTheDepthLimit) {
  Boxes doubling, same(100'000, point(1, 2, 3)), nested;
  for (int i = 0; i < 4000; ++i) doubling.push_back(point(std::ldexp(1.0f, i % 190 - 149)));
  for (int i = 0; i < 300; ++i) {
    const float size = std::pow(1.15f, static_cast<float>(i));
    if (size < 0x1p38f) nested.emplace_back(Vector3f::Constant(-size), Vector3f::Constant(size));
    nested.push_back(point(std::min(size, 0x1p39f), 1));
  }
  for (const Boxes& boxes : {doubling, same, nested}) {
    for (const unsigned leaf : {1u, 2u}) {
      const Bvh h = Bvh::build(boxes, {.leaf = leaf});
      expect_sound(h, boxes);
      EXPECT_LE(h.depth(), Bvh::kMostDepth);
    }
  }
}

TEST(Bvh, ThreadCount_DoesNotChangeTheBvh) {
  const Boxes boxes = random_boxes(50'000, 3);
  const Bvh one = Bvh::build(boxes, {.threads = 1});
  for (const unsigned threads : {2u, 5u, 0u}) {
    const Bvh many = Bvh::build(boxes, {.threads = threads});
    EXPECT_TRUE(std::ranges::equal(one.nodes(), many.nodes())) << threads;
    EXPECT_TRUE(std::ranges::equal(one.order(), many.order())) << threads;
  }
}

TEST(Bvh, Terrain_HasFewExpectedVisits) {
  const Mesh mesh = make_terrain();
  const Bvh h = Bvh::build(mesh);
  EXPECT_EQ(h.order().size(), mesh.faces.size());
  EXPECT_LE(h.depth(), 8u);
  const auto visits = h.expected_visits();
  EXPECT_GT(visits.nodes, 1);
  EXPECT_LT(visits.nodes, 12);
  EXPECT_LT(visits.secondaries, 8);
}

TEST(Bvh, Refit_FollowsMovedBoxes) {
  Boxes boxes = random_boxes(3000, 7);
  Bvh h = Bvh::build(boxes);
  const std::vector<Node> before(h.nodes().begin(), h.nodes().end());
  h.refit(boxes);
  EXPECT_TRUE(std::ranges::equal(h.nodes(), before)) << "no triangle has moved";
  for (std::size_t i = 0; i < boxes.size(); ++i)
    boxes[i].translate(Vector3f(std::sin(static_cast<float>(i)), 2, -0.25f));
  h.refit(boxes);
  expect_sound(h, boxes);
  boxes.pop_back();
  expect_error(ErrorCode::kUsage, "2999 secondaries for a BVH of 3000", [&] { h.refit(boxes); });
}

TEST(Bvh, UnbuildableInput_IsNamed) {
  expect_error(ErrorCode::kUsage, "a BVH with leaves of 3; expected 1 or 2",
               [] { (void)Bvh::build(Boxes{}, {.leaf = 3}); });
  const std::string must = "; it must not be empty or exceed 2^40";
  const float nan = std::nanf(""), large = 0x1.000002p40f;
  const std::pair<AlignedBox3f, std::string> bad[] = {
      {{Vector3f(1, 0, 0), Vector3f(0, 0, 0)}, "1,0,0 to 0,0,0"},
      {{Vector3f(0, nan, 0), Vector3f(0, 1, 0)}, "0,nan,0 to 0,1,0"},
      {{Vector3f(0, 0, 0), Vector3f(0, 0, INFINITY)}, "0,0,0 to 0,0,inf"}};
  for (const auto& [box, words] : bad)
    expect_error(ErrorCode::kBadInput, "secondary 1: its box is from " + words + must,
                 [&, b = box] {
                   (void)Bvh::build(Boxes{point(0), b});
                 });
  EXPECT_THROW((void)Bvh::build(Boxes{point(large)}), Error);
  // A NaN in any word of a triangle: a minimum of two numbers may drop it.
  for (unsigned word = 0; word < 9; ++word) {
    std::vector<Triangle> two(2, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    Bvh bvh = Bvh::build(two);
    Eigen::Vector3f* const corners[] = {&two[1].v0, &two[1].v1, &two[1].v2};
    (*corners[word / 3])[word % 3] = nan;
    EXPECT_THROW((void)Bvh::build(two), Error) << word;
    EXPECT_THROW(bvh.refit(two), Error) << word;
  }
  (void)Bvh::build(Boxes{point(0x1p40f), point(-0x1p40f)});
}

// ---- Files ----

TEST(Bvh, Files_ReadBackEqual) {
  const Folder folder;
  for (const std::size_t count : {0, 1, 500}) {
    const Boxes boxes = random_boxes(count, 9);
    const Bvh h = Bvh::build(boxes);
    h.save(folder / "h");
    const Bvh read = Bvh::load(folder / "h");
    EXPECT_TRUE(std::ranges::equal(h.nodes(), read.nodes()));
    EXPECT_TRUE(std::ranges::equal(h.order(), read.order()));
    EXPECT_EQ(h.depth(), read.depth());
    EXPECT_EQ(h.box().min(), read.box().min());
    EXPECT_EQ(h.box().max(), read.box().max());
  }
}

TEST(Bvh, DamagedFiles_AreRefused) {
  constexpr std::size_t kMagicBytes = 10;
  const Folder folder;
  const Boxes boxes = random_boxes(20, 9);
  Bvh::build(boxes).save(folder / "h");
  const std::string whole = bytes_of(folder / "h");
  const auto refused = [&](const std::string& bytes) {
    folder.write("x", bytes);
    try {
      (void)Bvh::load(folder / "x");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kFile);
      return std::string(e.what()).substr((folder / "x").string().size());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused(""), ": not a BVH file (cde.bvh.4)");
  EXPECT_EQ(refused("solid"), ": not a BVH file (cde.bvh.4)");
  std::string later = whole;
  later[8] = '1';
  EXPECT_EQ(refused(later), ": a BVH file of another version; expected cde.bvh.4");
  EXPECT_EQ(refused(whole.substr(0, 60)), ": a BVH file that is truncated in its header");
  for (std::size_t size = 14; size < whole.size(); size += 7)
    EXPECT_NE(refused(whole.substr(0, size)), "nothing") << size;
  EXPECT_NE(refused(whole + "x"), "nothing");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string one = whole;
    one[at] = static_cast<char>(one[at] ^ 4);
    EXPECT_NE(refused(one), "nothing") << at;
  }
  std::string many = whole;  // the largest possible node count
  for (std::size_t at = kMagicBytes; at < kMagicBytes + 8; ++at) many[at] = static_cast<char>(0xff);
  EXPECT_NE(refused(many), "nothing");
  // Forged files: the checksum is right, the content is not.
  const auto sealed = [&](std::string bytes) {
    bytes.resize(bytes.size() - 64);
    folder.write("y", bytes);
    const std::string command =
        "sha256sum <'" + (folder / "y").string() + "' >'" + (folder / "sum").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return bytes + bytes_of(folder / "sum").substr(0, 64);
  };
  EXPECT_EQ(refused(sealed(whole)), "nothing") << "the file must be accepted";
  std::string other = whole;
  other[kMagicBytes + 4 * 3 + 2] ^= 1;  // first number of the box
  EXPECT_EQ(refused(sealed(other)), ": its box differs from its root's");
  other = whole;
  other[kMagicBytes + 4 * 9 + 4 * 9] = 127;  // first exponent of the root
  EXPECT_EQ(refused(sealed(other)), ": node 0 has exponent 127; expected -80 to 40");
  std::string none = whole.substr(0, kMagicBytes) + std::string(4, '\0') + "\1" +
                     std::string(3 + 4 + 24 + 4, '\0');
  EXPECT_EQ(refused(sealed(none + std::string(64, 'x'))), ": a BVH without a root");
}

// ---- Objects ----

std::vector<Triangle> random_triangles(std::size_t count) {
  std::mt19937 bits(4);
  const auto point = [&] {
    std::uniform_real_distribution<float> at(-1, 1);
    return Vector3f{at(bits), at(bits), at(bits)};
  };
  std::vector<Triangle> all(count);
  for (Triangle& t : all) {
    t.v0 = 10 * point();
    t.v1 = t.v0 + point(), t.v2 = t.v0 + point();
  }
  return all;
}

/// Consecutive ranges, each with its own pose.
std::vector<Object> objects_of(std::size_t count, std::uint32_t each) {
  std::vector<Object> all;
  for (std::uint32_t k = 0; k < count; ++k) {
    all.push_back({k * each, each, {}});
    all.back().transform.rotation =
        Eigen::AngleAxisf(static_cast<float>(k), Vector3f(1, 2, 2) / 3).toRotationMatrix();
    all.back().transform.translation = {static_cast<float>(10 * k), 0, 0};
  }
  return all;
}

TEST(BvhOverObjects, Objects_HaveOnePartEach) {
  for (const std::size_t count : {1, 2, 7, 9, 300, 2048}) {
    for (const std::uint32_t each : {1u, 2u, 5u, 40u}) {
      if (count == 2048 && each == 40) continue;
      SCOPED_TRACE(std::to_string(count) + " of " + std::to_string(each));
      const auto triangles = random_triangles(count * each);
      const auto objects = objects_of(count, each);
      const Bvh h = bvh_of(triangles, objects);
      Boxes boxes;
      for (const Triangle& t : reference::pass_secondaries(triangles, objects).shapes)
        boxes.emplace_back(t.v0.cwiseMin(t.v1).cwiseMin(t.v2), t.v0.cwiseMax(t.v1).cwiseMax(t.v2));
      expect_sound(h, boxes);
      ASSERT_EQ(h.parts().size(), count);
      bvh::check(h.nodes(), h.order().size(), h.parts());
      const Folder folder;
      h.save(folder / "h");
      const Bvh read = Bvh::load(folder / "h");
      EXPECT_TRUE(std::ranges::equal(h.parts(), read.parts()));
      EXPECT_TRUE(std::ranges::equal(h.nodes(), read.nodes()));
    }
  }
}

TEST(BvhOverObjects, UnbuildableInput_IsNamed) {
  const auto triangles = random_triangles(40);
  const auto refused = [&](const std::vector<Object>& objects, ErrorCode code) {
    try {
      (void)bvh_of(triangles, objects);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code);
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused({}, ErrorCode::kUsage), "a BVH needs at least one object");
  EXPECT_EQ(refused({{0, 0, {}}}, ErrorCode::kUsage),
            "object 0: 0 secondaries from 0 on; expected 1 or more, within the 40 secondaries");
  EXPECT_EQ(refused({{0, 40, {}}, {3, 38, {}}}, ErrorCode::kUsage),
            "object 1: 38 secondaries from 3 on; expected 1 or more, within the 40 secondaries");
  EXPECT_EQ(refused({{~0u, ~0u, {}}}, ErrorCode::kUsage),
            "object 0: 4294967295 secondaries from 4294967295 on; expected 1 or more, within the "
            "40 secondaries");
  auto objects = objects_of(2, 20);
  objects[1].transform.translation.x() = 0x1p41f;
  EXPECT_EQ(refused(objects, ErrorCode::kBadInput).find("object 1: "), 0u);
  auto beyond = triangles;
  beyond[25].v0.x() = 0x1p41f;
  try {
    (void)Bvh::build(beyond, std::vector<std::uint32_t>{20, 20});
    ADD_FAILURE() << "built";
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find("part 1: secondary 5: its box is"), 0u) << e.what();
  }
  EXPECT_EQ(refused(std::vector<Object>(40'000, {0, 1, {}}), ErrorCode::kCapacity),
            "a BVH of 40000 parts; expected at most 32768");
  for (const std::vector<std::uint32_t>& parts :
       {std::vector<std::uint32_t>{}, {39}, {41}, {20, 0, 20}, {~0u, 41}})
    EXPECT_THROW((void)Bvh::build(triangles, parts), Error);
}

TEST(BvhOverObjects, ForeignParts_AreRefused) {
  const Bvh h = bvh_of(random_triangles(200), objects_of(4, 50));
  const auto defect = [&](const std::function<void(std::vector<Bvh::Part>&)>& change) {
    std::vector<Bvh::Part> parts(h.parts().begin(), h.parts().end());
    change(parts);
    try {
      bvh::check(h.nodes(), h.order().size(), parts);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::kBadInput);
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(defect([](auto&) {}), "nothing");
  EXPECT_EQ(defect([](auto& p) { p[2].first_node += 1; }),
            "part 2 does not follow the part before it");
  EXPECT_EQ(defect([](auto& p) { p[0].first_node = 0; }),
            "part 0 does not follow the part before it");
  EXPECT_EQ(defect([](auto& p) { p[3].nodes += 1; }), "part 3 exceeds the nodes or slots");
  EXPECT_EQ(defect([](auto& p) { p.pop_back(); }), "the parts do not cover all nodes and slots");
  EXPECT_TRUE(has(defect([](auto& p) {
                    p[1].nodes += 1;
                    p[2].first_node += 1;
                    p[2].nodes -= 1;
                  }),
                  "has another part's node or slot in node"));
  EXPECT_TRUE(has(defect([](auto& p) { p[1].secondaries -= 1, p[2].secondaries += 1; }),
                  "has another part's node or slot in node"));
}

// ---- Malformed nodes ----

std::string defect_in(std::vector<Node> nodes, std::size_t slots) {
  try {
    (void)bvh::check(nodes, slots);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kBadInput);
    return e.what();
  }
  return "";
}

TEST(BvhNodes, MalformedNodes_AreNamed) {
  const Boxes boxes = random_boxes(20, 9);
  const Bvh h = Bvh::build(boxes);
  const std::vector<Node> good(h.nodes().begin(), h.nodes().end());
  ASSERT_GT(good.size(), 2u);
  ASSERT_EQ(good[0].child(0), Child::kNode);
  EXPECT_EQ(defect_in(good, 20), "");
  EXPECT_EQ(defect_in({}, 0), "a BVH without a root");
  EXPECT_EQ(defect_in(good, 21), "slot 20 is in no leaf");
  EXPECT_TRUE(has(defect_in(good, 19), "there is no slot 19"));
  const auto with = [&](const std::function<void(Node&)>& change) {
    std::vector<Node> bad = good;
    change(bad[0]);
    return defect_in(bad, 20);
  };
  EXPECT_EQ(with([](Node& n) { n.set_first_node(0); }),
            "node 0 child 0: node 0 does not follow its parent");
  EXPECT_EQ(with([](Node& n) { n.set_first_node(1000); }), "node 0 child 0: there is no node 1000");
  EXPECT_NE(with([](Node& n) { n.set_child(0, Child::kNone); }), "");
  EXPECT_EQ(with([](Node& n) { n.set_exponent(1, 41); }),
            "node 0 has exponent 41; expected -80 to 40");
  EXPECT_EQ(with([](Node& n) {
              n.set_origin({0, INFINITY, 0});
            }),
            "node 0 has an origin that is not finite");
  EXPECT_EQ(with([](Node& n) {
              n.set_corner(false, 0, 2, 200);
              n.set_corner(true, 0, 2, 199);
            }),
            "node 0 child 0: its lower corner is above its upper one");
  std::vector<Node> chain(17);
  for (std::uint32_t n = 0; n < 16; ++n) {
    chain[n].set_child(0, Child::kNode);
    chain[n].set_first_node(n + 1);
  }
  EXPECT_EQ(defect_in(chain, 0), "node 15 child 0 is deeper than 16 levels");
  chain.resize(16);
  chain[15] = {};
  EXPECT_EQ(defect_in(chain, 0), "");
  std::mt19937 bits(1);  // random words: an error or a BVH, in finite time
  for (int i = 0; i < 2000; ++i) {
    std::vector<Node> random = good;
    for (int k = 0; k < 3; ++k)
      random[bits() % random.size()].words[3 + bits() % 3] = static_cast<std::uint32_t>(bits());
    (void)defect_in(random, 20);
  }
}

}  // namespace
}  // namespace cde::testing
