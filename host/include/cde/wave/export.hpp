// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "cde/wave/event.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

/// Waves as other kinds of files. Each of these writes all of the file or nothing ("-" is stdout);
/// Error kFile if it cannot be written. No views are all signals of the file. Times are those of
/// the file, in its units; a window has what signals are at `from`, and their changes up to and
/// with `to`. What is left out of the signals of `views` in formats of whole signals (VCD, FST) is
/// an index; that is Error kUsage.
namespace cde::wave {

/// VCD as IEEE 1800 has it, but that texts are values `s...`, as GTKWave reads them. Kinds of
/// signals that it has not are wires.
void write_vcd(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file);

/// An FST of the window alone: names, kinds, directions, ranges, enumerations and comments stay; of
/// `comments` it has one more each.
void write_cut(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file, std::span<const std::string> comments = {});

/// A save file of GTKWave: one group per scope, forms as GTKWave has them (fp32 and fp64 as
/// numbers, lanes of them as signals of their own; other formats of numbers in hexadecimal).
struct GtkwOptions {
  std::optional<std::uint64_t> fail = std::nullopt;  ///< where the marker stands
  std::filesystem::path waves = {};  ///< that it opens; empty: the file of the trace
  std::optional<std::uint64_t> from = std::nullopt, to = std::nullopt;  ///< what is seen first
};
void write_gtkw(Trace& trace, std::span<const View> views, const GtkwOptions& options,
                const std::filesystem::path& file);

/// A table with a header, fields in quotes where they must be: time, cycle if there is a clock, and
/// one column per view. A row for each time at which one of them changes, the first for `from`;
/// with `on` a row for each such edge, of the values just before it.
void write_csv(Trace& trace, Times& times, std::span<const View> views,
               const std::optional<Event>& on, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file);

/// WaveDrom: one column per cycle of the clock, with the values that there are at its end; without
/// a clock one column per time of changes. Error kUsage for more than 5000 columns.
void write_wavedrom(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
                    std::uint64_t to, const std::filesystem::path& file);

/// A picture, `width` pixels wide. Error kUsage for more than 500 signals.
struct SvgOptions {
  unsigned width = 1200;
  std::optional<std::uint64_t> fail = std::nullopt;  ///< where a line is
};
void write_svg(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
               std::uint64_t to, const SvgOptions& options, const std::filesystem::path& file);

/// The time in a comment `fail TIME` of a file, if it lies in it.
[[nodiscard]] std::optional<std::uint64_t> fail_time(Trace& trace, Times& times);

}  // namespace cde::wave
