// SPDX-License-Identifier: Apache-2.0
#include "cde/reference/traversal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "cde/contract/records.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/ray_node.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/error.hpp"
#include "query/record_choice.hpp"

namespace cde::reference {
namespace {

using hierarchy::Child;
using hierarchy::Node;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// What a card's stack has of a number, 16 bits: one that is not above it, or not below.
float half(float x, bool up) {
  const auto word = std::bit_cast<std::uint32_t>(x);
  const bool away = (word & 0xffffu) != 0 && std::signbit(x) != up;
  return std::bit_cast<float>((word & 0xffff0000u) + (away ? 0x10000u : 0u));
}

/// Children of a node that are still to be visited, from the last to the first.
struct Group {
  struct Entry {
    float key;  ///< that it is left out by: near, or far downwards
    std::uint32_t place;
    Child child;
  };
  std::array<Entry, Node::kChildren> entries;
  unsigned count = 0;
};

}  // namespace

/// One ray's way.
class Traversal::Walk {
 public:
  enum class Goal { kNearest, kFarthest, kHits, kAny, kOccluded };

  Walk(Traversal& of, const Ray& ray, std::uint32_t number, Goal goal)
      : of_(of), ray_(ray), number_(number), goal_(goal), tmax_(ray.tmax), tmin_(ray.tmin) {
    const auto& box = of.hierarchy_.box();
    front_ = ray_front<float>(ray.o, ray.d, root_bounds<float>(box.min(), box.max()));
    visit(of.hierarchy_.nodes()[0]);
    while (!over_ && depth_ != 0) {
      Group& top = stack_[depth_ - 1];
      const Group::Entry next = top.entries[--top.count];
      // Entries come in the order of their keys: where one is too far, so are the others.
      const bool whole = excluded(next.key);
      if (whole || top.count == 0) --depth_;
      if (whole) continue;
      if (next.child == Child::kNode)
        visit(of.hierarchy_.nodes()[next.place]);
      else
        test(next.place, slots_of(next.child));
    }
  }

  [[nodiscard]] std::vector<Record>& records() { return records_; }

 private:
  /// Whether nothing behind a child with this key counts any more.
  [[nodiscard]] bool excluded(float key) const {
    return goal_ == Goal::kFarthest ? key < tmin_ : key > tmax_;
  }

  void visit(const Node& node) {
    ++of_.counts_.nodes;
    const NodeFront<float> front = node_front(front_, node);
    Group& group = stack_[depth_];
    group.count = 0;
    const bool down = goal_ == Goal::kFarthest;
    // The last comes first, and of two that are the same the one with the lower number.
    for (unsigned i = Node::kChildren; i-- > 0;) {
      if (node.child(i) == Child::kNone) continue;
      const Stretch<float> s = stretch(front, front_, node, i);
      if (s.near > s.far || s.far < tmin_ || s.near > tmax_) continue;
      group.entries[group.count++] = {down ? s.far : s.near, node.place(i), node.child(i)};
    }
    if (group.count == 0) return;
    std::stable_sort(group.entries.begin(), group.entries.begin() + group.count,
                     [down](const Group::Entry& a, const Group::Entry& b) {
                       return down ? a.key < b.key : a.key > b.key;
                     });
    for (unsigned i = 0; i < group.count; ++i)
      group.entries[i].key = half(group.entries[i].key, down);
    of_.counts_.deepest = std::max(of_.counts_.deepest, ++depth_);
  }

  void test(std::uint32_t slot, unsigned count) {
    for (std::uint32_t s = slot; s < slot + count; ++s) {
      ++of_.counts_.triangles;
      const std::uint32_t index = of_.hierarchy_.order()[s];
      const Record record =
          record_of(ray_, of_.triangles_[index], number_, index, true, of_.algorithm_);
      if (record.f) keep(record);
    }
  }

  void keep(const Record& record) {
    if (goal_ == Goal::kHits || records_.empty()) {
      records_.push_back(record);
    } else if (better(record, records_[0])) {
      records_[0] = record;
    }
    if (goal_ == Goal::kNearest) tmax_ = records_[0].t;
    if (goal_ == Goal::kFarthest) tmin_ = records_[0].t;
    over_ = over_ || goal_ == Goal::kOccluded;
  }

  /// Whatever order the triangles come in: ties have the least index. The two zeros tie.
  [[nodiscard]] bool better(const Record& a, const Record& b) const {
    if (goal_ == Goal::kAny || a.t == b.t) return a.index < b.index;
    return goal_ == Goal::kNearest ? a.t < b.t : a.t > b.t;
  }

  Traversal& of_;
  const Ray& ray_;
  std::uint32_t number_;
  Goal goal_;
  float tmax_, tmin_;  // of what still counts
  RayFront<float> front_;
  /// A node's group is gone before the last of its children is visited, or lies below it.
  std::array<Group, Hierarchy::kMostDepth> stack_;
  unsigned depth_ = 0;
  std::vector<Record> records_;
  bool over_ = false;
};

Traversal::Traversal(const TriangleView& triangles, const Hierarchy& hierarchy, Algorithm algorithm)
    : triangles_(triangles), hierarchy_(hierarchy), algorithm_(algorithm) {
  (void)name(algorithm);  // or it is none
  if (triangles.size() != hierarchy.order().size())
    throw Error(ErrorCode::kUsage, fmt::format("{} triangles with a hierarchy of {}",
                                               triangles.size(), hierarchy.order().size()));
}

std::vector<Record> Traversal::trace(const Ray& ray, std::uint32_t number, Mode mode) {
  if (mode == Mode::kAll)
    throw Error(ErrorCode::kUsage, "mode all has records of all triangles: not by a hierarchy");
  std::vector<Record> records;
  const Record none = unanswered(ray, number, false, {});
  if (!none.bad && triangles_.size() != 0) {
    using Goal = Walk::Goal;
    const Goal goal = mode == Mode::kNearest    ? Goal::kNearest
                      : mode == Mode::kFarthest ? Goal::kFarthest
                      : mode == Mode::kHits     ? Goal::kHits
                                                : Goal::kAny;
    records = std::move(Walk(*this, ray, number, goal).records());
  }
  if (mode == Mode::kHits)
    std::sort(records.begin(), records.end(),
              [](const Record& a, const Record& b) { return a.index < b.index; });
  else if (records.empty())
    records.push_back(none);
  return records;
}

bool Traversal::occluded(const Ray& ray) {
  if (defect(ray) || triangles_.size() == 0) return false;
  return !Walk(*this, ray, 0, Walk::Goal::kOccluded).records().empty();
}

}  // namespace cde::reference
