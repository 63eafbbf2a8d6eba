// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/trace.hpp"
#include "cde/support/text_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/fst_api.hpp"

namespace cde::wave {
namespace {

constexpr std::array<const char*, FST_VT_MAX + 1> kKinds = {
    "event", "integer",  "parameter", "real",  "real parameter", "reg",      "supply0", "supply1",
    "time",  "tri",      "triand",    "trior", "trireg",         "tri0",     "tri1",    "wand",
    "wire",  "wor",      "port",      "array", "realtime",       "text",     "bit",     "logic",
    "int",   "shortint", "longint",   "byte",  "enum",           "shortreal"};
constexpr std::array<const char*, FST_VD_MAX + 1> kDirections = {"",      "input",  "output",
                                                                 "inout", "buffer", "linkage"};

/// Bytes that the full names of all signals may take, besides 64 per byte of the file. Deep scopes
/// with long names would otherwise take a thousand times the file's size.
constexpr std::uint64_t kMostNames = std::uint64_t{256} << 20;

/// Reads "[7:0]" or "[7]" at the end of a name, with or without a space before it.
bool read_range(std::string_view text, Signal& s) {
  if (text.size() < 3 || text.front() != '[' || text.back() != ']') return false;
  const char* at = text.data() + 1;
  const char* const stop = text.data() + text.size() - 1;
  const auto left = std::from_chars(at, stop, s.left);
  if (left.ec != std::errc()) return false;
  if (left.ptr == stop) {
    s.right = s.left;
    return true;
  }
  if (*left.ptr != ':') return false;
  const auto right = std::from_chars(left.ptr + 1, stop, s.right);
  return right.ec == std::errc() && right.ptr == stop;
}

void name_signal(Signal& s, const std::string& scope, std::string_view name) {
  while (name.ends_with(' ')) name.remove_suffix(1);
  // "a [7:0]" is a range. "a[7:0]" is a range if the width matches, else an array element.
  const std::size_t space = name.rfind(" [");
  const std::size_t bracket = space != std::string_view::npos ? space + 1 : name.rfind('[');
  std::string stem(name);
  if (bracket != std::string_view::npos && bracket != 0 && read_range(name.substr(bracket), s)) {
    const auto bits = static_cast<std::uint64_t>(std::abs(std::int64_t{s.left} - s.right)) + 1;
    s.ranged = bits == s.width && (space != std::string_view::npos || bits > 1 ||
                                   name.find(':', bracket) != std::string_view::npos);
    if (s.ranged) stem.resize(bracket);
  }
  while (stem.ends_with(' ')) stem.pop_back();
  // "mem [1]" is an array element.
  for (std::size_t at = 0; (at = stem.find(" [", at)) != std::string::npos;) stem.erase(at, 1);
  if (!s.ranged) {
    s.left = static_cast<int>(s.width) - 1;
    s.right = 0;
  }
  s.name.reserve(scope.size() + stem.size());
  s.name = scope;
  s.name += stem;
}

/// Parses "NAME COUNT name ... bits ...", all escaped; null if it is not such a table.
std::shared_ptr<const Names> table_of(const char* text) {
  const std::unique_ptr<fstETab, void (*)(fstETab*)> table(
      fstUtilityExtractEnumTableFromString(text), fstUtilityFreeEnumTable);
  if (!table) return nullptr;
  auto names = std::make_shared<Names>();
  for (std::uint32_t i = 0; i < table->elem_count; ++i)
    if (table->literal_arr[i] != nullptr && table->val_arr[i] != nullptr) {
      const std::string_view bits = table->val_arr[i];
      if (!bits.empty())
        names->emplace(bits.substr(std::min(bits.find_first_not_of('0'), bits.size() - 1)),
                       table->literal_arr[i]);
    }
  return names;
}

}  // namespace

Trace::Trace(const std::filesystem::path& file) : file_(file), source_(open_source(file)) {}

const std::vector<Signal>& Trace::signals() {
  if (!signals_) read_names();
  return *signals_;
}
unsigned Trace::scopes() {
  (void)signals();
  return scopes_;
}
const std::vector<std::string>& Trace::comments() {
  (void)signals();
  return comments_;
}
std::uint32_t Trace::handles() {
  (void)signals();
  return static_cast<std::uint32_t>(widths_.size() - 1);
}

namespace {

Signal signal_of(const VariableName& v, const std::string& scope) {
  Signal s;
  s.handle = v.handle;
  s.kind = kKinds.at(static_cast<std::size_t>(v.type));
  s.direction = kDirections.at(static_cast<std::size_t>(v.direction));
  s.real = v.type == FST_VT_VCD_REAL || v.type == FST_VT_VCD_REAL_PARAMETER ||
           v.type == FST_VT_VCD_REALTIME || v.type == FST_VT_SV_SHORTREAL;
  s.text = v.type == FST_VT_GEN_STRING;
  s.event = v.type == FST_VT_VCD_EVENT;
  s.is_signed = v.type == FST_VT_VCD_INTEGER || v.type == FST_VT_SV_INT ||
                v.type == FST_VT_SV_SHORTINT || v.type == FST_VT_SV_LONGINT ||
                v.type == FST_VT_SV_BYTE;
  s.width = v.width;
  name_signal(s, scope, v.name);
  return s;
}

/// Whether a signal is the next part of a vector that was written in parts.
bool follows(const Signal& before, const Signal& now, bool down) {
  return before.ranged && now.ranged && !now.event && before.name == now.name &&
         before.kind == std::string_view(now.kind) &&
         std::int64_t{now.left} == std::int64_t{before.right} + (down ? -1 : 1) &&
         (now.left == now.right || (now.left > now.right) == down);
}

}  // namespace

void Trace::read_names() {
  std::vector<Signal> found;
  std::vector<bool> begins;  // by signal: whether it is the first in its scope
  const std::uint32_t handles = source_->facts().handles;
  widths_.assign(handles + std::size_t{1}, 1);
  events_.assign(widths_.size(), false);
  std::string scope;
  std::vector<std::size_t> outer;
  std::map<std::uint64_t, std::shared_ptr<const Names>> tables;
  std::shared_ptr<const Names> names;  // for the next signal
  bool fresh = true;
  const std::uint64_t file_bytes = source_->facts().structure.bytes;
  const std::uint64_t most = kMostNames + 64 * file_bytes;
  std::uint64_t name_bytes = 0;
  SourceVisit visit;
  visit.open = [&](ScopeName&& s) {
    outer.push_back(scope.size());
    while (s.name.ends_with(' ')) s.name.pop_back();
    if (!s.name.empty()) scope.append(s.name).push_back('.');
    ++scopes_;
    fresh = true;
  };
  visit.close = [&] {
    scope.resize(outer.back());
    outer.pop_back();
    fresh = true;
  };
  visit.attribute = [&](Attribute&& a) {
    if (a.type != FST_AT_MISC) return;
    if (a.subtype == FST_MT_COMMENT) {
      comments_.push_back(std::move(a.name));
    } else if (a.subtype == FST_MT_ENUMTABLE) {
      if (!a.name.empty())
        tables[a.argument] = table_of(a.name.c_str());
      else if (const auto known = tables.find(a.argument); known != tables.end())
        names = known->second;
    }
  };
  visit.variable = [&](VariableName&& v) {
    if ((name_bytes += scope.size() + v.name.size()) > most)
      throw Error(ErrorCode::kFile,
                  fmt::format("{}: the full names of the first {} signals have {} bytes together; "
                              "expected at most {} for all signals in a file of {} bytes",
                              printable_name(file_.string()), found.size() + 1, name_bytes, most,
                              file_bytes));
    Signal& s = found.emplace_back(signal_of(v, scope));
    events_[s.handle] = s.event;
    widths_[s.handle] = s.width;
    s.names = std::exchange(names, nullptr);
    begins.push_back(std::exchange(fresh, false));
  };
  source_->names(visit);
  if (found.empty())
    throw Error(ErrorCode::kFile, printable_name(file_.string()) + ": has no signals");
  join_pieces(found, begins);
  number_twins();
}

void Trace::join_pieces(std::vector<Signal>& found, const std::vector<bool>& begins) {
  std::vector<Signal> all;
  all.reserve(found.size());
  for (std::size_t i = 0; i < found.size();) {
    std::size_t end = i + 1;
    bool down = true;
    if (end < found.size() && found[i].ranged && !found[i].event && !found[i].real) {
      down = found[i].left != found[i].right ? found[i].left > found[i].right
                                             : found[end].left < found[i].right;
      while (end < found.size() && !begins[end] && follows(found[end - 1], found[end], down)) ++end;
    }
    signal_of_.insert(signal_of_.end(), end - i, all.size());
    if (end == i + 1) {
      all.push_back(std::move(found[i]));
    } else {
      Signal whole = found[i];
      whole.handle = static_cast<std::uint32_t>(widths_.size());
      whole.right = found[end - 1].right;
      whole.width = 0;
      for (std::size_t k = i; k < end; ++k) {
        pieces_.emplace(found[k].handle, Piece{whole.handle, whole.width});
        parts_[whole.handle].push_back(found[k].handle);
        whole.width += found[k].width;
      }
      widths_.push_back(whole.width);
      events_.push_back(false);
      all.push_back(std::move(whole));
    }
    i = end;
  }
  signals_ = std::move(all);
}

/// Numbers different signals that have the same name.
void Trace::number_twins() {
  TextViewMap<std::size_t> first;
  first.reserve(signals_->size());
  std::map<std::size_t, std::vector<std::size_t>> twins;
  for (std::size_t i = 0; i < signals_->size(); ++i) {
    const auto [known, fresh] = first.emplace((*signals_)[i].name, i);
    if (!fresh && (*signals_)[i].handle != (*signals_)[known->second].handle)
      twins[known->second].push_back(i);
  }
  for (const auto& [leader, others] : twins) {
    (*signals_)[leader].number = 1;
    std::map<std::uint32_t, unsigned> numbers = {{(*signals_)[leader].handle, 1}};
    for (const std::size_t i : others) {
      Signal& s = (*signals_)[i];
      s.number = numbers.emplace(s.handle, numbers.size() + 1).first->second;
      s.name += fmt::format("#{}", s.number);
    }
  }
}

void Trace::nested(const NestedVisit& visit) {
  (void)signals();
  std::size_t next = 0;
  SourceVisit plain;
  plain.open = visit.open;
  plain.close = visit.close;
  plain.attribute = visit.attribute;
  plain.variable = [&](VariableName&& v) {
    const std::size_t index = signal_of_.at(next++);
    if (next > 1 && signal_of_[next - 2] == index) return;
    const Signal& s = (*signals_)[index];
    if (s.handle != v.handle) {
      v.name = fmt::format("{} [{}:{}]", v.name.substr(0, v.name.rfind('[')), s.left, s.right);
      if (const std::size_t blanks = v.name.find("  ["); blanks != std::string::npos)
        v.name.erase(blanks, 1);
      v.width = s.width;
      v.handle = s.handle;
    }
    if (visit.variable) visit.variable(std::move(v), index);
  };
  source_->names(plain);
}

/// Converts the changes of a source into a trace's stream.
class Changes {
 public:
  struct Stop {};  ///< the visitor has enough

  Changes(const Trace& trace, std::span<const std::uint32_t> wanted, std::uint64_t from,
          std::uint64_t to, const Trace::Visit& visit)
      : trace_(trace), from_(from), to_(to), visit_(visit), wanted_(wanted) {
    first_.resize(trace.widths_.size());
    const std::uint32_t own = trace.source_->facts().handles;
    for (const std::uint32_t handle : wanted) {
      if (handle <= own) {
        direct_.resize(trace.widths_.size());
        direct_[handle] = true;
        sources_.push_back(handle);
        continue;
      }
      vectors_.emplace(handle, Vector{std::string(trace.widths_[handle], 'x')});
      for (const std::uint32_t part : trace.parts_.at(handle)) sources_.push_back(part);
    }
    std::sort(sources_.begin(), sources_.end());
    sources_.erase(std::unique(sources_.begin(), sources_.end()), sources_.end());
  }
  /// The file's handles.
  [[nodiscard]] std::span<const std::uint32_t> sources() const { return sources_; }

  void take(std::uint64_t time, std::uint32_t handle, std::string_view value) {
    if (vectors_.empty()) return put(time, handle, value);
    if (time != now_) end_time();
    now_ = time;
    const auto [begin, end] = trace_.pieces_.equal_range(handle);
    for (auto p = begin; p != end; ++p) {
      const auto vector = vectors_.find(p->second.vector);
      if (vector == vectors_.end()) continue;
      vector->second.value.replace(p->second.at, value.size(), value);
      if (!std::exchange(vector->second.changed, true)) changed_.push_back(vector->first);
    }
    if (!direct_.empty() && direct_[handle]) put(time, handle, value);
  }
  void finish() {
    end_time();
    if (!flushed_) flush();
  }

 private:
  void end_time() {
    for (const std::uint32_t handle : std::exchange(changed_, {})) {
      Vector& vector = vectors_.at(handle);
      vector.changed = false;
      put(now_, handle, vector.value);
    }
  }
  void flush() {
    flushed_ = true;
    for (const std::uint32_t handle : wanted_) {
      auto& value = first_[handle];
      if (!value) value = trace_.events_[handle] ? "0" : std::string(trace_.widths_[handle], 'x');
      if (!visit_(from_, handle, *value)) throw Stop();
      value.reset();
    }
  }
  void put(std::uint64_t time, std::uint32_t handle, std::string_view value) {
    if (trace_.events_[handle]) {
      if (time < from_ || value == "0") return;
      value = "1";
    }
    if (time <= from_) {
      first_[handle] = std::string(value);
      return;
    }
    if (!flushed_) flush();
    if (time > to_) throw Stop();
    if (!visit_(time, handle, value)) throw Stop();
  }

  const Trace& trace_;
  std::uint64_t from_, to_;
  const Trace::Visit& visit_;
  std::span<const std::uint32_t> wanted_;
  std::vector<std::uint32_t> sources_;
  struct Vector {
    std::string value;
    bool changed = false;  ///< at now_
  };
  std::vector<bool> direct_;                 ///< by handle: whether it was requested itself
  std::map<std::uint32_t, Vector> vectors_;  ///< written in parts
  std::vector<std::uint32_t> changed_;       ///< vectors changed at now_
  std::uint64_t now_ = 0;
  std::vector<std::optional<std::string>> first_;  ///< by handle: the value at from_
  bool flushed_ = false;
};

void Trace::stream(std::span<const std::uint32_t> wanted, std::uint64_t from, std::uint64_t to,
                   const Visit& visit) {
  (void)signals();
  std::vector<std::uint32_t> once(wanted.begin(), wanted.end());
  std::sort(once.begin(), once.end());
  once.erase(std::unique(once.begin(), once.end()), once.end());
  Changes changes(*this, once, from, to, visit);
  try {
    source_->changes(changes.sources(), from, to,
                     [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                       changes.take(time, handle, value);
                       return true;
                     });
    changes.finish();
  } catch (const Changes::Stop&) {
    // the visitor has enough
  }
}

}  // namespace cde::wave
