// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "baselines/baseline.hpp"
#include "baselines/software_baselines.hpp"
#include "bench/bench.hpp"
#include "bench/flight_rays.hpp"
#include "bench/measured.hpp"
#include "bench/reproduce.hpp"
#include "bench/reproduce_opencl.hpp"
#include "cde/contract/records.hpp"
#include "cde/geometry/motion.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/pass.hpp"
#include "cde/reference/reference.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

/// PCI bus signals are simulated cycle by cycle, so modelled times need no model of the bus.
constexpr Bus kBus = Bus::kCycle;
constexpr std::size_t kFreshRays = std::size_t{1} << 20;

Entry software(const std::string& name, const std::string& note, const Spread& spread) {
  return {.name = name,
          .source = Source::kSoftware,
          .seconds = spread.median,
          .note = note,
          .spread = spread};
}

/// One of the cards, with its uploaded data.
class Card {
 public:
  Card(Setup setup, const Device& device)
      : setup_(std::move(setup)),
        clock_hz_(device.clock_hz()),
        board_(Board::open(on(device, {.lanes = setup_.lanes,
                                       .pairs = {Pair::kRayTriangle, Pair::kSphereSphere},
                                       .bus = kBus}),
                           {.clock_period_ps = device.clock_period_ps(),
                            .host = setup_.host,
                            .bus_burst = setup_.burst})) {}

  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] Board& board() { return board_; }

  /// Runs a frame: calls `upload`, which writes DDR, then casts every packet of the primaries.
  template <class P>
  Entry frame(Pair pair, Mode mode, std::span<const P> primaries,
              const std::function<void()>& upload, std::vector<Record>& records) {
    QueryFrame f;
    const std::uint64_t before = board_.time_ps();
    if (upload) upload();
    f.secondary_ps = board_.time_ps() - before;
    records.clear();
    for (std::size_t first = 0; first < primaries.size(); first += card::kMostPrimaries) {
      board_.load_shapes(
          primaries.subspan(first, std::min(card::kMostPrimaries, primaries.size() - first)));
      const Counters c =
          board_.run({.mode = mode, .pair = pair}, [&](std::span<const Record> some) {
            records.insert(records.end(), some.begin(), some.end());
          });
      f.counters += c;
      f.primary_ps += c.time.load;
    }
    const TimeSplit split = time_split(f, clock_hz_);
    return {.name = fmt::format("card, {}", setup_.name),
            .source = Source::kCard,
            .seconds = split.total(),
            .note = fmt::format("{} record{} to the host", grouped(records.size()),
                                records.size() == 1 ? "" : "s"),
            .split = split,
            .time = f.time()};
  }

 private:
  Setup setup_;
  double clock_hz_;
  Board board_;
};

/// State shared by all measurements.
struct Lab {
  Reproduction result;
  std::vector<Card> cards;
  baseline::Kind vector = baseline::Kind::kScalar;
  std::vector<Ray> fresh;  ///< new rays of the same kind as in Figure 5
  std::optional<OpenClRows> opencl;
  std::string doing;
  std::vector<double> works;  ///< estimated work per step, in the order of the steps
  std::size_t begun = 0;      ///< steps
  Progress progress{"measuring"};

  void step(unsigned number, const std::string& what) {
    doing = fmt::format("{} of 4: {}", number, what);
    if (::isatty(STDERR_FILENO) == 0) log("measuring {}\n", doing);
    ++begun;
    progress(share(), doing);
  }
  /// Shows the current measurement within a step.
  void detail(const std::string& what) { progress(share(), fmt::format("{}, {}", doing, what)); }
  /// Share of the work in the completed steps.
  [[nodiscard]] double share() const {
    const auto now = works.begin() + static_cast<std::ptrdiff_t>(begun - 1);
    return std::accumulate(works.begin(), now, 0.0) /
           std::accumulate(works.begin(), works.end(), 0.0);
  }
};

void compare_records(Lab& lab, const std::vector<Record>& card, std::span<const Record> wanted,
                     const std::string& what) {
  std::uint64_t wrong = card.size() != wanted.size() ? 1 : 0;
  for (std::size_t i = 0; i < std::min(card.size(), wanted.size()); ++i)
    wrong += same_bits(card[i], wanted[i]) ? 0 : 1;
  if (wrong != 0)
    differs(what + ": records of the card and of the reference", wrong, wanted.size());
  lab.result.records_compared += wanted.size();
}

void add_paper5(Experiment& e) {
  e.entries = {{.name = "paper, its card",
                .source = Source::kPaper,
                .seconds = kPaperCard,
                .note = "printed"},
               {.name = "paper, its GPU",
                .source = Source::kPaper,
                .seconds = kPaperGpuRatio * kPaperCard,
                .note = "from “four times faster”"},
               {.name = "paper, its 2.8 GHz Xeon",
                .source = Source::kPaper,
                .seconds = kPaperSoftware,
                .note = "printed"}};
}

/// Measures software on the same rays. `move` applies the changes since the last frame.
void add_software(Lab& lab, Experiment& e, const std::vector<Ray>& rays,
                  std::vector<Triangle>& triangles, EmbreeBaseline* embree,
                  const std::vector<Record>& nearest,
                  const std::function<void(EmbreeBaseline&)>& move = {}) {
  const auto brute = [&](baseline::Kind kind, const std::string& name, const std::string& note) {
    lab.detail(fmt::format("{} rays, {}", rays.size(), name));
    std::vector<baseline::ClosestHit> hits;
    const Spread spread =
        measured([&](std::size_t) { hits = baseline::closest(kind, rays, triangles); });
    std::vector<float> t;
    t.reserve(hits.size());
    for (const auto& hit : hits) t.push_back(hit.index == ~0u ? INFINITY : hit.t);
    compare_hits(nearest, t, name.c_str());
    e.entries.push_back(software(name, note, spread));
  };
  brute(baseline::Kind::kScalar, "scalar software", "every pair, one thread");
  if (lab.vector != baseline::Kind::kScalar)
    brute(lab.vector, fmt::format("{} software", lab.result.vector_kind), "every pair, one thread");
  if (embree == nullptr) return;
  lab.detail(fmt::format("{} rays, Embree", rays.size()));
  std::vector<float> t;
  if (move) {
    const Spread spread = measured([&](std::size_t) {
      move(*embree);
      t = embree->cast(rays);
    });
    compare_hits(nearest, t, "Embree");
    e.entries.push_back(software("Embree", "BVH refitted, one thread", spread));
    return;
  }
  t = embree->cast(rays);
  compare_hits(nearest, t, "Embree");
  // Fresh rays: each frame has new rays, so their BVH nodes are not in a near cache and branches
  // are not predicted. Warm rays: the same 256 rays in every frame.
  const auto cast_of = [&](std::size_t of) {
    return measured([&, some = std::span<const Ray>(lab.fresh).first(of)](std::size_t call) {
      t = embree->cast(turn_of(some, rays.size(), call));
    });
  };
  const Spread fresh = cast_of(kFreshRays), warm = cast_of(card::kMostPrimaries);
  e.entries.push_back(software("Embree, fresh rays", "BVH built before, one thread", fresh));
  e.entries.push_back(software("Embree, the same 256 rays again", "with warm caches", warm));
  e.entries.back().warm = true;
}

/// Runs the frame on every card. The last records are records of mode nearest.
void add_cards(Lab& lab, Experiment& e, const std::vector<Ray>& rays,
               const std::vector<Triangle>& triangles, const std::function<void(Board&)>& upload,
               std::vector<Record>& records) {
  for (Card& card : lab.cards) {
    const Mode mode = card.setup().all_records ? Mode::kAll : Mode::kNearest;
    if (mode == Mode::kAll && rays.size() > 1) continue;  // this would be gigabytes of records
    lab.detail(fmt::format("{} rays, card {}", rays.size(), card.setup().name));
    const std::function<void()> work =
        upload ? [&] { upload(card.board()); } : std::function<void()>();
    e.entries.push_back(card.frame(Pair::kRayTriangle, mode, std::span(rays), work, records));
    compare_records(lab, records, reference::cast(rays, triangles, mode), e.title);
  }
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = mesh.triangle(i);
  return triangles;
}

/// Static against static: one ray per frame, as the paper counts, and a full register file.
void figure5(Lab& lab, const Mesh& mesh, EmbreeBaseline* embree) {
  std::vector<Triangle> triangles = triangles_of(mesh);
  for (Card& card : lab.cards) card.board().upload(mesh);
  if (embree != nullptr) lab.fresh = flight_rays(mesh, kFreshRays, card::kMostPrimaries);
  for (const std::size_t count : {std::size_t{1}, card::kMostPrimaries}) {
    Experiment e;
    e.name = fmt::format("{}_rays", count);
    e.title = count == 1
                  ? fmt::format("One ray against {} triangles", grouped(triangles.size()))
                  : fmt::format("{} rays against {} triangles", count, grouped(triangles.size()));
    e.tests = count * triangles.size();
    if (e.tests == kPaperTests) add_paper5(e);
    const std::vector<Ray> rays = flight_rays(mesh, count);
    std::vector<Record> records;
    add_cards(lab, e, rays, triangles, {}, records);
    add_software(lab, e, rays, triangles, embree, records);
    if (lab.opencl) lab.opencl->figure5(e, count);
    lab.result.figure5.push_back(std::move(e));
  }
}

/// Static against dynamic: a band with a tenth of the vertices moves.
void figure6(Lab& lab, Mesh mesh, EmbreeBaseline* embree) {
  const std::size_t vertices = mesh.vertices.size();
  const std::size_t first = 4 * vertices / 10, last = vertices / 2;
  for (std::size_t v = first; v < last; ++v)
    mesh.vertices[v].z() += 25 * std::sin(static_cast<float>(v % 97));
  std::vector<Triangle> triangles = triangles_of(mesh);
  const auto touches = [&](const std::array<std::uint32_t, 3>& face) {
    return std::any_of(face.begin(), face.end(),
                       [&](std::uint32_t v) { return v >= first && v < last; });
  };
  const auto from =
      std::find_if(mesh.faces.begin(), mesh.faces.end(), touches) - mesh.faces.begin();
  const auto to = mesh.faces.rend() - std::find_if(mesh.faces.rbegin(), mesh.faces.rend(), touches);
  const std::span<const Triangle> moved(triangles.begin() + from, triangles.begin() + to);
  lab.result.moved_triangles = moved.size();
  Experiment e;
  e.name = "moved_vertices";
  e.title = fmt::format("One ray against {} triangles, {} of them moved", grouped(triangles.size()),
                        grouped(moved.size()));
  e.tests = triangles.size();
  const std::vector<Ray> rays = flight_rays(mesh, 1);
  std::vector<Record> records;
  add_cards(
      lab, e, rays, triangles,
      [&](Board& board) { board.update_shapes(static_cast<std::size_t>(from), moved); }, records);
  const std::span<const Eigen::Vector3f> places(
      mesh.vertices.begin() + static_cast<std::ptrdiff_t>(first),
      mesh.vertices.begin() + static_cast<std::ptrdiff_t>(last));
  add_software(lab, e, rays, triangles, embree, records,
               [&](EmbreeBaseline& baseline) { baseline.move(first, places); });
  if (lab.opencl) lab.opencl->figure6(e, static_cast<std::size_t>(from), moved, rays, records);
  lab.result.figure6.push_back(std::move(e));
}

std::vector<Sphere> flying_spheres(std::size_t count) {
  std::vector<Sphere> spheres(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k)
      spheres[i].c[k] =
          static_cast<float>(20 * random_unit(3, static_cast<std::uint64_t>(k), i) - 10);
    spheres[i].r = static_cast<float>(0.2 + 0.4 * random_unit(3, 9, i));
  }
  return spheres;
}

void add_sphere_software(Lab& lab, Experiment& e, const std::vector<Sphere>& spheres,
                         std::uint64_t hits) {
  std::array<std::vector<float>, 4> words;
  for (const Sphere& s : spheres) {
    for (std::size_t k = 0; k < 3; ++k) words[k].push_back(s.c[static_cast<Eigen::Index>(k)]);
    words[3].push_back(s.r);
  }
  const SphereArrays arrays{words[0].data(), words[1].data(), words[2].data(), words[3].data(),
                            spheres.size()};
  const auto measure = [&](const char* name, std::uint64_t (*kernel)(const SphereArrays&)) {
    std::uint64_t found = 0;
    const Spread spread = measured([&](std::size_t) { found = kernel(arrays); });
    // Pairs that touch within rounding may differ.
    if (std::max(found, hits) - std::min(found, hits) > 2 + hits / 1000)
      differs("overlaps of software and of the card", std::max(found, hits) - std::min(found, hits),
              hits);
    e.entries.push_back(software(name, "every pair, counted only", spread));
  };
  measure("scalar software", overlaps_scalar);
  if (lab.vector != baseline::Kind::kScalar) measure("AVX2 software", overlaps_avx2);
}

/// Dynamic against dynamic: all spheres move, and all pairs are tested.
void figure7(Lab& lab, std::size_t count) {
  const std::vector<Sphere> spheres = flying_spheres(count);
  Experiment e;
  e.name = fmt::format("{}_spheres", count);
  e.title = fmt::format("{} spheres, every one against every one", grouped(count));
  e.tests = count * count;
  std::uint64_t hits = 0;
  for (Card& card : lab.cards) {
    const Mode mode = card.setup().all_records ? Mode::kAll : Mode::kHits;
    std::vector<Record> records;
    e.entries.push_back(card.frame(
        Pair::kSphereSphere, mode, std::span<const Sphere>(spheres),
        [&] { card.board().upload_shapes(std::span<const Sphere>(spheres)); }, records));
    std::vector<Record> wanted;
    const Shapes all = spheres;
    for (std::size_t first = 0; first < count; first += card::kMostPrimaries) {
      std::vector<Sphere> packet(spheres.begin() + static_cast<std::ptrdiff_t>(first),
                                 spheres.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                       first + card::kMostPrimaries, count)));
      std::vector<std::uint32_t> numbers(packet.size());
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::uint32_t>(i);
      reference::Pass pass({.pair = Pair::kSphereSphere, .mode = mode}, Shapes(packet), numbers,
                           all);
      for (auto some = pass.next(); !some.empty(); some = pass.next())
        wanted.insert(wanted.end(), some.begin(), some.end());
    }
    compare_records(lab, records, wanted, e.title);
    hits = static_cast<std::uint64_t>(
        std::count_if(records.begin(), records.end(), [](const Record& r) { return r.f; }));
  }
  add_sphere_software(lab, e, spheres, hits);
  if (lab.opencl) lab.opencl->figure7(e, spheres, hits);
  lab.result.spheres.push_back(count);
  lab.result.figure7.push_back(std::move(e));
}

/// Entries of Figure 5 for the same frame: the best card's brute force, and Embree if available.
std::optional<EmbreeFrames> of_figure5(const Experiment& e, Entry& brute_force) {
  EmbreeFrames frames;
  for (const Entry& entry : e.entries) {
    if (entry.source == Source::kCard) brute_force = entry;  // the last one is the best card's
    if (entry.source != Source::kSoftware) continue;
    if (entry.spread) (entry.warm ? frames.warm : frames.fresh) = *entry.spread;
  }
  return EmbreeBaseline::available() ? std::optional(frames) : std::nullopt;
}

/// Sides of the terrains with a BVH, in quads, without the terrain of Figure 5.
std::vector<unsigned> sides_of(const ReproduceOptions& o) {
  return o.quick ? std::vector{20u} : std::vector{20u, 40u, 80u, 160u};
}
/// Numbers of moving spheres in Figure 7.
std::vector<std::size_t> spheres_of(const ReproduceOptions& o) {
  return o.quick ? std::vector<std::size_t>{50, 100}
                 : std::vector<std::size_t>{125, 250, 500, 1000};
}

/// Rays that are measured with a BVH.
std::size_t tree_rays_of(const ReproduceOptions& o) {
  return o.quick ? 8'192 : 65'536;
}

/// Estimated work of a frame with brute force, in simulated cycles of a card with one lane.
double frame_work(std::span<const Setup> cards, std::size_t primaries, std::size_t secondaries) {
  constexpr double kCyclesPerRecord = 12;  // over the bus, if the record of every pair leaves
  constexpr double kRestOfCard = 20;       // work to simulate it, in lanes
  double work = 0;
  for (const Setup& card : cards)
    work += card.all_records ? kCyclesPerRecord
                             : (card.lanes + kRestOfCard) / (card.lanes * (1 + kRestOfCard));
  return work * static_cast<double>(primaries) * static_cast<double>(secondaries);
}

/// Estimated work per step: Figures 5 and 6, Figure 7 once per number of spheres, and the terrains
/// with a BVH. The last terrain is the terrain of Figure 5. The work weighs the steps in the
/// progress line.
std::vector<double> works_of(const ReproduceOptions& o, std::span<const Setup> cards,
                             std::size_t triangles) {
  constexpr double kCyclesPerTreeRay = 64;  // with both memories, and the software beside them
  const double one_ray = frame_work(cards, 1, triangles);
  std::vector<double> works = {
      one_ray + frame_work(cards.subspan(1), card::kMostPrimaries, triangles), one_ray};
  for (const std::size_t count : spheres_of(o)) works.push_back(frame_work(cards, count, count));
  const double bvh = kCyclesPerTreeRay * static_cast<double>(tree_rays_of(o));
  for (const unsigned quads : sides_of(o))
    works.push_back(bvh + frame_work(cards.last(1), kBvhPacket, std::size_t{2} * quads * quads));
  works.push_back(bvh);
  return works;
}

/// Measures terrains with a BVH, up to the terrain of Figure 5, whose brute-force time is known.
void with_bvh(Lab& lab, const Mesh& terrain) {
  std::vector<Mesh> meshes;
  for (const unsigned quads : sides_of(lab.result.options))
    meshes.push_back(make_terrain({.quads_x = quads, .quads_y = quads}));
  meshes.push_back(terrain);
  Card& best = lab.cards.back();
  for (const Mesh& mesh : meshes) {
    const std::string name =
        fmt::format("{} rays against {} triangles", kBvhPacket, grouped(mesh.faces.size()));
    lab.step(4, "with a BVH, " + name);
    WithBvh row;
    std::optional<EmbreeFrames> known;
    if (&mesh == &meshes.back()) known = of_figure5(lab.result.figure5.back(), row.brute_force);
    row.figures = measure_bvh(mesh, tree_rays_of(lab.result.options), lab.result.options.device,
                              known, lab.result.options.opencl);
    lab.result.records_compared += row.figures.records_compared;
    if (&mesh != &meshes.back()) {
      lab.detail("card " + best.setup().name);
      best.board().upload(mesh);
      const std::vector<Ray> rays = flight_rays(mesh, kBvhPacket);
      std::vector<Record> records;
      row.brute_force =
          best.frame(Pair::kRayTriangle, Mode::kNearest, std::span(rays), {}, records);
      compare_records(lab, records, reference::cast(rays, triangles_of(mesh), Mode::kNearest),
                      name);
    }
    lab.result.bvh.push_back(std::move(row));
  }
}

std::vector<Setup> setups_of(const ReproduceOptions& o) {
  const HostProfile old = *host_profile("p64-2001"), ideal = *host_profile("ideal");
  return {
      {"as in the paper: 1 lane, every record", 1, old, 256, true},
      {"1 lane, reduction on the card", 1, old, 256, false},
      {fmt::format("best: {} lanes, reduction on the card", o.lanes), o.lanes, ideal, 4096, false}};
}

}  // namespace

Reproduction reproduce(const ReproduceOptions& options) {
  Lab lab;
  lab.result.options = options;
  lab.result.setups = setups_of(options);
  for (const auto kind : {baseline::Kind::kAvx2, baseline::Kind::kAvx512})
    if (baseline::available(kind)) lab.vector = kind;
  lab.result.vector_kind = baseline::name_of(lab.vector);
  for (const Setup& setup : lab.result.setups) lab.cards.emplace_back(setup, options.device);
  const Mesh mesh = [&] {
    const Progress busy("making the terrain");
    return options.quick ? make_terrain({.quads_x = 40, .quads_y = 50}) : make_terrain({});
  }();
  lab.result.triangles = mesh.faces.size();
  std::optional<EmbreeBaseline> embree;
  lab.result.embree = EmbreeBaseline::available();
  if (lab.result.embree) {
    const Progress busy("building Embree's BVH");
    const double start = thread_seconds();
    embree.emplace(mesh);
    lab.result.embree_build_seconds = thread_seconds() - start;
  }
  EmbreeBaseline* baseline = embree ? &*embree : nullptr;
  if (options.opencl) {
    const Progress busy("compiling the OpenCL kernels");
    lab.opencl.emplace(*options.opencl, mesh);
  }
  lab.works = works_of(options, lab.result.setups, mesh.faces.size());
  lab.step(1, "Figure 5, static objects");
  figure5(lab, mesh, baseline);
  lab.step(2, "Figure 6, moving vertices");
  figure6(lab, mesh, baseline);
  for (const std::size_t count : spheres_of(options)) {
    lab.step(3, fmt::format("Figure 7, {} moving spheres", grouped(count)));
    figure7(lab, count);
  }
  with_bvh(lab, mesh);
  return std::move(lab.result);
}

}  // namespace cde::cli
