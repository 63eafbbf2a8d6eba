// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

#include "cde/bvh/bvh.hpp"
#include "cde/geometry/surface_point.hpp"
#include "cde/mesh/inside.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/reference/traversal.hpp"
#include "cde/support/error.hpp"
#include "native.hpp"

namespace cde::python {
namespace {

/// Rays of an array of six columns: origin, direction.
RayView view_of(const Rows<const float>& rays, float tmin, float tmax) {
  const auto step = static_cast<std::ptrdiff_t>(rays.stride(0) * std::int64_t{sizeof(float)});
  return StridedRays{.origins = rays.data(),
                     .directions = rays.data() + 3,
                     .origin_step = step,
                     .direction_step = step,
                     .count = rays.shape(0),
                     .tmin = tmin,
                     .tmax = tmax};
}

/// The columns of hits, one row per hit.
struct HitColumns {
  List<float> t;
  List<std::uint32_t> triangles;
  Rows<float> uvs, normals;
};

struct Hits {
  std::vector<Record> records;
};

/// Triangles and their BVH, which is built before the first query. Several threads may ask at a
/// time; add() waits for their end.
class Triangles {
 public:
  explicit Triangles(const std::string& algorithm)
      : algorithm_(algorithm_named(algorithm).value()) {
    mesh_.name = "scene";
  }

  void add(const Rows<const float>& vertices, const Rows<const std::uint32_t>& faces) {
    const nb::gil_scoped_release release;
    const std::unique_lock lock(mutex_);
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (std::size_t i = 0; i < vertices.shape(0); ++i) {
      const float* v = vertices.data() + static_cast<std::int64_t>(i) * vertices.stride(0);
      mesh_.vertices.emplace_back(v[0], v[1], v[2]);
    }
    for (std::size_t i = 0; i < faces.shape(0); ++i) {
      const std::uint32_t* f = faces.data() + static_cast<std::int64_t>(i) * faces.stride(0);
      mesh_.faces.push_back({first + f[0], first + f[1], first + f[2]});
    }
    bvh_.reset();
    inside_.reset();
  }

  /// One record per ray. Ends with Python's exception if interrupted.
  void trace(const Rows<const float>& array, float tmin, float tmax, bool occluded,
             unsigned threads, const List<bool>& hit, const List<bool>& bad,
             const HitColumns& columns) {
    bool done;
    {
      const nb::gil_scoped_release release;
      const std::shared_lock lock(mutex_);
      const RayView rays = view_of(array, tmin, tmax);
      std::vector<Record> records(rays.size());
      done = reference::trace_rays(mesh_, bvh(), rays, records,
                                   {.mode = occluded ? Mode::kOccluded : Mode::kNearest,
                                    .algorithm = algorithm_,
                                    .threads = threads,
                                    .stop = interrupted});
      for (std::size_t i = 0; done && i < records.size(); ++i) {
        hit.data()[i] = records[i].f;
        bad.data()[i] = records[i].bad;
        if (!occluded) put(columns, i, records[i], rays[i]);
      }
    }
    if (!done) throw nb::python_error();
  }

  /// All hits of all rays, ray by ray, by ascending t; the number of hits of each ray in `counts`.
  Hits find_hits(const Rows<const float>& array, float tmin, float tmax,
                 const List<std::uint32_t>& counts) {
    bool stopped = false;
    Hits hits;
    {
      const nb::gil_scoped_release release;
      const std::shared_lock lock(mutex_);
      const RayView rays = view_of(array, tmin, tmax);
      reference::Traversal traversal(mesh_, bvh(), algorithm_);
      for (std::size_t i = 0; i < rays.size() && !stopped; ++i) {
        auto of_ray = traversal.trace(rays[i], static_cast<std::uint32_t>(i), Mode::kHits);
        std::ranges::stable_sort(of_ray, {}, &Record::t);
        counts.data()[i] = static_cast<std::uint32_t>(of_ray.size());
        hits.records.insert(hits.records.end(), of_ray.begin(), of_ray.end());
        stopped = i % 4096 == 4095 && interrupted();
      }
    }
    if (stopped) throw nb::python_error();
    return hits;
  }
  void put_hits(const Hits& hits, const Rows<const float>& array, const List<std::uint32_t>& ids,
                const HitColumns& columns) {
    const nb::gil_scoped_release release;
    const std::shared_lock lock(mutex_);
    const RayView rays = view_of(array, 0, 0);
    for (std::size_t i = 0; i < hits.records.size(); ++i) {
      const Record& r = hits.records[i];
      ids.data()[i] = r.primary;
      put(columns, i, r, rays[r.primary]);
    }
  }

  /// Whether each point is inside. Error kBadInput if the triangles are not closed.
  void contains(const Rows<const float>& points, const List<bool>& inside) {
    bool stopped = false;
    {
      const nb::gil_scoped_release release;
      const std::shared_lock lock(mutex_);
      const Inside& body = this->body();
      const std::size_t look = std::max<std::size_t>(1, 10'000'000 / (mesh_.faces.size() + 1));
      for (std::size_t i = 0; i < points.shape(0) && !stopped; ++i) {
        const float* p = points.data() + static_cast<std::int64_t>(i) * points.stride(0);
        inside.data()[i] = body.contains({p[0], p[1], p[2]});
        stopped = i % look == look - 1 && interrupted();
      }
    }
    if (stopped) throw nb::python_error();
  }

  [[nodiscard]] std::size_t size() const { return mesh_.faces.size(); }

 private:
  const Bvh& bvh() {
    const std::lock_guard lock(building_);
    if (!bvh_) {
      bvh_ = Bvh::build(mesh_);
    }
    return *bvh_;
  }

  const Inside& body() {
    const std::lock_guard lock(building_);
    if (!inside_) inside_.emplace(mesh_);
    return *inside_;
  }

  void put(const HitColumns& columns, std::size_t i, const Record& r, const Ray& ray) const {
    columns.t.data()[i] = r.t;
    columns.triangles.data()[i] = r.index;
    float *uv = columns.uvs.data() + 2 * i, *normal = columns.normals.data() + 3 * i;
    std::fill_n(uv, 2, 0.0f);
    std::fill_n(normal, 3, 0.0f);
    if (!r.f) return;
    const SurfacePoint at = surface_point(mesh_.triangle(r.index), r.cp, ray.d);
    uv[0] = static_cast<float>(at.u);
    uv[1] = static_cast<float>(at.v);
    for (int k = 0; k < 3; ++k) normal[k] = static_cast<float>(at.normal[k]);
  }

  Mesh mesh_;
  Algorithm algorithm_;
  std::optional<Bvh> bvh_;
  std::optional<Inside> inside_;
  std::shared_mutex mutex_;  ///< of the mesh
  std::mutex building_;      ///< of what is built from it
};

}  // namespace

void add_rays(nb::module_& module) {
  module.def("algorithm_names", [] { return algorithm_names(); });
  nb::class_<Hits>(module, "Hits").def("__len__", [](const Hits& hits) {
    return hits.records.size();
  });
  nb::class_<Triangles>(module, "Triangles")
      .def(nb::init<const std::string&>())
      .def("add", &Triangles::add)
      .def(
          "trace",
          [](Triangles& self, const Rows<const float>& rays, float tmin, float tmax, bool occluded,
             unsigned threads, const List<bool>& hit, const List<bool>& bad, const List<float>& t,
             const List<std::uint32_t>& triangles, const Rows<float>& uvs,
             const Rows<float>& normals) {
            self.trace(rays, tmin, tmax, occluded, threads, hit, bad, {t, triangles, uvs, normals});
          })
      .def("find_hits", &Triangles::find_hits)
      .def("put_hits",
           [](Triangles& self, const Hits& hits, const Rows<const float>& rays,
              const List<std::uint32_t>& ids, const List<float>& t,
              const List<std::uint32_t>& triangles, const Rows<float>& uvs,
              const Rows<float>& normals) {
             self.put_hits(hits, rays, ids, {t, triangles, uvs, normals});
           })
      .def("contains", &Triangles::contains)
      .def_prop_ro("size", &Triangles::size);
}

}  // namespace cde::python
