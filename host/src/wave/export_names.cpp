// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/export_names.hpp"

#include <fmt/format.h>

#include <memory>
#include <set>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde::wave {
namespace {

[[noreturn]] void corrupt(const Trace& trace) {
  throw Error(ErrorCode::kFile, printable_name(trace.file().string()) +
                                    ": is corrupt: Verilator's reader of FST cannot make sense of "
                                    "its names");
}

std::string text(const char* s) {
  return s == nullptr ? "" : s;
}

class Walk {
 public:
  Walk(Trace& trace, const std::vector<bool>& chosen, const NameVisit& visit)
      : trace_(trace), chosen_(chosen), visit_(visit) {}

  void take(const fstHier& h) {
    switch (h.htyp) {
      case FST_HT_SCOPE:
        waiting_.push_back({h.u.scope.typ, text(h.u.scope.name), text(h.u.scope.component)});
        break;
      case FST_HT_UPSCOPE:
        up();
        break;
      case FST_HT_ATTRBEGIN:
        if (h.u.attr.typ == FST_AT_MISC) attribute(h);
        break;
      case FST_HT_VAR:
        signal(h);
        break;
      default:
        break;
    }
  }

 private:
  void up() {
    if (!waiting_.empty()) {
      waiting_.pop_back();
    } else {
      if (open_ == 0) corrupt(trace_);
      --open_;
      if (visit_.close) visit_.close();
    }
  }
  void attribute(const fstHier& h) {
    Attribute a{h.u.attr.typ, h.u.attr.subtype, text(h.u.attr.name), h.u.attr.arg};
    const bool table = a.subtype == FST_MT_ENUMTABLE && !a.name.empty();
    if (a.subtype == FST_MT_COMMENT || a.subtype == FST_MT_ENVVAR || table) {
      if (visit_.attribute) visit_.attribute(a);
    } else if (a.subtype == FST_MT_ENUMTABLE || a.subtype == FST_MT_SUPVAR) {
      pending_.push_back(std::move(a));  // of the signal that follows
    }
  }
  void signal(const fstHier& h) {
    if (next_ >= chosen_.size()) corrupt(trace_);
    const std::size_t index = next_++;
    const std::vector<Attribute> own = std::exchange(pending_, {});
    if (!chosen_[index]) return;
    for (const ScopeName& s : waiting_)
      if (visit_.open) visit_.open(s);
    open_ += waiting_.size();
    waiting_.clear();
    if (visit_.attribute)
      for (const Attribute& a : own) visit_.attribute(a);
    visit_.signal(h, trace_.signals()[index]);
  }

  Trace& trace_;
  const std::vector<bool>& chosen_;
  const NameVisit& visit_;
  std::vector<ScopeName> waiting_;  ///< scopes around this place that nothing was in yet
  std::vector<Attribute> pending_;
  std::size_t next_ = 0, open_ = 0;
};

}  // namespace

void visit_names(Trace& trace, const std::vector<bool>& chosen, const NameVisit& visit) {
  Walk walk(trace, chosen, visit);
  try {
    const std::unique_ptr<void, void (*)(void*)> reader(fstReaderOpen(trace.file().c_str()),
                                                        fstReaderClose);
    if (!reader) corrupt(trace);
    while (const fstHier* const h = fstReaderIterateHier(reader.get())) walk.take(*h);
  } catch (const ReaderFailed&) {
    corrupt(trace);
  }
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
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} has whole signals, not {}; leave out the index", kind,
                              in_quotes(v.label)));
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
