// SPDX-License-Identifier: Apache-2.0
// Waves of a model that was built with waves (TRACE=1). Other models open no file.
#pragma once
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "Vmodel.h"
#include "cde/abi/abi_head.h"
#include "cde/contract/records.hpp"
#include "parameters.h"
#include "verilated.h"
#ifdef CDE_TRACE
#include "verilated_fst_c.h"
#include "wave_errors.h"

class WaveFile {
 public:
  /// Opens a file and ends the last one. Returns 0, -1 if the file cannot be written, or -2 - i if
  /// pattern i of `what` matches nothing. Times in `what` count from `now`.
  int open(VerilatedContext& context, Vmodel& model, const cde_trace& what, uint64_t now) {
    close();
    error_ = 0;
    what_ = what;
    what_.path = what_.scopes = nullptr;  // owned by the caller
    what_.from = later(now, what.from);
    what_.to = later(now, what.to);
    waiting_ = what.ddr_word != CDE_TRACE_NOW;
    const Noted noted(error_);
    context.traceEverOn(true);
    if (!file_) {
      file_ = std::make_unique<VerilatedFstC>();
      model.trace(file_.get(), 99);
    }
    const int unused = open_waves(*file_, what.path, what.scopes);
    if (!file_->isOpen()) return -1;
    if (unused >= 0) return file_->close(), -2 - unused;
    comment_waves(*file_, origin().c_str());
    comment_waves(*file_, forms().c_str());
    return 0;
  }
  /// Starts waves that wait for a DDR word: the card has requested it.
  void begin(uint64_t time) {
    if (!waiting_) return;
    waiting_ = false;
    what_.from = time;
    what_.to = later(time, what_.length);
  }
  [[nodiscard]] uint64_t awaited_word() const { return waiting_ ? what_.ddr_word : CDE_TRACE_NOW; }
  void dump(uint64_t time) {
    if (!file_ || !file_->isOpen() || error_ != 0) return;
    if (waiting_ || time < what_.from || time > what_.to) return;
    const Noted noted(error_);
    file_->dump(time);
  }
  /// 0, or the errno of the first failed write since open(): then the file is incomplete.
  int close() {
    if (!file_ || !file_->isOpen()) return error_;
    const Noted noted(error_);
    file_->close();
    return error_;
  }

 private:
  static uint64_t later(uint64_t time, uint64_t by) {
    return by > UINT64_MAX - time ? UINT64_MAX : time + by;
  }

  /// Describes the source of the waves: "model KIND NAME=VALUE ...
  /// configuration=0123456789abcdef".
  static std::string origin() {
    std::string text = "model " CDE_KIND " ";
    for (const char c : std::string_view(kParameters)) text.push_back(c == '\n' ? ' ' : c);
    char hash[32];
    std::snprintf(hash, sizeof hash, "configuration=%016llx",
                  static_cast<unsigned long long>(CDE_CONFIG_HASH));
    return text + hash;
  }

  /// How a viewer formats values: the first pattern that matches a signal counts. Arrays of words
  /// of the card's format hold numbers or conditions. A condition is a word of ones or zeros.
  static std::string forms() {
    constexpr unsigned kExp = parameter("EXP", 8), kMan = parameter("MAN", 23);
    constexpr unsigned kOwn = 1 + kExp + kMan, kWord = kOwn <= 32 ? 32 : 64;
    const std::string format = "e" + std::to_string(kExp) + "m" + std::to_string(kMan);
    const std::string words = (kOwn == kWord ? "" : "/" + std::to_string(kWord)) + "*1";
    const auto record = [](unsigned word, const char* form) {
      return " *record[" + std::to_string(word) + "]=" + form;
    };
    return "forms *index*=dec *count*=dec *sram_*=hex *range[*]=dec" +
           record(cde::card::kRecordFlags, "hex") + record(cde::card::kRecordIndex, "dec") +
           record(cde::card::kRecordPrimary, "dec") + " *result_t=" + format + words +
           " *record_t=" + format + words + " *]=" + format + "|mask" + words;
  }

  /// While an instance lives, the writer notes failures.
  class Noted {
   public:
    explicit Noted(int& error) { wave_error = &error; }
    ~Noted() { wave_error = nullptr; }
    Noted(const Noted&) = delete;
    Noted& operator=(const Noted&) = delete;
  };

  std::unique_ptr<VerilatedFstC> file_;
  cde_trace what_ = {};
  bool waiting_ = false;
  int error_ = 0;
};

#else

class WaveFile {
 public:
  int open(VerilatedContext&, Vmodel&, const cde_trace&, uint64_t) { return -1; }
  void begin(uint64_t) {}
  [[nodiscard]] uint64_t awaited_word() const { return CDE_TRACE_NOW; }
  void dump(uint64_t) {}
  int close() { return 0; }
};

#endif
