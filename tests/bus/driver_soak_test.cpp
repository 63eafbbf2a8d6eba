// SPDX-License-Identifier: Apache-2.0
// The driver under random faults of every kind, with random scenes, motions and modes. Every record
// is compared with the reference. Each pass ends in correct records, or in one clear error and then
// correct records. 40 faults of every kind by default, 10,000 with CDE_FULL=1.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "../board/cases.hpp"
#include "cde/support/error.hpp"

namespace cde::testing {
namespace {

/// The kinds of BusFault, and flipped bits in DDR.
enum Kind : std::uint32_t { kOneBit = kBusFaults, kCheckBit, kTwoBits, kKinds };
std::string name_of_kind(std::uint32_t kind) {
  static constexpr const char* kFlips[] = {"one bit", "check bit", "two bits"};
  return kind < kBusFaults ? name_of(static_cast<BusFault>(kind)) : kFlips[kind - kBusFaults];
}

struct Tally {
  std::array<std::uint64_t, kKinds> faults{};  ///< faults that happened. kHang and kNoGrant count
                                               ///< orders; bits count when the card noticed them
  std::map<std::string, std::uint64_t> errors;
  std::uint64_t passes = 0, records = 0, corrected = 0, resets = 0;
  BusCounters bus;  ///< sums of retries
};

constexpr std::uint32_t kTriangles = 40, kRays = 12;

class DriverSoak {
 public:
  DriverSoak(std::uint32_t seed, const char* host, bool narrow, Tally& tally)
      : random_(seed),
        tally_(tally),
        board_(Board::open(rich_config(Bus::kCycle), options(host, narrow))) {}

  /// Runs rounds until `each` faults of every kind happened on this board.
  void run(std::uint64_t each) {
    while (!enough(each)) {
      round(each);
      if (::testing::Test::HasFatalFailure()) break;
    }
    EXPECT_EQ(board_.bus_violation(), "");
    for (std::uint32_t kind = 0; kind < kKinds; ++kind) tally_.faults[kind] += happened(kind);
    const BusCounters c = board_.bus_counters();
    tally_.bus.transfers += c.transfers;
    tally_.bus.transfer_retries += c.transfer_retries;
    tally_.bus.access_retries += c.access_retries;
    tally_.bus.pass_retries += c.pass_retries;
    tally_.bus.lost_interrupts += c.lost_interrupts;
    tally_.bus.pci_cycles += c.pci_cycles;
  }

 private:
  static OpenOptions options(const char* host, bool narrow) {
    OpenOptions o;
    o.host = *host_profile(host);
    o.bus_burst = 256;
    o.narrow_bus = narrow;
    return o;
  }

  enum class Stage { kStart, kUploaded, kLoaded, kPass };

  // ---- Faults ----

  [[nodiscard]] std::uint64_t happened(std::uint32_t kind) const {
    const bool counted = kind < kBusFaults && kind != static_cast<std::uint32_t>(BusFault::kHang) &&
                         kind != static_cast<std::uint32_t>(BusFault::kNoGrant);
    return counted ? board_.bus_counters().faults[kind] : ordered_[kind];
  }
  [[nodiscard]] bool enough(std::uint64_t each) const {
    for (std::uint32_t kind = 0; kind < kKinds; ++kind)
      if (happened(kind) < each) return false;
    return true;
  }
  /// Injects a fault whose kind is still rare, mostly in a number that the driver recovers from.
  void hurt(std::uint64_t each) {
    std::uint32_t kind = random_.below(kKinds);
    for (std::uint32_t n = 0; n < kKinds && happened(kind) >= each; ++n) kind = (kind + 1) % kKinds;
    if (kind >= kBusFaults) return flip(static_cast<Kind>(kind));
    const auto fault = static_cast<BusFault>(kind);
    if (fault == BusFault::kHang && stage_ < Stage::kLoaded) return;  // memory is not read yet
    const bool stays = random_.below(64) == 0;
    std::uint32_t count = 1 + random_.below(stays ? 40 : 3), value = 1 + random_.below(2);
    switch (fault) {
      case BusFault::kTargetAbort:
        value = random_.below(2);
        break;
      case BusFault::kSlow:
        value = random_.below(32);
        break;
      case BusFault::kNoAnswer:
        count = random_.below(8) == 0 ? kUntilReset : count;
        break;
      case BusFault::kNoGrant:  // cycles
        count = random_.below(1024) == 0 ? kUntilReset : 1 + random_.below(1000);
        break;
      case BusFault::kHang:
        count = stays ? kUntilReset : 500 + random_.below(2000);
        break;
      default:
        break;
    }
    board_.inject(fault, count, value);
    ++ordered_[kind];
  }

  /// Flips bits in a triangle of the next pass; the flip is undone after the pass.
  void flip(Kind kind) {
    if (flipped_ || (stage_ != Stage::kUploaded && stage_ != Stage::kLoaded)) return;
    if (kind == kTwoBits && query_.mode == Mode::kAny) return;  // may end before it reads the word
    const std::uint32_t word = 9 * tested_triangle(random_) + random_.below(9),
                        bit = random_.below(32);
    flipped_ = kind;
    masks_ = {};
    if (kind == kCheckBit) {
      masks_[4] = static_cast<std::uint8_t>(1u << random_.below(7));
    } else {
      masks_[bit / 8] = static_cast<std::uint8_t>(1u << bit % 8);
    }
    if (kind == kTwoBits) {
      const std::uint32_t other = (bit + 1 + random_.below(31)) % 32;
      masks_[other / 8] ^= static_cast<std::uint8_t>(1u << other % 8);
    }
    word_ = word;
    apply_flip();
  }
  std::uint32_t tested_triangle(Random& random) const {
    if (objects_.empty()) return random.below(static_cast<std::uint32_t>(scene_.triangles.size()));
    const Object& o = objects_[random.below(static_cast<std::uint32_t>(objects_.size()))];
    return o.first + random.below(o.count);
  }
  void apply_flip() {
    for (std::uint32_t b = 0; b < 4; ++b)
      if (masks_[b] != 0) board_.flip_ddr(4 * std::uint64_t{word_} + b, masks_[b]);
    if (masks_[4] != 0) board_.flip_check(word_, masks_[4]);
  }

  // ---- Rounds ----

  void choose() {
    scene_ = beam(random_, 1 + random_.below(kRays), 1 + random_.below(kTriangles));
    objects_.clear();
    if (random_.below(2) == 0) return;
    const auto all = static_cast<std::uint32_t>(scene_.triangles.size());
    for (std::uint32_t n = 1 + random_.below(4); n > 0; --n) {
      const std::uint32_t first = random_.below(all);
      const Transform moved{.translation = random_.in_box(0.5f)};
      objects_.push_back({first, 1 + random_.below(all - first), moved});
    }
  }

  /// Repeats the whole sequence while it ends in an error, a limited number of times.
  void round(std::uint64_t each) {
    choose();
    query_ = {.mode = static_cast<Mode>(random_.below(5)), .pair = Pair::kRayTriangle};
    query_.drain_records = 8 + random_.below(57);
    query_.deadline_cycles = 150'000;
    for (unsigned attempt = 0; !whole(attempt == 0, each); ++attempt) {
      if (::testing::Test::HasFatalFailure()) return;
      ASSERT_LT(attempt, 30u) << "still errors after 30 attempts";
    }
  }
  /// Upload, objects, rays, pass; with new faults, or with the remaining ones only.
  bool whole(bool faults, std::uint64_t each) {
    const auto reached = [&](Stage stage) {
      stage_ = stage;
      for (unsigned n = 0; faults && n < (stage == Stage::kPass ? 1 : 2); ++n)
        if (random_.below(stage == Stage::kPass ? 8 : 2) == 0) hurt(each);
    };
    try {
      reached(Stage::kStart);
      board_.upload(scene_.triangles);
      reached(Stage::kUploaded);
      board_.set_objects(objects_);
      reached(Stage::kUploaded);
      board_.load(scene_.rays);
      reached(Stage::kLoaded);
      pass([&] { reached(Stage::kPass); });
      return true;
    } catch (const Error& error) {
      failed(error);
      return false;
    }
  }

  void pass(const std::function<void()>& reached) {
    reference::Checker checker(scene_.rays, scene_.triangles, query_.mode, {}, board_.primaries(),
                               "", objects_);
    const bool twice = flipped_ == kTwoBits;
    const auto check = [&](std::span<const Record> some) {
      tally_.records += some.size();
      if (!twice) checker.check(some);  // records of that triangle are wrong
      reached();
    };
    const Counters c = board_.run(query_, check);
    ++tally_.passes;
    checker.finish();
    ASSERT_FALSE(twice) << "no error for two wrong bits";
    if (flipped_ && c.corrected_words > 0) ++ordered_[*flipped_];
    // Mode kAny may have ended before it read the word.
    EXPECT_TRUE(!flipped_ || c.corrected_words > 0 || query_.mode == Mode::kAny);
    tally_.corrected += c.corrected_words;
    undo_flip();
  }
  void undo_flip() {
    if (flipped_) apply_flip();
    flipped_.reset();
  }

  void failed(const Error& error) {
    const std::string what = error.what();
    ASSERT_TRUE(error.code() == ErrorCode::kDevice || error.code() == ErrorCode::kTimeout) << what;
    ASSERT_TRUE(error.fault()) << what;
    ASSERT_NE(what.find("cycle"), std::string::npos) << what;
    const bool bits = what.find(" of DDR ") != std::string::npos;
    const bool lost = what.find("lost until reset()") != std::string::npos;
    ++tally_.errors[fmt::format("{}{}, code {}", lost ? "lost, " : "",
                                error.code() == ErrorCode::kTimeout ? "timeout"
                                : bits                              ? "words of DDR"
                                                                    : "device",
                                error.fault()->code)];
    if (bits) {
      ASSERT_EQ(flipped_, kTwoBits) << what;
      ++ordered_[kTwoBits];
      // A memory that hangs during the driver's search leaves the search without a result.
      if (error.code() != ErrorCode::kTimeout) {
        EXPECT_EQ(error.fault()->address, 36 * (word_ / 9)) << what;
      }
    }
    undo_flip();
    if (lost) come_back();
  }
  /// A reset fails while the card does not answer; each attempt uses up faults.
  void come_back() {
    for (unsigned attempt = 0; attempt < 100; ++attempt) {
      ++tally_.resets;
      try {
        return board_.reset();
      } catch (const Error& error) {
        ASSERT_NE(std::string(error.what()).find("does not answer"), std::string::npos)
            << error.what();
      }
    }
    FAIL() << "the card did not recover";
  }

  Random random_;
  Tally& tally_;
  Board board_;
  RayScene scene_;
  std::vector<Object> objects_;
  Query query_;
  std::array<std::uint64_t, kKinds> ordered_{};
  std::optional<Kind> flipped_;
  Stage stage_ = Stage::kStart;
  std::uint32_t word_ = 0;
  std::array<std::uint8_t, 5> masks_{};  // of the word's bytes and its check bits
};

void print(const Tally& t) {
  fmt::print("{} passes, {} records compared, {} words corrected, {} resets\n", t.passes, t.records,
             t.corrected, t.resets);
  for (std::uint32_t kind = 0; kind < kKinds; ++kind)
    fmt::print("  {:16} {}\n", name_of_kind(kind), t.faults[kind]);
  for (const auto& [what, count] : t.errors) fmt::print("  errors: {}: {}\n", what, count);
  fmt::print(
      "  {} transfers, {} repeated; {} accesses and {} passes repeated; {} interrupts found "
      "lost; {} PCI cycles\n",
      t.bus.transfers, t.bus.transfer_retries, t.bus.access_retries, t.bus.pass_retries,
      t.bus.lost_interrupts, t.bus.pci_cycles);
}

TEST(DriverSoak, RandomFaults_LoseOrRepeatNoRecord) {
  const bool full = std::getenv("CDE_FULL") != nullptr;
  const std::uint64_t each = full ? 10'000 : 40;
  struct Setting {
    const char* host;
    bool narrow;
  };
  static constexpr Setting kSettings[] = {
      {"ideal", false}, {"good", false}, {"good", true}, {"p64-2001", false}};
  Tally tally;
  std::uint32_t seed = kSeed;
  for (const Setting& s : kSettings) {
    DriverSoak soak(seed++, s.host, s.narrow, tally);
    soak.run(each / std::size(kSettings));
    if (HasFatalFailure()) break;
    if (full) print(tally);
    std::fflush(stdout);
  }
  print(tally);
  for (std::uint32_t kind = 0; kind < kKinds; ++kind)
    EXPECT_GE(tally.faults[kind], each) << name_of_kind(kind);
}

}  // namespace
}  // namespace cde::testing
