// SPDX-License-Identifier: Apache-2.0
/* C interface of a pair_unit bitstream. A unit is single-threaded. Words are 32 bits for formats of
 * up to 32 bits and 64 for wider ones, little-endian, in the order of the shapes
 * (rtl/contract/pairs_pkg.sv). */
#pragma once
#include <stdint.h>

#include "cde/abi/abi_head.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CDE_PAIR_ABI 6u

typedef struct cde_pair_unit cde_pair_unit;

/* An operator of the pipe. */
typedef struct cde_pair_operator {
  const char* path;   /* in the hierarchy, with the names of generate blocks, as %m has it */
  uint32_t operation; /* formats_pkg::FP_* */
  uint32_t latency;   /* clocks from operands to result */
} cde_pair_operator;

/* Words of a result: F and bad as 0 or 1, T, CP x y z, n x y z. */
enum {
  CDE_PAIR_F,
  CDE_PAIR_BAD,
  CDE_PAIR_T,
  CDE_PAIR_CP,
  CDE_PAIR_N = 6,
  CDE_PAIR_RESULT_WORDS = 9
};

/* What test() returns of a unit that does not go on. The longest a pipe takes for a row is some
 * 100,000 clocks, a ring with the greatest budget and operators of 64 clocks. */
#define CDE_PAIR_STUCK UINT64_MAX
enum { CDE_PAIR_PATIENCE = 1000000 };

/* How far the last test() came: rows taken and answered, the clock, counted from the first row, of
 * the last of them, and whether the answer to another row than the next stands there. */
typedef struct cde_pair_progress {
  uint64_t taken, answered, clock;
  uint32_t disordered;
} cde_pair_progress;

typedef struct cde_pair_api {
  cde_abi_head head;
  uint32_t word_bytes, lanes, a_words, b_words;
  uint64_t config_hash;
  const char* parameters;         /* NAME=VALUE lines */
  cde_pair_unit* (*create)(void); /* null when out of memory */
  void (*destroy)(cde_pair_unit*);
  uint32_t (*latency)(const cde_pair_unit*); /* clocks from operands to results */
  /* Work for a pair that takes as much as it is given: K2, K1 and M, a byte each from the top. The
   * unit is reset. */
  void (*set_budget)(cde_pair_unit*, uint32_t budget);
  /* n pairs, a row of lanes a clock while the unit is ready: operands as a_words (b_words) words a
   * pair, results as CDE_PAIR_RESULT_WORDS words a pair. Before each row `gap`, called with
   * gap_context, says how many idle clocks to put in; null is none. Returns the clocks from the
   * first row in to the last result out, or CDE_PAIR_STUCK: for CDE_PAIR_PATIENCE clocks, those of
   * gaps not counted, no row was taken and none answered, or the answer to another row than the
   * next came; a reset is needed. */
  uint64_t (*test)(cde_pair_unit*, const void* a, const void* b, void* results, uint64_t n,
                   uint32_t (*gap)(void*), void* gap_context);
  cde_pair_progress (*progress)(const cde_pair_unit*);
  /* Reset in mid-stream: what is in flight is gone. */
  void (*reset)(cde_pair_unit*);
  /* 0 when opened; waves need TRACE=1. There is no DDR. */
  int (*trace_open)(cde_pair_unit*, const cde_trace* what);
  int (*trace_close)(cde_pair_unit*); /* 0, or errno: what is missing from the file */
  /* Operators of a unit that was built with TAP=1; none of others. */
  uint32_t (*operators)(const cde_pair_unit*);
  const cde_pair_operator* (*operator_at)(const cde_pair_unit*, uint32_t index);
  /* From here on test() tells `seen`, with its context, what is at the operands and at the result
   * of each operator in each clock; clock 0 is that of the first row in. Null: no more. */
  void (*watch)(cde_pair_unit*,
                void (*seen)(void* context, uint32_t index, uint64_t clock, uint64_t a, uint64_t b,
                             uint64_t result),
                void* context);
} cde_pair_api;

typedef const cde_pair_api* (*cde_pair_entry_fn)(void);

#ifdef __cplusplus
}
#endif
