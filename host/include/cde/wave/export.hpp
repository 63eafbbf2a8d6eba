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

/// @file
/// Writes waves in other formats. Each function writes a complete file or nothing ("-" is stdout).
/// Error kFile if it cannot be written. Without views it writes all signals. Times are in units of
/// the file. A window has the values of signals at `from`, and their changes up to and including
/// `to`. Formats of whole signals (VCD, FST) refuse a view with an index: error kUsage.
namespace cde::wave {

/// VCD as in IEEE 1800, except that texts are values `s...`, as GTKWave reads them. Signal kinds
/// that VCD lacks become wires.
void write_vcd(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file);

/// An FST of the window alone. Names, kinds, directions, ranges, enumerations and comments stay.
/// `comments` are added.
void write_cut(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file, std::span<const std::string> comments = {});

/// A save file of GTKWave, with one group per scope. Forms are those that GTKWave has: fp32 and
/// fp64 as numbers, their lanes as separate signals, other number formats in hexadecimal. Signals
/// whose names GTKWave would read as something else are left out, with a warning on stderr.
struct GtkwOptions {
  std::optional<std::uint64_t> fail = std::nullopt;  ///< position of the marker
  std::filesystem::path waves = {};  ///< wave file to open; empty: the file of the trace
  std::filesystem::path named = {};  ///< name of this file in its text; empty: `file`
  /// Initially visible window.
  std::optional<std::uint64_t> from = std::nullopt, to = std::nullopt;
};
void write_gtkw(Trace& trace, std::span<const View> views, const GtkwOptions& options,
                const std::filesystem::path& file);

/// A CSV table with a header, and fields quoted if necessary. Columns are time, cycle (with a clock
/// only), and one per view. There is a row for `from` and for each time at which a view changes.
/// With `on` there is a row per such edge, with the values just before it. Each row repeats the
/// values of all views, so a small file can make a large table. Error kUsage beyond `most` bytes.
void write_csv(Trace& trace, Times& times, std::span<const View> views,
               const std::optional<Event>& on, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& file, std::uint64_t most = UINT64_MAX);
/// The limit of a table of a whole file.
[[nodiscard]] std::uint64_t most_csv_bytes(const Trace& trace);

/// WaveDrom: one column per clock cycle, with the values at its end; without a clock one column per
/// time of changes. Error kUsage for more than 5000 columns, or for 100 million values.
void write_wavedrom(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
                    std::uint64_t to, const std::filesystem::path& file);

/// An SVG picture, `width` pixels wide. Error kUsage for more than 500 signals.
struct SvgOptions {
  unsigned width = 1200;
  std::optional<std::uint64_t> fail = std::nullopt;  ///< position of a vertical line
};
void write_svg(Trace& trace, Times& times, std::span<const View> views, std::uint64_t from,
               std::uint64_t to, const SvgOptions& options, const std::filesystem::path& file);

/// The time of a comment `fail TIME` in the file, if the file covers it.
[[nodiscard]] std::optional<std::uint64_t> fail_time(Trace& trace, Times& times);

}  // namespace cde::wave
