// SPDX-License-Identifier: Apache-2.0
// Waves of a model, in a bitstream that was built with them (TRACE=1); in any other it opens none.
#pragma once
#include <cstdint>
#include <memory>

#include "Vmodel.h"
#include "verilated.h"
#ifdef CDE_TRACE
#include "verilated_fst_c.h"
#include "wave_errors.h"

class WaveFile {
 public:
  /// 0, or -1 if `path` cannot be written. Ends the file that was open before.
  int open(VerilatedContext& context, Vmodel& model, const char* path) {
    close();
    error_ = 0;
    const Noted noted(error_);
    context.traceEverOn(true);
    if (!file_) {
      file_ = std::make_unique<VerilatedFstC>();
      model.trace(file_.get(), 99);
    }
    file_->open(path);
    return file_->isOpen() ? 0 : -1;
  }
  void dump(uint64_t time) {
    if (!file_ || !file_->isOpen() || error_ != 0) return;
    const Noted noted(error_);
    file_->dump(time);
  }
  /// 0, or the errno of the first thing since open() that could not be written: then the file is
  /// not whole.
  int close() {
    if (!file_ || !file_->isOpen()) return error_;
    const Noted noted(error_);
    file_->close();
    return error_;
  }

 private:
  /// While it lives, the writer notes what fails.
  class Noted {
   public:
    explicit Noted(int& error) { wave_error = &error; }
    ~Noted() { wave_error = nullptr; }
    Noted(const Noted&) = delete;
    Noted& operator=(const Noted&) = delete;
  };

  std::unique_ptr<VerilatedFstC> file_;
  int error_ = 0;
};

#else

class WaveFile {
 public:
  int open(VerilatedContext&, Vmodel&, const char*) { return -1; }
  void dump(uint64_t) {}
  int close() { return 0; }
};

#endif
