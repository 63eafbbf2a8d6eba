// SPDX-License-Identifier: Apache-2.0
#include "baselines/binary_bvh.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "cde/support/error.hpp"

namespace cde::baseline {
namespace {

using Box = Eigen::AlignedBox3f;

/// From this level on splits are at medians, so at most 28 levels follow.
constexpr unsigned kLastBinned = 32;
constexpr unsigned kBins = 16;

float area(const Box& box) {
  if (box.isEmpty()) return 0;
  const Eigen::Vector3f s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

struct Bin {
  Box box;
  std::size_t count = 0;
  void add(const Bin& other) { box.extend(other.box), count += other.count; }
};

/// A binned split: triangles whose bin on `axis` is below `first_right` go to the left.
struct BinnedSplit {
  int axis = 0;
  unsigned first_right = 0;
  float cost = std::numeric_limits<float>::infinity();
};

class BinaryBuilder {
 public:
  explicit BinaryBuilder(std::span<const Triangle> triangles)
      : boxes_(triangles.size()), centres_(triangles.size()) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (const auto* v : {&triangles[i].v0, &triangles[i].v1, &triangles[i].v2})
        boxes_[i].extend(*v);
      centres_[i] = boxes_[i].min() * 0.5f + boxes_[i].max() * 0.5f;
      bvh_.box.extend(boxes_[i]);
    }
    bvh_.order.resize(triangles.size());
    std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
  }

  BinaryBvh build() {
    const std::size_t count = bvh_.order.size();
    bvh_.nodes.reserve(count);
    bvh_.nodes.emplace_back();
    if (count == 1) {  // the root has two children, here the same leaf
      set_child(0, 0, boxes_[0], 1);
      set_child(0, 1, boxes_[0], 1);
      bvh_.levels = 1;
    } else {
      split(0, 0, count, 1);
    }
    return std::move(bvh_);
  }

 private:
  void set_child(std::size_t node, int side, const Box& box, std::uint32_t child) {
    BinaryNode& n = bvh_.nodes[node];
    for (auto [words, k] : {std::pair(n.x, 0), std::pair(n.y, 1), std::pair(n.z, 2)})
      words[2 * side] = box.min()[k], words[2 * side + 1] = box.max()[k];
    n.child[side] = child;
  }

  /// Splits places first to last, at least two, among the children of a node.
  void split(std::size_t node, std::size_t first, std::size_t last, unsigned level) {
    bvh_.levels = std::max(bvh_.levels, level);
    const std::size_t middle = partition(first, last, level);
    int side = 0;
    for (const auto& [from, to] : {std::pair(first, middle), std::pair(middle, last)}) {
      Box box;
      for (std::size_t i = from; i < to; ++i) box.extend(boxes_[bvh_.order[i]]);
      const std::size_t count = to - from;
      if (count <= BinaryBvh::kLeaf) {
        set_child(node, side, box, static_cast<std::uint32_t>(from * 8 + count));
      } else {
        const std::size_t child = bvh_.nodes.size();
        bvh_.nodes.emplace_back();
        set_child(node, side, box, static_cast<std::uint32_t>(child * 8));
        split(child, from, to, level + 1);
      }
      ++side;
    }
  }

  std::size_t partition(std::size_t first, std::size_t last, unsigned level) {
    Box centres;
    for (std::size_t i = first; i < last; ++i) centres.extend(centres_[bvh_.order[i]]);
    const auto begin = bvh_.order.begin();
    if (level < kLastBinned) {
      BinnedSplit best;
      for (int axis = 0; axis < 3; ++axis) {
        const BinnedSplit here = cheapest(first, last, axis, centres);
        if (here.cost < best.cost) best = here;
      }
      if (best.first_right != 0) {
        const auto left = [&](std::uint32_t i) {
          return bin_of(i, best.axis, centres) < best.first_right;
        };
        return static_cast<std::size_t>(std::partition(begin + static_cast<std::ptrdiff_t>(first),
                                                       begin + static_cast<std::ptrdiff_t>(last),
                                                       left) -
                                        begin);
      }
    }
    Eigen::Index axis = 0;
    centres.sizes().maxCoeff(&axis);
    const std::size_t middle = first + (last - first) / 2;
    std::nth_element(
        begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
        begin + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t a, std::uint32_t b) {
          const float x = centres_[a][axis], y = centres_[b][axis];
          return x != y ? x < y : a < b;
        });
    return middle;
  }

  [[nodiscard]] unsigned bin_of(std::uint32_t i, int axis, const Box& centres) const {
    const float at = (centres_[i][axis] - centres.min()[axis]) / centres.sizes()[axis];
    return std::min(static_cast<unsigned>(at * kBins), kBins - 1);
  }

  /// The cheapest split along an axis; cost infinity if all centres are in one plane.
  [[nodiscard]] BinnedSplit cheapest(std::size_t first, std::size_t last, int axis,
                                     const Box& centres) const {
    BinnedSplit best{.axis = axis};
    if (!(centres.sizes()[axis] > 0)) return best;
    std::array<Bin, kBins> bins;
    for (std::size_t i = first; i < last; ++i)
      bins.at(bin_of(bvh_.order[i], axis, centres)).add({boxes_[bvh_.order[i]], 1});
    std::array<Bin, kBins> right;  // bins k to the last
    right[kBins - 1] = bins[kBins - 1];
    for (unsigned k = kBins - 1; k-- > 0;) {
      right.at(k) = bins.at(k);
      right.at(k).add(right.at(k + 1));
    }
    Bin left;
    for (unsigned k = 1; k < kBins; ++k) {
      left.add(bins.at(k - 1));
      if (left.count == 0 || right.at(k).count == 0) continue;
      const float cost = area(left.box) * static_cast<float>(left.count) +
                         area(right.at(k).box) * static_cast<float>(right.at(k).count);
      if (cost < best.cost) best.cost = cost, best.first_right = k;
    }
    return best;
  }

  std::vector<Box> boxes_;
  std::vector<Eigen::Vector3f> centres_;
  BinaryBvh bvh_;
};

}  // namespace

BinaryBvh BinaryBvh::build(std::span<const Triangle> triangles) {
  if (triangles.empty()) throw Error(ErrorCode::kBadInput, "the mesh has no triangles");
  if (triangles.size() > std::size_t{1} << 28)
    throw Error(ErrorCode::kCapacity, "the mesh has more than 2^28 triangles");
  return BinaryBuilder(triangles).build();
}

}  // namespace cde::baseline
