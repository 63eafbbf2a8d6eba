// Waves of a model, in a bitstream that was built with them (TRACE=1); in any other it opens none.
#pragma once
#include <cstdint>
#include <memory>

#include "Vmodel.h"
#include "verilated.h"
#ifdef CDE_TRACE
#include "verilated_fst_c.h"

class WaveFile {
 public:
  /// 0, or -1 if `path` cannot be written. Ends the file that was open before.
  int open(VerilatedContext& context, Vmodel& model, const char* path) {
    close();
    context.traceEverOn(true);
    if (!file_) {
      file_ = std::make_unique<VerilatedFstC>();
      model.trace(file_.get(), 99);
    }
    file_->open(path);
    return file_->isOpen() ? 0 : -1;
  }
  void dump(uint64_t time) {
    if (file_ && file_->isOpen()) file_->dump(time);
  }
  void close() {
    if (file_ && file_->isOpen()) file_->close();
  }

 private:
  std::unique_ptr<VerilatedFstC> file_;
};

#else

class WaveFile {
 public:
  int open(VerilatedContext&, Vmodel&, const char*) { return -1; }
  void dump(uint64_t) {}
  void close() {}
};

#endif
