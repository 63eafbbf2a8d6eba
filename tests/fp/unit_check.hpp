#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "cde/fp_unit.hpp"

namespace cde::testing {

/// A bitstream that the build made for these tests.
struct TestUnit {
  std::string label;
  FpFormat format;
  std::string arith;
  std::string path;
};
inline void PrintTo(const TestUnit& u, std::ostream* out) {
  *out << u.label;
}
const std::vector<TestUnit>& test_units();
inline std::string unit_name(const ::testing::TestParamInfo<TestUnit>& info) {
  return info.param.label;
}

FpUnit load(const TestUnit& unit);
const char* op_name(FpOp op);

/// Runs operations on a unit and compares every result and every flag with the reference. A
/// mismatch prints the operands and the command that repeats it.
class UnitCheck {
 public:
  explicit UnitCheck(const TestUnit& unit) : test_(unit), unit_(load(unit)) {}
  ~UnitCheck();

  [[nodiscard]] bool has(FpOp op) const;
  [[nodiscard]] FpUnit& unit() { return unit_; }
  void add(FpOp op, uint64_t a, uint64_t b = 0);
  /// Compares what was added; called for full batches and by finish().
  void finish();

 private:
  void run(FpOp op);
  TestUnit test_;
  FpUnit unit_;
  std::vector<std::vector<uint64_t>> a_{kFpOps}, b_{kFpOps};
  uint64_t compared_ = 0, mismatches_ = 0;
};

}  // namespace cde::testing
