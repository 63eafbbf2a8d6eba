// SPDX-License-Identifier: Apache-2.0
/* What both C interfaces of a card, abi.h and abi_pci.h, say of its DDR. */
#ifndef CDE_ABI_MEMORY_H
#define CDE_ABI_MEMORY_H
#include <stdint.h>

/* When DDR answers the card's reads. */
enum {
  CDE_MEMORY_IDEAL = 0, /* a beat a clock, each a fixed number of clocks after its request */
  CDE_MEMORY_CYCLE = 1  /* banks, rows, refresh, width of the bus: models/ddr_timing.h */
};

/* Since creation; CDE_MEMORY_IDEAL counts nothing. */
typedef struct cde_memory_counters {
  uint64_t bursts;     /* read */
  uint64_t row_misses; /* bursts that had to open their row */
  uint64_t refreshes;  /* that a read met; those of an idle memory are not counted */
} cde_memory_counters;

#endif
