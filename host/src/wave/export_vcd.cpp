// SPDX-License-Identifier: Apache-2.0
// Writes waves as VCD.
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/blackouts.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"
#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

/// A short name of a signal: base-94 digits of printable characters.
std::string code(std::uint32_t handle) {
  std::string text;
  for (std::uint32_t rest = handle; rest != 0; rest = (rest - 1) / 94)
    text.push_back(static_cast<char>('!' + (rest - 1) % 94));
  return text;
}

std::string scope_type(int type) {
  switch (type) {
    case FST_ST_VCD_TASK:
      return "task";
    case FST_ST_VCD_FUNCTION:
      return "function";
    case FST_ST_VCD_BEGIN:
    case FST_ST_VCD_GENERATE:
      return "begin";
    case FST_ST_VCD_FORK:
      return "fork";
    default:
      return "module";
  }
}

std::string signal_type(const Signal& s) {
  static constexpr std::string_view kOwn[] = {
      "event", "integer", "parameter", "real",   "realtime", "reg",  "supply0", "supply1", "time",
      "tri",   "triand",  "trior",     "trireg", "tri0",     "tri1", "wand",    "wire",    "wor"};
  if (s.text) return "string";
  if (std::find(std::begin(kOwn), std::end(kOwn), s.kind) != std::end(kOwn)) return s.kind;
  return s.real ? "real" : "wire";
}

/// Replaces spaces: VCD allows only the space before a range. Other characters that would control a
/// terminal are escaped.
std::string one_word(std::string_view text) {
  std::string word(text);
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  return word.empty() ? "_" : printable_name(word);
}
std::string reference(const VariableName& v) {
  const std::string_view name = v.name;
  const std::size_t range = name.rfind(" [");
  if (range == std::string_view::npos || range == 0) return one_word(name);
  return one_word(name.substr(0, range)) + " " + one_word(name.substr(range + 1));
}

/// A printable text. Replaces $end, which would end a section of VCD.
std::string inside(std::string_view of_file) {
  std::string text = printable(of_file);
  for (std::size_t at = 0; (at = text.find("$end", at)) != std::string::npos;) text[at] = '_';
  return text;
}

std::string timescale(const Trace& trace) {
  constexpr const char* kUnits[] = {"s", "ms", "us", "ns", "ps", "fs"};
  const int scale = trace.scale();
  if (scale > 2 || scale < -15)
    throw Error(ErrorCode::kUsage, fmt::format("VCD has no times in units of 1e{} s", scale));
  const int unit = scale >= 0 ? 0 : (2 - scale) / 3;
  constexpr int kPowers[] = {1, 10, 100};
  return fmt::format("{} {}", kPowers[scale + 3 * unit], kUnits[unit]);
}

class VcdText {
 public:
  VcdText(Trace& trace, OutputFile& file)
      : file_(file),
        kinds_(trace.handles() + std::size_t{1}, 'b'),
        codes_(trace.handles() + std::size_t{1}) {
    for (std::uint32_t h = 1; h < codes_.size(); ++h) codes_[h] = code(h) + "\n";
    for (const Signal& s : trace.signals())
      kinds_[s.handle] = s.event ? 'e' : s.text ? 's' : s.real ? 'r' : s.width == 1 ? '1' : 'b';
  }
  [[nodiscard]] bool is_event(std::uint32_t handle) const { return kinds_[handle] == 'e'; }
  void put(std::string_view text) {
    text_.append(text);
    if (text_.size() > 1u << 20) flush();
  }
  void flush() {
    file_.write(text_);
    text_.clear();
  }
  void change(std::uint32_t handle, std::string_view value) {
    switch (kinds_[handle]) {
      case 's': {
        std::string escaped(value.size() * 4 + 1, '\0');
        std::string copy(value);
        const int bytes = fstUtilityBinToEsc(reinterpret_cast<unsigned char*>(escaped.data()),
                                             reinterpret_cast<unsigned char*>(copy.data()),
                                             static_cast<int>(copy.size()));
        escaped.resize(static_cast<std::size_t>(bytes));
        put_all({"s", escaped, " ", codes_[handle]});
        break;
      }
      case 'r':
        if (!value.starts_with('x')) put_all({"r", value, " ", codes_[handle]});
        break;
      case 'e':
        if (value == "1") put_all({value, codes_[handle]});
        break;
      case '1':
        put_all({value, codes_[handle]});
        break;
      default: {
        // Readers extend 0 and 1 with 0, and x and z with themselves. They do not extend other
        // states.
        std::size_t first = 0;
        const auto fills = [](char c) { return c == '0' || c == 'x' || c == 'z'; };
        while (first + 1 < value.size() && value[first] == value[first + 1] && fills(value[first]))
          ++first;
        if (value[first] == '0' && first + 1 < value.size() && value[first + 1] == '1') ++first;
        put_all({"b", value.substr(first), " ", codes_[handle]});
      }
    }
  }

 private:
  void put_all(std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts) text_.append(part);
    put("");
  }

  OutputFile& file_;
  std::vector<char> kinds_;
  std::vector<std::string> codes_;  ///< each with its line end
  std::string text_;
};

void put_header(Trace& trace, const std::vector<bool>& chosen, VcdText& vcd) {
  vcd.put(fmt::format("$date\n  {}\n$end\n$version\n  cde wave export, of waves by {}\n$end\n",
                      inside(trace.date()), inside(trace.writer())));
  vcd.put(fmt::format("$timescale {} $end\n", timescale(trace)));
  if (trace.time_zero() != 0) vcd.put(fmt::format("$timezero {} $end\n", trace.time_zero()));
  NameVisit names;
  names.open = [&](const ScopeName& s) {
    vcd.put(fmt::format("$scope {} {} $end\n", scope_type(s.type), one_word(s.name)));
  };
  names.close = [&] { vcd.put("$upscope $end\n"); };
  names.signal = [&](const VariableName& v, const Signal& s) {
    vcd.put(fmt::format("$var {} {} {} {} $end\n", signal_type(s), s.text ? 1u : s.width,
                        code(s.handle), reference(v)));
  };
  names.attribute = [&](const Attribute& a) {
    if (a.subtype == FST_MT_COMMENT) vcd.put(fmt::format("$comment {} $end\n", inside(a.name)));
  };
  visit_names(trace, chosen, names);
  vcd.put("$enddefinitions $end\n");
}

}  // namespace

void write_vcd(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& path) {
  const std::vector<bool> chosen = chosen_signals(trace, views, "VCD");
  OutputFile file(path);
  VcdText vcd(trace, file);
  put_header(trace, chosen, vcd);
  vcd.put(fmt::format("#{}\n$dumpvars\n", from));
  std::uint64_t now = from;
  bool section = true;  // in $dumpvars and similar sections, until time advances
  const auto end_section = [&] {
    if (section) vcd.put("$end\n");
    section = false;
  };
  // A mark of an event within $dumpvars is a dump of its value and triggers nothing.
  std::vector<std::uint32_t> triggered;
  const auto trigger = [&] {
    if (triggered.empty()) return;
    end_section();
    for (const std::uint32_t handle : triggered) vcd.change(handle, "1");
    triggered.clear();
  };
  BlackoutsIn off(trace, from, to);
  const auto go_to = [&](std::uint64_t time) {
    end_section();
    if (time != now) vcd.put(fmt::format("#{}\n", time));
    now = time;
  };
  const auto advance = [&](std::uint64_t time) {
    off.until(time, [&](std::uint64_t turn, bool on) {
      go_to(turn);
      vcd.put(on ? "$dumpon\n" : "$dumpoff\n");
      section = true;
    });
    if (time != now) go_to(time);
  };
  trace.stream(chosen_handles(trace, chosen), from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) {
                   trigger();
                   advance(time);
                 }
                 if (section && vcd.is_event(handle) && value == "1")
                   triggered.push_back(handle);
                 else
                   vcd.change(handle, value);
                 return true;
               });
  trigger();
  advance(to);
  end_section();
  vcd.flush();
  file.commit();
}

}  // namespace cde::wave
