// SPDX-License-Identifier: Apache-2.0
/** @file
   C interface of a simulation model of pair_unit. A unit is single-threaded. Words have 32 bits for
   formats of up to 32 bits and 64 bits for wider ones, little-endian. Their order is the order of
   the shapes (rtl/contract/pairs_pkg.sv). */
#pragma once
#include <stdint.h>

#include "cde/abi/abi_head.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CDE_PAIR_ABI 6u

typedef struct cde_pair_unit cde_pair_unit;

/** A floating-point operator of the pipe. */
typedef struct cde_pair_operator {
  const char* path; /**< in the module hierarchy, with the names of generate blocks, as %m has it */
  uint32_t operation; /**< formats_pkg::FP_* */
  uint32_t latency;   /**< cycles from operands to result */
} cde_pair_operator;

/** Words of a result: F and bad as 0 or 1, T, CP x y z, n x y z. */
enum {
  CDE_PAIR_F,
  CDE_PAIR_BAD,
  CDE_PAIR_T,
  CDE_PAIR_CP,
  CDE_PAIR_N = 6,
  CDE_PAIR_RESULT_WORDS = 9
};

/** What test() returns if the unit makes no progress. The longest that a pipe takes for a row is
   about 100,000 cycles. That is an iterative pipeline with the most iterations and operators of 64
   cycles. */
#define CDE_PAIR_STUCK UINT64_MAX
enum { CDE_PAIR_PATIENCE = 1000000 };

/** Progress of the last test(): rows taken and answered, and the cycle of the last of them, counted
   from the first row. `disordered`: the pending answer belongs to another row than the next. */
typedef struct cde_pair_progress {
  uint64_t taken, answered, cycle;
  uint32_t disordered;
} cde_pair_progress;

typedef struct cde_pair_api {
  cde_abi_head head;
  uint32_t word_bytes, lanes, a_words, b_words;
  uint64_t config_hash;
  const char* parameters;         /**< NAME=VALUE lines */
  cde_pair_unit* (*create)(void); /**< null when out of memory */
  void (*destroy)(cde_pair_unit*);
  uint32_t (*latency)(const cde_pair_unit*); /**< cycles from operands to results */
  /** Iterations for pairs that take a number of them: K2, K1 and M, one byte each from the top. The
     unit is reset. */
  void (*set_iterations)(cde_pair_unit*, uint32_t iterations);
  /** Tests n pairs, one row of lanes per cycle while the unit is ready. Operands are a_words
     (b_words) words per pair, results CDE_PAIR_RESULT_WORDS words per pair. Before each row `gap`,
     called with gap_context, returns the number of idle cycles to insert; null: none. Returns the
     cycles from the first row in to the last result out. Returns CDE_PAIR_STUCK if the unit takes
     and answers no row for CDE_PAIR_PATIENCE cycles, not counting gaps. It also does so if an
     answer belongs to another row than the next. A reset is then needed. */
  uint64_t (*test)(cde_pair_unit*, const void* a, const void* b, void* results, uint64_t n,
                   uint32_t (*gap)(void*), void* gap_context);
  cde_pair_progress (*progress)(const cde_pair_unit*);
  /** Resets in mid-stream: rows in flight are lost. */
  void (*reset)(cde_pair_unit*);
  /** Returns 0 when opened; waves need TRACE=1. A unit has no DDR. */
  int (*trace_open)(cde_pair_unit*, const cde_trace* what);
  int (*trace_close)(cde_pair_unit*); /**< 0, or errno: what is missing from the file */
  /** Operators of a unit that was built with TAP=1; otherwise none. */
  uint32_t (*operators)(const cde_pair_unit*);
  const cde_pair_operator* (*operator_at)(const cde_pair_unit*, uint32_t index);
  /** From here on test() calls `seen` with its context, for each operator in each cycle. `seen`
     gets the values at the operands and at the result. The first row enters in cycle 0. Null:
     stop.
   */
  void (*watch)(cde_pair_unit*,
                void (*seen)(void* context, uint32_t index, uint64_t cycle, uint64_t a, uint64_t b,
                             uint64_t result),
                void* context);
} cde_pair_api;

typedef const cde_pair_api* (*cde_pair_entry_fn)(void);

#ifdef __cplusplus
}
#endif
