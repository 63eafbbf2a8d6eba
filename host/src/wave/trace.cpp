// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/trace.hpp"

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

/// "[7:0]" or "[7]" at the end of a name, with or without a space before it.
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
  // "a [7:0]" is a range; "a[7:0]" is one if it has the width, else an element of an array.
  const std::size_t space = name.find(" [");
  const std::size_t bracket = space != std::string_view::npos ? space + 1 : name.rfind('[');
  std::string_view stem = name.substr(0, space);
  if (bracket != std::string_view::npos && bracket != 0 && read_range(name.substr(bracket), s)) {
    const auto bits = static_cast<std::uint64_t>(std::abs(std::int64_t{s.left} - s.right)) + 1;
    s.ranged = bits == s.width && (space != std::string_view::npos || bits > 1);
    if (s.ranged) stem = name.substr(0, bracket);
  }
  while (stem.ends_with(' ')) stem.remove_suffix(1);
  if (!s.ranged) {
    s.left = static_cast<int>(s.width) - 1;
    s.right = 0;
  }
  s.name.reserve(scope.size() + stem.size());
  s.name = scope;
  s.name += stem;
}

struct Stop {};  ///< ends Verilator's reader from within

/// "NAME COUNT name ... bits ...", all escaped; null if it is none.
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

Trace::Trace(const std::filesystem::path& file)
    : file_(file), structure_(check_structure(file)), reader_(nullptr, fstReaderClose) {
  try {
    reader_.reset(fstReaderOpen(file.c_str()));
  } catch (const ReaderFailed&) {
    corrupt();
  }
  if (!reader_) corrupt();
}

void Trace::corrupt() const {
  throw Error(ErrorCode::kFile,
              printable_name(file_.string()) +
                  ": is corrupt: Verilator's reader of FST cannot make sense of it");
}

int Trace::scale() const {
  return fstReaderGetTimescale(reader_.get());
}
std::uint64_t Trace::start() const {
  return fstReaderGetStartTime(reader_.get());
}
std::uint64_t Trace::end() const {
  return fstReaderGetEndTime(reader_.get());
}
std::string Trace::writer() const {
  return fstReaderGetVersionString(reader_.get());
}
std::string Trace::date() const {
  std::string text = fstReaderGetDateString(reader_.get());
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}
std::uint32_t Trace::handles() const {
  return fstReaderGetMaxHandle(reader_.get());
}

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

void Trace::read_names() {
  std::vector<Signal> found;
  found.reserve(std::min<std::uint64_t>(fstReaderGetVarCount(reader_.get()), 1u << 20));
  widths_.assign(handles() + std::size_t{1}, 1);
  events_.assign(widths_.size(), false);
  std::string scope;
  std::vector<std::size_t> outer;
  std::map<std::uint64_t, std::shared_ptr<const Names>> tables;
  std::shared_ptr<const Names> names;  // of the next signal
  try {
    while (const fstHier* const h = fstReaderIterateHier(reader_.get())) {
      if (h->htyp == FST_HT_SCOPE) {
        outer.push_back(scope.size());
        scope.append(h->u.scope.name).push_back('.');
        ++scopes_;
      } else if (h->htyp == FST_HT_UPSCOPE) {
        if (outer.empty()) corrupt();
        scope.resize(outer.back());
        outer.pop_back();
      } else if (h->htyp == FST_HT_ATTRBEGIN && h->u.attr.typ == FST_AT_MISC &&
                 h->u.attr.subtype == FST_MT_COMMENT) {
        comments_.emplace_back(h->u.attr.name);
      } else if (h->htyp == FST_HT_ATTRBEGIN && h->u.attr.typ == FST_AT_MISC &&
                 h->u.attr.subtype == FST_MT_ENUMTABLE) {
        if (h->u.attr.name_length != 0)
          tables[h->u.attr.arg] = table_of(h->u.attr.name);
        else if (const auto known = tables.find(h->u.attr.arg); known != tables.end())
          names = known->second;
      }
      if (h->htyp != FST_HT_VAR) continue;
      const auto& v = h->u.var;
      if (v.handle == 0 || v.handle > handles() || v.typ > FST_VT_MAX || v.direction > FST_VD_MAX)
        corrupt();
      Signal& s = found.emplace_back();
      s.handle = v.handle;
      s.kind = kKinds[v.typ];
      s.direction = kDirections[v.direction];
      s.real = v.typ == FST_VT_VCD_REAL || v.typ == FST_VT_VCD_REAL_PARAMETER ||
               v.typ == FST_VT_VCD_REALTIME || v.typ == FST_VT_SV_SHORTREAL;
      s.text = v.typ == FST_VT_GEN_STRING;
      s.event = v.typ == FST_VT_VCD_EVENT;
      s.is_signed = v.typ == FST_VT_VCD_INTEGER || v.typ == FST_VT_SV_INT ||
                    v.typ == FST_VT_SV_SHORTINT || v.typ == FST_VT_SV_LONGINT ||
                    v.typ == FST_VT_SV_BYTE;
      events_[s.handle] = s.event;
      s.width = s.real ? 64 : v.length;
      s.names = std::exchange(names, nullptr);
      widths_[s.handle] = s.width;
      name_signal(s, scope, {v.name, v.name_length});
    }
  } catch (const ReaderFailed&) {
    corrupt();
  }
  if (found.empty()) corrupt();
  signals_ = std::move(found);
}

namespace {

/// What Verilator's reader calls for each change.
struct Receiver {
  std::uint64_t from, to;
  const Trace::Visit& visit;
  std::span<const std::uint32_t> handles;
  const std::vector<unsigned>& widths;
  const std::vector<bool>& events;
  std::vector<std::optional<std::string>> first;  ///< of each handle, up to `from`
  bool flushed = false;

  void flush() {
    flushed = true;
    for (const std::uint32_t handle : handles) {
      auto& value = first[handle];
      if (!value) value = events[handle] ? "0" : std::string(widths[handle], 'x');
      if (!visit(from, handle, *value)) throw Stop();
      value.reset();
    }
  }
  void take(std::uint64_t time, std::uint32_t handle, std::string_view value) {
    if (events[handle]) {
      if (time < from) return;
      value = "1";
    }
    if (time <= from) {
      first[handle] = std::string(value);
      return;
    }
    if (!flushed) flush();
    if (time > to) throw Stop();
    if (!visit(time, handle, value)) throw Stop();
  }
};

void on_change(void* to, std::uint64_t time, fstHandle handle, const unsigned char* value) {
  static_cast<Receiver*>(to)->take(time, handle, reinterpret_cast<const char*>(value));
}
void on_text(void* to, std::uint64_t time, fstHandle handle, const unsigned char* value,
             std::uint32_t length) {
  static_cast<Receiver*>(to)->take(time, handle, {reinterpret_cast<const char*>(value), length});
}

}  // namespace

void Trace::stream(std::span<const std::uint32_t> wanted, std::uint64_t from, std::uint64_t to,
                   const Visit& visit) {
  (void)signals();
  std::vector<std::uint32_t> once(wanted.begin(), wanted.end());
  std::sort(once.begin(), once.end());
  once.erase(std::unique(once.begin(), once.end()), once.end());
  fstReaderClrFacProcessMaskAll(reader_.get());
  for (const std::uint32_t handle : once) fstReaderSetFacProcessMask(reader_.get(), handle);
  // The reader begins with the values that signals have where the first block begins that it does
  // not skip; the block that ends before `from` has them if `from` is between two.
  std::uint64_t first = from;
  for (const Section& s : structure_.sections)
    if (s.begin <= from) first = std::min(from, s.end);
  fstReaderSetLimitTimeRange(reader_.get(), first, to);
  Receiver receiver{from, to, visit, once, widths_, events_, {}, false};
  receiver.first.resize(handles() + std::size_t{1});
  try {
    fstReaderIterBlocks2(reader_.get(), on_change, on_text, &receiver, nullptr);
    if (!receiver.flushed) receiver.flush();
  } catch (const Stop&) {
    // enough
  } catch (const ReaderFailed&) {
    corrupt();
  }
}

}  // namespace cde::wave
