// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>

/// Statistics of errors and of decisions.
namespace cde::accuracy {

/// How large errors are. Each is counted in a bin of a 32nd of an octave, so that counts of parts
/// add up to those of the whole, and a quantile is at most 1/32 too large.
class ErrorCounts {
 public:
  /// `size` is not negative; infinite for an answer that is no number.
  void add(double size);
  void add(const ErrorCounts& other);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// So large is the error of this share at most, 0 to 1; 0 if none was counted.
  [[nodiscard]] double quantile(double share) const;
  /// The largest, exactly.
  [[nodiscard]] double largest() const;

  /// All that was counted, and back. from_json throws what nlohmann::json does.
  [[nodiscard]] nlohmann::ordered_json to_json() const;
  [[nodiscard]] static ErrorCounts from_json(const nlohmann::ordered_json& json);

 private:
  std::uint64_t count_ = 0, zeros_ = 0, infinite_ = 0;
  double largest_ = 0;  ///< of those that are finite
  std::map<int, std::uint64_t> bins_;
};

struct Interval95 {
  double low, high;
};
/// Where the share lies that `found` of `all` were drawn with, by Wilson's score, at 95 %; 0 to 1
/// if there are none.
[[nodiscard]] Interval95 wilson(std::uint64_t found, std::uint64_t all);

/// `found`, how many per million of `all` that is, and the interval of that share.
[[nodiscard]] nlohmann::ordered_json share_json(std::uint64_t found, std::uint64_t all);

}  // namespace cde::accuracy
