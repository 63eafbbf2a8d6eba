// SPDX-License-Identifier: Apache-2.0
// Compiles the reader and writer of FST files from Verilator's runtime. Calls that end the process,
// print, or wait at the end of a truncated file throw instead.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

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

/// The reader searches the end of a name or number without checking for the end of the file.
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

/// Parts of files as one stream.
class Parts {
 public:
  explicit Parts(std::vector<cde::wave::FstPart> parts) : parts_(std::move(parts)) {
    for (cde::wave::FstPart& p : parts_) {
      if (!p.text.empty()) p.size = p.text.size();
      size_ += p.size;
    }
  }
  ssize_t read(char* to, std::size_t count) {
    std::uint64_t begin = 0;
    for (const cde::wave::FstPart& p : parts_) {
      if (at_ >= begin && at_ - begin < p.size) {
        const std::uint64_t from = at_ - begin;
        const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(count, p.size - from));
        ssize_t done = static_cast<ssize_t>(n);
        if (!p.text.empty())
          std::memcpy(to, p.text.data() + from, n);
        else
          done = ::pread(p.descriptor, to, n, static_cast<off_t>(p.offset + from));
        if (done > 0) at_ += static_cast<std::uint64_t>(done);
        return done;
      }
      begin += p.size;
    }
    return 0;
  }
  int seek(off64_t* to, int whence) {
    const std::int64_t base = whence == SEEK_SET   ? 0
                              : whence == SEEK_CUR ? static_cast<std::int64_t>(at_)
                                                   : static_cast<std::int64_t>(size_);
    if (*to < -base) return -1;
    at_ = static_cast<std::uint64_t>(base + *to);
    *to = static_cast<off64_t>(at_);
    return 0;
  }

 private:
  std::vector<cde::wave::FstPart> parts_;
  std::uint64_t size_ = 0, at_ = 0;
};

std::FILE* stream_of(std::vector<cde::wave::FstPart> parts) {
  cookie_io_functions_t calls{};
  calls.read = [](void* p, char* to, std::size_t n) { return static_cast<Parts*>(p)->read(to, n); };
  calls.seek = [](void* p, off64_t* to, int how) { return static_cast<Parts*>(p)->seek(to, how); };
  calls.close = [](void* p) {
    delete static_cast<Parts*>(p);
    return 0;
  };
  auto own = std::make_unique<Parts>(std::move(parts));
  std::FILE* const file = ::fopencookie(own.get(), "rb", calls);
  if (file == nullptr) return nullptr;
  (void)own.release();
  constexpr std::size_t kBuffer = 1u << 16;
  (void)std::setvbuf(file, nullptr, _IOFBF, kBuffer);
  return file;
}

thread_local std::FILE* reader_stream = nullptr;  ///< the stream that the reader opens next

/// The reader opens this stream only: NAME.hier beside the file may belong to another user. The
/// writer's own NAME.hier is kept in memory instead: on disk it could replace another user's file.
std::FILE* wave_open(const char* name, const char* mode) {
  if (mode[0] == 'r') return std::exchange(reader_stream, nullptr);
  const std::size_t length = std::strlen(name);
  constexpr char kNames[] = ".hier";
  constexpr std::size_t kEnd = sizeof kNames - 1;
  if (length < kEnd || std::strcmp(name + length - kEnd, kNames) != 0)
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
#define fopen wave_open
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

namespace cde::wave {

void* open_fst_reader(std::vector<FstPart> parts) {
  reader_stream = stream_of(std::move(parts));
  if (reader_stream == nullptr) return nullptr;
  return fstReaderOpen("waves");
}

}  // namespace cde::wave
