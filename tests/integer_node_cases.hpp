// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/reference/integer_node.hpp"
#include "hard_rays.hpp"

/// Rays and nodes for tests of the node in whole numbers (cde/reference/integer_node.hpp).
namespace cde::testing {

/// A ray at a node.
struct NodeVisit {
  Eigen::Vector3f o, d;
  reference::RootBounds<float> root;
  bvh::Node node;
  float floor, limit;
  bool farthest;
  bool infinite;  ///< the margin is infinite, as for rays that meet spheres far away

  /// The ray with a share of the margin M of fp32 nodes, in sixteenths.
  [[nodiscard]] reference::IntegerRay ray(int sixteenths = 13) const {
    auto front = reference::integer_ray(o, d, root, Shape::kTriangle, sixteenths);
    if (infinite) front.margin.setConstant(std::numeric_limits<float>::infinity());
    return front;
  }
};

/// The interval of T in which a ray is in a widened box, in doubles, and a bound of their errors.
struct NearFar {
  double near, far, error;
};

/// The margin m' that the proof in docs/background/bvh_integer.md needs.
template <class Real>
Real least_margin(const NodeVisit& visit) {
  Real reach = 0, most = 0;
  const auto larger = [](Real& a, const Real& b) {
    if (b > a) a = b;
  };
  for (int k = 0; k < 3; ++k)
    for (const float corner : {visit.root.lower[k], visit.root.upper[k]}) {
      const Real x = corner, from = x - Real(visit.o[k]);
      larger(reach, from < 0 ? Real(-from) : from);
      larger(most, x < 0 ? Real(-x) : x);
    }
  const Real u = 0x1p-24, share = 192 * u * (1 + 4 * u);
  return (share * reach + 12 * u * most) / (1 - share);
}

/// A corner of a child's box.
template <class Real>
Real corner_of(const bvh::Node& node, bool upper, unsigned child, int axis) {
  const Real byte = upper ? node.upper(child, axis) : node.lower(child, axis);
  return Real(node.origin()[axis]) + byte * Real(std::ldexp(1.0, node.exponent(axis)));
}

/// The interval for the box of a child, widened by the margin of the proof.
inline NearFar near_far(const NodeVisit& visit, unsigned child) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const double margin = least_margin<double>(visit);
  NearFar all{-kInfinite, kInfinite, 0};
  for (int k = 0; k < 3; ++k) {
    const double o = visit.o[k], d = visit.d[k];
    double low = corner_of<double>(visit.node, false, child, k) - margin - o,
           high = corner_of<double>(visit.node, true, child, k) + margin - o;
    const double size = std::abs(low) + std::abs(high) + 2 * std::abs(o) + 4 * margin;
    if (d == 0) {
      if (low > 0x1p-48 * size || high < -0x1p-48 * size) return {1, -1, 0};
      if (low > -0x1p-48 * size || high < 0x1p-48 * size) all.error = kInfinite;
      continue;
    }
    if (d < 0) std::swap(low, high);
    all.near = std::max(all.near, low / d);
    all.far = std::min(all.far, high / d);
    all.error = std::max(all.error, 0x1p-48 * size / std::abs(d));
  }
  return all;
}

/// Visits of BVHs of hard scenes and of nodes of any size. Rays are the ten kinds of hard::Rays in
/// turn. Some are changed: intervals end where a box begins or ends, rays graze a widened box,
/// components are tiny, margins are infinite.
class NodeVisits {
 public:
  /// The scene must outlive the object.
  NodeVisits(const hard::TriangleScene& scene, unsigned seed)
      : rays_(scene, seed), draw_(seed + 1), bvh_(Bvh::build(scene, {.leaf = 1 + seed % 2})) {
    root_ = reference::root_bounds<float>(bvh_.box().min(), bvh_.box().max());
  }

  static constexpr unsigned kKinds = hard::Rays::kKinds;

  NodeVisit operator()() {
    // A ray goes down the BVH, mostly to children that it meets.
    if (node_ == 0) {
      kind_ = (kind_ + 1) % kKinds;
      ray_ = rays_(kind_);
    }
    NodeVisit visit{ray_.o, ray_.d, root_, bvh_.nodes()[node_], ray_.tmin, ray_.tmax, false, false};
    node_ = next_of(visit);
    change(visit, count_++ % 12);
    visit.farthest = draw_.below(2) == 0;
    return visit;
  }
  /// The kind of the ray of the last visit.
  [[nodiscard]] unsigned kind() const { return kind_; }

 private:
  std::size_t next_of(const NodeVisit& visit) {
    std::vector<std::size_t> met, all;
    for (unsigned i = 0; i < bvh::Node::kChildren; ++i) {
      if (visit.node.child(i) != bvh::Child::kNode) continue;
      all.push_back(visit.node.place(i));
      const NearFar t = near_far(visit, i);
      if (t.near <= t.far) met.push_back(all.back());
    }
    if (all.empty()) return 0;
    if (met.empty()) return draw_.below(4) == 0 ? all[draw_.below(all.size())] : 0;
    return met[draw_.below(met.size())];
  }

  void change(NodeVisit& visit, unsigned how) {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    const auto child = static_cast<unsigned>(draw_.below(bvh::Node::kChildren));
    switch (how) {
      case 0:
      case 1:
      case 2: {  // the interval ends where a box begins, or begins where it ends, or both
        if (how == 2) graze(visit, child);
        const NearFar t = near_far(visit, child);
        if (!(t.near <= t.far) || std::isinf(t.near) || std::isinf(t.far)) return;
        if (how != 1) visit.limit = above(t.near);
        if (how != 0) visit.floor = below(t.far);
        return;
      }
      case 3:
      case 4:
        return graze(visit, child);
      case 5: {  // a tiny component, and a tiny coordinate
        const auto axis = static_cast<int>(draw_.below(3));
        visit.d[axis] = draw_(-1, 1) * draw_.power(-149, -60);
        if (draw_.below(2) == 0) visit.o[(axis + 1) % 3] = draw_(-1, 1) * draw_.power(-149, -100);
        if (visit.d.cwiseAbs().maxCoeff() < 0x1p-34f) visit.d[(axis + 1) % 3] = -0.25f;
        return;
      }
      case 6:
        visit.infinite = draw_.below(4) == 0;
        visit.floor = draw_.below(2) == 0 ? -kInfinite : visit.floor;
        return;
      case 7:
      case 8:
        return anything(visit);
      default:
        return;
    }
  }

  /// Aims the ray just inside an edge of a child's widened box: it leaves on one axis where it
  /// enters on another.
  void graze(NodeVisit& visit, unsigned child) {
    if (visit.node.child(child) == bvh::Child::kNone) return;
    for (int k = 0; k < 3; ++k)
      if (visit.d[k] == 0) return;
    const double margin = least_margin<double>(visit) * draw_(0.9f, 1);
    const auto in = static_cast<int>(draw_.below(3)),
               out = (in + 1 + static_cast<int>(draw_.below(2))) % 3;
    Eigen::Vector3d at;
    for (int k = 0; k < 3; ++k) {
      const double lower = corner_of<double>(visit.node, false, child, k),
                   upper = corner_of<double>(visit.node, true, child, k);
      at[k] = lower + (upper - lower) * draw_(0, 1);
      const bool up = (visit.d[k] > 0) == (k == out);
      if (k == in || k == out) at[k] = up ? upper + margin : lower - margin;
    }
    const Eigen::Vector3d d = visit.d.cast<double>();
    // The origin moves, but its largest coordinate along d stays.
    int most = 0;
    visit.d.cwiseAbs().maxCoeff(&most);
    const Eigen::Vector3d o = at - d * ((at[most] - visit.o[most]) / d[most]);
    if (o.cwiseAbs().maxCoeff() < 0x1p40) visit.o = o.cast<float>();
  }

  /// A node and a ray of any size within the contract.
  void anything(NodeVisit& visit) {
    const int size = static_cast<int>(draw_.below(90)) - 50;
    const auto vector = [&](int low, int high) -> Eigen::Vector3f {
      return {draw_(-1, 1) * draw_.power(low, high), draw_(-1, 1) * draw_.power(low, high),
              draw_(-1, 1) * draw_.power(low, high)};
    };
    std::array<Eigen::AlignedBox3f, bvh::Node::kChildren> boxes;
    const Eigen::Vector3f from = draw_.below(2) == 0 ? vector(-10, 39) : vector(size - 4, size);
    Eigen::AlignedBox3f root;
    for (unsigned i = 0; i < boxes.size(); ++i) {
      visit.node.set_child(i, draw_.below(10) == 0 ? bvh::Child::kNone : bvh::Child::kLeafOfOne);
      for (int corner = 0; corner < 2; ++corner) boxes[i].extend(from + vector(size - 8, size));
      root.extend(boxes[i]);
    }
    const auto flat = static_cast<int>(draw_.below(6));
    if (flat < 3) {  // all children in one plane
      root.min()[flat] = root.max()[flat] = from[flat];
      for (auto& box : boxes) box.min()[flat] = box.max()[flat] = from[flat];
    }
    bvh::set_boxes(visit.node, boxes);
    if (draw_.below(2) == 0) root.extend(vector(-10, 39));
    visit.root = reference::root_bounds<float>(root.min(), root.max());
    visit.d = vector(-20, 20);
    if (draw_.below(4) == 0)
      visit.d[static_cast<int>(draw_.below(3))] = draw_.below(2) == 0 ? 0.0f : -0.0f;
    if (visit.d.cwiseAbs().maxCoeff() < 0x1p-34f) visit.d.x() = 1;
    // Through one of the boxes, or past them.
    const Eigen::Vector3f at = boxes[draw_.below(8)].center() + vector(size - 10, size - 2);
    const Eigen::Vector3f o = at - visit.d * (draw_(-1, 1) * draw_.power(size - 30, size + 20));
    visit.o = o.cwiseMax(-0x1p39f).cwiseMin(0x1p39f);
    if (draw_.below(4) == 0) graze(visit, static_cast<unsigned>(draw_.below(8)));
  }

  static float above(double t) {
    const auto x = static_cast<float>(t);
    return x < t ? std::nextafter(x, std::numeric_limits<float>::infinity()) : x;
  }
  static float below(double t) {
    const auto x = static_cast<float>(t);
    return x > t ? std::nextafter(x, -std::numeric_limits<float>::infinity()) : x;
  }

  hard::Rays rays_;
  hard::Draw draw_;
  Bvh bvh_;
  reference::RootBounds<float> root_{};
  Ray ray_{};
  std::size_t node_ = 0;
  unsigned kind_ = kKinds - 1, count_ = 0;
};

}  // namespace cde::testing
