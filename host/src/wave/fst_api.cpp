// SPDX-License-Identifier: Apache-2.0
// Reader and writer of FST files are those of Verilator's runtime, compiled as they are, but that
// what ends the process, prints or waits for the end of a file that has ended throws instead.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "cde/wave/fst_api.hpp"

namespace {

[[noreturn]] void reader_exit(int) {
  throw cde::wave::ReaderFailed();
}

int reader_print(std::FILE* to, const char* format, ...) {
  if (to == stderr) return 0;
  va_list arguments;
  va_start(arguments, format);
  const int written = std::vfprintf(to, format, arguments);
  va_end(arguments);
  return written;
}

/// The reader looks for the end of a name or a number without looking for the end of the file.
int reader_getc(std::FILE* from) {
  static thread_local unsigned ends = 0;
  const int c = ::getc_unlocked(from);
  if (c != EOF) {
    ends = 0;
  } else if (++ends > 2) {
    ends = 0;
    throw cde::wave::ReaderFailed();
  }
  return c;
}

void* reader_malloc(std::size_t bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 32;
  void* const memory = bytes > kMost ? nullptr : std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw cde::wave::ReaderFailed();
  return memory;
}

void* reader_calloc(std::size_t count, std::size_t bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 32;
  if (count > kMost) throw cde::wave::ReaderFailed();
  void* const memory = std::calloc(count == 0 ? 1 : count, bytes);
  if (memory == nullptr) throw cde::wave::ReaderFailed();
  return memory;
}

/// The writer's own file of names is NAME.hier, which is in memory instead: beside NAME it would
/// replace what another user has put there.
std::FILE* writer_open(const char* name, const char* mode) {
  const std::size_t length = std::strlen(name);
  constexpr char kNames[] = ".hier";
  constexpr std::size_t kEnd = sizeof kNames - 1;
  if (mode[0] != 'w' || length < kEnd || std::strcmp(name + length - kEnd, kNames) != 0)
    return std::fopen(name, mode);
  const int fd = ::memfd_create("waves", MFD_CLOEXEC);
  return fd < 0 ? nullptr : ::fdopen(fd, "w+b");
}

}  // namespace

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#define FST_CONFIG_INCLUDE "fst_config.h"
#define exit reader_exit
#define fprintf reader_print
#define fopen writer_open
#undef fgetc
#define fgetc reader_getc
#define malloc reader_malloc
#define calloc reader_calloc
// clang-format off
// NOLINTBEGIN(bugprone-suspicious-include)
#include "gtkwave/fastlz.c"
#include "gtkwave/fstapi.c"
#include "gtkwave/lz4.c"
// NOLINTEND(bugprone-suspicious-include)
// clang-format on
#pragma GCC diagnostic pop
