// SPDX-License-Identifier: Apache-2.0
#include "cde/card/board.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "card/board_impl.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/contract/records.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/descriptor.hpp"
#include "support/output_target.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

/// The waves file for the next board of this process, if $CDE_WAVES asks for waves.
std::optional<std::filesystem::path> next_waves() {
  static std::atomic<unsigned> boards = 0;
  const char* folder = std::getenv("CDE_WAVES");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  const Descriptor opened(::open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (opened.get() >= 0) check_folder_link(folder, opened.get());
  return std::filesystem::path(folder) / fmt::format("board-{}.fst", boards++);
}

void check_identity(Board::Impl& card, const BoardConfig& config, std::uint64_t expected_hash,
                    const std::string& file) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::kConfiguration,
                fmt::format("simulation model {}: {}", printable_name(file), why));
  };
  const std::uint64_t id = card.read_register(card::kRegId);
  constexpr std::uint64_t kId = std::uint64_t{card::kIdMagic} << 32 | card::kInterfaceVersion;
  if (id != kId)
    refuse(fmt::format("the card's identification is {:#018x}; expected {:#018x}", id, kId));
  const std::uint64_t hash = card.read_register(card::kRegConfigHash);
  if (hash != expected_hash) {
    refuse(fmt::format("configuration hash is {:016x}; expected {:016x}", hash, expected_hash));
  }
  const std::uint64_t caps = card.read_register(card::kRegCaps);
  const std::uint64_t caps2 = card.read_register(card::kRegCaps2);
  card.lanes = card::kCapsLanes.of(caps);
  card.primaries = card::kCapsPrimaries.of(caps);
  card.pipe_latency = card::kCaps2Latency.of(caps2);
  card.sram_records = card::kCaps2SramRecords.of(caps2);
  card.capacity = card.read_register(card::kRegCapacity);
  card.traversal_units = card::kCaps2TraversalUnits.of(caps2);
  const auto field = [&](const char* what, std::uint64_t value, std::uint64_t wanted) {
    if (value != wanted) refuse(fmt::format("{} is {}; expected {}", what, value, wanted));
  };
  field("number of lanes", card.lanes, config.lanes);
  field("exponent width", card::kCapsExp.of(caps), static_cast<unsigned>(config.format.exp_bits));
  field("fraction width", card::kCapsMan.of(caps), static_cast<unsigned>(config.format.man_bits));
  field("ray-triangle algorithm", card::kCapsAlgorithm.of(caps),
        static_cast<unsigned>(config.algorithm));
  field("container width", card::kCaps2Container.of(caps2), kCardWord);
  field("DDR capacity", card.capacity, std::uint64_t{config.ddr_slots} * card::kDdrWords * 4);
  field("SRAM ring", card.sram_records, config.sram_records);
  const std::uint64_t caps3 = card.read_register(card::kRegCaps3);
  card.slot_words = card::kCaps3PrimWords.of(caps3);
  std::uint64_t pairs = 0;
  for (const Pair pair : config.pairs) pairs |= std::uint64_t{1} << static_cast<unsigned>(pair);
  field("set of pairs", card.read_register(card::kRegPairs), pairs);
  field("role swap", card::kCaps3Swap.of(caps3), config.swap);
  field("normals", card::kCaps3Normals.of(caps3), config.normals);
  field("two pairs at a time", card::kCaps3Parallel.of(caps3), config.parallel);
  field("box rule", card::kCaps3Box.of(caps3), config.box);
  field("filter", card::kCaps3Filter.of(caps3), config.filter.has_value());
  field("number of traversal units", card.traversal_units, config.traversal_units);
  if (card.traversal_units != 0) {
    const std::uint64_t node_caps = card.read_register(card::kRegNodeCaps);
    card.node_capacity = card::kNodeCapsNodes.of(node_caps);
    card.ray_places = card::kNodeCapsRays.of(node_caps);
    card.slot_capacity =
        std::uint64_t{card.node_capacity} * card::kNodeCapsSlotsPerNode.of(node_caps);
    field("memory of nodes", card.node_capacity, config.nodes);
    card.node_cache = config.node_cache != 0;
    card.chip_nodes = card.node_cache ? config.pinned_nodes : config.nodes;
    field("number of pinned nodes, as a power of two,", card::kNodeCapsPinnedBits.of(node_caps),
          card.node_cache ? static_cast<unsigned>(std::countr_zero(config.pinned_nodes))
                          : card::kNoNodeCache);
  }
  field("check bits in DDR", card::kCaps3Ecc.of(caps3), config.ecc);
  field("transformer", card::kCaps3Transform.of(caps3), static_cast<unsigned>(config.transform));
  card.objects.entries = card::kCaps3Objects.of(caps3);
  card.primary_objects.entries = card::kCaps3PrimObjects.of(caps3);
  card.pairs = config.pairs;
  card.can_swap = config.swap;
  card.has_normals = config.normals;
  card.parallel = config.parallel;
  card.sat_interval = config.sat_interval;
  card.row_cycles = std::max(config.shared_lane, 1u);
  card.filter = config.filter.has_value();
  card.box = config.box;
  if (card.primaries == 0 || card.primaries > Stencil().size())
    refuse("number of primaries is out of range");
}

}  // namespace

// ---- Bus accesses ----

void Board::Impl::write(card::Space space, std::uint32_t offset, const void* data,
                        std::uint64_t beats) {
  if (space == card::kSpaceDdr || space == card::kSpacePrim || offset >= card::kObjectTable)
    words_uploaded += 2 * beats;
  link->write(space, offset, data, beats);
}

std::uint64_t Board::Impl::read_register(std::uint32_t offset) {
  std::uint64_t value = 0;
  const std::uint64_t start = link->time_ps();
  link->read(card::kSpaceReg, offset, &value, 1);
  register_ps += link->time_ps() - start;
  return value;
}

void Board::Impl::write_register(std::uint32_t offset, std::uint64_t value) {
  const std::uint64_t start = link->time_ps();
  link->write(card::kSpaceReg, offset, &value, 1);
  register_ps += link->time_ps() - start;
}

void Board::Impl::check_bus(const char* during) {
  const std::uint64_t status = read_register(card::kRegStatus);
  if ((status >> card::kStatusBusError & 1) == 0) return;
  const std::uint64_t fault = read_register(card::kRegFaultAddr);
  write_register(card::kRegControl, card::kControlClear);
  throw Error(
      ErrorCode::kDevice,
      fmt::format(
          "bus error during {}: access to space {} offset {:#x} refused, status {:#x}, cycle {}",
          during, card::kFaultSpace.of(fault), card::kFaultAddr.of(fault), status, cycles()));
}

void Board::Impl::reset() {
  loaded = second_loaded = 0;
  for (ObjectTable* table : {&objects, &primary_objects}) table->assign({});
  link->reset();
}

void Board::Impl::recover() {
  for (Packet& packet : packets_) packet.written = false;
  for (ObjectTable* table : {&objects, &primary_objects})
    table->assign(std::vector(table->objects));
  link->reset();
}

void Board::Impl::prepare() {
  if (!packets_[0].written) write_packet(packets_[0]);
  if (second_loaded != 0 && !packets_[1].written) write_packet(packets_[1]);
  prepare_objects();
}

// ---- Opening ----

Board::Board(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
Board::Board(Board&&) noexcept = default;
Board& Board::operator=(Board&&) noexcept = default;
Board::~Board() = default;

Board::Impl& Board::card() const {
  if (!impl_) throw Error(ErrorCode::kUsage, "this Board is empty: it was moved from");
  return *impl_;
}

Board::Impl& Board::idle_card() const {
  Impl& it = card();
  if (it.passing)
    throw Error(ErrorCode::kUsage,
                "the board runs a pass; its sink and progress must not start other work");
  return it;
}

const char* name_of(Memory memory) {
  return memory == Memory::kIdeal ? "ideal" : memory == Memory::kCycle ? "DDR-400" : "16 bits";
}

OpenOptions options_on(const Device& device, bool timed) {
  return {.memory = device.narrow_memory ? Memory::kNarrow
                    : timed              ? Memory::kCycle
                                         : Memory::kIdeal,
          .clock_period_ps = device.clock_period_ps()};
}

Board Board::open(const BoardConfig& config, const OpenOptions& options) {
  if (options.memory > Memory::kNarrow)
    throw Error(ErrorCode::kUsage,
                fmt::format("there is no memory {}", static_cast<std::uint32_t>(options.memory)));
  if (options.memory == Memory::kNarrow && config.ecc)
    throw Error(ErrorCode::kUsage, "a memory of 16 bits has no check bits");
  if (options.ddr_latency < 1 || options.ddr_latency > 10000) {
    throw Error(ErrorCode::kUsage, fmt::format("ddr_latency is {}; it must be 1 to 10000 cycles",
                                               options.ddr_latency));
  }
  if (options.bus_burst < 64 || options.bus_burst > 4096 || options.bus_burst % 8 != 0) {
    throw Error(ErrorCode::kUsage,
                fmt::format("bus_burst is {}; it must be 64 to 4096 bytes, a multiple of 8",
                            options.bus_burst));
  }
  constexpr auto kLeastPs = static_cast<std::uint32_t>(1e6 / kMostClockMhz),
                 kMostPs = static_cast<std::uint32_t>(1e6 / kLeastClockMhz);
  if (options.clock_period_ps < kLeastPs || options.clock_period_ps > kMostPs) {
    throw Error(ErrorCode::kUsage, fmt::format("clock_period_ps is {}; it must be {} to {}",
                                               options.clock_period_ps, kLeastPs, kMostPs));
  }
  check_watchdog(options.watchdog);
  const std::optional<std::filesystem::path> waves =
      options.file || options.config_hash ? std::nullopt : next_waves();
  BoardConfig wanted = config;
  wanted.trace = config.trace || waves;
  const std::vector<std::string> parameters = wanted.parameters();
  SimulationModel model =
      options.file ? SimulationModel::load(
                         *options.file, options.config_hash ? *options.config_hash
                                                            : model_hash(config.top(), parameters))
                   : SimulationModel::open(config.top(), parameters);
  const std::uint64_t expected = options.config_hash.value_or(model.config_hash());
  const std::string file = model.path().string();

  auto impl =
      std::make_shared<Impl>(config.bus == Bus::kCycle ? pci_link(std::move(model), options)
                                                       : local_link(std::move(model), options),
                             file, config.format, options);
  check_identity(*impl, wanted, expected, file);
  Board board(std::move(impl));
  if (waves) board.trace_open(*waves);
  return board;
}

// ---- Algorithm 1, before the pass ----

void Board::throw_defect(Shape shape, std::size_t number, const std::string& why) {
  throw Error(ErrorCode::kBadInput, fmt::format("{} {}: {}", name(shape), number, why));
}

void Board::upload(const TriangleView& triangles, bool validate) {
  upload_words(
      Shape::kTriangle, triangles.size(),
      [&](std::size_t i, float* words) { to_words(triangles[i], slot<Triangle>(words)); },
      [&](std::size_t i) { return validate ? defect(triangles[i], format()) : std::nullopt; });
}

void Board::upload_words(Shape shape, std::size_t count, const Words& words,
                         const std::function<std::optional<std::string>(std::size_t)>& defect) {
  idle_card().link->alive();
  if (count == 0) throw Error(ErrorCode::kUsage, fmt::format("no {}s to upload", name(shape)));
  if (count > capacity(shape)) {
    throw Error(ErrorCode::kCapacity,
                fmt::format("{} {}s do not fit the card's DDR, which holds {}", count, name(shape),
                            capacity(shape)));
  }
  for (std::size_t i = 0; i < count; ++i)
    if (const auto why = defect(i)) throw_defect(shape, i, *why);
  const std::uint64_t start = cycles();
  card().secondaries = 0;
  card().bvh = {};
  card().write_slots(shape, 0, count, words);
  card().upload_cycles = cycles() - start;
  card().secondaries = static_cast<std::uint32_t>(count);
  card().secondary_shape = shape;
}

void Board::update_words(Shape shape, std::size_t first, std::size_t count, const Words& words,
                         const std::function<std::optional<std::string>(std::size_t)>& defect) {
  idle_card().link->alive();
  if (card().secondaries == 0 || shape != card().secondary_shape) {
    throw Error(ErrorCode::kUsage, fmt::format("no {}s were uploaded to the board", name(shape)));
  }
  if (first > card().secondaries || count > card().secondaries - first) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{}s {} to {} are not among the {} uploaded", name(shape), first,
                            first + count - 1, card().secondaries));
  }
  for (std::size_t i = 0; i < count; ++i)
    if (const auto why = defect(i)) throw_defect(shape, i, *why);
  const std::uint64_t start = cycles();
  const std::uint32_t there = std::exchange(card().secondaries, 0);  // no secondaries if this fails
  card().outdate_bvh(first, count);
  card().write_slots(shape, first, count, words);
  card().upload_cycles = cycles() - start;
  card().secondaries = there;
}

void Board::Impl::encode(Shape shape, std::size_t number, std::span<const float> numbers,
                         std::uint32_t* slot) const {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::uint64_t word = coding.encode(numbers[k]);
    slot[k] = static_cast<std::uint32_t>(word);
    if (contract::word_kind(shape, k) == WordKind::kInterval && std::isfinite(numbers[k]) &&
        !std::isfinite(coding.decode(word)))
      throw Error(ErrorCode::kBadInput,
                  fmt::format("{} {}: its interval has an end of {}, beyond the largest number of "
                              "{}, {}; infinity is legal",
                              name(shape), number, numbers[k], format.name(),
                              coding.decode(format.infinity() - 1)));
  }
}

void Board::Impl::write_slots(Shape shape, std::size_t first, std::size_t count,
                              const std::function<void(std::size_t, float*)>& numbers) {
  constexpr std::size_t kChunk = 1024;
  const std::size_t slot_words = cde::words(shape);
  const bool odd = slot_words % 2 != 0;
  // If a chunk begins or ends within a beat, the other word of that beat is also written.
  std::vector<std::uint32_t> buffer((kChunk + 1) * slot_words + 2);
  std::array<float, contract::kMostWords> shape_numbers{};
  for (std::size_t done = 0; done < count;) {
    const std::size_t slot = first + done;
    const std::size_t n = std::min(kChunk, count - done);
    const std::size_t before = odd ? slot % 2 : 0, after = odd ? (slot + n) % 2 : 0;
    std::uint32_t* const shapes = &buffer[before];
    for (std::size_t i = 0; i < n; ++i) {
      numbers(done + i, shape_numbers.data());
      encode(shape, slot + i, std::span(shape_numbers).first(slot_words), shapes + i * slot_words);
    }
    if (odd) {
      if (seams_.size() < (slot + n + 1) / 2) seams_.resize((slot + n + 1) / 2);
      for (std::size_t i = 0; i < n; ++i) {
        const bool second = (slot + i) % 2 != 0;
        seams_[(slot + i) / 2][second] = shapes[second ? i * slot_words : (i + 1) * slot_words - 1];
      }
      if (before != 0) buffer[0] = seams_[slot / 2][0];
      if (after != 0) shapes[n * slot_words] = seams_[(slot + n) / 2][1];
    }
    write(card::kSpaceDdr, static_cast<std::uint32_t>((slot * slot_words - before) * 4),
          buffer.data(), (before + n * slot_words + after) / 2);
    done += n;
  }
  check_bus("the upload of secondaries");
}

void Board::load(std::span<const Ray> rays) {
  load_shapes(rays);
}

void Board::Impl::load(std::uint32_t first, Shape shape, std::size_t count,
                       const std::function<void(std::size_t, float*)>& numbers) {
  if (first >= primaries) {
    throw Error(ErrorCode::kUsage,
                fmt::format("the first pair's primaries fill all {} rows of the register file",
                            primaries / lanes));
  }
  if (count == 0 || first + count > primaries) {
    throw Error(ErrorCode::kUsage, fmt::format("a packet has 1 to {} {}s, not {}",
                                               primaries - first, name(shape), count));
  }
  if (cde::words(shape) > slot_words) {
    throw Error(ErrorCode::kUsage,
                fmt::format("a {} does not fit a primary slot of this card, which has {} words",
                            name(shape), slot_words));
  }
  if (first == 0) loaded = 0;
  second_loaded = 0;
  const std::size_t stride = (slot_words + 1) / 2 * 2;
  Packet& packet = packets_[first == 0 ? 0 : 1];
  packet.offset = static_cast<std::uint32_t>(first * stride * 4);
  packet.words.assign(count * stride, 0);
  std::array<float, contract::kMostWords> shape_numbers{};
  for (std::size_t i = 0; i < count; ++i) {
    numbers(i, shape_numbers.data());
    encode(shape, i, std::span(shape_numbers).first(cde::words(shape)), &packet.words[i * stride]);
  }
  write_packet(packet);
}

void Board::Impl::write_packet(Packet& packet) {
  packet.written = false;
  write(card::kSpacePrim, packet.offset, packet.words.data(), packet.words.size() / 2);
  check_bus("the upload of primaries");
  packet.written = true;
}

void Board::load_words(Shape shape, std::size_t count, const Words& words) {
  idle_card().link->alive();
  const std::uint64_t start = cycles(), start_ps = time_ps();
  card().load(0, shape, count, words);
  card().load_cycles = cycles() - start;
  card().load_ps = time_ps() - start_ps;
  card().loaded = static_cast<std::uint32_t>(count);
  card().primary_shape = shape;
}

void Board::load_second_words(Shape shape, std::size_t count, const Words& words) {
  idle_card().link->alive();
  if (!card().parallel) throw Error(ErrorCode::kUsage, "this card works on one pair at a time");
  if (card().loaded == 0)
    throw Error(ErrorCode::kUsage, "the first pair's primaries are loaded before the second's");
  const std::uint64_t start = cycles(), start_ps = time_ps();
  card().load(card().split(), shape, count, words);
  card().load_cycles += cycles() - start;
  card().load_ps += time_ps() - start_ps;
  card().second_loaded = static_cast<std::uint32_t>(count);
  card().second_shape = shape;
}

// ---- The rest of the interface ----

void Board::reset() {
  idle_card().reset();
}

void Board::trace_open(const std::filesystem::path& file, const TraceOptions& which) {
  std::optional<std::uint64_t> word;
  if (which.secondary) word = *which.secondary * std::uint64_t{words(card().secondary_shape)};
  card().link->trace_open(file, which, word);
}

void Board::trace_close() {
  card().link->trace_close();
}

FpFormat Board::format() const {
  return card().format;
}
unsigned Board::lanes() const {
  return card().lanes;
}
unsigned Board::primaries() const {
  return card().primaries;
}
std::uint64_t Board::capacity(Shape shape) const {
  return card().capacity / (4 * words(shape));
}
std::uint64_t Board::sram_records() const {
  return card().sram_records;
}
unsigned Board::pipe_latency() const {
  return card().pipe_latency;
}
std::uint64_t Board::upload_cycles() const {
  return card().upload_cycles;
}
std::uint64_t Board::words_uploaded() const {
  return card().words_uploaded;
}
const std::filesystem::path& Board::model_path() const {
  return card().model_path;
}
std::uint64_t Board::config_hash() const {
  return card().link->config_hash();
}

std::uint64_t Board::read_register(std::uint32_t offset) {
  return card().read_register(offset);
}
void Board::write_register(std::uint32_t offset, std::uint64_t value) {
  card().write_register(offset, value);
}
void Board::bus_write(card::Space space, std::uint32_t offset,
                      std::span<const std::uint64_t> beats) {
  card().link->write(space, offset, beats.data(), beats.size());
}
void Board::bus_read(card::Space space, std::uint32_t offset, std::span<std::uint64_t> beats) {
  card().link->read(space, offset, beats.data(), beats.size());
}
std::uint64_t Board::wait(std::uint64_t max_cycles) {
  return card().link->run(max_cycles);
}
std::uint64_t Board::cycles() const {
  return card().cycles();
}
std::uint64_t Board::time_ps() const {
  return card().link->time_ps();
}
BusCounters Board::bus_counters() const {
  BusCounters c = card().link->counters();
  c.pass_retries = card().pass_retries;
  return c;
}
MemoryCounters Board::memory_counters() const {
  return card().link->memory_counters();
}
std::string Board::bus_violation() const {
  return card().link->violation();
}
void Board::inject(BusFault fault, std::uint32_t count, std::uint32_t value) {
  card().link->inject(fault, count, value);
}
void Board::flip_ddr(std::uint64_t byte, std::uint8_t mask) {
  if (byte >= card().capacity || !card().link->flip_ddr(byte, mask))
    throw Error(ErrorCode::kUsage,
                fmt::format("DDR has {} bytes, no byte {}", card().capacity, byte));
}
void Board::flip_check(std::uint64_t word, std::uint8_t mask) {
  if (mask > 0x7f) throw Error(ErrorCode::kUsage, "a word has check bits 0 to 6");
  if (word >= card().capacity / 4 || !card().link->flip_check(word, mask))
    throw Error(ErrorCode::kUsage, fmt::format("DDR has no check bits of word {}", word));
}

std::string place_on_card(const Board& board, std::uint32_t primary) {
  return fmt::format("cycle {} (record read), lane {}, row {}", board.cycles(),
                     primary % board.lanes(), primary / board.lanes());
}

}  // namespace cde
