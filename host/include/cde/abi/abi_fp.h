// SPDX-License-Identifier: Apache-2.0
/* C interface of an fp_unit bitstream. A unit is single-threaded; operands and results are the low
 * bits of 64-bit words. Operations are those of cde/contract/formats.hpp. */
#pragma once
#include <stdint.h>

#include "cde/abi/abi_head.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CDE_FP_ABI 2u

typedef struct cde_fp_unit cde_fp_unit;

typedef struct cde_fp_api {
  cde_abi_head head;
  uint32_t exp_bits, man_bits, lanes;
  uint32_t flags;               /* 1 if the bitstream computes flags */
  uint32_t operations;          /* bit op: the operation is there */
  const char* parameters;       /* NAME=VALUE lines */
  cde_fp_unit* (*create)(void); /* null when out of memory */
  void (*destroy)(cde_fp_unit*);
  /* Latency in clocks; 0 for an operation that is not there. */
  uint32_t (*latency)(const cde_fp_unit*, uint32_t op);
  /* n operations, streamed one row of lanes a clock (one operation a clock where B_LANES=1 makes
   * all lanes share one b). b is read by binary operations only; flags (bits NX 1, UF 2, OF 4, DZ
   * 8, NV 16) may be null. 0 on success, 1 for an operation that is not there. */
  int (*apply)(cde_fp_unit*, uint32_t op, const uint64_t* a, const uint64_t* b, uint64_t* r,
               uint8_t* flags, uint64_t n);
  /* Processor seconds (of the calling thread) of that many clocks of the operation, new operands
   * every clock; negative if it is not there. */
  double (*measure)(cde_fp_unit*, uint32_t op, uint64_t clocks);
} cde_fp_api;

typedef const cde_fp_api* (*cde_fp_entry_fn)(void);

#ifdef __cplusplus
}
#endif
