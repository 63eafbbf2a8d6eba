// SPDX-License-Identifier: Apache-2.0
/** @file
   C interface of a simulation model of fp_unit. A unit is single-threaded. Operands and results are
   the low bits of 64-bit words. cde/contract/formats.hpp lists the operations. */
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
  uint32_t flags;               /**< 1 if the model computes flags */
  uint32_t operations;          /**< bit op: the operation is there */
  const char* parameters;       /**< NAME=VALUE lines */
  cde_fp_unit* (*create)(void); /**< null when out of memory */
  void (*destroy)(cde_fp_unit*);
  /** Latency in cycles; 0 for a missing operation. */
  uint32_t (*latency)(const cde_fp_unit*, uint32_t op);
  /** n operations, streamed one row of lanes per cycle. With B_LANES=1 all lanes share one b: one
     operation per cycle. Only binary operations read b. flags (bits NX 1, UF 2, OF 4, DZ 8, NV 16)
     may be null. Returns 0 on success, 1 for a missing operation. */
  int (*apply)(cde_fp_unit*, uint32_t op, const uint64_t* a, const uint64_t* b, uint64_t* r,
               uint8_t* flags, uint64_t n);
  /** Processor seconds of the calling thread for this many cycles of the operation, with new
     operands in every cycle. Negative for a missing operation. */
  double (*measure)(cde_fp_unit*, uint32_t op, uint64_t cycles);
} cde_fp_api;

typedef const cde_fp_api* (*cde_fp_entry_fn)(void);

#ifdef __cplusplus
}
#endif
