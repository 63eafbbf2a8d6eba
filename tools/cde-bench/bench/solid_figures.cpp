// SPDX-License-Identifier: Apache-2.0
#include "bench/solid_figures.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "baselines/bench_fcl_mesh.hpp"
#include "bench/bvh_figures.hpp"
#include "cde/card/board.hpp"
#include "cde/geometry/motion.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;

constexpr float kQuad = 10;                 ///< edge of the terrain's quads
constexpr std::size_t kAlone = kBvhPacket;  ///< solids that run one by one, as in FCL
constexpr double kSizes[] = {1, 8};

/// A random solid near a vertex of the terrain, at most its own size away.
struct Place {
  Eigen::Vector3f centre;
  Eigen::Matrix3f turn;
};
Place place(const Mesh& mesh, std::size_t i, float size) {
  const Eigen::Vector3d a = random_direction(2026, 1, i), b = random_direction(2026, 2, i);
  const auto vertex = static_cast<std::size_t>((a.x() * 0.5 + 0.5) * 0.999 *
                                               static_cast<double>(mesh.vertices.size()));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(3 * a.y(), b.normalized()));
  return {mesh.vertices[vertex] + (1.5 * size * a.z() * b).cast<float>(),
          turn.toRotationMatrix().cast<float>()};
}
Sphere solid(const Place& at, float size, const Sphere*) {
  return {at.centre, size};
}
Obb solid(const Place& at, float size, const Obb*) {
  Obb box;
  box.c = at.centre;
  box.half = Eigen::Vector3f(size, 0.7f * size, 0.4f * size);
  box.rotation = at.turn;
  return box;
}

template <class Solid>
class Bench {
 public:
  Bench(const Mesh& mesh, const Bvh& bvh, Board& board, double quads)
      : traversal_(mesh, bvh), board_(board), mesh_(mesh) {
    figures_.shape = kShapeOf<Solid>;
    figures_.quads = quads;
    const float size = static_cast<float>(quads) * kQuad;
    for (std::size_t i = 0; i < kBvhRing; ++i)
      solids_.push_back(solid(place(mesh, i, size), size, static_cast<const Solid*>(nullptr)));
  }

  SolidFigures figures() {
    figures_.cards = {ask("touches", Mode::kOccluded), ask("nearest", Mode::kNearest)};
    std::vector<float> words;
    for (std::size_t i = 0; i < kBvhPacket; ++i) {
      const auto some = to_words(solids_[i]);
      words.insert(words.end(), some.begin(), some.end());
    }
    if (const auto fcl = measure_fcl_mesh(mesh_, figures_.shape, words)) {
      compare(*fcl);
      figures_.cards[0].fcl_seconds = fcl->collide_seconds;
      figures_.cards[1].fcl_seconds = fcl->distance_seconds;
    }
    return figures_;
  }

 private:
  SolidCard ask(std::string_view question, Mode mode) {
    SolidCard card;
    card.question = question;
    Query query{.mode = mode,
                .pair = std::is_same_v<Solid, Sphere> ? Pair::kTriangleSphere : Pair::kTriangleObb,
                .swap = true,
                .through = Through::kBvh};
    const RecordSink keep = [&](std::span<const Record> some) {
      records_.insert(records_.end(), some.begin(), some.end());
    };
    const auto cast = [&](std::size_t first, std::size_t count) {
      records_.clear();
      return board_.cast_shapes<Solid>(std::span<const Solid>(solids_).subspan(first, count), query,
                                       keep);
    };
    for (std::size_t i = 0; i < kAlone; ++i) card.one += cast(i, 1);
    card.packet = cast(0, kBvhPacket);
    card.stream = cast(0, kBvhRing);
    for (std::size_t i = 0; i < solids_.size(); ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      const bool same = mode == Mode::kOccluded
                            ? records_[i].f == traversal_.occluded(solids_[i])
                            : same_bits(records_[i], traversal_.trace(solids_[i], number, mode)[0]);
      if (!same)
        throw Error(ErrorCode::kMismatch, fmt::format("solid {} differs from the reference", i));
    }
    figures_.touching = static_cast<double>(std::count_if(records_.begin(), records_.end(),
                                                          [](const Record& r) { return r.f; })) /
                        static_cast<double>(records_.size());
    return card;
  }

  /// FCL computes in binary64, so solids that barely touch may differ: at most one in 100.
  void compare(const FclOnMesh& fcl) const {
    std::size_t other = 0;
    for (std::size_t i = 0; i < fcl.touches.size(); ++i) {
      const Record& r = records_[i];  // record of mode nearest
      const double apart = r.f ? 0 : r.t, expected = std::max(0.0, fcl.distances[i]);
      const bool near = std::abs(apart - expected) <= 1e-4 * (1 + expected);
      other += (r.f != (fcl.touches[i] > 0) && apart > 1e-3) || !near;
    }
    if (other * 100 > fcl.touches.size()) differs("FCL", other, fcl.touches.size());
  }

  SolidFigures figures_;
  std::vector<Solid> solids_;
  std::vector<Record> records_;
  reference::Traversal traversal_;
  Board& board_;
  const Mesh& mesh_;
};

/// Device cycles per solid.
double each(const Counters& c, std::size_t solids) {
  return static_cast<double>(c.cycles) / static_cast<double>(solids);
}

}  // namespace

std::vector<SolidFigures> measure_solids(const Mesh& terrain, const Device& device, bool quick) {
  std::vector<Pair> pairs = {Pair::kTriangleSphere};
  if (!quick) pairs.push_back(Pair::kTriangleObb);
  Board board = Board::open(on(device, {.lanes = std::min(quick ? 4u : 8u, device.lanes),
                                        .pairs = pairs,
                                        .box = true,
                                        .swap = true,
                                        .traversal_units = device.traversal_units}),
                            options_on(device));
  const Bvh bvh = Bvh::build(terrain);
  board.upload(terrain, bvh);
  std::vector<SolidFigures> all;
  for (const double quads : kSizes)
    all.push_back(Bench<Sphere>(terrain, bvh, board, quads).figures());
  if (quick) return all;
  for (const double quads : kSizes) all.push_back(Bench<Obb>(terrain, bvh, board, quads).figures());
  return all;
}

ordered_json solids_json(const std::vector<SolidFigures>& figures, const Device& device) {
  auto all = ordered_json::array();
  for (const SolidFigures& f : figures) {
    ordered_json j{{"shape", name(f.shape)},
                   {"quads", f.quads},
                   {"touching_share", f.touching},
                   {"by_question", ordered_json::array()}};
    for (const SolidCard& c : f.cards)
      j["by_question"].push_back(
          {{"question", c.question},
           {"seconds_alone", each(c.one, kAlone) / device.clock_hz()},
           {"packet_cycles", c.packet.cycles},
           {"packet_seconds_with_bus", 1e-12 * static_cast<double>(c.packet.time.total())},
           {"seconds_in_packet", each(c.packet, kBvhPacket) / device.clock_hz()},
           {"seconds_in_stream", each(c.stream, kBvhRing) / device.clock_hz()},
           {"nodes_each", static_cast<double>(c.stream.nodes) / kBvhRing},
           {"triangles_each", static_cast<double>(c.stream.pairs) / kBvhRing},
           {"fcl_seconds", c.fcl_seconds ? ordered_json(*c.fcl_seconds) : ordered_json()}});
    all.push_back(j);
  }
  return all;
}

void show_solids(const std::vector<SolidFigures>& figures, const Device& device) {
  print_figure(
      "  solids on a card of their pairs{}, memory {}; modelled time of each: alone, in a packet "
      "of 256, in a stream of 4,096\n",
      device.kind == DeviceKind::kPlaced ? " (projected)" : "", name_of(options_on(device).memory));
  for (const SolidFigures& f : figures)
    for (const SolidCard& c : f.cards)
      print_figure("  {:<7} {} quad{}, {}: {}, {}, {} ({:.1f} nodes, {:.1f} triangles); FCL {}\n",
                   name(f.shape), f.quads, f.quads == 1 ? "" : "s", c.question,
                   duration(each(c.one, kAlone) / device.clock_hz()),
                   duration(each(c.packet, kBvhPacket) / device.clock_hz()),
                   duration(each(c.stream, kBvhRing) / device.clock_hz()),
                   static_cast<double>(c.stream.nodes) / kBvhRing,
                   static_cast<double>(c.stream.pairs) / kBvhRing,
                   c.fcl_seconds ? duration(*c.fcl_seconds) : "not available");
}

}  // namespace cde::cli
