// SPDX-License-Identifier: Apache-2.0
// Verilator's writer of FST files by the library of GTKWave (fstcpp_writer.cpp is for the later
// library), with four changes. It notes failed writes for wave_file.h. It
// keeps temporary files in memory, since mapping them would end the process with SIGBUS on a full
// disk. It can write comments. It can write a selection of signals, for which Verilator's
// dumpvars() may make an invalid access.
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
#include <utility>
#include <vector>

#include "fst_selection.h"
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

/// Accessing a mapped file beyond its bytes would end the process. A file that could not grow is
/// too short, and memory replaces it.
void* checked_map(size_t length, int protection, int flags, int fd) {
  struct stat s = {};
  const bool too_short = fstat(fd, &s) != 0 || static_cast<size_t>(s.st_size) < length;
  if (too_short) flags = MAP_PRIVATE | MAP_ANONYMOUS, fd = -1;
  void* const memory = mmap(nullptr, length, protection, flags, fd, 0);
  return noted(too_short || memory == MAP_FAILED, memory);
}

/// Calls of the FST library by the selection.
struct Library {
  using File = void*;
  using Table = fstEnumHandle;
  struct Scope {
    fstScopeType type;
    std::string name;
    static constexpr bool unnamed = false;
  };
  struct Variable {
    fstVarType type;
    fstVarDir direction;
    uint32_t bits;
  };
  static void enter(File file, const Scope& scope) {
    fstWriterSetScope(file, scope.type, scope.name.c_str(), nullptr);
  }
  static void leave(File file) { fstWriterSetUpscope(file); }
  static void name_values(File file, Table table) { fstWriterEmitEnumTableRef(file, table); }
  static fstHandle declare(File file, const Variable& v, const char* name, fstHandle alias) {
    return fstWriterCreateVar(file, v.type, v.direction, v.bits, name, alias);
  }
};
thread_local Selection<Library> selection;

void enter_selected(void*, fstScopeType type, const char* name, const char*) {
  selection.enter({type, name});
}
void leave_selected(void* file) {
  selection.leave(file);
}
void name_selected(void*, fstEnumHandle table) {
  selection.name_values(table);
}
fstHandle declare_selected(void* file, fstVarType type, fstVarDir direction, uint32_t bits,
                           const char* name, fstHandle alias) {
  return selection.declare(file, {type, direction, bits}, name, alias);
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

// Redirects the writer's declarations to the selection. The first argument distinguishes its calls
// (m_fst) from the definitions in the included FST library, which must stay unchanged.
#define fstWriterSetScope(file, ...) SET_SCOPE_##file, __VA_ARGS__)
#define SET_SCOPE_void fstWriterSetScope(void
#define SET_SCOPE_m_fst enter_selected(m_fst
#define fstWriterSetUpscope(file) SET_UPSCOPE_##file)
#define SET_UPSCOPE_void fstWriterSetUpscope(void
#define SET_UPSCOPE_m_fst leave_selected(m_fst
#define fstWriterEmitEnumTableRef(file, ...) TABLE_REF_##file, __VA_ARGS__)
#define TABLE_REF_void fstWriterEmitEnumTableRef(void
#define TABLE_REF_m_fst name_selected(m_fst
#define fstWriterCreateVar(file, ...) CREATE_VAR_##file, __VA_ARGS__)
#define CREATE_VAR_void fstWriterCreateVar(void
#define CREATE_VAR_ctx fstWriterCreateVar(ctx
#define CREATE_VAR_m_fst declare_selected(m_fst
#include "verilated_fst_c.cpp"
#undef fstWriterSetScope
#undef fstWriterSetUpscope
#undef fstWriterEmitEnumTableRef
#undef fstWriterCreateVar

namespace {

// The FST writer's context is private; an explicit instantiation may name it.
void* context_of(VerilatedFst& writer);
fstHandle*& handles_of(VerilatedFst& writer);
uint32_t codes_of(VerilatedFst& writer);
template <auto Context, auto Handles, auto Codes>
struct Private {
  friend void* context_of(VerilatedFst& writer) { return writer.*Context; }
  friend fstHandle*& handles_of(VerilatedFst& writer) { return writer.*Handles; }
  friend uint32_t codes_of(VerilatedFst& writer) { return (writer.*Codes)(); }
};
template struct Private<&VerilatedFst::m_fst, &VerilatedFst::m_symbolp,
                        &VerilatedTrace<VerilatedFst, VerilatedFstBuffer>::nextCode>;

}  // namespace

void comment_waves(VerilatedFstC& file, const char* text) {
  fstWriterSetComment(context_of(*file.spTrace()), text);
}

int open_waves(VerilatedFstC& file, const char* path, const char* patterns) {
  // The handles belong to the last file, which may have had other signals.
  fstHandle*& handles = handles_of(*file.spTrace());
  delete[] handles;
  handles = nullptr;
  selection = Selection<Library>(patterns);
  file.open(path);
  if (!file.isOpen()) return -1;
  // Changes are packed and written in blocks, the last one when the file is closed. The library's
  // default block of 128 MB takes seconds to pack.
  static_cast<fstWriterContext*>(context_of(*file.spTrace()))->fst_break_size = std::size_t{1}
                                                                                << 24;
  for (uint32_t code = 0; code < codes_of(*file.spTrace()); ++code)
    handles[code] = selection.resolved(handles[code]);
  return selection.without_effect();
}
