// SPDX-License-Identifier: Apache-2.0
// cde bench bus: measures the bus between host and card in modelled time, with simulated PCI
// signals and with computed time, and a frame of the paper.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <chrono>

#include "bench/bench.hpp"
#include "cde/card/board.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/image/camera.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/error.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr double kPeak = 8 / 15e-9;  // bytes per second: 64 bits at 66.67 MHz
constexpr std::size_t kRays = 256;
constexpr std::array<std::uint32_t, 9> kSizes = {64,     256,     1024,      4096,     16'384,
                                                 65'536, 262'144, 1'048'576, 4'194'304};
/// A frame of the paper has 259,572 tests, here in whole passes of 256 rays.
constexpr std::size_t kFrameTriangles = 1014;

const char* name_of_bus(Bus bus) {
  return bus == Bus::kCycle ? "cycle" : "functional";
}

Board open(Bus bus, unsigned lanes, const HostProfile& host, std::uint32_t burst,
           const BenchOptions& o) {
  OpenOptions options = options_on(o.device);
  options.host = host;
  options.bus_burst = burst;
  return Board::open(on(o.device, {.lanes = lanes, .bus = bus}), options);
}

/// The first triangles of a terrain. Rays are cast straight down at all of it.
std::vector<Triangle> triangles(std::size_t count) {
  const Mesh mesh = make_terrain({});
  std::vector<Triangle> some;
  const std::size_t step = mesh.faces.size() / count;
  for (std::size_t i = 0; i < count; ++i) some.push_back(mesh.triangle(i * step));
  return some;
}
std::vector<Ray> rays() {
  return grid_rays(bounds(make_terrain({})), {16, 16});
}

// ---- Transfers ----

/// Runs a pass whose records stay in the card, so that they can be read in pieces of any size.
void fill_ring(Board& board, std::size_t records) {
  const std::size_t count = (records + kRays - 1) / kRays;
  board.upload(triangles(count));
  board.load(rays());
  board.write_register(card::kRegCommand,
                       card::kCommandMode(Mode::kAll) | card::kCommandPair(Pair::kRayTriangle));
  board.write_register(card::kRegPrimCount, kRays);
  board.write_register(card::kRegSecFirst, 0);
  board.write_register(card::kRegSecCount, count);
  board.write_register(card::kRegControl, card::kControlGo);
  board.wait(4 * kRays * count + 10'000);
  const bool done = (board.read_register(card::kRegStatus) >> card::kStatusDone & 1) != 0;
  const std::uint64_t waiting = board.read_register(card::kRegRecords);
  if (!done || waiting < records)
    throw Error(ErrorCode::kDevice,
                fmt::format("the card has {} records; expected {}", waiting, records));
  board.write_register(card::kRegControl, card::kControlClear);
}

struct BusRate {
  double up, down;  ///< bytes per second of modelled time
};

/// Measures one transfer of each size in each direction, including the accesses of the driver.
std::vector<BusRate> sweep(Board& board) {
  std::size_t records = 0;
  for (const std::uint32_t bytes : kSizes) records += bytes / 32;
  fill_ring(board, records);
  std::vector<BusRate> rates;
  const auto rate = [&](std::uint32_t bytes, const auto& transfer) {
    const std::uint64_t start = board.time_ps();
    transfer();
    return bytes / (static_cast<double>(board.time_ps() - start) * 1e-12);
  };
  for (const std::uint32_t bytes : kSizes) {
    std::vector<std::uint64_t> words(bytes / 8);
    rates.push_back({.up = rate(bytes, [&] { board.bus_write(card::kSpaceDdr, 0, words); }),
                     .down = rate(bytes, [&] { board.bus_read(card::kSpaceSram, 0, words); })});
  }
  return rates;
}

struct Sweep {
  const HostProfile* host;
  Bus bus;
  std::vector<BusRate> rates;
  double wall_seconds;
};

std::vector<Sweep> sweeps(const BenchOptions& o, std::uint32_t burst) {
  std::vector<Sweep> all;
  Progress progress("transfers");
  for (const HostProfile& host : kHostProfiles)
    for (const Bus bus : {Bus::kFunctional, Bus::kCycle}) {
      if (o.quick && bus == Bus::kCycle) continue;
      progress(static_cast<double>(all.size()) / static_cast<double>(2 * std::size(kHostProfiles)),
               fmt::format("host {}, {} bus", host.name, name_of_bus(bus)));
      Board board = open(bus, o.quick ? 16 : 1, host, burst, o);
      const auto start = Clock::now();
      std::vector<BusRate> rates = sweep(board);
      all.push_back({&host, bus, std::move(rates),
                     std::chrono::duration<double>(Clock::now() - start).count()});
    }
  return all;
}

void print_sweeps(const std::vector<Sweep>& all, std::uint32_t burst, const BenchOptions& o) {
  print_figure(
      "\nbus: modelled MB/s of a transfer to the card and to the host, with the driver's "
      "accesses\n{} bytes per burst, 64 bits at 66.67 MHz (533 MB/s), core {}\n{:>10}",
      burst, device_for(o.device, on(o.device, {.lanes = 1, .bus = Bus::kCycle})).text(), "bytes");
  for (const Sweep& s : all)
    print_figure(" {:>22}", fmt::format("{} {}", s.host->name, name_of_bus(s.bus)));
  print_figure("\n{:>10}", "");
  for (std::size_t i = 0; i < all.size(); ++i) print_figure(" {:>22}", "to card  to host");
  print_figure("\n");
  for (std::size_t i = 0; i < kSizes.size(); ++i) {
    print_figure("{:>10}", kSizes[i]);
    for (const Sweep& s : all)
      print_figure(" {:>22}",
                   fmt::format("{:>7.1f}  {:>7.1f}", s.rates[i].up / 1e6, s.rates[i].down / 1e6));
    print_figure("\n");
  }
  print_figure("{:>10}", "wall s");
  for (const Sweep& s : all) print_figure(" {:>22.3g}", s.wall_seconds);
  print_figure("\n");
  for (const Sweep& s : all)
    if (s.host->name == "ideal")
      print_figure("upload with host ideal ({}) and 4 KiB bursts: {:.1f} % of 533 MB/s\n",
                   name_of_bus(s.bus), 100 * s.rates.back().up / kPeak);
}

ordered_json json_of(const std::vector<Sweep>& all, std::uint32_t burst, const BenchOptions& o) {
  ordered_json rows = ordered_json::array();
  for (const Sweep& s : all) {
    ordered_json points = ordered_json::array();
    for (std::size_t i = 0; i < kSizes.size(); ++i)
      points.push_back({{"bytes", kSizes[i]},
                        {"to_card_bytes_per_second", s.rates[i].up},
                        {"to_card_share", s.rates[i].up / kPeak},
                        {"to_host_bytes_per_second", s.rates[i].down},
                        {"to_host_share", s.rates[i].down / kPeak}});
    rows.push_back({{"host", s.host->name},
                    {"bus", name_of_bus(s.bus)},
                    {"burst_bytes", burst},
                    {"clock_hz", o.device.clock_hz()},
                    {"peak_bytes_per_second", kPeak},
                    {"modelled", points},
                    {"wall_seconds", s.wall_seconds}});
  }
  return rows;
}

// ---- The paper's frame ----

struct Frame {
  Bus bus;
  unsigned lanes;
  Mode mode;
  std::uint64_t upload = 0;  ///< picoseconds
  Counters counters = {};
  double wall_seconds = 0;
};

Frame frame(Bus bus, unsigned lanes, Mode mode, const BenchOptions& o) {
  Board board = open(bus, lanes, *host_profile("p64-2001"), 256, o);
  Frame f{.bus = bus, .lanes = lanes, .mode = mode};
  const std::vector<Triangle> scene = triangles(kFrameTriangles);
  const std::vector<Ray> packet = rays();
  const auto start = Clock::now();
  const std::uint64_t before = board.time_ps();
  board.upload(scene);
  f.upload = board.time_ps() - before;
  board.load(packet);
  f.counters = board.run({.mode = mode}, [](std::span<const Record>) {});
  f.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return f;
}

ordered_json paper(const BenchOptions& o) {
  print_figure(
      "\npaper profile: a frame of {} tests ({} triangles x {} rays), fp32, core {}, "
      "host p64-2001, 64 bits, 256-byte bursts; modelled ms\n{:<8} {:<11} {:>5} {:>8} "
      "{:>8} {:>8} {:>10} {:>8} {:>9} {:>8}   wall s\n",
      kFrameTriangles * kRays, kFrameTriangles, kRays,
      device_for(o.device, on(o.device, {.lanes = 1, .bus = Bus::kCycle})).text(), "mode", "bus",
      "lanes", "upload", "load", "engine", "write-back", "download", "registers", "total");
  ordered_json rows = ordered_json::array();
  constexpr std::array<std::pair<Mode, unsigned>, 3> kCards = {
      {{Mode::kAll, 1}, {Mode::kNearest, 1}, {Mode::kNearest, 16}}};
  Progress progress("the paper's frame");
  for (const auto& [mode, lanes] : kCards)
    for (const Bus bus : {Bus::kFunctional, Bus::kCycle}) {
      if (o.quick && (lanes == 1 || bus == Bus::kCycle)) continue;
      progress(static_cast<double>(rows.size()) / (2.0 * kCards.size()),
               fmt::format("{} lanes, {} bus", lanes, name_of_bus(bus)));
      const Frame f = frame(bus, lanes, mode, o);
      const ModelledTime& t = f.counters.time;
      const auto ms = [](std::uint64_t ps) { return static_cast<double>(ps) * 1e-9; };
      const std::uint64_t total = f.upload + t.total();
      print_figure(
          "{:<8} {:<11} {:>5} {:>8.3f} {:>8.3f} {:>8.3f} {:>10.3f} {:>8.3f} {:>9.3f} "
          "{:>8.3f} {:>8.3g}\n",
          name_of(mode), name_of_bus(bus), lanes, ms(f.upload), ms(t.load), ms(t.engine),
          ms(t.write_back), ms(t.download), ms(t.registers), ms(total), f.wall_seconds);
      rows.push_back({{"mode", name_of(mode)},
                      {"bus", name_of_bus(bus)},
                      {"lanes", lanes},
                      {"format", "fp32"},
                      {"host", "p64-2001"},
                      {"burst_bytes", 256},
                      {"clock_hz", o.device.clock_hz()},
                      {"tests", f.counters.pairs},
                      {"modelled_seconds", time_json(t, f.upload)},
                      {"wall_seconds", f.wall_seconds}});
    }
  return rows;
}

}  // namespace

ordered_json bench_bus(const BenchOptions& o) {
  constexpr std::uint32_t kBurst = 4096;
  const std::vector<Sweep> all = sweeps(o, kBurst);
  print_sweeps(all, kBurst, o);
  if (o.quick) print_figure("PCI signals and cards of one lane: skipped (--quick)\n");
  return {{"transfers", json_of(all, kBurst, o)}, {"paper_frame", paper(o)}};
}

}  // namespace cde::cli
