// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cde/card/json_keys.hpp"
#include "cde/support/error.hpp"

namespace cde::wave {

using Json = nlohmann::ordered_json;

Form Request::default_form() const {
  return parse_form(form).value_or(Form{});
}

Json begin_json(const Request& r) {
  Json j = {{"schema", "cde.wave." + r.command + ".1"}};
  j.update(program_json());
  j["file"] = r.file;
  return j;
}

std::string Lines::rest() const {
  return more() == 0 ? "" : fmt::format("... {} more (--max 0 prints all)\n", more());
}

std::string without_spaces(std::string_view text) {
  std::string trimmed;
  trimmed.reserve(text.size());
  for (const char c : text) {
    if (c == '\n')
      while (trimmed.ends_with(' ')) trimmed.pop_back();
    trimmed.push_back(c);
  }
  return trimmed;
}

std::vector<View> views(const Request& r, Trace& trace, std::size_t first_word) {
  std::vector<View> all;
  for (std::size_t i = first_word; i < r.words.size(); ++i)
    for (View& v : views(trace, r.words[i], r.default_form())) all.push_back(std::move(v));
  if (all.empty()) throw Error(ErrorCode::kUsage, "a signal is missing: cde wave " + r.command);
  return all;
}

std::vector<std::uint32_t> handles(const std::vector<View>& views) {
  std::vector<std::uint32_t> all;
  for (const View& v : views) all.push_back(v.signal.handle);
  return all;
}

Window window(const Request& r, Trace& trace, Times& times) {
  Window w{trace.start(), trace.end()};
  if (!r.around.empty()) {
    if (!r.from.empty() || !r.to.empty())
      throw Error(ErrorCode::kUsage, "--around cannot be combined with --from or --to");
    const std::uint64_t middle = times.parse(r.around), n = r.window == 0 ? 10 : r.window;
    if (times.clock_if_any() != nullptr && !times.edges().empty()) {
      const auto& edges = times.edges();
      const std::uint64_t c = times.cycle(middle).value_or(0), last = edges.size() - 1;
      if (c > n) w.from = edges[c - n];
      if (last - c > n) w.to = edges[c + n + 1];
    } else {
      w.from = middle - std::min(n, middle - w.from);
      w.to = middle + std::min(n, w.to - middle);
    }
    return w;
  }
  if (r.window != 0) throw Error(ErrorCode::kUsage, "--window needs --around");
  if (!r.from.empty()) w.from = times.parse(r.from);
  if (!r.to.empty()) w.to = times.parse(r.to);
  if (w.from > w.to)
    throw Error(ErrorCode::kUsage,
                fmt::format("--from {} is after --to {}", times.text(w.from), times.text(w.to)));
  return w;
}

}  // namespace cde::wave
