// SPDX-License-Identifier: Apache-2.0
/// Calls that reroll_waves writes: each declares or dumps a run of adjacent lanes.
#pragma once
#include <string>

#include "verilated_fst_c.h"

namespace waves {

/// Declares `count` lanes from number `first` on. The first lane has code `code`.
inline void declare(VerilatedFst* tracep, uint32_t code, unsigned first, unsigned count,
                    fstVarDir direction, fstVarType type, bool array, int array_number, int msb,
                    int lsb) {
  for (unsigned i = 0; i < count; ++i) {
    const std::string name = "[" + std::to_string(first + i) + "]";
    tracep->declBus(code + i, name.c_str(), -1, direction, type, array, array_number, msb, lsb);
  }
}

/// Dumps the changes of `count` words of 32 bits.
[[gnu::noinline]] inline void chg(VerilatedFst::Buffer* bufp, uint32_t* oldp, const IData* words,
                                  unsigned count) {
  for (unsigned i = 0; i < count; ++i) bufp->chgIData(oldp + i, words[i], 32);
}

/// Dumps all of the words.
[[gnu::noinline]] inline void full(VerilatedFst::Buffer* bufp, uint32_t* oldp, const IData* words,
                                   unsigned count) {
  for (unsigned i = 0; i < count; ++i) bufp->fullIData(oldp + i, words[i], 32);
}

}  // namespace waves
