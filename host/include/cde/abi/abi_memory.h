// SPDX-License-Identifier: Apache-2.0
/** @file
   DDR of a card, as both C interfaces (abi.h and abi_pci.h) describe it. */
#ifndef CDE_ABI_MEMORY_H
#define CDE_ABI_MEMORY_H
#include <stdint.h>

/** When DDR answers reads of the card. */
enum {
  CDE_MEMORY_IDEAL = 0, /**< one beat per cycle, each a fixed number of cycles after its request */
  CDE_MEMORY_CYCLE = 1, /**< banks, rows, refresh, bus width: models/ddr_timing.h */
  CDE_MEMORY_NARROW = 2 /**< 16 bits per cycle of the core: models/narrow_timing.h */
};

/** Counted since creation. Only CDE_MEMORY_CYCLE counts. */
typedef struct cde_memory_counters {
  uint64_t bursts;     /**< read */
  uint64_t row_misses; /**< bursts that had to open their row */
  uint64_t refreshes;  /**< refreshes that delayed a read; an idle memory's are not counted */
} cde_memory_counters;

#endif
