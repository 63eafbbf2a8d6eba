// SPDX-License-Identifier: Apache-2.0
/** @file
   Head of every function table of a simulation model. The library exports one function, which
   returns its table. A loader stops reading unless both numbers equal the numbers that it was built
   with. */
#ifndef CDE_ABI_HEAD_H
#define CDE_ABI_HEAD_H
#include <stdint.h>

typedef struct cde_abi_head {
  uint32_t version; /**< CDE_*_ABI */
  uint32_t size;    /**< bytes of the table */
} cde_abi_head;

/** Which waves are written. Times are on the time axis of the file. */
typedef struct cde_trace {
  const char* path;
  uint64_t from, to; /**< first and last time, counted from now */
  uint64_t
      ddr_word; /**< waves begin where the card asks DDR for this word, CDE_TRACE_NOW: at `from` */
  uint64_t length;    /**< waves end this much later */
  const char* scopes; /**< patterns of scopes and signals, one per line; empty: all */
} cde_trace;

#define CDE_TRACE_NOW UINT64_MAX

#endif
