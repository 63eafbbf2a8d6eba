// SPDX-License-Identifier: Apache-2.0
// cde wave serve: transactions above the signals, and source lines beside them.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cde/support/message.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/transaction.hpp"
#include "commands/wave_page.hpp"
#include "output/streams.hpp"

namespace cde::wave {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kAround = 2;         ///< lines before and after a place
constexpr std::size_t kMostPlaces = 4;  ///< places per signal

/// Puts JSON among the packed bytes, because names and labels repeat and compress well.
Json put(const Json& json, std::string& bytes) {
  const std::string text = json_text(json, -1);
  Json part = {{"at", bytes.size()}, {"n", text.size()}};
  bytes += text;
  return part;
}

/// The source places of a signal on the page, as [file, line, kind].
class Places {
 public:
  explicit Places(const Design& design) : design_(design) {}

  [[nodiscard]] Json of(std::string_view name) {
    const auto places = design_.places_of(name);
    Json list = Json::array();
    if (!places) return list;
    std::set<std::pair<std::string, unsigned>> seen;
    const auto add = [&](const Place& place, const char* what) {
      if (list.size() == kMostPlaces || place.file.empty() ||
          !seen.emplace(place.file, place.line).second)
        return;
      const auto& lines = design_.source(place.file);
      if (place.line == 0 || place.line > lines.size()) return;
      list.push_back({number(place.file), place.line, what});
      auto& kept = lines_[place.file];
      const std::size_t first = place.line - std::min(place.line - 1, kAround);
      for (std::size_t k = first; k <= place.line + kAround && k <= lines.size(); ++k)
        kept[k] = printable(lines[k - 1]);
    };
    add(places->declaration, "declared");
    for (const Place& driver : places->drivers) add(driver, "driven");
    return list;
  }
  [[nodiscard]] Json files() const {
    Json list = Json::array();
    for (const std::string& file : files_) {
      Json lines = Json::object();
      for (const auto& [line, text] : lines_.at(file)) lines[std::to_string(line)] = text;
      list.push_back({{"name", printable_name(file.substr(file.rfind('/') + 1))},
                      {"lines", std::move(lines)}});
    }
    return list;
  }

 private:
  std::size_t number(const std::string& file) {
    const auto found = std::find(files_.begin(), files_.end(), file);
    if (found != files_.end()) return static_cast<std::size_t>(found - files_.begin());
    files_.push_back(file);
    return files_.size() - 1;
  }

  const Design& design_;
  std::vector<std::string> files_;
  std::map<std::string, std::map<std::size_t, std::string>> lines_;
};

}  // namespace

void add_transactions(Json& data, Trace& trace, const Window& w, std::string& bytes) {
  Json list = Json::array();
  for (const Transaction& t : transactions(trace, {}, w.from, w.to)) {
    Json fields = Json::array();
    for (const auto& [key, value] : t.fields)
      fields.push_back({printable_name(key), printable_name(value)});
    // Times count from the begin of the window. A transaction that began before it has begin -1.
    const bool before = t.begin < w.from;
    list.push_back({{"kind", t.kind},
                    {"label", printable_name(t.label)},
                    {"scope", printable_name(t.scope)},
                    {"begin", before ? -1 : static_cast<std::int64_t>(t.begin - w.from)},
                    {"end", std::min(t.end, w.to) - std::min(w.from, t.end)},
                    {"stalls", t.stalls ? Json(*t.stalls) : Json()},
                    {"outcome", printable_name(t.outcome)},
                    {"fields", std::move(fields)}});
  }
  if (!list.empty()) data["transactions"] = put(list, bytes);
}

void add_sources(Json& data, Trace& trace, const std::string& structure,
                 const std::vector<View>& shown, std::string& bytes) {
  const auto design = Design::if_known(trace, structure);
  if (!design) return;
  Places places(*design);
  std::map<std::string, Json> known;  // several views may show one signal
  Json of = Json::array();
  bool any = false;
  for (const View& v : shown) {
    const auto [found, is_new] = known.try_emplace(v.signal.name);
    if (is_new) found->second = places.of(v.signal.name);
    any = any || !found->second.empty();
    of.push_back(found->second);
  }
  if (any) data["sources"] = put({{"of", of}, {"files", places.files()}}, bytes);
}

}  // namespace cde::wave
