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
  const char* slots;     ///< what the ranges are of, for messages
  std::uint32_t offset;  ///< in kSpaceReg
  unsigned entries = 0;  ///< 0: the card has none
  std::vector<Object> objects = {};
  std::vector<std::uint32_t> placed = {};  ///< first slot of each range, as written; ~0: not yet
  std::vector<bool> posed = {};            ///< whose transform has been written

  /// These, of which nothing has been written.
  void assign(std::vector<Object> all) {
    objects = std::move(all);
    placed.assign(objects.size(), ~0u);
    posed.assign(objects.size(), false);
  }
};

/// The hierarchy in a card's memory.
struct LoadedHierarchy {
  std::uint32_t nodes = 0, slots = 0;   ///< 0: none
  std::array<std::uint32_t, 8> root{};  ///< as kRegRoot has it
  std::vector<Hierarchy::Part> parts;   ///< of objects
  std::vector<std::uint32_t> firsts;    ///< secondaries that the objects begin with
  std::vector<std::uint32_t> counts;
  bool stale = false;       ///< secondaries have changed since
  std::vector<bool> moved;  ///< of which objects; meant only while it is stale
};

/// State of a Board, and single accesses to its card. Private to the driver.
class Board::Impl {
 public:
  Impl(std::unique_ptr<CardLink> way, std::filesystem::path file, FpFormat numbers,
       const OpenOptions& options)
      : format(numbers),
        coding(numbers),
        link(std::move(way)),
        bitstream(std::move(file)),
        bus(options),
        period_ps(options.clock_period_ps),
        ddr_latency(options.ddr_latency),
        pass_retry_limit(options.bus_retries) {}

  /// Over the link, and counted if it is shapes or objects.
  void write(card::Space space, std::uint32_t offset, const void* data, std::uint64_t beats);
  [[nodiscard]] std::uint64_t read_register(std::uint32_t offset);
  void write_register(std::uint32_t offset, std::uint64_t value);
  [[nodiscard]] std::uint64_t clocks() const { return link->clocks(); }

  /// Hardware reset: what is not in DDR is gone.
  void reset();
  /// The same, but the next pass writes primaries and objects again.
  void recover();

  /// Throws kDevice with the fault address if an access was refused, after clearing it.
  void check_bus(const char* during);

  /// Primaries into the register file from slot `first` on. Error kUsage if they do not fit.
  void load(std::uint32_t first, Shape shape, std::size_t count,
            const std::function<void(std::size_t, float*)>& words);
  /// Slot of the second pair's first primary: rows are not shared.
  [[nodiscard]] std::uint32_t split() const { return (loaded + lanes - 1) / lanes * lanes; }

  /// Shapes into DDR from slot `first` on, through a small buffer.
  void write_slots(Shape shape, std::size_t first, std::size_t count,
                   const std::function<void(std::size_t, float*)>& words);
  void set_objects(ObjectTable& table, std::span<const Object> all);
  void move_object(ObjectTable& table, std::size_t number, const Transform& transform);
  /// What a pass needs: primaries and objects as they were given, if a fault kept them from the
  /// card; objects that fit, ranges of primaries where these lie.
  void prepare();
  void prepare_objects();  ///< the part of it that is of objects
  /// Byte of DDR where a secondary begins that has a word with more wrong bits than check bits
  /// correct, found by passes over half of what is left at a time; `command` as the pass that met
  /// it had. Nothing if it is not met again.
  [[nodiscard]] std::optional<std::uint64_t> find_uncorrectable(std::uint64_t command);
  /// Nodes and slots into their memories.
  void write_hierarchy(const Hierarchy& hierarchy);
  /// A word of each slot, of what its place in the order is.
  void write_slots_of(std::span<const std::uint32_t> order, std::uint64_t byte,
                      const std::function<std::uint32_t(std::uint32_t)>& word);
  /// The registers that passes through it and refits share; of the nodes from the first one on up
  /// to the end.
  void configure_hierarchy(std::uint32_t first, std::uint32_t end);
  /// Secondaries have changed, or objects have moved: the hierarchy's boxes are not theirs.
  void outdate_hierarchy(std::uint64_t first, std::uint64_t count);
  void outdate_hierarchy(std::size_t object);
  [[nodiscard]] std::optional<std::string> no_way_through_objects() const;
  /// Why the pass cannot go through a hierarchy; nothing if it can.
  [[nodiscard]] std::optional<std::string> no_way_through(const Query& query) const;
  /// The words of a loaded primary.
  [[nodiscard]] const std::uint32_t* loaded_words(std::uint32_t primary) const {
    return &packets_[0].words[primary * ((slot_words + 1) / 2 * 2)];
  }
  /// Secondaries of a pass.
  [[nodiscard]] std::uint64_t swept(const Query& query) const;

  /// Numbers of a slot as words of the card; what is left of `slot` stays. A shape's number is for
  /// messages: error kBadInput for an end of an interval that is finite and beyond the format, as
  /// the card would not flag it.
  void encode(Shape shape, std::size_t number, std::span<const float> numbers,
              std::uint32_t* slot) const;

  FpFormat format;
  FloatWords coding;  ///< of the format
  std::unique_ptr<CardLink> link;
  std::filesystem::path bitstream;
  BusTime bus;              ///< of either kind of link, for deadlines
  std::uint64_t period_ps;  ///< of the core clock
  unsigned ddr_latency;
  unsigned pass_retry_limit;
  unsigned lanes = 0, primaries = 0, pipe_latency = 0;
  std::uint64_t capacity = 0, sram_records = 0;  ///< bytes of DDR
  std::uint32_t secondaries = 0;                 ///< uploaded
  std::uint32_t loaded = 0;                      ///< primaries in the register file
  std::uint32_t second_loaded = 0;  ///< those of the second pair, behind them on the next full row
  Shape secondary_shape = Shape::kTriangle, primary_shape = Shape::kRay, second_shape = Shape::kRay;
  std::vector<Pair> pairs;
  bool can_swap = false, has_normals = false, parallel = false;
  unsigned slot_words = 0;      ///< of a primary
  unsigned facet_interval = 1;  ///< clocks from row to row of pairs with facets
  bool verdicts = false;        ///< BoardConfig::verdicts
  bool box = false;             ///< BoardConfig::box
  bool passing = false;         ///< in Board::run, which its sink and progress may not ask for more
  std::uint64_t pass_retries = 0;
  std::uint64_t register_ps = 0;  ///< spent in read_register() and write_register()
  std::uint64_t load_ps = 0;      ///< spent in the last load of primaries
  std::uint64_t upload_clocks = 0, load_clocks = 0, words_uploaded = 0;
  unsigned node_units = 0, node_capacity = 0, ray_places = 0;
  std::uint64_t slot_capacity = 0;  ///< of leaves
  LoadedHierarchy hierarchy;
  ObjectTable objects{"secondaries", card::kObjectTable};
  ObjectTable primary_objects{"primaries", card::kPrimObjectTable};

 private:
  /// Primaries as the card has them, or is to have them.
  struct Packet {
    std::uint32_t offset = 0;  ///< in kSpacePrim
    std::vector<std::uint32_t> words = {};
    bool written = false;
  };
  void write_packet(Packet& packet);
  [[nodiscard]] bool uncorrectable(std::uint32_t first, std::uint32_t count);
  std::array<Packet, 2> packets_;  ///< of the first and of the second pair
  /// Error kUsage if the object does not fit what lies in the card, as far as something does.
  void check_object(const ObjectTable& table, std::size_t number, const Object& object) const;
  void write_object(ObjectTable& table, std::size_t number);  ///< its range, if it changed
  void write_transform(ObjectTable& table, std::size_t number);
  /// Shapes of an odd number of words share beats of DDR, which is written by whole beats: the last
  /// word of an even slot and the first one of the next, for every such two slots.
  std::vector<std::array<std::uint32_t, 2>> seams_;
};

/// Error kUsage unless it is a time; infinity is one. Comparisons with NaN are false, so a watchdog
/// of NaN would never bite.
inline void check_watchdog(std::chrono::duration<double> watchdog) {
  if (!(watchdog.count() >= 0))
    throw Error(ErrorCode::kUsage,
                fmt::format("watchdog is {} s; it must be at least 0", watchdog.count()));
}

}  // namespace cde
