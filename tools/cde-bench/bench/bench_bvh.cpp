// SPDX-License-Identifier: Apache-2.0
// cde bench bvh: measures BVH traversal on the card, without and with the bus, its refit, and
// the time to simulate it. It compares rays with Embree, and spheres, OBBs and meshes with FCL.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/bench.hpp"
#include "bench/bvh_figures.hpp"
#include "bench/cloud_figures.hpp"
#include "bench/mesh_figures.hpp"
#include "bench/solid_figures.hpp"
#include "cde/card/json_keys.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/progress.hpp"
#include "output/streams.hpp"

namespace cde::cli {

nlohmann::ordered_json bench_bvh(const BenchOptions& o) {
  print_figure(
      "\nBVH: device times are modelled cycles, other times are processor time of this machine\n");
  std::vector<TerrainOptions> meshes = {{.quads_x = 80, .quads_y = 80}};
  if (!o.quick) meshes.emplace_back();
  auto all = nlohmann::ordered_json::array();
  const double steps = o.quick ? 2 : static_cast<double>(3 * meshes.size() + 1);
  double done = 0;
  Progress progress("bvh");
  for (const TerrainOptions& options : meshes) {
    const Mesh mesh = make_terrain(options);
    progress(done++ / steps, fmt::format("rays against {} triangles", mesh.faces.size()));
    const BvhFigures figures =
        measure_bvh(mesh, o.quick ? 8'192 : 65'536, o.device, {}, opencl_for_rows(o.opencl_device));
    show_bvh(figures);
    all.push_back(bvh_json(figures));
    progress(done++ / steps, fmt::format("solids against {} triangles", mesh.faces.size()));
    const std::vector<SolidFigures> solids = measure_solids(mesh, o.device, o.quick);
    show_solids(solids, o.device);
    all.back()["solids"] = solids_json(solids, o.device);
    if (o.quick) continue;  // needs another card
    const auto caches = measure_node_caches(mesh, 16'384, o.device);
    show_node_caches(caches, o.device);
    all.back()["node_caches"] = node_caches_json(caches, o.device);
    progress(done++ / steps, fmt::format("a mesh against {} triangles", mesh.faces.size()));
    const MeshFigures through = measure_meshes(mesh, o.device);
    show_meshes(through, o.device);
    all.back()["meshes"] = meshes_json(through, o.device);
  }
  if (o.quick) return all;  // needs another card
  progress(done++ / steps, "spheres against spheres and OBBs");
  const std::vector<CloudFigures> clouds = measure_clouds(o.device);
  show_clouds(clouds, o.device);
  all.back()["clouds"] = clouds_json(clouds, o.device);
  return all;
}

}  // namespace cde::cli
