// SPDX-License-Identifier: Apache-2.0
/// What reroll_waves makes of Verilator's code for waves: lanes that lie side by side, declared or
/// dumped by one call.
#pragma once
#include <string>

#include "verilated_fst_c.h"

namespace waves {

/// `count` lanes from number `first` on, the first of them with code `code`.
inline void declare(VerilatedFst* tracep, uint32_t code, unsigned first, unsigned count,
                    fstVarDir direction, fstVarType type, bool array, int array_number, int msb,
                    int lsb) {
  for (unsigned i = 0; i < count; ++i) {
    const std::string name = "[" + std::to_string(first + i) + "]";
    tracep->declBus(code + i, name.c_str(), -1, direction, type, array, array_number, msb, lsb);
  }
}

/// What changed of `count` words of 32 bits.
[[gnu::noinline]] inline void chg(VerilatedFst::Buffer* bufp, uint32_t* oldp, const IData* words,
                                  unsigned count) {
  for (unsigned i = 0; i < count; ++i) bufp->chgIData(oldp + i, words[i], 32);
}

/// All of them.
[[gnu::noinline]] inline void full(VerilatedFst::Buffer* bufp, uint32_t* oldp, const IData* words,
                                   unsigned count) {
  for (unsigned i = 0; i < count; ++i) bufp->fullIData(oldp + i, words[i], 32);
}

}  // namespace waves
