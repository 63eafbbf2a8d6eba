// SPDX-License-Identifier: Apache-2.0
// cde bench rays: compares the simulated card with software that does the same brute force on one
// thread.
#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <random>
#include <thread>

#include "baselines/baseline.hpp"
#include "bench/bench.hpp"
#include "bench/opencl_figures.hpp"
#include "cde/card/board.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/output.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Scene {
  Mesh mesh;
  std::vector<Triangle> triangles;
  std::vector<Ray> rays;
};

/// 256 rays over a terrain. Random: origins along a flight path, random directions below the
/// horizon, as in the paper's experiment. Otherwise straight down on a grid, where software has few
/// branch mispredictions.
Scene make_scene(std::uint32_t quads_x, std::uint32_t quads_y, bool random = true) {
  const Progress busy("making a terrain");
  Scene s{make_terrain({.quads_x = quads_x, .quads_y = quads_y}), {}, {}};
  for (std::size_t i = 0; i < s.mesh.faces.size(); ++i) s.triangles.push_back(s.mesh.triangle(i));
  const Eigen::AlignedBox3f box = bounds(s.mesh);
  s.rays = grid_rays(box, {16, 16});
  if (!random) return s;
  std::mt19937 bits(2007);
  const auto unit = [&] { return static_cast<float>(bits() >> 8) * 0x1p-24f; };
  for (std::size_t i = 0; i < s.rays.size(); ++i) {
    const float along = static_cast<float>(i) / static_cast<float>(s.rays.size());
    const Eigen::Vector3f at(0.25f + 0.5f * along, 0.1f + 0.8f * along, 1.1f);
    s.rays[i].o = box.min() + box.sizes().cwiseProduct(at);
    s.rays[i].d = {2 * unit() - 1, 2 * unit() - 1, -unit()};
  }
  return s;
}

struct MeasuredRays {
  double seconds = 1e300;  // best processor time of this thread
  Counters counters;
  std::vector<Record> records;

  /// Casts the rays again. The triangles must be uploaded.
  void cast(Board& board, const Scene& scene) {
    const double start = thread_seconds();
    records.clear();
    counters = board.cast(scene.rays, {}, [&](std::span<const Record> some) {
      records.insert(records.end(), some.begin(), some.end());
    });
    seconds = std::min(seconds, thread_seconds() - start);
  }
};

/// A card of the comparison.
struct BaselineEntry {
  BoardConfig config;
  Board board;
  MeasuredRays measured = {};
};

/// Checks that software and card find the same triangles at the same distances, except for ties and
/// rounding.
void require_agreement(const std::vector<Record>& card,
                       const std::vector<baseline::ClosestHit>& software, const char* name) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < card.size(); ++i) {
    const bool hit = software[i].index != ~0u;
    if (hit != card[i].f ||
        (hit && std::abs(software[i].t - card[i].t) > 1e-4f * std::abs(card[i].t)))
      ++differ;
  }
  // With other rounding, a ray through an edge may hit either triangle, or none.
  if (differ * 50 > card.size()) {
    throw Error(ErrorCode::kMismatch,
                fmt::format("{} of {} hits of the {} baseline differ from the card's", differ,
                            card.size(), name));
  }
}

struct SoftwareRate {
  std::string name;
  double tests_per_second = 0;
};

/// Runs each software baseline again. `rates` keeps the best rates.
void run_baselines(const Scene& scene, const std::vector<Record>& card,
                   std::vector<SoftwareRate>& rates) {
  std::size_t at = 0;
  for (const auto kind :
       {baseline::Kind::kScalar, baseline::Kind::kAvx2, baseline::Kind::kAvx512}) {
    if (!baseline::available(kind)) continue;
    const double start = thread_seconds();
    const auto hits = baseline::closest(kind, scene.rays, scene.triangles);
    const double rate = static_cast<double>(scene.rays.size() * scene.triangles.size()) /
                        (thread_seconds() - start);
    require_agreement(card, hits, baseline::name_of(kind));
    if (at == rates.size()) rates.push_back({baseline::name_of(kind)});
    rates[at].tests_per_second = std::max(rates[at].tests_per_second, rate);
    ++at;
  }
}

/// The same rays by brute force on an OpenCL device.
ordered_json opencl_rates(const baseline::OpenClDevice& device, const Scene& scene) {
  const Progress busy("OpenCL");
  baseline::OpenClRays opencl(device, scene.triangles);
  const OpenClSeries series =
      measure_opencl(opencl, Through::kBruteForce, scene.rays, scene.rays.size(),
                     reference_records(scene.triangles, scene.rays), device.label());
  const auto rate = [&](const Spread& x) {
    return 1e-6 * static_cast<double>(scene.rays.size() * scene.triangles.size()) / x.median;
  };
  print_figure(
      "{}: {:.1f} M tests/s by the kernel, {:.1f} with copies, {:.1f} with upload of triangles; "
      "random rays, median; {}\n",
      device.label(), rate(series.kernel), rate(series.with_copies), rate(series.with_upload),
      series.differences.text());
  return opencl_row_json(device, std::span(&series, 1));
}

ordered_json compare_rates(const BenchOptions& o) {
  const Scene scene = o.quick ? make_scene(70, 70) : make_scene(291, 446);
  const Scene down = o.quick ? make_scene(70, 70, false) : make_scene(291, 446, false);
  constexpr int kRounds = 5;
  print_figure(
      "\n256 rays x {} triangles, single thread, processor time, best of {} rounds with one "
      "measurement of each (gate level: of 2)\n",
      scene.triangles.size(), kRounds);
  std::vector<BaselineEntry> entries;
  // Lane counts near the fastest. Wider cards take minutes to compile and exceed the first-level
  // cache.
  constexpr std::pair<Arithmetic, unsigned> kCards[] = {
      {Arithmetic::kHost, 16}, {Arithmetic::kHost, 64}, {Arithmetic::kHost, 128},
      {Arithmetic::kRtl, 8},   {Arithmetic::kRtl, 16},  {Arithmetic::kRtl, 32}};
  for (const auto& [arithmetic, lanes] : kCards) {
    if (!o.quick || lanes == 16) {
      const BoardConfig config = on(o.device, {.lanes = lanes, .arithmetic = arithmetic});
      entries.push_back({config, Board::open(config)});
      entries.back().board.upload(scene.triangles);
    }
  }
  Board board_down = Board::open(on(o.device, {}));
  board_down.upload(down.triangles);
  MeasuredRays card_down;
  card_down.cast(board_down, down);
  // The load of the machine changes over minutes, so everything is measured in turn, several times.
  std::vector<SoftwareRate> rates, rates_down;
  std::optional<Progress> progress("rays, cards and software");
  for (int round = 0; round < kRounds; ++round) {
    (*progress)(static_cast<double>(round) / kRounds);
    for (BaselineEntry& e : entries)
      if (e.config.arithmetic == Arithmetic::kHost || round < 2) e.measured.cast(e.board, scene);
    run_baselines(scene, entries[0].measured.records, rates);
    run_baselines(down, card_down.records, rates_down);
  }
  progress.reset();
  const double scalar = rates.front().tests_per_second, vector = rates.back().tests_per_second;
  ordered_json j = {{"rays", scene.rays.size()},
                    {"triangles", scene.triangles.size()},
                    {"software", ordered_json::array()},
                    {"card", ordered_json::array()}};
  for (const auto* list : {&rates, &rates_down}) {
    const char* rays = list == &rates ? "random" : "straight down";
    for (const SoftwareRate& r : *list) {
      print_figure("software {:<8} {:8.1f} M tests/s, {} rays\n", r.name, r.tests_per_second / 1e6,
                   rays);
      j["software"].push_back(
          {{"kind", r.name}, {"rays", rays}, {"tests_per_second", r.tests_per_second}});
    }
  }
  for (const BaselineEntry& e : entries) {
    const Counters& c = e.measured.counters;
    const char* arithmetic = e.config.arithmetic == Arithmetic::kHost ? "host" : "rtl";
    const double rate = static_cast<double>(c.pairs) / e.measured.seconds;
    const double rows = static_cast<double>(scene.triangles.size()) * 256.0 / e.config.lanes;
    const double per_row = static_cast<double>(c.cycles) / rows;
    print_figure(
        "card {:<4} {:>3} lanes  {:8.1f} M tests/s simulated, {:.2f} of scalar ({:.2f} straight "
        "down), {:.3f} of {}; {} cycles, {:.6f} per row\n",
        arithmetic, e.config.lanes, rate / 1e6, rate / scalar,
        rate / rates_down.front().tests_per_second, rate / vector, rates.back().name, c.cycles,
        per_row);
    j["card"].push_back(
        {{"arithmetic", arithmetic},
         {"lanes", e.config.lanes},
         {"tests_per_second_simulated", rate},
         {"ratio_to_scalar", rate / scalar},
         {"ratio_to_scalar_straight_down", rate / rates_down.front().tests_per_second},
         {"ratio_to_vector", rate / vector},
         {"device_cycles", c.cycles},
         {"writeback_cycles", c.writeback},
         {"cycles_per_row", per_row}});
  }
  const auto device = opencl_for_rows(o.opencl_device);
  j["opencl"] = device ? opencl_rates(*device, scene) : ordered_json();
  return j;
}

std::size_t resident_bytes() {
  std::size_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// Device cycles and simulation time against the number of triangles.
ordered_json linearity(const BenchOptions& o) {
  print_figure("\nsize of the scene, host arithmetic, 16 lanes, 256 rays\n");
  ordered_json list = ordered_json::array();
  std::vector<std::uint32_t> sides = {22, 71, 224};
  if (!o.quick) sides.push_back(707);
  if (o.full) sides.push_back(2236);
  // The largest scene takes most of the time, so progress counts work, not scenes.
  const auto work = [](std::uint32_t side) { return static_cast<double>(side) * side; };
  const double all = std::transform_reduce(sides.begin(), sides.end(), 0.0, std::plus<>(), work);
  double done = 0;
  Progress progress("rays");
  for (const std::uint32_t side : sides) {
    progress(done / all, fmt::format("{} triangles", 2ull * side * side));
    done += work(side);
    const Mesh mesh = make_terrain({.quads_x = side, .quads_y = side});
    const std::vector<Ray> rays = grid_rays(bounds(mesh), {16, 16});
    const std::size_t count = mesh.faces.size();
    Board board = Board::open(on(o.device, {}));
    const std::size_t before = resident_bytes();
    const double upload_start = thread_seconds();
    board.upload(mesh);
    const double upload = thread_seconds() - upload_start;
    const double bytes =
        static_cast<double>(resident_bytes() - before) / static_cast<double>(count);
    const double start = thread_seconds();
    const Counters c = board.cast(rays, {}, [](std::span<const Record>) {});
    const double seconds = thread_seconds() - start;
    const double rows = static_cast<double>(count) * 256 / board.lanes();
    print_figure(
        "{:>9} triangles  {:>10} cycles, {:.6f} per row  cast {:8.3f} s, {:6.1f} M tests/s  upload "
        "{:6.3f} s, {:5.1f} bytes per triangle\n",
        count, c.cycles, static_cast<double>(c.cycles) / rows, seconds,
        static_cast<double>(c.pairs) / seconds / 1e6, upload, bytes);
    list.push_back({{"triangles", count},
                    {"device_cycles", c.cycles},
                    {"cycles_per_row", static_cast<double>(c.cycles) / rows},
                    {"simulation_seconds", seconds},
                    {"tests_per_second_simulated", static_cast<double>(c.pairs) / seconds},
                    {"upload_seconds", upload},
                    {"resident_bytes_per_triangle", bytes}});
  }
  return list;
}

/// Runs the same work on one board, and on two boards in two threads at once.
ordered_json two_boards(const BenchOptions& o) {
  const Scene scene = o.quick ? make_scene(100, 100) : make_scene(291, 446);
  Board first = Board::open(on(o.device, {})), second = Board::open(on(o.device, {}));
  first.upload(scene.triangles);
  second.upload(scene.triangles);
  const auto cast = [&](Board& board) {
    board.cast(scene.rays, {}, [](std::span<const Record>) {});
  };
  const auto wall = [](auto work) {
    const auto start = Clock::now();
    work();
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  cast(first);
  std::optional<Progress> progress("rays, two boards in two threads");
  double one = 1e300, two = 1e300;  // the best of three rounds each
  for (int round = 0; round < 3; ++round) {
    (*progress)(round / 3.0);
    one = std::min(one, wall([&] { cast(first); }));
    two = std::min(two, wall([&] {
                     std::thread other([&] { cast(second); });
                     cast(first);
                     other.join();
                   }));
  }
  progress.reset();
  print_figure("\ntwo boards in two threads: {:.2f} times the tests/s of one (wall clock)\n",
               2 * one / two);
  return {
      {"one_board_seconds", one}, {"two_boards_seconds", two}, {"throughput_ratio", 2 * one / two}};
}

}  // namespace

ordered_json bench_rays(const BenchOptions& o) {
  return {{"rates", compare_rates(o)}, {"linearity", linearity(o)}, {"two_boards", two_boards(o)}};
}

}  // namespace cde::cli
