// SPDX-License-Identifier: Apache-2.0
// Existing simulation models that stand in for the planned card.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cases.hpp"
#include "cde/scene/plan.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

/// The test's own cache. No other card has adders of 7 cycles, so no model in the build folder can
/// serve these scenes.
class CardChoice : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cde-choice-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    const char* old = std::getenv("CDE_CACHE");
    if (old != nullptr) before_ = old;
    ::setenv("CDE_CACHE", name.c_str(), 1);
  }
  void TearDown() override {
    fs::remove_all(folder_);
    before_ ? ::setenv("CDE_CACHE", before_->c_str(), 1) : ::unsetenv("CDE_CACHE");
  }

  static BoardConfig slow_adders(BoardConfig card) {
    const OperatorLatencies own = card.latency;
    card.latency = default_device().latencies;
    card.latency.add = 7;
    if (own.mul != 1) card.latency.mul = own.mul;
    return card;
  }
  /// Adds a cache entry for a card as the builder leaves it. Its code belongs to another card,
  /// because the choice does not read the code.
  static fs::path keep(const BoardConfig& card) {
    const fs::path code = model_path("board", host_config().parameters());
    const fs::path file = model_file(card.top(), card.parameters()).path;
    fs::copy_file(code, file, fs::copy_options::overwrite_existing);
    std::ifstream in(fs::path(code) += ".sha256");
    std::string comment, sum;
    std::getline(in, comment);
    in >> sum;
    std::ofstream(fs::path(file) += ".sha256")
        << fmt::format("# {} {}\n{}  {}\n", card.top(), fmt::join(card.parameters(), " "), sum,
                       file.filename().string());
    return file;
  }
  /// Rays against spheres, on a card with slow adders.
  static cde::Scene scene(unsigned rays = 10, const std::string& card = "",
                          const char* query = "") {
    return parse_scene(
        fmt::format("[card]\nlatency = {{ add = 7 }}\n{}"
                    "[[object]]\nname = \"rays\"\nrandom_rays = {{ count = {} }}\n"
                    "[[object]]\nname = \"ball\"\nsphere = {{ center = [1, 2, 3], radius = 0.5 }}\n"
                    "[[query]]\nname = \"q\"\npair = \"ray-sphere\"\nprimaries = \"rays\"\n"
                    "secondaries = \"ball\"\n{}",
                    card, rays, query),
        "s.toml");
  }
  static Plan planned(const cde::Scene& s) {
    Plan p = plan(s);
    use_built_card(s, p);
    return p;
  }

  fs::path folder_;
  std::optional<std::string> before_;
};

TEST_F(CardChoice, Parameters_ReadBackEqual) {
  const BoardConfig odd = {.lanes = 8,
                           .arithmetic = Arithmetic::kRtl,
                           .pairs = {Pair::kRayTriangle, Pair::kSphereSphere},
                           .algorithm = Algorithm::kPluecker,
                           .box = true,
                           .swap = true,
                           .normals = true,
                           .parallel = true,
                           .filter = FpFormat::parse("fp16"),
                           .transform = Transformer::kBoth,
                           .objects = 32,
                           .primary_objects = 16,
                           .latency = {.sqrt = 3},
                           .ddr_slots = 1000,
                           .sram_records = 64,
                           .ecc = true,
                           .trace = true};
  for (const BoardConfig& card : {BoardConfig{}, odd}) {
    const std::optional<BoardConfig> read = BoardConfig::of(card.parameters());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->parameters(), card.parameters());
  }
  EXPECT_EQ(odd.parameters().size(), 18u) << "every parameter differs from its default";
  for (const std::vector<std::string>& none : {std::vector<std::string>{"ARITH=host", "LANES=3"},
                                               {"ARITH=soft"},
                                               {"LANES"},
                                               {"LANES="},
                                               {"LANES=8x"},
                                               {"LANES=8", "LANES=8"},
                                               {"NO_SUCH=1"},
                                               {"BOX=2"},
                                               {fmt::format("PAIRS={}", 1u << kPairs)},
                                               {""}})
    EXPECT_FALSE(BoardConfig::of(none)) << fmt::format("{}", fmt::join(none, " "));
}

TEST_F(CardChoice, SeveralBuiltCards_CheapestServes) {
  const cde::Scene s = scene();
  const BoardConfig best = slow_adders({.pairs = {Pair::kRaySphere}});
  Plan p = planned(s);
  EXPECT_FALSE(p.stands_in_for) << "no model exists";
  EXPECT_EQ(p.board.parameters(), best.parameters());

  const std::vector<Pair> two = {Pair::kRayTriangle, Pair::kRaySphere};
  const fs::path more = keep(slow_adders({.pairs = two, .box = true, .trace = true}));
  p = planned(s);
  ASSERT_TRUE(p.stands_in_for);
  EXPECT_EQ(p.stands_in_for->board.parameters(), best.parameters());
  EXPECT_TRUE(p.board.trace);
  const double dearer = p.stands_in_for->times;
  EXPECT_GT(dearer, 1.1);
  EXPECT_LE(dearer, 1.3);

  keep(slow_adders({.pairs = two, .normals = true}));
  p = planned(s);
  ASSERT_TRUE(p.stands_in_for);
  EXPECT_EQ(p.board.pairs, two);
  EXPECT_FALSE(p.board.trace);
  EXPECT_LT(p.stands_in_for->times, dearer);
  EXPECT_EQ(planned(s).board.parameters(), p.board.parameters()) << "the choice is repeatable";

  keep(best);
  p = planned(s);
  EXPECT_FALSE(p.stands_in_for);
  EXPECT_EQ(p.board.parameters(), best.parameters());
}

TEST_F(CardChoice, UnsuitableCards_AreNotChosen) {
  const std::vector<Pair> rays = {Pair::kRaySphere};
  for (BoardConfig card :
       {BoardConfig{.pairs = {Pair::kRayTriangle}},  // another pipe
        BoardConfig{.lanes = 8, .pairs = rays},      // twice the cycles
        BoardConfig{.lanes = 32, .pairs = rays},     // more than the device has
        BoardConfig{.arithmetic = Arithmetic::kRtl, .pairs = rays},
        BoardConfig{.pairs = rays, .transform = Transformer::kSecondaries},
        BoardConfig{.pairs = rays, .latency = {.mul = 2}},
        BoardConfig{.pairs = rays, .ddr_slots = 1000},
        BoardConfig{.pairs = rays, .bus = Bus::kCycle}, BoardConfig{.pairs = rays, .ecc = true},
        BoardConfig{.pairs = {Pair::kRayTriangle, Pair::kObbObb, Pair::kRaySphere,
                              Pair::kSphereSphere, Pair::kSphereObb}}})
    keep(slow_adders(card));
  const Plan p = planned(scene());
  EXPECT_FALSE(p.stands_in_for) << fmt::format("{}", fmt::join(p.board.parameters(), " "));
  // Each entry is valid: it is found where it is the planned card, or where it would serve.
  EXPECT_EQ(planned(scene(10, "lanes = 8\n")).board.lanes, 8u);
  EXPECT_TRUE(model_file("card", slow_adders({.pairs = rays}).parameters()).built);
  EXPECT_FALSE(built_models("card").empty());
}

TEST_F(CardChoice, ScenesRequests_AreKept) {
  keep(slow_adders({.pairs = {Pair::kRayTriangle, Pair::kRaySphere}, .swap = false}));
  EXPECT_TRUE(planned(scene()).stands_in_for);
  EXPECT_TRUE(planned(scene(10, "lanes = 16\n")).stands_in_for);
  EXPECT_FALSE(planned(scene(10, "lanes = 4\n")).stands_in_for);
  EXPECT_FALSE(planned(scene(10, "pairs = [\"ray-sphere\"]\n")).stands_in_for);
  EXPECT_FALSE(planned(scene(10, "trace = true\n")).stands_in_for);
  EXPECT_FALSE(planned(scene(10, "device = \"ecp5-85\"\n")).stands_in_for) << "it has one lane";
  EXPECT_TRUE(planned(scene(200)).stands_in_for);
  EXPECT_FALSE(planned(scene(300)).stands_in_for) << "a large scene builds its own card";
}

/// The comment in a checksum file is only a hint: the key and the checksum decide.
TEST_F(CardChoice, DamagedOrForeignEntries_AreNotChosen) {
  const BoardConfig card = slow_adders({.pairs = {Pair::kRayTriangle, Pair::kRaySphere}});
  const fs::path file = keep(card), sum = fs::path(file) += ".sha256";
  ASSERT_TRUE(planned(scene()).stands_in_for);
  fs::permissions(sum, fs::perms::others_write, fs::perm_options::add);
  EXPECT_FALSE(planned(scene()).stands_in_for) << "other users can write the entry";
  fs::permissions(sum, fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
  EXPECT_FALSE(planned(scene()).stands_in_for);
  fs::permissions(file, fs::perms::others_write, fs::perm_options::remove);
  ASSERT_TRUE(planned(scene()).stands_in_for);
  // Under the name of another key, as after a change of the RTL or the tools.
  fs::rename(file, folder_ / "0123456789abcdef01234567.so");
  fs::rename(sum, folder_ / "0123456789abcdef01234567.so.sha256");
  EXPECT_FALSE(planned(scene()).stands_in_for);
  keep(card);
  ASSERT_TRUE(planned(scene()).stands_in_for);
  std::ofstream(file, std::ios::app) << "more";
  EXPECT_FALSE(planned(scene()).stands_in_for) << "the checksum is wrong";
  std::ofstream(sum, std::ios::trunc) << "# board ARITH=host LANES=\xff PAIRS=no\n";
  EXPECT_FALSE(planned(scene()).stands_in_for);
}

}  // namespace
}  // namespace cde::testing
