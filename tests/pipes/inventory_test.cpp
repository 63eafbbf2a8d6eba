// SPDX-License-Identifier: Apache-2.0
// The operators of a pipe, counted in the elaborated design, against its mirror reference
// and Table 2 of the paper.
#include "cde/netlist/elaborate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "numerics/operators.hpp"

namespace cde::netlist {

static std::ostream& operator<<(std::ostream& out, const Operators& o) {
  return out << o.multipliers << " mul, " << o.dividers << " div, " << o.square_roots << " sqrt, "
             << o.adders << " add, " << o.subtractors << " sub, " << o.comparators << " cmp, "
             << o.min_max << " min/max, " << o.mask_ands << " and";
}

namespace {

const std::filesystem::path kRtl = std::filesystem::path(CDE_SOURCE_DIR) / "rtl";
const Operators kPaper{
    .multipliers = 27, .dividers = 1, .adders = 12, .subtractors = 15, .comparators = 8};

/// The ANDs are not compared with the paper, which does not state their width.
Operators without_ands(Operators o) {
  o.mask_ands = 0;
  return o;
}

TEST(Inventory, Moller_HasThePapersOperators) {
  const Elaboration design(kRtl, "ray_triangle_moller");
  EXPECT_EQ(without_ands(design.operators("ray_triangle_moller")), kPaper);
  EXPECT_EQ(design.constant("ray_triangle_moller", "LATENCY"), 10u);
}

TEST(Inventory, MoreLanes_AreTheSameOperatorsWider) {
  const Elaboration design(kRtl, "ray_triangle_moller", {"LANES=4"});
  EXPECT_EQ(without_ands(design.operators("ray_triangle_moller")), kPaper);
  EXPECT_EQ(design.bits("ray_triangle_moller", "b_i"), 9u * 4 * 32);
}

TEST(Inventory, Part_IsCountedAlone) {
  // Counts a part alone, so that a count that always returned the paper's figures would fail.
  const Elaboration design(kRtl, "ray_triangle_moller");
  const Operators cross{.multipliers = 6, .subtractors = 3};
  EXPECT_EQ(design.operators("ray_triangle_moller.cross_p"), cross);
  EXPECT_EQ(design.operators("ray_triangle_moller.no_such_part"), Operators{});
}

/// The operators that the box rule adds, as reference/pipes/ray_box.hpp states them: in gates, and
/// as calls per lane with host arithmetic. All lanes share the triangle's part.
TEST(Inventory, BoxRule_AddsItsOperators) {
  const Elaboration design(kRtl, "ray_triangle_moller",
                           {"ARITH=rtl", "BOX=1", "LANES=4", "B_LANES=1"});
  const std::string box = "ray_triangle_moller.box_hit";
  const Operators triangle{
      .multipliers = 13, .adders = 15, .subtractors = 12, .comparators = 3, .min_max = 14};
  EXPECT_EQ(without_ands(design.operators(box + ".bounds")), triangle);
  Operators all = triangle;
  all.multipliers += 1, all.adders += 2, all.subtractors += 6, all.comparators += 3;
  EXPECT_EQ(without_ands(design.operators(box)), all);
  EXPECT_EQ(design.constant("ray_triangle_moller", "LATENCY"), 13u);
}

/// A pipe that accepts one pair per cycle, with its parameters.
struct Pipe {
  std::string module;
  Pair pair;
  Algorithm algorithm = Algorithm::kMoller;

  friend void PrintTo(const Pipe& p, std::ostream* out) { *out << p.module; }
};
std::vector<Pipe> pipes() {
  std::vector<Pipe> all;
  for (unsigned p = 0; p < kPairs; ++p) {
    const auto pair = static_cast<Pair>(p);
    if (has_iterations(pair)) continue;
    std::string module(name(pair));
    std::replace(module.begin(), module.end(), '-', '_');
    if (pair != Pair::kRayTriangle) {
      all.push_back({module, pair});
      continue;
    }
    for (unsigned a = 0; a < kAlgorithms; ++a) {
      const auto algorithm = static_cast<Algorithm>(a);
      all.push_back({module + "_" + std::string(name(algorithm)), pair, algorithm});
    }
  }
  return all;
}

/// Operators of the mirror reference.
Operators counted(Pair pair, Algorithm algorithm = Algorithm::kMoller) {
  const cde::testing::Tally n = cde::testing::operators(pair, algorithm);
  const auto count = [](int k) { return static_cast<unsigned>(k); };
  return {.multipliers = count(n.mul),
          .dividers = count(n.div),
          .square_roots = count(n.sqrt),
          .adders = count(n.add),
          .subtractors = count(n.sub),
          .comparators = count(n.cmp),
          .min_max = count(n.minmax)};
}

class PipeInventory : public ::testing::TestWithParam<Pipe> {};

TEST_P(PipeInventory, Pipe_HasTheReferencesOperators) {
  // Host arithmetic has the same operators and elaborates faster.
  const Elaboration design(kRtl, GetParam().module, {"ARITH=host"});
  EXPECT_EQ(without_ands(design.operators(GetParam().module)),
            counted(GetParam().pair, GetParam().algorithm));
}

INSTANTIATE_TEST_SUITE_P(Pipes, PipeInventory, ::testing::ValuesIn(pipes()),
                         [](const auto& info) { return info.param.module; });

/// Operators of pipes whose candidate-axis units are shared, and their latency in cycles.
struct Turns {
  const char* module;
  Pair pair;
  Operators stated;
  unsigned latency, latency_of_one;  ///< with an interval of 3, and of 1

  friend void PrintTo(const Turns& t, std::ostream* out) { *out << t.module; }
};
const Turns kTurns[] = {{"obb_obb",
                         Pair::kObbObb,
                         {.multipliers = 335,
                          .dividers = 7,
                          .square_roots = 4,
                          .adders = 203,
                          .subtractors = 169,
                          .comparators = 81,
                          .min_max = 43},
                         110,
                         107},
                        {"triangle_obb",
                         Pair::kTriangleObb,
                         {.multipliers = 378,
                          .dividers = 10,
                          .square_roots = 5,
                          .adders = 203,
                          .subtractors = 147,
                          .comparators = 102,
                          .min_max = 79},
                         113,
                         112},
                        {"triangle_aabb",
                         Pair::kTriangleAabb,
                         {.multipliers = 336,
                          .dividers = 10,
                          .square_roots = 5,
                          .adders = 176,
                          .subtractors = 159,
                          .comparators = 102,
                          .min_max = 79},
                         110,
                         109}};

class SharedSatUnits : public ::testing::TestWithParam<Turns> {};

TEST_P(SharedSatUnits, SharedAxes_NeedFewerUnits) {
  const char* module = GetParam().module;
  const Elaboration gates(kRtl, module, {"ARITH=rtl", "SAT_II=3"});
  EXPECT_EQ(without_ands(gates.operators(module)), GetParam().stated);
  EXPECT_EQ(gates.constant(module, "LATENCY"), GetParam().latency);
  // The host's arithmetic computes all candidate axes at once, with the latency of the gates.
  const Elaboration host(kRtl, module, {"ARITH=host", "SAT_II=3"});
  EXPECT_EQ(without_ands(host.operators(module)), counted(GetParam().pair));
  EXPECT_EQ(host.constant(module, "LATENCY"), GetParam().latency);
  const Elaboration one(kRtl, module, {"ARITH=host"});
  EXPECT_EQ(one.constant(module, "LATENCY"), GetParam().latency_of_one);
}

INSTANTIATE_TEST_SUITE_P(Convex, SharedSatUnits, ::testing::ValuesIn(kTurns),
                         [](const auto& info) { return std::string(info.param.module); });

TEST(Inventory, WrappedPipe_HasTheSameOperators) {
  for (const char* arith : {"ARITH=rtl", "ARITH=host"}) {
    const Elaboration design(kRtl, "pair_pipe",
                             {"PAIR=0", latency_parameter(3, 1, 12, 1, 1), arith});
    EXPECT_EQ(design.module_of("pair_pipe.pipe"), "ray_triangle_moller");
    EXPECT_EQ(without_ands(design.operators("pair_pipe.pipe")), kPaper) << arith;
    // sub, cross (mul sub), dot (mul add add), div, scale (mul), point (add), select.
    EXPECT_EQ(design.constant("pair_pipe.pipe", "LATENCY"), 3u + 4 + 7 + 12 + 1 + 3 + 1) << arith;
  }
}

// The last result depends on the latencies of operators: no delay may become negative. Iterative
// pipelines take minutes to elaborate this often, and so do candidate axes unless they are shared.
TEST(Inventory, SlowComparisons_Elaborate) {
  for (unsigned p = 0; p < cde::kPairs; ++p) {
    if ((cde::contract::kIterativePairs >> p & 1) != 0) continue;
    std::vector<std::string> parameters = {"PAIR=" + std::to_string(p), "ARITH=host",
                                           latency_parameter(1, 1, 1, 64, 64)};
    if ((cde::contract::kSatPairs >> p & 1) != 0) parameters.emplace_back("SAT_II=3");
    EXPECT_NO_THROW(Elaboration(kRtl, "pair_pipe", parameters)) << p;
  }
}

TEST(Inventory, HiddenBodies_KeepTheConstantsOfTheTop) {
  const std::vector<std::string> parameters = {"ARITH=host", latency_parameter(3, 3, 12, 12, 1)};
  const Elaboration whole(kRtl, "obb_plane", parameters);
  const Elaboration outline(kRtl, "obb_plane", parameters, [](std::string_view) { return true; });
  EXPECT_EQ(outline.constant("obb_plane", "LATENCY"), whole.constant("obb_plane", "LATENCY"));
  EXPECT_EQ(outline.bits("obb_plane", "a_i"), whole.bits("obb_plane", "a_i"));
  EXPECT_EQ(outline.operators("obb_plane").adders, 0u);
  EXPECT_GT(whole.operators("obb_plane").adders, 0u);
}

/// The figures in the header of rtl/pipes/cylinder_pair.sv.
struct IterativePipe {
  const char* pair;
  const char* parameter;
  Operators stated;
  unsigned rows, latency;

  friend void PrintTo(const IterativePipe& r, std::ostream* out) { *out << r.pair; }
};
const IterativePipe kIterativePipes[] = {{"cylinder_cylinder",
                                          "PAIR=8",
                                          {.multipliers = 321,
                                           .dividers = 9,
                                           .square_roots = 8,
                                           .adders = 142,
                                           .subtractors = 115,
                                           .comparators = 34,
                                           .min_max = 18},
                                          64,
                                          4298},
                                         {"obb_cylinder",
                                          "PAIR=9",
                                          {.multipliers = 215,
                                           .dividers = 5,
                                           .square_roots = 4,
                                           .adders = 120,
                                           .subtractors = 83,
                                           .comparators = 35,
                                           .min_max = 16},
                                          64,
                                          5066},
                                         {"triangle_cylinder",
                                          "PAIR=7",
                                          {.multipliers = 269,
                                           .dividers = 8,
                                           .square_roots = 4,
                                           .adders = 135,
                                           .subtractors = 125,
                                           .comparators = 54,
                                           .min_max = 21},
                                          70,
                                          5260}};

class IterativePipeInventory : public ::testing::TestWithParam<IterativePipe> {};

TEST_P(IterativePipeInventory, Pipe_HasTheOperatorsOfItsHeader) {
  const Elaboration design(kRtl, "pair_unit", {GetParam().parameter, "ARITH=host"});
  const char* pipe = "pair_unit.pipe";
  EXPECT_EQ(design.module_of(pipe), "cylinder_pair");
  EXPECT_EQ(without_ands(design.operators(pipe)), GetParam().stated);
  EXPECT_EQ(design.constant(pipe, "SLOTS"), GetParam().rows);
  EXPECT_EQ(design.constant(pipe, "LATENCY"), GetParam().latency);
}

INSTANTIATE_TEST_SUITE_P(Cylinders, IterativePipeInventory, ::testing::ValuesIn(kIterativePipes),
                         [](const auto& info) { return std::string(info.param.pair); });

TEST(Inventory, FailedElaboration_NamesTheReason) {
  try {
    const Elaboration design(kRtl, "pair_pipe", {"PAIR=" + std::to_string(cde::kPairs)});
    FAIL() << "expected an error: no pair has this code";
  } catch (const ElaborationError& error) {
    EXPECT_NE(std::string(error.what()).find("no pipe for this pair"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(Elaboration(kRtl, "no_such_module"), ElaborationError);
  const auto refused = [](const char* top, const std::vector<std::string>& parameters) {
    try {
      const Elaboration design(kRtl, top, parameters);
    } catch (const ElaborationError& error) {
      return std::string(error.what());
    }
    return std::string("elaborated");
  };
  for (const char* interval : {"SAT_II=0", "SAT_II=2"}) {
    EXPECT_NE(refused("triangle_aabb", {interval, "ARITH=host"}).find("SAT_II must be 1 or 3"),
              std::string::npos);
    EXPECT_NE(refused("board", {interval, "ARITH=host"}).find("SAT_II must be 1 or 3"),
              std::string::npos);
  }
  EXPECT_NE(refused("pair_pipe", {"PAIR=4", "SAT_II=3"}).find("needs a pair with candidate axes"),
            std::string::npos);
}

}  // namespace
}  // namespace cde::netlist
