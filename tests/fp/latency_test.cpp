// SPDX-License-Identifier: Apache-2.0
// Latencies are exact. A unit gets different operands every cycle, and each result must appear
// exactly LAT cycles later. The call apply() reads a result only in that cycle, so an error of one
// cycle would return a neighbour's result.
#include "cde/support/error.hpp"
#include "operands.hpp"
#include "unit_check.hpp"

namespace cde::testing {
namespace {

const TestUnit& unit_of(const std::string& label) {
  for (const TestUnit& u : test_units())
    if (u.label == label) return u;
  throw std::runtime_error("no test model " + label);
}

struct Latencies {
  std::string label;
  int add, mul, div, sqrt, compare, convert, lanes;
};

TEST(Latency, EachUnit_HasItsBuiltLatency) {
  for (const Latencies& want : {Latencies{"fp32_rtl", 1, 1, 1, 1, 1, 1, 8},
                                {"fp16_rtl_cuts2", 2, 2, 2, 2, 2, 2, 3},
                                {"fp32_rtl_cuts4", 4, 4, 9, 10, 3, 3, 1},
                                {"fp16_rtl_cuts6", 6, 6, 16, 14, 1, 4, 1},
                                {"e3m2_rtl_more", 9, 8, 40, 33, 5, 7, 2},
                                {"fp32_host_more", 9, 8, 40, 33, 5, 7, 5}}) {
    const FpUnit unit = load(unit_of(want.label));
    EXPECT_EQ(unit.latency(FpOp::kSub), want.add) << want.label;
    EXPECT_EQ(unit.latency(FpOp::kMul), want.mul) << want.label;
    EXPECT_EQ(unit.latency(FpOp::kDiv), want.div) << want.label;
    EXPECT_EQ(unit.latency(FpOp::kSqrt), want.sqrt) << want.label;
    EXPECT_EQ(unit.latency(FpOp::kMax), want.compare) << want.label;
    EXPECT_EQ(unit.latency(FpOp::kToI64), want.convert) << want.label;
    EXPECT_EQ(unit.lanes(), want.lanes) << want.label;
  }
}

TEST(Latency, StreamedNeighbours_KeepTheirResults) {
  FpUnit unit = load(unit_of("fp32_rtl_cuts4"));
  const FpFormat f = unit.format();
  std::vector<uint64_t> a(1000), b(1000), r(1000);
  std::vector<uint8_t> flags(1000);
  for (std::size_t i = 0; i < a.size(); i++)
    a[i] = f.encode(static_cast<double>(i) + 1), b[i] = f.encode(1.0);
  for (const FpOp op : {FpOp::kAdd, FpOp::kMul, FpOp::kDiv}) {
    unit.apply(op, a, b, r, flags);
    for (std::size_t i = 0; i < a.size(); i++)
      ASSERT_EQ(f.decode(r[i]), static_cast<double>(i) + (op == FpOp::kAdd ? 2 : 1))
          << op_name(op) << " " << i;
  }
}

TEST(FpUnit, OperandsOfDifferentSizes_AreRefused) {
  FpUnit unit = load(unit_of("fp32_host"));
  std::vector<uint64_t> three(3), two(2);
  EXPECT_THROW(unit.apply(FpOp::kAdd, three, two, three), Error);
  EXPECT_THROW(unit.apply(FpOp::kSqrt, three, three, three), Error);
  EXPECT_THROW(unit.apply(FpOp::kAdd, three, three, two), Error);
}

TEST(FpUnit, OmittedOperation_IsRefused) {
  FpUnit unit = load(unit_of("fp64_rtl_cuts6"));
  std::vector<uint64_t> one(1);
  EXPECT_THROW(unit.apply(FpOp::kToI32, one, {}, one), Error);
}

TEST(FpUnit, Measurement_ReturnsARate) {
  FpUnit unit = load(unit_of("fp32_host"));
  EXPECT_GT(unit.measure(FpOp::kAdd, 0.01), 1e5);
}

}  // namespace
}  // namespace cde::testing
