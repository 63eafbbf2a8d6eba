// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <verilated.h>

#include <memory>
#include <random>

namespace cde::testing {

/// A module alone: registers start with random values, and one call is one cycle.
template <class Module>
class Clocked {
 public:
  Clocked() {
    context_.randReset(2);
    context_.randSeed(kSeed);
    module_ = std::make_unique<Module>(&context_);
  }
  ~Clocked() {
    // Verilator removes a module's scopes from the last context of the thread.
    Verilated::threadContextp(&context_);
    module_->final();
  }
  Clocked(const Clocked&) = delete;
  Clocked& operator=(const Clocked&) = delete;
  Module* operator->() { return module_.get(); }

  /// Settles the outputs for the current inputs.
  void settle() {
    module_->clk_i = 0;
    module_->eval();
  }
  void clock() {
    settle();
    module_->clk_i = 1;
    module_->eval();
  }

  static constexpr unsigned kSeed = 20240611;

 private:
  VerilatedContext context_;
  std::unique_ptr<Module> module_;
};

/// Small random numbers, the same in every run.
class Dice {
 public:
  unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }
  bool once_in(unsigned n) { return below(n) == 0; }

 private:
  std::mt19937 engine_{20240611};
};

}  // namespace cde::testing
