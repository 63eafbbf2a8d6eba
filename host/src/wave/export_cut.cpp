// SPDX-License-Identifier: Apache-2.0
// A window of waves as an FST of its own.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/wave/export.hpp"
#include "cde/wave/export_names.hpp"

namespace cde::wave {
namespace {

using Fst = std::unique_ptr<void, void (*)(void*)>;

[[noreturn]] void cannot_write(const std::filesystem::path& path) {
  throw Error(ErrorCode::kFile, fmt::format("{}: cannot be written as a whole; is the disk full?",
                                            printable_name(path.string())));
}

/// The names, and the handles that signals get.
std::vector<fstHandle> copy_names(Trace& trace, const std::vector<bool>& chosen, void* to) {
  std::vector<fstHandle> handles(trace.handles() + std::size_t{1}, 0);
  NameVisit names;
  names.open = [&](const ScopeName& s) {
    fstWriterSetScope(to, static_cast<fstScopeType>(s.type), s.name.c_str(),
                      s.component.empty() ? nullptr : s.component.c_str());
  };
  names.close = [&] { fstWriterSetUpscope(to); };
  names.attribute = [&](const Attribute& a) {
    fstWriterSetAttrBegin(to, static_cast<fstAttrType>(a.type), a.subtype, a.name.c_str(),
                          a.argument);
  };
  names.signal = [&](const fstHier& h, const Signal& s) {
    const fstHandle made = fstWriterCreateVar(to, static_cast<fstVarType>(h.u.var.typ),
                                              static_cast<fstVarDir>(h.u.var.direction),
                                              h.u.var.length, h.u.var.name, handles[s.handle]);
    if (handles[s.handle] == 0) handles[s.handle] = made;
  };
  visit_names(trace, chosen, names);
  return handles;
}

void copy_changes(Trace& trace, const std::vector<bool>& chosen, std::uint64_t from,
                  std::uint64_t to, const std::vector<fstHandle>& handles, void* fst) {
  enum class Kind : char { kBits, kReal, kText };
  std::vector<Kind> kinds(trace.handles() + std::size_t{1}, Kind::kBits);
  for (const Signal& s : trace.signals())
    if (s.real || s.text) kinds[s.handle] = s.real ? Kind::kReal : Kind::kText;
  std::uint64_t now = from;
  std::string bits;
  fstWriterEmitTimeChange(fst, from);
  trace.stream(chosen_handles(trace, chosen), from, to,
               [&](std::uint64_t time, std::uint32_t handle, std::string_view value) {
                 if (time != now) fstWriterEmitTimeChange(fst, now = time);
                 const fstHandle h = handles[handle];
                 if (kinds[handle] == Kind::kText) {
                   fstWriterEmitVariableLengthValueChange(fst, h, value.data(),
                                                          static_cast<std::uint32_t>(value.size()));
                 } else if (kinds[handle] == Kind::kReal) {
                   if (value.starts_with('x')) return true;  // has no value yet
                   const double number = std::strtod(std::string(value).c_str(), nullptr);
                   fstWriterEmitValueChange(fst, h, &number);
                 } else {
                   bits = value;
                   fstWriterEmitValueChange(fst, h, bits.c_str());
                 }
                 return true;
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
    fstWriterSetVersion(fst.get(), trace.writer().c_str());
    fstWriterSetDate(fst.get(), trace.date().c_str());
    fstWriterSetPackType(fst.get(), FST_WR_PT_LZ4);
    for (const std::string& comment : comments) fstWriterSetComment(fst.get(), comment.c_str());
    const std::vector<fstHandle> handles = copy_names(trace, chosen, fst.get());
    copy_changes(trace, chosen, from, to, handles, fst.get());
  } catch (const ReaderFailed&) {
    cannot_write(path);
  }
  // The writer does not say whether all was written.
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
