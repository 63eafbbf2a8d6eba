// SPDX-License-Identifier: Apache-2.0
// Verilator's writer of FST files by the library fstcpp, with the changes of fst_writer.cpp. It
// notes failed writes for wave_file.h. It can write comments and a selection of signals. It packs
// smaller blocks.
#include "verilated_fst_c.h"

#include <errno.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <type_traits>
#include <utility>

#include "fst_selection.h"
#include "fstcpp/fstcpp_writer.h"
#include "wave_errors.h"

thread_local int* wave_error = nullptr;

namespace {

// Private members; an explicit instantiation may name them.
std::ofstream& stream_of(fst::Writer& writer);
uint64_t& block_size_of(fst::Writer& writer);
fst::Writer* writer_of(VerilatedFst& waves);
vlFstHandle*& handles_of(VerilatedFst& waves);
uint32_t codes_of(VerilatedFst& waves);
template <auto Stream, auto BlockSize>
struct PrivateOfWriter {
  friend std::ofstream& stream_of(fst::Writer& writer) { return writer.*Stream; }
  friend uint64_t& block_size_of(fst::Writer& writer) { return writer.*BlockSize; }
};
template struct PrivateOfWriter<&fst::Writer::m_main_fst_file_,
                                &fst::Writer::m_value_change_data_flush_threshold_>;
template <auto Writer, auto Handles, auto Codes>
struct PrivateOfWaves {
  friend fst::Writer* writer_of(VerilatedFst& waves) { return waves.*Writer; }
  friend vlFstHandle*& handles_of(VerilatedFst& waves) { return waves.*Handles; }
  friend uint32_t codes_of(VerilatedFst& waves) { return (waves.*Codes)(); }
};
template struct PrivateOfWaves<&VerilatedFst::m_fst, &VerilatedFst::m_symbolp,
                               &VerilatedTrace<VerilatedFst, VerilatedFstBuffer>::nextCode>;

void note_failure(fst::Writer& writer) {
  if (!stream_of(writer).fail() || wave_error == nullptr || *wave_error != 0) return;
  *wave_error = errno != 0 ? errno : EIO;
}

/// Calls of the FST library by the selection.
struct Library {
  using File = fst::Writer*;
  using Table = fst::EnumHandle;
  struct Scope {
    fst::Hierarchy::ScopeType type;
    std::string name;
    bool unnamed;  ///< an array: its elements have its name, as signals of the earlier writer
    bool has_attribute;
    fst::Hierarchy::AttrType attribute;
    fst::Hierarchy::AttrSubType kind;
    std::string label;
    uint64_t value;
  };
  struct Variable {
    fst::Hierarchy::VarType type;
    fst::Hierarchy::VarDirection direction;
    uint32_t bits;
  };
  static void enter(File file, const Scope& s) {
    if (s.has_attribute) file->setAttrBegin(s.attribute, s.kind, s.label, s.value);
    file->setScope(s.type, s.name, std::string());
  }
  static void leave(File file) { file->upscope(); }
  static void name_values(File file, Table table) { file->emitEnumTableRef(table); }
  static fst::Handle declare(File file, const Variable& v, const char* name, fst::Handle alias) {
    return file->createVar(v.type, v.direction, v.bits, name, alias);
  }
};
using Signals = Selection<Library>;
thread_local Signals selection;
thread_local Library::Scope next_scope;

/// The library's writer as Verilator's code uses it: a pointer. Declarations go to the selection.
template <class Pointer>
class Writer {
 public:
  explicit Writer(Pointer& writer) : writer_(writer) {}
  operator fst::Writer*() const { return writer_; }
  Writer& operator=(fst::Writer* writer) {
    writer_ = writer;
    return *this;
  }
  Writer* operator->() { return this; }

  void setScope(fst::Hierarchy::ScopeType type, const std::string& name, const std::string&) {
    Library::Scope scope = std::exchange(next_scope, {});
    const Library::Scope* const outer = selection.last();
    scope.type = type;
    scope.name = outer != nullptr && outer->unnamed ? outer->name + name : name;
    scope.unnamed = type == fst::Hierarchy::ScopeType::SV_ARRAY;
    selection.enter(scope);
  }
  void upscope() { selection.leave(writer_); }
  /// Verilator sets only attributes of the next scope.
  void setAttrBegin(fst::Hierarchy::AttrType attribute, fst::Hierarchy::AttrSubType kind,
                    const char* label, uint64_t value) {
    next_scope = {.has_attribute = true,
                  .attribute = attribute,
                  .kind = kind,
                  .label = label,
                  .value = value};
  }
  void emitEnumTableRef(fst::EnumHandle table) { selection.name_values(table); }
  fst::Handle createVar(fst::Hierarchy::VarType type, fst::Hierarchy::VarDirection direction,
                        uint32_t bits, const char* name, fst::Handle alias) {
    return selection.declare(writer_, {type, direction, bits}, name, alias);
  }
  void emitTimeChange(uint64_t time) {
    errno = 0;
    writer_->emitTimeChange(time);
    note_failure(*writer_);
    // The first time sets the library's default of 128 MB, which takes seconds to pack.
    block_size_of(*writer_) = uint64_t{1} << 24;
  }
  template <class... Value>
  void emitValueChange(fst::Handle handle, Value... value) {
    if (!Signals::is_left_out(handle)) writer_->emitValueChange(handle, value...);
  }
  /// Verilator forgets the closed writer.
  void close() {
    errno = 0;
    writer_->close();
    note_failure(*writer_);
    delete writer_;
  }
  template <class... Arguments>
  auto createEnumTable(Arguments&&... arguments) {
    return writer_->createEnumTable(std::forward<Arguments>(arguments)...);
  }
  void setWriterPackType(fst::WriterPackType type) { writer_->setWriterPackType(type); }
  void setTimecale(int8_t scale) { writer_->setTimecale(scale); }
  void setWriter(const char* name) { writer_->setWriter(name); }
  void flushValueChangeData() { writer_->flushValueChangeData(); }

 private:
  Pointer& writer_;
};

}  // namespace

// The library would end the process when it closes a file that could not grow.
#undef FST_DCHECK_EQ
#define FST_DCHECK_EQ(a, b) static_cast<void>(0)
// The library itself does not use this name.
// clang-format off
#define m_fst Writer<decltype(m_fst)>{m_fst}
// clang-format on
#include "verilated_fst_c.cpp"
#undef m_fst

void comment_waves(VerilatedFstC& file, const char* text) {
  writer_of(*file.spTrace())
      ->setAttrBegin(fst::Hierarchy::AttrType::MISC, fst::Hierarchy::AttrSubType::MISC_COMMENT,
                     text, 0);
}

int open_waves(VerilatedFstC& file, const char* path, const char* patterns) {
  // The handles belong to the last file, which may have had other signals.
  vlFstHandle*& handles = handles_of(*file.spTrace());
  delete[] handles;
  handles = nullptr;
  selection = Signals(patterns);
  errno = 0;
  file.open(path);
  if (!file.isOpen()) return -1;
  if (!stream_of(*writer_of(*file.spTrace())).is_open()) {
    note_failure(*writer_of(*file.spTrace()));
    file.close();
    return -1;
  }
  for (uint32_t code = 0; code < codes_of(*file.spTrace()); ++code)
    handles[code] = selection.resolved(handles[code]);
  return selection.without_effect();
}
