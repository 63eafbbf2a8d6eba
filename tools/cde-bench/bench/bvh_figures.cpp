// SPDX-License-Identifier: Apache-2.0
#include "bench/bvh_figures.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "baselines/software_baselines.hpp"
#include "bench/bench.hpp"
#include "bench/flight_rays.hpp"
#include "cde/card/board.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// Enough rays that the nodes they need are not in a cache.
constexpr std::size_t kFreshBvhRays = std::size_t{1} << 20;

/// Compares records with the reference's traversal. Error kMismatch at a difference.
void compare(BvhFigures& figures, reference::Traversal& traversal, std::span<const Ray> rays,
             std::span<const Record> records) {
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!same_bits(records[i],
                   traversal.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kNearest)[0]))
      throw Error(ErrorCode::kMismatch, fmt::format("ray {} differs from the reference", i));
  figures.records_compared += rays.size();
}

/// Measures a card, with the timing of its memory or an ideal one. `records` gets the records of
/// the last cast, of all rays.
BvhCard card_with(bool timed, const Mesh& mesh, const Bvh& bvh, std::span<const Ray> rays,
                  BvhFigures& figures, std::vector<Record>& records) {
  BvhCard card;
  const OpenOptions options = options_on(figures.device, timed);
  card.memory = options.memory;
  Board board = Board::open(on(figures.device, {.lanes = figures.device.leaf_lanes(),
                                                .box = true,
                                                .traversal_units = figures.device.traversal_units}),
                            options);
  std::uint64_t before = board.time_ps();
  const auto passed = [&] { return 1e-12 * static_cast<double>(board.time_ps() - before); };
  board.upload(mesh, bvh);
  card.upload_seconds = passed();
  reference::Traversal traversal(mesh, bvh);
  const Query query{.through = Through::kBvh};
  board.load(rays.first(kBvhPacket));
  compare(figures, traversal, rays.first(kBvhPacket), board.run(query, &card.packet));
  const RecordSink keep = [&](std::span<const Record> some) {
    records.insert(records.end(), some.begin(), some.end());
  };
  card.ring = board.cast(rays.first(kBvhRing), query, keep);
  records.clear();
  const auto start = Clock::now();
  card.stream = board.cast(rays, query, keep);
  card.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  compare(figures, traversal, rays, records);
  std::vector<Triangle> triangles(mesh.faces.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.triangle(i);
  before = board.time_ps();
  board.update_shapes(0, std::span<const Triangle>(triangles));
  if (board.refits())
    card.refit = board.refit();
  else
    board.upload(bvh);  // as the host refits it; its processor time is not modelled
  card.update_seconds = passed();
  return card;
}

BvhEmbree embree_on(const Mesh& mesh, std::span<const Ray> rays, std::span<const Record> records,
                    const std::optional<EmbreeFrames>& known) {
  BvhEmbree embree;
  const double start = thread_seconds();
  EmbreeBaseline baseline(mesh);
  embree.build_seconds = thread_seconds() - start;
  compare_hits(records, baseline.cast(rays), "Embree");
  std::vector<float> hits;
  const auto cast = [&](std::span<const Ray> some, std::size_t size) {
    return measured(
        [&, size](std::size_t call) { hits = baseline.cast(turn_of(some, size, call)); });
  };
  if (known) {
    embree.frame = *known;
  } else {
    embree.frame.fresh = cast(flight_rays(mesh, kFreshBvhRays, rays.size()), kBvhPacket);
    embree.frame.warm = cast(rays.first(kBvhPacket), kBvhPacket);
  }
  embree.stream = cast(rays, rays.size());
  embree.refit = measured([&](std::size_t) { baseline.move(0, mesh.vertices); });
  return embree;
}

BvhOpenCl opencl_on(const baseline::OpenClDevice& device, const Mesh& mesh,
                    std::span<const Ray> rays, std::span<const Record> records) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.triangle(i);
  baseline::OpenClRays opencl(device, triangles);
  BvhOpenCl row{.device = device, .bvh = opencl.bvh(), .casts = {}};
  for (const std::size_t size : {kBvhPacket, rays.size()})
    row.casts.push_back(measure_opencl(opencl, Through::kBvh, rays, size, records, device.label()));
  return row;
}

}  // namespace

double BvhCard::per_ray(double total) const {
  return total / static_cast<double>(stream.records);
}

std::string BvhFigures::refit_text(const BvhCard& card) const {
  return card.refit ? duration(seconds(card.refit->cycles)) : "by the host";
}

BvhFigures measure_bvh(const Mesh& mesh, std::size_t count, const Device& device,
                       const std::optional<EmbreeFrames>& known,
                       const std::optional<baseline::OpenClDevice>& opencl) {
  BvhFigures figures;
  figures.device = device;
  figures.triangles = mesh.faces.size();
  figures.rays = count;
  const double start = thread_seconds();
  const Bvh bvh = Bvh::build(mesh, {.threads = 1});
  figures.build_seconds = thread_seconds() - start;
  figures.nodes = bvh.nodes().size();
  figures.levels = bvh.depth();
  figures.bytes = bvh.nodes().size_bytes() + bvh.order().size_bytes();
  const std::vector<Ray> rays = flight_rays(mesh, count);
  std::vector<Record> records;
  // A device with a narrow memory has no other.
  if (!device.narrow_memory)
    figures.cards.push_back(card_with(false, mesh, bvh, rays, figures, records));
  figures.cards.push_back(card_with(true, mesh, bvh, rays, figures, records));
  figures.hits = static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(), [](const Record& r) { return r.f; }));
  if (EmbreeBaseline::available()) figures.embree = embree_on(mesh, rays, records, known);
  if (opencl) figures.opencl = opencl_on(*opencl, mesh, rays, records);
  return figures;
}

std::vector<NodeCacheFigures> measure_node_caches(const Mesh& mesh, std::size_t count,
                                                  const Device& device) {
  std::vector<NodeCacheFigures> all;
  if (device.node_cache == 0) return all;
  const Bvh bvh = Bvh::build(mesh);
  const std::vector<Ray> rays = flight_rays(mesh, count);
  const unsigned own = device.node_cache, pinned = device.pinned_nodes;
  for (const auto& [lines, on_chip] : {std::pair{0u, pinned},
                                       {own / 4, pinned},
                                       {own, pinned},
                                       {4 * own, pinned},
                                       {own, pinned / 4}}) {
    BvhFigures figures;
    figures.device = device;
    figures.device.node_cache = lines;
    figures.device.pinned_nodes = on_chip;
    std::vector<Record> records;
    all.push_back({lines, on_chip, card_with(true, mesh, bvh, rays, figures, records)});
  }
  return all;
}

ordered_json node_caches_json(const std::vector<NodeCacheFigures>& all, const Device& device) {
  auto rows = ordered_json::array();
  for (const NodeCacheFigures& f : all)
    rows.push_back(
        {{"node_cache", f.lines},
         {"pinned_nodes", f.lines == 0 ? ordered_json(nullptr) : ordered_json(f.pinned)},
         {"packet_seconds", static_cast<double>(f.card.packet.cycles) / device.clock_hz()},
         {"cycles_per_ray", static_cast<double>(f.card.ring.cycles) / kBvhRing},
         {"nodes_per_ray", f.card.per_ray(static_cast<double>(f.card.stream.nodes))},
         {"cached_nodes_per_ray", f.card.per_ray(static_cast<double>(f.card.stream.cached_nodes))},
         {"fetched_nodes_per_ray",
          f.card.per_ray(static_cast<double>(f.card.stream.fetched_nodes))}});
  return rows;
}

void show_node_caches(const std::vector<NodeCacheFigures>& all, const Device& device) {
  if (!all.empty())
    print_figure(
        "\nNodes in DDR: {}, {}, without the bus{}\n", device.text(),
        name_of(options_on(device, true).memory),
        device.kind == DeviceKind::kPlaced ? "; sizes other than its own are projected" : "");
  for (const NodeCacheFigures& f : all)
    print_figure(
        "  {:<40} 256 rays {}, streamed {:.2f} M rays/s; per ray {:.2f} nodes, {:.2f} not on chip, "
        "{:.2f} fetched\n",
        f.lines == 0 ? "all nodes on chip"
                     : fmt::format("cache of {} nodes, {} on chip", f.lines, f.pinned),
        duration(static_cast<double>(f.card.packet.cycles) / device.clock_hz()),
        device.clock_mhz * kBvhRing / static_cast<double>(f.card.ring.cycles),
        f.card.per_ray(static_cast<double>(f.card.stream.nodes)),
        f.card.per_ray(static_cast<double>(f.card.stream.cached_nodes)),
        f.card.per_ray(static_cast<double>(f.card.stream.fetched_nodes)));
}

ordered_json bvh_json(const BvhFigures& f) {
  ordered_json j{{"triangles", f.triangles},
                 {"nodes", f.nodes},
                 {"levels", f.levels},
                 {"bytes", f.bytes},
                 {"rays", f.rays},
                 {"build_seconds", f.build_seconds},
                 {"traversal_units", f.device.traversal_units},
                 {"hit_share", static_cast<double>(f.hits) / static_cast<double>(f.rays)},
                 {"card", ordered_json::array()},
                 {"embree", nullptr},
                 {"opencl", nullptr}};
  for (const BvhCard& c : f.cards) {
    const double of_ring = static_cast<double>(c.ring.cycles) / kBvhRing,
                 bus = c.per_ray(1e-12 * static_cast<double>(c.stream.time.total()));
    j["card"].push_back(
        {{"memory", name_of(c.memory)},
         {"packet_cycles", c.packet.cycles},
         {"packet_seconds", f.seconds(c.packet.cycles)},
         {"packet_seconds_with_bus", 1e-12 * static_cast<double>(c.packet.time.total())},
         {"cycles_per_ray", of_ring},
         {"rays_per_second_device", f.device.clock_hz() / of_ring},
         {"rays_per_second_with_bus", 1 / bus},
         {"refit_cycles", c.refit ? ordered_json(c.refit->cycles) : nullptr},
         {"refit_seconds", c.refit ? ordered_json(f.seconds(c.refit->cycles)) : nullptr},
         {"refit_seconds_with_bus", c.update_seconds},
         {"upload_seconds_with_bus", c.upload_seconds},
         {"nodes_per_ray", c.per_ray(static_cast<double>(c.stream.nodes))},
         {"cached_nodes_per_ray", c.per_ray(static_cast<double>(c.stream.cached_nodes))},
         {"fetched_nodes_per_ray", c.per_ray(static_cast<double>(c.stream.fetched_nodes))},
         {"triangles_per_ray", c.per_ray(static_cast<double>(c.stream.pairs))},
         {"rays_per_second_simulated", 1 / c.per_ray(c.wall_seconds)}});
  }
  if (f.embree)
    j["embree"] = {{"build_seconds", f.embree->build_seconds},
                   {"packet_seconds_warm", f.embree->frame.warm.median},
                   {"packet_seconds_fresh", f.embree->frame.fresh.median},
                   {"rays_per_second", static_cast<double>(f.rays) / f.embree->stream.median},
                   {"refit_seconds", f.embree->refit.median},
                   {"spread_warm", spread_json(f.embree->frame.warm)},
                   {"spread_fresh", spread_json(f.embree->frame.fresh)},
                   {"spread_refit", spread_json(f.embree->refit)}};
  if (f.opencl) {
    j["opencl"] = opencl_row_json(f.opencl->device, f.opencl->casts);
    j["opencl"]["build_seconds"] = f.opencl->bvh.build_seconds;
  }
  return j;
}

void show_bvh(const BvhFigures& f) {
  print_figure(
      "\n{} triangles: {} nodes, {} levels, {:.1f} bytes per triangle, built in {} by one thread; "
      "{} of {}, {}, fp32, PCI 64/66, {} rays\n",
      f.triangles, f.nodes, f.levels,
      static_cast<double>(f.bytes) / static_cast<double>(f.triangles), duration(f.build_seconds),
      counted(f.device.traversal_units, "traversal unit"), f.device.text(),
      counted(f.device.leaf_lanes(), "lane"), f.rays);
  for (const BvhCard& c : f.cards) {
    const double of_ring = static_cast<double>(c.ring.cycles) / kBvhRing;
    print_figure(
        "  {:<8} 256 rays {}, with all transfers {}; streamed {:.1f} M rays/s ({:.2f} cycles "
        "each), with all transfers {:.2f} M rays/s; refit {}, with upload of triangles {}; "
        "simulated {:.0f} k rays/s\n",
        name_of(c.memory), duration(f.seconds(c.packet.cycles)),
        duration(1e-12 * static_cast<double>(c.packet.time.total())), f.device.clock_mhz / of_ring,
        of_ring, 1e6 / c.per_ray(static_cast<double>(c.stream.time.total())), f.refit_text(c),
        duration(c.update_seconds), 1e-3 / c.per_ray(c.wall_seconds));
    if (c.stream.cached_nodes != 0)
      print_figure(
          "           per ray {:.2f} nodes, {:.2f} of them not on chip, {:.2f} fetched from DDR "
          "({:.0f} "
          "bytes)\n",
          c.per_ray(static_cast<double>(c.stream.nodes)),
          c.per_ray(static_cast<double>(c.stream.cached_nodes)),
          c.per_ray(static_cast<double>(c.stream.fetched_nodes)),
          c.per_ray(static_cast<double>(4 * bvh::Node::kWords * c.stream.fetched_nodes)));
  }
  if (f.opencl)
    for (const OpenClSeries& s : f.opencl->casts) show_opencl_row(f.opencl->device, s);
  if (!f.embree) {
    print_figure("  Embree: not in this build of cde\n");
    return;
  }
  print_figure(
      "  Embree   256 rays {} warm, {} fresh; {:.2f} M rays/s; refit {}, built in {}; one thread, "
      "its processor time\n",
      duration(f.embree->frame.warm.median), duration(f.embree->frame.fresh.median),
      1e-6 * static_cast<double>(f.rays) / f.embree->stream.median,
      duration(f.embree->refit.median), duration(f.embree->build_seconds));
}

}  // namespace cde::cli
