// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/bitstream/bus.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/pair.hpp"

namespace cde {

/// Arithmetic of the simulated card; results and clocks are the same bit for bit.
enum class Arithmetic {
  kHost,  ///< the host's FPU called from the pipeline: fast to simulate
  kRtl,   ///< the gates of rtl/fp
};

/// Error kUsage if it is neither.
void check(Arithmetic arithmetic);

/// Error kUsage, with the reason, if no card has the format.
void check_card_format(FpFormat format);

/// Error kUsage, with the rule, if lanes of `narrow` cannot stand before one of `wide`
/// (BoardConfig::verdicts): they have no more exponent bits and fewer fraction bits.
void check_narrow_format(FpFormat narrow, FpFormat wide);

/// What the card's transformer moves before a pass meets it.
enum class Transformer : unsigned { kNone, kSecondaries, kBoth };

/// One elaborated configuration of rtl/board.sv, or of rtl/card.sv around it.
struct BoardConfig {
  unsigned lanes = 16;  ///< pairs a clock: a power of two, 1 to 256
  Arithmetic arithmetic = Arithmetic::kHost;
  FpFormat format = {};  ///< of all numbers on the card: fp16, bf16, tf32, fp24 or fp32
                         ///< (is_card_format). The driver takes and gives floats all the same
  std::vector<Pair> pairs = {Pair::kRayTriangle};  ///< the pipes of the card, at least one
  Algorithm algorithm = Algorithm::kMoller;        ///< of ray-triangle
  bool box = false;             ///< of ray-triangle: a hit must lie in the triangle's box
                                ///< (reference/pipes/ray_box.hpp); of the other pairs that
                                ///< has_box_rule() says: a gap is at least that of the boxes
                                ///< (reference/pipes/gap_bound.hpp)
  bool swap = false;            ///< passes can exchange the roles of primary and secondary
  bool normals = false;         ///< passes can give normals
  bool parallel = false;        ///< a pass can use two pipes at a time (Query::second)
  unsigned facet_interval = 1;  ///< clocks from row to row of pairs with facets, 1 or 3: with 3 the
                                ///< gates of three facets are one unit's (has_facets)
  std::optional<FpFormat> verdicts =
      std::nullopt;         ///< narrow lanes prove misses of pairs of solids
                            ///< (has_verdicts) in modes any and hits, and one lane of
                            ///< `format` tests what they leave open: the same records
  unsigned node_units = 0;  ///< of a hierarchy: 0 (none), 1, 2 or 4; of fp32 cards with a pair
                            ///< that has a way through one (way_through())
  unsigned nodes = 65'536;  ///< that its memory holds, a power of two, up to 2^22; and eight slots
                            ///< of leaves each
  Transformer transform = Transformer::kNone;  ///< objects (Board::set_objects) can move
  unsigned objects = 1024;                     ///< that the card's table holds, 2 to 2,048
  unsigned primary_objects = 64;               ///< likewise
  unsigned latency_add = 1;                    ///< clocks of an operator, at least 1
  unsigned latency_mul = 1;
  unsigned latency_div = 1;
  unsigned latency_sqrt = 1;
  unsigned latency_compare = 1;
  unsigned ddr_slots =
      55'555'555;  ///< DDR in triangles (36 bytes); the default is two 1 GB modules
  unsigned sram_records = 524'288;  ///< ring of records, a power of two; seven 2 MB chips
  Bus bus = Bus::kFunctional;       ///< kCycle: the card with its PCI bridge
  bool ecc = false;  ///< check bits in DDR: one wrong bit of a word is corrected, more are an error
  bool trace = false;  ///< waves can be written (and everything runs slower)

  /// Whether the card has the box rule of a pair: not where narrow lanes prove misses.
  [[nodiscard]] bool box_rule(Pair pair) const;
  /// Which primaries go through a hierarchy over what, with node units; nothing where they sweep.
  [[nodiscard]] std::optional<WayThrough> way_through(Pair pair, bool swap) const;
  /// NAME=VALUE for the builder, without what the RTL has as default. Error kUsage if a value is
  /// out of range, naming it.
  [[nodiscard]] std::vector<std::string> parameters() const;
  /// The configuration that these parameters make; nothing if a parameter is unknown, given twice
  /// or out of range.
  [[nodiscard]] static std::optional<BoardConfig> of(const std::vector<std::string>& parameters);
  /// Top module: "board", or "card" with its PCI bridge.
  [[nodiscard]] const char* top() const { return bus == Bus::kCycle ? "card" : "board"; }
};

/// A loaded bitstream: one elaborated configuration as a shared library. Copies share the library.
///
/// Bitstreams are called <cache key>.so, the key covering parameters, RTL, harness, tools and CPU;
/// <cache key>.so.sha256 beside it has its checksum. They are searched for in $CDE_BITSTREAMS, in
/// the folder of the installation, or of the build where the program is not an installed one, and
/// in the user's cache ($CDE_CACHE, else $XDG_CACHE_HOME/cde, else ~/.cache/cde, else, or if that
/// cannot be written, /tmp/cde-UID). One that is nowhere, or whose file is damaged, is built into
/// the cache by the script `verilator/bitstream` (of $CDE_SHARE, else of the installation or source
/// tree): see usual_build_seconds(), with progress on stderr. Processes that want the same one wait
/// for each other. While one is built, SIGINT, SIGTERM and SIGHUP end the build before they do what
/// else they would (which is their handler's or the end of the process; error kInterrupted where
/// the process goes on).
///
/// Folders and files that are loaded belong to the user or to root and can be written by nobody
/// else; others are passed over with a message on stderr that names them, or, of the cache itself,
/// error kFile.
class Bitstream {
 public:
  /// `kind` is a top module, e.g. "board". Errors: kBuild with the builder's last lines (or what is
  /// missing); kUsage if the builder refuses a parameter.
  [[nodiscard]] static Bitstream open(const std::string& kind,
                                      const std::vector<std::string>& parameters);

  /// A file, of which nothing is assumed but that it is a shared library; its configuration hash is
  /// taken as `config_hash`. Errors: kConfiguration if it cannot be loaded, or is not what the
  /// checksum beside it says; kFile if it, or its folder, can be written by somebody else.
  [[nodiscard]] static Bitstream load(const std::filesystem::path& file, std::uint64_t config_hash);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// What the configuration asked for hashes to; the card must show the same.
  [[nodiscard]] std::uint64_t config_hash() const { return config_hash_; }

  /// Address of an exported function. Error kConfiguration if there is none of that name.
  [[nodiscard]] void* symbol(const char* name) const;

 private:
  Bitstream() = default;
  static Bitstream link(const std::filesystem::path& named, const std::filesystem::path& inside,
                        std::uint64_t config_hash);
  std::shared_ptr<void> library_;
  std::filesystem::path path_;
  std::uint64_t config_hash_ = 0;
};

/// Seconds that a build of a bitstream with such parameters takes on two cores, roughly.
[[nodiscard]] double usual_build_seconds(const std::vector<std::string>& parameters);

/// Whether a bitstream that is built says so on stderr, with its phases. It does unless told
/// otherwise.
void tell_builds(bool tell);

/// Where the file of a configuration is, building it if need be; Bitstream::open without the
/// loading.
[[nodiscard]] std::filesystem::path bitstream_path(const std::string& kind,
                                                   const std::vector<std::string>& parameters);

/// The file of a configuration as it is: where it lies, or where it would be built.
struct BitstreamFile {
  std::filesystem::path path;
  bool built = false;
};
/// Builds nothing. Error kBuild as above.
[[nodiscard]] BitstreamFile bitstream_file(const std::string& kind,
                                           const std::vector<std::string>& parameters);

/// Parameters of the bitstreams of a kind that lie in the folders that are asked, as the comments
/// beside them say; sorted, each once. Nothing is known of the files but that: bitstream_file says
/// whether the one of a configuration is there and whole, under the name that its key gives it.
[[nodiscard]] std::vector<std::vector<std::string>> kept_bitstreams(const std::string& kind);

/// Hash that the card of a configuration shows. Error kBuild as above.
[[nodiscard]] std::uint64_t bitstream_hash(const std::string& kind,
                                           const std::vector<std::string>& parameters);

/// Folders for messages and `cde doctor`.
[[nodiscard]] std::filesystem::path bitstream_cache();  ///< made, 0700, if it does not exist; kFile
[[nodiscard]] std::filesystem::path bitstream_builder();  ///< the script; error kBuild if nowhere

}  // namespace cde
