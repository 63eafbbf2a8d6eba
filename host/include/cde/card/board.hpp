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

#include "cde/bvh/bvh.hpp"
#include "cde/card/host_profile.hpp"
#include "cde/card/memory.hpp"
#include "cde/card/trace.hpp"
#include "cde/contract/registers.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/geometry/primitives.hpp"
#include "cde/geometry/transform.hpp"
#include "cde/image/ray_view.hpp"
#include "cde/mesh/triangle_view.hpp"
#include "cde/model/device.hpp"
#include "cde/model/model.hpp"
#include "cde/query/counters.hpp"
#include "cde/query/query.hpp"
#include "cde/query/record.hpp"

namespace cde {

/// Range of assumed core clocks. A period is a whole number of picoseconds.
inline constexpr double kLeastClockMhz = 1, kMostClockMhz = 10'000;

struct OpenOptions {
  std::optional<std::filesystem::path> file = {};  ///< this simulation model instead of a search
  std::optional<std::uint64_t> config_hash =
      {};  ///< hash that its card must show; with `file` the default is the configuration's
  Memory memory = Memory::kIdeal;
  std::uint32_t ddr_latency =
      20;  ///< cycles from request to data, 1 to 10000; not of Memory::kCycle
  std::uint32_t clock_period_ps = 10'000;  ///< of the core clock: 1 to 10,000 MHz
  HostProfile host = kHostProfiles[0];     ///< "ideal"; the host's share of modelled times
  std::uint32_t bus_burst = 4096;          ///< bytes per DMA burst, 64 to 4096, a multiple of 8
  unsigned bus_retries = 4;  ///< consecutive retries of a failed transfer, access or pass
  bool narrow_bus = false;   ///< the host has a 32-bit bus
  std::chrono::duration<double> watchdog =
      std::chrono::minutes(10);  ///< Bus::kCycle: wall-clock limit per access or transfer
};

/// Clock and memory of a device. `timed`: with the timing of its memory, if that is DDR; otherwise
/// it is ideal.
[[nodiscard]] OpenOptions options_on(const Device& device, bool timed = false);

/// Driver of one simulated card: the paper's Algorithm 1. Independent boards may live in different
/// threads. Two threads must not use one board at once.
///
/// Numbers are floats, whatever the card's format (BoardConfig::format). They are rounded to it, to
/// nearest even, when they are written to the card. Records hold floats equal to the card's values.
/// `validate` checks the rounded numbers, and a finite number beyond the format's largest is bad
/// input. For an end of a ray's interval it is kBadInput even without validation, because the card
/// would take it for infinity.
///
/// After an exception from run() or cast() the pass has been aborted and the card is ready.
/// Triangles, rays and objects stay. A card that cannot be aborted is reset, and the driver writes
/// rays and objects again. kDevice and kTimeout say what the card was doing. After an error of an
/// upload, the replaced data are lost. Secondaries or primaries must then be loaded again before
/// the next pass; the driver rewrites objects by itself.
///
/// A card is lost if it does not answer, or if its bus or DMA engine hangs. That call and every
/// later one that needs the card throws the same Error, until reset(). It is kDevice or kTimeout
/// with fault().
///
/// Every call of a moved-from board is an Error kUsage. The sink or progress of a pass must not
/// give its own board work (uploads, loads, objects, run, cast, reset). That is also kUsage; the
/// error goes through the sink and ends the pass. A sink that destroys or replaces its own board
/// also ends the pass. Both run() and cast() keep the card until they return, and throw kUsage as
/// soon as the sink returns. The sink, what it refers to, and the query must outlive the call. A
/// sink may move its board elsewhere during run(). During cast() this is an error if rays remain.
class Board {
 public:
  class Impl;  ///< the driver's implementation
  /// The paper's initializeDevice: finds or builds the simulation model, loads it and resets the
  /// card. Error kConfiguration unless interface version, configuration hash, lanes, format and
  /// algorithm are as requested. Other errors: kBuild (model.hpp), kDevice (no memory for the
  /// card).
  /// If $CDE_WAVES is an existing folder, cards without a given file or hash have waves. They write
  /// them from the start to board-N.fst in it, where N counts boards of the process from 0. Error
  /// kFile if they cannot be written.
  [[nodiscard]] static Board open(const BoardConfig& config, const OpenOptions& options = {});

  Board(Board&&) noexcept;
  Board& operator=(Board&&) noexcept;
  ~Board();

  /// The paper's secondaryUpload: these triangles replace those in DDR, through a small fixed
  /// buffer. Errors: kUsage for no triangles; kCapacity if DDR is too small. Error kBadInput names
  /// the first triangle that is not finite, before anything is uploaded. Without `validate` the
  /// card flags its records instead.
  void upload(const TriangleView& triangles, bool validate = true);
  /// The same, with a BVH of these triangles. Rays then traverse it if the query permits
  /// (Query::through), with the same records. It stays over passes and reset() until other
  /// secondaries are uploaded. Further errors come before anything is uploaded. Error kUsage: the
  /// card has no traversal units, or the BVH has another number of triangles. Error kCapacity, with
  /// the sizes: its node or slot memory is too small.
  void upload(const TriangleView& triangles, const Bvh& bvh, bool validate = true);
  /// The same for spheres, AABBs or OBBs; traversal_shapes() lists their pairs. Only the number of
  /// the BVH's secondaries is checked. A bad secondary in the BVH is not flagged, so `validate` may
  /// be off only for valid data.
  void upload(std::span<const Sphere> spheres, const Bvh& bvh, bool validate = true);
  void upload(std::span<const Aabb> boxes, const Bvh& bvh, bool validate = true);
  void upload(std::span<const Obb> boxes, const Bvh& bvh, bool validate = true);
  /// Replaces the BVH over the uploaded secondaries as they are now. update_shapes() makes the old
  /// BVH unused; upload its refit() again. With objects (set_objects()) it must be a BVH of the
  /// moved objects (bvh_of()). Their ranges must be consecutive in DDR to be traversed. Errors as
  /// above.
  void upload(const Bvh& bvh);
  /// Refits the boxes of the card's BVH on the card after update_shapes() and move_object(); the
  /// topology stays. In a BVH of objects it refits only changed objects, and the top BVH with the
  /// roots of all objects. Returns the card's counters.
  /// Error kUsage: there is no BVH, it has other objects, the card has a node cache, or its
  /// secondaries are not triangles (use Bvh::refit()). Error kBadInput, naming a slot: its moved
  /// triangle is not finite or beyond 2^40. Error kDevice as for run(). After kBadInput or kDevice
  /// the BVH is unused.
  Counters refit();
  /// Whether the card can refit a BVH: it has no BoardConfig::node_cache.
  [[nodiscard]] bool refits() const;
  /// upload() for other shapes (Sphere, Aabb, Obb, Plane, Cylinder, Ray) and for Triangle.
  template <class P>
  void upload_shapes(std::span<const P> shapes, bool validate = true) {
    upload_words(
        kShapeOf<P>, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); },
        [&](std::size_t i) { return validate ? defect(shapes[i], format()) : std::nullopt; });
  }

  /// Uploads shapes again from slot `first` on, for deforming meshes; the others stay. Error kUsage
  /// if their shape differs from the uploaded one, or they exceed the upload. Error kBadInput as
  /// for upload().
  template <class P>
  void update_shapes(std::size_t first, std::span<const P> shapes, bool validate = true) {
    update_words(
        kShapeOf<P>, first, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); },
        [&](std::size_t i) { return validate ? defect(shapes[i], format()) : std::nullopt; });
  }

  /// Sets the objects. From now on a pass takes only these ranges of the uploaded secondaries, in
  /// this order, each moved by its transform. Without objects (the default) it takes all
  /// secondaries unmoved. The index of a record is the secondary's number in upload order. Objects
  /// stay over uploads and loads; reset() drops them. Moved secondaries are checked against the
  /// input contract, so one that overflows is flagged as bad.
  /// Errors come before the card is touched. Error kUsage: no BoardConfig::transform, more than
  /// BoardConfig::objects, a rotated object of AABBs, or a range that is empty or exceeds the
  /// upload (run() checks again). Error kBadInput names an object whose transform has a defect.
  void set_objects(std::span<const Object> objects);
  /// Moves one object: 12 words over the bus. A BVH over the objects is then unused until refit();
  /// if they are not triangles, until another is uploaded. Errors as above.
  void move_object(std::size_t object, const Transform& transform);

  /// The same for primaries, by their number in the packet. Primaries of load_second_shapes()
  /// follow the first ones; no object has primaries of both. Primaries in no object stay as loaded.
  /// If several objects have the same primary, the last one counts. The card poses them at the
  /// start of the next pass, in one cycle per primary of the objects. It does so only if something
  /// has moved. Needs Transformer::kBoth.
  void set_primary_objects(std::span<const Object> objects);
  void move_primary_object(std::size_t object, const Transform& transform);

  /// The paper's primaryRegFileUpload: one packet of 1 to primaries() rays (else kUsage). Bad rays
  /// are legal: the card flags their records.
  void load(std::span<const Ray> rays);
  /// The same for other shapes. Error kUsage if they do not fit a primary slot of the card. Error
  /// kBadInput names the first shape that breaks its contract, before anything is loaded; rays are
  /// exempt. Without `validate` the card flags its records instead.
  template <class P>
  void load_shapes(std::span<const P> shapes, bool validate = true) {
    if (validate) check_contract(shapes);
    load_words(kShapeOf<P>, shapes.size(),
               [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); });
  }

  /// Primaries of Query::second. They follow the primaries of load_shapes(), start on a row of
  /// their own, and are dropped by the next load_shapes(). In records their numbers follow the
  /// numbers of the first. Errors: kUsage without BoardConfig::parallel, before load_shapes(), or
  /// if they do not fit; kBadInput as for load_shapes().
  template <class P>
  void load_second_shapes(std::span<const P> shapes, bool validate = true) {
    if (validate) check_contract(shapes);
    load_second_words(kShapeOf<P>, shapes.size(),
                      [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); });
  }

  /// The paper's invokeCDE and downloadSRAM: one pass of the loaded rays over all triangles. In
  /// modes all and hits records are drained during the pass, so SRAM does not limit their number.
  /// The number of records is checked against the mode. Error kUsage, before anything is sent:
  /// nothing is loaded or uploaded, the sink is empty, or the mode or pair is invalid. Other
  /// errors: kTimeout, kDevice, and whatever `sink` throws.
  Counters run(const Query& query, const RecordSink& sink);
  [[nodiscard]] std::vector<Record> run(const Query& query, Counters* counters = nullptr);

  /// Why run() or cast() would not traverse the BVH for a query; nothing if they would.
  [[nodiscard]] std::optional<std::string> why_not_traversable(const Query& query) const;

  /// load() and run() for any number of rays, in packets of primaries(). Each packet is made when
  /// its turn comes. A stencil masks the same slots in every packet. `primary` of the records
  /// counts through all rays. Counters are sums. For a BVH, rays are streamed instead of loaded,
  /// and records come in the same order.
  Counters cast(const RayView& rays, const Query& query, const RecordSink& sink);
  [[nodiscard]] std::vector<Record> cast(const RayView& rays, const Query& query = {});
  /// The same for any number of shapes, as load_shapes() and run(). Pairs of traversal_shapes()
  /// traverse a BVH. Error kBadInput as for load_shapes(), before anything is sent.
  template <class P>
  Counters cast_shapes(std::span<const P> shapes, const Query& query, const RecordSink& sink,
                       bool validate = true) {
    if (validate) check_contract(shapes);
    return cast_words(
        kShapeOf<P>, shapes.size(),
        [&](std::size_t i, float* words) { to_words(shapes[i], slot<P>(words)); }, query, sink);
  }

  /// Hardware reset. Registers, rays and objects are lost; triangles in DDR stay. Injected faults
  /// that last until reset end. It is the only way to recover a lost device, and throws if the
  /// device still does not answer.
  void reset();

  /// Modelled time in picoseconds: core cycles, and PCI time for OpenOptions::host, bus_burst and
  /// narrow_bus. It counts from power-on; with Bus::kFunctional from the end of the host's set-up.
  [[nodiscard]] std::uint64_t time_ps() const;
  [[nodiscard]] BusCounters bus_counters() const;
  [[nodiscard]] MemoryCounters memory_counters() const;
  /// Bus::kCycle: the first PCI rule that host or card broke, with its cycle; empty if none.
  [[nodiscard]] std::string bus_violation() const;
  /// Injects this fault into the next `count` transactions (or the unit that BusFault names). It
  /// replaces the rest of an earlier fault of its kind. BusFault defines `value`. Error kUsage if
  /// the board's bus does not support the fault.
  void inject(BusFault fault, std::uint32_t count = 1, std::uint32_t value = 1);

  /// Starts waves. Error kUsage without BoardConfig::trace; kFile if the file cannot be written.
  void trace_open(const std::filesystem::path& file, const TraceOptions& which = {});
  /// Ends waves. Error kFile if they could not be written completely; the file is then unusable.
  void trace_close();

  [[nodiscard]] FpFormat format() const;
  [[nodiscard]] unsigned lanes() const;
  [[nodiscard]] unsigned primaries() const;  ///< most rays in a packet
  /// Shapes that DDR holds.
  [[nodiscard]] std::uint64_t capacity(Shape shape = Shape::kTriangle) const;
  [[nodiscard]] std::uint64_t sram_records() const;
  [[nodiscard]] unsigned pipe_latency() const;        ///< cycles
  [[nodiscard]] std::uint64_t upload_cycles() const;  ///< cycles of the last upload()
  /// 32-bit words of shapes, ranges and transforms written to the card since it was opened.
  [[nodiscard]] std::uint64_t words_uploaded() const;
  [[nodiscard]] const std::filesystem::path& model_path() const;
  [[nodiscard]] std::uint64_t config_hash() const;

  /// Single accesses on the local bus, below the driver, for tests and diagnosis. A refused access
  /// sets kStatusBusError and reads 0. Error kDevice if the bus hangs.
  [[nodiscard]] std::uint64_t read_register(std::uint32_t offset);
  void write_register(std::uint32_t offset, std::uint64_t value);
  void bus_write(card::Space space, std::uint32_t offset, std::span<const std::uint64_t> beats);
  void bus_read(card::Space space, std::uint32_t offset, std::span<std::uint64_t> beats);
  /// Waits for the interrupt and returns the cycles spent. An interrupt that an earlier write has
  /// cleared does not count.
  std::uint64_t wait(std::uint64_t max_cycles);
  [[nodiscard]] std::uint64_t cycles() const;  ///< core cycles of time_ps().
  /// Flips bits as a memory fault would: of a DDR byte, or with BoardConfig::ecc of the check bits
  /// (bits 0 to 6) of a four-byte word. Error kUsage if there are none.
  void flip_ddr(std::uint64_t byte, std::uint8_t mask);
  void flip_check(std::uint64_t word, std::uint8_t mask);

 private:
  explicit Board(std::shared_ptr<Impl> impl);
  [[nodiscard]] Impl& card() const;       ///< kUsage if moved from
  [[nodiscard]] Impl& idle_card() const;  ///< kUsage also during a pass
  template <class P>
  static std::span<float, P::kWords> slot(float* words) {
    return std::span<float, P::kWords>(words, P::kWords);
  }
  /// Rays that break their contract are legal: the card flags their records.
  template <class P>
  void check_contract(std::span<const P> shapes) const {
    (void)idle_card();
    if constexpr (kShapeOf<P> != Shape::kRay)
      for (std::size_t i = 0; i < shapes.size(); ++i)
        if (const auto why = defect(shapes[i], format())) throw_defect(kShapeOf<P>, i, *why);
  }
  [[noreturn]] static void throw_defect(Shape shape, std::size_t number, const std::string& why);
  /// Number of a shape, destination of its words.
  using Words = std::function<void(std::size_t, float*)>;
  void upload_words(Shape shape, std::size_t count, const Words& words,
                    const std::function<std::optional<std::string>(std::size_t)>& defect);
  template <class P>
  void upload_with(std::span<const P> shapes, const Bvh& bvh, bool validate);
  void update_words(Shape shape, std::size_t first, std::size_t count, const Words& words,
                    const std::function<std::optional<std::string>(std::size_t)>& defect);
  void load_words(Shape shape, std::size_t count, const Words& words);
  void load_second_words(Shape shape, std::size_t count, const Words& words);
  Counters cast_words(Shape shape, std::size_t count, const Words& words, const Query& query,
                      const RecordSink& sink);
  Counters cast_through(Shape shape, std::size_t count, const Words& words, const Query& query,
                        const RecordSink& sink);
  std::shared_ptr<Impl> impl_;  ///< a pass keeps it alive if its sink drops the board
};

/// A BVH over the triangles, spheres, AABBs or OBBs of objects, object after object, as a card's
/// transformer moves them. Each object is a part of it. Error kUsage: no object, a range that is
/// empty or exceeds the list, or rotated AABBs. Other errors as for Bvh::build.
[[nodiscard]] Bvh bvh_of(const TriangleView& triangles, std::span<const Object> objects,
                         const BvhOptions& options = {});
[[nodiscard]] Bvh bvh_of(std::span<const Sphere> spheres, std::span<const Object> objects,
                         const BvhOptions& options = {});
[[nodiscard]] Bvh bvh_of(std::span<const Aabb> boxes, std::span<const Object> objects,
                         const BvhOptions& options = {});
[[nodiscard]] Bvh bvh_of(std::span<const Obb> boxes, std::span<const Object> objects,
                         const BvhOptions& options = {});

/// Where a record of a packet's primary comes from, for messages. It names the current cycle, at
/// which the record has been read, and the lane and register-file row of the primary.
[[nodiscard]] std::string place_on_card(const Board& board, std::uint32_t primary);

}  // namespace cde
