// SPDX-License-Identifier: Apache-2.0
// What goes between the modules of a card; software sees none of it.
package card_pkg;
  // Who does a pass.
  localparam int UNIT_BITS = 2;
  localparam logic [1:0] UNIT_ENGINE = 2'd0;  // engine_control and what it leads
  localparam logic [1:0] UNIT_HIERARCHY = 2'd1;  // hierarchy_unit, where the card has one
  localparam int UNITS = 2;

  // What the registers ask of a pass. Mode, pairs and swaps are kept by the sequencer from go on.
  typedef struct packed {
    logic [1:0] unit;           // UNIT_*
    logic [31:0] prim_objects;  // objects of primaries; 0: primaries as they were written
    logic [31:0] objects;       // objects to sweep; 0: the slots of `first` and `count`
    logic [31:0] first;         // secondary slot
    logic [31:0] count;         // secondaries
    logic [8:0] primaries;      // in the register file
    logic [7:0] split;          // the first primary of the second pair
    logic [23:0] budget;        // of cylinder pairs
    logic normals;
    logic [1:0] swap;           // of roles, of each pair
    logic [1:0][pairs_pkg::PAIR_BITS-1:0] pair;  // the second one or NO_PAIR, the first
    logic [2:0] mode;
  } pass_t;

  // What happens in a clock of a pass of the engine, to be counted.
  typedef struct packed {
    logic [1:0] open;           // pairs go through a wide pipe behind narrow lanes
    logic [3:0] ecc_failed;     // words
    logic [7:0] ecc_corrected;
    logic record;               // is written to SRAM
    logic writeback;            // the clock is one of the write-back
    logic secondary_bad;
    logic secondary;            // is swept
    logic stall;
    logic bubble;
    logic [1:0] issue;          // rows
  } events_t;
  // What another unit counts of its passes: an array of as many events of a clock as it has counters in
  // registers_pkg::COUNTER_REGISTERS, each so many bits (pass_counters.sv).
  localparam int COUNT_BITS = 4;

  // An access of the bus that may be, for modules with registers or memories beside card_registers. Of reads, all:
  // where another is read, or none, one's own answer is 0.
  typedef struct packed {
    logic write;
    logic read;
    logic there;  // what is read may be
    logic [2:0] space;
    logic [31:0] addr;
    logic [63:0] data;
  } access_t;

  // A reader of DDR asks for a beat, until that is taken or the reader takes it back.
  typedef struct packed {
    logic valid;
    logic [31:0] word;  // address in words
  } ddr_request_t;

  // Rows of primaries, lanes and primaries have 8 bits, whatever the card has of them.
  // Rows of primaries that meet the secondary in a clock: of the second pair, of the first.
  typedef struct packed {
    logic parity;  // of the pass
    logic [1:0][7:0] row;
    logic [1:0] valid;
  } issue_t;
  // A result that the output FIFO shows; T and CP are still with the lane.
  typedef struct packed {
    logic valid;
    logic bad;
    logic f;
    logic [31:0] index;
    logic [7:0] row;
    logic [7:0] lane;
  } streamed_t;
  // A primary whose result in the update buffers is to be written to SRAM.
  typedef struct packed {
    logic valid;
    logic parity;  // of the pass
    logic [7:0] primary;
  } writeback_t;

  // Between PCI's clock and the core's: requests for the local bus, in order, and what comes back.
  typedef struct packed {
    logic tag;           // 1: of the DMA engine, 0: of an access of the host
    logic write;
    logic [2:0] space;
    logic [31:0] offset;
    logic [63:0] data;   // of a write; of a read the number of beats
  } local_request_t;
  typedef struct packed {
    logic irq;  // the interrupt line changed: data
    logic tag;  // of the request
    logic [63:0] data;
  } local_response_t;
endpackage
