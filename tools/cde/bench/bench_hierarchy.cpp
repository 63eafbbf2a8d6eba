// SPDX-License-Identifier: Apache-2.0
// cde bench hierarchy: rays through the hierarchy of a card, its own clocks and with the bus, what
// simulating it takes, its refit, and Embree on the same rays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <span>

#include "bench/bench.hpp"
#include "bench/flight_rays.hpp"
#include "bench/rivals.hpp"
#include "cde/card/board.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "output/busy.hpp"
#include "output/json_keys.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kPacket = 256, kRing = 4096;  // rays that are there before the pass begins
constexpr int kRounds = 5;

template <class Work>
double seconds_of(const Work& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The median of some rounds.
template <class Work>
double median_of(const Work& work) {
  std::array<double, kRounds> seconds{};
  for (int i = 0; i < kRounds; ++i)
    seconds.at(static_cast<std::size_t>(i)) = seconds_of([&] { work(i); });
  std::sort(seconds.begin(), seconds.end());
  return seconds[kRounds / 2];
}

/// Where a ray differs from the reference's way through the hierarchy nothing is measured.
void compare(const Mesh& mesh, const Hierarchy& tree, std::span<const Ray> rays,
             std::span<const Record> records) {
  reference::Traversal walk(mesh, tree);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!same_bits(records[i],
                   walk.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kNearest)[0]))
      throw Error(ErrorCode::kMismatch, fmt::format("ray {} differs from the reference", i));
}

ordered_json card_with(Memory memory, const BenchOptions& o, const Mesh& mesh,
                       const Hierarchy& tree, std::span<const Ray> rays) {
  const BoardConfig config{.lanes = 4, .box = true, .node_units = 2};
  Board board = Board::open(
      config, {.memory = memory, .clock_period_ps = static_cast<std::uint32_t>(1e12 / o.clock_hz)});
  board.upload(mesh, tree);
  const Query query{.through = Through::kHierarchy};
  Counters packet, ring, stream;
  board.load(rays.first(kPacket));
  compare(mesh, tree, rays.first(kPacket), board.run(query, &packet));
  std::vector<Record> records;
  const RecordSink keep = [&](std::span<const Record> some) {
    records.insert(records.end(), some.begin(), some.end());
  };
  ring = board.cast(rays.first(kRing), query, keep);
  records.clear();
  const double seconds = seconds_of([&] { stream = board.cast(rays, query, keep); });
  compare(mesh, tree, rays, records);
  const Counters refit = board.refit();
  const auto count = static_cast<double>(rays.size());
  const double of_ring = static_cast<double>(ring.cycles) / kRing,
               bus = static_cast<double>(stream.time.total()) * 1e-12 / count;
  const char* name = memory == Memory::kIdeal ? "ideal" : "DDR-400";
  show(
      "  {:<8} 256 rays {:6.1f} us; streamed {:5.1f} M rays/s ({:.2f} clocks each), over PCI "
      "64/66 with all transfers {:.2f} M rays/s; refit {:.2f} ms; simulated {:.0f} k rays/s\n",
      name, 1e6 * static_cast<double>(packet.cycles) / o.clock_hz, 1e-6 * o.clock_hz / of_ring,
      of_ring, 1e-6 / bus, 1e3 * static_cast<double>(refit.cycles) / o.clock_hz,
      1e-3 * count / seconds);
  return {{"memory", name},
          {"packet_cycles", packet.cycles},
          {"packet_seconds", static_cast<double>(packet.cycles) / o.clock_hz},
          {"cycles_per_ray", of_ring},
          {"rays_per_second_device", o.clock_hz / of_ring},
          {"rays_per_second_with_bus", 1 / bus},
          {"refit_cycles", refit.cycles},
          {"refit_seconds", static_cast<double>(refit.cycles) / o.clock_hz},
          {"nodes_per_ray", static_cast<double>(stream.nodes) / count},
          {"triangles_per_ray", static_cast<double>(stream.pairs) / count},
          {"rays_per_second_simulated", count / seconds}};
}

ordered_json embree_on(const Mesh& mesh, std::span<const Ray> rays) {
  if (!EmbreeRival::available()) {
    show("  Embree: not built with this program\n");
    return nullptr;
  }
  std::vector<float> hits;
  EmbreeRival rival(mesh);
  (void)rival.cast(rays.first(kPacket));
  const double warm = median_of([&](int) { hits = rival.cast(rays.first(kPacket)); }),
               fresh = median_of([&](int i) {
                 hits =
                     rival.cast(rays.subspan(static_cast<std::size_t>(i + 1) * kPacket, kPacket));
               }),
               stream = median_of([&](int) { hits = rival.cast(rays); });
  const double refit = median_of([&](int) { rival.move(0, mesh.vertices); });
  const double a_ray = stream / static_cast<double>(rays.size());
  show(
      "  Embree   256 rays {:6.1f} us warm, {:.1f} us fresh; {:.2f} M rays/s; refit {:.1f} ms, one "
      "thread, wall time\n",
      1e6 * warm, 1e6 * fresh, 1e-6 / a_ray, 1e3 * refit);
  return {{"packet_seconds_warm", warm},
          {"packet_seconds_fresh", fresh},
          {"rays_per_second", 1 / a_ray},
          {"refit_seconds", refit}};
}

ordered_json on_mesh(const BenchOptions& o, const TerrainOptions& options) {
  const Mesh mesh = make_terrain(options);
  const Busy busy(fmt::format("rays through {} triangles", mesh.faces.size()), false);
  Hierarchy tree;
  const double build = seconds_of([&] { tree = Hierarchy::build(mesh, {.threads = 1}); });
  const std::vector<Ray> rays = flight_rays(mesh, o.quick ? 8'192 : 65'536);
  const std::size_t bytes = tree.nodes().size_bytes() + tree.order().size_bytes();
  show(
      "\n{} triangles: {} nodes, {} levels, {:.1f} bytes a triangle, built in {:.3f} s by one "
      "thread; card of 2 node units at {:g} MHz, fp32, {} rays\n",
      mesh.faces.size(), tree.nodes().size(), tree.depth(),
      static_cast<double>(bytes) / static_cast<double>(mesh.faces.size()), build, o.clock_hz / 1e6,
      rays.size());
  ordered_json j{{"triangles", mesh.faces.size()}, {"nodes", tree.nodes().size()},
                 {"levels", tree.depth()},         {"bytes", bytes},
                 {"build_seconds", build},         {"rays", rays.size()}};
  for (const Memory memory : {Memory::kIdeal, Memory::kCycle})
    j["card"].push_back(card_with(memory, o, mesh, tree, rays));
  j["embree"] = embree_on(mesh, rays);
  return j;
}

}  // namespace

ordered_json bench_hierarchy(const BenchOptions& o) {
  show("\nHierarchy: device times are modelled clocks, the others wall time of this machine\n");
  ordered_json all = ordered_json::array();
  all.push_back(on_mesh(o, {.quads_x = 80, .quads_y = 80}));
  if (!o.quick) all.push_back(on_mesh(o, {}));
  return all;
}

}  // namespace cde::cli
