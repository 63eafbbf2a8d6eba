// SPDX-License-Identifier: Apache-2.0
#include "bench/cloud_figures.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <span>

#include "bench/bvh_figures.hpp"
#include "bench/measured.hpp"
#include "cde/card/board.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kCounts[] = {1'000, 10'000};

/// Random shapes in a cube. Their number along each edge is a quarter of what would fit in a row.
class Cloud {
 public:
  explicit Cloud(std::size_t count)
      : size_(0.25f / std::cbrt(static_cast<float>(count))), bits_(2026) {}
  Sphere draw(const Sphere*) { return {point(), size_}; }
  Obb draw(const Obb*) {
    Obb box{point(), {size_, 0.7f * size_, 0.4f * size_}, Eigen::Matrix3f::Identity()};
    const Eigen::Vector3f axis = point() - Eigen::Vector3f::Constant(0.5f);
    if (axis.norm() > 0.1f)
      box.rotation = Eigen::AngleAxisd(6 * share(), axis.cast<double>().normalized())
                         .toRotationMatrix()
                         .cast<float>();
    return box;
  }
  template <class P>
  std::vector<P> some(std::size_t count) {
    std::vector<P> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(draw(static_cast<const P*>(nullptr)));
    return all;
  }

 private:
  float share() { return static_cast<float>(bits_() >> 8) * 0x1p-24f; }
  Eigen::Vector3f point() {
    const float x = share(), y = share();
    return {x, y, share()};
  }
  float size_;
  std::mt19937 bits_;
};

template <class Secondary>
CloudFigures of_cloud(Board& board, std::size_t count) {
  Cloud draws(count);
  const auto all = draws.some<Secondary>(count);
  const auto primaries = draws.some<Sphere>(kBvhRing);
  CloudFigures figures;
  figures.shape = kShapeOf<Secondary>;
  figures.secondaries = count;
  figures.lanes = board.lanes();
  Bvh bvh = Bvh::build(all, {.threads = 1});
  figures.refit_seconds = measured([&](std::size_t) { bvh.refit(all); }).median;
  board.upload(all, bvh);
  const std::uint64_t before = board.time_ps();
  board.upload(bvh);
  figures.bvh_upload_seconds = 1e-12 * static_cast<double>(board.time_ps() - before);
  std::vector<Record> records;
  const auto cast = [&](std::size_t first, Through through) {
    records.clear();
    Query query{
        .mode = Mode::kNearest,
        .pair = kShapeOf<Secondary> == Shape::kSphere ? Pair::kSphereSphere : Pair::kSphereObb};
    query.through = through;
    return board.cast_shapes<Sphere>(std::span(primaries).first(first), query,
                                     [&](std::span<const Record> some) {
                                       records.insert(records.end(), some.begin(), some.end());
                                     });
  };
  figures.brute_force_cycles = cast(kBvhPacket, Through::kBruteForce).cycles;
  figures.packet = cast(kBvhPacket, Through::kBvh);
  figures.stream = cast(kBvhRing, Through::kBvh);
  reference::Traversal traversal(all, bvh);
  for (std::uint32_t i = 0; i < primaries.size(); ++i)
    if (!same_bits(records[i], traversal.trace(primaries[i], i, Mode::kNearest)[0]))
      throw Error(ErrorCode::kMismatch, fmt::format("sphere {} differs from the reference", i));
  return figures;
}

double each(const Counters& c, std::size_t count) {
  return static_cast<double>(c.cycles) / static_cast<double>(count);
}

}  // namespace

std::vector<CloudFigures> measure_clouds(const Device& device) {
  Board board = Board::open(on(device, {.lanes = device.lanes,
                                        .pairs = {Pair::kSphereSphere, Pair::kSphereObb},
                                        .box = true,
                                        .traversal_units = device.traversal_units}),
                            options_on(device));
  std::vector<CloudFigures> figures;
  for (const std::size_t count : kCounts) figures.push_back(of_cloud<Sphere>(board, count));
  for (const std::size_t count : kCounts) figures.push_back(of_cloud<Obb>(board, count));
  return figures;
}

ordered_json clouds_json(const std::vector<CloudFigures>& figures, const Device& device) {
  auto all = ordered_json::array();
  for (const CloudFigures& f : figures)
    all.push_back({{"shape", name(f.shape)},
                   {"secondaries", f.secondaries},
                   {"packet_cycles", f.packet.cycles},
                   {"seconds_in_packet", each(f.packet, kBvhPacket) / device.clock_hz()},
                   {"seconds_in_stream", each(f.stream, kBvhRing) / device.clock_hz()},
                   {"lanes", f.lanes},
                   {"brute_force_cycles", f.brute_force_cycles},
                   {"refit_seconds", f.refit_seconds},
                   {"bvh_upload_seconds", f.bvh_upload_seconds}});
  return all;
}

void show_clouds(const std::vector<CloudFigures>& figures, const Device& device) {
  print_figure("  spheres that find the nearest shape{}, memory {}:\n",
               device.kind == DeviceKind::kPlaced ? " (projected)" : "",
               name_of(options_on(device).memory));
  for (const CloudFigures& f : figures)
    print_figure(
        "  {:>6} {:<7} 256 in {} ({:.1f} cycles each), 4,096 in {:.1f} each; brute force with {} "
        "{}; refit by the host {}, upload of the BVH over the bus {}\n",
        f.secondaries, fmt::format("{}s:", name(f.shape)),
        duration(static_cast<double>(f.packet.cycles) / device.clock_hz()),
        each(f.packet, kBvhPacket), each(f.stream, kBvhRing), counted(f.lanes, "lane"),
        duration(static_cast<double>(f.brute_force_cycles) / device.clock_hz()),
        duration(f.refit_seconds), duration(f.bvh_upload_seconds));
}

}  // namespace cde::cli
