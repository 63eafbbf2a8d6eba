// SPDX-License-Identifier: Apache-2.0
// The node in whole numbers against the bound of docs/background/bvh_integer.md, in exact rational
// arithmetic, and traversals with it against brute force.
#include "cde/reference/integer_node.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "cde/reference/reference.hpp"
#include "cde/reference/traversal.hpp"
#include "float_node.hpp"
#include "hard_rays.hpp"
#include "integer_node_cases.hpp"

namespace cde::testing {
namespace {

using namespace hard;
using reference::IntegerFormat;
using reference::IntegerRay;
using reference::IntegerVisit;
using Rational = boost::multiprecision::cpp_rational;

bool full() {
  return std::getenv("CDE_FULL") != nullptr;
}

// ---- The bound of the proof ----

/// Whether a T of the ray's interval exists at which the ray is in the child's box, widened by the
/// margin of the proof. Exact.
bool meets_exactly(const NodeVisit& visit, unsigned child) {
  const auto margin = least_margin<Rational>(visit);
  Rational near = 0, far = 0;
  bool has_near = !std::isinf(visit.floor), has_far = !std::isinf(visit.limit);
  if (has_near) near = visit.floor;
  if (has_far) far = visit.limit;
  for (int k = 0; k < 3; ++k) {
    const Rational d = visit.d[k], o = visit.o[k];
    Rational low = corner_of<Rational>(visit.node, false, child, k) - margin - o,
             high = corner_of<Rational>(visit.node, true, child, k) + margin - o;
    if (d == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    low /= d, high /= d;
    if (d < 0) std::swap(low, high);
    if (!has_near || low > near) near = low;
    if (!has_far || high < far) far = high;
    has_near = has_far = true;
  }
  return near <= far;
}

enum class Answer { kNo, kYes, kUncertain };
/// The same in doubles, with a bound of their errors.
Answer meets(const NodeVisit& visit, const NearFar& t) {
  const double near = std::max<double>(t.near, visit.floor),
               far = std::min<double>(t.far, visit.limit);
  // A limit has no error, but T does.
  if (near > far + 2 * t.error) return Answer::kNo;
  return near + 2 * t.error <= far ? Answer::kYes : Answer::kUncertain;
}

struct Counts {
  std::size_t visits = 0, boxes = 0, entered = 0, lost = 0, exact = 0, keys = 0, wrong_keys = 0;
};

/// Whether T counts for a key: the least T of a child in mode nearest, the largest in farthest.
void check_key(const NodeVisit& visit, const IntegerVisit& answer, unsigned child, const NearFar& t,
               const IntegerFormat& format, Counts& counts) {
  const double near = std::max<double>(t.near + t.error, visit.floor),
               far = std::min<double>(t.far - t.error, visit.limit);
  const auto first = static_cast<float>(visit.farthest ? far : near);
  if (!std::isfinite(first) || first < near || first > far) return;
  ++counts.keys;
  const unsigned limit = reference::key_limit(answer.scale, first, visit.farthest, format);
  if (answer.keys[child] > limit) ++counts.wrong_keys;
}

Counts check_bound(NodeVisits& visits, std::size_t count, int sixteenths,
                   const IntegerFormat& format, bool report) {
  Counts counts;
  for (std::size_t i = 0; i < count; ++i) {
    const NodeVisit visit = visits();
    const IntegerVisit answer = reference::integer_visit(
        visit.ray(sixteenths), visit.node, visit.floor, visit.limit, visit.farthest, format);
    ++counts.visits;
    for (unsigned c = 0; c < bvh::Node::kChildren; ++c) {
      const bool entered = (answer.entered >> c & 1) != 0;
      if (visit.node.child(c) == bvh::Child::kNone) {
        EXPECT_FALSE(entered);
        continue;
      }
      ++counts.boxes;
      counts.entered += entered ? 1 : 0;
      const NearFar t = near_far(visit, c);
      const Answer fast = meets(visit, t);
      bool met = fast == Answer::kYes;
      if (fast == Answer::kUncertain ? !entered : i % 512 == 0) {
        ++counts.exact;
        met = meets_exactly(visit, c);
        if (fast != Answer::kUncertain) {
          EXPECT_EQ(met, fast == Answer::kYes) << "visit " << i;
        }
      }
      if (met && entered && !visit.infinite) check_key(visit, answer, c, t, format, counts);
      if (!met || entered) continue;
      if (counts.lost++ < 3 && report)
        ADD_FAILURE() << "visit " << i << ", child " << c << ": o " << visit.o.transpose() << ", d "
                      << visit.d.transpose() << ", T " << visit.floor << " to " << visit.limit
                      << ", exactly " << t.near << " to " << t.far;
    }
  }
  return counts;
}

class IntegerNode : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, IntegerNode, ::testing::ValuesIn(kScenes),
                         [](const auto& test) { return test.param.name; });

/// CDE_FULL=1: two million visits for each of three formats.
TEST_P(IntegerNode, BoxesOfTheTheorem_AreEntered) {
  const TriangleScene scene = GetParam().make();
  const std::size_t count = full() ? 250'000 : 12'000;
  for (const IntegerFormat& format :
       {IntegerFormat{16, 6}, IntegerFormat{14, 5}, IntegerFormat{12, 4}}) {
    NodeVisits visits(scene, 1), same(scene, 1), again(scene, 1);
    const Counts c = check_bound(visits, count, 13, format, true);
    EXPECT_EQ(c.lost, 0u);
    EXPECT_EQ(c.wrong_keys, 0u);
    EXPECT_GT(c.entered, count);
    EXPECT_GT(c.keys, count / 2);
    const Counts planted = check_bound(same, count, 4, format, false);
    EXPECT_GT(planted.lost, count / 1000) << "a quarter of the margin must lose boxes";
    const Counts none = check_bound(again, count, 0, format, false);
    EXPECT_GT(none.lost, planted.lost) << "no margin must lose more";
    fmt::print(
        "{} bits: {} visits, {} boxes, {} entered, {} lost at 13/16 M, {} of {} keys wrong, {} "
        "decided exactly; {} lost at M/4, {} without a margin\n",
        format.unit_bits, c.visits, c.boxes, c.entered, c.lost, c.wrong_keys, c.keys, c.exact,
        planted.lost, none.lost);
  }
}

/// With 17/16 M a ray enters every child that it enters in fp32. This needs no exact arithmetic.
TEST_P(IntegerNode, LargerMargin_ContainsTheFloatingPointNode) {
  const TriangleScene scene = GetParam().make();
  NodeVisits visits(scene, 2);
  const std::size_t count = full() ? 250'000 : 20'000;
  std::size_t entered_in_float = 0, lost = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const NodeVisit visit = visits();
    if (visit.infinite) continue;
    const FloatRay ray(visit.o, visit.d, visit.root);
    const unsigned entered = reference::integer_visit(visit.ray(17), visit.node, visit.floor,
                                                      visit.limit, visit.farthest)
                                 .entered;
    for (unsigned c = 0; c < bvh::Node::kChildren; ++c) {
      if (visit.node.child(c) == bvh::Child::kNone) continue;
      const FloatInterval s = float_interval(ray, visit.node, c);
      if (s.near > s.far || s.far < visit.floor || s.near > visit.limit) continue;
      ++entered_in_float;
      lost += (entered >> c & 1) == 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(lost, 0u) << "of " << entered_in_float;
  EXPECT_GT(entered_in_float, count);
}

/// Rays that meet spheres far away have an infinite margin.
TEST_P(IntegerNode, InfiniteMargin_EntersEveryChild) {
  const TriangleScene scene = GetParam().make();
  NodeVisits visits(scene, 3);
  for (unsigned i = 0; i < 2'000; ++i) {
    NodeVisit visit = visits();
    visit.infinite = true;
    const IntegerVisit answer =
        reference::integer_visit(visit.ray(), visit.node, visit.floor, visit.limit, false);
    unsigned all = 0;
    for (unsigned c = 0; c < bvh::Node::kChildren; ++c) {
      if (visit.node.child(c) == bvh::Child::kNone) continue;
      all |= 1u << c;
      EXPECT_EQ(answer.keys[c], 0u) << "key 0 is never culled";
    }
    ASSERT_EQ(answer.entered, all) << "visit " << i;
  }
}

// ---- Traversals ----

/// Nodes in whole numbers of any format.
class IntegerNodes {
 public:
  IntegerNodes(const Ray& ray, const reference::RootBounds<float>& root,
               const IntegerFormat& format)
      : format_(format), ray_(reference::integer_ray(ray.o, ray.d, root)) {}

  struct Visit {
    std::vector<unsigned> order;  // of children
    IntegerVisit answer;
  };
  [[nodiscard]] Visit visit(const bvh::Node& node, float floor, float limit, bool down) const {
    Visit v{{}, reference::integer_visit(ray_, node, floor, limit, down, format_)};
    for (unsigned c = 0; c < bvh::Node::kChildren; ++c)
      if ((v.answer.entered >> c & 1) != 0) v.order.push_back(c);
    std::stable_sort(v.order.begin(), v.order.end(),
                     [&](unsigned a, unsigned b) { return v.answer.keys[a] < v.answer.keys[b]; });
    return v;
  }
  [[nodiscard]] bool excluded(const Visit& v, unsigned child, float best, bool down) const {
    return v.answer.keys[child] > reference::key_limit(v.answer.scale, best, down, format_);
  }

 private:
  IntegerFormat format_;
  IntegerRay ray_;
};

/// Nodes in fp32. Culls by the whole near or far.
class FloatNodes {
 public:
  FloatNodes(const Ray& ray, const reference::RootBounds<float>& root, const IntegerFormat&)
      : ray_(ray.o, ray.d, root) {}

  struct Visit {
    std::vector<unsigned> order;
    std::array<float, bvh::Node::kChildren> first{};  // near, or -far
  };
  [[nodiscard]] Visit visit(const bvh::Node& node, float floor, float limit, bool down) const {
    Visit v;
    for (unsigned c = 0; c < bvh::Node::kChildren; ++c) {
      if (node.child(c) == bvh::Child::kNone) continue;
      const FloatInterval s = float_interval(ray_, node, c);
      if (s.near > s.far || s.far < floor || s.near > limit) continue;
      v.first[c] = down ? -s.far : s.near;
      v.order.push_back(c);
    }
    std::stable_sort(v.order.begin(), v.order.end(),
                     [&](unsigned a, unsigned b) { return v.first[a] < v.first[b]; });
    return v;
  }
  [[nodiscard]] bool excluded(const Visit& v, unsigned child, float best, bool down) const {
    return v.first[child] > (down ? -best : best);
  }

 private:
  FloatRay ray_;
};

/// Traverses a BVH over triangles as reference::Traversal does, with nodes of either kind.
template <class Nodes>
class NodeTraversal {
 public:
  NodeTraversal(const TriangleScene& scene, const Bvh& bvh, IntegerFormat format)
      : scene_(scene),
        bvh_(bvh),
        format_(format),
        root_(reference::root_bounds<float>(bvh.box().min(), bvh.box().max())) {}

  /// Records by ascending index, one unless the mode is hits; empty without a hit.
  std::vector<Record> trace(const Ray& ray, std::uint32_t number, Mode mode) {
    records_.clear();
    if (bvh_.order().empty()) return {};
    floor_ = ray.tmin, limit_ = ray.tmax;
    descend(Nodes(ray, root_, format_), bvh_.nodes()[0], ray, number, mode);
    std::sort(records_.begin(), records_.end(),
              [](const Record& a, const Record& b) { return a.index < b.index; });
    return records_;
  }
  std::size_t nodes = 0, triangles = 0;

 private:
  void descend(const Nodes& front, const bvh::Node& node, const Ray& ray, std::uint32_t number,
               Mode mode) {
    ++nodes;
    const bool down = mode == Mode::kFarthest;
    const auto visit = front.visit(node, floor_, limit_, down);
    for (const unsigned c : visit.order) {
      if (front.excluded(visit, c, down ? floor_ : limit_, down)) return;
      const bvh::Child child = node.child(c);
      if (child == bvh::Child::kNode)
        descend(front, bvh_.nodes()[node.place(c)], ray, number, mode);
      else
        for (unsigned s = 0; s < slots_of(child); ++s) test(node.place(c) + s, ray, number, mode);
    }
  }

  void test(std::uint32_t slot, const Ray& ray, std::uint32_t number, Mode mode) {
    ++triangles;
    const std::uint32_t index = bvh_.order()[slot];
    const Record record = reference::record_of(ray, scene_[index], number, index, true);
    if (!record.f) return;
    if (mode == Mode::kHits || records_.empty()) {
      records_.push_back(record);
    } else {
      const Record& best = records_[0];
      const bool tie = mode == Mode::kAny || record.t == best.t;
      if (tie ? record.index < best.index
              : (mode == Mode::kNearest ? record.t < best.t : record.t > best.t))
        records_[0] = record;
    }
    if (mode == Mode::kNearest) limit_ = records_[0].t;
    if (mode == Mode::kFarthest) floor_ = records_[0].t;
  }

  const TriangleScene& scene_;
  const Bvh& bvh_;
  IntegerFormat format_;
  reference::RootBounds<float> root_;
  float floor_ = 0, limit_ = 0;
  std::vector<Record> records_;
};

/// CDE_FULL=1: 400,000 rays in four modes, with two formats.
TEST_P(IntegerNode, Traversals_EqualBruteForce) {
  const TriangleScene scene = GetParam().make();
  const Bvh bvh = Bvh::build(scene);
  Rays draw(scene, 4);
  std::vector<Ray> rays;
  for (unsigned i = 0; i < (full() ? 50'000u : 3'000u); ++i) rays.push_back(draw(i % Rays::kKinds));
  std::map<Mode, std::vector<Record>> should;
  for (const Mode mode : {Mode::kNearest, Mode::kFarthest, Mode::kAny, Mode::kHits}) {
    std::vector<Record>& all = should[mode] = reference::cast(rays, scene, mode, {}, {}, true);
    std::erase_if(all, [](const Record& r) { return !r.f; });
    std::stable_sort(all.begin(), all.end(), [](const Record& a, const Record& b) {
      return a.primary != b.primary ? a.primary < b.primary : a.index < b.index;
    });
  }
  for (const IntegerFormat& format : {IntegerFormat{16, 6}, IntegerFormat{12, 4}}) {
    NodeTraversal<IntegerNodes> whole(scene, bvh, format);
    reference::Traversal library(scene, bvh);
    for (const auto& [mode, all] : should) {
      std::vector<Record> own;
      for (std::uint32_t i = 0; i < rays.size(); ++i)
        for (const Record& r : whole.trace(rays[i], i, mode)) own.push_back(r);
      for (std::uint32_t i = 0; i < rays.size(); ++i) (void)library.trace(rays[i], i, mode);
      EXPECT_TRUE(std::ranges::equal(own, all, same_bits)) << name_of(mode);
      EXPECT_GT(own.size(), rays.size() / 20);
    }
    if (format.unit_bits == IntegerFormat{}.unit_bits) {
      EXPECT_EQ(library.counts().nodes, whole.nodes);
      EXPECT_EQ(library.counts().secondaries, whole.triangles);
    }
  }
}

/// Nodes per ray beside the nodes in fp32, for each kind of ray. Prints the figures of
/// docs/background/bvh_integer.md.
void compare_nodes(const TriangleScene& scene) {
  const Bvh bvh = Bvh::build(scene);
  const unsigned count = full() ? 200'000 : 5'000;
  double whole_nodes = 0, float_nodes = 0, whole_triangles = 0, float_triangles = 0;
  std::string kinds;
  for (unsigned kind = 0; kind < Rays::kKinds; ++kind) {
    Rays draw(scene, 5);
    reference::Traversal whole(scene, bvh);
    NodeTraversal<FloatNodes> in_float(scene, bvh, {});
    for (unsigned i = 0; i < count / Rays::kKinds; ++i) {
      const Ray ray = draw(kind);
      (void)whole.trace(ray, i, Mode::kNearest);
      (void)in_float.trace(ray, i, Mode::kNearest);
    }
    const auto nodes = static_cast<double>(whole.counts().nodes),
               before = static_cast<double>(in_float.nodes);
    kinds += fmt::format(" {:.3f}", nodes / before);
    EXPECT_LT(nodes, 1.032 * before) << "rays of kind " << kind;
    whole_nodes += nodes, float_nodes += before;
    whole_triangles += static_cast<double>(whole.counts().secondaries);
    float_triangles += static_cast<double>(in_float.triangles);
  }
  EXPECT_LT(whole_nodes, 1.03 * float_nodes);
  fmt::print("nodes per ray {:.2f}, {:.3f} of fp32; triangles {:.3f}; nodes by kind{}\n",
             whole_nodes / count, whole_nodes / float_nodes, whole_triangles / float_triangles,
             kinds);
}
TEST_P(IntegerNode, NodesPerRay_AreAsManyAsInFloatingPoint) {
  compare_nodes(GetParam().make());
}

/// Nodes of a floor have no height, so a byte step is 2^-80 there. Its T must not set the scale.
TEST(IntegerNodeOfAFloor, NodesPerRay_AreAsManyAsInFloatingPoint) {
  for (const int axis : {0, 1, 2}) {
    TriangleScene scene;
    for (int i = 0; i < 256; ++i) {
      Vector3f corner = Vector3f::Constant(0.75f), a = Vector3f::Zero(), b = Vector3f::Zero();
      corner[(axis + 1) % 3] = static_cast<float>(i % 16) * 0.3f;
      corner[(axis + 2) % 3] = static_cast<float>(i / 16) * 0.3f;
      a[(axis + 1) % 3] = 0.25f, b[(axis + 2) % 3] = 0.25f;
      scene.push_back({corner, corner + a, corner + b});
    }
    compare_nodes(scene);
  }
}

}  // namespace
}  // namespace cde::testing
