// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/model/bus.hpp"

namespace cde {

/// Arithmetic of the simulated card. Results and cycles are identical.
enum class Arithmetic {
  kHost,  ///< the host's FPU, called from the pipeline: fast to simulate
  kRtl,   ///< the gates of rtl/fp
};

/// Error kUsage if the value is not one of these.
void check(Arithmetic arithmetic);

/// Error kUsage, with the reason, if no card has the format.
void check_card_format(FpFormat format);

/// Error kUsage, with the rule, if a certified filter in `narrow` cannot precede lanes of `wide`
/// (`BoardConfig::filter`). `narrow` must have no more exponent bits, and fewer fraction bits.
void check_narrow_format(FpFormat narrow, FpFormat wide);

/// Objects that the card's transformer moves before a pass tests them.
enum class Transformer : unsigned { kNone, kSecondaries, kBoth };

/// Latencies of operators in cycles, 1 to kMostOperatorLatency, in the order of a card's
/// parameters.
struct OperatorLatencies {
  unsigned add = 1, mul = 1, div = 1, sqrt = 1, compare = 1;
  bool operator==(const OperatorLatencies&) const = default;
};
inline constexpr unsigned kMostOperatorLatency = 64;
/// The five in their order.
[[nodiscard]] constexpr std::array<unsigned, 5> cycles_of(const OperatorLatencies& l) {
  return {l.add, l.mul, l.div, l.sqrt, l.compare};
}

/// One elaborated configuration of rtl/board.sv, or of rtl/card.sv around it.
struct BoardConfig {
  unsigned lanes = 16;  ///< pairs per cycle: a power of two, 1 to 256
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};  ///< of all numbers on the card: fp16, bf16, tf32, fp24 or fp32
                         ///< (is_card_format). The driver takes and returns floats
  std::vector<Pair> pairs = {Pair::kRayTriangle};  ///< the pipes of the card, at least one
  Algorithm algorithm = Algorithm::kMoller;        ///< of ray-triangle
  bool box = false;   ///< box rule. Ray-triangle: a hit must lie in the triangle's box
                      ///< (reference/pipes/ray_box.hpp). Other pairs of has_box_rule(): the signed
                      ///< distance is at least the distance of the boxes
                      ///< (reference/pipes/distance_bound.hpp).
  bool swap = false;  ///< passes can exchange the roles of primary and secondary
  bool normals = false;       ///< passes can return normals
  bool parallel = false;      ///< a pass can use two pipes at once (Query::second)
  unsigned sat_interval = 1;  ///< cycles from row to row of SAT pairs, 1 or 3. With 3, one unit
                              ///< tests three candidate axes in turn (has_sat_interval)
  std::optional<FpFormat> filter =
      std::nullopt;  ///< certified filter: narrow lanes prove misses of pairs of solids
                     ///< (`has_filter`) in modes any and hits. One lane of `format` tests the
                     ///< uncertain pairs. Records are the same
  unsigned traversal_units = 0;  ///< for a BVH: 0 (none), 1, 2 or 4. Only fp32 cards with a
                                 ///< pair that can traverse a BVH (traversal_shapes())
  unsigned nodes = 65'536;  ///< most nodes of a BVH, a power of two from 16 to 2^22; eight slots of
                            ///< leaves per node. Without a cache all are on chip
  unsigned node_cycles =
      1;  ///< cycles per node of a traversal unit, 1, 2 or 4. Above 1 its
          ///< operators for rays are shared: a half or a quarter of the multipliers
  unsigned node_cache = 0;  ///< 0: all nodes are on chip. Else the nodes in the cache of each
                            ///< traversal unit, a power of two up to 2^16. The first `pinned_nodes`
                            ///< nodes are on chip, the others and all slots in DDR
  unsigned node_ways = 4;   ///< of the cache: 2, 4, 8 or 16, at most node_cache / 2
  unsigned pinned_nodes = 4096;  ///< with a cache, a power of two from 16 to `nodes`
  unsigned contexts = 256;     ///< primaries that traverse a BVH at a time, a power of two from 16
  unsigned shared_lane = 0;    ///< 0, or 1, 2, 4 or 8: brute-force passes and leaves of a BVH share
                               ///< one lane, which takes a row per so many cycles. Only with one
                               ///< lane, and ray-triangle by Möller alone
  unsigned ray_places = 4096;  ///< of the queue of primaries, a power of two from 64
  Transformer transform = Transformer::kNone;  ///< objects (Board::set_objects) can move
  unsigned objects = 1024;                     ///< size of the card's object table, 2 to 2,048
  unsigned primary_objects = 64;               ///< the same for primaries
  OperatorLatencies latency = {};
  unsigned ddr_slots =
      55'555'555;  ///< DDR size in triangles (36 bytes each); the default is two 1 GB modules
  unsigned sram_records = 524'288;  ///< record ring, a power of two; seven 2 MB chips
  Bus bus = Bus::kFunctional;       ///< kCycle: the card with its PCI bridge.
  bool ecc = false;  ///< check bits in DDR: one wrong bit per word is corrected, more are an error.
  bool trace = false;  ///< waves can be written; the simulation is slower

  /// Whether the card has the box rule for a pair. It does not for pairs of the certified filter.
  [[nodiscard]] bool box_rule(Pair pair) const;
  /// Whether `shared_lane` may be above 0, on a card with traversal units.
  [[nodiscard]] bool can_share_lane() const;
  /// Shapes with which a pair traverses a BVH on this card; nothing if it has brute-force passes
  /// only.
  [[nodiscard]] std::optional<TraversalShapes> traversal_shapes(Pair pair, bool swap) const;
  /// NAME=VALUE for the builder, without values that are the RTL's defaults. Error kUsage, naming
  /// it, if a value is out of range.
  [[nodiscard]] std::vector<std::string> parameters() const;
  /// The configuration with these parameters. Nothing if a parameter is unknown, given twice or out
  /// of range.
  [[nodiscard]] static std::optional<BoardConfig> of(const std::vector<std::string>& parameters);
  /// Top module: "board", or "card" with its PCI bridge.
  [[nodiscard]] const char* top() const { return bus == Bus::kCycle ? "card" : "board"; }
};

/// A loaded simulation model: one elaborated configuration as a shared library. Copies share the
/// library.
///
/// Models are named `CACHE_KEY.so`. The key covers parameters, RTL, harness, tools and CPU. Beside
/// it `CACHE_KEY.so.sha256` has its checksum. They are first searched for in $CDE_MODELS. Next
/// is the folder of the installation, or of the build if the program is not installed. Last is the
/// user's cache: $CDE_CACHE, else $XDG_CACHE_HOME/cde, else ~/.cache/cde, else (also if that cannot
/// be written) /tmp/cde-UID.
///
/// A missing or damaged model is built into the cache by the script `verilator/model_builder` of
/// $CDE_SHARE, else of the installation or source tree. Function expected_build_seconds() estimates
/// the time; progress goes to stderr. Processes that need the same model wait for each other.
/// During a build, SIGINT, SIGTERM and SIGHUP first end the build. Then they take their usual
/// effect: a handler, or the end of the process. Error kInterrupted if the process continues.
///
/// Loaded folders and files must belong to the user or to root, and no other user may write them.
/// Others are skipped with a message on stderr that names them; for the cache itself it is error
/// kFile.
class SimulationModel {
 public:
  /// `kind` is a top module, e.g. "board". Error kBuild with the builder's last lines, or with what
  /// is missing. Error kUsage if the builder refuses a parameter.
  [[nodiscard]] static SimulationModel open(const std::string& kind,
                                            const std::vector<std::string>& parameters);

  /// Loads a file that may be any shared library. Its configuration hash is taken as `config_hash`.
  /// Error kConfiguration if it cannot be loaded, or differs from the checksum beside it. Error
  /// kFile if another user can write it or its folder.
  [[nodiscard]] static SimulationModel load(const std::filesystem::path& file,
                                            std::uint64_t config_hash);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Hash of the requested configuration; the card must show the same.
  [[nodiscard]] std::uint64_t config_hash() const { return config_hash_; }

  /// Address of an exported function. Error kConfiguration if it is missing.
  [[nodiscard]] void* symbol(const char* name) const;

 private:
  SimulationModel() = default;
  static SimulationModel link(const std::filesystem::path& named,
                              const std::filesystem::path& inside, std::uint64_t config_hash);
  std::shared_ptr<void> library_;
  std::filesystem::path path_;
  std::uint64_t config_hash_ = 0;
};

/// Rough number of seconds to build a simulation model with these parameters on two cores.
[[nodiscard]] double expected_build_seconds(const std::vector<std::string>& parameters);

/// Whether builds report themselves and their phases on stderr. The default is true. Returns the
/// value before.
bool report_builds(bool tell);

/// File of a configuration, built if necessary: SimulationModel::open without loading.
[[nodiscard]] std::filesystem::path model_path(const std::string& kind,
                                               const std::vector<std::string>& parameters);

/// Where the file of a configuration is, or would be built.
struct ModelFile {
  std::filesystem::path path;
  bool built = false;
};
/// Builds nothing. Error kBuild as for SimulationModel::open.
[[nodiscard]] ModelFile model_file(const std::string& kind,
                                   const std::vector<std::string>& parameters);

/// Parameters of the existing simulation models of a kind, in all searched folders. They come from
/// the comments beside the files; sorted, without duplicates. Nothing else is checked:
/// model_file() tells whether a configuration's file exists and is intact under its key.
[[nodiscard]] std::vector<std::vector<std::string>> built_models(const std::string& kind);

/// Hash that the card of a configuration shows. Error kBuild as for SimulationModel::open.
[[nodiscard]] std::uint64_t model_hash(const std::string& kind,
                                       const std::vector<std::string>& parameters);

/// Folders for messages and `cde doctor`.
/// Created with mode 0700 if missing; error kFile.
[[nodiscard]] std::filesystem::path model_cache();
[[nodiscard]] std::filesystem::path model_builder();  ///< the script; error kBuild if not found

}  // namespace cde
