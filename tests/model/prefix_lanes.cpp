// SPDX-License-Identifier: Apache-2.0
// Prints the outputs of prefix_lanes for 200 random inputs, one line each.
#include <cstdio>
#include <random>

#include "Vmodel.h"

int main() {
  constexpr unsigned kSeed = 20240611, kLanes = 16;
  VerilatedContext context;
  Vmodel model{&context};
  std::mt19937 random(kSeed);
  for (int clock = 0; clock < 200; ++clock) {
    for (unsigned l = 0; l < kLanes; ++l) {
      model.a_i[l] = random() & random() & random();
      model.b_i[l] = random() | random() | random();
    }
    model.clk_i = 0;
    model.eval();
    model.clk_i = 1;
    model.eval();
    for (unsigned l = 0; l < kLanes; ++l)
      std::printf("%08x %08x %08x %08x %08x ", model.any_o[l], model.turn_o[l], model.and_o[l],
                  model.late_o[l], model.steps_o[l]);
    std::printf("\n");
  }
}
