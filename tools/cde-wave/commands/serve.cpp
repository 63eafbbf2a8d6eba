// SPDX-License-Identifier: Apache-2.0
// cde wave serve: makes a page of a window of waves.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <optional>

#include "cde/support/counted.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/blackouts.hpp"
#include "cde/wave/packed.hpp"
#include "commands/commands.hpp"
#include "commands/wave_page.hpp"
#include "output/streams.hpp"
#include "page/page.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMega = 1'000'000;
/// The uncompressed changes may be this many times as large as the page. A browser must hold them.
constexpr std::uint64_t kMostUnpacked = 12;

std::vector<View> shown_views(const Request& r, Trace& trace) {
  return r.words.empty() ? views(trace, "*", r.default_form()) : views(r, trace, 0);
}

[[noreturn]] void too_large(const Request& r, const std::string& what) {
  throw Error(
      ErrorCode::kUsage,
      fmt::format("{}, but --max is {} MB; name fewer signals, choose a smaller window (--around "
                  "TIME --window N, --from, --to), or use --max 0 for a page of any size",
                  what, r.max));
}

/// The changes of all signals of the page, each signal once.
struct Tracks {
  std::map<std::uint32_t, std::size_t> of;  ///< by handle
  std::vector<Packed> all;
  std::uint64_t bytes = 0, changes = 0;
};

Tracks read_tracks(const Request& r, Trace& trace, const Times& times, const Window& w,
                   const std::vector<View>& shown) {
  Tracks t;
  for (const View& v : shown)
    if (t.of.try_emplace(v.signal.handle, t.all.size()).second)
      t.all.emplace_back(v.signal.width, v.signal.real || v.signal.text);
  std::vector<std::size_t> number(trace.handles() + std::size_t{1});
  std::vector<bool> events(number.size());
  for (const View& v : shown) events[v.signal.handle] = v.signal.event;
  for (const auto& [handle, track] : t.of) number[handle] = track;
  trace.stream(handles(shown), w.from, w.to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 Packed& track = t.all[number[handle]];
                 const std::size_t before = track.bytes();
                 track.add(time - w.from, value);
                 // An event is a pulse of one unit of time, drawn as a mark.
                 if (events[handle] && value == "1" && time < w.to)
                   track.add(time + 1 - w.from, "0");
                 t.bytes += track.bytes() - before;
                 if (r.max != 0 && t.bytes > r.max * kMega * kMostUnpacked)
                   too_large(r, fmt::format("there are more than {} MB of changes even before {}",
                                            r.max * kMostUnpacked, times.text(time)));
                 return true;
               });
  for (const Packed& track : t.all) t.changes += track.changes() - 1;
  return t;
}

/// The rising edges of the clock within the window.
Json clock_json(Times& times, const Window& w, std::string& bytes) {
  const Signal* const clock = times.clock_if_any();
  if (clock == nullptr || clock->width != 1) return nullptr;
  const auto& edges = times.edges();
  const auto first = std::lower_bound(edges.begin(), edges.end(), w.from);
  Packed packed(1, false);
  for (auto edge = first; edge != edges.end() && *edge <= w.to; ++edge)
    packed.add_time(*edge - w.from);
  const Json j = {{"name", printable_name(clock->name)},
                  {"first", first - edges.begin()},
                  {"at", bytes.size()},
                  {"n", packed.changes()}};
  bytes += packed.times();
  return j;
}

Json tracks_json(const std::vector<Packed>& all, const std::vector<View>& shown,
                 const std::map<std::uint32_t, std::size_t>& of, std::string& bytes) {
  std::vector<unsigned> widths(all.size());
  for (const View& v : shown) widths[of.at(v.signal.handle)] = v.signal.width;
  Json list = Json::array();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Packed& p = all[i];
    Json j = {{"w", widths[i]},
              {"n", p.changes()},
              {"at", bytes.size()},
              {"v", bytes.size() + p.times().size()},
              {"p", p.planes()}};
    if (!p.texts().empty()) j["texts"] = p.texts();
    bytes.append(p.times()).append(p.values());
    list.push_back(std::move(j));
  }
  return list;
}

Json views_json(const std::vector<View>& shown, const std::map<std::uint32_t, std::size_t>& of,
                Json& scopes) {
  std::map<std::string, std::size_t> numbers;
  Json list = Json::array();
  for (const View& v : shown) {
    // The last part of a signal's name can contain dots only in the brackets of its index.
    const std::size_t dot = v.signal.name.rfind('.');
    const std::string scope = dot == std::string::npos ? "" : v.signal.name.substr(0, dot);
    const auto [found, is_new] = numbers.try_emplace(scope, scopes.size());
    if (is_new) scopes.push_back(printable_name(scope));
    Json j = {{"name", printable_name(v.label.substr(dot == std::string::npos ? 0 : dot + 1))},
              {"scope", found->second},
              {"track", of.at(v.signal.handle)},
              {"form", form_name(v.form)},
              {"kind", fmt::format("{}{}{}", v.signal.kind, *v.signal.direction != 0 ? " " : "",
                                   v.signal.direction)}};
    if (v.form.kind == Form::Kind::kNames) j["names"] = *v.form.names;
    if (v.signal.ranged) j["range"] = fmt::format("[{}:{}]", v.signal.left, v.signal.right);
    if (v.first != 0 || v.width != v.signal.width) j["bits"] = {v.first, v.width};
    if (v.signal.real || v.signal.text) j["text"] = true;
    list.push_back(std::move(j));
  }
  return list;
}

/// The first place of cursor A: the time of --around, else the failure, else the begin of the
/// window.
std::uint64_t first_cursor(const Request& r, Times& times, const Window& w) {
  std::uint64_t time = w.from;
  if (!r.around.empty()) {
    time = times.parse(r.around);
  } else {
    try {
      time = times.parse("fail");
    } catch (const Error&) {
      // the file has no failure time
    }
  }
  return time < w.from || time > w.to ? w.from : time;
}

Json formats_json() {
  Json list = Json::object();
  for (const NamedFpFormat& f : kFpFormats) list[f.name] = {f.format.exp_bits, f.format.man_bits};
  return list;
}

}  // namespace

int serve(const Request& r) {
  if (r.output.empty())
    throw Error(
        ErrorCode::kUsage,
        "cde wave serve needs the name of the page: cde wave serve FILE --output PAGE.html");
  check_outputs(std::vector<FileUse>{{"--output", r.output}, {"--json", r.json ? "-" : ""}},
                std::vector<FileUse>{{"FILE", r.file}});
  Trace trace(r.file);
  Times times(trace, r.clock);
  warn_if_cut(trace, times);
  const Window w = window(r, trace, times);
  if (w.to - w.from >= std::uint64_t{1} << 52)
    throw Error(ErrorCode::kUsage,
                "the window has 2^52 units of time or more, too many for the scripts of a page; "
                "choose a smaller one (--from, --to)");
  const std::vector<View> shown = shown_views(r, trace);
  const Tracks tracks = read_tracks(r, trace, times, w, shown);
  std::string bytes;
  Json scopes = Json::array();
  Json data = {{"title", printable_name(trace.file().filename().string())},
               {"writer", printable_name(trace.writer())},
               {"date", printable_name(trace.date())},
               {"scale", trace.scale()},
               {"from", fmt::to_string(times.number(
                            w.from))},  // as text, since it may exceed the numbers of scripts
               {"to", fmt::to_string(times.number(w.to))},
               {"cursor", first_cursor(r, times, w) - w.from},
               {"chosen", !r.words.empty()},
               {"formats", formats_json()}};
  data["clock"] = clock_json(times, w, bytes);
  data["dark"] = Json::array();  // $dumpoff
  for (const Blackout& b : blackouts_in(trace, w.from, w.to))
    data["dark"].push_back({b.from - w.from, b.to - w.from});
  data["tracks"] = tracks_json(tracks.all, shown, tracks.of, bytes);
  data["views"] = views_json(shown, tracks.of, scopes);
  data["scopes"] = std::move(scopes);
  add_transactions(data, trace, w, bytes);
  add_sources(data, trace, r.structure, shown, bytes);
  data["size"] = bytes.size();
  const std::string packed = deflated(bytes);
  data["packed"] =
      cli::base64({reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()});
  const std::string page = wave_page(data);
  if (r.max != 0 && page.size() > r.max * kMega)
    too_large(r, fmt::format("the page would have {:.1f} MB, of {} of {}",
                             static_cast<double>(page.size()) / 1e6,
                             counted(tracks.changes, "change"), counted(shown.size(), "signal")));
  write_file(r.output, page);
  if (r.json) {
    Json j = begin_json(r);
    j.update({{"from", times.number(w.from)},
              {"to", times.number(w.to)},
              {"signals", shown.size()},
              {"changes", tracks.changes},
              {"page", r.output},
              {"page_bytes", page.size()}});
    cli::print_json(j);
  } else {
    cli::log("{}: {}, {}, {} to {}, {:.1f} MB\n", printable_name(r.output),
             counted(shown.size(), "signal"), counted(tracks.changes, "change"), times.text(w.from),
             times.text(w.to), static_cast<double>(page.size()) / 1e6);
  }
  return 0;
}

}  // namespace cde::wave
