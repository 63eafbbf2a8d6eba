// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/measured.hpp"
#include "bench/opencl_figures.hpp"
#include "cde/card/memory.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/model/device.hpp"
#include "cde/query/counters.hpp"

/// Measures rays against a BVH: a card with traversal units, and Embree on the same rays, from
/// a flight (flight_rays.hpp). `cde bench bvh` and `cde reproduce` print the figures.
namespace cde::cli {

inline constexpr std::size_t kBvhPacket = 256;  ///< rays per frame
inline constexpr std::size_t kBvhRing = 4096;   ///< rays on the card before the pass begins

/// A card with one kind of memory. All figures but wall_seconds are modelled.
struct BvhCard {
  Memory memory = Memory::kIdeal;
  Counters packet;                ///< one frame
  Counters ring;                  ///< a full ring buffer
  Counters stream;                ///< all rays
  std::optional<Counters> refit;  ///< nothing if nodes are in DDR: the host refits them
  double upload_seconds = 0;      ///< upload of triangles and BVH
  double update_seconds = 0;      ///< upload of all triangles, and the refit
  double wall_seconds = 0;        ///< time of this machine to simulate `stream`

  [[nodiscard]] double per_ray(double total) const;  ///< a total over the rays of `stream`
};

/// Embree's processor time per frame, one thread.
struct EmbreeFrames {
  Spread warm;   ///< the same rays in every frame
  Spread fresh;  ///< new rays in every frame
};

/// Embree's figures, in processor time of one thread.
struct BvhEmbree {
  double build_seconds = 0;
  EmbreeFrames frame;
  Spread stream;  ///< all rays
  Spread refit;
};

/// The OpenCL baseline with a BVH of its own, on one device.
struct BvhOpenCl {
  baseline::OpenClDevice device;
  baseline::OpenClRays::BvhFacts bvh;
  std::vector<OpenClSeries> casts;  ///< one frame, all rays
};

/// A mesh and its BVH.
struct BvhFigures {
  Device device;
  std::size_t triangles = 0, nodes = 0, rays = 0, hits = 0;
  unsigned levels = 0;
  std::size_t bytes = 0;     ///< size of the BVH
  double build_seconds = 0;  ///< processor time of one thread
  std::uint64_t records_compared = 0;
  std::vector<BvhCard> cards;
  std::optional<BvhEmbree> embree;  ///< empty in a build without Embree
  std::optional<BvhOpenCl> opencl;  ///< empty without a device

  [[nodiscard]] double seconds(std::uint64_t cycles) const {
    return static_cast<double>(cycles) / device.clock_hz();
  }
  /// How long the card refits, or "by the host".
  [[nodiscard]] std::string refit_text(const BvhCard& card) const;
};

/// The device's card with other sizes of the node cache, DDR-400, without the bus.
struct NodeCacheFigures {
  unsigned lines = 0, pinned = 0;  ///< of Device; 0: all nodes are on chip
  BvhCard card;
};

/// Measures all nodes on chip, a quarter of the device's cache, its own and four times as much;
/// then its own with a quarter of the nodes on chip. Nothing for a device without a node cache.
[[nodiscard]] std::vector<NodeCacheFigures> measure_node_caches(const Mesh& mesh, std::size_t count,
                                                                const Device& device);
[[nodiscard]] nlohmann::ordered_json node_caches_json(const std::vector<NodeCacheFigures>& all,
                                                      const Device& device);
void show_node_caches(const std::vector<NodeCacheFigures>& all, const Device& device);

/// Error kMismatch if a record differs from the reference's traversal, or if Embree
/// or the OpenCL device finds other hits. `known`: Embree's frames on this mesh, if already
/// measured. `opencl`: the device of a row beside Embree.
[[nodiscard]] BvhFigures measure_bvh(const Mesh& mesh, std::size_t rays, const Device& device,
                                     const std::optional<EmbreeFrames>& known = {},
                                     const std::optional<baseline::OpenClDevice>& opencl = {});

[[nodiscard]] nlohmann::ordered_json bvh_json(const BvhFigures& figures);
/// Prints the figures as text.
void show_bvh(const BvhFigures& figures);

}  // namespace cde::cli
