// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cast/words.hpp"
#include "cde/image/camera.hpp"
#include "cde/scene/cast_plan.hpp"

/// The options of `cde cast` or `cde render` as typed values, checked against each other.
namespace cde::cli {

/// The source of rays: a file, the command line, or the pixels of a picture.
struct RaySource {
  std::string file;
  std::vector<Ray> given;
  std::optional<Camera> camera;
  std::optional<Resolution> grid, size;
  char up = 'z';             ///< the axis that is up in pictures
  bool up_is_asked = false;  ///< false: the format of the mesh decides

  /// Whether rays are listed, not made for a picture.
  [[nodiscard]] bool listed() const { return !file.empty() || !given.empty(); }
};

/// Files of a picture; an empty name: not wanted.
struct PictureFiles {
  std::string shaded, depth, normals, indices;
  bool shadows = false;
  bool shows_itself = false;  ///< `shaded` has the default name; a terminal also shows it

  [[nodiscard]] bool any() const {
    return !depth.empty() || !shaded.empty() || !normals.empty() || !indices.empty();
  }
};

struct CastTask {
  std::string verb = "cast", mesh;
  RaySource source;
  CastRequest request;
  std::string records;              ///< file name, "-" for stdout, or empty
  std::vector<std::string> fields;  ///< additional columns of the records
  PictureFiles picture;
  TraceRequest trace;
  BundleRequest bundle;
  DistributionOptions distribution;
  unsigned boards = 1;
  unsigned partition = 1;  ///< parts of the mesh, each on a card of its own
  double timeout = 3600;
  std::uint64_t deadline = 0;
  bool bits = false, json = false, quiet = false;
  bool check = true;                    ///< every record is compared with the reference
  std::uint64_t brute_force_rays = 64;  ///< with a BVH: rays also compared with brute force
};

/// Error kUsage for options that cannot be combined, before any work starts.
[[nodiscard]] CastTask task_of(const CastWords& words);

/// Error kUsage if an output is also an input or another output. `more` are files that the mesh
/// names.
void check_files(const CastTask& task, const std::vector<std::string>& more = {});

/// "host" or "rtl".
[[nodiscard]] const char* name_of(Arithmetic arithmetic);

}  // namespace cde::cli
