// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/traversal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "cde/contract/records.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/integer_node.hpp"
#include "cde/reference/pipes/convex/obb_obb.hpp"
#include "cde/reference/pipes/convex/sphere_obb.hpp"
#include "cde/reference/pipes/convex/sphere_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_box.hpp"
#include "cde/reference/pipes/convex/triangle_sphere.hpp"
#include "cde/reference/pipes/convex/triangle_triangle.hpp"
#include "cde/reference/pipes/ray_sphere.hpp"
#include "cde/reference/pipes/solid_node.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/error.hpp"
#include "query/record_choice.hpp"

namespace cde::reference {
namespace {

using bvh::Child;
using bvh::Node;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// A key as the card's stack holds it, in 16 bits: rounded down.
float half(float x) {
  const auto word = std::bit_cast<std::uint32_t>(x);
  const bool away = (word & 0xffffu) != 0 && std::signbit(x);
  return std::bit_cast<float>((word & 0xffff0000u) + (away ? 0x10000u : 0u));
}

/// Children of a node that remain to be visited, last one first.
template <class Key>
struct Group {
  struct Entry {
    Key key;  ///< key for culling: the least is visited first
    std::uint32_t place;
    Child child;
  };
  std::array<Entry, Node::kChildren> entries;
  unsigned count = 0;
  TimeScale scale{};  ///< of a ray's keys
};

// ---- What depends on the primary's shape ----

IntegerRay front_of(const Ray& ray, const RootBounds<float>& root, Shape leaf) {
  return integer_ray(ray.o, ray.d, root, leaf);
}
template <class Solid>
SolidFront<float> front_of(const Solid& solid, const RootBounds<float>& root, Shape) {
  return solid_front<float>(solid, root);
}

Record record_from(const Outcome<float>& o, std::uint32_t number, std::uint32_t index) {
  Record r;
  r.f = o.f;
  r.bad = o.bad;
  r.t = canonical(o.t);
  for (int k = 0; k < 3; ++k) r.cp[k] = canonical(o.cp[k]);
  r.index = o.bad ? ~0u : index;
  r.primary = number;
  return r;
}

// The pairs by shapes A and B: plain pairs first, then pairs with the box rule.
Outcome<float> plain(const Ray& a, const Sphere& b) {
  return ray_sphere<float>(a, b);
}
Outcome<float> plain(const Sphere& a, const Sphere& b) {
  return sphere_sphere<float>(a, b);
}
Outcome<float> pipe(const Triangle& a, const Sphere& b) {
  return triangle_sphere<float>(a, b);
}
Outcome<float> pipe(const Triangle& a, const Aabb& b) {
  return triangle_aabb<float>(a, b);
}
Outcome<float> pipe(const Triangle& a, const Obb& b) {
  return triangle_obb<float>(a, b);
}
Outcome<float> pipe(const Triangle& a, const Triangle& b) {
  return triangle_triangle<float>(a, b);
}
Outcome<float> pipe(const Sphere& a, const Obb& b) {
  return sphere_obb<float>(a, b);
}
Outcome<float> pipe(const Obb& a, const Obb& b) {
  return obb_obb<float>(a, b);
}

Record answer(const Ray& ray, const Triangle& triangle, std::uint32_t number, std::uint32_t index,
              Algorithm algorithm) {
  return record_of(ray, triangle, number, index, true, algorithm);
}
/// Either shape may be in the BVH.
template <class P, class L>
Record answer(const P& primary, const L& secondary, std::uint32_t number, std::uint32_t index,
              Algorithm) {
  if constexpr (requires { plain(primary, secondary); })
    return record_from(plain(primary, secondary), number, index);
  else if constexpr (requires { pipe(primary, secondary); })
    return record_from(bounded<float>(pipe(primary, secondary), primary, secondary), number, index);
  else if constexpr (requires { pipe(secondary, primary); })
    return record_from(bounded<float>(pipe(secondary, primary), secondary, primary), number, index);
  else
    throw Error(ErrorCode::kUsage, fmt::format("{}s cannot traverse a BVH over {}s",
                                               name(kShapeOf<P>), name(kShapeOf<L>)));
}

/// The value that modes compare: T, or for solids the signed distance.
template <class P>
float signed_t(const Record& r) {
  return !std::is_same_v<P, Ray> && r.f ? -r.t : r.t;
}

}  // namespace

/// Traverses the BVH for one primary.
template <class P>
class Traversal::Trace {
 public:
  Trace(Traversal& of, const P& primary, std::uint32_t number, Goal goal)
      : of_(of), primary_(primary), number_(number), goal_(goal) {
    if constexpr (kSolid) {
      tmax_ = goal == Goal::kNearest ? kInfinite : 0.0f;
    } else {
      tmin_ = primary.tmin;
      tmax_ = primary.tmax;
    }
    const auto& box = of.bvh_.box();
    front_ = front_of(primary, root_bounds<float>(box.min(), box.max()),
                      std::holds_alternative<std::span<const Sphere>>(of.secondaries_)
                          ? Shape::kSphere
                          : Shape::kTriangle);
    visit(of.bvh_.nodes()[0]);
    while (!over_ && depth_ != 0) {
      Entries& top = stack_[depth_ - 1];
      const auto next = top.entries[--top.count];
      // Entries are ordered by key: if one is too far, so is the rest.
      const bool whole = excluded(top, next.key);
      if (whole || top.count == 0) --depth_;
      if (whole) continue;
      if (next.child == Child::kNode)
        visit(of.bvh_.nodes()[next.place]);
      else
        test(next.place, slots_of(next.child));
    }
  }

  [[nodiscard]] std::vector<Record>& records() { return records_; }

 private:
  static constexpr bool kSolid = !std::is_same_v<P, Ray>;
  using Key = std::conditional_t<kSolid, float, unsigned>;
  using Entries = Group<Key>;

  [[nodiscard]] bool down() const { return goal_ == Goal::kFarthest; }

  /// Whether no pair below a child with this key counts.
  [[nodiscard]] bool excluded(const Entries& group, Key key) const {
    if constexpr (kSolid)
      return key > tmax_;
    else
      return key > key_limit(group.scale, down() ? tmin_ : tmax_, down());
  }

  void visit(const Node& node) {
    ++of_.counts_.nodes;
    Entries& group = stack_[depth_];
    group.count = 0;
    fill(group, node);
    if (group.count == 0) return;
    // The last entry is visited first. For equal keys, the lower number is visited first.
    std::stable_sort(group.entries.begin(), group.entries.begin() + group.count,
                     [](const auto& a, const auto& b) { return a.key > b.key; });
    if constexpr (kSolid)
      for (unsigned i = 0; i < group.count; ++i) group.entries[i].key = half(group.entries[i].key);
    of_.counts_.deepest = std::max(of_.counts_.deepest, ++depth_);
  }

  /// The children that the primary meets, by descending number.
  void fill(Entries& group, const Node& node) {
    const auto add = [&](unsigned i, Key key) {
      group.entries[group.count++] = {key, node.place(i), node.child(i)};
    };
    if constexpr (kSolid) {
      const SolidNode<float> front = solid_node(front_, node);
      for (unsigned i = Node::kChildren; i-- > 0;) {
        const float key = distance_key(axis_distances(front, node, i));
        if (node.child(i) != Child::kNone && key <= tmax_) add(i, key);
      }
    } else {
      const IntegerVisit met = integer_visit(front_, node, tmin_, tmax_, down());
      group.scale = met.scale;
      for (unsigned i = Node::kChildren; i-- > 0;)
        if ((met.entered >> i & 1) != 0) add(i, met.keys[i]);
    }
  }

  void test(std::uint32_t slot, unsigned count) {
    for (std::uint32_t s = slot; s < slot + count; ++s) {
      ++of_.counts_.secondaries;
      const std::uint32_t index = of_.bvh_.order()[s];
      const Record record = std::visit(
          [&](const auto& all) {
            return answer(primary_, all[index], number_, index, of_.algorithm_);
          },
          of_.secondaries_);
      if (record.f || (kSolid && goal_ == Goal::kNearest)) keep(record);
    }
  }

  void keep(const Record& record) {
    if (goal_ == Goal::kHits || records_.empty()) {
      records_.push_back(record);
    } else if (better(record, records_[0])) {
      records_[0] = record;
    }
    if (goal_ == Goal::kNearest && kSolid)
      tmax_ = distance_key<float>(records_[0].f, signed_t<P>(records_[0]));
    if (goal_ == Goal::kNearest && !kSolid) tmax_ = records_[0].t;
    if (goal_ == Goal::kFarthest) tmin_ = records_[0].t;
    over_ = over_ || goal_ == Goal::kOccluded;
  }

  /// Order-independent: ties go to the least index. +0 and -0 tie.
  [[nodiscard]] bool better(const Record& a, const Record& b) const {
    const float x = signed_t<P>(a), y = signed_t<P>(b);
    if (goal_ == Goal::kAny || x == y) return a.index < b.index;
    return goal_ == Goal::kNearest ? x < y : x > y;
  }

  Traversal& of_;
  const P& primary_;
  std::uint32_t number_;
  Goal goal_;
  /// The T interval that still counts. For solids, tmax_ is the largest key (distance_key()).
  float tmax_ = 0, tmin_ = 0;
  std::conditional_t<kSolid, SolidFront<float>, IntegerRay> front_;
  /// When a node's last child is visited, its group is already popped. So depth is bounded.
  std::array<Entries, Bvh::kMostDepth> stack_;
  unsigned depth_ = 0;
  std::vector<Record> records_;
  bool over_ = false;
};

Traversal::Traversal(Secondaries secondaries, std::size_t count, std::string_view shape,
                     const Bvh& bvh, Algorithm algorithm)
    : secondaries_(secondaries), bvh_(bvh), algorithm_(algorithm) {
  (void)name(algorithm);  // throws for an unknown algorithm
  if (count != bvh.order().size())
    throw Error(ErrorCode::kUsage,
                fmt::format("{} {}s for a BVH of {}", count, shape, bvh.order().size()));
}
Traversal::Traversal(const TriangleView& triangles, const Bvh& bvh, Algorithm algorithm)
    : Traversal(triangles, triangles.size(), name(Shape::kTriangle), bvh, algorithm) {}
Traversal::Traversal(std::span<const Sphere> spheres, const Bvh& bvh)
    : Traversal(spheres, spheres.size(), name(Shape::kSphere), bvh, Algorithm::kMoller) {}
Traversal::Traversal(std::span<const Aabb> boxes, const Bvh& bvh)
    : Traversal(boxes, boxes.size(), name(Shape::kAabb), bvh, Algorithm::kMoller) {}
Traversal::Traversal(std::span<const Obb> boxes, const Bvh& bvh)
    : Traversal(boxes, boxes.size(), name(Shape::kObb), bvh, Algorithm::kMoller) {}

template <class P>
std::vector<Record> Traversal::trace_any(const P& primary, std::uint32_t number, Mode mode) {
  if (mode == Mode::kAll)
    throw Error(ErrorCode::kUsage, "mode all reports every secondary, so it cannot use a BVH");
  if (mode == Mode::kFarthest && !std::is_same_v<P, Ray>)
    throw Error(ErrorCode::kUsage, "a BVH cannot find the farthest shape from a solid");
  std::vector<Record> records;
  const Record none = unanswered(primary, number, false, {});
  if (!none.bad && !bvh_.order().empty()) {
    const Goal goal = mode == Mode::kNearest    ? Goal::kNearest
                      : mode == Mode::kFarthest ? Goal::kFarthest
                      : mode == Mode::kHits     ? Goal::kHits
                                                : Goal::kAny;
    records = std::move(Trace<P>(*this, primary, number, goal).records());
  }
  if (mode == Mode::kHits)
    std::sort(records.begin(), records.end(),
              [](const Record& a, const Record& b) { return a.index < b.index; });
  else if (records.empty())
    records.push_back(none);
  return records;
}

std::vector<Record> Traversal::trace(const Ray& ray, std::uint32_t number, Mode mode) {
  return trace_any(ray, number, mode);
}
template <class P>
bool Traversal::meets_any(const P& primary) {
  if (defect(primary) || bvh_.order().empty()) return false;
  return !Trace<P>(*this, primary, 0, Goal::kOccluded).records().empty();
}

bool Traversal::occluded(const Ray& ray) {
  return meets_any(ray);
}
template std::vector<Record> Traversal::trace_any(const Sphere&, std::uint32_t, Mode);
template std::vector<Record> Traversal::trace_any(const Aabb&, std::uint32_t, Mode);
template std::vector<Record> Traversal::trace_any(const Obb&, std::uint32_t, Mode);
template std::vector<Record> Traversal::trace_any(const Triangle&, std::uint32_t, Mode);
template bool Traversal::meets_any(const Sphere&);
template bool Traversal::meets_any(const Aabb&);
template bool Traversal::meets_any(const Obb&);
template bool Traversal::meets_any(const Triangle&);

}  // namespace cde::reference
