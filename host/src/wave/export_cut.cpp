// SPDX-License-Identifier: Apache-2.0
// Writes a window of waves as a new FST file.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/blackouts.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"
#include "cde/wave/fst_api.hpp"
#include "wave/port_states.hpp"

namespace cde::wave {
namespace {

using Fst = std::unique_ptr<void, void (*)(void*)>;

[[noreturn]] void cannot_write(const std::filesystem::path& path) {
  throw Error(ErrorCode::kFile, fmt::format("{}: cannot be written completely; is the disk full?",
                                            printable_name(path.string())));
}

/// Writes the names, escaped as in other exports, and returns the new handles.
std::vector<fstHandle> copy_names(Trace& trace, const std::vector<bool>& chosen, void* to) {
  std::vector<fstHandle> handles(trace.handles() + std::size_t{1}, 0);
  NameVisit names;
  names.open = [&](const ScopeName& s) {
    fstWriterSetScope(to, static_cast<fstScopeType>(s.type), printable_name(s.name).c_str(),
                      s.component.empty() ? nullptr : printable_name(s.component).c_str());
  };
  names.close = [&] { fstWriterSetUpscope(to); };
  names.attribute = [&](const Attribute& a) {
    fstWriterSetAttrBegin(to, static_cast<fstAttrType>(a.type), a.subtype,
                          printable(a.name).c_str(), a.argument);
  };
  names.signal = [&](const VariableName& v, const Signal& s) {
    // A port's value has a state and two strengths per bit, and two blanks.
    const std::uint32_t length = v.type == FST_VT_VCD_PORT ? 3 * v.width + 2 : v.width;
    const fstHandle made =
        fstWriterCreateVar(to, static_cast<fstVarType>(v.type), static_cast<fstVarDir>(v.direction),
                           length, printable_name(v.name).c_str(), handles[s.handle]);
    if (handles[s.handle] == 0) handles[s.handle] = made;
  };
  visit_names(trace, chosen, names);
  return handles;
}

void copy_changes(Trace& trace, const std::vector<bool>& chosen, std::uint64_t from,
                  std::uint64_t to, const std::vector<fstHandle>& handles, void* fst) {
  enum class Kind : char { kBits, kReal, kText, kPort, kEvent };
  std::vector<Kind> kinds(trace.handles() + std::size_t{1}, Kind::kBits);
  for (const Signal& s : trace.signals())
    if (s.real || s.text || s.event || s.kind == std::string_view("port"))
      kinds[s.handle] = s.real    ? Kind::kReal
                        : s.text  ? Kind::kText
                        : s.event ? Kind::kEvent
                                  : Kind::kPort;
  BlackoutsIn off(trace, from, to);
  std::uint64_t now = from;
  std::string bits;
  fstWriterEmitTimeChange(fst, from);
  const auto dumps = [&](std::uint64_t, bool on) { fstWriterEmitDumpActive(fst, on ? 1 : 0); };
  off.until(from, dumps);
  trace.stream(chosen_handles(trace, chosen), from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) {
                   const auto between = [&](std::uint64_t t, bool on) {
                     if (t != now) fstWriterEmitTimeChange(fst, now = t);
                     dumps(t, on);
                   };
                   off.until(time, between);
                   if (time != now) fstWriterEmitTimeChange(fst, now = time);
                 }
                 const fstHandle h = handles[handle];
                 if (kinds[handle] == Kind::kEvent && value == "0") return true;
                 if (kinds[handle] == Kind::kText) {
                   fstWriterEmitVariableLengthValueChange(fst, h, value.data(),
                                                          static_cast<std::uint32_t>(value.size()));
                 } else if (kinds[handle] == Kind::kReal) {
                   if (value.starts_with('x')) return true;  // has no value yet
                   const double number = std::strtod(std::string(value).c_str(), nullptr);
                   fstWriterEmitValueChange(fst, h, &number);
                 } else {
                   bits = kinds[handle] == Kind::kPort ? port_value(value) : std::string(value);
                   fstWriterEmitValueChange(fst, h, bits.c_str());
                 }
                 return true;
               });
  off.until(to, [&](std::uint64_t t, bool on) {
    if (t != now) fstWriterEmitTimeChange(fst, now = t);
    dumps(t, on);
  });
  if (now != to) fstWriterEmitTimeChange(fst, to);
}

}  // namespace

void write_cut(Trace& trace, std::span<const View> views, std::uint64_t from, std::uint64_t to,
               const std::filesystem::path& path, std::span<const std::string> comments) {
  const std::vector<bool> chosen = chosen_signals(trace, views, "FST");
  OutputFile file(path, OutputFile::Use::kByName);
  try {
    Fst fst(fstWriterCreate(file.by_name().c_str(), 1), fstWriterClose);
    if (!fst) cannot_write(path);
    fstWriterSetTimescale(fst.get(), trace.scale());
    fstWriterSetTimezero(fst.get(), trace.time_zero());
    fstWriterSetVersion(fst.get(), printable(trace.writer()).c_str());
    fstWriterSetDate(fst.get(), printable(trace.date()).c_str());
    fstWriterSetPackType(fst.get(), FST_WR_PT_LZ4);
    for (const std::string& comment : comments) fstWriterSetComment(fst.get(), comment.c_str());
    const std::vector<fstHandle> handles = copy_names(trace, chosen, fst.get());
    copy_changes(trace, chosen, from, to, handles, fst.get());
  } catch (const ReaderFailed&) {
    cannot_write(path);
  }
  // The FST writer does not report failed writes.
  try {
    Trace written(file.by_name());
    const auto count = static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), true));
    if (written.start() != from || written.end() != to || written.signals().size() != count)
      cannot_write(path);
  } catch (const Error&) {
    cannot_write(path);
  }
  file.commit();
}

}  // namespace cde::wave
