// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/export_names.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

class Walk {
 public:
  Walk(Trace& trace, const std::vector<bool>& chosen, const NameVisit& visit)
      : trace_(trace), chosen_(chosen), visit_(visit) {}

  void open(ScopeName&& s) { waiting_.push_back(std::move(s)); }
  void close() {
    if (!waiting_.empty())
      waiting_.pop_back();
    else if (visit_.close)
      visit_.close();
  }
  void attribute(Attribute&& a) {
    if (a.type != FST_AT_MISC) return;
    const bool table = a.subtype == FST_MT_ENUMTABLE && !a.name.empty();
    if (a.subtype == FST_MT_COMMENT || a.subtype == FST_MT_ENVVAR || table) {
      if (visit_.attribute) visit_.attribute(a);
    } else if (a.subtype == FST_MT_ENUMTABLE || a.subtype == FST_MT_SUPVAR) {
      pending_.push_back(std::move(a));  // belongs to the next signal
    }
  }
  void signal(const VariableName& v, std::size_t index) {
    const std::vector<Attribute> own = std::exchange(pending_, {});
    if (!chosen_[index]) return;
    for (const ScopeName& s : waiting_)
      if (visit_.open) visit_.open(s);
    waiting_.clear();
    if (visit_.attribute)
      for (const Attribute& a : own) visit_.attribute(a);
    visit_.signal(v, trace_.signals()[index]);
  }

 private:
  Trace& trace_;
  const std::vector<bool>& chosen_;
  const NameVisit& visit_;
  std::vector<ScopeName> waiting_;  ///< enclosing scopes that have no content yet
  std::vector<Attribute> pending_;
};

}  // namespace

void visit_names(Trace& trace, const std::vector<bool>& chosen, const NameVisit& visit) {
  Walk walk(trace, chosen, visit);
  Trace::NestedVisit nested;
  nested.open = [&](ScopeName&& s) { walk.open(std::move(s)); };
  nested.close = [&] { walk.close(); };
  nested.attribute = [&](Attribute&& a) { walk.attribute(std::move(a)); };
  nested.variable = [&](VariableName&& v, std::size_t index) { walk.signal(v, index); };
  trace.nested(nested);
}

std::vector<View> views_or_all(Trace& trace, std::span<const View> views) {
  std::vector<View> all(views.begin(), views.end());
  if (!all.empty()) return all;
  for (const Signal& s : trace.signals()) {
    View& v = all.emplace_back();
    v.signal = s;
    v.label = s.name;
    v.width = s.width;
  }
  return all;
}

std::vector<bool> chosen_signals(Trace& trace, std::span<const View> views,
                                 const std::string& kind) {
  std::set<std::string> names;
  for (const View& v : views) {
    if (v.width != v.signal.width)
      throw Error(ErrorCode::kUsage, fmt::format("{} writes whole signals, not {}; omit the index",
                                                 kind, in_quotes(v.label)));
    names.insert(v.signal.name);
  }
  std::vector<bool> chosen;
  for (const Signal& s : trace.signals()) chosen.push_back(views.empty() || names.contains(s.name));
  return chosen;
}

std::vector<std::uint32_t> chosen_handles(Trace& trace, const std::vector<bool>& chosen) {
  std::vector<std::uint32_t> handles;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) handles.push_back(trace.signals()[i].handle);
  return handles;
}

}  // namespace cde::wave
