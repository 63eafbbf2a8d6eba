// SPDX-License-Identifier: Apache-2.0
// Verilator's writer of FST files, as it is but for three things: it looks at no result of what it
// writes, it maps temporary files into memory, which ends the process with SIGBUS where their disk
// is full, and it leaves no comments. Here failures are noted for wave_file.h, what is temporary
// lies in memory, and there are comments.
#include "verilated_fst_c.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "wave_errors.h"

thread_local int* wave_error = nullptr;

namespace {

template <class Result>
Result noted(bool failed, Result result) {
  if (failed && wave_error != nullptr && *wave_error == 0) *wave_error = errno != 0 ? errno : EIO;
  return result;
}

FILE* memory_file() {
  const int fd = memfd_create("waves", MFD_CLOEXEC);
  FILE* const file = fd < 0 ? nullptr : fdopen(fd, "w+b");
  if (file == nullptr && fd >= 0) close(fd);
  return noted(file == nullptr, file);
}

FILE* checked_open(const char* name, const char* mode) {
  const char* const dot = strrchr(name, '.');
  const bool writes = mode[0] == 'w';
  if (writes && dot != nullptr && strcmp(dot, ".hier") == 0) return memory_file();
  FILE* const file = fopen(name, mode);
  return noted(writes && file == nullptr, file);
}

size_t checked_write(const void* from, size_t size, size_t count, FILE* file) {
  const size_t written = fwrite(from, size, count, file);
  return noted(written != count, written);
}

int checked_put(int c, FILE* file) {
  const int result = fputc(c, file);
  return noted(result == EOF, result);
}

int checked_flush(FILE* file) {
  const int result = fflush(file);
  return noted(result != 0, result);
}

int checked_seek(FILE* file, off_t to, int whence) {
  const int result = fseeko(file, to, whence);
  return noted(result != 0, result);
}

int checked_truncate(int fd, off_t length) {
  const int result = ftruncate(fd, length);
  return noted(result != 0, result);
}

int checked_close(FILE* file) {
  const bool failed = ferror(file) != 0;
  const int result = fclose(file);
  return noted(failed || result != 0, result);
}

/// Reading or writing where a mapped file has no bytes would end the process: a file that is
/// shorter than it should be, because it could not grow, is replaced by memory.
void* checked_map(size_t length, int protection, int flags, int fd) {
  struct stat s = {};
  const bool too_short = fstat(fd, &s) != 0 || static_cast<size_t>(s.st_size) < length;
  if (too_short) flags = MAP_PRIVATE | MAP_ANONYMOUS, fd = -1;
  void* const memory = mmap(nullptr, length, protection, flags, fd, 0);
  return noted(too_short || memory == MAP_FAILED, memory);
}

}  // namespace

#define tmpfile() memory_file()
#define fopen(name, mode) checked_open(name, mode)
#define fwrite(from, size, count, file) checked_write(from, size, count, file)
#define fputc(c, file) checked_put(c, file)
#define fflush(file) checked_flush(file)
#define fseeko(file, to, whence) checked_seek(file, to, whence)
#define ftruncate(fd, length) checked_truncate(fd, length)
#define fclose(file) checked_close(file)
#define mmap(address, length, protection, flags, fd, offset) \
  checked_map(length, protection, flags, fd)
#include "verilated_fst_c.cpp"

namespace {

// The context of the writer of FST is private; an explicit instantiation may name it.
void* context_of(VerilatedFst& writer);
template <void* VerilatedFst::*Context>
struct Private {
  friend void* context_of(VerilatedFst& writer) { return writer.*Context; }
};
template struct Private<&VerilatedFst::m_fst>;

}  // namespace

void comment_waves(VerilatedFstC& file, const char* text) {
  fstWriterSetComment(context_of(*file.spTrace()), text);
}
