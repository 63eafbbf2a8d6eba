// SPDX-License-Identifier: Apache-2.0
// Harness of the `board` top module, with DDR and SRAM chips.
#include "chips.h"

// After the class Chips.
#include "local_bus_model.h"
