// SPDX-License-Identifier: Apache-2.0
// Harness of the `fpga_card` top module, with its memory of 16 bits.
#include "narrow_memory.h"

// After the class Chips.
#include "local_bus_model.h"
