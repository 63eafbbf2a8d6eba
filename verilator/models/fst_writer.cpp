// SPDX-License-Identifier: Apache-2.0
// Verilator's writer of FST files, with four changes. It notes failed writes for wave_file.h. It
// keeps temporary files in memory, since mapping them would end the process with SIGBUS on a full
// disk. It can write comments. It can write a selection of signals, for which Verilator's
// dumpvars() may make an invalid access.
#include "verilated_fst_c.h"

#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
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

/// Leaves out unselected signals. A scope is written when a signal in it is.
class Selection {
 public:
  explicit Selection(const char* patterns = "") {
    std::istringstream lines(patterns);
    for (std::string line; std::getline(lines, line);) {
      std::string pattern;
      for (const char c : line) {
        if (c == '[' || c == '\\')
          pattern += '\\';  // fnmatch treats more characters than * and ? as special
        pattern += c;
      }
      patterns_.push_back({pattern, "*." + pattern});
    }
  }
  void enter(void*, fstScopeType type, const char* name, const char*) {
    const bool all = inside();
    path_.push_back({type, name, false, false});
    path_.back().wanted = named("") || all;
  }
  void leave(void* file) {
    if (path_.back().written) fstWriterSetUpscope(file);
    path_.pop_back();
  }
  void names(void*, fstEnumHandle table) { table_ = table; }
  /// A signal that is left out gets a handle above all others, which the library does not write. An
  /// alias of it may still be selected.
  fstHandle declare(void* file, fstVarType type, fstVarDir direction, uint32_t bits,
                    const char* name, fstHandle alias) {
    const fstEnumHandle table = std::exchange(table_, 0);
    const std::string stem(name, strcspn(name, " "));
    if (!named(stem) && !inside()) {
      if (alias != 0) return alias;
      aliases_.push_back(0);
      return kLeftOut - static_cast<fstHandle>(aliases_.size() - 1);
    }
    for (Scope& scope : path_) {
      if (!scope.written) fstWriterSetScope(file, scope.type, scope.name.c_str(), nullptr);
      scope.written = true;
    }
    if (table != 0) fstWriterEmitEnumTableRef(file, table);
    fstHandle& same = alias > kLeftOut / 2 ? aliases_[kLeftOut - alias] : alias;
    const fstHandle handle = fstWriterCreateVar(file, type, direction, bits, name, same);
    if (same == 0) same = handle;
    return handle;
  }
  /// The handle to write for a signal, once all signals are declared.
  [[nodiscard]] fstHandle resolved(fstHandle handle) const {
    if (handle <= kLeftOut / 2) return handle;
    const fstHandle alias = aliases_[kLeftOut - handle];
    return alias != 0 ? alias : kLeftOut;
  }
  /// The first pattern that matches nothing, or -1.
  [[nodiscard]] int without_effect() const {
    for (std::size_t i = 0; i < patterns_.size(); ++i)
      if (!patterns_[i].used) return static_cast<int>(i);
    return -1;
  }

 private:
  static constexpr fstHandle kLeftOut = UINT32_MAX;
  struct Pattern {
    std::string whole, inner;
    bool used = false;
  };
  struct Scope {
    fstScopeType type;
    std::string name;
    bool wanted, written;
  };
  [[nodiscard]] bool inside() const {
    return patterns_.empty() || (!path_.empty() && path_.back().wanted);
  }
  /// Whether a pattern matches the last entered scope, or a signal in it.
  bool named(const std::string& signal) {
    if (patterns_.empty()) return true;
    std::string name;
    for (const Scope& scope : path_) name += (name.empty() ? "" : ".") + scope.name;
    if (!signal.empty()) name += (name.empty() ? "" : ".") + signal;
    bool any = false;
    for (Pattern& p : patterns_) {
      if (fnmatch(p.whole.c_str(), name.c_str(), 0) != 0 &&
          fnmatch(p.inner.c_str(), name.c_str(), 0) != 0)
        continue;
      any = p.used = true;
    }
    return any;
  }

  std::vector<Pattern> patterns_;
  std::vector<Scope> path_;
  std::vector<fstHandle> aliases_;  // for signals left out: a selected alias, or 0
  fstEnumHandle table_ = 0;
};
thread_local Selection selection;

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
#define SET_SCOPE_m_fst selection.enter(m_fst
#define fstWriterSetUpscope(file) SET_UPSCOPE_##file)
#define SET_UPSCOPE_void fstWriterSetUpscope(void
#define SET_UPSCOPE_m_fst selection.leave(m_fst
#define fstWriterEmitEnumTableRef(file, ...) TABLE_REF_##file, __VA_ARGS__)
#define TABLE_REF_void fstWriterEmitEnumTableRef(void
#define TABLE_REF_m_fst selection.names(m_fst
#define fstWriterCreateVar(file, ...) CREATE_VAR_##file, __VA_ARGS__)
#define CREATE_VAR_void fstWriterCreateVar(void
#define CREATE_VAR_ctx fstWriterCreateVar(ctx
#define CREATE_VAR_m_fst selection.declare(m_fst
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
  selection = Selection(patterns);
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
