// SPDX-License-Identifier: Apache-2.0
// Reads [[object]]: the source of its shapes, and their deformation.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cde/image/camera.hpp"
#include "cde/io/rays_csv.hpp"
#include "cde/support/counted.hpp"
#include "cde/support/message.hpp"
#include "cde/support/read_limits.hpp"
#include "mesh/readers.hpp"
#include "scene/parts.hpp"
#include "support/text.hpp"

namespace cde::scene_parts {
namespace {

using toml_reader::kPositive;
using toml_reader::Table;

constexpr std::int64_t kMostShapes = 1 << 24;
const std::vector<std::string> kShapeNames = [] {
  std::vector<std::string> names;
  for (const contract::ShapeRow& row : contract::kShapeTable) names.emplace_back(row.name);
  return names;
}();

Eigen::Vector3f narrow(const Eigen::Vector3d& v) {
  return v.cast<float>();
}

/// A direction of any length, normalised.
Eigen::Vector3d unit(Table& t, const char* key,
                     const std::optional<Eigen::Vector3d>& fallback = {}) {
  const Eigen::Vector3d v = t.vector(key, fallback);
  if (!(v.norm() > 1e-30)) t.fail(key, "has no direction");
  return v / v.norm();
}

// ---- Primitives written out ----

Eigen::Matrix3f read_axes(Table& t) {
  const bool turned = t.has("axis") || t.has("degrees");
  const Eigen::Vector3d axis = unit(t, "axis", Eigen::Vector3d(0, 0, 1));
  const double degrees = t.number("degrees", turned ? std::optional<double>{} : 0.0);
  return Eigen::AngleAxisd(degrees * kDegree, axis).toRotationMatrix().cast<float>();
}

/// The key of a field, such as half_height for "half height".
std::string key_of(std::string field) {
  if (field == "half extent") return "half";
  std::replace(field.begin(), field.end(), ' ', '_');
  return field;
}

/// tmin and tmax keep their defaults if they are missing. Directions may have any length.
template <class P>
void read(Table& t, P& shape) {
  visit_fields(shape, [&t](const char* name, WordKind kind, auto& field) {
    const std::string key = key_of(name);
    using Field = std::remove_reference_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, Eigen::Matrix3f>)
      field = read_axes(t);
    else if constexpr (std::is_same_v<Field, Eigen::Vector3f>)
      field = narrow(kind == WordKind::kPure ? unit(t, key.c_str()) : t.vector(key.c_str()));
    else if (kind == WordKind::kInterval)
      field = static_cast<float>(t.number(key.c_str(), field, {.infinite = true}));
    else if (kind == WordKind::kSize)
      field = static_cast<float>(t.number(key.c_str(), {}, kPositive));
    else
      field = static_cast<float>(t.number(key.c_str()));
  });
}

template <class P>
Shapes read_shapes(toml_reader::Tables tables) {
  std::vector<P> shapes;
  for (Table& t : tables) {
    P shape;
    read(t, shape);
    t.finish();
    if (const auto why = defect(shape)) t.fail(*why);
    shapes.push_back(shape);
  }
  return shapes;
}

// ---- Primitives drawn at random ----

struct Scatter {
  std::uint64_t seed;
  Eigen::Vector3d min, max;
  double smallest, largest;
  std::uint64_t i = 0, stream = 0;

  double unit() { return random_unit(seed, 16 + stream++, i); }
  float size() { return static_cast<float>(smallest + (largest - smallest) * unit()); }
  Eigen::Vector3f point() {
    Eigen::Vector3f p;
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(min[k] + (max[k] - min[k]) * unit());
    return p;
  }
  Eigen::Vector3f around(const Eigen::Vector3f& c) {
    const Eigen::Vector3f to = direction();
    return c + size() * to;
  }
  Eigen::Vector3f direction() { return random_direction(seed, 16 + stream++, i).cast<float>(); }
  Eigen::Matrix3f rotation() {
    const Eigen::Vector3d axis = random_direction(seed, 16 + stream++, i);
    return Eigen::AngleAxisd(2 * std::numbers::pi * unit(), axis).toRotationMatrix().cast<float>();
  }
};

template <class P>
Shapes scattered(Scatter s, std::uint32_t count, const Table& t) {
  std::vector<P> list;
  list.reserve(count);
  for (; s.i < count; ++s.i) {
    s.stream = 0;
    list.push_back(P::random(s));
    if (const auto why = defect(list.back())) t.fail(fmt::format("shape {}: {}", s.i, *why));
  }
  return list;
}

Shapes read_scatter(Table t, std::string& source, Memory& memory) {
  const auto shape = static_cast<Shape>(t.choice("shape", kShapeNames));
  const auto count = t.integer<std::uint32_t>("count", {}, 1, kMostShapes);
  memory.add(t, "count", shape, count);
  Scatter s{t.integer<std::uint64_t>("seed", 1, 0, std::numeric_limits<std::int64_t>::max()),
            t.vector("min"), t.vector("max"), 1, 1};
  for (int k = 0; k < 3; ++k)
    if (!(s.min[k] <= s.max[k])) t.fail("max", "must be at least min on every axis");
  if (with_shape<float>(shape, []<class P>() {
        return requires {
          P::kReach;
        };
      })) {
    const std::vector<double> sizes = t.numbers("size", 2);
    s.smallest = sizes[0], s.largest = sizes[1];
    if (!(s.smallest > 0 && s.largest >= s.smallest))
      t.fail("size", "must be [SMALLEST, LARGEST], both > 0");
  }
  t.finish();
  source = fmt::format("{} random {}s, seed {}", count, name(shape), s.seed);
  return with_shape<float>(shape, [&]<class P>() { return scattered<P>(s, count, t); });
}

// ---- Rays ----

Shapes read_camera(Table t, std::string& source, Memory& memory) {
  Camera camera{narrow(t.vector("eye")), narrow(t.vector("target")),
                narrow(t.vector("up", Eigen::Vector3d::UnitZ())),
                static_cast<float>(t.number("fov", 40.0, {.min = 0, .max = 180, .above = true}))};
  const Resolution size{t.integer<std::uint32_t>("width", {}, 1, 4096),
                        t.integer<std::uint32_t>("height", {}, 1, 4096)};
  t.finish();
  memory.add(t, "width", Shape::kRay, size.pixels());
  source = fmt::format("camera of {} x {} rays", size.width, size.height);
  try {
    return camera.rays(size);
  } catch (const Error& e) {
    t.fail(e.what());
  }
}

RandomRays read_random_rays(Table t, Memory& memory) {
  RandomRays rays;
  rays.count = t.integer<std::uint32_t>("count", {}, 1, kMostShapes);
  memory.add(t, "count", Shape::kRay, rays.count);
  rays.seed = t.integer<std::uint64_t>("seed", 1, 0, std::numeric_limits<std::int64_t>::max());
  rays.axis = unit(t, "axis", Eigen::Vector3d(0, 0, -1));
  rays.half_angle = kDegree * t.number("half_angle", 180.0, {.min = 0, .max = 180});
  rays.redraw = t.flag("redraw", true);
  t.finish();
  return rays;
}

// ---- Meshes ----

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.faces.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) triangles.push_back(mesh.triangle(i));
  return triangles;
}

Mesh read_mesh(Table& t, const std::filesystem::path& folder, std::filesystem::path& file,
               Memory& memory, Meshes& meshes) {
  const std::string spec = t.text("mesh");
  const bool builtin = spec == "terrain" || spec.starts_with("terrain:");
  if (!builtin) file = folder / spec;
  const double scale = t.number("scale", 1.0, kPositive);
  const auto attempt = [&](const auto& what) {
    try {
      return what();
    } catch (const Error& e) {
      t.fail(e.code(), "mesh", e.what());
    }
  };
  if (builtin)
    memory.add(t, "mesh", Shape::kTriangle,
               attempt([&] { return mesh_readers::builtin_triangles(spec); }));
  Mesh mesh = attempt([&] {
    Mesh made = builtin ? load_mesh_or_builtin(spec) : meshes.load(file);
    for (Eigen::Vector3f& v : made.vertices) v = (v.cast<double>() * scale).cast<float>();
    check(made, made.name);
    if (const auto why = out_of_range(made, made.name)) throw Error(ErrorCode::kBadInput, *why);
    return made;
  });
  if (!builtin) memory.add(t, "mesh", Shape::kTriangle, mesh.faces.size());
  return mesh;
}

Deformation read_deformation(Table t, const Mesh& mesh) {
  Deformation d;
  d.kind = static_cast<Deformation::Kind>(t.choice("kind", {"random", "wave"}));
  const auto most = static_cast<double>(mesh.vertices.size() - 1);
  std::vector<double> range = {0, most};
  if (t.has("vertices")) range = t.numbers("vertices", 2);
  if (!(range[0] >= 0 && range[0] <= range[1] && range[1] <= most &&
        range[0] == std::floor(range[0]) && range[1] == std::floor(range[1])))
    t.fail("vertices", fmt::format("must be [FIRST, LAST], whole numbers within 0..{}", most));
  d.first = static_cast<std::uint32_t>(range[0]);
  d.last = static_cast<std::uint32_t>(range[1]);
  d.amplitude = t.vector("amplitude");
  if (d.kind == Deformation::Kind::kRandom) {
    d.seed = t.integer<std::uint64_t>("seed", 1, 0, std::numeric_limits<std::int64_t>::max());
  } else {
    d.period = t.number("period", {}, kPositive);
    d.wavelength = t.number("wavelength", {}, kPositive);
    d.direction = unit(t, "direction", Eigen::Vector3d(1, 0, 0));
  }
  t.finish();
  return d;
}

void read_source(Table& t, const std::filesystem::path& folder, SceneObject& object, Memory& memory,
                 Meshes& meshes) {
  std::vector<std::string> sources = kShapeNames;
  sources.insert(sources.end(), {"mesh", "random", "camera", "random_rays", "rays_csv"});
  const std::string source = t.one_of(sources);
  const char* key = source.c_str();
  if (source == "mesh") {
    Mesh mesh = read_mesh(t, folder, object.file, memory, meshes);
    object.source = mesh.name + ", " + counted(mesh.faces.size(), "triangle");
    object.shapes = triangles_of(mesh);
    object.more_files = mesh.files;
    object.warnings = mesh.warnings;
    if (auto deform = t.table("deform")) {
      object.deform = read_deformation(*deform, mesh);
      object.mesh = std::move(mesh);
    }
  } else if (source == "random") {
    object.shapes = read_scatter(*t.table(key), object.source, memory);
  } else if (source == "camera") {
    object.shapes = read_camera(*t.table(key), object.source, memory);
  } else if (source == "random_rays") {
    object.rays = read_random_rays(*t.table(key), memory);
    object.shapes = std::vector<Ray>(object.rays->count);
    object.source = fmt::format("{}{}, seed {}", counted(object.rays->count, "random ray"),
                                object.rays->redraw ? " per frame" : "", object.rays->seed);
  } else if (source == "rays_csv") {
    const std::string file = t.text(key);
    object.file = folder / file;
    try {
      object.shapes = read_rays_csv(object.file);
    } catch (const Error& e) {
      t.fail(e.code(), key, e.what());
    }
    if (size(object.shapes) == 0) t.fail(key, fmt::format("{} has no rays", file));
    memory.add(t, key, Shape::kRay, size(object.shapes));
    object.source = file + ", " + counted(size(object.shapes), "ray");
  } else {
    const auto shape = static_cast<Shape>(
        std::find(kShapeNames.begin(), kShapeNames.end(), source) - kShapeNames.begin());
    object.shapes =
        with_shape<float>(shape, [&]<class P>() { return read_shapes<P>(t.tables(key)); });
    object.source = counted(size(object.shapes), source);
  }
  if (t.has("deform") && !object.deform)
    t.fail(ErrorCode::kUsage, "deform", "moves the vertices of a mesh; this object has no mesh");
}

/// Shapes of fp32 are checked where they are read.
void check_shapes(const Table& t, const Shapes& shapes, FpFormat format) {
  std::visit(
      [&](const auto& list) {
        for (std::size_t i = 0; i < list.size(); ++i)
          if (const auto why = defect(list[i], format))
            t.fail(fmt::format("{} {}: {}", name(shape_of(shapes)), i, *why));
      },
      shapes);
}

/// Copies of a shape: the file, the posed shapes, both sides of the card, and the reference.
constexpr std::uint64_t kCopies = 5;

}  // namespace

void Memory::add(const Table& t, const char* key, const std::string& what, std::uint64_t bytes) {
  constexpr std::uint64_t kMega = 1 << 20;
  bytes_ += bytes;
  if (bytes_ <= kMost) return;
  t.fail(
      ErrorCode::kCapacity, key,
      fmt::format("{} need {} MB, with earlier objects {} MB; the limit of a scene is {} MB", what,
                  (bytes + kMega - 1) / kMega, (bytes_ + kMega - 1) / kMega, kMost / kMega));
}

void Memory::add(const Table& t, const char* key, Shape shape, std::uint64_t count) {
  add(t, key, fmt::format("{} {}s", count, name(shape)), kCopies * 4 * words(shape) * count);
}

void Memory::add_poses(const Table& t, std::uint64_t count) {
  // The current pose, the last pose, and the centre that they start from.
  add(t, "motion", fmt::format("poses of {} shapes", count),
      (2 * sizeof(Transform) + sizeof(Eigen::Vector3d)) * count);
}

const Mesh& Meshes::load(const std::filesystem::path& file) {
  if (file == last_file_) return last_;
  std::error_code none;
  if (files_.insert(file).second)
    if (const auto size = std::filesystem::file_size(file, none); !none) bytes_ += size;
  const std::chrono::seconds most = ReadLimits::time_for(bytes_);
  if (spent_ >= most)
    throw Error(ErrorCode::kFile, fmt::format("the meshes of the scene are not read within {} s "
                                              "(CDE_READ_SECONDS sets another limit)",
                                              most.count()));
  MeshLimits limits = MeshLimits::from_environment();
  limits.time = std::min(limits.time, std::chrono::ceil<std::chrono::seconds>(most - spent_));
  const auto began = std::chrono::steady_clock::now();
  last_file_.clear();
  last_ = load_named_mesh(file, limits);
  last_file_ = file;
  spent_ += std::chrono::steady_clock::now() - began;
  return last_;
}

SceneObject read_object(Table& t, const std::filesystem::path& folder, Memory& memory,
                        Meshes& meshes, FpFormat format) {
  SceneObject object;
  object.name = t.text("name");
  if (object.name.empty()) t.fail("name", "is empty");
  t = t.named(fmt::format("object {}", in_quotes(object.name)));
  t.also_known({"motion", "parent", "deform", "scale"});
  read_source(t, folder, object, memory, meshes);
  if (format != FpFormat{} && !object.rays) check_shapes(t, object.shapes, format);
  if (auto motion = t.table("motion")) object.motion = read_motion(*motion, object);
  if (has_member_poses(object)) memory.add_poses(t, size(object.shapes));
  return object;
}

}  // namespace cde::scene_parts
