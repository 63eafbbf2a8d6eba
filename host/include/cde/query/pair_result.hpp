// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace cde {

/// Result of a pipe for one pair, as words of the format (low bits of a uint64_t).
struct PairResult {
  bool f = false;    ///< the shapes meet
  bool bad = false;  ///< an operand is out of contract: F = 0, the other fields NaN
  std::uint64_t t = 0;
  std::uint64_t cp[3] = {};
  std::uint64_t n[3] = {};  ///< zero for rays
  bool operator==(const PairResult&) const = default;
};

/// The same in binary32, as numbers.
struct PairAnswer {
  bool f = false;
  bool bad = false;
  float t = 0;
  std::array<float, 3> cp = {};
  std::array<float, 3> n = {};
};

/// Names of the fields in which two results differ, "F, T, CPx".
[[nodiscard]] std::string differing_fields(const PairResult& a, const PairResult& b);

}  // namespace cde
