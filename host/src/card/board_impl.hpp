// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <array>
#include <chrono>

#include "card/bus_time.hpp"
#include "card/card_link.hpp"
#include "cde/card/board.hpp"
#include "cde/fp/scalars.hpp"
#include "cde/support/error.hpp"

namespace cde {

/// An object table of the card, and what the driver wrote into it.
struct ObjectTable {
  const char* slots;     ///< the side of the ranges, for messages
  std::uint32_t offset;  ///< in kSpaceReg
  unsigned entries = 0;  ///< 0: the card has no such table
  std::vector<Object> objects = {};
  std::vector<std::uint32_t> placed = {};  ///< first slot of each range as written; ~0 before
  std::vector<bool> posed = {};            ///< whether each transform has been written

  /// Takes these objects. Nothing of them is written yet.
  void assign(std::vector<Object> all) {
    objects = std::move(all);
    placed.assign(objects.size(), ~0u);
    posed.assign(objects.size(), false);
  }
};

/// The BVH in a card's memory.
struct LoadedBvh {
  std::uint32_t nodes = 0, slots = 0;            ///< 0: no BVH
  std::uint32_t node_base = 0;                   ///< words in DDR, with a node cache: of node 0,
  std::uint32_t slot_base = 0, object_base = 0;  ///< of slot 0, of its object
  std::array<std::uint32_t, 8> root{};           ///< as in kRegRoot
  std::vector<Bvh::Part> parts;                  ///< one per object
  std::vector<std::uint32_t> firsts;             ///< first secondary of each object
  std::vector<std::uint32_t> counts;
  bool stale = false;       ///< secondaries have changed since the upload
  std::vector<bool> moved;  ///< by object; valid only while stale
};

/// State of a Board, and single accesses to its card. Private to the driver.
class Board::Impl {
 public:
  Impl(std::unique_ptr<CardLink> connection, std::filesystem::path file, FpFormat numbers,
       const OpenOptions& options)
      : format(numbers),
        coding(numbers),
        link(std::move(connection)),
        model_path(std::move(file)),
        bus(options),
        period_ps(options.clock_period_ps),
        ddr_latency(options.ddr_latency),
        pass_retry_limit(options.bus_retries) {}

  /// Writes over the link, and counts words of shapes and objects.
  void write(card::Space space, std::uint32_t offset, const void* data, std::uint64_t beats);
  [[nodiscard]] std::uint64_t read_register(std::uint32_t offset);
  void write_register(std::uint32_t offset, std::uint64_t value);
  [[nodiscard]] std::uint64_t cycles() const { return link->cycles(); }

  /// Hardware reset: keeps only DDR.
  void reset();
  /// Also makes the next pass write primaries and objects again.
  void recover();

  /// Throws kDevice with the fault address if the card refused an access, and clears the fault.
  void check_bus(const char* during);

  /// Loads primaries into the register file from slot `first` on. Error kUsage if they do not fit.
  void load(std::uint32_t first, Shape shape, std::size_t count,
            const std::function<void(std::size_t, float*)>& words);
  /// Slot of the second pair's first primary. The two pairs share no row.
  [[nodiscard]] std::uint32_t split() const { return (loaded + lanes - 1) / lanes * lanes; }

  /// Writes shapes into DDR from slot `first` on, through a small buffer.
  void write_slots(Shape shape, std::size_t first, std::size_t count,
                   const std::function<void(std::size_t, float*)>& words);
  void set_objects(ObjectTable& table, std::span<const Object> all);
  void move_object(ObjectTable& table, std::size_t number, const Transform& transform);
  /// Prepares a pass. Writes primaries and objects again if a fault kept them from the card. Checks
  /// that objects fit, and writes the ranges of primaries.
  void prepare();
  void prepare_objects();  ///< the objects' part of prepare()
  /// The DDR byte where a secondary with an uncorrectable word begins. Halves the range with a pass
  /// each time. `command` is the command of the failed pass. Nothing if no pass finds the error
  /// again.
  [[nodiscard]] std::optional<std::uint64_t> find_uncorrectable(std::uint64_t command);
  /// Writes nodes and slots into their memories.
  void write_bvh(const Bvh& source);
  /// With a node cache: places nodes and slots at the end of DDR, nodes on multiples of their size.
  void place_in_ddr(std::uint64_t node_count, std::uint64_t slot_count);
  void write_chip_nodes(std::span<const bvh::Node> nodes);
  void write_ddr_nodes(std::span<const bvh::Node> nodes);
  /// Writes one word per slot: the word of the secondary at that place of the order.
  void write_slots_of(std::span<const std::uint32_t> order, card::Space space, std::uint64_t byte,
                      const std::function<std::uint32_t(std::uint32_t)>& word);
  /// Writes the registers that traversal and refit share, for the nodes [first, end).
  void configure_bvh(std::uint32_t first, std::uint32_t end);
  /// Marks the BVH as stale: secondaries have changed, or an object has moved.
  void outdate_bvh(std::uint64_t first, std::uint64_t count);
  void outdate_bvh(std::size_t object);
  [[nodiscard]] std::optional<std::string> why_objects_not_traversable() const;
  /// Why the pass cannot traverse a BVH; nothing if it can.
  [[nodiscard]] std::optional<std::string> why_not_traversable(const Query& query) const;
  /// The words of a loaded primary.
  [[nodiscard]] const std::uint32_t* loaded_words(std::uint32_t primary) const {
    return &packets_[0].words[primary * ((slot_words + 1) / 2 * 2)];
  }
  /// Number of secondaries that a brute-force pass tests.
  [[nodiscard]] std::uint64_t tested_secondaries(const Query& query) const;

  /// Encodes a slot's numbers as words of the card; other words of `slot` keep their value. Error
  /// kBadInput for a finite end of an interval beyond the format, which the card would not flag.
  /// The shape's number is for messages.
  void encode(Shape shape, std::size_t number, std::span<const float> numbers,
              std::uint32_t* slot) const;

  FpFormat format;
  FloatWords coding;  ///< of the card's format
  std::unique_ptr<CardLink> link;
  std::filesystem::path model_path;
  BusTime bus;              ///< timing of either link, for deadlines
  std::uint64_t period_ps;  ///< of the core clock
  unsigned ddr_latency;
  unsigned pass_retry_limit;
  unsigned lanes = 0, primaries = 0, pipe_latency = 0;
  std::uint64_t capacity = 0, sram_records = 0;  ///< capacity: bytes of DDR
  std::uint32_t secondaries = 0;                 ///< number of uploaded secondaries
  std::uint32_t loaded = 0;                      ///< number of primaries in the register file
  std::uint32_t second_loaded = 0;  ///< primaries of the second pair, on the next full row
  Shape secondary_shape = Shape::kTriangle, primary_shape = Shape::kRay, second_shape = Shape::kRay;
  std::vector<Pair> pairs;
  bool can_swap = false, has_normals = false, parallel = false;
  unsigned slot_words = 0;    ///< of a primary
  unsigned sat_interval = 1;  ///< cycles between rows for pairs with candidate axes
  unsigned row_cycles = 1;    ///< cycles between rows for other pairs
  bool filter = false;        ///< `BoardConfig::filter`
  bool box = false;           ///< BoardConfig::box
  bool passing = false;       ///< inside Board::run, whose sink and progress must not start a pass
  std::uint64_t pass_retries = 0;
  std::uint64_t register_ps = 0;  ///< spent in register accesses
  std::uint64_t load_ps = 0;      ///< spent in the last load of primaries
  std::uint64_t upload_cycles = 0, load_cycles = 0, words_uploaded = 0;
  unsigned traversal_units = 0, node_capacity = 0, ray_places = 0;
  std::uint32_t chip_nodes = 0;     ///< of node_capacity, those on chip
  bool node_cache = false;          ///< BoardConfig::node_cache: slots are in DDR
  std::uint64_t slot_capacity = 0;  ///< leaf slots that the card can hold
  LoadedBvh bvh;
  ObjectTable objects{"secondaries", card::kObjectTable};
  ObjectTable primary_objects{"primaries", card::kPrimObjectTable};

 private:
  /// Primaries as they are, or should be, in the card.
  struct Packet {
    std::uint32_t offset = 0;  ///< in kSpacePrim
    std::vector<std::uint32_t> words = {};
    bool written = false;
  };
  void write_packet(Packet& packet);
  [[nodiscard]] bool uncorrectable(std::uint32_t first, std::uint32_t count);
  std::array<Packet, 2> packets_;  ///< of the first and the second pair
  /// Error kUsage if the object does not fit the shapes in the card.
  void check_object(const ObjectTable& table, std::size_t number, const Object& object) const;
  void write_object(ObjectTable& table, std::size_t number);  ///< writes a changed range
  void write_transform(ObjectTable& table, std::size_t number);
  /// Last and first word of each two neighbouring slots. Shapes with an odd number of words share
  /// DDR beats, and DDR is written in whole beats.
  std::vector<std::array<std::uint32_t, 2>> seams_;
};

/// Error kUsage unless the watchdog is a time; infinity is valid. A NaN would never expire, since
/// all comparisons with it are false.
inline void check_watchdog(std::chrono::duration<double> watchdog) {
  if (!(watchdog.count() >= 0))
    throw Error(ErrorCode::kUsage,
                fmt::format("watchdog is {} s; it must be at least 0", watchdog.count()));
}

}  // namespace cde
