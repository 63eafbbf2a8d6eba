// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/card/board.hpp"
#include "cde/geometry/motion.hpp"
#include "cde/geometry/shapes.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/mesh/mesh.hpp"
#include "cde/model/device.hpp"

/// @file
/// Contents of a scene file (docs/reference/scenes.md): moving objects, and the queries about them
/// in every frame.
namespace cde {

/// Vertices of a mesh that move on their own, in the object's frame.
struct Deformation {
  enum class Kind {
    kRandom,  ///< in every frame a random offset within the amplitude
    kWave,    ///< amplitude * sin(2 pi (time / period - travelled / wavelength))
  };
  Kind kind = Kind::kRandom;
  std::uint32_t first = 0, last = 0;  ///< vertices, both inclusive
  Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();
  std::uint64_t seed = 1;
  double period = 1;                                     ///< seconds, > 0
  double wavelength = 1;                                 ///< units, > 0
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< direction of travel, unit
};

/// Rays from the object's origin in random directions within a cone.
struct RandomRays {
  std::uint32_t count = 256;
  std::uint64_t seed = 1;
  Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();  ///< unit
  double half_angle = 3.141592653589793;             ///< radians from the axis, 0 to pi
  bool redraw = true;                                ///< new directions in every frame
};

/// Objects that an object can follow: its parent, the parent's parent, and so on.
inline constexpr unsigned kMostParents = 1000;

struct SceneObject {
  std::string name;
  std::string source;                             ///< origin of its shapes, for messages
  std::filesystem::path file;                     ///< file of the shapes, or empty
  std::vector<std::filesystem::path> more_files;  ///< files that `file` names (Mesh::files)
  std::vector<std::string> warnings = {};         ///< of reading the files (Mesh::warnings)
  Shapes shapes;                                  ///< object's frame, undeformed, of frame 0
  std::optional<Mesh> mesh;                       ///< if the object is deformed
  std::optional<Deformation> deform;              ///< needs `mesh`
  std::optional<RandomRays> rays;                 ///< directions drawn again in every frame
  Motion motion;                                  ///< in the parent's frame
  std::optional<std::size_t> parent;  ///< number of another object whose motion it follows
};

/// Which records are compared with the reference.
enum class Check {
  kAll,     ///< every record
  kSample,  ///< records of at most kSampledPrimaries primaries per packet, other ones in every
            ///< frame
  kNone,
};
inline constexpr unsigned kSampledPrimaries = 8;
[[nodiscard]] const char* name_of(Check check);
[[nodiscard]] std::optional<Check> check_named(std::string_view text);

/// Format of the records that a run writes.
enum class Results { kNone, kCsv, kBinary, kNpy };

/// Members [first, first + count) of a list.
struct Range {
  std::size_t first = 0, count = 0;
};
/// Whether the number is in one of the ranges, which are ascending and do not overlap.
[[nodiscard]] bool contains(const std::vector<Range>& ranges, std::size_t number);
/// How many numbers the ranges hold.
[[nodiscard]] std::size_t count(const std::vector<Range>& ranges);

/// Tests every primary against every secondary, in every frame. Primaries and secondaries are
/// numbered through their objects in the given order.
struct SceneQuery {
  std::string name;
  Pair pair = Pair::kRayTriangle;
  bool swap = false;  ///< primaries have the pair's second shape
  /// Object numbers; all objects of a side have one shape.
  std::vector<std::size_t> primaries, secondaries;
  Mode mode = Mode::kNearest;
  bool normals = false;
  bool inside = false;  ///< records tell whether the primary is inside a secondary object
                        ///< (SceneInside)
  PairIterations iterations;
  std::vector<Range> mask;  ///< masked primaries, ascending, not adjacent
  /// For an object on both sides: pairs of a shape with itself count, and pairs of two shapes count
  /// from either side. Without it the former never count. In modes all and hits the latter count
  /// once, with the lower primary.
  bool self = false;
};

/// Site that transforms rigid objects.
enum class TransformSite {
  kAuto,
  kHost,  ///< the host poses shapes and uploads them again
  kCard,  ///< the card's transformer, 12 words per object
};

/// Whether rays traverse a BVH of the triangles.
enum class UseBvh {
  kAuto,  ///< if that takes less time
  kOn,
  kOff,
};

/// What the scene requests of the card. The planner chooses for an empty optional.
struct SceneCard {
  Device device = default_device();  ///< of modelled times; clock and latencies may be changed
  std::optional<unsigned> lanes;
  std::vector<Pair> pairs;  ///< pipes of the card; empty: the pairs of the queries
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};                           ///< BoardConfig::format
  std::optional<FpFormat> filter = std::nullopt;  ///< `BoardConfig::filter`
  Algorithm algorithm = kLeakFree;
  bool box = true;         ///< box rule, for pairs that have it
  bool cycle_bus = false;  ///< PCI signals cycle by cycle; otherwise PCI time is computed
  HostProfile host = kHostProfiles[0];  ///< host of the card
  unsigned burst = 4096;                ///< most bytes per DMA burst
  bool narrow = false;                  ///< the host has a 32-bit bus
  bool cycle_memory = false;            ///< DDR timing with banks and refresh
  bool ecc = false;
  bool trace = false;
  TransformSite transform_site = TransformSite::kAuto;
  UseBvh bvh = UseBvh::kAuto;
};

struct Scene {
  std::string file;    ///< as named by the user
  std::string digest;  ///< SHA-256 of the file's bytes
  std::string title;
  std::uint32_t frames = 1;
  double rate = 30;  ///< frames per second: frame f is at time f / rate
  Check check = Check::kAll;
  Results results = Results::kCsv;
  bool bits = false;       ///< CSV also has hexadecimal words
  bool only_hits = false;  ///< omits records with F = 0
  SceneCard card;
  std::vector<SceneObject> objects;
  std::vector<SceneQuery> queries;
  std::vector<std::string> warnings = {};  ///< warnings for the user, one line each
};

/// Reads a scene file, and the meshes and rays that it names, relative to its folder. Errors name
/// file, line, column and key as compilers do: "a.toml:7:3: object 'ball': ...". For an unknown
/// word they suggest the nearest known one.
/// Error kFile: not TOML, unknown or missing keys, wrong types. Error kBadInput: shapes that break
/// their contract, values out of range, missing or circular references. Error kUsage: what no card
/// can do, such as rotating an AABB.
[[nodiscard]] Scene load_scene(const std::filesystem::path& path);

/// The same for a scene that another file names. Error kFile if it is no regular file: a FIFO could
/// let this process wait for ever.
[[nodiscard]] Scene load_named_scene(const std::filesystem::path& path);

/// The same from a text. `name` names the file in messages and gives the folder.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& name);

[[nodiscard]] inline double seconds(const Scene& scene, std::uint32_t frame) {
  return frame / scene.rate;
}

/// Pose of an object in a frame, parents included. It is computed in binary64 and each entry is
/// rounded once, so the rotation is orthonormal within a few units of 2^-24.
[[nodiscard]] Transform pose(const Scene& scene, const SceneObject& object, std::uint32_t frame);

/// The object's shapes in its own frame, deformed and with directions drawn.
[[nodiscard]] Shapes local_shapes(const Scene& scene, const SceneObject& object,
                                  std::uint32_t frame);

/// Shapes that differ from frame to frame in the object's own frame, ascending; its pose does not
/// count.
[[nodiscard]] std::vector<Range> deforming(const SceneObject& object);

/// Whether every shape has its own pose (RandomMotion::each), and these poses.
[[nodiscard]] bool has_member_poses(const SceneObject& object);
[[nodiscard]] std::vector<Transform> member_poses(const Scene& scene, const SceneObject& object,
                                                  std::uint32_t frame);

/// Whether the object's pose is the same in all frames, parents included.
[[nodiscard]] bool is_still(const Scene& scene, const SceneObject& object);

/// Shapes moved by a pose, every operation rounded to binary32. An AABB is only translated.
[[nodiscard]] Shapes posed(const Shapes& shapes, const Transform& pose);
/// Shapes moved by one pose each.
[[nodiscard]] Shapes posed(const Shapes& shapes, const std::vector<Transform>& poses);

}  // namespace cde
