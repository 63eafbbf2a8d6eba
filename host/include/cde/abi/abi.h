// SPDX-License-Identifier: Apache-2.0
/** @file
   C interface of a simulation model of a board: a shared library with one Verilated `board` and
   models of the chips around it. The only symbol is cde_board_entry(). One handle is one card.
   Handles are independent and may live in different threads. Two threads must not use one handle at
   once. */
#ifndef CDE_ABI_H
#define CDE_ABI_H
#include <stdint.h>

#include "cde/abi/abi_head.h"
#include "cde/abi/abi_memory.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CDE_BOARD_ABI 4u

typedef struct cde_board_options {
  uint32_t memory;          /**< CDE_MEMORY_* */
  uint32_t ddr_latency;     /**< ideal memory: cycles from a slot request to its data, >= 1 */
  uint32_t clock_period_ps; /**< time axis of waves, and of CDE_MEMORY_CYCLE */
} cde_board_options;

typedef struct cde_board_api {
  cde_abi_head head;
  uint32_t container_bits; /**< width of a word in slots and records: 32 or 64 */
  uint64_t config_hash;    /**< expected value of the register */
  const char* parameters;  /**< NAME=VALUE lines of the elaborated configuration */

  void* (*create)(const cde_board_options*
                      options); /**< NULL when memory is short; the card comes out of reset */
  void (*destroy)(void* card);
  void (*reset)(void* card);

  /** `beats` transfers of 64 bits on the local bus, one per cycle, at byte offset, offset + 8, ...
     For SRAM the offset stays 0. Returns the number of beats transferred. It is smaller only if
     `max_cycles` ran out, or the bus has no such space number (card::kSpaceBits). The card itself
     refuses a space that it does not have. */
  uint64_t (*write)(void* card, uint32_t space, uint32_t offset, const void* data, uint64_t beats,
                    uint64_t max_cycles);
  uint64_t (*read)(void* card, uint32_t space, uint32_t offset, void* data, uint64_t beats,
                   uint64_t max_cycles);

  /** Runs until the interrupt line is high, at most max_cycles cycles. Returns the cycles spent. */
  uint64_t (*run)(void* card, uint64_t max_cycles);
  /** Runs this many cycles, whatever the interrupt line does. */
  void (*advance)(void* card, uint64_t cycles);
  int (*interrupt)(void* card);
  uint64_t (*cycles)(void* card); /**< since creation */
  void (*memory)(void* card, cde_memory_counters* counters);

  /** Waves: 0, or -1 if the model has no tracing or the file cannot be written. destroy() also
     closes them. */
  int (*trace_open)(void* card, const cde_trace* what);
  int (*trace_close)(void* card); /**< 0, or errno: what is missing from the file */

  /** For tests: flips bits of a DDR byte, or of the check bits of a word, as a fault would. Returns
     0, or -1 if there is no such byte or the card has no check bits. */
  int (*ddr_flip)(void* card, uint64_t byte, uint8_t mask);
  int (*check_flip)(void* card, uint64_t word, uint8_t mask);
  /** DDR gives no data for this many cycles; all ones: until reset. */
  void (*ddr_hang)(void* card, uint32_t cycles);
} cde_board_api;

typedef const cde_board_api* (*cde_board_entry_fn)(void);

#ifdef __cplusplus
}
#endif
#endif
