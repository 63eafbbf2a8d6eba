// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Converts times of a file to text and back.
class Times {
 public:
  /// `clock` is the signal whose rising edges are cycles. If it is empty, the signal that looks
  /// like a clock is used.
  Times(Trace& trace, std::string clock) : trace_(trace), clock_(std::move(clock)) {}

  /// "12.5ns", exact. It counts from the file's time zero and may be negative.
  [[nodiscard]] std::string text(std::uint64_t time) const;
  /// The same in units of the file, for programs.
  [[nodiscard]] std::int64_t number(std::uint64_t time) const;
  /// A duration as text.
  [[nodiscard]] std::string span(std::uint64_t length) const;
  /// A number with an optional unit, in units of the file; nothing if the text is invalid.
  [[nodiscard]] std::optional<double> length(const std::string& text) const;
  /// Parses a time: a number in units of the file or with fs, ps, ns, us, ms or s. Other forms are
  /// `cyc:N` (rising edge N of the clock, from 0), `start` and `end`. If the file has a comment
  /// `fail TIME`, `fail` is that time. An offset +N or -N with a unit or cyc may follow. Numbers
  /// count from the file's time zero and may be negative. Error kUsage for other texts and for
  /// times outside the file.
  [[nodiscard]] std::uint64_t parse(const std::string& text);
  /// The signal that counts cycles. Error kUsage if none was named and no signal looks like a
  /// clock.
  [[nodiscard]] const Signal& clock();
  /// The same without an error.
  [[nodiscard]] const Signal* clock_if_any();
  /// Its rising edges.
  [[nodiscard]] const std::vector<std::uint64_t>& edges();
  /// The cycle of a time: the number of its last edge. Nothing before the first edge.
  [[nodiscard]] std::optional<std::uint64_t> cycle(std::uint64_t time);

 private:
  [[nodiscard]] std::uint64_t from_zero(bool negative, std::uint64_t magnitude,
                                        const std::string& whole) const;
  [[noreturn]] void outside(const std::string& whole) const;
  [[nodiscard]] std::uint64_t base(const std::string& text, const std::string& whole);
  [[nodiscard]] std::uint64_t edge(std::uint64_t number, const std::string& whole);

  Trace& trace_;
  std::string clock_;
  std::optional<std::vector<std::uint64_t>> edges_;
};

/// Warns on stderr, if the file is not closed, where it ends and which changes are missing.
void warn_if_cut(const Trace& trace, const Times& times);

}  // namespace cde::wave
