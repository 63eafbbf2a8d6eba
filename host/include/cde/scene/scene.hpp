// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/bitstream/bitstream.hpp"
#include "cde/card/board.hpp"
#include "cde/geometry/motion.hpp"
#include "cde/geometry/shapes.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/mesh/mesh.hpp"

/// What a scene file says (docs/scenes.md): objects that move, and what is asked of them in every
/// frame.
namespace cde {

/// Vertices of a mesh that move by themselves, in the object's frame.
struct Deformation {
  enum class Kind {
    kRandom,  ///< in every frame anywhere within the amplitude
    kWave,    ///< amplitude * sin(2 pi (time / period - travelled / wavelength))
  };
  Kind kind = Kind::kRandom;
  std::uint32_t first = 0, last = 0;  ///< vertices, both included
  Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();
  std::uint64_t seed = 1;
  double period = 1;                                     ///< seconds, > 0
  double wavelength = 1;                                 ///< units, > 0
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< of travel, unit
};

/// Rays from the object's origin in random directions within a cone.
struct RandomRays {
  std::uint32_t count = 256;
  std::uint64_t seed = 1;
  Eigen::Vector3d axis = -Eigen::Vector3d::UnitZ();  ///< unit
  double half_angle = 3.141592653589793;             ///< radians from the axis, 0 to pi
  bool redraw = true;                                ///< other directions in every frame
};

struct SceneObject {
  std::string name;
  std::string source;                             ///< where its shapes come from, for messages
  std::filesystem::path file;                     ///< that they were read from, or empty
  std::vector<std::filesystem::path> more_files;  ///< that `file` names (Mesh::files)
  std::vector<std::string> warnings = {};         ///< of reading them (Mesh::warnings)
  Shapes shapes;                                  ///< object's frame, undeformed, those of frame 0
  std::optional<Mesh> mesh;                       ///< of an object that is deformed
  std::optional<Deformation> deform;              ///< has mesh
  std::optional<RandomRays> rays;                 ///< directions drawn again in every frame
  Motion motion;                                  ///< in the parent's frame
  std::optional<std::size_t> parent;  ///< number of another object, whose motion it follows
};

/// What is compared with the reference.
enum class Check {
  kAll,     ///< every record
  kSample,  ///< the records of at most kSampledPrimaries primaries a packet, others in every frame
  kNone,
};
inline constexpr unsigned kSampledPrimaries = 8;
[[nodiscard]] const char* name_of(Check check);
[[nodiscard]] std::optional<Check> check_named(std::string_view text);

/// Form of the records that a run writes.
enum class Results { kNone, kCsv, kBinary, kNpy };

/// Members [first, first + count) of some list.
struct Range {
  std::size_t first = 0, count = 0;
};
/// Whether the number is in one of these, which are ascending and do not overlap.
[[nodiscard]] bool contains(const std::vector<Range>& ranges, std::size_t number);
/// How many numbers they have.
[[nodiscard]] std::size_t count(const std::vector<Range>& ranges);

/// Every primary against every secondary, in every frame. Primaries and secondaries are numbered
/// through their objects in the order given.
struct SceneQuery {
  std::string name;
  Pair pair = Pair::kRayTriangle;
  bool swap = false;                                ///< primaries are of the pair's second shape
  std::vector<std::size_t> primaries, secondaries;  ///< numbers of objects, each of one shape
  Mode mode = Mode::kNearest;
  bool normals = false;
  bool inside = false;  ///< records tell whether the primary is inside a secondary object
                        ///< (SceneInside)
  PairBudget budget;
  std::vector<Range> mask;  ///< primaries left out, ascending, with gaps between
  bool self = false;  ///< of an object on both sides, pairs of a shape with itself count, and those
                      ///< of two shapes from either side; otherwise the first never, and in modes
                      ///< all and hits each pair once, with the lower primary
};

/// Who moves rigid objects.
enum class Mover {
  kAuto,
  kHost,  ///< shapes are posed by the host and uploaded again
  kCard,  ///< the card's transformer, 12 words an object
};

/// Whether rays go through a hierarchy of the triangles.
enum class UseHierarchy {
  kAuto,  ///< where that takes less
  kOn,
  kOff,
};

/// What the scene wants of the card; an empty optional leaves the choice to the planner.
struct SceneCard {
  std::optional<unsigned> lanes;
  std::vector<Pair> pairs;  ///< pipes of the bitstream; empty: those of the queries
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};                             ///< BoardConfig::format
  std::optional<FpFormat> verdicts = std::nullopt;  ///< BoardConfig::verdicts
  Algorithm algorithm = kLeakFree;
  bool box = true;          ///< the box rule, of pairs that have it
  double clock_hz = 100e6;  ///< an assumption about the device
  bool cycle_bus = false;   ///< PCI signals clock by clock; otherwise its time is computed
  HostProfile host = kHostProfiles[0];  ///< that the card is plugged into
  unsigned burst = 4096;                ///< bytes of a DMA burst at most
  bool narrow = false;                  ///< the host has a 32-bit bus
  bool cycle_memory = false;            ///< DDR with the timing of banks and refresh
  bool ecc = false;
  bool trace = false;
  Mover mover = Mover::kAuto;
  UseHierarchy hierarchy = UseHierarchy::kAuto;
  unsigned latency_add = 1, latency_mul = 1, latency_div = 1, latency_sqrt = 1, latency_compare = 1;
};

struct Scene {
  std::string file;  ///< as it was named
  std::string title;
  std::uint32_t frames = 1;
  double rate = 30;  ///< frames a second: frame f shows the time f / rate
  Check check = Check::kAll;
  Results results = Results::kCsv;
  bool bits = false;       ///< CSV also has hexadecimal words
  bool only_hits = false;  ///< files leave out records with F = 0
  SceneCard card;
  std::vector<SceneObject> objects;
  std::vector<SceneQuery> queries;
  std::vector<std::string> warnings = {};  ///< what the user should know: a line each
};

/// Reads a scene file, and the meshes and rays that it names (paths are relative to its folder).
/// Errors name file, line, column and key, as compilers do ("a.toml:7:3: object 'ball': ..."), with
/// the nearest known word for one that is not known: kFile (not TOML, unknown or missing keys,
/// wrong types), kBadInput (shapes that break their contract, values out of range, references to
/// what is not there or in a circle), kUsage (what no card can do, such as rotating an AABB).
[[nodiscard]] Scene load_scene(const std::filesystem::path& path);

/// The same from a text. `name` stands for the file in messages and gives the folder.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& name);

[[nodiscard]] inline double seconds(const Scene& scene, std::uint32_t frame) {
  return frame / scene.rate;
}

/// Of an object in a frame, parents included: computed in binary64, each entry rounded once, so
/// that the rotation is orthonormal within a few units of 2^-24.
[[nodiscard]] Transform pose(const Scene& scene, const SceneObject& object, std::uint32_t frame);

/// The object's shapes in its own frame: deformed, directions drawn.
[[nodiscard]] Shapes local_shapes(const Scene& scene, const SceneObject& object,
                                  std::uint32_t frame);

/// Shapes that frame to frame are others in the object's own frame, ascending; the pose apart.
[[nodiscard]] std::vector<Range> deforming(const SceneObject& object);

/// Whether every shape has a pose of its own (RandomMotion::each), and that pose.
[[nodiscard]] bool has_member_poses(const SceneObject& object);
[[nodiscard]] std::vector<Transform> member_poses(const Scene& scene, const SceneObject& object,
                                                  std::uint32_t frame);

/// Whether its pose is the same in all frames, parents included.
[[nodiscard]] bool is_still(const Scene& scene, const SceneObject& object);

/// Shapes by a pose, every operation rounded to binary32. An AABB is only moved.
[[nodiscard]] Shapes posed(const Shapes& shapes, const Transform& pose);
/// Each by a pose of its own.
[[nodiscard]] Shapes posed(const Shapes& shapes, const std::vector<Transform>& poses);

}  // namespace cde
