// SPDX-License-Identifier: Apache-2.0
// Writes a save file of GTKWave.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string_view>

#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"

namespace cde::wave {
namespace {

// Flags before a signal in GTKWave's save files, in hexadecimal.
constexpr unsigned kHex = 0x2, kDec = 0x4, kBin = 0x8, kRight = 0x20, kBlank = 0x200,
                   kSigned = 0x400, kReal = 0x40000, kClosed = 0x400000, kGroupBegin = 0x800000,
                   kGroupEnd = 0x1000000;

/// Files with more signals, and signals with more lanes, get closed groups.
constexpr std::size_t kOpenSignals = 60;
constexpr unsigned kOpenLanes = 8;

/// Bits per lane, if the view has several lanes.
unsigned lane_of(const View& v) {
  if (v.form.kind != Form::Kind::kFloat) return v.form.lane < v.width ? v.form.lane : 0;
  const auto own = static_cast<unsigned>(v.form.format.width());
  const unsigned lane = v.form.lane != 0 ? v.form.lane : own;
  return lane < v.width && v.width % lane == 0 ? lane : 0;
}

bool is_real(const View& v, unsigned width) {
  return v.form.kind == Form::Kind::kFloat && ((v.form.format == FpFormat{8, 23} && width == 32) ||
                                               (v.form.format == FpFormat{11, 52} && width == 64));
}

unsigned flags(const View& v, unsigned width) {
  if (v.signal.real || v.signal.text) return kRight;
  if (is_real(v, width)) return kReal | kRight;
  if (width == 1) return kBin | kRight;
  switch (v.form.kind) {
    case Form::Kind::kUnsigned:
      return kDec | kRight;
    case Form::Kind::kSigned:
      return kDec | kSigned | kRight;
    case Form::Kind::kBinary:
      return kBin | kRight;
    default:
      return kHex | kRight;
  }
}

/// The signal's name in GTKWave. A line feed in a name would begin a new line.
std::string name_of(const Signal& s) {
  const std::string name = printable_name(s.name);
  return s.ranged ? s.left == s.right ? fmt::format("{}[{}]", name, s.left)
                                      : fmt::format("{}[{}:{}]", name, s.left, s.right)
                  : name;
}

/// Whether GTKWave reads a line with this name as the name. It takes other first characters for
/// directives, among them `^>` before a program that it starts. It removes the first brace, takes *
/// for a pattern, and ends the name at a blank.
bool is_name(std::string_view name) {
  if (name.empty() || name.find_first_of(" \t*{}") != std::string_view::npos) return false;
  const auto first = static_cast<unsigned char>(name[0]);
  return std::isalnum(first) != 0 || first >= 0x80 || first == '_' || first == '$' || first == '\\';
}

class SaveFile {
 public:
  explicit SaveFile(std::size_t count) : closed_(count > kOpenSignals ? kClosed : 0) {}

  void add(const View& v) {
    if (const std::string name = name_of(v.signal); !is_name(name)) {
      if (left_out_.insert(name).second && left_out_.size() == 1) first_left_out_ = name;
      return;
    }
    const std::size_t dot = v.signal.name.rfind('.');
    const std::string scope = dot == std::string::npos ? "" : v.signal.name.substr(0, dot);
    if (scope != scope_) {
      end();
      if (!scope.empty()) group(kGroupBegin | closed_, scope);
      scope_ = scope;
    }
    const unsigned lane = lane_of(v);
    if (lane == 0) {
      part(v, v.first, v.width, v.label);
      return;
    }
    // Lanes below the whole signal, lowest bits first.
    const unsigned closed = v.width / lane > kOpenLanes ? kClosed : closed_;
    group(kGroupBegin | closed, v.label);
    View whole = v;
    whole.form = Form{};
    part(whole, v.first, v.width, v.label);
    for (unsigned i = 0; i < v.width / lane; ++i)
      part(v, v.first + v.width - lane * (i + 1), lane, fmt::format("{}[{}]", v.label, i));
    group(kGroupEnd | closed, v.label);
  }
  /// The text. Warns of signals that are not in it.
  std::string finish(const std::filesystem::path& path) {
    end();
    if (!left_out_.empty())
      log(
          fmt::format("cde: warning: {} lacks {} whose names GTKWave would not read as names; the "
                      "first is {}\n",
                      path == "-" ? "stdout" : printable_name(path.string()),
                      cde::counted(left_out_.size(), "signal"), in_quotes(first_left_out_)));
    return std::move(text_);
  }

 private:
  void end() {
    if (!scope_.empty()) group(kGroupEnd | closed_, scope_);
    scope_.clear();
  }
  void group(unsigned kind, const std::string& name) {
    text_ += fmt::format("@{:x}\n-{}\n", kind | kBlank, printable_name(name));
  }
  /// Adds some characters of a signal's value.
  void part(const View& v, unsigned first, unsigned width, const std::string& label) {
    text_ += fmt::format("@{:x}\n", flags(v, width));
    const std::string whole = name_of(v.signal);
    if (width == v.signal.width) {
      text_ += whole + "\n";
      return;
    }
    text_ += fmt::format("#{{{}}}", printable_name(label));
    for (unsigned bit = first; bit < first + width; ++bit)
      text_ += fmt::format(" ({}){}", bit, whole);
    text_ += "\n";
  }

  unsigned closed_;
  std::string scope_, text_, first_left_out_;
  std::set<std::string> left_out_;
};

/// Converts a time to GTKWave's units, which are s, ms, us, ns, ps or fs. A time in units of 10 ps
/// becomes ten times as large. The time omits $timezero, because GTKWave adds it for display.
std::uint64_t in_units_of_gtkwave(const Trace& trace, std::uint64_t time) {
  constexpr std::uint64_t kFactors[] = {1, 10, 100};
  const std::uint64_t factor = kFactors[(trace.scale() % 3 + 3) % 3];
  constexpr std::uint64_t kMost = INT64_MAX;
  return time > kMost / factor ? kMost : time * factor;
}

std::string whole_path(const std::filesystem::path& file) {
  std::error_code none;
  const std::filesystem::path whole = std::filesystem::absolute(file, none);
  return printable_name((none ? file : whole.lexically_normal()).string());
}

}  // namespace

void write_gtkw(Trace& trace, std::span<const View> views, const GtkwOptions& options,
                const std::filesystem::path& path) {
  if (options.waves.empty() && trace.file() == "-")
    throw Error(ErrorCode::kUsage,
                "a save file of GTKWave cannot be combined with waves from stdin; name a file");
  std::string text = "[*] Save file of GTKWave, written by cde wave export\n";
  text += fmt::format("[dumpfile] \"{}\"\n",
                      whole_path(options.waves.empty() ? trace.file() : options.waves));
  // If both files have moved, GTKWave finds the waves by the save file's old path.
  if (path != "-")
    text += fmt::format("[savefile] \"{}\"\n",
                        whole_path(options.named.empty() ? path : options.named));
  const auto units = [&](std::uint64_t time) { return in_units_of_gtkwave(trace, time); };
  const std::uint64_t from = units(options.from.value_or(trace.start())),
                      to = units(options.to.value_or(trace.end()));
  text += fmt::format("[timestart] {}\n[size] 1400 800\n[pos] -1 -1\n", from);
  // The zoom, as the power of two of the units per 200 pixels, of which the window has a little
  // over four; the marker; and the marks A to Z.
  const double screen = std::max(1.0, static_cast<double>(to - from) / 4.2);
  text += fmt::format("*{:.6f}", -std::log2(screen));
  for (int mark = 0; mark < 27; ++mark)
    text += options.fail && mark < 2 ? fmt::format(" {}", units(*options.fail)) : " -1";
  text += "\n";
  if (options.fail) text += "[markername] Afail\n";
  text += "[sst_width] 220\n[signals_width] 260\n[sst_expanded] 1\n";
  const std::vector<View> all = views_or_all(trace, views);
  SaveFile save(all.size());
  for (const View& v : all) save.add(v);
  text += save.finish(path) + "[pattern_trace] 1\n[pattern_trace] 0\n";
  write_file(path, text);
}

}  // namespace cde::wave
