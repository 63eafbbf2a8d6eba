// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/measured.hpp"
#include "cde/card/memory.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/query/counters.hpp"

/// Rays through a hierarchy of boxes: a card with node units beside Embree on the same rays, those
/// of a flight (flight_rays.hpp). `cde bench hierarchy` and `cde reproduce` show it.
namespace cde::cli {

inline constexpr std::size_t kTreePacket = 256;  ///< rays of a frame
inline constexpr std::size_t kTreeRing = 4096;   ///< that are there before the pass begins
inline constexpr unsigned kTreeUnits = 2;        ///< that read nodes

/// A card with one kind of memory; all of it modelled but for one figure.
struct TreeCard {
  Memory memory = Memory::kIdeal;
  Counters packet;  ///< a frame
  Counters ring;    ///< a full ring
  Counters stream;  ///< all rays
  Counters refit;
  double upload_seconds = 0;  ///< triangles and tree over the bus
  double update_seconds = 0;  ///< all triangles over the bus again, and the refit
  double wall_seconds = 0;    ///< of this machine, for simulating `stream`

  [[nodiscard]] double per_ray(double total) const;  ///< of those in `stream`
};

/// Embree's processor time of one thread for a frame.
struct EmbreeFrames {
  Spread warm;   ///< the same rays again and again
  Spread fresh;  ///< others in every frame
};

/// Likewise.
struct TreeEmbree {
  double build_seconds = 0;
  EmbreeFrames frame;
  Spread stream;  ///< all rays
  Spread refit;
};

/// A mesh and its tree.
struct TreeFigures {
  double clock_hz = 0;
  std::size_t triangles = 0, nodes = 0, rays = 0, hits = 0;
  unsigned levels = 0;
  std::size_t bytes = 0;     ///< of the tree
  double build_seconds = 0;  ///< processor time of one thread
  std::uint64_t records_compared = 0;
  std::vector<TreeCard> cards;
  std::optional<TreeEmbree> embree;  ///< not without it in this build

  [[nodiscard]] double seconds(std::uint64_t clocks) const {
    return static_cast<double>(clocks) / clock_hz;
  }
};

[[nodiscard]] const char* name_of(Memory memory);

/// Error kMismatch if a record differs from the reference's way through the tree, or Embree finds
/// other hits. `known`: Embree's frames on this mesh, if they have been measured.
[[nodiscard]] TreeFigures measure_tree(const Mesh& mesh, std::size_t rays, double clock_hz,
                                       const std::optional<EmbreeFrames>& known = {});

[[nodiscard]] nlohmann::ordered_json tree_json(const TreeFigures& figures);
/// On stdout, for people.
void show_tree(const TreeFigures& figures);

}  // namespace cde::cli
