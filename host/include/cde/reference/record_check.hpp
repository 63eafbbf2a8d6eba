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

/// Compares each record of the card bit by bit with the reference's when it arrives. Keeps the
/// first difference as data and as text; the text has the command that repeats it.
class RecordCheck {
 public:
  /// The reference's next records in the card's order; empty at the end. Valid until the next call.
  using Source = std::function<std::span<const Record>()>;

  /// How a difference is reported.
  struct ReportOptions {
    std::string noun = "ray";  ///< name of a primary in messages.
    /// Words of a primary and of a secondary in slot order, by their numbers in records; empty if
    /// the number is invalid.
    std::function<std::vector<float>(std::uint32_t primary)> primary = {};
    std::function<std::vector<float>(std::uint32_t index)> secondary = {};
    /// Place of a primary's record in the card: "cycle 12, lane 3, row 1"; may be empty.
    std::function<std::string(std::uint32_t primary)> place = {};
    /// Lines that repeat the difference, after "repeat with: "; may be empty.
    std::function<std::string(const Difference&)> repeat = {};
  };

  RecordCheck(Source source, ReportOptions report)
      : source_(std::move(source)), report_(std::move(report)) {}

  void compare(std::span<const Record> records);
  /// Call it after the last record: a record that the card left out is a difference.
  void compare_end();
  /// Counts two differing records; null: that side has no record.
  void differ(const Record* card, const Record* expected);

  /// Like compare and compare_end, but error kMismatch at the first difference.
  void check(std::span<const Record> records);
  void finish();

  /// Records compared, records equal in every bit, and differences.
  [[nodiscard]] std::uint64_t compared() const { return compared_; }
  [[nodiscard]] std::uint64_t matching() const { return matching_; }
  [[nodiscard]] std::uint64_t mismatches() const { return compared_ - matching_; }
  /// The first difference: both records, differing fields, place, words in hexfloat, and the line
  /// that repeats it. Empty if all records match.
  [[nodiscard]] const std::string& difference() const { return difference_; }
  /// The first difference as data; nothing if all match.
  [[nodiscard]] const std::optional<Difference>& first_difference() const { return first_; }
  /// Sets the function for a primary's place.
  void set_place(std::function<std::string(std::uint32_t)> place) {
    report_.place = std::move(place);
  }

 private:
  [[nodiscard]] std::string text() const;
  Source source_;
  ReportOptions report_;
  std::span<const Record> pending_;
  std::uint64_t compared_ = 0, matching_ = 0;
  std::string difference_;
  std::optional<Difference> first_;
};

}  // namespace cde::reference
