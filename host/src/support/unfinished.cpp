// SPDX-License-Identifier: Apache-2.0
#include "support/unfinished.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <string_view>

namespace cde {
namespace {

/// What remove_unfinished() removes. Slots are never freed, so a signal handler can walk them at
/// any time.
struct Slot {
  std::atomic<const NameInFolder*> entry;
  Slot* next;
};
using Slots = std::atomic<Slot*>;
Slots files{nullptr}, folders{nullptr}, contents{nullptr};

Slots& slots_of(UnfinishedKind kind) {
  return kind == UnfinishedKind::kFile     ? files
         : kind == UnfinishedKind::kFolder ? folders
                                           : contents;
}

}  // namespace

void remember_unfinished(const NameInFolder& entry, UnfinishedKind kind) {
  Slots& slots = slots_of(kind);
  for (Slot* slot = slots.load(); slot != nullptr; slot = slot->next) {
    const NameInFolder* none = nullptr;
    if (slot->entry.compare_exchange_strong(none, &entry)) return;
  }
  Slot* const slot = new Slot{&entry, slots.load()};
  while (!slots.compare_exchange_weak(slot->next, slot)) {
  }
}

void forget_unfinished(const NameInFolder& entry, UnfinishedKind kind) {
  for (Slot* slot = slots_of(kind).load(); slot != nullptr; slot = slot->next) {
    const NameInFolder* expected = &entry;
    if (slot->entry.compare_exchange_strong(expected, nullptr)) return;
  }
}

void remove_contents(int folder) noexcept {
  // The descriptor may be open as a path only.
  const int opened = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  alignas(dirent64) std::array<char, 4096> entries;
  long bytes = 0;
  while ((bytes = ::syscall(SYS_getdents64, opened, entries.data(), entries.size())) > 0) {
    for (long at = 0; at < bytes;) {
      const auto* const entry = reinterpret_cast<const dirent64*>(entries.data() + at);
      at += entry->d_reclen;
      const std::string_view name = entry->d_name;
      if (name == "." || name == "..") continue;
      if (::unlinkat(opened, entry->d_name, 0) == 0 || errno != EISDIR) continue;
      const int inner =
          ::openat(opened, entry->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
      if (inner >= 0) {
        remove_contents(inner);
        ::close(inner);
      }
      ::unlinkat(opened, entry->d_name, AT_REMOVEDIR);
    }
  }
  ::close(opened);
}

void OutputFile::remove_unfinished() noexcept {
  for (const Slot* slot = contents.load(); slot != nullptr; slot = slot->next)
    if (const NameInFolder* entry = slot->entry.load()) remove_contents(entry->folder);
  for (const Slot* slot = files.load(); slot != nullptr; slot = slot->next)
    if (const NameInFolder* entry = slot->entry.load())
      ::unlinkat(entry->folder, entry->name.c_str(), 0);
  // Folders may be in any order, so repeat as many times as there are folders.
  for (const Slot* pass = folders.load(); pass != nullptr; pass = pass->next)
    for (const Slot* slot = folders.load(); slot != nullptr; slot = slot->next)
      if (const NameInFolder* entry = slot->entry.load())
        ::unlinkat(entry->folder, entry->name.c_str(), AT_REMOVEDIR);
}

}  // namespace cde
