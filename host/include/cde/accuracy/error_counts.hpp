// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>

/// @file
/// Statistics of errors and of decisions.
namespace cde::accuracy {

/// Distribution of error sizes. Bins have a width of 1/32 octave. Counts of parts add up to the
/// counts of the whole, and a quantile is at most 1/32 too large.
class ErrorCounts {
 public:
  /// `size` is not negative. It is infinite for a result that is not a number.
  void add(double size);
  void add(const ErrorCounts& other);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Upper bound of the error for this share (0 to 1) of the counted errors; 0 if none was counted.
  [[nodiscard]] double quantile(double share) const;
  /// The largest error, exactly.
  [[nodiscard]] double largest() const;

  /// All counts as JSON, and back. from_json throws what nlohmann::json throws.
  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static ErrorCounts from_json(const nlohmann::ordered_json& json);

 private:
  std::uint64_t count_ = 0, zeros_ = 0, infinite_ = 0;
  double largest_ = 0;  ///< largest finite error
  std::map<int, std::uint64_t> bins_;
};

struct Interval95 {
  double low, high;
};
/// 95 % interval of a probability by Wilson's score, if `found` of `all` trials succeeded. It is 0
/// to 1 without trials.
[[nodiscard]] Interval95 wilson(std::uint64_t found, std::uint64_t all);

/// JSON of `found`, its rate per million of `all`, and the interval of that rate.
[[nodiscard]] nlohmann::ordered_json share_json(std::uint64_t found, std::uint64_t all);

}  // namespace cde::accuracy
