// SPDX-License-Identifier: Apache-2.0
/** @file
   C interface of a card behind PCI: a shared library with a Verilated `card`, and its host: bridge,
   arbiter and memory. Instead of `card` it may hold `pci_bridge` with a memory on its local bus.
   The only symbol is cde_pci_entry(). One handle is one host with one card. Handles are independent
   and may live in different threads. Two threads must not use one handle at once. Calls that use
   the bus return when the access ends; both clocks and every DMA run on meanwhile. */
#ifndef CDE_ABI_PCI_H
#define CDE_ABI_PCI_H
#include <stdint.h>

#include "cde/abi/abi_head.h"
#include "cde/abi/abi_memory.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CDE_PCI_ABI 4u

/** What a host adds to the card's own cycles. docs/reference/pci.md has the figures and their
   sources. */
typedef struct cde_pci_profile {
  uint32_t arbitration; /**< PCI cycles from REQ# to GNT# on an idle bus that is not parked at the
                           card */
  uint32_t
      read_latency; /**< PCI cycles from the address phase to the first data phase, at least 3 */
  uint32_t write_latency; /**< the same for writes into host memory, at least 2 */
  uint32_t wait_every;    /**< data phases before each group of wait states; 0: never */
  uint32_t waits;         /**< wait states per group */
} cde_pci_profile;

typedef struct cde_pci_options {
  uint32_t core_period_ps; /**< core clock */
  uint32_t pci_period_ps;  /**< PCI clock, 15000 for 66.67 MHz */
  uint32_t memory;         /**< CDE_MEMORY_* */
  uint32_t
      ddr_latency; /**< of the ideal memory: core cycles from a slot request to its data, >= 1 */
  uint32_t narrow; /**< 1: the host has a 32-bit bus */
  uint64_t memory_bytes; /**< host memory, a multiple of 4096, at most 1 GiB */
  uint64_t seed; /**< for the order of physical pages; for local-bus stalls of `pci_bridge` */
  cde_pci_profile profile;
} cde_pci_options;

/** How an access of the host ended. */
enum {
  CDE_PCI_OK = 0,
  CDE_PCI_MASTER_ABORT = 1, /**< no device answered */
  CDE_PCI_TARGET_ABORT = 2,
  CDE_PCI_PARITY = 3,  /**< data was read, or the card reported a write, with bad parity */
  CDE_PCI_RETRIED = 4, /**< only retries for a million cycles */
  CDE_PCI_STUCK = 5    /**< a transaction did not end, or did not get the bus, for a million cycles;
                          every access ends so until reset */
};

/** One bus transaction of the host, for tests. A retry or a disconnect ends it. */
typedef struct cde_pci_transaction {
  uint32_t command; /**< C/BE#[3:0] of the address phase */
  uint32_t address; /**< AD of the address phase; configuration: register, IDSEL is the card's */
  uint32_t wide;    /**< 1: asks for 64 bits */
  uint32_t dwords;  /**< data, 1 to 64; even if wide */
  uint32_t waits;   /**< cycles without IRDY# before each data phase */
  uint32_t bad_address_parity; /**< 1: PAR of the address phase is wrong */
  uint32_t bad_data_parity;    /**< number of a data phase whose PAR is wrong, from 1; 0: none */
  uint32_t data[64];
  uint8_t enable[64]; /**< bytes of each dword, bit 0 the lowest */
  uint32_t done;      /**< out: dwords moved */
  uint32_t stopped;   /**< out: 1: ended by STOP# (a retry if nothing was moved) */
  uint32_t took_wide; /**< out: ACK64# was asserted */
  uint32_t devsel;    /**< out: cycles from the address phase to DEVSEL# */
} cde_pci_transaction;

/** Faults of the host towards the card, and of the card's memory. `count` transactions (or the unit
   named below) have the fault. All ones: every one until reset. */
enum {
  CDE_PCI_FAULT_RETRY = 0,      /**< retried */
  CDE_PCI_FAULT_SLOW = 1,       /**< `value` wait states before every data phase */
  CDE_PCI_FAULT_DISCONNECT = 2, /**< disconnected with data at data phase `value`, from 1 */
  CDE_PCI_FAULT_DISCONNECT_EMPTY =
      3,                    /**< disconnected without data after `value` data phases, >= 1 */
  CDE_PCI_FAULT_PARITY = 4, /**< wrong parity in data phase `value` (from 1) of the transaction */
  CDE_PCI_FAULT_TARGET_ABORT = 5,   /**< aborted after `value` data phases */
  CDE_PCI_FAULT_MASTER_ABORT = 6,   /**< not answered */
  CDE_PCI_FAULT_LOST_INTERRUPT = 7, /**< not seen by `run` and `interrupt` */
  CDE_PCI_FAULT_GRANT = 8,          /**< GNT# removed `value` cycles after FRAME# */
  CDE_PCI_FAULT_NO_ANSWER = 9,      /**< the card does not answer a transaction of the host */
  CDE_PCI_FAULT_NO_GRANT = 10, /**< no GNT# for `count` cycles in which the card requests the bus */
  CDE_PCI_FAULT_HANG = 11,     /**< `card` only: DDR gives no data for `count` core cycles */
  CDE_PCI_FAULTS = 12
};
#define CDE_PCI_UNTIL_RESET 0xFFFFFFFFu

/** A space of local_memory that the local bus does not have: check bits of DDR, one byte per word.
 */
#define CDE_PCI_SPACE_CHECK 0x100u

typedef struct cde_pci_counters {
  uint64_t cycles;     /**< PCI cycles since creation */
  uint64_t busy;       /**< cycles with FRAME# or IRDY# asserted */
  uint64_t data;       /**< cycles in which data moved */
  uint64_t waits;      /**< busy cycles without data */
  uint64_t bytes_read; /**< from host memory by the card */
  uint64_t bytes_written;
  uint64_t transactions; /**< of the card */
  uint64_t skipped;      /**< cycles that were not simulated because they change nothing */
  uint64_t faults[CDE_PCI_FAULTS]; /**< faults that happened, by kind; NO_GRANT and HANG: cycles */
} cde_pci_counters;

typedef struct cde_pci_api {
  cde_abi_head head;
  uint32_t container_bits; /**< width of a word in slots and records: 32 or 64; 0 without a board */
  uint64_t config_hash;    /**< of parameters and RTL */
  const char* parameters;  /**< NAME=VALUE lines of the elaborated configuration */

  void* (*create)(
      const cde_pci_options* options); /**< NULL when memory is short or an option is bad */
  void (*destroy)(void* host);
  void (*reset)(void* host); /**< RST#; host memory stays */

  /** Accesses of the CPU. mmio is at `offset` in BAR0, which config_write must have placed and
     enabled. Its `bytes` are 4, or a multiple of 8 as one burst if the bus permits. Retries and
     disconnects are followed up. Configuration: 4 bytes. */
  int (*mmio_read)(void* host, uint32_t offset, void* data, uint32_t bytes);
  int (*mmio_write)(void* host, uint32_t offset, const void* data, uint32_t bytes);
  int (*config_read)(void* host, uint32_t offset, uint32_t* value);
  int (*config_write)(void* host, uint32_t offset, uint32_t value);
  int (*transact)(void* host, cde_pci_transaction* transaction);

  /** Host memory: pages of 4 KiB whose frames (bus address / 4096) are not contiguous. */
  uint32_t (*frame)(void* host,
                    uint32_t page); /**< frame of the n-th page; all ones beyond memory */
  void* (*memory)(void* host, uint32_t frame); /**< NULL if there is no such frame */

  /** Runs for max_ps. With `until_interrupt` it ends early when INTA# is seen. Returns the
     picoseconds that passed. */
  uint64_t (*run)(void* host, uint64_t max_ps, int until_interrupt);
  int (*interrupt)(void* host);
  uint64_t (*time_ps)(void* host); /**< since creation */
  void (*counters)(void* host, cde_pci_counters* counters);
  void (*memory_counters)(void* host, cde_memory_counters* counters); /**< of the card's DDR */

  int (*fault)(void* host, uint32_t kind, uint32_t count, uint32_t value); /**< -1: no such fault */
  const char* (*violation)(void* host); /**< first PCI rule broken, with its cycle; NULL if none */

  /** Waves: 0, or -1 if the model has no tracing or the file cannot be written. destroy() also
     closes them. */
  int (*trace_open)(void* host, const cde_trace* what);
  int (*trace_close)(void* host); /**< 0, or errno: what is missing from the file */

  /** For tests: memory behind a space of the local bus (NULL if there is none), and the card's
     interrupt line (`pci_bridge` only). */
  void* (*local_memory)(void* host, uint32_t space, uint64_t* bytes);
  void (*local_irq)(void* host, int level);
  void (*evaluate_all)(void* host, int on); /**< 1: no idle PCI cycle is skipped */
} cde_pci_api;

typedef const cde_pci_api* (*cde_pci_entry_fn)(void);

#ifdef __cplusplus
}
#endif
#endif
