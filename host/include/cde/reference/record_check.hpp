// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cde/query/difference.hpp"
#include "cde/query/record.hpp"

namespace cde::reference {

/// Compares each record of the card with the reference's when it arrives, bit by bit.
/// Keeps the first difference, as data and as text; the text has the command that repeats it.
class RecordCheck {
 public:
  /// The reference's next records in the card's order; empty at the end. Valid until the next call.
  using Source = std::function<std::span<const Record>()>;

  /// How a difference is told.
  struct Told {
    std::string noun = "ray";  ///< a primary in messages
    /// Words of a primary and of a secondary in slot order, by the numbers that records have; empty
    /// if there is none of that number.
    std::function<std::vector<float>(std::uint32_t primary)> primary = {};
    std::function<std::vector<float>(std::uint32_t index)> secondary = {};
    /// Where a primary's record is in the card: "clock 12, lane 3, row 1"; may be empty.
    std::function<std::string(std::uint32_t primary)> place = {};
    /// Lines that repeat the difference, behind "repeat with: "; may be empty.
    std::function<std::string(const Difference&)> repeat = {};
  };

  RecordCheck(Source source, Told told) : source_(std::move(source)), told_(std::move(told)) {}

  void compare(std::span<const Record> records);
  /// Call it behind the last record: a record that the card left out differs.
  void compare_end();
  /// Counts two records that differ; null: that side has none.
  void differ(const Record* card, const Record* expected);

  /// The same as compare and compare_end, but error kMismatch at the first difference.
  void check(std::span<const Record> records);
  void finish();

  /// Records compared, records equal in every bit, and differences.
  [[nodiscard]] std::uint64_t compared() const { return compared_; }
  [[nodiscard]] std::uint64_t matching() const { return matching_; }
  [[nodiscard]] std::uint64_t mismatches() const { return compared_ - matching_; }
  /// The first difference: both records, fields that differ, place, words in hexfloat, and the line
  /// that repeats it; empty if all records match.
  [[nodiscard]] const std::string& difference() const { return difference_; }
  /// The same as data; nothing if all match.
  [[nodiscard]] const std::optional<Difference>& first_difference() const { return first_; }
  /// Tells the place of a primary from here on.
  void place_by(std::function<std::string(std::uint32_t)> place) { told_.place = std::move(place); }

 private:
  [[nodiscard]] std::string text() const;
  Source source_;
  Told told_;
  std::span<const Record> pending_;
  std::uint64_t compared_ = 0, matching_ = 0;
  std::string difference_;
  std::optional<Difference> first_;
};

}  // namespace cde::reference
