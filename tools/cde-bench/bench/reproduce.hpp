// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/bvh_figures.hpp"
#include "cde/card/host_profile.hpp"
#include "page/time_split.hpp"

/// `cde reproduce`: measures the paper's Figures 5, 6 and 7 again, and the rays of Figure 5 with a
/// BVH (docs/background/reproduction.md).
namespace cde::cli {

/// The source of a figure.
enum class Source {
  kPaper,     ///< printed in the paper, or derived from its figures
  kCard,      ///< modelled time of the simulated card
  kSoftware,  ///< processor time of one thread of this machine
  kOpenCl,    ///< wall time of an OpenCL device, copies of queries and answers included
};

/// Time of one frame.
struct Entry {
  std::string name;
  Source source = Source::kCard;
  double seconds = 0;  ///< for software the median
  std::string note;
  std::optional<TimeSplit> split = {};  ///< parts of the card's time
  ModelledTime time = {};               ///< the same in the form of a run
  std::optional<Spread> spread = {};    ///< spread of software times
  bool warm = false;                    ///< the same rays in every frame; a real frame has new rays
};

/// A workload, with the times of cards and software.
struct Experiment {
  std::string name, title;
  std::uint64_t tests = 0;  ///< pairs per frame
  std::vector<Entry> entries;
};

/// A card of the comparison, and its host.
struct Setup {
  std::string name;
  unsigned lanes = 1;
  HostProfile host;
  std::uint32_t burst = 4096;  ///< bytes
  bool all_records = false;    ///< whether the record of every pair goes to the host
};

/// A terrain with a BVH, and the best card with brute force on the same rays.
struct WithBvh {
  BvhFigures figures;
  Entry brute_force;
};

struct ReproduceOptions {
  bool quick = false;  ///< a small terrain, few spheres
  Device device = default_device();
  unsigned lanes = default_device().lanes;            ///< of the best card
  std::optional<baseline::OpenClDevice> opencl = {};  ///< device of rows in Figures 5 to 7
};

struct Reproduction {
  ReproduceOptions options;
  std::vector<Setup> setups;  ///< as in the paper, one lane with reduction, best
  std::size_t triangles = 0, moved_triangles = 0;
  std::string vector_kind;  ///< "AVX2" and so on
  bool embree = false;
  double embree_build_seconds = 0;
  std::uint64_t records_compared = 0;  ///< records compared with the reference, bit by bit
  std::vector<Experiment> figure5, figure6;
  std::vector<Experiment> figure7;  ///< one per number of spheres, ascending
  std::vector<std::size_t> spheres;
  std::vector<WithBvh> bvh;  ///< ascending; the last is the terrain of Figure 5
};

/// Runs all measurements. Error kMismatch if a record of the card differs from the reference, or
/// software finds other hits.
[[nodiscard]] Reproduction reproduce(const ReproduceOptions& options);

[[nodiscard]] nlohmann::ordered_json reproduction_json(const Reproduction& r,
                                                       const nlohmann::ordered_json& machine);
[[nodiscard]] std::string reproduction_html(const Reproduction& r,
                                            const nlohmann::ordered_json& machine);

/// Figures printed in the paper.
inline constexpr std::uint64_t kPaperTests = 259'572;              ///< tests per frame of Figure 5
inline constexpr double kPaperCard = 0.031, kPaperSoftware = 2.1;  ///< seconds, Figure 5
inline constexpr double kPaperGpuRatio = 4;  ///< GPU time over card time, Figure 5
inline constexpr double kPaperRatio5 = 70, kPaperRatio6 = 30, kPaperRatio7 = 1.4;

}  // namespace cde::cli
