// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "cde/card/fp_unit.hpp"

namespace cde::testing {

/// A simulation model that the build made for these tests.
struct TestUnit {
  std::string label;
  FpFormat format;
  std::string arith;
  std::string path;
  std::string parameters;  ///< parameters besides format, lanes and back end: NAME=VALUE;...

  [[nodiscard]] bool gives(const char* parameter) const {
    return parameters.find(parameter) != std::string::npos;
  }
  /// Whether arithmetic may return any NaN where the reference returns the canonical NaN.
  [[nodiscard]] bool any_nan() const { return gives("CANON=0"); }
};
inline void PrintTo(const TestUnit& u, std::ostream* out) {
  *out << u.label;
}
const std::vector<TestUnit>& test_units();

/// The units for which the predicate holds. Tests are instantiated with these alone, so a skipped
/// test always means a missing check.
template <class Predicate>
std::vector<TestUnit> units_where(Predicate holds) {
  std::vector<TestUnit> units;
  std::copy_if(test_units().begin(), test_units().end(), std::back_inserter(units), holds);
  return units;
}
inline std::string unit_name(const ::testing::TestParamInfo<TestUnit>& info) {
  return info.param.label;
}

FpUnit load(const TestUnit& unit);
const char* op_name(FpOp op);

/// Runs operations on a unit and compares every result and every flag with the reference. A
/// mismatch prints the operands and the command that repeats it. Units that may return any NaN must
/// return a NaN where the reference does, and the reference's bits elsewhere.
class UnitCheck {
 public:
  explicit UnitCheck(const TestUnit& unit) : test_(unit), unit_(load(unit)) {}
  ~UnitCheck();

  [[nodiscard]] bool has(FpOp op) const;
  [[nodiscard]] FpUnit& unit() { return unit_; }
  void add(FpOp op, uint64_t a, uint64_t b = 0);
  /// Compares the queued operations; called for full batches and by finish().
  void finish();
  /// Number of NaNs so far that were not canonical.
  [[nodiscard]] uint64_t other_nans() const { return other_nans_; }

 private:
  void run(FpOp op);
  TestUnit test_;
  FpUnit unit_;
  std::vector<std::vector<uint64_t>> a_{kFpOps}, b_{kFpOps};
  uint64_t compared_ = 0, mismatches_ = 0, other_nans_ = 0;
};

}  // namespace cde::testing
