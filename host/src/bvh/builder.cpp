// SPDX-License-Identifier: Apache-2.0
// Builds a binary BVH by surface area and collapses it into a BVH with nodes of eight children.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>

#include "cde/bvh/bvh.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

using Corner = Eigen::Array4f;  // x, y, z and an unused fourth: one vector register
constexpr unsigned kBins = 16;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct Box {
  Corner lo = Corner::Constant(kInfinite), hi = Corner::Constant(-kInfinite);
  void extend(const Box& other) {
    lo = lo.min(other.lo);
    hi = hi.max(other.hi);
  }
  void extend(const Corner& point) {
    lo = lo.min(point);
    hi = hi.max(point);
  }
  /// Half of the surface.
  [[nodiscard]] float area() const {
    const Corner e = hi - lo;
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
};

/// A secondary in 32 bytes: its box, with its number in the fourth coordinate. kOffset makes the
/// number a normal float.
class Reference {
 public:
  Reference(const Eigen::AlignedBox3f& of, std::uint32_t index) {
    box.lo << of.min(), std::bit_cast<float>(index + kOffset);
    box.hi << of.max(), 0;
  }
  [[nodiscard]] std::uint32_t index() const {
    return std::bit_cast<std::uint32_t>(box.lo[3]) - kOffset;
  }
  [[nodiscard]] Corner centre() const { return box.lo + box.hi; }  // twice the centre
  Box box;

 private:
  static constexpr std::uint32_t kOffset = 1u << 29;  // numbers have 28 bits
};

/// A node of the binary BVH. A leaf has no children.
struct Pairing {
  Box box;
  std::uint32_t children = 0;  ///< number of the first; the second one follows; 0: none
  std::uint32_t first = 0, count = 0;
  unsigned height = 0;
};

/// The least number of levels that so many secondaries need below a node.
unsigned least_height(std::size_t count, unsigned leaf) {
  unsigned height = 0;
  for (std::size_t held = leaf; held < count; held *= 2) ++height;
  return height;
}

class Pairings {
 public:
  /// At most `depth` levels of nodes of eight children: each is three levels of the binary BVH.
  Pairings(std::vector<Reference>& references, unsigned leaf, unsigned threads, unsigned depth)
      : references_(references), leaf_(leaf), capacity_(2 * references.size()) {
    nodes_ = {std::allocator<Pairing>().allocate(capacity_), Free{capacity_}};
    for (unsigned forks = 1; forks < threads; forks *= 2) ++forks_;
    split(0, 0, references.size(), 3 * depth, forks_);
  }
  [[nodiscard]] const Pairing& operator[](std::uint32_t i) const { return nodes_.get()[i]; }

 private:
  struct Bin {
    Box box;
    std::uint32_t count = 0;
  };
  struct Split {
    float cost = kInfinite;
    int axis = -1;
    unsigned bin = 0;  ///< the first bin on the right side
  };
  /// Gives the bin of a centre on each axis.
  struct Binning {
    Corner origin, scale;
    [[nodiscard]] Eigen::Array4i bin(const Corner& centre) const {
      return ((centre - origin) * scale).min(kBins - 1).cast<int>();
    }
  };

  /// Makes node `at` from the references from `first` on. `height` levels are available.
  void split(std::uint32_t at, std::size_t first, std::size_t count, unsigned height,
             unsigned forks) {
    Pairing& node = *std::construct_at(nodes_.get() + at);
    node.first = static_cast<std::uint32_t>(first);
    node.count = static_cast<std::uint32_t>(count);
    Box centres;
    for (std::size_t i = first; i < first + count; ++i) {
      node.box.extend(references_[i].box);
      centres.extend(references_[i].centre());
    }
    if (count <= leaf_) return;
    const std::size_t left = divided(first, count, height, centres);
    const std::uint32_t children = used_.fetch_add(2);
    node.children = children;
    if (forks > 0 && count > 4096) {
      std::thread other([&] { split(children, first, left, height - 1, forks - 1); });
      split(children + 1, first + left, count - left, height - 1, forks - 1);
      other.join();
    } else {
      split(children, first, left, height - 1, 0);
      split(children + 1, first + left, count - left, height - 1, 0);
    }
    node.height = 1 + std::max((*this)[children].height, (*this)[children + 1].height);
  }

  /// Moves the references of the left child to the front and returns their number.
  std::size_t divided(std::size_t first, std::size_t count, unsigned height, const Box& centres) {
    if (least_height(count, leaf_) < height) {
      const Corner extent = centres.hi - centres.lo;
      // An axis without extent has one bin.
      const Binning binning{centres.lo, (extent > 0x1p-100f).select(kBins / extent, 0.0f)};
      const Split best = best_split(first, count, binning);
      if (best.axis >= 0) {
        const auto begin = references_.begin() + static_cast<std::ptrdiff_t>(first);
        const auto middle = std::partition(
            begin, begin + static_cast<std::ptrdiff_t>(count), [&](const Reference& r) {
              return static_cast<unsigned>(binning.bin(r.centre())[best.axis]) < best.bin;
            });
        const auto left = static_cast<std::size_t>(middle - begin);
        if (least_height(std::max(left, count - left), leaf_) <= height - 1) return left;
      }
    }
    return halved(first, count, centres);
  }

  [[nodiscard]] Split best_split(std::size_t first, std::size_t count,
                                 const Binning& binning) const {
    std::array<std::array<Bin, kBins>, 3> bins;
    for (std::size_t i = first; i < first + count; ++i) {
      const Reference& r = references_[i];
      const Eigen::Array4i at = binning.bin(r.centre());
      for (unsigned k = 0; k < 3; ++k) {
        Bin& bin = bins[k][static_cast<unsigned>(at[k])];
        bin.box.extend(r.box);
        ++bin.count;
      }
    }
    Split best;
    for (unsigned k = 0; k < 3; ++k) {
      std::array<float, kBins> right;  // costs of all bins from this one on
      Bin sum;
      for (unsigned b = kBins - 1; b > 0; --b) {
        sum.box.extend(bins[k][b].box);
        sum.count += bins[k][b].count;
        right[b] = sum.count == 0 ? kInfinite : sum.box.area() * static_cast<float>(sum.count);
      }
      sum = {};
      for (unsigned b = 1; b < kBins; ++b) {
        sum.box.extend(bins[k][b - 1].box);
        sum.count += bins[k][b - 1].count;
        if (sum.count == 0) continue;
        const float cost = sum.box.area() * static_cast<float>(sum.count) + right[b];
        if (cost < best.cost) best = {cost, static_cast<int>(k), b};
      }
    }
    return best;
  }

  /// Splits at the median of the longest axis. Ties go by index, so the result does not depend on
  /// the order.
  std::size_t halved(std::size_t first, std::size_t count, const Box& centres) {
    int axis = 0;
    (centres.hi - centres.lo).head<3>().maxCoeff(&axis);
    const auto begin = references_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto middle = begin + static_cast<std::ptrdiff_t>((count + 1) / 2);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(count),
                     [axis](const Reference& a, const Reference& b) {
                       const float x = a.centre()[axis], y = b.centre()[axis];
                       return x != y ? x < y : a.index() < b.index();
                     });
    return (count + 1) / 2;
  }

  std::vector<Reference>& references_;
  unsigned leaf_, forks_ = 0;
  /// Room for the largest possible number of nodes. Unused room is never touched and takes no
  /// memory.
  struct Free {
    std::size_t capacity;
    void operator()(Pairing* all) const { std::allocator<Pairing>().deallocate(all, capacity); }
  };
  std::size_t capacity_;
  std::unique_ptr<Pairing, Free> nodes_{nullptr, Free{0}};
  std::atomic<std::uint32_t> used_{1};
};

Eigen::AlignedBox3f aligned(const Box& box) {
  return {box.lo.head<3>().matrix(), box.hi.head<3>().matrix()};
}

void check_count(std::size_t count) {
  if (count > bvh::Node::kMostNumber)
    throw Error(ErrorCode::kCapacity, fmt::format("a BVH of {} secondaries; expected at most {}",
                                                  count, bvh::Node::kMostNumber));
}

void check_box(std::size_t i, const Eigen::AlignedBox3f& b) {
  constexpr float kMost = 0x1p40f;
  const float most = std::max(b.min().cwiseAbs().maxCoeff(), b.max().cwiseAbs().maxCoeff());
  // A NaN fails this test.
  if (!((b.min().array() <= b.max().array()).all() && most <= kMost))
    throw Error(ErrorCode::kBadInput, fmt::format("secondary {}: its box is from {},{},{} to "
                                                  "{},{},{}; it must not be empty or exceed 2^40",
                                                  i, b.min().x(), b.min().y(), b.min().z(),
                                                  b.max().x(), b.max().y(), b.max().z()));
}

/// c - r, rounded down. c + r rounded up is -below(-c, r).
float below(float c, float r) {
  const float rounded = c - r, part = rounded - c;
  const float error = (c - (rounded - part)) + (-r - part);  // exact: Knuth's sum
  return error < 0 ? std::nextafter(rounded, -kInfinite) : rounded;
}

Eigen::AlignedBox3f box_of(const Sphere& s) {
  Eigen::AlignedBox3f box;
  for (int k = 0; k < 3; ++k) {
    box.min()[k] = below(s.c[k], s.r);
    box.max()[k] = -below(-s.c[k], s.r);
  }
  return box;
}

Eigen::AlignedBox3f box_of(const Aabb& box) {
  return {box.min, box.max};
}

/// x, rounded down. x rounded up is -rounded_down(-x).
float rounded_down(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded > x ? std::nextafter(rounded, -kInfinite) : rounded;
}

/// Products of two floats are exact in double. kUp and the relative margins bound the rounding of
/// the sums, so the box contains the solid.
Eigen::AlignedBox3f box_of(const Obb& solid) {
  constexpr double kUp = 1 + 0x1p-48;
  Eigen::AlignedBox3f box;
  for (int k = 0; k < 3; ++k) {
    const double half =
        kUp * solid.rotation.row(k).cast<double>().cwiseAbs().dot(solid.half.cast<double>());
    const double low = solid.c[k] - half, high = solid.c[k] + half;
    box.min()[k] = rounded_down(low - 0x1p-50 * std::abs(low));
    box.max()[k] = -rounded_down(-high - 0x1p-50 * std::abs(high));
  }
  return box;
}

Eigen::AlignedBox3f box_of(const Triangle& t) {
  Eigen::AlignedBox3f box(t.v0.cwiseMin(t.v1).cwiseMin(t.v2), t.v0.cwiseMax(t.v1).cwiseMax(t.v2));
  // min and max may drop a NaN, so it is put back.
  for (const Eigen::Vector3f* v : {&t.v0, &t.v1, &t.v2})
    if (v->hasNaN()) box.min() = *v;
  return box;
}

/// The boxes of all secondaries. Error kBadInput for a solid that no pipe accepts.
template <class P>
auto boxes_of(std::span<const P> all) {
  return [all](std::size_t i) {
    if (const auto why = defect(all[i]))
      throw Error(ErrorCode::kBadInput, fmt::format("{} {}: {}", name(kShapeOf<P>), i, *why));
    return box_of(all[i]);
  };
}
auto boxes_of(const TriangleView& triangles) {
  return [&triangles](std::size_t i) { return box_of(triangles[i]); };
}

}  // namespace

/// Makes nodes of eight children, level by level.
class BvhBuilder {
 public:
  BvhBuilder(Bvh& to, const Pairings& from, const std::vector<Reference>& references,
             unsigned depth)
      : to_(to), from_(from), most_(depth) {
    to_.nodes_.clear();
    to_.order_.reserve(references.size());
    waiting_.push_back(0);
    for (to_.depth_ = 0; !waiting_.empty(); ++to_.depth_) {
      const std::vector<std::uint32_t> level = std::move(waiting_);
      waiting_.clear();
      next_node_ = static_cast<std::uint32_t>(to_.nodes_.size() + level.size());
      for (const std::uint32_t node : level) add(node, references);
    }
  }

 private:
  /// Children of a node: starts from the binary node and opens children until there are eight.
  /// Opens first the tallest child that would not fit below, then the largest one.
  [[nodiscard]] std::vector<std::uint32_t> opened(std::uint32_t node) const {
    std::vector<std::uint32_t> list = {node};
    const unsigned below = 3 * (most_ - to_.depth_ - 1);
    while (list.size() < bvh::Node::kChildren) {
      std::size_t best = list.size();
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (from_[list[i]].children == 0) continue;
        if (best == list.size() || precedes(from_[list[i]], from_[list[best]], below)) best = i;
      }
      if (best == list.size()) break;
      const std::uint32_t children = from_[list[best]].children;
      list[best] = children;
      list.insert(list.begin() + static_cast<std::ptrdiff_t>(best) + 1, children + 1);
    }
    return list;
  }
  static bool precedes(const Pairing& a, const Pairing& b, unsigned below) {
    const bool a_tall = a.height > below, b_tall = b.height > below;
    if (a_tall || b_tall) return a_tall && (!b_tall || a.height > b.height);
    return a.box.area() > b.box.area();
  }

  void add(std::uint32_t pairing, const std::vector<Reference>& references) {
    using bvh::Child;
    bvh::Node node;
    node.set_first_node(next_node_);
    node.set_first_slot(static_cast<std::uint32_t>(to_.order_.size()));
    std::array<Eigen::AlignedBox3f, bvh::Node::kChildren> boxes;
    unsigned i = 0;
    for (const std::uint32_t child : opened(pairing)) {
      const Pairing& c = from_[child];
      boxes[i] = aligned(c.box);
      if (c.children != 0) {
        node.set_child(i, Child::kNode);
        waiting_.push_back(child);
        ++next_node_;
      } else {
        node.set_child(i, c.count == 1 ? Child::kLeafOfOne : Child::kLeafOfTwo);
        for (std::uint32_t r = c.first; r < c.first + c.count; ++r)
          to_.order_.push_back(references[r].index());
      }
      ++i;
    }
    bvh::set_boxes(node, {boxes.data(), i});
    to_.nodes_.push_back(node);
  }

  Bvh& to_;
  const Pairings& from_;
  unsigned most_;
  std::vector<std::uint32_t> waiting_;
  std::uint32_t next_node_ = 0;
};

Bvh Bvh::build(std::span<const Eigen::AlignedBox3f> boxes, const BvhOptions& options) {
  return build(
      boxes.size(), [&](std::size_t i) { return boxes[i]; }, options, kMostDepth);
}

Bvh Bvh::build(std::size_t count, const BoxOf& box, const BvhOptions& options, unsigned depth) {
  if (options.leaf != 1 && options.leaf != 2)
    throw Error(ErrorCode::kUsage,
                fmt::format("a BVH with leaves of {}; expected 1 or 2", options.leaf));
  check_count(count);
  Bvh made;
  if (count == 0) return made;
  std::vector<Reference> references;
  references.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::AlignedBox3f its = box(i);
    check_box(i, its);
    references.emplace_back(its, static_cast<std::uint32_t>(i));
  }
  const unsigned threads =
      options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  const Pairings pairings(references, options.leaf, threads, depth);
  made.box_ = aligned(pairings[0].box);
  const BvhBuilder builder(made, pairings, references, depth);
  return made;
}

Bvh Bvh::build(const TriangleView& triangles, const BvhOptions& options) {
  return build(triangles.size(), boxes_of(triangles), options, kMostDepth);
}
Bvh Bvh::build(std::span<const Sphere> spheres, const BvhOptions& options) {
  return build(spheres.size(), boxes_of(spheres), options, kMostDepth);
}
Bvh Bvh::build(std::span<const Aabb> boxes, const BvhOptions& options) {
  return build(boxes.size(), boxes_of(boxes), options, kMostDepth);
}
Bvh Bvh::build(std::span<const Obb> boxes, const BvhOptions& options) {
  return build(boxes.size(), boxes_of(boxes), options, kMostDepth);
}

namespace {

/// Levels of the BVH over the boxes of parts, and the most parts. A card has up to 2,048 objects.
constexpr unsigned kTopDepth = 5;
constexpr std::size_t kMostParts = std::size_t{1} << (3 * kTopDepth);

}  // namespace

Bvh Bvh::build(const TriangleView& triangles, std::span<const std::uint32_t> parts,
               const BvhOptions& options) {
  return build(triangles.size(), boxes_of(triangles), parts, options);
}
Bvh Bvh::build(std::span<const Sphere> spheres, std::span<const std::uint32_t> parts,
               const BvhOptions& options) {
  return build(spheres.size(), boxes_of(spheres), parts, options);
}
Bvh Bvh::build(std::span<const Aabb> boxes, std::span<const std::uint32_t> parts,
               const BvhOptions& options) {
  return build(boxes.size(), boxes_of(boxes), parts, options);
}
Bvh Bvh::build(std::span<const Obb> boxes, std::span<const std::uint32_t> parts,
               const BvhOptions& options) {
  return build(boxes.size(), boxes_of(boxes), parts, options);
}

Bvh Bvh::build(std::size_t count, const BoxOf& box, std::span<const std::uint32_t> parts,
               const BvhOptions& options) {
  if (parts.empty()) throw Error(ErrorCode::kUsage, "a BVH needs at least one part");
  if (parts.size() > kMostParts)
    throw Error(ErrorCode::kCapacity,
                fmt::format("a BVH of {} parts; expected at most {}", parts.size(), kMostParts));
  const std::uint64_t all = std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
  if (all != count || std::find(parts.begin(), parts.end(), 0u) != parts.end())
    throw Error(ErrorCode::kUsage,
                fmt::format("the parts have {} secondaries; expected all {}, and no empty part",
                            all, count));
  std::vector<Bvh> bvhs;
  std::size_t first = 0;
  for (std::size_t k = 0; k < parts.size(); first += parts[k++]) {
    try {
      bvhs.push_back(build(
          parts[k], [&](std::size_t i) { return box(first + i); }, options,
          kMostDepth - kTopDepth));
    } catch (const Error& e) {
      if (e.code() != ErrorCode::kBadInput) throw;
      throw Error(ErrorCode::kBadInput, fmt::format("part {}: {}", k, e.what()));
    }
  }
  return joined(bvhs);
}

/// Puts the top BVH first, together with the roots of all BVHs, each behind its parent. The nodes
/// below the roots follow, BVH by BVH.
Bvh Bvh::joined(std::span<const Bvh> bvhs) {
  using bvh::Child;
  const Bvh top = build(
      bvhs.size(), [&](std::size_t i) { return bvhs[i].box(); }, {.leaf = 1, .threads = 1},
      kTopDepth);
  struct Entry {
    bool of_top;
    std::uint32_t number;  ///< its node's number, or its BVH's
  };
  std::vector<Entry> entries = {{true, 0}};
  std::vector<std::size_t> roots(bvhs.size());
  Bvh all;
  all.nodes_.clear();
  for (std::size_t n = 0; n < entries.size(); ++n) {
    all.nodes_.emplace_back();
    if (!entries[n].of_top) {
      roots[entries[n].number] = n;
      continue;
    }
    bvh::Node node = top.nodes()[entries[n].number];
    const bvh::Node from = node;
    node.set_first_node(static_cast<std::uint32_t>(entries.size()));
    node.set_first_slot(0);
    for (unsigned i = 0; i < bvh::Node::kChildren; ++i) {
      if (from.child(i) == Child::kNone) continue;
      const bool of_top = from.child(i) == Child::kNode;
      entries.push_back({of_top, of_top ? from.place(i) : top.order()[from.place(i)]});
      node.set_child(i, Child::kNode);
    }
    all.nodes_[n] = node;
  }
  for (std::size_t k = 0; k < bvhs.size(); ++k) all.add_part(bvhs[k], roots[k]);
  all.box_ = top.box();
  all.depth_ = bvh::check(all.nodes_, all.order_.size());
  return all;
}

void Bvh::add_part(const Bvh& bvh, std::size_t root) {
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  const auto slots = static_cast<std::uint32_t>(order_.size());
  for (std::size_t n = 0; n < bvh.nodes_.size(); ++n) {
    bvh::Node node = bvh.nodes_[n];
    node.set_first_node(first + node.first_node() - 1);
    node.set_first_slot(slots + node.first_slot());
    if (n == 0)
      nodes_[root] = node;
    else
      nodes_.push_back(node);
  }
  for (const std::uint32_t index : bvh.order_) order_.push_back(slots + index);
  parts_.push_back({first, static_cast<std::uint32_t>(bvh.nodes_.size() - 1),
                    static_cast<std::uint32_t>(bvh.order_.size())});
}

void Bvh::refit(std::span<const Eigen::AlignedBox3f> boxes) {
  if (boxes.size() != order_.size())
    throw Error(ErrorCode::kUsage,
                fmt::format("{} secondaries for a BVH of {}", boxes.size(), order_.size()));
  for (std::size_t i = 0; i < boxes.size(); ++i) check_box(i, boxes[i]);
  std::vector<Eigen::AlignedBox3f> of_nodes(nodes_.size());
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children follow their parents
    bvh::Node& node = nodes_[n];
    std::array<Eigen::AlignedBox3f, bvh::Node::kChildren> children;
    for (unsigned i = 0; i < children.size(); ++i) {
      const auto place = node.place(i);
      if (node.child(i) == bvh::Child::kNode) children[i] = of_nodes[place];
      for (unsigned s = 0; s < slots_of(node.child(i)); ++s)
        children[i].extend(boxes[order_[place + s]]);
      of_nodes[n].extend(children[i]);
    }
    bvh::set_boxes(node, children);
  }
  box_ = of_nodes[0];
}

void Bvh::refit(std::size_t count, const BoxOf& box) {
  std::vector<Eigen::AlignedBox3f> boxes(count);
  for (std::size_t i = 0; i < count; ++i) boxes[i] = box(i);
  refit(boxes);
}
void Bvh::refit(const TriangleView& triangles) {
  refit(triangles.size(), boxes_of(triangles));
}
void Bvh::refit(std::span<const Sphere> spheres) {
  refit(spheres.size(), boxes_of(spheres));
}
void Bvh::refit(std::span<const Aabb> boxes) {
  refit(boxes.size(), boxes_of(boxes));
}
void Bvh::refit(std::span<const Obb> boxes) {
  refit(boxes.size(), boxes_of(boxes));
}

}  // namespace cde
