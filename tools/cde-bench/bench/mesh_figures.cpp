// SPDX-License-Identifier: Apache-2.0
#include "bench/mesh_figures.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "baselines/bench_fcl_mesh.hpp"
#include "bench/bvh_figures.hpp"
#include "cde/card/board.hpp"
#include "cde/geometry/motion.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kPlaces = 8;
constexpr unsigned kQuads = 24;  ///< quads along a side of the smaller mesh

/// A small terrain, turned at random, that intersects the large one.
Mesh placed(const Mesh& small, const Mesh& terrain, std::size_t i) {
  const Eigen::Vector3d a = random_direction(2026, 3, i), b = random_direction(2026, 4, i);
  const auto vertex = static_cast<std::size_t>((a.x() * 0.5 + 0.5) * 0.999 *
                                               static_cast<double>(terrain.vertices.size()));
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisd(3 * a.y(), b.normalized()).toRotationMatrix().cast<float>();
  const Eigen::Vector3f centre = bounds(small).center();
  Mesh mesh = small;
  for (Eigen::Vector3f& v : mesh.vertices) v = turn * (v - centre) + terrain.vertices[vertex];
  return mesh;
}

class Bench {
 public:
  Bench(const Mesh& terrain, const Device& device)
      : terrain_(terrain),
        bvh_(Bvh::build(terrain)),
        board_(Board::open(on(device, {.lanes = std::min(8u, device.lanes),
                                       .pairs = {Pair::kTriangleTriangle},
                                       .box = true,
                                       .traversal_units = device.traversal_units}),
                           options_on(device))) {
    board_.upload(terrain, bvh_);
    const Mesh small = make_terrain({.quads_x = kQuads, .quads_y = kQuads});
    for (std::size_t i = 0; i < kPlaces; ++i) meshes_.push_back(placed(small, terrain, i));
  }

  MeshFigures figures() {
    MeshFigures figures;
    figures.triangles = meshes_[0].faces.size();
    figures.questions = {ask("touches", Mode::kOccluded), ask("contacts", Mode::kHits),
                         ask("nearest", Mode::kNearest)};
    for (const double count : contacts_) figures.contacts += count / kPlaces;
    if (const auto fcl = measure_fcl_meshes(terrain_, meshes_)) {
      compare(*fcl);
      figures.questions[0].fcl_seconds = fcl->touch_seconds;
      figures.questions[1].fcl_seconds = fcl->contacts_seconds;
      figures.questions[2].fcl_seconds = fcl->distance_seconds;
    }
    return figures;
  }

 private:
  MeshQuestion ask(std::string_view question, Mode mode) {
    MeshQuestion q;
    q.question = question;
    for (const Mesh& mesh : meshes_) {
      std::vector<Triangle> triangles;
      for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
      std::vector<Record> records;
      const Counters c = board_.cast_shapes<Triangle>(
          triangles, {.mode = mode, .pair = Pair::kTriangleTriangle, .through = Through::kBvh},
          [&](std::span<const Record> some) {
            records.insert(records.end(), some.begin(), some.end());
          });
      q.cycles += static_cast<double>(c.cycles) / kPlaces;
      q.seconds_with_bus += 1e-12 * static_cast<double>(c.time.total()) / kPlaces;
      q.nodes += static_cast<double>(c.nodes) / kPlaces;
      q.pairs += static_cast<double>(c.pairs) / kPlaces;
      if (mode == Mode::kHits) contacts_.push_back(static_cast<double>(records.size()));
      if (mode == Mode::kNearest) check_nearest(triangles, records);
    }
    return q;
  }

  void check_nearest(const std::vector<Triangle>& triangles, const std::vector<Record>& records) {
    reference::Traversal traversal(terrain_, bvh_);
    double least = INFINITY;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      if (!same_bits(records[i], traversal.trace(triangles[i], i, Mode::kNearest)[0]))
        throw Error(ErrorCode::kMismatch, fmt::format("triangle {} differs from the reference", i));
      least = std::min(least, records[i].f ? 0.0 : static_cast<double>(records[i].t));
    }
    distances_.push_back(least);
  }

  /// FCL computes in binary64, so pairs that barely touch may differ.
  void compare(const FclMeshes& fcl) const {
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const double apart = std::max(0.0, fcl.distances[i]);
      if (std::abs(distances_[i] - apart) > 1e-3 * (1 + apart) ||
          std::abs(contacts_[i] - fcl.contacts[i]) > 0.02 * (1 + fcl.contacts[i]))
        throw Error(ErrorCode::kMismatch,
                    fmt::format("mesh {}: {} contacts, distance {}; FCL: {} and {}", i,
                                contacts_[i], distances_[i], fcl.contacts[i], apart));
    }
  }

  const Mesh& terrain_;
  const Bvh bvh_;
  Board board_;
  std::vector<Mesh> meshes_;
  std::vector<double> contacts_, distances_;
};

}  // namespace

MeshFigures measure_meshes(const Mesh& terrain, const Device& device) {
  return Bench(terrain, device).figures();
}

ordered_json meshes_json(const MeshFigures& figures, const Device& device) {
  ordered_json j{{"triangles", figures.triangles},
                 {"contacts", figures.contacts},
                 {"by_question", ordered_json::array()}};
  for (const MeshQuestion& q : figures.questions)
    j["by_question"].push_back(
        {{"question", q.question},
         {"cycles", q.cycles},
         {"seconds", q.cycles / device.clock_hz()},
         {"seconds_with_bus", q.seconds_with_bus},
         {"nodes", q.nodes},
         {"pairs", q.pairs},
         {"fcl_seconds", q.fcl_seconds ? ordered_json(*q.fcl_seconds) : ordered_json()}});
  return j;
}

void show_meshes(const MeshFigures& figures, const Device& device) {
  print_figure(
      "  a mesh of {} triangles in it, with {:.0f} touching pairs, on a card of "
      "triangle-triangle:\n",
      figures.triangles, figures.contacts);
  for (const MeshQuestion& q : figures.questions)
    print_figure("  {:<8} {}, with bus {} ({:.0f} nodes, {:.0f} pairs); FCL {}\n", q.question,
                 duration(q.cycles / device.clock_hz()), duration(q.seconds_with_bus), q.nodes,
                 q.pairs, q.fcl_seconds ? duration(*q.fcl_seconds) : "not available");
}

}  // namespace cde::cli
