// SPDX-License-Identifier: Apache-2.0
// A card after power-on with random state, in a model built with CDE_RANDOM_START=1. Every register
// starts with a random value, and inputs are random before the first reset. The seed is decimal in
// $CDE_RANDOM_SEED. Without it, or with 0, all values start as zeros. Other models do not contain
// this.
#pragma once
#include <verilated.h>

#include <cstdint>
#include <cstdlib>
#include <random>

#include "cde/contract/registers.hpp"

#ifdef CDE_RANDOM_START
class RandomStart {
 public:
  /// Constructed before the model.
  explicit RandomStart(VerilatedContext& context) : context_(context), engine_(seed()) {
    context.randReset(seed() != 0 ? 2 : 0);
    if (seed() != 0) context.randSeed(static_cast<int>(seed()));
  }
  /// Drives random inputs for some cycles without a reset. Assertions are off meanwhile.
  template <class Model, class Clock>
  void before_reset(Model& model, Clock clock) {
    if (seed() == 0) return;
    context_.assertOn(false);
    for (int i = 0; i < kCycles; ++i) {
      drive(model);
      clock();
    }
    if constexpr (requires { model.bus_valid_i; }) model.bus_valid_i = 0;
  }
  /// Called after the reset.
  void after_reset() { context_.assertOn(true); }

 private:
  static constexpr int kCycles = 50;
  static uint32_t seed() {
    const char* const text = std::getenv("CDE_RANDOM_SEED");
    return text != nullptr ? static_cast<uint32_t>(std::strtoul(text, nullptr, 10)) : 0;
  }
  void fill(int bits, uint32_t* words) {
    for (int at = 0; at < bits; at += 32) {
      words[at / 32] = static_cast<uint32_t>(engine_());
      if (bits - at < 32) words[at / 32] &= (1u << (bits - at)) - 1;
    }
  }
  template <class T>
  void fill(int bits, T& port) {
    uint32_t words[2] = {};
    fill(bits, words);
    port = static_cast<T>(words[0] | static_cast<uint64_t>(words[1]) << 32);
  }
  template <std::size_t kWords>
  void fill(int bits, VlWide<kWords>& port) {
    fill(bits, port.data());
  }
  /// Drives the inputs that the top module has.
  template <class Model>
  void drive(Model& m) {
    if constexpr (requires { m.ddr_data_i; }) {
      fill(1, m.ddr_ready_i);
      fill(1, m.ddr_valid_i);
      fill(8 * sizeof m.ddr_data_i, m.ddr_data_i);
      fill(72, m.ddr_check_i);
      fill(8 * sizeof m.sram_read_data_i, m.sram_read_data_i);
    }
    if constexpr (requires { m.bus_wdata_i; }) {
      fill(1, m.bus_valid_i);
      fill(1, m.bus_write_i);
      fill(cde::card::kSpaceBits, m.bus_space_i);
      fill(32, m.bus_addr_i);
      fill(64, m.bus_wdata_i);
    }
    if constexpr (requires { m.pci_ad_i; }) {
      fill(64, m.pci_ad_i);
      fill(8, m.pci_cbe_n_i);
      fill(1, m.pci_par_i);
      fill(1, m.pci_par64_i);
      fill(1, m.pci_frame_n_i);
      fill(1, m.pci_req64_n_i);
      fill(1, m.pci_irdy_n_i);
      fill(1, m.pci_trdy_n_i);
      fill(1, m.pci_stop_n_i);
      fill(1, m.pci_devsel_n_i);
      fill(1, m.pci_ack64_n_i);
      fill(1, m.pci_perr_n_i);
      fill(1, m.pci_idsel_i);
      fill(1, m.pci_gnt_n_i);
    }
  }
  VerilatedContext& context_;
  std::mt19937 engine_;
};
#else
class RandomStart {
 public:
  explicit RandomStart(VerilatedContext&) {}
  template <class Model, class Clock>
  void before_reset(Model&, Clock) {}
  void after_reset() {}
};
#endif
