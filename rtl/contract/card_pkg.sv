// SPDX-License-Identifier: Apache-2.0
// Types between the modules of a card. Software does not see them.
package card_pkg;
  // Unit that does a pass.
  localparam int UNIT_BITS = 2;
  localparam logic [1:0] UNIT_ENGINE = 2'd0;  // engine_control and the modules that it controls
  localparam logic [1:0] UNIT_BVH = 2'd1;  // bvh_unit, if the card has one
  localparam int UNITS = 2;

  // Request for a pass, from the registers. From go on, the sequencer keeps mode, pairs and swaps.
  typedef struct packed {
    logic [1:0] unit;           // UNIT_*
    logic [31:0] prim_objects;  // objects of primaries; 0: primaries are not transformed
    logic [31:0] objects;       // objects of the pass; 0: the slots of `first` and `count`
    logic [31:0] first;         // secondary slot
    logic [31:0] count;         // secondaries
    logic [8:0] primaries;      // in the register file
    logic [7:0] split;          // first primary of the second pair
    logic [23:0] iterations;    // iterations of cylinder pairs
    logic normals;
    logic [1:0] swap;           // role swap of each pair
    logic [1:0][pairs_pkg::PAIR_BITS-1:0] pair;  // [1] is the second pair or NO_PAIR, [0] the first
    logic [2:0] mode;
  } pass_t;

  // Events in a cycle of an engine pass, for the counters.
  typedef struct packed {
    logic [1:0] uncertain;      // pairs with certified filters that are uncertain and go through the wide pipe
    logic [3:0] ecc_failed;     // words with uncorrectable errors
    logic [7:0] ecc_corrected;
    logic record;               // a record is written to SRAM
    logic writeback;            // a cycle of the write-back
    logic secondary_bad;
    logic secondary;            // a secondary enters the rows
    logic stall;
    logic bubble;
    logic [1:0] issue;          // rows issued
  } events_t;
  // Events that another unit counts in its passes: one number per counter in registers_pkg::COUNTER_REGISTERS. Each
  // number has this many bits per cycle (pass_counters.sv).
  localparam int COUNT_BITS = 4;

  // An allowed bus access, for modules with registers or memories beside card_registers. Reads include all spaces: a
  // module answers 0 to a read that is not its own.
  typedef struct packed {
    logic write;
    logic read;  // also in the cycles in which it waits
    logic hit;  // the beat is in the 4 KB of the registers
    logic [2:0] space;
    logic [31:0] addr;
    logic [63:0] data;
  } access_t;

  // Read request of a DDR reader. It holds the request until it is taken, or withdraws it.
  typedef struct packed {
    logic [3:0] words;  // of the beat in use
    logic valid;
    logic [31:0] word;  // address in words
  } ddr_request_t;

  // Numbers of rows, lanes and primaries have 8 bits, for any number of them on the card.
  // Rows of primaries that meet the secondary in a cycle: [1] of the second pair, [0] of the first.
  typedef struct packed {
    logic parity;  // buffer parity of the pass
    logic [1:0][7:0] row;
    logic [1:0] valid;
  } issue_t;
  // A result at the output of the FIFO. T and CP are still in the lane.
  typedef struct packed {
    logic valid;
    logic bad;
    logic f;
    logic [31:0] index;
    logic [7:0] row;
    logic [7:0] lane;
  } streamed_t;
  // A primary whose result is to go from the update buffers to SRAM.
  typedef struct packed {
    logic valid;
    logic parity;  // buffer parity of the pass
    logic [7:0] primary;
  } writeback_t;

  // A lane that brute-force passes and leaves of a BVH share: a ray and a triangle, and the pipe's results.
  typedef struct packed {
    logic valid;  // leaves use the lane in this pass
    logic [7:0][31:0] ray;
    logic [8:0][31:0] triangle;
  } lane_operands_t;
  typedef struct packed {
    logic [31:0] f;
    logic [31:0] t;
    logic [2:0][31:0] point;
    logic [15:0] latency;
  } lane_results_t;

  // Between the PCI clock and the core clock: requests for the local bus, in order, and their responses.
  typedef struct packed {
    logic tag;           // 1: from the DMA engine, 0: from a host access
    logic write;
    logic [2:0] space;
    logic [31:0] offset;
    logic [63:0] data;   // write: the data; read: the number of beats
  } local_request_t;
  typedef struct packed {
    logic irq;  // the interrupt line changed; its level is in data
    logic tag;  // tag of the request
    logic [63:0] data;
  } local_response_t;
endpackage
