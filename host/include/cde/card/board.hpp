// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/bitstream/bitstream.hpp"
#include "cde/card/host_profile.hpp"
#include "cde/card/memory.hpp"
#include "cde/card/trace.hpp"
#include "cde/contract/registers.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/hierarchy/hierarchy.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/query/counters.hpp"
#include "cde/query/query.hpp"
#include "cde/query/record.hpp"

namespace cde {

/// Core clocks that can be assumed; a period is whole picoseconds.
inline constexpr double kLeastClockMhz = 1, kMostClockMhz = 10'000;

struct OpenOptions {
  std::optional<std::filesystem::path> file = {};  ///< this bitstream instead of a search
  std::optional<std::uint64_t> config_hash =
      {};  ///< that its card must show; with `file` by default what the search would ask for
  Memory memory = Memory::kIdeal;
  std::uint32_t ddr_latency = 20;          ///< Memory::kIdeal: clocks from request to data, 1 to
                                           ///< 10000
  std::uint32_t clock_period_ps = 10'000;  ///< of the core clock, 1 to 10,000 MHz
  HostProfile host = kHostProfiles[0];     ///< "ideal"; the host's part of modelled times
  std::uint32_t bus_burst = 4096;          ///< bytes of a DMA burst, 64 to 4096, a multiple of 8
  unsigned bus_retries = 4;                ///< of a failed transfer, access or pass, in a row
  bool narrow_bus = false;                 ///< the host has a 32-bit bus
  std::chrono::duration<double> watchdog =
      std::chrono::minutes(10);  ///< Bus::kCycle: wall clock, for one access or transfer
};

/// Driver of one simulated card: the paper's Algorithm 1. Independent boards may live in different
/// threads; one board must not be used by two threads at once.
///
/// Numbers are floats, whatever the card's format (BoardConfig::format): they are rounded to it, to
/// nearest even, where they are written to the card, and records have floats of the same value as
/// the card's. `validate` looks at the rounded numbers, and a finite one beyond the format's
/// largest is bad input. As an end of a ray's interval, which the card would take for an infinite
/// one and not flag, it is kBadInput even where nothing else is checked.
///
/// After an exception from run() or cast() the pass has been aborted and the card is ready for
/// another; triangles, rays and objects stay (a card that cannot be aborted is reset, and gets rays
/// and objects again from the driver). kDevice and kTimeout say what the card was doing. After an
/// error of an upload, what it replaced is gone: secondaries or primaries are loaded again before
/// the next pass; objects the driver writes again by itself.
///
/// A card that does not answer, or whose bus or DMA engine hangs, is lost: that call and every
/// later one that needs the card throws the same Error, kDevice or kTimeout with fault(), until
/// reset().
///
/// Every call of a board that was moved from is an Error kUsage. So is whatever gives a board work
/// (uploads, loads, objects, run, cast, reset) from the sink or progress of a pass of its own; that
/// error goes through the sink and ends the pass. A sink that destroys or replaces its own board
/// ends the pass, too: run() and cast() keep the card until they are left, and throw kUsage as soon
/// as the sink returns. The sink itself, what it refers to, and the query must outlive the call. A
/// sink that moves its board elsewhere does no harm to run(); cast() ends as with a board that was
/// moved from, if rays are left.
class Board {
 public:
  class Impl;  ///< the driver's own
  /// initializeDevice: finds or builds the bitstream, loads it, resets the card, and refuses it
  /// (kConfiguration) unless interface version, configuration hash, lanes, format and algorithm are
  /// those asked for. Also kBuild (bitstream.hpp) and kDevice (no memory for the card).
  /// With $CDE_WAVES, a folder that is there, cards of no given file or hash are ones with waves
  /// and write them from the start to board-N.fst, N counting from 0 in the process; kFile if that
  /// cannot be written.
  [[nodiscard]] static Board open(const BoardConfig& config, const OpenOptions& options = {});

  Board(Board&&) noexcept;
  Board& operator=(Board&&) noexcept;
  ~Board();

  /// secondaryUpload: these triangles replace those in DDR. Through a small fixed buffer, whatever
  /// their number. Errors: kUsage if there are none; kCapacity if DDR is smaller; kBadInput naming
  /// the first triangle that is not finite, before anything is uploaded, unless `validate` is off
  /// (the card then flags its records).
  void upload(const TriangleView& triangles, bool validate = true);
  /// The same, and a hierarchy over them, which must be of these triangles: rays then go through it
  /// where a query allows (Query::through), with the same records. It stays over passes and
  /// reset(), until other secondaries are uploaded. Errors beside those above, before anything is
  /// uploaded: kUsage if the card has no node units, or the hierarchy is of another number of
  /// triangles; kCapacity, with the sizes, if its memory of nodes or slots is smaller.
  void upload(const TriangleView& triangles, const Hierarchy& hierarchy, bool validate = true);
  /// The same of spheres, AABBs or OBBs: way_through() says what meets them. Whether the hierarchy
  /// is of these secondaries is not looked at but for their number, nor is a bad one flagged that
  /// is in it: `validate` off is for what is known to be good.
  void upload(std::span<const Sphere> spheres, const Hierarchy& hierarchy, bool validate = true);
  void upload(std::span<const Aabb> boxes, const Hierarchy& hierarchy, bool validate = true);
  void upload(std::span<const Obb> boxes, const Hierarchy& hierarchy, bool validate = true);
  /// A hierarchy over what is uploaded, as it is now: after update_shapes(), which leaves the one
  /// before unused, with its refit(). With objects, those of set_objects(), one of these as they
  /// have been moved (hierarchy_of()); they must lie one behind the other in DDR for
  /// rays to go through it. Errors as above.
  void upload(const Hierarchy& hierarchy);
  /// Boxes of the card's hierarchy anew, by the card, for secondaries as update_shapes() and
  /// move_object() left them; the tree stays as it is. Of a hierarchy of objects only what is below
  /// those that have changed, and what is above all of them, their roots included. Returns what the
  /// card counted. Errors: kUsage if there is no hierarchy, or it is of other objects, or not
  /// of triangles (Hierarchy::refit() is the way for others); kBadInput naming a slot of the tree
  /// whose triangle is not finite or beyond 2^40, as it was moved, and kDevice, as run(): the
  /// hierarchy is then unused.
  Counters refit();
  /// The same for other shapes (Sphere, Aabb, Obb, Plane, Cylinder, Ray; Triangle too).
  template <class P>
  void upload_shapes(std::span<const P> shapes, bool validate = true) {
    upload_words(
        kShapeOf<P>, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); },
        [&](std::size_t i) { return validate ? defect(shapes[i], format()) : std::nullopt; });
  }

  /// Uploads shapes again from slot `first` on, for meshes that deform; the others stay. Error
  /// kUsage if they are not what was uploaded, or reach beyond it; kBadInput as upload().
  template <class P>
  void update_shapes(std::size_t first, std::span<const P> shapes, bool validate = true) {
    update_words(
        kShapeOf<P>, first, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); },
        [&](std::size_t i) { return validate ? defect(shapes[i], format()) : std::nullopt; });
  }

  /// Objects: from now on a pass sweeps these ranges of the uploaded secondaries, in this order,
  /// each moved by its transform, and nothing else; none (the default) is all secondaries as they
  /// are. Records have the number of the secondary in upload order as their index. They stay over
  /// uploads and loads, and reset() drops them. What the transform makes of a secondary is held
  /// against the input contract, so one that overflows is flagged as bad. Errors, before the card
  /// is touched: kUsage without BoardConfig::transform, for more than BoardConfig::objects, for a
  /// range that is empty or reaches beyond the upload (run() looks again), or for a rotated object
  /// of AABBs; kBadInput naming an object whose transform has a defect.
  void set_objects(std::span<const Object> objects);
  /// Moves one of them: 12 words over the bus. A hierarchy over them is then unused until
  /// refit(), or where they are no triangles until another is uploaded.
  /// Errors as above.
  void move_object(std::size_t object, const Transform& transform);

  /// The same for primaries, by their number in the packet (with those of load_second_shapes()
  /// behind; no object has primaries of both). Primaries in no object stay as they were loaded; of
  /// several objects with the same primary the last one counts. They are posed by the card at the
  /// start of the next pass, which takes a clock a primary of the objects, and nothing while
  /// nothing moves. Needs Transformer::kBoth.
  void set_primary_objects(std::span<const Object> objects);
  void move_primary_object(std::size_t object, const Transform& transform);

  /// primaryRegFileUpload: one packet of rays, 1 to primaries() of them (else kUsage). Bad rays are
  /// legal: the card flags their records.
  void load(std::span<const Ray> rays);
  /// The same for other shapes. Errors: kUsage if a slot of the card is too small for them;
  /// kBadInput naming the first shape but rays that breaks its contract, before anything is loaded,
  /// unless `validate` is off (the card then flags its records).
  template <class P>
  void load_shapes(std::span<const P> shapes, bool validate = true) {
    if (validate) check_contract(shapes);
    load_words(kShapeOf<P>, shapes.size(),
               [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); });
  }

  /// Primaries of Query::second, behind those of load_shapes() and on rows of their own; the next
  /// load_shapes() drops them. In records their numbers follow those of the first. Errors: kUsage
  /// without BoardConfig::parallel, before load_shapes(), or if they do not fit; kBadInput as
  /// load_shapes().
  template <class P>
  void load_second_shapes(std::span<const P> shapes, bool validate = true) {
    if (validate) check_contract(shapes);
    load_second_words(kShapeOf<P>, shapes.size(),
                      [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); });
  }

  /// invokeCDE and downloadSRAM: one pass of the loaded rays over all triangles. In modes all and
  /// hits the records are drained while the pass runs, so their number is not limited by SRAM. The
  /// number of records is checked against what the mode promises. Errors: kUsage (nothing loaded or
  /// uploaded, an empty sink, a mode or pair that is none; nothing is sent to the card), kTimeout,
  /// kDevice, and whatever `sink` throws.
  Counters run(const Query& query, const RecordSink& sink);
  [[nodiscard]] std::vector<Record> run(const Query& query, Counters* counters = nullptr);

  /// Why run() or cast() would not take the hierarchy for a query; nothing if they would.
  [[nodiscard]] std::optional<std::string> no_way_through(const Query& query) const;

  /// load() and run() for any number of rays, in packets of primaries(), each made when its turn
  /// comes. The stencil, if any, masks
  /// places in every packet. `primary` of the records counts through all rays. Counters are sums.
  /// Through a hierarchy rays are streamed, and nothing is loaded; records come in the same order.
  Counters cast(const RayView& rays, const Query& query, const RecordSink& sink);
  [[nodiscard]] std::vector<Record> cast(const RayView& rays, const Query& query = {});
  /// The same of any number of shapes, as load_shapes() and run(). They go through a hierarchy
  /// where way_through() says so. Error kBadInput as load_shapes(), before anything is sent.
  template <class P>
  Counters cast_shapes(std::span<const P> shapes, const Query& query, const RecordSink& sink,
                       bool validate = true) {
    if (validate) check_contract(shapes);
    return cast_words(
        kShapeOf<P>, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); }, query, sink);
  }

  /// Hardware reset: registers, rays and objects are lost, triangles in DDR stay; faults that were
  /// ordered until reset end. The only way on when the device is lost; throws if it still does not
  /// answer.
  void reset();

  /// Modelled time in picoseconds: core clocks, and what PCI takes with OpenOptions::host,
  /// bus_burst and narrow_bus. Since power-on; with Bus::kFunctional since the host has set the
  /// card up.
  [[nodiscard]] std::uint64_t time_ps() const;
  [[nodiscard]] BusCounters bus_counters() const;
  [[nodiscard]] MemoryCounters memory_counters() const;
  /// Bus::kCycle: the first rule of PCI that host or card broke, with its clock; empty if none.
  [[nodiscard]] std::string bus_violation() const;
  /// From now on `count` transactions (or what BusFault names) get this fault, instead of what is
  /// left of an earlier one of its kind; `value` as BusFault says. Error kUsage if the board's bus
  /// has no such fault.
  void inject(BusFault fault, std::uint32_t count = 1, std::uint32_t value = 1);

  /// Waves from now on; BoardConfig::trace must be set. Error kUsage without it,
  /// kFile if the file cannot be written.
  void trace_open(const std::filesystem::path& file, const TraceOptions& which = {});
  /// Error kFile if not all of the waves could be written; the file is then of no use.
  void trace_close();

  [[nodiscard]] FpFormat format() const;
  [[nodiscard]] unsigned lanes() const;
  [[nodiscard]] unsigned primaries() const;  ///< rays in a packet at most
  [[nodiscard]] std::uint64_t capacity(Shape shape = Shape::kTriangle) const;  ///< that DDR holds
  [[nodiscard]] std::uint64_t sram_records() const;
  [[nodiscard]] unsigned pipe_latency() const;        ///< clocks
  [[nodiscard]] std::uint64_t upload_clocks() const;  ///< of the last upload()
  /// 32-bit words of shapes, ranges and transforms written to the card since it was opened.
  [[nodiscard]] std::uint64_t words_uploaded() const;
  [[nodiscard]] const std::filesystem::path& bitstream() const;
  [[nodiscard]] std::uint64_t config_hash() const;

  /// Below the driver, for tests and diagnosis: single accesses on the local bus. A refused access
  /// sets kStatusBusError and reads 0; kDevice if the bus hangs.
  [[nodiscard]] std::uint64_t read_register(std::uint32_t offset);
  void write_register(std::uint32_t offset, std::uint64_t value);
  void bus_write(card::Space space, std::uint32_t offset, std::span<const std::uint64_t> beats);
  void bus_read(card::Space space, std::uint32_t offset, std::span<std::uint64_t> beats);
  /// Until the interrupt; returns clocks spent. One that a write before this has cleared does not
  /// count.
  std::uint64_t wait(std::uint64_t max_clocks);
  [[nodiscard]] std::uint64_t clocks() const;  ///< core clocks of time_ps()
  /// Flips bits as a memory fault would: of a byte of DDR, or with BoardConfig::ecc of the check
  /// bits (bits 0 to 6) of a word of four bytes. Error kUsage where there are none.
  void flip_ddr(std::uint64_t byte, std::uint8_t mask);
  void flip_check(std::uint64_t word, std::uint8_t mask);

 private:
  explicit Board(std::shared_ptr<Impl> impl);
  [[nodiscard]] Impl& card() const;       ///< kUsage if it was moved from
  [[nodiscard]] Impl& idle_card() const;  ///< and in a pass
  template <class P>
  static std::span<float, P::kWords> slot(float* words) {
    return std::span<float, P::kWords>(words, P::kWords);
  }
  /// Rays that break theirs are legal: the card flags their records.
  template <class P>
  void check_contract(std::span<const P> shapes) const {
    (void)idle_card();
    if constexpr (kShapeOf<P> != Shape::kRay)
      for (std::size_t i = 0; i < shapes.size(); ++i)
        if (const auto why = defect(shapes[i], format())) throw_defect(kShapeOf<P>, i, *why);
  }
  [[noreturn]] static void throw_defect(Shape shape, std::size_t number, const std::string& why);
  using Words = std::function<void(std::size_t, float*)>;  ///< number of a shape, where to put it
  void upload_words(Shape shape, std::size_t count, const Words& words,
                    const std::function<std::optional<std::string>(std::size_t)>& defect);
  template <class P>
  void upload_with(std::span<const P> shapes, const Hierarchy& hierarchy, bool validate);
  void update_words(Shape shape, std::size_t first, std::size_t count, const Words& words,
                    const std::function<std::optional<std::string>(std::size_t)>& defect);
  void load_words(Shape shape, std::size_t count, const Words& words);
  void load_second_words(Shape shape, std::size_t count, const Words& words);
  Counters cast_words(Shape shape, std::size_t count, const Words& words, const Query& query,
                      const RecordSink& sink);
  Counters cast_through(Shape shape, std::size_t count, const Words& words, const Query& query,
                        const RecordSink& sink);
  std::shared_ptr<Impl> impl_;  ///< this board's; a pass keeps it over a sink that drops the board
};

/// A hierarchy over the triangles, spheres, AABBs or OBBs of objects, object after object, as a
/// card's transformer moves them; each object is a part of it. Errors: kUsage (no object, or one
/// that is empty or reaches beyond the triangles, or AABBs that are rotated), and as
/// Hierarchy::build.
[[nodiscard]] Hierarchy hierarchy_of(const TriangleView& triangles, std::span<const Object> objects,
                                     const HierarchyOptions& options = {});
[[nodiscard]] Hierarchy hierarchy_of(std::span<const Sphere> spheres,
                                     std::span<const Object> objects,
                                     const HierarchyOptions& options = {});
[[nodiscard]] Hierarchy hierarchy_of(std::span<const Aabb> boxes, std::span<const Object> objects,
                                     const HierarchyOptions& options = {});
[[nodiscard]] Hierarchy hierarchy_of(std::span<const Obb> boxes, std::span<const Object> objects,
                                     const HierarchyOptions& options = {});

/// Where a record of a packet's primary comes from, for messages: the clock as it is now, when the
/// record has been read, and the lane and the row of the register file that hold the primary.
[[nodiscard]] std::string place_on_card(const Board& board, std::uint32_t primary);

}  // namespace cde
