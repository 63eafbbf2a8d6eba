// SPDX-License-Identifier: Apache-2.0
// cde wave export: writes waves in other file formats.
#include "cde/wave/export.hpp"
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/suffix.hpp"
#include "cde/wave/scope_views.hpp"
#include "commands/commands.hpp"
#include "options/typed.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

struct Format {
  const char *name, *suffix;
};
constexpr std::array<Format, 6> kFormats = {{{"vcd", ".vcd"},
                                             {"csv", ".csv"},
                                             {"wavedrom", ".json"},
                                             {"svg", ".svg"},
                                             {"fst", ".fst"},
                                             {"gtkw", ".gtkw"}}};

/// The format from --format, else from the name of the file.
std::string format_of(const Request& r, const std::string& output) {
  if (!r.format.empty()) return r.format;
  const std::string suffix = suffix_of(output).text;
  for (const Format& f : kFormats)
    if (suffix == f.suffix) return f.name;
  if (r.output.empty())
    throw Error(ErrorCode::kUsage, "cde wave export needs --output FILE, or --format for stdout");
  wrong_suffix("--output", output,
               ".vcd, .csv, .json, .svg, .fst or .gtkw, or --format must name the format");
}

/// Refuses options that the format does not use.
void check_options(const Request& r, const std::string& format) {
  const auto only = [&](bool given, const char* option, const char* where) {
    if (given && format != where)
      cli::cannot_combine(option, "--format " + format, fmt::format("expected {}", where));
  };
  only(!r.on.empty(), "--on", "csv");
  only(r.columns != 0, "--columns", "svg");
  if (r.form != "auto" && (format == "vcd" || format == "fst"))
    cli::cannot_combine("--as", "--format " + format, "expected csv, wavedrom, svg or gtkw");
}

}  // namespace

int export_waves(const Request& r) {
  const std::string output = r.output.empty() ? "-" : r.output;
  const std::string format = format_of(r, output);
  check_options(r, format);
  if (r.json && output == "-")
    throw Error(ErrorCode::kUsage,
                "--json and the export would both go to stdout; name a file with --output");
  check_outputs(std::vector<FileUse>{{"--output", output}, {"--json", r.json ? "-" : ""}},
                std::vector<FileUse>{{"FILE", r.file}});
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  const Window w = window(r, trace, times);
  std::vector<View> all;
  if (!r.words.empty() || (format != "vcd" && format != "fst"))
    all = views_in_scopes(r, trace, false);
  if (format == "vcd") {
    write_vcd(trace, all, w.from, w.to, output);
  } else if (format == "fst") {
    write_cut(trace, all, w.from, w.to, output);
  } else if (format == "gtkw") {
    write_gtkw(trace, all, {.fail = fail_time(trace, times), .from = w.from, .to = w.to}, output);
  } else if (format == "csv") {
    std::optional<Event> on;
    if (!r.on.empty()) on.emplace(trace, r.on);
    const bool whole = r.words.empty() && r.from.empty() && r.to.empty() && r.around.empty();
    write_csv(trace, times, all, on, w.from, w.to, output,
              whole ? most_csv_bytes(trace) : UINT64_MAX);
  } else if (format == "wavedrom") {
    write_wavedrom(trace, times, all, w.from, w.to, output);
  } else {
    SvgOptions options;
    if (r.columns != 0) options.width = static_cast<unsigned>(r.columns) * 8;
    options.fail = fail_time(trace, times);
    write_svg(trace, times, all, w.from, w.to, options, output);
  }
  const std::size_t count = all.empty() ? trace.signals().size() : all.size();
  if (r.json) {
    nlohmann::ordered_json j = begin_json(r);
    j.update({{"written", output},
              {"written_as", format},
              {"from", times.number(w.from)},
              {"to", times.number(w.to)},
              {"signals", count}});
    cli::print_json(j);
  } else if (output != "-") {
    cli::log("{}: {}, {}, {} to {}\n", printable_name(output), format, counted(count, "signal"),
             times.text(w.from), times.text(w.to));
  }
  return 0;
}

}  // namespace cde::wave
