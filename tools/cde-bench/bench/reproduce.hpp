// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/tree_figures.hpp"
#include "cde/card/host_profile.hpp"
#include "page/time_split.hpp"

/// `cde reproduce`: the paper's Figures 5, 6 and 7 measured again, and what a hierarchy makes of
/// the first (docs/background/reproduction.md).
namespace cde::cli {

/// Where a figure comes from.
enum class Source {
  kPaper,     ///< printed in the paper, or follows from what is
  kCard,      ///< modelled time of the simulated card
  kSoftware,  ///< processor time of one thread of this machine
};

/// Time of one frame.
struct Entry {
  std::string name;
  Source source = Source::kCard;
  double seconds = 0;  ///< of software the median
  std::string note;
  std::optional<TimeSplit> split = {};  ///< of the card
  ModelledTime time = {};               ///< the same as a run has it
  std::optional<Spread> spread = {};    ///< of software
  bool warm = false;                    ///< the same rays again and again: no frame is like that
};

/// One workload, and who did it in what time.
struct Experiment {
  std::string name, title;
  std::uint64_t tests = 0;  ///< pairs in a frame
  std::vector<Entry> entries;
};

/// A card of the comparison and the host it is plugged into.
struct Setup {
  std::string name;
  unsigned lanes = 1;
  HostProfile host;
  std::uint32_t burst = 4096;  ///< bytes
  bool all_records = false;    ///< every pair's record goes to the host
};

/// A terrain with a hierarchy over it, and the best card that sweeps the same frame of rays.
struct WithHierarchy {
  TreeFigures tree;
  Entry sweep;
};

struct ReproduceOptions {
  bool quick = false;   ///< a small terrain, few spheres
  unsigned lanes = 16;  ///< of the best card
  double clock_hz = 100e6;
  std::string clock_is = "an assumption about the device, not a measurement";
};

struct Reproduction {
  ReproduceOptions options;
  std::vector<Setup> setups;  ///< the paper's, one lane with reduction, the best
  std::size_t triangles = 0, moved_triangles = 0;
  std::string vector_kind;  ///< "AVX2" and so on
  bool embree = false;
  double embree_build_seconds = 0;
  std::uint64_t records_compared = 0;  ///< with the reference, bit by bit
  std::vector<Experiment> figure5, figure6;
  std::vector<Experiment> figure7;  ///< one a number of spheres, ascending
  std::vector<std::size_t> spheres;
  std::vector<WithHierarchy> hierarchy;  ///< ascending; the last is the terrain of Figure 5
};

/// Runs everything. Error kMismatch if a record of the card differs from the reference, or software
/// finds other hits.
[[nodiscard]] Reproduction reproduce(const ReproduceOptions& options);

[[nodiscard]] nlohmann::ordered_json reproduction_json(const Reproduction& r,
                                                       const nlohmann::ordered_json& machine);
[[nodiscard]] std::string reproduction_html(const Reproduction& r,
                                            const nlohmann::ordered_json& machine);

/// What the paper prints.
inline constexpr std::uint64_t kPaperTests = 259'572;              ///< a frame of Figure 5
inline constexpr double kPaperCard = 0.031, kPaperSoftware = 2.1;  ///< seconds, Figure 5
inline constexpr double kPaperGpuRatio = 4;                        ///< card against GPU, Figure 5
inline constexpr double kPaperRatio5 = 70, kPaperRatio6 = 30, kPaperRatio7 = 1.4;

}  // namespace cde::cli
